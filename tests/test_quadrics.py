"""Quadrics: kinds, plane sections, and intersections of two."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy
from flint import fmpq_mat
from hypothesis import example, given, settings
from hypothesis import strategies as st

import pas
from pas import Polynomial, plane_section, quadric_intersection
from pas.errors import GeometryError
from pas.parametric.generatrix.quadric import Quadric, QuadricKind, inertia, members, planes_of, to_array
from pas.parametric.generatrix.sections import conic_section, ellipse_bounds

S = np.linspace(0, 1, 201)
KINDS = {
    "x^2 + y^2/4 + z^2/9 - 1": "ellipsoid",
    "x^2 + y^2/4 - 1": "elliptic cylinder",
    "x^2 + y^2/4 - z^2": "elliptic cone",
    "x^2 + y^2/4 - z": "elliptic paraboloid",
    "x^2 + y^2/4 - z^2 - 1": "hyperboloid of one sheet",
    "x^2 + y^2/4 - z^2 + 1": "hyperboloid of two sheets",
    "x^2 - y^2/4 - z": "hyperbolic paraboloid",
    "x^2 - y^2/4 - 1": "hyperbolic cylinder",
    "x^2 - y": "parabolic cylinder",
    "x^2 - y^2": "pair of planes",
    "x^2 - 1": "pair of planes",
    "x^2": "double plane",
    "x^2 + y^2": "straight line",
    "x^2 + y^2 + z^2": "point",
    "x^2 + y^2 + z^2 + 1": "empty set",
    "x^2 + y^2 + 1": "empty set",
    "x^2 + 1": "empty set",
}
CLOSED = list(KINDS)[:6]
numbers = st.integers(-3, 3)
motions = st.tuples(numbers, numbers, numbers, numbers, numbers, numbers)


def moved(polynomial, quaternion_and_shift) -> Polynomial:
    """The quadric rotated rationally (Cayley) and shifted."""
    a, b, c, *shift = quaternion_and_shift
    x = sympy.Matrix([[0, -c, b], [c, 0, -a], [-b, a, 0]]) / 2
    rotation = (sympy.eye(3) - x) * (sympy.eye(3) + x).inv()
    variables = [Polynomial(v) for v in "xyz"]
    images = [
        sum((variables[j] * Fraction(str(rotation[j, i])) for j in range(3)), Polynomial(Fraction(shift[i], 3)))
        for i in range(3)
    ]
    return Polynomial(polynomial).compose(*images)


def residual(polynomial, points) -> float:
    """The greatest distance |f| / |grad f|, over the size of the points."""
    f = Polynomial(polynomial)
    away = np.abs(f(points)) / np.linalg.norm(f.gradient(points), axis=-1)
    return float((away / (1 + np.abs(points).max())).max())


def smooth(curve) -> float:
    """The greatest relative error of the derivative against differences."""
    s, h = S[1:-1], 1e-5
    change = (curve(s + h) - curve(s - h)) / (2 * h)
    exact = curve.derivative(s)
    return float((np.linalg.norm(change - exact, axis=-1) / np.linalg.norm(exact, axis=-1)).max())


@pytest.mark.parametrize(("text", "kind"), KINDS.items())
@pytest.mark.parametrize("sign", [1, -1])
def test_kinds(text, kind, sign):
    assert Quadric(Polynomial(text) * sign).kind is QuadricKind(kind)
    assert Quadric(moved(Polynomial(text) * sign, (1, -2, 1, 3, -1, 2))).kind is QuadricKind(kind)


@given(st.lists(st.integers(-3, 3), min_size=10, max_size=10))
@settings(max_examples=60, deadline=None)
def test_inertia_against_eigenvalues(entries):
    rows = [[0] * 4 for _ in range(4)]
    for (i, j), value in zip(((a, b) for a in range(4) for b in range(a + 1)), entries, strict=True):
        rows[i][j] = rows[j][i] = value
    values = np.linalg.eigvalsh(np.array(rows, dtype=float))
    assert inertia(fmpq_mat(rows)) == (int((values > 1e-9).sum()), int((values < -1e-9).sum()))


def test_matrix_is_that_of_the_polynomial():
    f = Polynomial("x^2 - 3*x*y + y*z/7 + 2*z - 5")
    q, p = to_array(Quadric(f).matrix), np.array([0.3, -1.1, 2.5, 1])
    assert p @ q @ p == pytest.approx(float(f(p[:3])))


@pytest.mark.parametrize("text", CLOSED)
@given(motions, st.tuples(numbers, numbers, numbers, st.integers(-6, 6)))
@example((-2, -3, 0, 0, 0, 0), (-3, -1, -3, 0))  # of the paraboloid an ellipse of 13 761: a distance is a length
@settings(max_examples=12, deadline=None)
def test_sections_lie_on_both(text, motion, plane):
    """Whatever the position, a section is a curve on both, or an error that says what it is."""
    f = moved(text, motion)
    h = Polynomial(f"{plane[0]}*x + {plane[1]}*y + {plane[2]}*z + {plane[3]}/4")
    if h.degree != 1:
        return
    try:
        curve = plane_section(f, h, interval=(-1, 1.5))
    except GeometryError as error:
        assert any(word in str(error) for word in ("empty", "one point", "line"))
        return
    points = curve(S)
    assert residual(f, points) < 1e-12 and residual(h, points) < 1e-12
    assert smooth(curve) < 1e-6
    if curve.closed:
        size = 1 + np.abs(points).max()
        np.testing.assert_allclose(points[0], points[-1], atol=1e-12 * size)
        assert curve.bounds().angle < 1e-9 and curve.bounds().distance < 1e-11 * size


@pytest.mark.parametrize(
    ("quadric", "plane", "half_axes"),
    [
        ("x^2 + y^2 - 1", "z - 3", (1, 1)),
        ("x^2 + y^2 - 1", "z - x", (1, math.sqrt(2))),
        ("x^2/4 + y^2 - z^2", "z - 2", (2, 4)),
        ("x^2 + y^2 + z^2 - 4", "x + y + z - 1", (math.sqrt(11 / 3),) * 2),
        ("x^2/9 + y^2 - z", "z - 4", (2, 6)),
    ],
)
def test_half_axes(quadric, plane, half_axes):
    conic = conic_section(Quadric(quadric), *pas.parametric.generatrix.quadric.read_plane(plane))
    lengths = sorted(np.linalg.norm(v) for v in (conic.first, conic.second))
    assert lengths == pytest.approx(sorted(half_axes), rel=1e-14)
    assert conic.first @ conic.second == pytest.approx(0, abs=1e-13)


def test_bounds_of_a_long_ellipse():
    """Nearly a parabola, over a thousand times as long as it is curved at its end."""
    curve = plane_section("x^2 + y^2/4 - z", "x + z/40 - 1")
    assert np.ptp(curve(S), axis=0).max() > 1600 and curve.bounds().angle < 1e-9


def test_bounds_see_a_curve_that_is_off():
    f = Quadric("x^2 + y^2 - 1")
    conic = conic_section(f, *pas.parametric.generatrix.quadric.read_plane("z"))
    off = type(conic)(conic.kind, conic.origin + [1e-3, 0, 0], conic.first, conic.second)
    angle = np.linspace(0, 2 * np.pi, 500)
    points, tangents, normals = off(angle), off(angle, 1), f.polynomial.gradient(off(angle))
    sine = np.abs((tangents * normals).sum(1)) / np.linalg.norm(tangents, axis=1) / np.linalg.norm(normals, axis=1)
    away = np.abs(f.polynomial(points)) / np.linalg.norm(normals, axis=1)
    bounds = ellipse_bounds(f, off)
    assert np.arcsin(sine.max()) <= bounds.angle < 2 * np.arcsin(sine.max())
    assert away.max() <= bounds.distance < 2 * away.max()


@pytest.mark.parametrize(
    ("quadric", "plane", "message"),
    [
        ("x^2 + y^2 + z^2 - 1", "z - 2", r"section is empty \(complex\); move the plane"),
        ("x^2 + y^2 + z^2 - 1", "z - 1", r"one point at \(0, 0, 1\); it touches"),
        ("x^2 + y^2 - z^2", "z", r"one point at \(0, 0, 0\); it passes through the apex"),
        ("x^2 + y^2 - z^2", "x", r"two straight lines that cross at \(0, 0, 0\)"),
        ("x^2 + y^2 - z^2", "x - z", "one straight line, along which they touch"),
        ("x^2 + y^2 - 1", "x - 2", "nothing: the section is empty"),
        ("x^2 + y^2 - 1", "x - 1/2", "two parallel straight lines"),
        ("x^2 + y^2 - z", "x - 1", r"a parabola, an open curve: say which part, for example interval=\(-1, 1\)"),
        ("x^2 + y^2 - z^2", "x - 1", "a hyperbola, an open curve"),
        ("x*y - z", "x - 1", "one straight line; tilt"),
    ],
)
def test_sections_that_are_no_closed_curve(quadric, plane, message):
    with pytest.raises(GeometryError, match=message):
        plane_section(quadric, plane)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: plane_section("x^3 - 1", "z"), "the quadric must be a polynomial of degree 2, not x\\^3 - 1"),
        (lambda: plane_section("x^2 - y^2", "z"), "quadric must be a curved surface .* pair of planes"),
        (lambda: plane_section("x^2 + y^2 - 1", "z^2"), "plane must be a polynomial of degree 1"),
        (lambda: plane_section("x^2 - y", "z", interval=(2, 1)), "low < high"),
        (lambda: plane_section("x^2 - y^2 - 1", "z", interval=(0, 1), branch=0), "branch must be 1 or -1"),
        (lambda: quadric_intersection("x^2 - 1", "x^2 + y^2 - 1"), "first must be a curved surface"),
        (lambda: quadric_intersection("x^2 + y^2 - 1", "z"), "second must be a polynomial of degree 2"),
    ],
)
def test_misuse(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_branches_of_a_hyperbola():
    one, two = (plane_section("x^2 - y^2 - 1", "z - 1", interval=(-1, 1), branch=b)(S) for b in (1, -1))
    assert {np.sign(one[:, 0].min()), np.sign(two[:, 0].max())} == {1.0, -1.0} or one[0, 0] * two[0, 0] < 0


def test_published_cone_and_ellipsoid():
    """t = +-36 / sqrt(1040 - 768 cos - 311 sin^2) on S = (t, (2t/3) cos, (t/3) sin), the ellipsoid turned by pi/4."""
    t, a, x, y, z = sympy.symbols("t a x y z")
    place = {x: t, y: 2 * t / 3 * sympy.cos(a), z: t / 3 * sympy.sin(a)}
    cone = -(x**2) / 9 + y**2 / 4 + z**2
    assert sympy.simplify(cone.subs(place)) == 0
    turn = sympy.sqrt(2) / 2
    turned = []
    for sense in (1, -1):  # seen from axes turned by +-pi/4: print and check value have opposite senses
        axes = {x: turn * (x - sense * y), y: turn * (y + sense * x)}
        turned.append(sympy.expand((x**2 + y**2 / 9 + z**2 / 16 - 1).subs(axes, simultaneous=True)))
    denominator = 1040 - 768 * sympy.cos(a) - 311 * sympy.sin(a) ** 2
    fits = [sympy.simplify(e.subs(place).subs(t, 36 / sympy.sqrt(denominator))) == 0 for e in turned]
    assert fits == [True, False]
    branches = quadric_intersection(sympy.sstr(cone).replace("**", "^"), sympy.sstr(turned[0]).replace("**", "^"))
    assert len(branches) == 2 and all(b.closed and b.factor is None for b in branches)
    signs = set()
    for branch in branches:
        p = branch(S)
        angle = np.arctan2(p[:, 2] * 3 / p[:, 0], p[:, 1] * 1.5 / p[:, 0])
        expected = 36 / np.sqrt(1040 - 768 * np.cos(angle) - 311 * np.sin(angle) ** 2)
        np.testing.assert_allclose(np.abs(p[:, 0]), expected, rtol=1e-13)
        signs.add(float(np.sign(p[0, 0])))
        turns = np.unwrap(angle)
        assert abs(turns[-1] - turns[0]) == pytest.approx(2 * np.pi)
    assert signs == {1.0, -1.0}


BRANCHES = [
    ("x^2 + y^2 - 1", "y^2 + z^2 - 2", 2),
    ("x^2 + y^2 - 1", "y^2 + z^2/4 - 1/2", 2),
    ("x^2 + y^2 - 1", "(y - 1/2)^2 + z^2 - 1/2", 1),
    ("x^2 + y^2 + z^2 - 1", "(x - 1)^2 + y^2 + z^2 - 1", 1),
    ("x^2 + y^2 + z^2 - 1", "4*x^2 + 2*y^2 + z^2/3 - 1", 2),
    ("x^2 + y^2/4 + z^2/9 - 1", "(x - 1/2)^2/2 + (y - 1/3)^2 + (z - 1)^2 - 1", 1),
    ("x^2 + y^2/4 + z^2/9 - 1", "4*x^2 + y^2/16 + z^2/4 - 1", 2),
    ("x^2 + y^2 - 1", "x^2 + y^2 + z^2 - 1", 1),
    ("x^2 + y^2 - 1", "x^2 + y^2 + z^2 - 2", 2),
    ("x^2 + y^2 - z", "x^2 + 2*y^2 + z - 3", 1),
    ("x^2 + y^2 - z", "y^2 + z^2 - 1", 1),
    ("x^2 + y^2 - z", "y^2/2 + z^2 + x^2 - x/3 - 3", 1),
    ("x^2 + y^2 - z^2 - 1", "x^2/4 + y^2 + (z - 1/3)^2 - 2", 2),
    ("x^2 + y^2 - z^2 + 1", "x^2/4 + y^2 + (z - 2)^2 - 2", 1),
    ("x^2 + y^2 - z^2", "x^2 + y^2/2 + z^2 - 4", 2),
    ("x^2 + y^2 - z^2", "(x - 1)^2 + y^2/2 + (z - 2)^2 - 1", 1),
]


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("first", "second", "count"), BRANCHES)
@pytest.mark.parametrize("motion", [(0, 0, 0, 0, 0, 0), (1, -2, 3, 2, -1, 1), (-1, 1, 1, -30, 20, 7)])
def test_closed_branches(first, second, count, motion):
    pair = moved(first, motion), moved(second, motion)
    branches = quadric_intersection(*pair)
    assert len(branches) == count == len(quadric_intersection(*pair[::-1]))
    for branch in branches:
        assert branch.closed
        p = branch(S)
        assert max(residual(f, p) for f in pair) < 1e-13
        np.testing.assert_allclose(p[0], p[-1], atol=1e-9)
        assert smooth(branch) < 1e-5
        assert np.linalg.norm(np.diff(p, axis=0), axis=1).max() < 0.2 * np.ptp(p, axis=0).max()
    clouds = [b(S) for b in branches]
    if count == 2:
        assert np.linalg.norm(clouds[0][:, None] - clouds[1][None], axis=2).min() > 1e-2


@pytest.mark.parametrize("shift", [(1000, -500, 300), (100_000, 0, 0)])
@pytest.mark.parametrize("first", ["x^2 + y^2/4 + z^2/9 - 1", "x^2 + y^2 - z^2 - 1"])
def test_branches_far_from_the_origin(first, shift):
    second = "(x - 1/2)^2/2 + (y - 1/3)^2 + (z - 1)^2 - 1"
    near = quadric_intersection(first, second)
    moves = [Polynomial(v) - Polynomial(c) for v, c in zip("xyz", shift, strict=True)]
    pair = [Polynomial(f).compose(*moves) for f in (first, second)]
    far = quadric_intersection(*pair)
    assert len(far) == len(near)
    for branch in far:
        assert max(residual(f, branch(S) - np.array(shift)) for f in (first, second)) < 1e-9
        assert branch.on(0).closed and smooth(branch) < 1e-4


@given(motions, motions, st.sampled_from(CLOSED), st.sampled_from(CLOSED))
@settings(max_examples=20, deadline=None)
def test_branches_of_random_quadrics(one, two, first, second):
    """Every branch lies on both; every point where rays on the first meet the second is on a branch."""
    f, g = moved(first, one), moved(second, two)
    try:
        branches = quadric_intersection(f, g)
    except GeometryError as error:
        assert any(w in str(error) for w in ("empty", "same", "touch", "cross", "straight", "no curve"))
        return
    points = []
    for branch in branches:
        s = S if branch.closed else S[[not any(abs(x - p) < 0.02 for p in branch.poles) for x in S]]
        p = branch(s)
        assert max(residual(f, p), residual(g, p)) < 1e-11
        points.append(branch(np.linspace(0, 1, 4001)))
    cloud = np.concatenate(points)
    cloud = cloud[np.isfinite(cloud).all(axis=1)]
    for p in samples_of_intersection(f, g):
        assert np.linalg.norm(cloud - p, axis=1).min() < 0.05 * (1 + np.linalg.norm(p))


def samples_of_intersection(f, g) -> list[np.ndarray]:
    """Points on both, by Newton's method from random starts: independent of any parametrisation."""
    p = np.random.default_rng(3).uniform(-3, 3, (60, 3))
    for _ in range(60):
        slopes = np.stack([f.gradient(p), g.gradient(p)], axis=1)
        values = np.stack([f(p), g(p)], axis=1)
        p = np.clip(p - (np.linalg.pinv(slopes) @ values[..., None])[..., 0], -1e6, 1e6)
    good = (np.abs(f(p)) < 1e-10) & (np.abs(g(p)) < 1e-10) & (np.abs(p).max(axis=1) < 5)
    crossed = np.cross(f.gradient(p), g.gradient(p))  # not where they touch, in a point that is no curve
    good &= np.linalg.norm(crossed, axis=1) > 1e-3
    return list(p[good])


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        ("x^2 + y^2 + z^2 - 1", "(x - 3)^2 + y^2 + z^2 - 1", r"do not meet: the intersection is empty \(complex\)"),
        ("x^2 + y^2 + z^2 - 1", "x^2 + y^2 + z^2 - 2", "do not meet"),
        ("x^2 + y^2 + z^2 - 1", "(x - 2)^2 + y^2 + z^2 - 1", r"one point at \(1, 0, 0\); it touches there"),
        ("x^2 + y^2 + z^2 - 1", "(x - 1)^2 + y^2/4 + z^2 - 4", r"at \(-1, .*they touch"),
        ("x^2 + y^2 - 1", "x^2 + (y - 1)^2 + z^2 - 4", "their curves cross"),
        ("x^2 + y^2 - 1", "y^2 + z^2 - 1", "cross or touch each other near"),
        ("x^2 + y^2 - 1", "2*x^2 + 2*y^2 - 2", "are the same surface"),
        ("x^2 + y^2 - 1", "(x - 5)^2 + y^2 - 1", "no curve in common|do not meet"),
        ("x^2 + y^2 - z^2", "x^2 + 2*y^2 - z^2 - x*y", "straight lines|no curve"),
    ],
)
def test_intersections_that_are_no_curves(first, second, message):
    with pytest.raises(GeometryError, match=message):
        quadric_intersection(first, second)


