"""Parametric surfaces, curves on them and blends: input, evaluation, proofs, errors."""

from __future__ import annotations

import math
import pickle
import re
from fractions import Fraction

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import pas
from pas import BlendingData, ParametricSurface, RationalFunction
from pas.parametric.data import contact_verdicts

T, H = sympy.symbols("t h")
CYLINDER = ParametricSurface("(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)", "h")
CONE = ParametricSurface("(h + 1)*(1 - t^2)/(1 + t^2)", "2*(h + 1)*t/(1 + t^2)", "h + 2")
SADDLE = ParametricSurface("t", "h", "t*h + t^3/3")
RNG = np.random.default_rng(5)
POINTS = RNG.uniform(0.1, 0.9, (7, 2))

small = st.integers(-4, 4)
polynomials = st.lists(small, min_size=6, max_size=6).map(
    lambda c: f"{c[0]} + {c[1]}*t + {c[2]}*h + {c[3]}*t*h + {c[4]}*t^2 + {c[5]}*h^2"
)
functions = st.tuples(polynomials, polynomials).map(lambda p: RationalFunction(f"({p[0]})/(({p[1]})^2 + 1)"))


@given(functions, functions, functions)
@settings(max_examples=25, deadline=None)
def test_rational_functions_form_a_field(f, g, k):
    assert f * (g + k) == f * g + f * k
    assert f - f == 0 and (f.is_zero or f / f == 1)
    assert (f * g).diff(1, 0) == f.diff(1, 0) * g + f * g.diff(1, 0)
    assert (f.numerator.gcd(f.denominator)).is_constant()


@given(functions)
@settings(max_examples=15, deadline=None)
def test_rational_functions_agree_with_sympy(f):
    assert RationalFunction(f.to_sympy()) == f == pickle.loads(pickle.dumps(f))
    assert hash(f) == hash(RationalFunction(str(f)))
    where = {T: sympy.Rational(1, 3), H: sympy.Rational(-2, 7)}
    assert sympy.Rational(str(f.at("1/3", "-2/7"))) == f.to_sympy().subs(where)
    assert f(0.3, -0.2) == pytest.approx(float(f.at(0.3, -0.2)), rel=1e-9, abs=1e-12)


def test_substitution():
    f = RationalFunction("(t + h)/(1 + t*h)")
    assert f.substitute(RationalFunction("1/t"), RationalFunction("1/h")) == f
    with pytest.raises(ValueError, match="zero"):
        f.substitute(RationalFunction("t"), RationalFunction("-1/t"))


@pytest.mark.parametrize("form", ["string", "sympy", "callable", "given"])
def test_surfaces_from_any_form(form):
    texts = ("(1 - t^2)/(1 + t^2)", "2*t*h/(1 + t^2)", "h^3 - t")
    first = lambda t, h: (1 - t**2) / (1 + t**2)  # noqa: E731
    if form == "callable":
        surface = ParametricSurface(first, lambda t, h: 2 * t * h / (1 + t**2), lambda t, h: h**3 - t)
    elif form == "given":
        slope = ParametricSurface(*texts).diff(0, 1)
        slopes = {(0, 1): lambda t, h: np.moveaxis(slope(np.stack([t, h], -1)), -1, 0)}
        surface = ParametricSurface(first, *texts[1:], derivatives=slopes)
    else:
        surface = ParametricSurface(*(sympy.sympify(s.replace("^", "**")) if form == "sympy" else s for s in texts))
    exact = ParametricSurface(*texts)
    assert surface.is_exact == (form in ("string", "sympy"))
    np.testing.assert_allclose(surface(POINTS), exact(POINTS), rtol=1e-14)
    orders = [(0, 1)] if form == "given" else [(1, 0), (0, 1), (2, 1), (0, 3), (4, 0)]
    for order in orders:
        np.testing.assert_allclose(surface.derivative(POINTS, *order), exact.diff(*order)(POINTS), atol=1e-11)
    if form == "given":
        with pytest.raises(ValueError, match=r"orders \(1, 0\) is not among those given"):
            surface.derivative(POINTS, 1, 0)


