"""Examples are run, and a figure of each is asserted."""

from __future__ import annotations

import runpy
import sys
from functools import cache

import pytest
from conftest import ELBOW, EQUAL, ROOT, UNEQUAL, corner, fair

import pas

CORNERS = ROOT / "examples/corners"
ENERGIES = {
    "elbow_gc1": (4, 41, 23.71),
    "elbow_gc2": (5, 38, 26.45),
    "elbow_slim": (5, 34, 47.70),
    "equal_gc1": (4, 26, 34.69),
    "equal_gc2": (5, 18, 46.19),
    "equal_gc3": (6, 12, 55.40),
    "published_a": (3, 3, 24.365),
    "published_b": (3, 3, 465.28),
    "published_c": (3, 3, 11.328),
    "published_proved": (3, 3, 23.20),
    "three_pipes": (6, 59, 46.75),
    "unequal_gc1": (4, 25, 36.47),
    "unequal_gc2": (6, 59, 46.75),
}
"""Degree, dimension and energy of each problem file."""


SCRIPT = runpy.run_path(str(CORNERS / "corners.py"))


SHARED = {
    "elbow_gc1": (ELBOW, 1),
    "elbow_gc2": (ELBOW, 2),
    "equal_gc1": (EQUAL, 1),
    "equal_gc2": (EQUAL, 2),
    "three_pipes": (UNEQUAL, 2),
    "unequal_gc1": (UNEQUAL, 1),
    "unequal_gc2": (UNEQUAL, 2),
}
"""Problem files whose corners other tests solve, too: radii and order."""

QUICK = ("elbow_gc1", "equal_gc1", "published_a", "published_b", "published_c", "published_proved", "three_pipes")
"""Published ones, and of the others one of each kind."""


@cache
def solved(path):
    """The blend of a corner file, once for all tests of this process."""
    if path.stem not in SHARED:
        return SCRIPT["solve"](path)
    radii, order = SHARED[path.stem]
    problem = pas.read_problem(path)
    assert (list(problem.contacts), problem.order, problem.degree) == (corner(radii), order, None)
    assert problem.options == {"partition": None, "wishes": pas.Wishes()}
    return fair(radii, order)


def test_every_problem_file_has_a_figure_here():
    assert sorted(ENERGIES) == sorted(p.stem for p in CORNERS.glob("*.toml"))


@pytest.mark.parametrize(
    "name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in sorted(ENERGIES)]
)
def test_corner(name):
    blend = solved(CORNERS / f"{name}.toml")
    degree, dimension, energy = ENERGIES[name]
    assert (blend.surface.degree, blend.dimension) == (degree, dimension)
    published = name in ("published_a", "published_b", "published_c")
    assert blend.energy == pytest.approx(energy, rel=1e-3 if name.startswith("published") else 1e-2)
    if not name.startswith("published"):
        assert blend.fairness.within(blend.limits), blend.fairness.beyond(blend.limits)
    assert blend.certificate.proved is not published
    if published:
        assert blend.certificate.one_sheet.status is pas.Status.REFUTED
        assert blend.certificate.enclosed.status is pas.Status.REFUTED
        assert all(v.proved for v in blend.certificate.faces)


@pytest.mark.slow
def test_the_script_draws_them_all(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["corners.py", "-o", str(tmp_path)])
    monkeypatch.setitem(SCRIPT["main"].__globals__, "solve", solved)
    SCRIPT["main"]()
    assert sorted(p.stem for p in tmp_path.glob("*.png")) == sorted(
        [*ENERGIES, "three_pipes_zebra", "three_pipes_gauss", "three_pipes_body"]
    )
    assert capsys.readouterr().out.count("all proved") == 10