def test_branches_that_go_to_infinity():
    pair = "x^2 + y^2 - z", "(x - 2)^2 + 2*y^2 - z - 1"
    (branch,) = quadric_intersection(*pair)
    assert not branch.closed and "open" in str(branch)
    with pytest.raises(GeometryError, match=r"goes to infinity at s = .* say which part"):
        branch.on(0)
    pole = branch.poles[0]
    with pytest.raises(GeometryError, match="inside the interval"):
        branch.on(0, (pole - 0.1, pole + 0.1))
    boundary = branch.on(1, (pole + 0.2, pole + 0.8))
    assert not boundary.closed and max(residual(f, boundary(S)) for f in pair) < 1e-12


def test_branches_as_boundaries():
    first, second = "x^2 + y^2 + z^2 - 4", "(x - 1)^2 + y^2 - 1/2"
    for branch in quadric_intersection(first, second):
        boundary = branch.on(0)
        assert boundary.closed
        normals = Polynomial(first).gradient(boundary(S))
        np.testing.assert_allclose(np.cross(normals, boundary.normals(S)), 0, atol=1e-12)
        part = branch.on(1, (0.1, 0.4))
        assert not part.closed
        np.testing.assert_allclose(part([0, 1]), branch([0.1, 0.4]), atol=1e-12)
    with pytest.raises(ValueError, match="number must be 0 or 1"):
        branch.on(2)