@pytest.mark.parametrize(
    "text",
    [
        *("sin(t*h)", "cos(t) + tan(h)", "exp(t)*log(1 + h)", "sqrt(1 + t^2*h)", "sinh(t)*cosh(h)", "tanh(t*h)"),
        *("atan(t - h)", "asin(t*h)", "acos(t*h)", "(1 + t)^(1/3)", "t^h", "2^t", "Abs(t - 2)*h", "pi*E^h"),
    ],
)
def test_taylor_arithmetic_of_elementary_functions(text):
    surface = ParametricSurface(text, "t", "h")
    assert not surface.is_exact
    t, h = sympy.symbols("t h", positive=True)
    expression = sympy.sympify(text.replace("^", "**").replace("Abs(t - 2)", "(2 - t)"), locals={"t": t, "h": h})
    for i, j in [(0, 0), (1, 0), (0, 1), (2, 1), (1, 2), (3, 0)]:
        derivative = sympy.lambdify((t, h), sympy.diff(expression, t, i, h, j))
        expected = [float(derivative(a, b)) for a, b in POINTS]
        np.testing.assert_allclose(surface.derivative(POINTS, i, j)[:, 0], expected, rtol=1e-9, atol=1e-9)


def test_callables_without_taylor_series_are_differenced():
    table = lambda t, h: np.interp(t, [0, 1], [0, 1]) ** 3 * h  # noqa: E731
    surface = ParametricSurface(table, "t", "h")
    np.testing.assert_allclose(surface.derivative(POINTS, 1, 1)[:, 0], 3 * POINTS[:, 0] ** 2, rtol=1e-6)


def test_shapes_of_arrays_and_grids():
    surface = CYLINDER.with_domain(((0, 1), (0, 2)))
    points = RNG.uniform(0, 1, (2, 3, 2))
    assert surface(points).shape == (2, 3, 3) == surface.normals(points).shape
    assert surface.tangents(points).shape == (2, 3, 2, 3)
    assert surface([0.5, 0.5]).shape == (3,)
    t, h = np.linspace(0, 1, 5), np.linspace(0, 2, 4)
    mesh = np.stack(np.meshgrid(t, h, indexing="ij"), -1)
    np.testing.assert_allclose(surface.on_grid(t, h), surface(mesh), rtol=1e-14)


def test_normals_are_unit_and_normal():
    normals, tangents = SADDLE.normals(POINTS), SADDLE.tangents(POINTS)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1)
    np.testing.assert_allclose(np.einsum("...ij,...j", tangents, normals), 0, atol=1e-14)
    assert np.isnan(pas.elliptic_cone().normals([0.3, 0.0])).all()


@pytest.mark.parametrize(
    ("surface", "equation"),
    [
        (pas.plane((1, 2, 3), (1, 0, "1/2"), (0, 1, -1)), "z - 3 - (x - 1)/2 + (y - 2)"),
        (pas.elliptic_cylinder(2, "1/3"), "x^2/4 + 9*y^2 - 1"),
        (pas.elliptic_cone(2, 3), "x^2/4 + y^2/9 - z^2"),
        (pas.elliptic_paraboloid(2, 3), "x^2/4 + y^2/9 - z"),
        (pas.ellipsoid(1, 2, 3), "x^2 + y^2/4 + z^2/9 - 1"),
        (pas.one_sheet_hyperboloid(1, 2, 3), "x^2 + y^2/4 - z^2/9 - 1"),
        (pas.two_sheet_hyperboloid(1, 2, 3), "x^2 + y^2/4 - z^2/9 + 1"),
        (pas.torus(3, 1), "(x^2 + y^2 + z^2 + 8)^2 - 36*(x^2 + y^2)"),
        (pas.surface_of_revolution("1 + h^2", "h"), "x^2 + y^2 - (1 + z^2)^2"),
        (pas.tube(("t", "0", "0"), "1 + t^2", ("0", "1", "0"), ("0", "0", "1")), "y^2 + z^2 - (1 + x^2)^2"),
        (pas.ellipsoid().moved(((0, 0, 2), (1, 0, 0), (0, 1, 0)), (1, 0, 0)), "(x - 1)^2/4 + y^2 + z^2 - 1"),
    ],
)
def test_ready_made_surfaces_lie_on_their_equations(surface, equation):
    assert surface.implicit_residual(equation).is_zero
    points = surface(np.array([[0.3, 1.0], [-2.0, 1.0]]))
    np.testing.assert_allclose(pas.Polynomial(equation)(points), 0, atol=1e-12)


