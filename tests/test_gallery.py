"""The gallery's scripts are run, each with its picture, and a figure of each is asserted."""

from __future__ import annotations

import runpy
from fractions import Fraction

import pytest
from conftest import ROOT

GALLERY = ROOT / "examples/gallery"


def run(name, tmp_path):
    picture = tmp_path / f"{name}.png"
    result = runpy.run_path(str(GALLERY / f"{name}.py"))["main"](picture)
    assert picture.stat().st_size > 10_000
    return result


def test_every_script_has_a_picture_and_a_test():
    names = {p.stem for p in GALLERY.glob("*.py")}
    assert names == {p.stem for p in (GALLERY / "pictures").glob("*.png")}
    assert names == {name.removeprefix("test_") for name in globals() if name.startswith("test_")} - {
        "every_script_has_a_picture_and_a_test"
    }


def test_coaxial_cylinders(tmp_path, capsys):
    best = run("coaxial_cylinders", tmp_path)
    assert best.energy == Fraction(3091077120, 8535169)
    out = capsys.readouterr().out
    assert "{2: 0, 3: 2, 4: 9, 5: 22}" in out
    assert "99120/41" in out
    assert out.count("proved") == 4


def test_perpendicular_cylinders(tmp_path, capsys):
    optimum, blend = run("perpendicular_cylinders", tmp_path)
    assert float(optimum.energy) == pytest.approx(449.23, abs=0.01)
    assert (blend.surface.degree, blend.dimension, blend.certificate.proved) == (4, 7, True)
    assert "d1**2 - d2**2 + r1**2 - r2**2" in capsys.readouterr().out


@pytest.mark.slow
def test_three_cylinders(tmp_path, capsys):
    blend = run("three_cylinders", tmp_path)
    assert (blend.surface.degree, blend.dimension, blend.certificate.proved) == (5, 9, True)
    out = capsys.readouterr().out
    assert out.count("degree 4, dimension 2") == 4
    assert "1 of 2 dimensions are singular along contact 3" in out


def test_two_hemispheres(tmp_path):
    fit, blend = run("two_hemispheres", tmp_path)
    assert fit.quotient == pytest.approx(9.8700981328e-6, rel=1e-9)
    assert (blend.surface.degree, blend.surface.order, blend.certificate.proved) == (4, 2, True)


def test_reducible_contact(tmp_path):
    equal, blend = run("reducible_contact", tmp_path)
    assert equal
    assert (blend.dimension, len(blend.certificate.contacts), blend.certificate.proved) == (2, 4, True)


def test_elliptic_cylinders(tmp_path):
    blend = run("elliptic_cylinders", tmp_path)
    assert (blend.surface.degree, blend.dimension, blend.certificate.proved) == (5, 6, True)
