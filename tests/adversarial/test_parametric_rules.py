"""Each rule of the proofs about parametric surfaces, broken alone: exactly its verdict changes."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from flint import fmpq, fmpq_poly
from parametric_cases import ONE, H, T

import pas
from pas.bernstein.signs import Status
from pas.generatrix.injective import is_injective
from pas.parametric.blends import ParametricBlend, hermite_blend
from pas.parametric.common_zeros import UNIT_SQUARE, without_common_zero
from pas.parametric.data import BlendingData
from pas.parametric.proofs import contact_verdicts
from pas.parametric.regularity import positive_on_unit_square, regularity
from pas.parametric.roots import roots_and_sides, roots_between
from pas.parametric.surface import ParametricSurface

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
    with pytest.raises(ValueError, match="order must be a whole number"):
        contact_verdicts(blend.surface, blend.data, order)
    with pytest.raises(ValueError, match="order must be a whole number"):
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
    "a pole": ("1/(t - 1/2)", "h", "0"),
}


@pytest.mark.parametrize("name", DOUBLE)
def test_double_points_are_never_proved_away(name):
    for scale in (1, Fraction(10) ** 200, Fraction(10) ** -1000):
        x, y, z = (pas.RationalFunction(c) * scale for c in DOUBLE[name])
        assert not is_injective(ParametricSurface(x, y, z, domain=UNIT))
        assert not is_injective(ParametricSurface(z, x, y, domain=UNIT))


ROOTS = [0, 1, TINY, 1 - TINY, -TINY, 1 + TINY, Fraction(1, 10**1000), 1 - Fraction(1, 10**1000), Fraction(1, 3)]


@pytest.mark.parametrize("first", ROOTS)
@pytest.mark.parametrize("second", ROOTS)
def test_roots_near_the_ends(first, second):
    polynomial = fmpq_poly([-2, 0, 1])
    for root in (first, second):
        polynomial = polynomial * fmpq_poly([-fmpq(Fraction(root).numerator, Fraction(root).denominator), 1])
    inside = sorted({Fraction(r) for r in (first, second) if 0 < r < 1})
    assert roots_between(polynomial, fmpq(0), fmpq(1)) == [float(r) for r in inside]
    assert len(roots_and_sides(polynomial, fmpq(0), fmpq(1))) == 2 + len({first, second})


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