@pytest.mark.parametrize("make", [pas.torus, pas.ellipsoid, pas.one_sheet_hyperboloid, pas.two_sheet_hyperboloid])
def test_angles_in_place_of_rational_circles(make):
    surface, exact = make(angle=True), make()
    assert not surface.is_exact
    h = math.pi / 3 if make is pas.torus else 1.0
    half = math.tan(math.pi / 6) if make is pas.torus else 1.0
    np.testing.assert_allclose(surface([0.8, h]), exact([math.tan(0.4), half]), atol=1e-14)


def test_helicoid():
    surface = pas.helicoid(start=2)
    np.testing.assert_allclose(surface([0.7, 3]), [3 * math.sin(0.7), 3 * math.cos(0.7), 2.7])
    np.testing.assert_allclose(-surface.derivative([0.0, 2.0], 1, 0), [-2, 0, -1])


def test_curves_on_surfaces():
    curve = pas.SurfaceCurve(CYLINDER, "s^2", "1 + s")
    assert curve.components[2] == RationalFunction("1 + t")
    s = np.linspace(0.1, 1, 5)
    np.testing.assert_allclose(curve(s), CYLINDER(np.stack([s**2, 1 + s], -1)))
    exact = [c.diff(2, 0)(s, 0.0 * s) for c in curve.components]
    np.testing.assert_allclose(curve.derivative(s, 2), np.stack(exact, -1), atol=1e-13)
    for vectors in (curve.tangents(s), curve.across(s)):
        np.testing.assert_allclose(np.einsum("ij,ij->i", vectors, curve.normals(s)), 0, atol=1e-14)
    iso = pas.iso_curve(pas.helicoid(start=2), t=0)
    np.testing.assert_allclose(iso([0, 4]), [[0, 0, 2], [0, 4, 2]], atol=1e-15)
    wave = pas.SurfaceCurve(CYLINDER, "s", np.sin)
    np.testing.assert_allclose(wave.derivative(s)[:, 2], np.cos(s))
    with pytest.raises(ValueError, match="not exact"):
        _ = wave.components


def test_twenty_surfaces_of_order_three():
    surfaces = [pas.elliptic_cylinder(i + 1, 2).moved(offset=(0, 0, i)) for i in range(20)]
    blend = pas.hermite_blend(BlendingData(surfaces), 3)
    assert all(v.proved for v in blend.prove(effort=1).contacts)
    assert blend.surface.degrees == (2, 79)
    for i in range(20):
        np.testing.assert_allclose(blend.surface([0.4, i]), surfaces[i]([0.4, i]), rtol=1e-12)
    points = RNG.uniform((0, 8), (1, 11), (4, 2))
    exact = [[float(c) for c in blend.surface.at(float(a), float(b))] for a, b in points]
    np.testing.assert_allclose(blend.surface(points), exact, rtol=1e-11)
    weighted = pas.weighted_blend(BlendingData(surfaces), 3, normalized=True)
    np.testing.assert_allclose(weighted.surface([0.4, 7]), surfaces[7]([0.4, 7]), rtol=1e-12)


