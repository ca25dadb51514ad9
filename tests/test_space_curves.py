"""Exact real points, arcs and components of space curves."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, pairwise
from math import floor
from random import Random

import numpy as np
import pytest
from flint import fmpq, fmpq_poly

from pas import Ideal, Polynomial
from pas.algebra.components import Components
from pas.algebra.curve import SpaceCurve, SplitError
from pas.algebra.roots import RealRoot, between, rational_root, real_roots, simplest
from pas.algebra.zeros import linear_form, linear_forms, real_zeros, values_at_zeros

X, Y, Z = (Polynomial(v) for v in "xyz")


def fraction(value: fmpq) -> Fraction:
    return Fraction(int(value.p), int(value.q))


def test_roots_are_told_apart_however_close():
    tiny = fmpq(1, 10**60)
    polynomial = fmpq_poly([-2, 0, 1]) * fmpq_poly([-2 - tiny, 0, 1]) * fmpq_poly([0, 1]) * fmpq_poly([1, 0, 1])
    roots = sorted(real_roots(polynomial * fmpq_poly([-2, 0, 1])))
    assert len(roots) == 5
    for low, high in pairwise([None, *roots, None]):
        value = rational_root(between(low, high))
        assert low is None or low < value
        assert high is None or value < high
    assert roots[0].bounds(300)[0] ** 2 - 2 - tiny < fmpq(1, 10**80)


@pytest.mark.parametrize("seed", range(20))
def test_simplest_fractions(seed):
    random = Random(seed)
    low = fmpq(random.randint(-50, 50), random.randint(1, 30))
    high = low + fmpq(random.randint(1, 20), random.randint(1, 1000))
    found = fraction(simplest(low, high))
    assert fraction(low) < found < fraction(high)
    for d in range(1, found.denominator):
        assert Fraction(floor(fraction(low) * d) + 1, d) >= fraction(high)


@pytest.mark.parametrize(
    ("generators", "points"),
    [
        (["x^2 - 2", "y - x", "z"], [(-(2**0.5), -(2**0.5), 0), (2**0.5, 2**0.5, 0)]),
        (["x^2", "y^2", "z"], [(0, 0, 0)]),
        (["(x - 1)^3*(x + 2)", "y^2 - x", "z - y"], [(1, -1, -1), (1, 1, 1)]),
        (["x^2 - y^2", "y^2 - z^2", "x^2 - 1"], [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]),
        (["x^2*(x - 1)", "(y - x)^2", "z^2 - y + x"], [(0, 0, 0), (1, 1, 0)]),
        (["x^2 + 1", "y", "z"], []),
        (["x", "x - 1"], []),
    ],
)
def test_zeros_have_exact_signs(generators, points):
    zeros = real_zeros(Ideal(*generators))
    assert np.array(sorted(z.point for z in zeros)) == pytest.approx(np.array(sorted(points)))
    for zero in zeros:
        x, y, _ = zero.point
        assert zero.sign(X * X - Y * Y) == 0
        assert zero.sign(X - Y) == (x > y + 1e-9) - (x < y - 1e-9)
        assert zero.sign(X * X - Y * Y + Fraction(1, 10**200)) == 1
    assert real_zeros(Ideal("x", "y")) is None
    assert values_at_zeros(Ideal("x", "y"), next(linear_forms())) is None


def test_ideals_are_saturated():
    assert Ideal("x*y", "x*z").saturated("x") == Ideal("y", "z")
    assert Ideal("x^2*y", "z").saturated("x") == Ideal("y", "z")
    assert Ideal("x", "y").saturated("x").is_whole_ring


def on_arcs(curve: SpaceCurve) -> list:
    """A point of each arc, with its plane."""
    turns = sorted(set(curve.whole.turns))
    return [(v, p) for v in (between(*slab) for slab in pairwise([None, *turns, None])) for p in curve.whole.points(v)]


@pytest.mark.parametrize(
    ("g", "h", "arcs", "components"),
    [
        ("x^2 + y^2 - 1", "z", 2, 1),
        ("x^2 + y^2 + 1", "z", 0, 0),
        ("x^2 + y^2", "z", 0, 0),  # a point
        ("x", "y", 1, 1),
        ("x*y - 1", "z", None, 2),
        ("x*y", "z", 4, 1),
        ("y^2 - x^3 + x", "z", None, 2),
        ("y^2 - x^3", "z", None, 1),  # a cusp
        ("y^2 - x^3 + x^2", "z", None, 1),  # with an isolated point
        ("y - x^2", "z - x^3", None, 1),
        ("x^2 + y^2 + z^2 - 1", "x^2 + y^2 - 1/4", None, 2),
        ("x^2 + y^2 + z^2 - 1", "(x - 1/2)^2 + y^2 - 1/4", None, 1),  # Viviani
        ("x^2 + y^2 + z^2 - 1", "(x - 1/2)^2 + y^2 - 1/4 + 1/10^30", None, 2),
        ("x^2 + y^2 + z^2 - 1", "(x - 1/2)^2 + y^2 - 1/4 - 1/10^30", None, 1),
    ],
)
def test_arcs_and_components(g, h, arcs, components):
    curve = SpaceCurve(Polynomial(g), Polynomial(h))
    found = on_arcs(curve)
    assert arcs is None or len(found) == arcs
    assert all(p.sign(q) == 0 and p.sign(curve.form - Polynomial(v)) == 0 for v, p in found for q in curve.pair)
    assert len(set(Components(curve).of(found))) == components


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.sampled(4)
def test_components_of_circles_are_those_that_meet(seed):
    random = Random(seed)
    circles = []
    while len(circles) < 3:
        x, y, r = random.randint(-4, 4), random.randint(-4, 4), Fraction(random.randint(1, 8), random.choice((1, 2)))
        if all((x, y, r) != c for c in circles):
            circles.append((x, y, r))
    x, y, r = circles[0]
    if seed % 2:  # one that touches the first, or nearly does
        circles[1] = (x + 9, y, 9 - r + random.choice((0, Fraction(1, 10**12), -Fraction(1, 10**12))))
    curves = [(X - x) ** 2 + (Y - y) ** 2 - r * r for x, y, r in circles]
    curve = SpaceCurve(curves[0] * curves[1] * curves[2], Z - X * Fraction(1, 3))
    of = list(range(3))
    for i, j in combinations(range(3), 2):
        d2 = (circles[i][0] - circles[j][0]) ** 2 + (circles[i][1] - circles[j][1]) ** 2
        a, b = circles[i][2], circles[j][2]
        if (a - b) ** 2 <= d2 <= (a + b) ** 2:
            of = [of[i] if k == of[j] else k for k in of]
    found = on_arcs(curve)
    labels = Components(curve).of(found)
    own = [of[next(i for i, c in enumerate(curves) if p.sign(c) == 0)] for _, p in found]
    assert set(own) == set(of)
    assert len(set(zip(labels, own, strict=True))) == len(set(labels)) == len(set(own))


def test_components_are_followed_where_their_points_change_places():
    """Two skew lines, whose points have one value of x + 6y + 36z, by which they are ordered first, where t = -41."""
    curve = SpaceCurve(Z * (Z - 1), Y - X * Z)
    found = [(fmpq(t), p) for t in (-100, 0) for p in curve.whole.points(fmpq(t))]
    lines = [p.sign(Z) for _, p in found]
    labels = Components(curve).of(found)
    assert sorted(lines) == [0, 0, 1, 1]
    assert len(set(labels)) == len(set(zip(labels, lines, strict=True))) == 2


def test_forms_are_changed_where_a_line_lies_in_their_planes():
    a, b, _ = next(linear_forms())
    curve = SpaceCurve(X * a + Y * b, Z)  # a line on which the first form is 0
    assert curve.linear != next(linear_forms())
    assert len(on_arcs(curve)) == 1
    hyperbola = SpaceCurve(linear_form(next(linear_forms())) * X - 1, Z)
    assert hyperbola.linear != next(linear_forms())
    assert len(set(Components(hyperbola).of(on_arcs(hyperbola)))) == 2


def test_parts_split_where_a_polynomial_vanishes_on_one_component():
    curve = SpaceCurve(X * X + Y * Y + Z * Z - 1, X * X + Y * Y - Fraction(9, 25))
    with pytest.raises(SplitError) as error:
        curve.whole.contains(Z - Fraction(4, 5))
    on, off = curve.whole.split(error.value.polynomial)
    assert on.contains(Z - Fraction(4, 5))
    assert off.contains(Z + Fraction(4, 5))
    assert not off.contains(Z - Fraction(4, 5))
    assert off.crossings(Z - Fraction(4, 5)) == []
    assert len(off.points(fmpq(0))) + len(on.points(fmpq(0))) == len(curve.whole.points(fmpq(0)))
    cut = on.crossings(X)
    assert len(cut) == 2
    assert isinstance(cut[0], RealRoot)


@pytest.mark.parametrize(("g", "h"), [("y^2 + z^2 - 1", "y - 1"), ("(z^2 - x)*(y^2 + x^2 - 1)", "x*z")])
def test_curves_that_are_not_reduced_say_so(g, h):
    parts, whole = [], [SpaceCurve(Polynomial(g), Polynomial(h)).whole]
    while whole:
        part = whole.pop()
        try:
            parts.append(part.turns is not None)
        except SplitError as error:
            whole += part.split(error.polynomial)
    assert False in parts
