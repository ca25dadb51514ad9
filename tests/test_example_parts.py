"""The parts of examples/parts: each script is short, and other programs read the same body in what it writes."""

from __future__ import annotations

import runpy
from functools import cache

import pytest
from conftest import ROOT
from test_step import measures, read_solids

import pas
from pas.cli import main

PARTS = ROOT / "examples/parts"
BODIES = {
    "bottle": 1,
    "bracket": 1,
    "enclosure": 2,
    "gear": 1,
    "heatsink": 1,
    "housing": 1,
    "lug": 1,
    "manifold": 1,
    "mug": 1,
    "nameplate": 6,
    "tee": 1,
}
"""How many bodies each has."""


@cache
def script(name):
    return runpy.run_path(str(PARTS / f"{name}.py"))


def test_there_are_ten_short_scripts():
    scripts = {path.stem: path.read_text().splitlines() for path in PARTS.glob("*.py")}
    assert scripts.keys() == BODIES.keys()
    assert len(scripts) >= 10
    assert all(len(lines) <= 30 for lines in scripts.values())
    assert {path.stem for path in PARTS.glob("*.toml")} == scripts.keys() - {"manifold"}  # its flanges follow its ends


@pytest.mark.slow
@pytest.mark.parametrize("name", BODIES)
def test_other_programs_read_the_same_body(name, tmp_path, monkeypatch):
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("OCP")
    monkeypatch.chdir(tmp_path)
    part = runpy.run_path(str(PARTS / f"{name}.py"), run_name="__main__")["part"]
    assert {path.name for path in tmp_path.iterdir()} == {f"{name}.png", f"{name}.3mf", f"{name}.step"}
    shapes = part.parts.values() if isinstance(part, pas.solid.Assembly) else [part]
    volume = sum(shape.mesh().volume for shape in shapes)
    meshes = trimesh.load(tmp_path / f"{name}.3mf").geometry.values()
    assert all(mesh.is_watertight for mesh in meshes)
    assert sum(mesh.volume for mesh in meshes) == pytest.approx(volume, rel=0.02)
    solids, _ = read_solids(tmp_path / f"{name}.step")
    assert len(solids) == BODIES[name]
    assert sum(measures(solid)[0] for solid in solids) == pytest.approx(volume, rel=0.02)


FILES = sorted(path.stem for path in PARTS.glob("*.toml"))
TOLERANCES = {"lug": 0.2, "tee": 0.2}
"""Of the files that say one."""
QUICK_FILES = ("heatsink",)


@pytest.mark.parametrize(
    "name", [name if name in QUICK_FILES else pytest.param(name, marks=pytest.mark.slow) for name in FILES]
)
def test_files_make_the_parts_of_the_scripts(name, tmp_path):
    written, picture = tmp_path / "a.stl", tmp_path / "a.png"
    assert main(["build", str(PARTS / f"{name}.toml"), "-o", str(written), "-o", str(picture)]) in (0, 1)
    part = script(name)["part"]
    shapes = part.parts.values() if isinstance(part, pas.solid.Assembly) else [part]
    trimesh = pytest.importorskip("trimesh")
    volume = sum(shape.mesh(TOLERANCES.get(name)).volume for shape in shapes)
    assert trimesh.load(written).volume == pytest.approx(volume, rel=1e-6)
    assert picture.exists()