@pytest.mark.parametrize("make", [pas.hermite_blend, pas.weighted_blend])
def test_blends_of_surfaces_that_are_not_exact(make):
    numeric = ParametricSurface("cos(t)", "sin(t)", "h - 1"), ParametricSurface("2*cos(t)", "2*sin(t)", "exp(h)")
    blend = make(BlendingData(numeric), 2)
    assert not blend.surface.is_exact
    for i, verdict in enumerate(blend.prove().contacts):
        assert verdict.status is pas.Status.HOLDS_MEASURED and "not exact" in verdict.reason
        assert verdict.measured and not verdict.proved
        points = np.array([[0.3, i], [1.2, i]])
        for j, m in [(0, 0), (0, 1), (0, 2), (1, 1), (2, 0)]:
            expected = numeric[i].derivative(points, j, m)
            np.testing.assert_allclose(blend.surface.derivative(points, j, m), expected, atol=1e-12)
    with pytest.raises(ValueError, match=r"surfaces\[0\]: component x"):
        _ = blend.surface.components


@pytest.mark.parametrize("order", [0, 1, 3])
def test_derivatives_of_blends_agree_with_the_exact_ones(order):
    for blend in (
        pas.hermite_blend(BlendingData([CYLINDER, CONE, SADDLE], (0, "1/2", 2)), order),
        pas.weighted_blend(BlendingData([CYLINDER, CONE, SADDLE], (0, "1/2", 2)), order, (".2", ".5", ".9"), True),
    ):
        for i, j in [(0, 0), (1, 0), (0, 1), (1, 2)]:
            slopes = [c.diff(i, j) for c in blend.surface.components]
            expected = [[float(f.at(float(t), float(h))) for f in slopes] for t, h in POINTS[:3]]
            np.testing.assert_allclose(blend.surface.derivative(POINTS[:3], i, j), expected, rtol=1e-10, atol=1e-10)


def test_affine_invariance_of_normalised_weights():
    surfaces = [CYLINDER, CONE, SADDLE]
    shifted = [s.moved(offset=(5, -1, 2)) for s in surfaces]
    for normalized in (True, False):
        one, two = (pas.weighted_blend(BlendingData(s), 1, normalized=normalized).surface for s in (surfaces, shifted))
        assert (one.moved(offset=(5, -1, 2)).components == two.components) == normalized


def test_members_of_the_solutions():
    blend = pas.hermite_blend(BlendingData([CYLINDER, CONE]), 1)
    solutions = blend.all_solutions()
    member = solutions.member("1/(h + 1)", "t", "3")
    assert member.x == blend.surface.x + solutions.multiplier / RationalFunction("h + 1")
    assert solutions.coordinates(member) == (RationalFunction("1/(h + 1)"), RationalFunction("t"), RationalFunction(3))
    np.testing.assert_allclose(member(POINTS)[:, 2], member.z(POINTS[:, 0], POINTS[:, 1]))
    moved = ParametricSurface(*(c + 1 for c in blend.surface.components))
    assert not solutions.contains(moved)
    waved = solutions.member("sin(t)", "0", "0")
    np.testing.assert_allclose(waved.derivative([0.3, 1.0], 0, 1), CONE.derivative([0.3, 1.0], 0, 1))
    refuted = pas.hermite_blend(BlendingData([CYLINDER, CONE]), 0).surface
    data = BlendingData([CYLINDER, CONE])
    verdict = contact_verdicts(refuted, data, 1)[0]
    assert verdict.status is pas.Status.REFUTED and "of order 1 differ" in verdict.reason
    with pytest.raises(pas.GeometryError, match="R1 has a pole along h = 1"):
        solutions.member("1/(h^2 - 1)", "0", "0")


