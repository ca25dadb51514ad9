"""Each rule of the proofs about parametric surfaces, broken alone: exactly its verdict changes."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from random import Random

import numpy as np
import pytest
from exact_distances import off_spline, square_distance
from flint import fmpq, fmpq_poly
from parametric_cases import ONE, H, T

import pas
from pas.algebra.rational import rational
from pas.parametric.blends import ParametricBlend, hermite_blend
from pas.parametric.common_zeros import UNIT_SQUARE, avoids_origin, without_common_zero
from pas.parametric.data import BlendingData, contact_verdicts
from pas.parametric.fitting import FittedPatch, _bound, _outer, even_knots
from pas.parametric.generatrix.verdicts import is_injective, positive_on_unit_square, regularity
from pas.parametric.meshing import bounded
from pas.parametric.nets import Framed, Nets, PlacedNets, exact_net, exact_rectangle
from pas.parametric.series import rounded_roots
from pas.parametric.surface import ParametricSurface
from pas.verdicts import Status

UNIT = ((0, 1), (0, 1))
TINY = Fraction(1, 10**40)
VALUES = (Fraction(0), Fraction(1), Fraction(2))
ORDER = 1
W = [(H - s) ** (ORDER + 1) for s in VALUES]
ALL = W[0] * W[1] * W[2]


def base() -> ParametricBlend:
    """Three graphs over one plane, all claims proved."""
    heights = "(t - 1/2)^2*(h - 1/2)", "t*h/3", "t^2/5 - h"
    data = BlendingData([ParametricSurface("t", "h", z, domain=((0, 1), None)) for z in heights], VALUES)
    return hermite_blend(data, ORDER)


def changed(blend: ParametricBlend, terms: dict[int, object]) -> ParametricBlend:
    parts = [c + terms.get(axis, 0) for axis, c in enumerate(blend.surface.components)]
    return replace(blend, surface=ParametricSurface(*parts, domain=blend.surface.ends))


BREAKS = {
    **{
        f"contact {i}, order {j}, {axis}": (
            {"xyz".index(axis): TINY * (H - VALUES[i]) ** j * W[(i + 1) % 3] * W[(i + 2) % 3]},
            i,
        )
        for i in range(3)
        for j, axis in ((0, "x"), (ORDER, "y"), (0, "z"), (ORDER, "z"))
    },
    **{f"pole of {axis}": ({"xyz".index(axis): ALL / (T - Fraction(1, 3))}, 3) for axis in "xyz"},
    **{f"pole of {axis} at the end": ({"xyz".index(axis): ALL / (1 - T)}, 3) for axis in "xyz"},
}


@pytest.mark.parametrize("name", BREAKS)
def test_each_claim_of_a_blend_alone(name):
    blend = base()
    assert blend.prove().proved
    terms, number = BREAKS[name]
    verdicts = changed(blend, terms).prove().verdicts
    assert [v.status for v in verdicts] == [Status.REFUTED if i == number else Status.PROVED for i in range(4)], (
        verdicts
    )


def test_a_normal_that_vanishes_between_the_curves():
    """x is made constant along h = 1/2, z level at t = 1/2 there: dP/dt = 0 at one point, contacts as they were."""
    blend = base()
    level = blend.surface.z.diff(1, 0).at("1/2", "1/2")
    scale = Fraction(1) / ALL.at("1/2", "1/2")
    verdicts = changed(blend, {0: -T * ALL * scale, 2: -T * ALL * scale * level}).prove().verdicts
    assert [v.status for v in verdicts] == [Status.PROVED] * 3 + [Status.REFUTED]
    assert "normal vanishes at t = 1/2, h = 1/2" in verdicts[3].reason


def test_terms_beyond_the_order_break_nothing():
    assert changed(base(), {2: ALL * (1 + T) / 50}).prove().proved


def test_contact_with_a_surface_that_is_not_defined_there():
    """Identities alone would pass: both sides are multiplied by denominators that vanish."""
    blend = base()
    data = blend.data
    assert blend.surface.components
    undefined = ParametricSurface(T, H, T / (H - 1), domain=((0, 1), None))
    object.__setattr__(data, "surfaces", (data.surfaces[0], undefined, data.surfaces[2]))
    statuses = [v.status for v in contact_verdicts(blend.surface, data, ORDER)]
    assert statuses == [Status.PROVED, Status.REFUTED, Status.PROVED]
    same = [v.status for v in contact_verdicts(undefined, data, ORDER)]
    assert same[1] is Status.REFUTED


@pytest.mark.parametrize("order", [-1, True, 0.5, "1"])
def test_orders_are_checked(order):
    blend = base()
    with pytest.raises((ValueError, TypeError), match="order must be"):
        contact_verdicts(blend.surface, blend.data, order)
    with pytest.raises((ValueError, TypeError), match="order must be"):
        replace(blend, order=order)


POLYNOMIALS = {
    "no zero": ([T * T + 1], Status.PROVED),
    "a margin of 1e-40, left": ([T + TINY], Status.PROVED),
    "a zero 1e-40 inside, left": ([T - TINY], Status.REFUTED),
    "a margin of 1e-40, top": ([1 + TINY - H], Status.PROVED),
    "a zero 1e-40 inside, top": ([1 - TINY - H], Status.REFUTED),
    "a zero at a corner": ([(T - 1) * (T - 1) + (H - 1) * (H - 1)], Status.REFUTED),
    "a double zero along a line": ([(T - Fraction(1, 2)) ** 2], Status.REFUTED),
    "a zero at thirds": ([(T - Fraction(1, 3)) ** 2 + (H - Fraction(2, 3)) ** 2], Status.REFUTED),
    "two without a zero in common": ([T - Fraction(1, 3), 3 * T - 1 + H * TINY + TINY], Status.PROVED),
    "two with one": ([T - Fraction(1, 3), (H - Fraction(1, 4)) * (T + 1)], Status.REFUTED),
    "irrational, isolated": ([T * T - Fraction(1, 2), H * H - Fraction(1, 2)], Status.UNDECIDED),
    "raised by little": ([(T * T - Fraction(1, 2)) ** 2 + TINY], Status.PROVED),
    "of different sizes": ([(T - 1) * Fraction(10) ** 900, (H + 1) / Fraction(10) ** 900], Status.PROVED),
    "nothing at all": ([ONE * 0, ONE * 0], Status.REFUTED),
}


@pytest.mark.parametrize("scale", [0, -170, 170, -400, 400])
@pytest.mark.parametrize("name", POLYNOMIALS)
def test_common_zeros(name, scale):
    polynomials, status = POLYNOMIALS[name]
    scaled = [p.numerator * fmpq(10) ** scale for p in polynomials]
    outcome = without_common_zero(scaled, UNIT_SQUARE, 5000)
    assert outcome.status is status
    if outcome.exact:
        assert all(p(*outcome.place) == 0 for p in scaled)


@pytest.mark.parametrize(
    ("function", "positive"),
    [
        (T + TINY, True),
        (-T - TINY, False),
        (T, False),
        (1 / (1 - T), False),
        ((T - 2) / (H - 3), True),
        ((T - 2) / (3 - H), False),
        (ONE * 0, False),
        (ONE / 10**400, True),
        (ONE * -1, False),
    ],
    ids=str,
)
def test_positive_functions(function, positive):
    assert positive_on_unit_square(function) is positive


C = Fraction(1, 10**40)
DOUBLE = {
    "folded in the middle": ("(t - 1/2)^2", "h", "0"),
    "folded next to the end": (T * T - C * T, H, ONE * 0),
    "a loop": ("(2*t-1)^2", "(2*t-1)^3 - (2*t-1)/4", "h"),
    "closed": ("t*(1 - t)", "h", "t*(1-t)*(t-1/2)"),
    "a square": ("t^2", "h", "0"),
    "monotone in one direction alone": ("t", "2*h^2 - h", "0"),
    "a turn": (
        "((2*t - 1) + 3)^5 - 10*((2*t - 1) + 3)^3*(6*h - 3)^2 + 5*((2*t - 1) + 3)*(6*h - 3)^4",
        "h*(h - 1)",
        "0",
    ),
    "a pole": ("1/(t - 1/2)", "h", "0"),
}


@pytest.mark.parametrize("name", DOUBLE)
def test_double_points_are_never_proved_away(name):
    for scale in (1, Fraction(10) ** 200, Fraction(10) ** -1000):
        x, y, z = (pas.RationalFunction(c) * scale for c in DOUBLE[name])
        assert not is_injective(ParametricSurface(x, y, z, domain=UNIT))
        assert not is_injective(ParametricSurface(z, x, y, domain=UNIT))


@pytest.mark.parametrize("degrees", [(1, 1), (2, 5), (9, 3)])
def test_rounding_is_bounded(degrees):
    """Coefficients rounded and halved again and again stay within the bound, which is as large as the theorem says."""
    draw = Random(sum(degrees))
    n, m = degrees
    exact = [[Fraction(draw.randint(-(10**20), 10**20), 10**20) for _ in range(m + 1)] for _ in range(n + 1)]
    net = np.array([[float(c) for c in row] for row in exact])[None, ..., None]
    nets = Nets(net, np.full((1, n + 1, m + 1), 2.0**-53))

    def half(rows, axis, side):
        rows = rows if axis else [list(r) for r in zip(*rows, strict=True)]
        rows = [halved_row(row, side) for row in rows]
        return rows if axis else [list(r) for r in zip(*rows, strict=True)]

    def fractions(array):
        return [[Fraction(x) for x in row] for row in array.tolist()]

    for count in range(30):
        axis, side = count % 2, draw.randrange(2)
        added = (degrees[axis] + 3) * Fraction(1, 2**53)
        known = zip(fractions(nets.off[0]), fractions(np.abs(nets.table[0, ..., 0])), strict=True)
        least = half([[o + added * c for o, c in zip(*rows, strict=True)] for rows in known], axis, side)
        nets = nets.halves(axis).select(np.array([side]))
        exact = half(exact, axis, side)
        offs, values = fractions(nets.off[0]), fractions(nets.table[0, ..., 0])
        for i, j in np.ndindex(n + 1, m + 1):
            assert abs(values[i][j] - exact[i][j]) <= offs[i][j] >= least[i][j]


@pytest.mark.parametrize("sign", [1, -1])
def test_vectors_avoid_the_origin_beyond_their_rounding(sign):
    """One coordinate of one sign, or a slanting direction: what is within the rounding of zero is not settled."""
    off = np.array([1e-13])
    for size, settled in ((0.9, False), (1.1, True)):
        assert avoids_origin(np.full((1, 2, 2, 1), sign * size * off[0]), off)[0] == settled
    assert avoids_origin(np.array([[[[1.0, -2.0], [-2.0, 1.0]]]]) * sign, off)[0]
    assert not avoids_origin(np.array([[[[1.0, -1.0], [-1.0, 1.0 + 1e-13]]]]) * sign, off)[0]


def halved_row(row: list[Fraction], side: int) -> list[Fraction]:
    """De Casteljau's subdivision in the middle."""
    found = []
    while row:
        found.append(row[-1 if side else 0])
        row = [(a + b) / 2 for a, b in pairwise(row)]
    return found[::-1] if side else found


