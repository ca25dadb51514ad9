"""The recipes of CONTRIBUTING.md: their code is run as it stands there, and what it makes is used from end to end."""

from __future__ import annotations

import json
import re
import sys
from argparse import ArgumentParser
from dataclasses import fields
from types import ModuleType

import numpy as np
import pytest
from conftest import ROOT, pipes
from PIL import Image

import pas
from pas import network, solid
from pas.algebra.systems import SYSTEMS
from pas.blending.solving import METHODS
from pas.certify.certificate import Certificate
from pas.certify.proofs import CLAIMS
from pas.cli import main
from pas.cli.common import add_settings, settings_of
from pas.contacts.contact import CONTACTS
from pas.exchange.files import checksum
from pas.exchange.formats import FORMATS
from pas.exchange.picture_options import STYLES
from pas.fairing.energy import ENERGIES
from pas.layouts.kinds import LAYOUTS
from pas.network.lattices import UNIT_CELLS
from pas.partition.cells import PARTITIONS
from pas.settings import MeshSettings, given
from pas.shape import KINDS
from pas.studio import controls as studio
from pas.studio.documents import program, toml

TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
RECIPES = {part.split("\n")[0]: part for part in re.split(r"^### ", TEXT, flags=re.M)[1:]}
REGISTRIES = (CONTACTS, ENERGIES, LAYOUTS, PARTITIONS, FORMATS, CLAIMS, METHODS, SYSTEMS, UNIT_CELLS, STYLES, KINDS)
MOST_FILES = 4
EQUAL = ("1/3", "1/3", "1/3")
CORNER = {"order": 1, "degree": 3, "pipes": [{"axis": a, "radius": "1/3", "clip": 1} for a in ([0, 1, 0], [0, 0, 1])]}


def test_the_way_of_contacts_is_as_it_is_told():
    """In the order in which the functions are first called; at most 25 of them, in at most 14 files."""
    rows = re.findall(r"^\| `pas/(\S+\.py)` \| (`\w+`(?:, `\w+`)*) \|$", TEXT.split("## Layers")[0], flags=re.M)
    told = [(file, name) for file, names in rows for name in re.findall(r"\w+", names)]
    assert 20 < len(told) <= 25 and len({file for file, _ in told}) <= 14
    found: dict[tuple[str, str], None] = {}

    def called(frame, event, _):
        if event == "call":
            *_, owner, name = ("", *frame.f_code.co_qualname.split("."))
            place = (frame.f_code.co_filename.rpartition("/pas/")[2], owner if name == "__init__" else name)
            if place in told and not name[0].isupper():  # the body of a class is a frame as well
                found.setdefault(place)

    contacts = [
        pas.Pipe(axis, radius, "auto") for axis, radius in (((1, 0, 0), "7/6"), ((-1, 2, 0), 1), ((0, -1, 3), 1))
    ]
    before = sys.getprofile()
    sys.setprofile(called)
    try:
        pas.blend(contacts, 1)
    finally:
        sys.setprofile(before)
    assert list(found) == told


@pytest.fixture(autouse=True)
def forgotten(monkeypatch):
    """What a recipe registers is forgotten after its test."""
    monkeypatch.setitem(sys.modules, "recipe", None)
    for registry in REGISTRIES:
        monkeypatch.setattr(registry, "_entries", dict(registry._entries))


def made(title):
    """What the code of a recipe defines, by name."""
    (code,) = re.findall(r"^```python\n(.*?)^```", RECIPES[title], flags=re.M | re.S)
    module = sys.modules["recipe"] = ModuleType("recipe")
    exec(compile(code, f"recipe: {title}", "exec", dont_inherit=True), vars(module))
    return vars(module)


def corner(tmp_path, **tables):
    """The path of a problem file with the tables of `CORNER` and others."""
    path = tmp_path / "corner.toml"
    path.write_text(toml(CORNER | tables))
    return path


def test_there_are_all_recipes():
    things = "A contact, An energy, A layout, A partition, A format, An option of `pas mesh`, A verdict"
    others = "A method of solving, A computer algebra system, A unit cell, A style of pictures, A kind of shape"
    assert list(RECIPES) == [*things.split(", "), "A control of the studio", *others.split(", ")]


CLOSED = {"PROBLEMS", "DOCUMENTS", "MAKERS"}
"""Registries that are asked in their order, and that of what part files take by the names of functions."""