@pytest.mark.parametrize(
    ("surface", "status", "words"),
    [
        (CYLINDER.with_domain(((-1, 1), (0, 1))), pas.Status.PROVED, ""),
        (CYLINDER, pas.Status.PROVED, ""),
        (pas.elliptic_cone().with_domain(((-1, 1), ("1/3", 2))), pas.Status.PROVED, ""),
        (pas.elliptic_cone().with_domain(((-1, 1), (-1, 2))), pas.Status.REFUTED, "normal vanishes at t = "),
        (
            pas.elliptic_paraboloid().with_domain(((-1, 1), (0, 2))),
            pas.Status.REFUTED,
            "normal vanishes at t = -1, h = 0",
        ),
        (ParametricSurface("t^2", "h^2", "t*h", domain=((-1, 1), (-1, 1))), pas.Status.REFUTED, "at t = 0, h = 0"),
        (
            ParametricSurface("1/(t^2 - 2)", "h", "t", domain=((0, 3), (0, 1))),
            pas.Status.REFUTED,
            "denominator vanishes near t = 1.41",
        ),
        (ParametricSurface("t^2 - 2*t", "h", "h*t - t", domain=((0, 3), (0, 3))), pas.Status.REFUTED, "t = 1"),
        (ParametricSurface("sin(t)", "h", "t"), pas.Status.HOLDS_MEASURED, "degrees or more"),
        (ParametricSurface("cos(t)", "h", "t - sin(t)"), pas.Status.FAILS_MEASURED, "one of the two vanishes"),
        (  # far from 0, in a finite interval
            ParametricSurface("cos(t - 5)", "h", "cos(t - 5)", domain=((0, 10), None)),
            pas.Status.FAILS_MEASURED,
            "one of the two vanishes",
        ),
        (  # longer than doubles hold
            ParametricSurface("sin(t)", "h", "t", domain=((-1e308, 1e308), None)),
            pas.Status.HOLDS_MEASURED,
            "degrees or more",
        ),
        (
            ParametricSurface("t", "h", "1/sin(t)", domain=((-1, 1), (-1, 1))),
            pas.Status.UNDECIDED,
            "at 33 of 1089 points tried it has no finite tangents, as at t = 0, h = -1",
        ),
        (ParametricSurface("t", "h", "sqrt(t - 2)", domain=((0, 1), None)), pas.Status.UNDECIDED, "at 1089 of 1089"),
        (
            ParametricSurface("sin(t)", "h", "t/0.1 - t/(1/10)").with_domain(((0, 1), None)),
            pas.Status.HOLDS_MEASURED,
            "",
        ),
    ],
)
def test_regularity(surface, status, words):
    verdict = pas.regularity(surface)
    assert verdict.status is status
    assert words in verdict.reason


SIZES = [0, 154, -154, 155, -155, 159, -159, 200, -200, 300, -300, 400, -400, 1000, -1000]


@pytest.mark.parametrize("size", SIZES)
def test_regularity_at_any_size(size):
    """A common scale changes no verdict: products of two coordinates neither vanish nor overflow on the way."""
    unit = f"1e{size}"
    folded = [f"{unit}*({x})" for x in ("(t - 1/2)^3/3 - t/100", "h", "t*((h - 1/2)^2 - 1/100)")]
    verdict = pas.regularity(ParametricSurface(*folded, domain=((0, 1), (0, 1))))
    assert verdict.status is pas.Status.REFUTED and re.search("at t = [23]/5, h = [23]/5$", verdict.reason)
    graph = [f"{unit}*({x})" for x in ("t + t^2/3", "h/(1 + t)", "t*h")]
    assert pas.regularity(ParametricSurface(*graph, domain=((0, 1), (0, 1)))).proved
    mixed = ParametricSurface(f"t*{unit}", "h", f"t*h/{unit}", domain=((0, 1), (0, 1)))
    assert pas.regularity(mixed).proved


def test_regularity_up_to_the_very_end_of_the_domain():
    """The double next to 2/3 lies below it; the surface is singular at 2/3."""
    cusp = ParametricSurface("(t - 2/3)^2", "(t - 2/3)^3", "h", domain=((0, "2/3"), (0, 1)))
    verdict = pas.regularity(cusp)
    assert verdict.status is pas.Status.REFUTED and "t = 2/3" in verdict.reason
    for gap in (Fraction(1, 10**13), Fraction(1, 10**17)):
        short = cusp.with_domain(((0, Fraction(2, 3) - gap), (0, 1)))  # the simplest place near its end is outside
        assert pas.regularity(short).proved
    for power, scale in ((12, 1), (40, 1), (40, "1e-300")):
        pole = ParametricSurface(f"{scale}/(1 + 1/10^{power} - t)", "t", "h", domain=((0, 1), (0, 1)))
        assert pas.regularity(pole).proved
        pole = ParametricSurface(f"{scale}/(1 - 1/10^{power} - t)", "t", "h", domain=((0, 1), (0, 1)))
        assert pas.regularity(pole).status is pas.Status.REFUTED