@pytest.mark.parametrize("far", [0, 10**6, 10**12])
@pytest.mark.parametrize("weight", ["1", "1 + 10^4*t^2", "1 + (t - h)^2"])
def test_bounds_of_cells_count_their_rounding(far, weight):
    """|P - B| for the bilinear B of the rounded corners, exactly, on cells halved down to a small one."""
    surface = ParametricSurface(f"{far} + t/(3*({weight}))", f"{far}/7 + h/3", f"t*(1-h)/({weight})", domain=UNIT)
    exact = exact_net(surface, ((fmpq(0), fmpq(1)), (fmpq(0), fmpq(1))))
    nets, low, size, draw = exact.rounded(), [Fraction(0), Fraction(0)], [Fraction(1), Fraction(1)], Random(far)
    finite = 0
    for step in range(12):
        look = bounded(nets)
        if np.isfinite(look.slack).all():
            finite += 1
            reach = Fraction(float(np.linalg.norm(look.errors[0], axis=-1).max())) + Fraction(float(look.slack[0]))
            for _ in range(6):
                u, v = (Fraction(draw.randint(0, 8), 8) for _ in range(2))
                shares = ((1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v)
                corners = look.corners[0].reshape(4, 3)
                middle = [
                    sum(s * Fraction(float(c)) for s, c in zip(shares, corners[:, k], strict=True)) for k in range(3)
                ]
                point = surface.at(low[0] + size[0] * u, low[1] + size[1] * v)
                assert square_distance(point, middle) <= reach**2
        axis, side = step % 2, draw.randrange(2)
        nets = nets.halves(axis).select(np.array([side]))
        size[axis] /= 2
        low[axis] += side * size[axis]
    assert finite > 6, "bounds were looked at"


@pytest.mark.parametrize("far", [0, 10**7])
def test_points_of_cells_count_their_rounding(far):
    """Corners and middles of halved nets are within what is said of them."""
    surface = ParametricSurface(f"{far} + (t - 40)^12/10^9", "h/(1 + t^2)", "t*h", domain=((39, 42), (0, "1/3")))
    framed = Framed.of(surface)
    net = exact_net(surface, exact_rectangle(surface), framed).rounded()
    cells = PlacedNets(net.table, net.off, np.zeros((1, 2), dtype=object), np.zeros((1, 2), dtype=int))
    for number in range(12):
        halves = cells.halves(number % 2)
        cells = halves.select(np.random.default_rng(number).permutation(len(halves))[:8])
    seen = bounded(cells)
    shares = [(a, b) for a in (0, 1) for b in (0, 1)] + [(Fraction(1, 2), Fraction(1, 2))]
    for start, steps, points, bound in zip(cells.start, cells.steps.tolist(), seen.points, seen.away, strict=True):
        assert bound < 1e-12
        for point, share in zip(points, shares, strict=True):
            places = [Fraction(s + w) / 2**n for s, w, n in zip(start, share, steps, strict=True)]
            at = [rational(a + (b - a) * place) for (a, b), place in zip(surface.ends, places, strict=True)]
            true = [
                (c.numerator(*at) / c.denominator(*at) - rational(z)) / fmpq(2) ** framed.exponent
                for c, z in zip(surface.components, framed.center.tolist(), strict=True)
            ]
            exact = [Fraction(int(x.p), int(x.q)) for x in true]
            assert square_distance([Fraction(float(x)) for x in point], exact) <= Fraction(float(bound)) ** 2


@pytest.mark.parametrize(
    ("surface", "tolerance"),
    [
        (ParametricSurface("t - 10^6", "h", "t*h/10^9", domain=(("1000000.3", "3000004/3"), ("1/3", "2/3"))), 1e-6),
        (ParametricSurface("t/(1 + 100*t^2)", "h/(1 + 100*t^2)", "t", domain=((0, 1), (0, 1))), 0.1),
        (ParametricSurface("t", "h", "1/(20000*(1001/1000 - t))", domain=((0, 1), (0, 1))), 5),
    ],
    ids=["knots", "weights", "near a pole"],
)
def test_bounds_of_splines(surface, tolerance):
    """Exactly: where knots are rounded, and where weights differ within a span."""
    patch, draw = pas.fit_patch(surface, tolerance), Random(1)
    assert patch.certified and patch.deviation <= tolerance
    assert max(off_spline(surface, patch, draw) for _ in range(60)) <= Fraction(patch.deviation) ** 2


def test_bounds_of_splines_count_their_knots():
    """Control points as good as can be, but knots of 10^6 and some thirds, which no doubles are."""
    interval = fmpq(3000001, 3), fmpq(3000004, 3)
    surface = ParametricSurface("t - 10^6", "h", "0", domain=(("3000001/3", "3000004/3"), (0, 1)))
    knots = even_knots((0.0, 1.0), 1), even_knots((0.0, 1.0), 1)
    sites = np.array([0.0, 1 / 3, 2 / 3, 1.0])
    points = np.stack(np.broadcast_arrays(1 / 3 + sites[:, None], sites[None, :], 0.0), axis=-1)
    outer, moved = zip(_outer(knots[0], interval), _outer(knots[1], (fmpq(0), fmpq(1))), strict=True)
    away = _bound(exact_net(surface, (interval, (fmpq(0), fmpq(1)))).rounded(), knots, points, moved)
    patch = FittedPatch(points, np.ones((4, 4)), outer, None, away, True)
    assert max(off_spline(surface, patch, Random(2)) for _ in range(20)) <= Fraction(away) ** 2
    assert away < 1e-8


@pytest.mark.parametrize("below", range(3, 9))
def test_a_change_of_sign_must_be_beyond_rounding(below):
    """Along t = 1/2 it is positive by 1e-30, which rounded coefficients do not show."""
    factor = 1 + T / below + H / (below + 4) + T * H / (below + 6)
    positive = ((T - Fraction(1, 2)) ** 2 * factor + Fraction(1, 10**30)).numerator
    assert without_common_zero([positive], UNIT_SQUARE, 5000).status is not Status.REFUTED


@pytest.mark.parametrize("effort", [1, 2, 3, 10, 30, 100, 300])
def test_effort_that_is_spent_proves_nothing(effort):
    polynomials = [p.numerator for p in (T * T - Fraction(1, 2), H * H - T * T)]
    outcome = without_common_zero(polynomials, UNIT_SQUARE, effort)
    assert outcome.status is Status.UNDECIDED and outcome.cells <= effort
    assert without_common_zero(polynomials, UNIT_SQUARE, 0).status is Status.UNDECIDED


def test_factors_that_are_multiple_and_irrational():
    """Without their multiplicity they change sign where they vanish."""
    stopped = ParametricSurface("t^5/5 - t^3/3 + t/4", "h", "h^2", domain=UNIT)  # dx/dt = (t^2 - 1/2)^2
    pole = ParametricSurface("t", "h", "1/(t^2 - 1/2)^2", domain=UNIT)
    for surface in (stopped, pole):
        verdict = regularity(surface)
        assert verdict.status is Status.REFUTED and "near t = 0.707" in verdict.reason


def test_a_saddle_over_one_cell():
    """The bilinear interpolant is the surface, the two triangles are not: off by a quarter of the twist."""
    mesh = ParametricSurface("t", "h", "t*h", domain=UNIT).mesh(0.3)
    assert len(mesh.triangles) == 2 and 0.25 <= mesh.deviation <= 0.251


ROOTS = [0, 1, TINY, 1 - TINY, -TINY, 1 + TINY, Fraction(1, 10**1000), 1 - Fraction(1, 10**1000), Fraction(1, 3)]


@pytest.mark.parametrize("first", ROOTS)
@pytest.mark.parametrize("second", ROOTS)
def test_roots_near_the_ends(first, second):
    polynomial = fmpq_poly([-2, 0, 1])
    for root in (first, second):
        polynomial = polynomial * fmpq_poly([-fmpq(Fraction(root).numerator, Fraction(root).denominator), 1])
    inside = sorted({Fraction(r) for r in (first, second) if 0 <= r <= 1})
    assert rounded_roots(polynomial, fmpq(0), fmpq(1)) == [float(r) for r in inside]
    assert len(rounded_roots(polynomial)) == 2 + len({first, second})


def test_weights_with_a_pole_next_to_a_value():
    """Of the pole between the values, not of the one outside, whatever a double says."""
    weights = pas.Weights([0, "1/100000000000000000001", 1], 0, exponent=1)
    assert all(pole.inside == (0 < pole.h < 1) or pole.h in (0.0, 1.0) for pole in weights.poles())


def test_regularity_of_each_component():
    """A pole of any component alone, and tangents that are parallel though neither vanishes."""
    for axis in range(3):
        parts = [T, H, T * H]
        parts[axis] = parts[axis] + 1 / (T - Fraction(1, 7))
        verdict = regularity(ParametricSurface(*parts, domain=UNIT))
        assert verdict.status is Status.REFUTED and "denominator" in verdict.reason
    parallel = ParametricSurface(T + H, T + H + (T - H) ** 3, ONE * 0, domain=UNIT)
    assert regularity(parallel).status is Status.REFUTED
