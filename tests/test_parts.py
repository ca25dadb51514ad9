"""Parts in files: what their tables make is what the functions make, and what is wrong is told with its line."""

from __future__ import annotations

import json
import re
from fractions import Fraction

import numpy as np
import pytest
from conftest import EQUAL, solved

import pas
from pas import solid
from pas.cli import main
from pas.exchange.formats import Sizing
from pas.exchange.part_problem import MAKERS, steps_of

BRACKET = """\
unit = "mm"

[[solid]]
name = "plate"
kind = "box"
lower = [0, 0, 0]
upper = [40, 30, 5]
face = "plate"

[[solid]]
name = "boss"
kind = "rectangle"
width = 10
height = 30
face = "boss"
then = [
  { kind = "extrude", height = 20 },
]

[[solid]]
name = "bracket"
kind = "union"
of = ["plate", "boss"]

[[solid.then]]
kind = "fillet"
first = "plate z+"
second = "boss 2"
radius = 3

[[solid.then]]
kind = "mirror"
normal = [1, 0, 0]
"""

SKETCH = """
[[solid]]
name = "hole"
kind = "circle"
center = [1, "1/2"]
radius = 0.25

[[solid]]
name = "foot"
kind = "sketch"
start = [0, 0]
then = [
  { kind = "line_to", x = 4, y = 0 },
  { kind = "arc_to", x = 4, y = 1, radius = "1/2" },
  { kind = "line_to", x = 0, y = 1 },
  { kind = "close" },
  { kind = "difference", of = ["hole"] },
  { kind = "extrude", height = 1 },
]

[[solid]]
name = "dome"
kind = "implicit"
polynomial = "x^2 + y^2 + z^2 - 1"
region = ["z"]
color = "#112a80"
then = [{ kind = "translate", offset = [0, 0, 3] }, { kind = "rotate", axis = [0, 0, 1], degrees = 90 }]
"""

CORNER = """
[[solid]]
name = "corner"
kind = "blend"
order = 1
length = 2
pipes = [
  { axis = [1, 0, 0], radius = "1/3", clip = 1 },
  { axis = [0, 1, 0], radius = "1/3", clip = 1 },
  { axis = [0, 0, 1], radius = "1/3", clip = 1 },
]

[solid.partition]
kind = "six tetrahedra"
center = [0, 0, 0]
legs = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
"""


def read(text, tmp_path):
    path = tmp_path / "part.toml"
    path.write_text(text)
    return pas.read_problem(path)


def test_tables_make_what_functions_make(tmp_path):
    problem = read(BRACKET, tmp_path)
    assert (problem.name, problem.model_unit) == ("part", "millimeter")
    boss = solid.rectangle(10, 30, face="boss").extrude(20)
    part = solid.box((0, 0, 0), (40, 30, 5), face="plate") | boss
    found = problem.solve()
    assert found.faces == (*part.faces, "fillet")
    assert found.polynomials["boss 2"] == part.mirror((1, 0, 0)).polynomials["boss 2"]
    assert [(joint.first, joint.second, joint.order) for joint in found.joints] == [
        ("fillet", "plate z+", 1),
        ("fillet", "boss 2", 1),
    ]


def test_tables_that_nothing_uses_are_the_parts(tmp_path):
    found = read(SKETCH, tmp_path).solve()
    assert [*found.parts] == ["foot", "dome"]
    sides = solid.sketch().line_to(4, 0).arc_to(4, 1, radius="1/2").line_to(0, 1).close()
    foot = (sides - solid.circle((1, "1/2"), "1/4")).extrude(1)
    dome = solid.implicit("x^2 + y^2 + z^2 - 1", "z").translate(0, 0, 3).rotate((0, 0, 1), 90)
    assert found["foot"].shape.tree == foot.tree
    assert (found["dome"].shape.tree, found["dome"].color) == (dome.tree, "#112a80")


def test_a_blend_is_a_solid_among_others(tmp_path, monkeypatch):
    found = read(CORNER, tmp_path).solve()
    assert found.faces == ("blend", *(f"neighbour {n}{end}" for n in (1, 2, 3) for end in ("", " end")))
    assert found.proved
    np.testing.assert_allclose(found.bounding_box, [[-1 / 3] * 3, [3] * 3], atol=0.01)