def test_every_registry_has_a_recipe():
    """By its name, which stands in the recipe's code, or in the function that registers for it."""
    sources = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "pas").rglob("*.py"))
    found = re.findall(r"^([A-Z_]+): Registry\[", sources, flags=re.M)
    code = "\n".join(re.findall(r"^```python\n(.*?)^```", TEXT, flags=re.M | re.S))
    code = re.sub(r"pas\.register_(\w+)", lambda m: f"{m[1]}s".replace("ys", "ies").upper(), code)
    assert {name for name in found if name not in code} == CLOSED
    assert all(f"`{name}`" in TEXT for name in CLOSED - {"MAKERS"}) and len(found) == len(set(found)) > 10


@pytest.mark.parametrize("title", RECIPES)
def test_the_files_of_a_recipe_are_few_and_there(title):
    rows = [line for line in RECIPES[title].splitlines() if line.startswith("| `")]
    files = [re.search(r"`([^`]+)`", line)[1] for line in rows]
    assert 2 <= len(files) <= MOST_FILES
    for file in files:
        path = ROOT / file
        assert path.parent.is_dir() if "NAME" in file else path.is_file(), file


def test_a_contact(tmp_path):
    made("A contact")
    rods = [{"radius": "1/3", "clip": 1}]
    problem = pas.read_problem(corner(tmp_path, rods=rods))
    blend = problem.solve()
    assert blend.certificate.proved
    assert blend.surface.polynomials == pas.blend(problem.contacts, 1, 3).surface.polynomials
    assert pas.load(blend.save(tmp_path / "a.pas.json")).surface.polynomials == blend.surface.polynomials
    document = {"kind": "problem", "problem": CORNER | {"rods": rods}}
    found = [c for c in studio.controls(document) if c["path"][:3] == ["problem", "rods", 0]]
    assert [(c["kind"], c["label"]) for c in found] == [("number", "radius"), ("number", "clip")]
    assert 'read_problem("problem.toml")' in program(document["problem"])
    with pytest.raises(pas.ProblemFileError, match=r"unknown key 'radios' in \[rods\]; is 'radius' meant"):
        pas.read_problem(corner(tmp_path, rods=[{"radios": 1, "clip": 1}]))


def test_an_energy(tmp_path):
    area = made("An energy")["Area"]
    rods = {"pipes": [*CORNER["pipes"], {"axis": [1, 0, 0], "radius": "1/3", "clip": 1}]}
    problem = pas.read_problem(corner(tmp_path, **rods, energy={"kind": "plain-area", "power": 2}))
    assert problem.wishes.energy == area(2)
    space = pas.solutions(pipes(EQUAL), 1, 4)
    usual, small = space.fit(), space.fit(energy=pas.CurvatureVariation() + 20 * area(2))
    assert small.surface.mesh(0.02).area < usual.surface.mesh(0.02).area
    assert pas.load(small.save(tmp_path / "a.pas.json")).wishes.energy == small.wishes.energy


def test_a_layout(tmp_path):
    made("A layout")
    rods = {"pipes": [*CORNER["pipes"], {"axis": [1, 0, 0], "radius": "1/3", "clip": 1}]}
    problem = pas.read_problem(corner(tmp_path, **rods, partition={"kind": "doubled"}))
    assert problem.partition == "doubled"
    space = pas.solutions(problem.contacts, 1, 3, problem.partition)
    assert space.partition.to_record() == pas.solutions(pipes(EQUAL), 1, 3, "fan").partition.to_record()
    assert 'partition="doubled"' in program(CORNER | rods | {"partition": {"kind": "doubled"}})


def test_a_partition(tmp_path):
    octants = made("A partition")["Octants"]
    rods = {"pipes": [*CORNER["pipes"], {"axis": [1, 0, 0], "radius": "1/3", "clip": 1}]}
    problem = pas.read_problem(corner(tmp_path, **rods, partition={"kind": "octants", "size": 3}))
    assert problem.partition.vertices == octants(3).vertices
    assert len(octants().interior_faces) == 12
    assert (
        pas.solutions([], 1, 3, partition=octants()).dimension > pas.solutions([], 2, 3, partition=octants()).dimension
    )


