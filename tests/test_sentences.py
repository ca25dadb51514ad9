"""What users get wrong most easily, each answered with one sentence that says what would be right."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from conftest import EQUAL, ROOT, pipes, solved

import pas
from pas import solid
from pas.cli import INTERRUPTED, main

PROBLEM = str(ROOT / "examples/corners/equal_gc1.toml")
PARAMETRIC = str(ROOT / "examples/parametric/wavy_pipes.toml")


def blend():
    return solved(EQUAL, 1)


CALLS = [
    (lambda: pas.blend(pipes()[0], 1), TypeError, "contacts must be a list of pipes"),
    (lambda: pas.blend(None, 1), TypeError, "contacts must be a list of pipes"),
    (lambda: pas.blend("pipe", 1), TypeError, "contacts must be a list of pipes"),
    (lambda: pas.blend(pipes(), 0), ValueError, "order must be at least 1 where the region has several pieces"),
    (lambda: pas.blend([*pipes()[:2], pipes()[0]], 1), pas.GeometryError, "contacts 1 and 3 end in the same curve"),
    (
        lambda: pas.blend(pipes()[:1], 1),
        pas.GeometryError,
        "two contacts or more, and here is one.*pas.SingleCell",
    ),
    (lambda: pas.write_solid("b.stl", solid.ball((0, 0, 0), 1)), TypeError, "is written to a path such as 'name.stl'"),
    (lambda: pas.write_mesh("b.stl", None), TypeError, "a shape is written to a path such as 'name.stl', not to None"),
    (lambda: pas.save_solid("b.pas.json", solid.ball((0, 0, 0), 1)), TypeError, "is written to a path such as"),
    (lambda: blend().save("a\0b.pas.json"), ValueError, "has a null character in it"),
    (lambda: blend().save("a" * 300 + ".pas.json"), ValueError, "is too long"),
    (lambda: blend().save("/proc/a.pas.json"), ValueError, "nothing can be written to the folder /proc"),
    (lambda: pas.load("a\0b"), ValueError, "has a null character in it"),
    (lambda: pas.load("a" * 300), ValueError, "is too long"),
    (lambda: pas.load(3), TypeError, "the file must be given by its name, not by 3"),
    (lambda: pas.read_problem("a\0b"), ValueError, "has a null character in it"),
    (lambda: pas.write_step(blend(), "a.step"), TypeError, "is neither; write the solid that it bounds, as in shape"),
    (lambda: pas.draw(None, "/proc/a.png"), ValueError, "nothing can be written to the folder /proc"),
    (lambda: pas.blend(pipes(), 1, "lowset"), TypeError, "from 1 to 12, not 'lowset'; or \"lowest\""),
    (
        lambda: pas.blend(pipes(), 1, np.array([3, 4])),
        TypeError,
        "^degree must be a whole number from 1 to 12, not arr",
    ),
    (
        lambda: pas.blend(pipes(), 1, wishes={"tension": 1}),
        TypeError,
        r"^wishes must be pas.Wishes\(...\) or None, not {",
    ),
    (lambda: blend().space.fit({"tension": 1}), TypeError, r"^wishes must be pas.Wishes\(...\) or None, not {"),
    (lambda: pas.blend(pipes(), 1, prove="no"), TypeError, "^prove must be True or False, not 'no'"),
    (lambda: pas.blend(pipes(), 1, guard=1), TypeError, "^guard must be True or False, not 1"),
    (lambda: pas.blend(pipes(), 1, handles=5), ValueError, "^handles must map .* to values, .* not 5"),
    (lambda: pas.blend(pipes(), 1, 3, basis=5), TypeError, "^basis must be a sequence of members, .* not 5"),
    (lambda: pas.blend(pipes(), 1, 3, basis=[]), ValueError, "^basis must have at least one member"),
    (
        lambda: pas.blend(pipes(), 1, on_stage="x"),
        TypeError,
        "^on_stage must be a function of a stage's name and seconds",
    ),
    (lambda: pas.blend(pipes(), 1, tension="1e400"), ValueError, "^tension must be below 1.8e[+]308, not "),
    (lambda: pas.FairnessLimits(bulge="1e400"), ValueError, "^bulge must be below 1.8e[+]308, not "),
    (
        lambda: blend().refit(energy=pas.ThinPlate()),
        TypeError,
        "^there is no option 'energy' here; there are inside, out",
    ),
    (lambda: blend().fairness.within({"bulge": 1}), TypeError, r"^limits must be pas.FairnessLimits\(...\), not {"),
    (lambda: blend().space.least_squares(5), TypeError, "^points must be a sequence of points, each three numbers"),
    (lambda: blend().draw("a.png", mesh=3), TypeError, "^mesh must be a pas.Mesh or map names of parts to such, not 3"),
    (lambda: blend().draw("a.png", size=3), TypeError, "^size must be width and height in pixels, .*, not 3"),
    (lambda: blend().draw("a.png", size=(0, 1)), ValueError, r"^size\[0\] must be a whole number from 1 to"),
    (lambda: blend().draw("a.png", view="topp"), ValueError, "^there is no view 'topp'; is 'top' meant"),
    (lambda: blend().draw("a.png", view=(0, 0, 0)), ValueError, "^view must not be the zero vector"),
    (lambda: blend().draw("a.png", cut="x"), ValueError, "^there is no cut 'x'; there are front"),
]


@pytest.mark.sampled(4)
@pytest.mark.parametrize("number", range(len(CALLS)))
def test_a_call_is_answered_with_a_sentence(number, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call, kind, said = CALLS[number]
    with pytest.raises(kind, match=said):
        call()
    assert list(tmp_path.iterdir()) == []


def test_step_takes_the_domain_that_it_asks_for(tmp_path):
    data = pas.BlendingData([pas.elliptic_cylinder(1, 1), pas.elliptic_cylinder(2, 2)], values=[0, 1])
    neck = pas.hermite_blend(data, order=1)
    with pytest.raises(ValueError, match=r"give a finite one, such as domain="):
        pas.write_step(neck, tmp_path / "neck.step")
    try:
        pas.write_step(neck, tmp_path / "neck.step", domain=((-1, 1), (0, 1)))
    except pas.MissingLibraryError as error:
        assert "pip install 'pas[step]'" in str(error)
    else:
        assert (tmp_path / "neck.step").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["belnd", PROBLEM], "there is no command 'belnd'; is 'blend' meant?"),
        (["blend", PROBLEM, "--tolerence=3"], "--tolerence=3; is '--tolerance' meant?"),
        (["blend", "corner.pas.json"], "is a project, solved already"),
        (["solve", "corner.pas.json"], "is a project, solved already"),
        (["parametric", "corner.pas.json"], "is a project, solved already"),
        (["solve", PARAMETRIC], "a problem of the kind 'parametric', not 'corner'"),
        (["blend", PARAMETRIC, "--degree", "3"], "has the degree that its data give it; leave out --degree"),
        (["mesh", PROBLEM, "-o", "a.stl"], "is a problem file"),
        (["render", PROBLEM, "-o", "a.png"], "is a problem file"),
        (["convert", PROBLEM, "a.stl"], "is a problem file"),
        (["blend", PROBLEM, "-o", "/proc/new"], "nothing can be written to the folder /proc"),
        (["blend", PROBLEM, "-o", "corner.stl"], "corner.stl is not a folder"),
        (["mesh", "MADE", "-o", "o.3mf"], "a blend's solid can, see `pas convert`"),
        (["mesh", "MADE", "-o", "/proc/o.stl"], "nothing can be written to the folder /proc"),
        (["render", "MADE", "-o", "/proc/o.png"], "nothing can be written to the folder /proc"),
        (["convert", "MADE", "/proc/o.stl"], "nothing can be written to the folder /proc"),
    ],
)
def test_a_command_is_answered_with_a_sentence(arguments, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    made = str(blend().save(tmp_path / "made.pas.json"))
    try:
        code = main([made if a == "MADE" else a for a in arguments])
    except SystemExit as end:  # argparse's own
        code = end.code
    assert code == 2
    last = capsys.readouterr().err.splitlines()[-1]
    assert said in last
    assert [p.name for p in tmp_path.iterdir()] == ["made.pas.json"]


def test_ctrl_c_ends_with_130(tmp_path):
    """The signal comes while the command runs, which would take a minute; nothing is left."""
    import signal

    code = """