def test_every_function_that_makes_a_body_is_a_kind_of_tables():
    bodies = {name for name in solid.__all__ if name.islower()} - {"assembly", "patch"}
    assert set(MAKERS) == bodies | {"difference", "blend"}
    assert {"fillet", "chamfer", "rounded", "shell", "pattern", "circular_pattern", "mirror", "union"} <= set(
        steps_of("Solid")
    )
    assert {"extrude", "revolve", "difference"} <= set(steps_of("Profile"))
    assert MAKERS["box"].keys == {"lower": True, "upper": True, "face": False}
    assert steps_of("Solid")["translate"].keys == {"offset": True}


HOLE = 'kind = "circle"\ncenter = [1, "1/2"]\nradius = 0.25'

WRONG = [
    (BRACKET, 'kind = "box"', 'kind = "boxx"', 5, "no kind of solid or profile 'boxx'; is 'box' meant"),
    (BRACKET, "upper", "uper", 7, "'uper' does not belong to the kind 'box'; is 'upper' meant"),
    (BRACKET, "upper = [40, 30, 5]", "", 5, "solid 1: the kind 'box' needs 'upper'"),
    (BRACKET, "[40, 30, 5]", "[40, 30, 0]", 6, "solid 'plate': lower must be below upper: they are 0 and 0 in z"),
    (BRACKET, 'of = ["plate", ', 'of = ["plat", ', 23, "of: there is no solid 'plat' above; is 'plate' meant"),
    (BRACKET, 'name = "boss"', 'name = "plate"', 11, "name must be one of its own, not 'plate'"),
    (BRACKET, 'name = "boss"', "", 10, "solid 2: a solid needs a name"),
    (BRACKET, '"extrude"', '"extrud"', 17, "'boss', step 1: there is no step for a profile 'extrud'; is 'extrude'"),
    (BRACKET, '"extrude"', '"fillet"', 17, "'boss', step 1: there is no step for a profile 'fillet'; there are"),
    (BRACKET, "height = 20", "heigth = 20", 17, "'heigth' does not belong to the step 'extrude'; is 'h"),
    (BRACKET, "height = 20", "height = 0", 17, "solid 'boss', step 1: height must be positive, not 0"),
    (BRACKET, "radius = 3", "radius = -3", 29, "solid 'bracket', step 1: radius must be positive, not -3"),
    (BRACKET, 'second = "boss 2"', 'second = "bos 2"', 25, "solid 'bracket', step 1: "),
    (BRACKET, 'unit = "mm"', 'unit = "mile"', 1, "unit must be one of"),
    (BRACKET, 'unit = "mm"', "units = 3", 1, "unknown key 'units' in the file; is 'unit' meant"),
    (BRACKET, 'of = ["plate", "boss"]', "of = []", 23, "of must be a list of names of tables above"),
    (SKETCH, 'kind = "close"', 'kind = "extrude"', 16, "step 4: there is no step for a sketch 'extrude'"),
    (SKETCH, '  { kind = "extrude", height = 1 },\n', "", 8, "'foot' is a profile that nothing uses; extrude or"),
    (SKETCH, 'region = ["z"]', 'region = "z"', 25, "solid 'dome': region must be a list, not 'z'"),
    (SKETCH, '"#112a80"', '"blue"', 26, "the colour of 'dome' must be written #rrggbb, not 'blue'"),
    (SKETCH, 'region = ["z"]', "face = 3", 25, "solid 'dome': face must be a string, not 3"),
    (SKETCH, 'radius = "1/2" }', "radius = 1, clockwise = 3 }", 14, "step 2: clockwise must be true or false, not 3"),
    (SKETCH, 'kind = "close"', "", 16, "solid 'foot', step 4: there is no 'kind', which says what"),
    (SKETCH, 'of = ["hole"]', 'of = [["hole"]]', 17, "of: there is no solid ['hole'] above"),
    (SKETCH, HOLE, 'kind = "text"\nwords = "a"\nsize = 1\nfont = "Nofont"', 7, "no font 'Nofont' is installed"),
    (CORNER, 'kind = "six tetra', 'kind = "six tetre', 14, "there is no partition 'six tetre"),
    (CORNER, "length = 2", "tolerance = 2", 6, "tolerance is that of the whole file"),
    (CORNER, 'radius = "1/3", clip = 1 },\n]', 'radios = "1/3", clip = 1 },\n]', 10, "radios"),
]


