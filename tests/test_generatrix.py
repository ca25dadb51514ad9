"""Blends by a Bezier generatrix: boundaries, turning, shapes, certificates, the middle sphere, bad input."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import pas
from pas import Boundary, GeneratrixShape, Polynomial, ShapeFunction, Status, generatrix_blend, plane_section
from pas.errors import GeometryError, NotProvedError
from pas.mesh.crossings import crossings
from pas.parametric.generatrix.align import alignment, sides
from pas.parametric.generatrix.form import connectivity
from pas.parametric.nets import bernstein_at

S = np.linspace(0, 1, 101)
ROUND = ("(1 - 6*(2*s - 1)^2 + (2*s - 1)^4)/(1 + (2*s - 1)^2)^2", "4*(2*s - 1)*(1 - (2*s - 1)^2)/(1 + (2*s - 1)^2)^2")
"""The whole unit circle, once round for s in [0, 1], rational (t the tangent of a quarter of the angle)."""

pair = st.tuples(st.fractions(0, 1, max_denominator=9), st.fractions(-3, 3, max_denominator=5))

RIM = Boundary.on_implicit("x^2 + y^2 - 1", (*ROUND, "2"), name="the rim")
"""Of the unit cylinder, exact and closed."""

COLLAR = Boundary.on_implicit("x^2 + y^2 - 4", (f"2*{ROUND[0]}", f"2*{ROUND[1]}", "-2"), name="the collar")
RING = plane_section("x^2 + y^2 - 1", "z - 2")
STRIP = Boundary.along(("s", "0", "0"), tangent=("0", "1", "s"), name="the strip")
EDGE = Boundary.on_implicit("z - x^2 - 2", ("s", "3", "s^2 + 2"), name="the edge")


def pipe(axis: str, at: object, radius2: object = 1, side: int | None = None) -> Boundary:
    """The end of a round pipe along an axis."""
    others = [f"{v}^2" for v in "xyz" if v != axis]
    return plane_section(f"{others[0]} + {others[1]} - ({radius2})", f"{axis} - ({at})", side=side)


def angle_to_surfaces(blend) -> float:
    """The greatest angle between blend and surfaces, as the sine between normals."""
    worst = 0.0
    for number, boundary in enumerate(blend.boundaries):
        normals = blend.surface.normals(np.stack([S, np.full_like(S, number)], axis=-1))
        worst = max(worst, float(np.linalg.norm(np.cross(normals, boundary.normals(S)), axis=1).max()))
    return worst


# --- boundaries -----------------------------------------------------------------------------------


def boundary_cases():
    helicoid = pas.helicoid(start=2)
    torus = pas.torus(2, 1, angle=True)
    knot = lambda s: np.stack([np.cos(2 * np.pi * s), np.sin(2 * np.pi * s), 0 * s], axis=-1)  # noqa: E731
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    return {
        "implicit, exact": (RIM, True, True),
        "implicit, formulas": (
            Boundary.on_implicit("x^2 + y^2 - 1", ("cos(pi*s)", "sin(pi*s)", "s*(1-s)")),
            False,
            False,
        ),
        "tangent, exact": (STRIP, False, True),
        "iso-curve, exact": (Boundary.on_parametric(pas.iso_curve(pas.elliptic_cylinder(), h=1), (0, 1)), False, True),
        "iso-curve": (Boundary.on_parametric(pas.iso_curve(torus, h=0), (-math.pi, math.pi)), True, False),
        "curve in the domain": (Boundary.on_parametric(pas.SurfaceCurve(helicoid, "s", "1 + s^2")), False, False),
        "callable": (Boundary.along(knot, normal=knot), True, False),
        "points": (Boundary.from_points(ring, ring, closed=True), True, False),
        "section": (plane_section("x^2 + y^2/4 - z^2", "z + x/3 - 1"), True, False),
        "intersection": (pas.quadric_intersection("x^2 + y^2 + z^2 - 4", "(x-1)^2 + y^2 - 1/2")[0].on(0), True, False),
    }


CASES = boundary_cases()


@pytest.mark.parametrize("name", CASES)
def test_boundaries(name):
    boundary, closed, exact = CASES[name]
    assert boundary.closed == closed and (boundary.exact is not None) == exact
    s, h = S[1:-1], 1e-6
    change = (boundary(s + h) - boundary(s - h)) / (2 * h)
    np.testing.assert_allclose(boundary.derivative(s), change, atol=2e-8 * np.abs(change).max())
    normals = boundary.normals(S)
    along = boundary.derivative(S) / np.linalg.norm(boundary.derivative(S), axis=1, keepdims=True)
    np.testing.assert_allclose((normals * along).sum(axis=1), 0, atol=1e-8)
    np.testing.assert_allclose((normals * boundary.across(S)).sum(axis=1), 0, atol=1e-8)
    if exact:
        assert boundary.exact.lies_in_plane


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("backwards", [False, True])
def test_turning_boundaries(name, backwards):
    boundary, closed, _ = CASES[name]
    turned = boundary.turned(backwards, 0.0)
    np.testing.assert_allclose(turned(S), boundary(S[::-1] if backwards else S), atol=1e-9)
    np.testing.assert_allclose(
        turned.derivative(S), boundary.derivative(S[::-1]) * -1 if backwards else boundary.derivative(S)
    )
    np.testing.assert_allclose(turned.across(S), boundary.across(S[::-1] if backwards else S), atol=1e-8)
    again = turned.turned(backwards, 0.0)
    np.testing.assert_allclose(again(S), boundary(S), atol=1e-9)
    if closed:
        shifted = turned.turned(False, 0.3)
        np.testing.assert_allclose(shifted(S[:60]), turned(S[:60] + 0.3), atol=1e-9)
    else:
        with pytest.raises(ValueError, match="not closed"):
            turned.turned(False, 0.3)


BAD_BOUNDARIES = [
    (
        lambda: Boundary.on_implicit("x^2 + y^2 - 1", ("s", "0", "0")),
        GeometryError,
        "does not lie on the surface; there",
    ),
    (
        lambda: Boundary.on_implicit("x^2 + y^2 - 1", ("cos(s)", "sin(s) + s/100", "0")),
        GeometryError,
        "off the surface by 0.0.* at s = 1",
    ),
    (
        lambda: Boundary.on_implicit("z", ("(s - 1/3)^2", "(s - 1/3)^3", "0")),
        GeometryError,
        "not regular; its derivative vanishes at s = 0.333333",
    ),
    (
        lambda: Boundary.along(("cos(pi*s)", "cos(pi*s)", "0"), normal=("0", "0", "1")),
        GeometryError,
        "not regular; its derivative vanishes at s = 0",
    ),
    (
        lambda: Boundary.on_implicit("x^2 + y^2 - z^2", ("2*s - 1", "0", "2*s - 1")),
        GeometryError,
        "surface's normal vanishes at s = 0.5",
    ),
    (
        lambda: Boundary.along(("s", "0", "0"), tangent=("0", "1 - 2*s", "0")),
        GeometryError,
        "tangent vector given vanishes at s = 0.5",
    ),
    (
        lambda: Boundary.along(("s", "0", "0"), tangent=("1", "s - 1/4", "0")),
        GeometryError,
        "tangent vector given is along the curve at s = 0.25",
    ),
    (
        lambda: Boundary.along(("s", "sin(s)", "0"), tangent=("1", "cos(s)", "0")),
        GeometryError,
        "tangent vector given is along the curve at s = 0",
    ),
    (
        lambda: Boundary.along(("1/(2*s - 1)", "s", "0"), normal=("0", "0", "1")),
        GeometryError,
        "a denominator vanishes at s = 0.5",
    ),
    (lambda: Boundary.along(("log(s)", "s", "0"), normal=("0", "0", "1")), GeometryError, "not finite at s = 0"),
    (
        lambda: Boundary.along(("s", "sin(s)", "0"), normal=("0", "1", "1")),
        GeometryError,
        "normal is not perpendicular to the curve at s = 0",
    ),
    (
        lambda: Boundary.on_implicit("z", ("s", "s^2", "0"), closed=True),
        GeometryError,
        "called closed, but its ends are 1.41 apart",
    ),
    (lambda: Boundary.on_implicit("z", ("s*(1-s)", "s^2*(1-s)", "0")), GeometryError, "has a corner at s = 0"),
    (
        lambda: Boundary.along(
            ("cos(2*pi*s)", "sin(2*pi*s)", "0"),
            normal=("cos(pi*s)*cos(2*pi*s)", "cos(pi*s)*sin(2*pi*s)", "sin(pi*s)"),
        ),
        GeometryError,
        "direction at s = 0 and s = 1 differ",
    ),
    (
        lambda: Boundary.on_parametric(pas.iso_curve(pas.ellipsoid(), h=0.5), (0, 1), side=2),
        ValueError,
        "side of .* must be 1, -1 or None, not 2",
    ),
    (
        lambda: Boundary.on_parametric(pas.SurfaceCurve(pas.ellipsoid(), "s", "2*s")),
        ValueError,
        r"h = 1.00781 lies outside the domain \[-1, 1\]",
    ),
    (lambda: Boundary.on_parametric(pas.ellipsoid()), TypeError, "must be a SurfaceCurve"),
    (lambda: Boundary.along(("s", "0", "0")), ValueError, "exactly one of normal and tangent"),
    (lambda: Boundary.along("s", normal=("0", "0", "1")), TypeError, "three expressions in s or one callable"),
    (
        lambda: Boundary.along(("u", "0", "0"), normal=("0", "0", "1")),
        ValueError,
        "variable 'u' is not one of s",
    ),
    (lambda: Boundary.along(("s", "0", "0"), normal=("0", "0", "1"), interval=(1, 1)), ValueError, "low < high"),
    (lambda: Boundary.along(("s", "0", "0"), normal=("0", "0", "1"), interval=3), ValueError, "must be two numbers"),
    (lambda: Boundary.from_points(np.zeros((5, 3)), np.ones((5, 3))), GeometryError, "points 0 and 1 coincide"),
    (lambda: Boundary.from_points(np.eye(3), np.eye(3)), ValueError, r"shape \(n, 3\) with n >= 4, not \(3, 3\)"),
    (lambda: Boundary.from_points(np.random.rand(5, 3), np.ones((4, 3))), ValueError, "5 points but 4 normals"),
    (lambda: Boundary.from_points(np.diag([1, 2, 3, 4])[:, :3], np.zeros((4, 3))), GeometryError, "normal 0 is zero"),
]


@pytest.mark.parametrize(("make", "error", "message"), BAD_BOUNDARIES)
def test_bad_boundaries(make, error, message):
    with pytest.raises(error, match=message):
        make()


def test_sampled_boundary_passes_through_its_points():
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    points = np.stack([2 * np.cos(angle), np.sin(angle), 0.2 * np.cos(2 * angle)], axis=1)
    normals = np.stack([np.cos(angle), 2 * np.sin(angle), 0 * angle], axis=1)
    boundary = Boundary.from_points(points, normals, closed=True)
    chords = np.linalg.norm(np.diff(np.concatenate([points, points[:1]]), axis=0), axis=1)
    s = np.concatenate([[0], np.cumsum(chords)])[:-1] / chords.sum()
    np.testing.assert_allclose(boundary(s), points, atol=1e-12)
    fine = 2 * np.cos(angle[:1] + np.pi / 40), np.sin(angle[:1] + np.pi / 40)
    assert np.linalg.norm(boundary(s[:1] + (s[1] - s[0]) / 2)[0, :2] - np.concatenate(fine)) < 1e-3


# --- shape functions ------------------------------------------------------------------------------


@given(st.lists(pair, min_size=1, max_size=6, unique_by=lambda p: p[0]))
@settings(max_examples=15, deadline=None)
def test_shape_functions_through_pairs(pairs):
    f = ShapeFunction.through(pairs)
    assert len(f.coefficients) <= len(pairs)
    for s, value in pairs:
        assert sum(c * s**i for i, c in enumerate(f.coefficients)) == value
    t = sympy.Symbol("t")
    poly = sum(sympy.Rational(str(c)) * t**i for i, c in enumerate(f.coefficients))
    where = [float(sympy.sympify(poly).subs(t, sympy.Rational(k, 7))) for k in range(8)]
    np.testing.assert_allclose(f(np.arange(8) / 7), where, atol=1e-9)
    np.testing.assert_allclose(f(S[1:-1], 1), (f(S[1:-1] + 1e-6) - f(S[1:-1] - 1e-6)) / 2e-6, atol=1e-3)
    positive = min(float(v) for v in f(np.linspace(0, 1, 2001))) > 1e-9
    try:
        GeneratrixShape(l1=f)
        assert positive
    except ValueError as error:
        assert not positive or "l1 is 0" in str(error)


def test_cosine_shape():
    f = ShapeFunction.cosine("1/2", 2, "1/4")
    np.testing.assert_allclose(f(S), 1.5 * (1 - np.cos(2 * np.pi * (S - 0.25))) / 2 + 0.5)
    np.testing.assert_allclose(f(S, 1), 1.5 * np.pi * np.sin(2 * np.pi * (S - 0.25)), atol=1e-12)
    assert f.is_periodic and f.exact is None and f.value is None
    assert ShapeFunction.cosine(2, 2).value == 2


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: GeneratrixShape(l1=0), "l1 is 0; it must be positive"),
        (lambda: GeneratrixShape(l2="-1/2"), "l2 is -1/2; it must be positive"),
        (lambda: GeneratrixShape(l1=ShapeFunction.through([(0, 1), ("1/2", -1), (1, 1)])), "l1 is .* at s = 0.146447"),
        (lambda: GeneratrixShape(l1=ShapeFunction.through([(0, 1), ("1/2", 0), (1, 1)])), "l1 is 0 at s = 0.5"),
        (lambda: GeneratrixShape(l2=ShapeFunction.cosine(1, -1, "1/4")), "l2 is -1 at s = 0.75"),
        (lambda: GeneratrixShape(lambda1=1), "lambda1 is 1; it must lie between -1 and 1"),
        (lambda: GeneratrixShape(lambda2="-1"), "lambda2 is -1; it must lie"),
        (lambda: GeneratrixShape(lambda2=ShapeFunction.through([(0, 0), (1, 2)])), "lambda2 is 1 at s = 0.5"),
        (lambda: ShapeFunction.through([]), "data pairs"),
        (lambda: ShapeFunction.through([(0, 1), (0, 2)]), "distinct and in"),
        (lambda: ShapeFunction.through([(2, 1)]), "distinct and in"),
        (lambda: ShapeFunction.through([(Fraction(i, 30), 1) for i in range(30)]), "30 pairs are too many"),
        (lambda: ShapeFunction.constant("one"), "the shape value is not a rational number"),
    ],
)
def test_bad_shapes(make, message):
    with pytest.raises(ValueError, match=message):
        make()


# --- turning and sides ----------------------------------------------------------------------------

FITS = {  # boundaries, whether reversed, partner of the point of the first curve that is nearest to the second
    "coaxial": (pipe("z", 0), pipe("z", 3, 4), None),
    "elbow": (pipe("z", 3), pipe("x", 3), None),
    "bend": (
        plane_section("(x - 2)^2 + y^2 - 1", "z", side=1),
        plane_section("(x + 2)^2 + y^2 - 1/2", "z", side=1),
        None,
    ),
    "plane and pipe": (Boundary.on_implicit("z", (f"3*{ROUND[0]}", f"3*{ROUND[1]}", "0")), pipe("z", 2), None),
    "skew": (pipe("z", 4), plane_section("(y - 1)^2 + z^2/4 - 1", "x - y/3 - 4"), None),
}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", FITS)
@pytest.mark.parametrize("backwards", [False, True])
def test_closed_curves_are_turned_to_fit(name, backwards, shift=0.37):
    """However the second curve is given, the same blend results, regular and without crossings."""
    first, second, _ = FITS[name]
    plain = generatrix_blend(first, second)
    blend = generatrix_blend(first, second.turned(backwards, 0.0).turned(False, shift))
    assert blend.alignment.reversed == (plain.alignment.reversed != backwards)
    np.testing.assert_allclose(blend.boundaries[1](S), plain.boundaries[1](S), atol=1e-4)
    assert not blend.certificate.failed
    assert angle_to_surfaces(blend) < 1e-9
    assert blend.require() is blend


@pytest.mark.parametrize("name", ["elbow", "bend", "coaxial"])
@pytest.mark.sampled(3)
def test_opposed_curves_are_reported(name):
    first, second, _ = FITS[name]
    right = generatrix_blend(first, second)
    wrong = generatrix_blend(first, right.boundaries[1].turned(True, 0.0), align=False)
    sense = right.certificate.sense
    assert sense.status is Status.HOLDS_MEASURED  # closed curves are compared at samples
    assert wrong.certificate.sense.status is Status.FAILS_MEASURED and not wrong.certificate.refuted
    with pytest.raises(NotProvedError, match=r"run the same way.* reverse one curve"):
        wrong.require()


def test_least_squares_would_not_tell():
    """For perpendicular pipes the sum of squares is the same in both senses: why it is not used."""
    first, second, _ = FITS["elbow"]
    s = np.linspace(0, 1, 64, endpoint=False)
    best = []
    for backwards in (False, True):
        other = second.turned(backwards, 0.0)
        best.append(min(((first(s) - other(s + k / 64)) ** 2).sum() for k in range(64)))
    assert best[0] == pytest.approx(best[1])


def worked_case() -> tuple[Boundary, Boundary]:
    """A helicoid with its tangent vector, and an implicit cubic: as printed, they run against each other."""
    first = Boundary.along(("0", "4*s", "2"), tangent=("-4*s", "0", "-1"), name="the helicoid")
    ends = (-(21 ** (1 / 3)), -(17 ** (1 / 3)))
    second = Boundary.on_implicit("x^3 + y + z^2 + 4*z + 5", ("s", "-17 - s^3", "2"), ends, name="the cubic")
    return first, second


def test_worked_case():
    first, second = worked_case()
    helicoid = Boundary.on_parametric(pas.SurfaceCurve(pas.helicoid(start=2), "0", "4*s"))
    np.testing.assert_allclose(np.cross(helicoid.normals(S), first.normals(S)), 0, atol=1e-12)
    u = second(S)[:, 0]
    across = np.stack([24 * u**2, 8 + 0 * u, -(9 * u**4 + 1)], axis=1)
    np.testing.assert_allclose(np.cross(across, second.across(S)) / np.abs(across).max() ** 2, 0, atol=1e-12)
    assert second(0)[1] == pytest.approx(4) and second(1)[1] == pytest.approx(0, abs=1e-12)
    printed = generatrix_blend(first, second, align=False)
    assert printed.certificate.sense.status is Status.REFUTED
    with pytest.raises(NotProvedError, match="twisted"):
        printed.require()
    blend = generatrix_blend(first, second)
    assert blend.alignment.reversed and blend.alignment.shift == 0
    assert all(v.proved for v in blend.certificate.contacts) and not blend.certificate.failed


@pytest.mark.parametrize("name", ["callable", "section", "intersection", "curve in the domain"])
def test_length_as_parameter(name):
    boundary = CASES[name][0]
    made = boundary.by_length()
    speed = np.linalg.norm(made.derivative(S), axis=1)
    np.testing.assert_allclose(speed, speed[0], rtol=1e-4)
    np.testing.assert_allclose(made([0, 1]), boundary([0, 1]), atol=1e-9)
    np.testing.assert_allclose(
        np.cross(made.normals(S), made.derivative(S)),
        made.across(S) / np.linalg.norm(made.field(S), axis=1)[:, None],
        atol=1e-9,
    )
    change = (made(S[1:-1] + 1e-6) - made(S[1:-1] - 1e-6)) / 2e-6
    np.testing.assert_allclose(made.derivative(S[1:-1]), change, atol=1e-6)


def test_curves_of_uneven_speed_are_evened():
    """The same circle run through unevenly is brought to the even one."""
    uneven = lambda s: 2 * np.pi * s + 0.8 * np.sin(2 * np.pi * s)  # noqa: E731
    circle = lambda s: np.stack([np.cos(uneven(s)), np.sin(uneven(s)), 0 * s], axis=-1)  # noqa: E731
    blend = generatrix_blend(Boundary.along(circle, normal=circle), pipe("z", 2))
    assert blend.alignment.by_length and blend.alignment.distance == pytest.approx(2, abs=1e-4)
    assert not generatrix_blend(pipe("z", 0), pipe("z", 2)).alignment.by_length


def test_sides():
    first, second, _ = FITS["elbow"]
    signs = sides(first, second)
    towards = signs[0] * first.across(0.3)
    assert towards[2] < 0 == pytest.approx(towards[0]) == pytest.approx(towards[1])
    bend = plane_section("(x - 2)^2 + y^2 - 1", "z"), plane_section("(x + 2)^2 + y^2 - 1", "z")
    with pytest.raises(GeometryError, match=r"not clear on which side .* side=1 or side=-1"):
        generatrix_blend(*bend)
    for side in (1, -1):
        turned = [plane_section(f"(x {c} 2)^2 + y^2 - 1", "z", side=side) for c in "-+"]
        blend = generatrix_blend(*turned)
        assert not blend.certificate.failed
        assert np.sign(blend.surface([0.2, 0.5])[2]) == np.sign(blend.surface([0.7, 0.5])[2])


# --- blends ---------------------------------------------------------------------------------------


@given(
    st.floats(0.05, 3), st.floats(0.05, 3), st.floats(-0.95, 0.95), st.floats(-0.95, 0.95), st.booleans()
)  # fmt: skip
@settings(max_examples=10, deadline=None)
def test_tangent_planes_for_any_shape(l1, l2, lambda1, lambda2, quartic):
    middle = (lambda s: np.stack([2 + np.cos(6 * s), s, np.sin(6 * s)], axis=-1)) if quartic else None
    blend = generatrix_blend(STRIP, EDGE, GeneratrixShape(l1, l2, lambda1, lambda2, middle))
    assert blend.degree == (4 if quartic else 3)
    assert angle_to_surfaces(blend) < 1e-9
    controls = blend.control_points(S)
    assert controls.shape == (101, blend.degree + 1, 3)
    np.testing.assert_allclose(controls[:, 0], STRIP(S), atol=1e-12)
    legs = np.linalg.norm(controls[:, -2] - controls[:, -1], axis=1)
    np.testing.assert_allclose(legs, l2, rtol=1e-9)  # T is of length one


@pytest.mark.sampled(2)
@pytest.mark.parametrize("middle", [None, ("s", "3/2", "2 - s")])
@pytest.mark.parametrize("slant", [0, "3/5"])
def test_exact_blend(middle, slant):
    shape = GeneratrixShape("1/2", ShapeFunction.through([(0, 1), (1, "1/3")]), slant, 0, middle)
    blend = generatrix_blend(STRIP, EDGE.turned(True, 0.0), shape, unit=False)
    assert blend.alignment.reversed and blend.surface.is_exact and blend.surface.is_polynomial
    places = np.random.default_rng(1).uniform(0, 1, (50, 2))
    exact = np.stack([c(places[:, 0], places[:, 1]) for c in blend.surface.components], axis=-1)
    np.testing.assert_allclose(blend.surface(places), exact, atol=1e-12)
    for order in [(1, 0), (0, 1), (1, 1), (0, 3)]:
        np.testing.assert_allclose(
            blend.surface.derivative(places, *order), blend.surface.diff(*order)(places), atol=1e-7
        )
    np.testing.assert_allclose(blend.surface.derivative(places, 2, 0), blend.surface.diff(2, 0)(places), atol=1e-5)
    assert all(v.proved for v in blend.certificate.contacts) and blend.certificate.regular.proved
    s = sympy.Symbol("s")
    parts = [sympy.sympify(str(c).replace("^", "**")) for c in blend.surface.components]
    first = [sympy.diff(p, "t").subs("t", 0) for p in parts]
    normal = sympy.Matrix([1, 0, 0]).cross(sympy.Matrix([0, 1, s]))
    assert sympy.expand(sympy.Matrix(first).dot(normal)) == 0


def test_exact_closed_blend():
    blend = generatrix_blend(RIM, COLLAR, GeneratrixShape("1/2", "1/3"), unit=False)
    assert blend.closed and blend.surface.is_exact and blend.alignment.shift == 0
    assert all(v.proved for v in blend.certificate.contacts)
    np.testing.assert_allclose(blend.surface([[0, 0.3]]), blend.surface([[1, 0.3]]), atol=1e-12)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"unit": True}, "length one"),
        ({"shape": GeneratrixShape(1, 1, "1/2")}, "lambda1 is not a constant with a rational"),
        ({"shape": GeneratrixShape(1, ShapeFunction.cosine(1, 2))}, "l2 is no polynomial"),
        ({"second": COLLAR.turned(False, 0.3), "align": False}, "starts at 0.3"),
        ({"second": pipe("z", -2, 4)}, "is not rational"),
        (
            {"shape": GeneratrixShape(1, 1, middle=("cos(2*pi*s)", "sin(2*pi*s)", "0"))},
            "the middle curve is not rational",
        ),
    ],
)
def test_why_a_blend_is_not_exact(change, reason):
    options = {"second": COLLAR, "shape": GeneratrixShape(1, 1), "unit": False} | change
    blend = generatrix_blend(RIM, **options)
    assert not blend.surface.is_exact
    with pytest.raises(ValueError, match=reason):
        _ = blend.surface.components


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "first", [pipe("z", 3), pas.quadric_intersection("x^2 + y^2 - 1", "x^2/2 + y^2 + z^2 - 9")[0].on(0)]
)
def test_measured_contact_sees_a_wrong_one(monkeypatch, first):
    """Legs that leave the tangent plane by 0.1 degrees."""
    right, tilt = Boundary.across, math.radians(0.1)
    second = Boundary.from_points(pipe("x", 9)(S[:-1]), pipe("x", 9).normals(S[:-1]), closed=True)
    blend = generatrix_blend(second, first, GeneratrixShape(1, 1))
    assert blend.certificate.contacts[0].status is Status.HOLDS_MEASURED

    def tilted(self, s):
        across = right(self, s)
        return across + tilt * np.linalg.norm(across, axis=-1)[..., None] * self.normals(s)

    monkeypatch.setattr(Boundary, "across", tilted)
    verdict = generatrix_blend(second, first, GeneratrixShape(1, 1)).certificate.contacts[0]
    assert verdict.status is Status.FAILS_MEASURED and "differ by 1.0e-01 degrees" in verdict.reason


def test_exact_contact_sees_a_wrong_one():
    from pas.parametric.generatrix.paths import ExactCurve

    one, zero, s = (pas.RationalFunction(e, ("s", "t")) for e in ("1", "0", "s"))
    assert ExactCurve((s, zero, zero), (zero, one, s), True).lies_in_plane
    assert not ExactCurve((s, zero, zero), (s, one, zero), True).lies_in_plane


def test_crossing_blend_is_found_and_its_double_point_is_one():
    blend = generatrix_blend(pipe("z", 2), pipe("x", 2), GeneratrixShape(4, 4))
    verdict = blend.certificate.simple
    assert verdict.status is Status.FAILS_MEASURED and "largest_safe" in verdict.reason
    text = verdict.reason.replace("P(", "").split(" to ")[0]
    places = [[float(x) for x in part.strip(" )").split(",")] for part in text.split("=")]
    points = blend.surface(places)
    assert np.linalg.norm(points[0] - points[1]) < 1e-2 < np.linalg.norm(np.subtract(*places))
    assert np.linalg.norm(points[0] - verdict.witness) < 1e-2


@pytest.mark.parametrize("number", [0, pytest.param(None, marks=pytest.mark.slow)])
def test_largest_safe_length(number):
    blend = generatrix_blend(pipe("z", 2), pipe("x", 2))
    safe = blend.largest_safe(number, (48, 20))
    names = ("l1", "l2") if number is None else ("l1",)
    # Both at once may be 2 long, where the normal vanishes at a point; on so coarse a mesh 1.82 are found.
    below, above = (blend.with_shape(**dict.fromkeys(names, f * safe)) for f in (0.97, 1.15))
    assert not below.certificate.failed
    assert above.certificate.simple.failed or above.certificate.regular.failed
    assert above.certificate.failed and not above.certificate.refuted


def test_no_length_is_unsafe_where_nothing_can_cross():
    flat = Boundary.along(("s", "0", "0"), tangent=("0", "1", "0"))
    other = Boundary.along(("s", "1", "1"), tangent=("0", "1", "0"))
    assert generatrix_blend(flat, other).largest_safe(0, (8, 8)) > 0.3
    with pytest.raises(ValueError, match="number must be 0, 1 or None"):
        generatrix_blend(flat, other).largest_safe(2)


def test_middle_curve_opens_a_blend_that_crosses_itself():
    """Two pipes side by side, with one length everywhere: the bend collapses, a middle curve opens it."""
    pair = [plane_section(f"(x {c} 2)^2 + y^2 - 1", "z", side=-1) for c in "-+"]
    tight = generatrix_blend(*pair, GeneratrixShape(1, 1))
    assert tight.certificate.regular.status is Status.FAILS_MEASURED
    below = np.sign(tight.surface([0.2, 0.5])[2]) * np.array([0, 0, 0.7])

    def middle(s):
        one, two = (boundary(s) for boundary in tight.boundaries)
        return (one + two) / 2 + below * np.linalg.norm(one - two, axis=-1)[..., None]

    opened = tight.with_shape(middle=middle)
    assert opened.degree == 4 and not opened.certificate.failed


def test_default_lengths_follow_the_distance():
    blend = generatrix_blend(*FITS["bend"][:2])
    distance = np.linalg.norm(blend.boundaries[0](S) - blend.boundaries[1](S), axis=1)
    np.testing.assert_allclose(blend.shape.l1(S), distance / 3, rtol=0.02)


# --- meshes ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [(3, 2), (40, 9)])
def test_meshes(size):
    tube = generatrix_blend(RIM, COLLAR).mesh(size=size)
    assert tube.is_manifold and tube.euler_characteristic == 0 and len(tube.points) == size[0] * size[1]
    assert len(tube.boundary) == 2 * size[0]
    sheet = generatrix_blend(STRIP, EDGE).mesh(size=size)
    assert sheet.is_manifold and sheet.euler_characteristic == 1
    with pytest.raises(ValueError, match="at least"):
        generatrix_blend(STRIP, EDGE).mesh(size=(2, 2))


@pytest.mark.parametrize("sign", [1, -1])
def test_mesh_normals_agree_with_the_triangles_and_the_surface(sign):
    first = plane_section(Polynomial("x^2 + y^2 - 1") * sign, "z - 2")
    mesh = generatrix_blend(first, pipe("x", 2)).mesh(size=(60, 20))
    p = mesh.points[mesh.triangles]
    flat = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    assert ((flat * mesh.point_normals[mesh.triangles[:, 0]]).sum(axis=1) > 0).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.point_normals, axis=1), 1)
    rim = np.isclose(mesh.points[:, 2], 2) & (np.hypot(mesh.points[:, 0], mesh.points[:, 1]) < 1 + 1e-9)
    outward = mesh.points[rim] * [1, 1, 0] * sign
    assert rim.sum() >= 60 and (mesh.point_normals[rim] * outward).sum(axis=1).min() > 0.99


def test_mesh_is_the_surface():
    blend = generatrix_blend(RIM, pipe("x", 4))
    points, normals = blend.sheet((12, 7))
    s, t = np.arange(12) / 12, np.linspace(0, 1, 7)
    places = np.stack(np.meshgrid(s, t, indexing="ij"), axis=-1)
    np.testing.assert_allclose(points, blend.surface(places), atol=1e-12)
    np.testing.assert_allclose(np.cross(normals, blend.surface.normals(places)), 0, atol=1e-8)
    np.testing.assert_allclose(points, blend.surface.on_grid(s, t), atol=1e-12)


def test_with_shape_is_the_blend_made_anew():
    blend = generatrix_blend(pipe("z", 2), pipe("x", 2), GeneratrixShape(1, 1))
    changed = blend.with_shape(l1="3/2", lambda2="1/5")
    made = generatrix_blend(pipe("z", 2), pipe("x", 2), GeneratrixShape("3/2", 1, 0, "1/5"))
    np.testing.assert_array_equal(changed.mesh(size=(30, 10)).points, made.mesh(size=(30, 10)).points)
    assert changed.frames is blend.frames  # nothing is computed again
    with pytest.raises(TypeError, match="no l3"):
        blend.with_shape(l3=1)


def test_normals_against_differences():
    growing, turning = ShapeFunction.through([(0, 1), (1, 2)]), ShapeFunction.through([(0, 0), (1, "1/2")])
    blend = generatrix_blend(STRIP, EDGE, GeneratrixShape(1, growing, "1/3", turning))
    places, h = np.random.default_rng(2).uniform(0.1, 0.9, (40, 2)), 1e-5
    for axis, order in ((0, (1, 0)), (1, (0, 1))):
        step = np.eye(2)[axis] * h
        change = (blend.surface(places + step) - blend.surface(places - step)) / (2 * h)
        np.testing.assert_allclose(blend.surface.derivative(places, *order), change, atol=1e-7)


def test_bernstein_derivatives():
    t = np.linspace(0, 1, 9)
    for degree in (3, 4):
        rows = bernstein_at(degree, t)
        np.testing.assert_allclose(rows.sum(axis=1), 1)
        change = (bernstein_at(degree, t + 1e-6) - bernstein_at(degree, t - 1e-6)) / 2e-6
        np.testing.assert_allclose(bernstein_at(degree, t, 1), change, atol=1e-8)
        assert not bernstein_at(degree, t, degree + 1).any()


# --- crossings ------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(2))
def test_crossings_against_all_pairs(seed):
    """The tree finds what testing all pairs finds, and that is what linear programming says of pairs."""
    rng = np.random.default_rng(seed)
    centers = rng.uniform(-1, 1, (15, 1, 3)) * 0.5
    points = (centers + rng.normal(0, 0.3, (15, 3, 3))).reshape(-1, 3)
    triangles = np.arange(45).reshape(-1, 3)
    pairs, places = crossings(points, triangles)
    found = {tuple(p) for p in pairs.tolist()}
    expected = {
        (i, j) for i in range(15) for j in range(i) if meet(points[3 * i : 3 * i + 3], points[3 * j : 3 * j + 3])
    }
    assert found == {(j, i) for i, j in expected}
    for (i, j), place in zip(pairs, places, strict=True):
        for k in (i, j):
            p = points[triangles[k]]
            weights = np.linalg.lstsq(np.vstack([p.T, np.ones(3)]), np.append(place, 1), rcond=None)[0]
            np.testing.assert_allclose(weights @ p, place, atol=1e-9)
            assert weights.min() > -1e-9


def meet(first: np.ndarray, second: np.ndarray) -> bool:
    """Whether two triangles have a point in common, by linear programming."""
    from scipy.optimize import linprog

    rows = np.vstack([np.hstack([first.T, -second.T]), [1, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1]])
    return bool(linprog(np.zeros(6), A_eq=rows, b_eq=[0, 0, 0, 1, 1], bounds=(0, None)).status == 0)


def test_neighbours_do_not_cross():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]])
    assert not len(crossings(points, np.array([[0, 1, 2], [1, 3, 2]]))[0])
    assert connectivity((4, 3), True, False).max() == 11


# --- quadrics and the sphere ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "data",
    [
        ("x^2 + y^2 + z^2 - 4", "z - 1", "x^2 + y^2 - (z - 7)^2/9", "z - 5"),
        ("x^2 + y^2/4 - 1", "z - 2 + x/5", "(y - 1)^2 + z^2/4 - 1", "x - y/3 - 4"),
        ("x^2 + y^2 - z - 1", "z - 2", "x^2 + y^2/2 - (z - 6)^2 - 1", "z - 5"),
        ("x^2/4 + y^2 - z^2 + 1", "z - 2 - x/9", "(x - 1)^2 + y^2 + (z + 4)^2/2 - 3", "z + x/2 + 3"),
    ],
)
def test_blends_of_quadrics(data):
    blend = pas.blend_quadrics(*data)
    assert blend.closed and not blend.certificate.failed
    for verdict, polynomial in zip(blend.certificate.contacts, (data[0], data[2]), strict=True):
        assert verdict.proved and "to rounding" in verdict.claim
        assert str(Polynomial(polynomial)) in verdict.claim


def test_blend_along_intersections():
    """Boundaries that are not plane: two cylinders cut by spheres."""
    first = next(b for b in pas.quadric_intersection("x^2 + y^2 - 1", "x^2 + y^2/2 + z^2 - 4") if b(0.0)[2] > 0)
    second = next(b for b in pas.quadric_intersection("y^2 + z^2 - 1", "x^2 + y^2/3 + z^2 - 9") if b(0.0)[0] > 0)
    blend = generatrix_blend(first.on(0), second.on(0))
    assert not blend.certificate.failed and angle_to_surfaces(blend) < 1e-9
    assert blend.certificate.contacts[0].measured


def test_blend_through_a_sphere():
    ends = [pipe("x", 3, "1/4"), pipe("y", -3, "1/2"), plane_section("x^2 + y^2 - z^2/4", "z - 3")]
    result = pas.blend_through_sphere(ends, (0, 0, 0), 1)
    assert len(result.blends) == len(result.circles) == 3 and result.require() is result
    clouds = [c(S) for c in result.circles]
    for i, cloud in enumerate(clouds):
        np.testing.assert_allclose(np.linalg.norm(cloud, axis=1), 1, atol=1e-12)
        axis = cloud.mean(axis=0) / np.linalg.norm(cloud.mean(axis=0))
        for other in clouds[:i]:
            assert (other @ axis).max() < (cloud @ axis).min()
        blend = result.blends[i]
        assert angle_to_surfaces(blend) < 1e-9
        leaving = blend.control_points(S)[:, 2] - blend.control_points(S)[:, 3]
        assert (leaving @ axis).min() > 0


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: pas.blend_through_sphere([RIM], (0, 0, 0), 1), ValueError, "at least two boundaries, not 1"),
        (lambda: pas.blend_through_sphere([RIM, COLLAR], (0, 0, 0), 0), ValueError, "radius must be positive, not 0"),
        (lambda: pas.blend_through_sphere([RIM, STRIP], (0, 0, 0), 1), GeometryError, r"boundaries\[1\] .* is open"),
        (lambda: pas.blend_through_sphere([RIM, COLLAR], (0, 0, 0), 3), GeometryError, "reaches into the sphere"),
        (lambda: pas.blend_through_sphere([RING, COLLAR], (0, 0, 2), "1/2"), GeometryError, "goes round the centre"),
        (lambda: pas.blend_through_sphere([pipe("z", 3), pipe("z", 5)], (0, 0, 0), 1), GeometryError, "same direction"),
        (
            lambda: pas.blend_through_sphere([pipe("z", 2), pipe("z", -2)], (0, 0, 0), 1, angles=(2, 2)),
            GeometryError,
            "circles 0 and 1 overlap: .* less than 3.142",
        ),
        (lambda: pas.blend_through_sphere([RIM, COLLAR], (0, 0, 0), 1, angles=(1,)), ValueError, "2 boundaries but 1"),
        (lambda: pas.blend_through_sphere([RIM, COLLAR], (0, 0, 0), 1, angles=(1, 0)), ValueError, r"angles\[1\] must"),
        (lambda: pas.blend_through_sphere([RIM, 3], (0, 0, 0), 1), TypeError, r"boundaries\[1\] must be a Boundary"),
        (lambda: generatrix_blend(RIM, STRIP), GeometryError, "the rim is closed but the strip is not"),
        (lambda: generatrix_blend(RIM, RIM), GeometryError, r"touch at \("),
        (lambda: generatrix_blend(pipe("z", 0), pipe("x", 0)), GeometryError, r"touch at \(.*move them apart"),
        (lambda: generatrix_blend(RIM, 3), TypeError, "second must be a Boundary"),
        (lambda: generatrix_blend(RIM, COLLAR, 3), TypeError, "shape must be a GeneratrixShape"),
        (
            lambda: generatrix_blend(RIM, COLLAR, GeneratrixShape(l1=ShapeFunction.through([(0, 1), (1, 2)]))),
            ValueError,
            "l1 differs .* but the curves are closed; use ShapeFunction.cosine",
        ),
        (
            lambda: generatrix_blend(RIM, COLLAR, GeneratrixShape(middle=("s", "0", "0"))),
            GeometryError,
            "the middle curve is not",
        ),
        (lambda: generatrix_blend(STRIP, EDGE).control_points(1.5), ValueError, "s = 1.5 lies outside"),
        (lambda: generatrix_blend(STRIP, EDGE).surface([0.5, 2]), ValueError, "t = 2 lies outside the domain"),
        (
            lambda: pas.blend_quadrics("x^2 + y^2 - 1", "z", "x^2 + y^2 + z^2 - 1", "z - 5"),
            GeometryError,
            "quadric2 and plane2: .* empty",
        ),
    ],
)
def test_bad_blends(make, error, message):
    with pytest.raises(error, match=message):
        make()


@pytest.mark.parametrize(
    ("surface", "injective"),
    [
        (("s", "t", "s*t"), True),
        (("s + t^2/3", "t - s^2/3", "s*t*4"), True),
        (("s/(1 + s + t)", "t", "s - t^2"), True),
        (("s*(1 - s)", "t", "(s - 1/2)^2*t^2"), False),  # (s, 1 - s) are one point
        (("s^2 - s", "t", "(s - 1/2)^3 - (s - 1/2)/16"), False),  # three of them
        (("t", "s", "0"), True),
        (("s^2", "t", "0"), False),  # injective, but not shown by a strict inequality
    ],
)
def test_injectivity(surface, injective):
    from pas.parametric.generatrix.verdicts import is_injective

    made = pas.ParametricSurface(*surface, parameters=("s", "t"), domain=((0, 1), (0, 1)))
    assert is_injective(made) == injective


def test_a_certificate_that_is_proved_throughout():
    blend = generatrix_blend(STRIP, EDGE, GeneratrixShape(1, "1/2"), unit=False)
    assert blend.certificate.proved and blend.certificate.simple.proved
    loop = Boundary.along(("s", "0", "0"), tangent=("0", "-1", "0"), side=1)
    crossed = generatrix_blend(loop, EDGE, GeneratrixShape(1, 1), unit=False)
    assert not crossed.certificate.proved


def test_verdicts_are_not_bools():
    certificate = generatrix_blend(STRIP, EDGE).certificate
    with pytest.raises(TypeError, match="several verdicts"):
        bool(certificate)
    assert len(str(certificate).splitlines()) == 5 and not certificate.proved
    assert str(generatrix_blend(RIM, COLLAR.turned(True, 0.0).turned(False, 0.2))).endswith(
        "reversed and shifted by 0.2"
    )


def test_alignment_of_curves_as_they_are():
    found = alignment(RIM, COLLAR, sides(RIM, COLLAR), turn=False)
    assert not found.opposed and found.distance == pytest.approx(math.sqrt(17))
