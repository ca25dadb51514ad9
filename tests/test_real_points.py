"""Counting real points exactly, against sympy's roots."""

from __future__ import annotations

import pytest
import sympy

from pas.algebra.curve import has_real_curve
from pas.algebra.ideal import Ideal
from pas.algebra.polynomial import Polynomial
from pas.algebra.zeros import real_zeros

X, Y, Z = sympy.symbols("x y z")


@pytest.mark.parametrize(
    ("generators", "number"),
    [
        (["x^2 - 2", "y - x", "z"], 2),
        (["x^2 + 1", "y", "z"], 0),
        (["x^2", "y", "z"], 1),
        (["(x - 1)^3*(x + 2)", "y^2 - x", "z"], 2),
        (["x^2 + y^2 - 1", "x - y", "z^2 - 4"], 4),
        (["x^2 + y^2 - 1", "x*y - 3", "z"], 0),
        (["x", "x - 1"], 0),
        (["x", "y"], None),
        (["x*y", "z"], None),
    ],
)
def test_known_counts(generators, number):
    found = real_zeros(Ideal(*generators))
    assert (None if found is None else len(found)) == number


@pytest.mark.parametrize("text", ["x^4 - 3*x^2 + 1", "x^5 - x - 1/3", "x^6 + x^3 - 7", "(x^2 - 2)^2*(x - 5)"])
def test_univariate_counts_are_sturms(text):
    real = sympy.Poly(Polynomial(text).to_sympy(), X).sqf_part().count_roots()
    assert len(real_zeros(Ideal(text, "y - x^2", "z - x*y"))) == real


@pytest.mark.parametrize(
    ("surface", "clip", "real"),
    [
        ("x^2 + y^2 - 1", "z", True),
        ("x^2 + y^2 + 1", "z", False),
        ("y^2 + z^2 - 1", "y - 2", False),
        ("x^2 + y^2", "z", False),  # one point, no curve
        ("x^2 - y^2", "z", True),
        ("x^2 + y^2 + z^2 - 1", "x^2 + y^2 - z", True),
        ("((y - 1)^2 + z^2 - 1/4)*((y + 1)^2 + z^2 - 1/4)", "x - 1", True),
        ("y^2 + z^2 - 1", "y - 1", None),  # tangent along a line
    ],
)
def test_real_curves(surface, clip, real):
    assert has_real_curve(Polynomial(surface), Polynomial(clip)) is real