TOUCHING = [("x^2 + y^2 - 1", "x^2 + y^2 + z^2 - 1", None), ("x^2 - y^2 - 1", "x^2 - y^2 + z^2 - 1", ("1/4", "3/4"))]


@pytest.mark.parametrize(("first", "second", "interval"), TOUCHING)
def test_quadrics_that_touch_along_a_conic(first, second, interval):
    """Their gradients are parallel there, and say nothing of the curve's direction."""
    s, step = np.linspace(0.3, 0.7, 5), 1e-5
    for branch in quadric_intersection(first, second):
        changes = (branch(s + step) - branch(s - step)) / (2 * step)
        np.testing.assert_allclose(branch.derivative(s), changes, atol=1e-6)
        assert np.isfinite(branch.on(0, interval).velocity(S)).all()
        if branch.closed:
            np.testing.assert_allclose(np.linalg.norm(branch.derivative(s), axis=1), 2 * np.pi, rtol=1e-14)


def test_planes_of_a_pencil():
    found = members(Quadric("x^2 + y^2 - 1"), Quadric("y^2 + z^2/4 - 1"))
    pair = next(matrix for matrix, signs in found if signs == (1, 1))
    planes = np.array([[float(Fraction(str(c))) for c in p] for p in planes_of(pair)])
    product = np.outer(planes[0], planes[1])
    q = to_array(pair)
    np.testing.assert_allclose((product + product.T) / 2 * q[0, 0] / product[0, 0], q, atol=1e-14)
