"""The parametric examples are run, and figures of each are asserted."""

from __future__ import annotations

import re
import runpy
import sys

import numpy as np
import pytest
from conftest import ROOT

import pas

FOLDER = ROOT / "examples/parametric"
SLOW = {"input_IV", "input_VII"}
BLENDS = {
    "example_1": (2, (3, 5), "refuted", 1),
    "example_2": (2, (2, 5), "proved", 2),
    "example_2_weights": (2, (2, 6), "proved", 2),
    "example_3": (1, (2, 5), "proved", 2),
    "example_3_weights": (1, (6, 17), "holds, measured", 2),
    "input_I": (2, (4, 5), "proved", 2),
    "input_II": (8, (2, 17), "undecided", 2),
    "input_III": (5, (2, 11), "proved", 1),
    "input_IV": (4, (25, 9), "holds, measured", 1),
    "input_VII": (2, (6, 11), "proved", 1),
    "input_VIII": (1, (5, 7), "refuted", 1),
}
"""Order, degrees, verdict on regularity and number of Bezier patches of each exact problem file."""


@pytest.fixture(scope="module")
def script():
    return runpy.run_path(str(FOLDER / "parametric.py"))


def test_every_problem_file_has_figures_and_a_picture():
    names = {p.stem for p in FOLDER.glob("*.toml")}
    assert names == {*BLENDS, "wavy_pipes"}
    assert names == {p.stem for p in (FOLDER / "pictures").glob("*.png")}
    assert all(p.stat().st_size < 200_000 for p in (FOLDER / "pictures").glob("*.png"))


def test_links_of_the_readme_exist():
    for link in re.findall(r"\]\(([^)#:]+)\)", (FOLDER / "README.md").read_text()):
        assert (FOLDER / link).exists(), link


@pytest.mark.sampled(9)
@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow if n in SLOW else ()) for n in BLENDS])
def test_blend(script, name):
    order, degrees, regular, number = BLENDS[name]
    blend = script["solve"](FOLDER / f"{name}.toml")
    assert (blend.order, blend.surface.degrees) == (order, degrees)
    certificate = blend.prove(effort=20_000 if name == "example_3" else 2000)
    assert all(verdict.proved for verdict in certificate.contacts)
    assert certificate.regular.status.value == regular
    mesh = blend.mesh()
    assert mesh.certified
    assert mesh.deviation <= 1.001e-3 * np.ptp(mesh.points, axis=0).max()
    patches = script["patches"](blend)
    assert len(patches) == number
    assert all(p.surface().components == blend.surface.components for p in patches)


def test_sines(script):
    blend = script["solve"](FOLDER / "wavy_pipes.toml")
    mesh = blend.mesh()
    assert not mesh.certified
    assert (mesh.euler_characteristic, mesh.is_manifold) == (0, True)
    (patch,) = script["patches"](blend)
    assert patch.deviation < 5e-3
    assert "differ by" in blend.prove().contacts[0].reason


@pytest.mark.slow
def test_the_script_draws_them_all(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["parametric.py", "-o", str(tmp_path)])
    runpy.run_path(str(FOLDER / "parametric.py"), run_name="__main__")
    assert sorted(p.stem for p in tmp_path.glob("*.png")) == sorted([*BLENDS, "wavy_pipes"])
    assert capsys.readouterr().out.count("contacts proved") == len(BLENDS)


def test_problem_files_say_what_was_published():
    """The files' surfaces are those of the verified data."""
    import json

    facts = json.loads((ROOT / "tests/data/parametric.json").read_text())
    for name in BLENDS:
        key = name.removesuffix("_weights")
        case = facts["ex" + key[-1]] if key.startswith("example") else facts["inputs"][key.removeprefix("input_")]
        found = pas.read_parametric_problem(FOLDER / f"{name}.toml").data.surfaces
        assert [s.components for s in found] == [pas.ParametricSurface(*p).components for p in case["P"]]
