"""Seeded blends with contacts that are true by construction, and the same broken in one place.

With W_i = prod_{l != i} (h - s_l)^(k+1) a term c t^a (h - s_i)^j W_i in one coordinate, j <= k, takes contact of order
k with surface i away, keeps order j - 1, and touches no other contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import prod
from random import Random

from parametric_cases import ONE, POWERS, H, Map, T, number, polynomial, positive

from pas.algebra.rational_function import RationalFunction
from pas.parametric.blends import hermite_blend, weighted_blend
from pas.parametric.data import BlendingData
from pas.parametric.hermite import hermite_basis
from pas.parametric.surface import ParametricSurface


@dataclass(frozen=True)
class ContactCase:
    """A surface with blending data, an order, and whether each contact of that order is one."""

    surface: ParametricSurface
    data: BlendingData
    order: int
    true: tuple[bool, ...]
    kind: str


def contact_case(seed: int) -> ContactCase:
    """The case of a number."""
    draw = Random(seed)
    count, order = draw.choice((2, 2, 3)), draw.randint(0, 3)
    scale = Fraction(10) ** draw.choice(POWERS)
    values = draw.sample([Fraction(n, d) for n in range(-6, 7) for d in (1, 3, 7) if n % d or d == 1], count)
    surfaces = [_surface(draw, scale, draw.random() < 0.5) for _ in values]
    data = BlendingData(surfaces, values)
    blend = weighted_blend if draw.random() < 0.3 and count == 2 else hermite_blend
    parts = blend(data, order).surface.components
    broken = draw.randrange(count)
    kind = draw.choice(list(BREAKS))
    beyond = _others(data, order + 1, broken) * _step(data, broken) ** (order + 1)  # changes nothing up to order k
    parts = _plus(parts, draw.randrange(3), beyond * number(draw))
    changed = BREAKS[kind](draw, parts, data, order, broken)
    true = tuple(changed is None or i != broken for i in range(count))
    made = ParametricSurface(*(parts if changed is None else changed))
    return ContactCase(made, data, order, true, f"{seed}: {kind} {blend.__name__} of order {order}, surface {broken}")


def _surface(draw: Random, scale: Fraction, rational: bool) -> ParametricSurface:
    below = positive(draw) if rational else ONE
    parts = (T + polynomial(draw, 2, 2), H + polynomial(draw, 2, 2), polynomial(draw, 3) / below)
    return ParametricSurface(*(p * scale for p in parts))


def _others(data: BlendingData, order: int, number: int) -> RationalFunction:
    """W_i."""
    values = [Fraction(int(v.p), int(v.q)) for v in data.values]
    return prod(((H - s) ** (order + 1) for i, s in enumerate(values) if i != number), start=ONE)


def _step(data: BlendingData, number: int) -> RationalFunction:
    value = data.values[number]
    return H - Fraction(int(value.p), int(value.q))


def _plus(parts: Map, axis: int, term: RationalFunction) -> Map:
    x, y, z = (p + term if i == axis else p for i, p in enumerate(parts))
    return x, y, z


def nothing(draw: Random, parts: Map, data: BlendingData, order: int, broken: int) -> None:
    """The blend itself."""
    return


def one_coefficient(draw: Random, parts: Map, data: BlendingData, order: int, broken: int) -> Map:
    """One coefficient off by little, at any order up to k."""
    size = Fraction(10) ** -draw.choice((3, 40, 40, 300)) * T ** draw.randint(0, 3)
    term = ONE * size * _step(data, broken) ** draw.randint(0, order) * _others(data, order, broken)
    return _plus(parts, draw.randrange(3), term)


def one_order_lower(draw: Random, parts: Map, data: BlendingData, order: int, broken: int) -> Map:
    """Contact of order k - 1 and no more."""
    return _plus(
        parts, draw.randrange(3), _step(data, broken) ** order * _others(data, order, broken) * (number(draw) or 1)
    )


def wrong_curve(draw: Random, parts: Map, data: BlendingData, order: int, broken: int) -> Map:
    """The curve moved within its plane, all derivatives across it kept."""
    basis = hermite_basis([Fraction(int(v.p), int(v.q)) for v in data.values], order)
    return _plus(parts, draw.randrange(3), basis[broken][0] * (T + number(draw)) * Fraction(1, 10**12))


def normal_turned(draw: Random, parts: Map, data: BlendingData, order: int, broken: int) -> Map | None:
    """The first derivative across the curve negated; none at order 0, where that breaks nothing."""
    if order == 0:
        return None
    basis = hermite_basis([Fraction(int(v.p), int(v.q)) for v in data.values], order)
    slopes = [d * 1 for d in data.coefficients(broken, 1)[1]]
    if all(s.is_zero for s in slopes):
        return None
    x, y, z = (p - 2 * s * basis[broken][1] for p, s in zip(parts, slopes, strict=True))
    return x, y, z


Break = Callable[[Random, Map, BlendingData, int, int], Map | None]
BREAKS: dict[str, Break] = {
    f.__name__: f for f in (nothing, one_coefficient, one_order_lower, wrong_curve, normal_turned)
}