def test_domains_that_doubles_do_not_hold():
    for domain in (((0, "1e400"), None), ((0, "1e-400"), None), (("1/3", "0.333333333333333333333333"), None)):
        with pytest.raises(ValueError, match="domain of t"):
            ParametricSurface("t", "h", "0", domain=domain)


def test_certificate_of_a_blend():
    data = BlendingData([s.with_domain(((-1, 1), None)) for s in (CYLINDER, CONE)])
    certificate = pas.hermite_blend(data, 2).prove()
    assert certificate.proved and len(certificate.verdicts) == 3
    assert "contact of order 2 with surfaces[1] at h = 1: proved" in str(certificate)
    with pytest.raises(TypeError, match=r"\.proved"):
        bool(certificate)


BAD = [
    (lambda: ParametricSurface("u", "t", "h"), ValueError, "component x.*'u' is not one of t, h"),
    (lambda: ParametricSurface(sympy.Symbol("q"), "t", "h"), ValueError, "'q'"),
    (lambda: ParametricSurface("t +", "t", "h"), ValueError, "cannot read the expression"),
    (lambda: ParametricSurface("1/(t - t)", "t", "h"), ValueError, "divides by zero"),
    (lambda: ParametricSurface("t", "f(t)", "h"), ValueError, "no function 'f'"),
    (lambda: ParametricSurface("t", "h", math.sin), TypeError, "component z: the callable must take two"),
    (lambda: ParametricSurface("t", "h", None), TypeError, "component z"),
    (lambda: ParametricSurface("t", "h", "1", ("t", "t")), ValueError, "two different names"),
    (lambda: ParametricSurface("t", "h", "1", domain=((1, 0), None)), ValueError, "domain of t .*low < high"),
    (lambda: ParametricSurface("t", "h", "1", domain=3), ValueError, "two intervals"),
    (lambda: CYLINDER.with_domain(((0, 1), None))([2, 0]), ValueError, r"t = 2 lies outside the domain \[0, 1\]"),
    (lambda: CYLINDER.with_domain(((0, 1), None))([math.nan, 0]), ValueError, "outside the domain"),
    (lambda: CYLINDER([1, 2, 3]), ValueError, r"shape \(\.\.\., 2\)"),
    (lambda: CYLINDER.derivative([0, 0], -1), ValueError, "first must be a whole number"),
    (
        lambda: ParametricSurface("sin(t)", "t", "h").x,
        ValueError,
        "exact surface.*component x: 'sin.*sin is not rational",
    ),
    (lambda: ParametricSurface("sin(t)", "t", "h").implicit_residual("x"), ValueError, "exact surface"),
    (lambda: RationalFunction("t^(1/2)"), ValueError, "not a whole number"),
    (lambda: RationalFunction("1/h").at(1, 0), ValueError, "pole at t = 1, h = 0"),
    (lambda: BlendingData([CYLINDER]), ValueError, "from 2 to 32 surfaces, not 1"),
    (lambda: BlendingData([CYLINDER, "t"]), TypeError, r"surfaces\[1\] must be a ParametricSurface"),
    (lambda: BlendingData([CYLINDER, CONE], (1, "1")), ValueError, r"values\[0\] and values\[1\] are both 1"),
    (lambda: BlendingData([CYLINDER, CONE], (1, 2, 3)), ValueError, "2 surfaces but 3 values"),
    (
        lambda: BlendingData([CYLINDER, CYLINDER.with_domain((None, (0, "1/2")))]),
        pas.GeometryError,
        r"not defined at h = 1: its domain",
    ),
    (
        lambda: BlendingData([CYLINDER, ParametricSurface("t", "h/(h - 1)", "0")]),
        pas.GeometryError,
        r"surfaces\[1\] is not defined at h = 1: the denominator of y",
    ),
    (lambda: BlendingData([CYLINDER, ParametricSurface("log(h - 3)", "t", "h")]), pas.GeometryError, "no finite value"),
    (lambda: pas.hermite_blend([CYLINDER, CONE], 1), TypeError, "BlendingData"),
    (
        lambda: pas.hermite_blend(BlendingData([CYLINDER, CONE]), -1),
        ValueError,
        "order must be a whole number from 0 to 8",
    ),
    (lambda: pas.weighted_blend(BlendingData([CYLINDER, CONE]), 1, 1), ValueError, "strictly between 0 and 1, not 1"),
    (lambda: pas.weighted_blend(BlendingData([CYLINDER, CONE]), 1, (".1", ".2", ".3")), ValueError, "one number or 2"),
    (
        lambda: pas.weighted_blend(BlendingData([CYLINDER, CONE]), 2, exponent=2),
        ValueError,
        "exponent must be a whole number from 3 to 24",
    ),
    (
        lambda: pas.weighted_blend(BlendingData([CYLINDER, ParametricSurface("t/h", "h", "1")]), 1),
        pas.GeometryError,
        r"surfaces\[1\] is not defined at h = 0",
    ),
    (
        lambda: pas.has_polynomial_solution(BlendingData([CYLINDER, ParametricSurface("sin(t)", "h", "1")]), 1),
        ValueError,
        r"needs exact surfaces; surfaces\[1\]",
    ),
    (
        lambda: pas.hermite_blend(
            BlendingData([CYLINDER.with_domain(((0, 1), None)), CONE.with_domain(((2, 3), None))]), 1
        ),
        pas.GeometryError,
        "no t in common",
    ),
    (lambda: pas.torus(1, 2), ValueError, "minor must be less than major"),
    (lambda: pas.ellipsoid(1, 0, 1), ValueError, "b must be positive, not 0"),
    (lambda: pas.plane(first=(1, 2, 3), second=(2, 4, 6)), ValueError, "parallel"),
    (lambda: pas.helicoid(0), ValueError, "pitch must not be 0"),
    (lambda: pas.iso_curve(CYLINDER), ValueError, "exactly one of t and h"),
    (lambda: pas.iso_curve(CYLINDER.with_domain((None, (0, 1))), h=2), ValueError, "outside the domain"),
    (lambda: pas.SurfaceCurve(CYLINDER, "q", "s"), ValueError, "'q' is not one of s"),
]


