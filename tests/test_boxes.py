"""Surfaces of single polynomials in boxes: what they are, their meshes, bad input."""

from __future__ import annotations

import numpy as np
import pytest

import pas

TORUS = "(x^2 + y^2 + z^2 + 8/9)^2 - 4*(x^2 + y^2)"
BOX = ((-2, -2, -2), (2, 2, 2))


def test_a_polynomial_in_a_box_is_a_surface_like_any_other(tmp_path):
    surface = pas.Polynomial(TORUS).surface(*BOX)
    assert surface.polynomials == (pas.Polynomial(TORUS),)
    assert surface.evaluator.values([[4 / 3, 0, 0]]) == pytest.approx(0, abs=1e-12)
    again = pas.load(surface.save(tmp_path / "torus.pas.json"))
    assert again.polynomials == surface.polynomials
    assert again.partition.box == surface.partition.box
    assert surface.draw(tmp_path / "torus.png", size=(80, 60)).exists()


@pytest.mark.parametrize(
    ("text", "lower", "upper", "words"),
    [
        ("0", *BOX, "constant: it vanishes everywhere"),
        ("3", *BOX, "constant: it vanishes nowhere"),
        ("x", (0, 0, 0), (1, 0, 1), "from 0 to 1, 0 to 0, 0 to 1"),
        ("x", (0, 0, 2), (1, 1, 1), "below the upper one"),
        ("x", (0, 0, 0), (1, 1, float("nan")), r"upper\[2\] must be finite"),
        ("x", (0, 0, float("-inf")), (1, 1, 1), r"lower\[2\] must be finite"),
        ("x", (0, 0), (1, 1, 1), "lower must be three numbers"),
    ],
)
def test_what_is_no_surface_or_no_box(text, lower, upper, words):
    with pytest.raises(ValueError, match=words):
        pas.Polynomial(text).surface(lower, upper)


def test_a_constant_in_a_cell_has_no_mesh():
    surface = pas.PiecewiseSurface.from_polynomials(pas.SingleCell(*BOX), [], 0, ["0"])
    with pytest.raises(pas.MeshError, match="constant in each piece"):
        surface.mesh()