import sys, time
from pas.cli import main
from pas.pipeline import search
search.solve = lambda *_: print('up', flush=True) or time.sleep(60)
sys.exit(main(sys.argv[1:]))
"""
    command = [sys.executable, "-c", code, "blend", str(ROOT / "examples/corners/three_pipes.toml"), "-o", "out"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background
    try:
        process = subprocess.Popen(command, cwd=tmp_path, **pipes)
    finally:
        signal.signal(signal.SIGINT, before)
    with process:
        assert process.stdout.readline() == "up\n"
        process.send_signal(signal.SIGINT)
        error = process.communicate(timeout=60)[1]
    assert process.returncode == INTERRUPTED == 130
    assert "pas: interrupted; nothing was left half-written" in error
    assert list(tmp_path.iterdir()) == []


GUESSED = [
    ("solid.sphere", "pas.solid has no 'sphere'; is 'ball' meant?"),
    ("solid.cube", "pas.solid has no 'cube'; is 'box' meant?"),
    ("solid.difference", "pas.solid has no 'difference'; it is written a - b"),
    ("pas.sphere", "pas has no 'sphere'; is 'solid.ball' meant?"),
    ("pas.box", "pas has no 'box'; is 'solid.box' meant?"),
    ("pas.cylinder", "pas has no 'cylinder'; is 'solid.cylinder' meant?"),
    ("pas.cube", "pas has no 'cube'; is 'solid.box' meant?"),
    ("ball.export", "a solid has no 'export'; is 'write' meant?"),
    ("ball.filet", "a solid has no 'filet'; is 'fillet' meant?"),
    ("ball.cut", "a solid has no 'cut'; it is written a - b"),
    ("ball.fuse", "a solid has no 'fuse'; it is written a | b"),
    ("ball.color", "a solid has no 'color'; it is written solid.assembly(name=(shape, '#rrggbb'))"),
    ("ball.centroid", "a solid has no 'centroid'; is 'measures' meant?"),
    ("solid.circle((0, 0), 1).linear_extrude", "a profile has no 'linear_extrude'; is 'extrude' meant?"),
    ("solid.sweep", "pas.solid has no 'sweep'; is 'pipe' meant?"),
    (
        "solid.sketch((0, 0)).line_to(4, 0).line_to(4, 1).extrude",
        "an open sketch has no 'extrude', its profile has: close() goes from (4, 1) back to (0, 0)",
    ),
    ("solid.sketch((0, 0)).lineto", "a sketch has no 'lineto'; is 'line_to' meant?"),
    ("solid.circle((0, 0), 1).fillet", "a profile has no 'fillet'; it is flat: extrude or revolve it first"),
    ("solid.assembly(a=ball).export", "an assembly has no 'export'; is 'write' meant?"),
]


@pytest.mark.parametrize(("code", "sentence"), GUESSED)
def test_names_that_other_programs_have_are_told_as_they_are_here(code, sentence):
    with pytest.raises(AttributeError) as caught:
        eval(code, {"pas": pas, "solid": solid, "ball": solid.ball((0, 0, 0), 1)})
    assert str(caught.value) == sentence


def test_all_words_of_other_programs_lead_to_names_that_are_there():
    from pas.errors import ELSEWHERE

    known = {
        *solid.__all__,
        *(n for made in (solid.Solid, solid.Profile, solid.Sketch) for n in dir(made)),
        "difference",
    }
    assert {here for here in ELSEWHERE if here.isidentifier()} <= known


def test_an_error_in_a_property_is_its_own():
    class Broken(solid.Solid):
        @property
        def length(self):
            return self.nothing

    with pytest.raises(AttributeError, match="a solid has no 'nothing'"):
        _ = Broken(solid.ball((0, 0, 0), 1).tree).length
    assert not hasattr(solid.ball((0, 0, 0), 1), "__array__")