@pytest.mark.parametrize(("action", "error", "words"), BAD)
def test_bad_input_is_refused_in_one_sentence(action, error, words):
    with pytest.raises(error, match=words) as caught:
        action()
    assert "\n" not in str(caught.value)


def test_values_need_not_be_in_order():
    blend = pas.weighted_blend(BlendingData([CYLINDER, CONE], ("3/2", "-1/2")), 2, "1/3")
    assert blend.surface.domain[1] == (-0.5, 1.5)
    assert not any(p.inside for p in blend.weights.poles())
    assert all(v.proved for v in blend.prove(effort=1).contacts)
    assert blend.surface.at(0, "1/2") == tuple(map(Fraction, (blend.surface.at(0, "1/2"))))


def test_values_and_derivatives_of_a_blend_are_the_exact_ones():
    """Circles: x and y stand over 1 + t^2, z over 1."""
    ring = ("(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)")
    data = pas.BlendingData([pas.ParametricSurface(*(f"{r}*{c}" for c in ring), f"h + {r}") for r in (1, "5/2", 3)])
    blend = pas.hermite_blend(data, 2)
    points = np.random.default_rng(3).uniform(0, 2, (20, 2))
    exact = lambda f: np.array([float(f.at(*map(Fraction, p))) for p in points.tolist()])  # noqa: E731
    for orders in ((0, 0), (1, 0), (0, 1), (2, 1)):
        expected = np.stack([exact(c.diff(*orders)) for c in blend.surface.components], axis=-1)
        assert np.allclose(blend.surface.derivative(points, *orders), expected, rtol=1e-10, atol=1e-10)
    grid = blend.surface.on_grid(points[:5, 0], points[:7, 1])
    assert np.allclose(grid[2, 3], blend.surface(np.array([points[2, 0], points[3, 1]])))