def test_a_format(tmp_path, capsys):
    made("A format")
    ball = solid.ball((0, 0, 0), 1)
    path = ball.write(tmp_path / "a.xyz", tolerance=0.1)
    assert np.allclose(np.linalg.norm(np.loadtxt(path), axis=1), 1)
    project = ball.save(tmp_path / "a.pas.json")
    assert main(["mesh", str(project), "-o", str(tmp_path / "b.xyz"), "--tolerance", "0.1"]) == 0
    assert (tmp_path / "b.xyz").read_bytes() == path.read_bytes()
    assert main(["mesh", str(project), "-o", str(tmp_path / "b.zyx")]) == 2
    assert ".xyz" in capsys.readouterr().err
    assert main(["teapot", "-o", str(tmp_path / "b.xyz" / "c.xyz")]) == 2  # no folder is called so


class Smoothed(pas.Shape):
    """A shape that has the option of the recipe."""

    kind = "smoothed"

    @property
    def certificate(self):
        return solid.ball((0, 0, 0), 1).certificate

    def mesh(self, tolerance=None, *, rounds=0):
        return solid.ball((0, 0, 0), 1 + rounds).mesh(tolerance)

    def __str__(self):
        return "a ball"


def test_an_option_of_meshes():
    rounded = made("An option of `pas mesh`")["Rounded"]
    parser = ArgumentParser()
    add_settings(parser, rounded)
    assert "rounds of smoothing (default: none)" in parser.format_help()
    settings = settings_of(rounded, parser.parse_args(["--rounds", "2", "--tolerance", "0.1"]))
    assert given(settings) == {"tolerance": 0.1, "rounds": 2}
    assert np.allclose(np.linalg.norm(Smoothed().meshed(settings).points, axis=1), 3)
    with pytest.raises(ValueError, match=r"rounds is that of a shape of another kind, which <Solid.* is not"):
        solid.ball((0, 0, 0), 1).meshed(settings)
    assert len(fields(rounded)) == len(fields(MeshSettings)) + 1


def test_options_of_meshes_go_through_commands_and_files(tmp_path, capsys):
    """Those that there are: the quality, and how many triangles there may be at most."""
    project = str(solid.cylinder((0, 0, 0), (0, 0, 1), 1).save(tmp_path / "a.pas.json"))
    sizes = {}
    for word in ("angles", "count"):
        assert main(["mesh", project, "-o", str(tmp_path / "a.stl"), "--quality", word, "--json"]) == 0
        sizes[word] = json.loads(capsys.readouterr().out)["triangles"]
    assert sizes["count"] < sizes["angles"]
    assert main(["mesh", project, "-o", str(tmp_path / "a.stl"), "--quality", "best"]) == 2
    assert "quality must be one of 'angles', 'balanced', 'count', not 'best'" in capsys.readouterr().err
    assert main(["mesh", project, "-o", str(tmp_path / "a.stl"), "--max-triangles", "9"]) == 2
    assert "max_triangles is that of a shape of another kind" in capsys.readouterr().err
    rods = {"rods": [{"radius": "1/3", "clip": 1}]}
    made("A contact")
    problem = pas.read_problem(corner(tmp_path, **rods, mesh={"max_triangles": 100, "quality": "count"}))
    assert given(problem.mesh) == {"quality": "count", "max_triangles": 100}
    with pytest.raises(pas.MeshError, match="triangles"):
        problem.solve().meshed(problem.mesh)
    with pytest.raises(pas.ProblemFileError, match=r"max_triangles must be a whole number, not 1\.5"):
        pas.read_problem(corner(tmp_path, **rods, mesh={"max_triangles": 1.5}))


def test_a_verdict(tmp_path):
    blend = pas.blend(pipes(EQUAL), 1, 3)
    old = blend.save(tmp_path / "old.pas.json")
    made("A verdict")
    again = pas.load(old)  # which has no such verdict
    assert again.certificate.verdicts == (*blend.certificate.verdicts, *again.certificate.further)
    (verdict,) = again.certificate.further
    assert verdict.proved and again.certificate.proved and verdict.claim in str(again)
    assert "nothing is stored" in "".join(again.certificate.differences(again.stored))
    new = pas.load(again.save(tmp_path / "new.pas.json"))
    assert new.stored == again.certificate and Certificate.from_record(new.stored.to_record()) == new.stored
    large = replace_numbers(new, 2**70)
    assert [v.claim for v in large.certificate.refuted] == ["small numerators"]