@pytest.mark.parametrize(("text", "old", "new", "line", "sentence"), WRONG)
def test_what_is_wrong_is_told_with_its_line(text, old, new, line, sentence, tmp_path):
    assert text.count(old) >= 1
    with pytest.raises(pas.ProblemFileError, match=re.escape(sentence)) as caught:
        read(text.replace(old, new, 1), tmp_path).solve()
    assert caught.value.line == line


def test_blends_with_a_wall_are_hollow(tmp_path):
    found = read(CORNER.replace("length = 2", 'length = 2\nwall = "1/10"'), tmp_path).solve()
    assert "inside of blend" in found.faces and found.proved
    with pytest.raises(pas.ProblemFileError, match="solid 'corner': "):
        read(CORNER.replace("length = 2", "wall = 1"), tmp_path).solve()


PLATE = """
tolerance = 0.05

[[solid]]
name = "plate"
kind = "rectangle"
width = 4
height = 3
then = [{ kind = "extrude", height = 1 }]
"""


def run(capsys, *arguments):
    code = main([str(a) for a in arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_wrong_units_and_sizes_are_told_before_anything_is_made(tmp_path, capsys):
    path = tmp_path / "part.toml"
    path.write_text(PLATE.replace("height = 1 ", "height = -1 "))
    for option, value in (("--unit", "parsec"), ("--scale", "0"), ("--size", "x")):
        code, _, err = run(capsys, "build", path, option, value)
        assert code and option.strip("-") in err and "height" not in err
    assert "height must be positive" in run(capsys, "build", path)[2]


def test_the_command_writes_each_file_by_its_suffix(tmp_path, capsys):
    path, names = tmp_path / "part.toml", ("a.stl", "b.pas.json", "c.csv")
    path.write_text(PLATE)
    outputs = [word for name in names for word in ("-o", tmp_path / name)]
    code, out, _ = run(capsys, "build", path, *outputs, "--size", "120mm", "--json")
    record = json.loads(out)
    assert (code, record["unit"]) == (0, "millimeter")
    assert record["written"] == [str(tmp_path / name) for name in names]
    (row,) = record["parts"]
    assert (row["part"], row["volume"]) == ("part", pytest.approx(120 * 90 * 30))
    again = pas.load(tmp_path / "b.pas.json")
    assert again.tree == solid.rectangle(4, 3).extrude(1).scale(30).tree
    assert (tmp_path / "c.csv").read_text().startswith("part,volume (mm^3)")
    code, out, _ = run(capsys, "build", path)
    assert code == 0 and "part  12" in out and "written" not in out


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("-o", "a.stk"), "cannot write a part as 'a.stk'; the suffix must be one of .pas.json, .png, .stl"),
        (("--size", "3 miles"), "unit must be one of"),
        (("--size", "0"), "size must be positive, not 0"),
        (("--scale", "-2"), "scale must be positive, not -2"),
        (("--scale", "2", "--size", "3"), "scale and size are two ways"),
    ],
)
def test_wrong_options_leave_no_file(words, sentence, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "part.toml").write_text(PLATE)
    code, _, err = run(capsys, "build", "part.toml", "-o", "b.stl", *words)
    assert code == 2 and sentence in err
    assert [p.name for p in tmp_path.iterdir()] == ["part.toml"]


@pytest.mark.parametrize(
    ("size", "unit", "factor", "told"),
    [
        (Sizing(), "inch", 1, "inch"),
        (Sizing(scale="1/3"), None, Fraction(1, 3), None),
        (Sizing(size="12"), None, 3, None),
        (Sizing(size="12 cm"), None, 3, "centimeter"),
        (Sizing(size="254mm"), "inch", Fraction(5, 2), "inch"),
    ],
)
def test_sizes_are_exact(size, unit, factor, told):
    box = solid.box((1, 1, 1), (5, 4, 3))
    made, found = size.applied(box, unit)
    assert (made.tree, found) == (box.scale(factor).tree, told)


def test_blends_are_made_solid_before_they_are_scaled():
    with pytest.raises(ValueError, match="scale and size are for solids, assemblies and meshes; <Blend"):
        Sizing(scale="2").applied(solved(EQUAL, 1), None)