def replace_numbers(blend, factor):
    """The surface of a blend with all its polynomials times a number."""
    f = blend.surface
    return pas.PiecewiseSurface.from_polynomials(f.partition, f.contacts, f.order, [p * factor for p in f.polynomials])


def test_a_control(tmp_path):
    control = made("A control of the studio")["margin_control"]
    document = {"kind": "problem", "problem": {**CORNER, "rods": [{"radius": "1/3", "clip": 1}]}}
    made("A contact")
    (new,) = control(document)
    known = studio.controls(document)
    number = next(c for c in known if c["kind"] == "number")
    assert number.keys() <= new.keys() and new["path"] not in [c["path"] for c in known]
    *way, last = new["path"]
    table = document
    for step in way:
        table = table.setdefault(step, {})
    table[last] = "1/50"
    path = tmp_path / "moved.toml"
    path.write_text(toml(document["problem"]))
    assert pas.read_problem(path).wishes == pas.Wishes(margin="1/50")


def test_a_method():
    made("A method of solving")
    contacts = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + y^2 - 1", "z - 2")]
    found, usual = (pas.solutions(contacts, 1, 4, pas.SingleCell(), method=m) for m in ("ideals", "linear"))
    assert found.dimension == usual.dimension > 1
    assert all(usual.coordinates(member) for member in found.basis)


def test_a_computer_algebra_system():
    made("A computer algebra system")
    ideal = pas.contact_ideal(("x^2 + z^2 - 1", "y - 2"), 1)
    text = ideal.written("cocoa")
    assert text == "use QQ[x, y, z];\nI := ideal(x^2 + z^2 - 1, y^2 - 4*y + 4);\n"
    assert pas.Ideal.of_rows(SYSTEMS["cocoa"].read(text)) == ideal
    with pytest.raises(ValueError, match="modules are not written for CoCoA"):
        pas.syzygies(["x", "y", "z"]).written("cocoa")


def test_a_unit_cell():
    made("A unit cell")
    block = network.lattice("columns", cells=2, radius="1/10")
    assert not block.check() and len(block.classes()) > 1
    assert block.edges.shape == network.lattice(UNIT_CELLS["columns"], cells=2, radius="1/10").edges.shape


def test_a_style(tmp_path):
    made("A style of pictures")
    ball = solid.ball((0, 0, 0), 1)
    views = {}
    for style in ("slope", "plain"):
        path = ball.draw(tmp_path / f"{style}.png", style=style, size=(60, 45), tolerance=0.1, view=(0, -1, 0))
        views[style] = np.asarray(Image.open(path).convert("RGB"), dtype=int)
    top, side = (views["slope"][row, 30] for row in (8, 22))
    assert top[1] > side[1] + 50  # green above, purple at the side
    assert np.abs(views["slope"] - views["plain"]).max() > 50


def test_a_kind(tmp_path, capsys):
    made("A kind of shape")
    ball = KINDS["ball"].type(2)
    path = ball.save(tmp_path / "a.pas.json")
    assert pas.load(path).radius == 2
    assert main(["mesh", str(path), "-o", str(tmp_path / "a.stl"), "--tolerance", "0.1"]) == 0
    assert main(["render", str(path), "-o", str(tmp_path / "a.png")]) == 0
    assert main(["convert", str(path), str(tmp_path / "a.step")]) != 0 and "ball" in capsys.readouterr().err
    record = json.loads(path.read_text())
    record["content"]["radius"] = "two"
    record["sha256"] = checksum(record["content"])
    path.write_text(json.dumps(record))
    with pytest.raises(pas.ProjectFileError, match="radius"):
        pas.load(path)


def test_old_files_need_no_verdicts_that_came_later(tmp_path):
    """A file whose certificate has the first four parts alone is read."""
    path = pas.blend(pipes(EQUAL), 1, 3).save(tmp_path / "a.pas.json")
    record = json.loads(path.read_text())
    assert set(record["content"]["certificate"]) == {"contacts", "faces", "one_sheet", "enclosed"}
    record["content"]["certificate"]["further"] = [{"claim": "x"}]
    record["sha256"] = checksum(record["content"])
    path.write_text(json.dumps(record))
    with pytest.raises(pas.ProjectFileError, match=r"certificate\.further\[0\] has no 'status'"):
        pas.load(path)
