"""Blending data, surfaces P_i(t, h) each to be met where h has its value s_i, and proofs that they are met.

The Taylor coefficients of P_i in h at s_i, up to the order k, are all that a blend must agree with
(Perez-Diaz and Sendra 2003).  They are rational functions of t; where these have poles, and where
numerator and denominator of P_i vanish together (base points), no blend helps: such t are reported.

Contact of order k at h = s_i: for T = A/B and P_i = C/D the Taylor coefficients of A D - C B in h at s_i
vanish up to order k, as polynomials in t, and B, D do not vanish identically at s_i.  Then (and only
then) all partial derivatives up to order k agree along the curve.  How T was made is not used.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from flint import fmpq, fmpq_poly

from pas.algebra.brief import brief
from pas.algebra.inputs import MOST_SURFACES, check_order, set_fields, short, shown
from pas.algebra.rational import Exact, plain, rational, three, to_float, to_fraction
from pas.algebra.rational_function import ONE, RationalFunction
from pas.errors import GeometryError
from pas.parametric.hermite import distinct
from pas.parametric.maps import Ends, ExactDomain
from pas.parametric.nets import finite_part
from pas.parametric.series import Components, rounded_roots, taylor, univariate
from pas.parametric.surface import ParametricSurface
from pas.verdicts import Status, Verdict, Verdicts

AXES = "xyz"


class PointKind(Enum):
    """The behaviour at an isolated t: the curve has a pole, or numerator and denominator vanish together."""

    POLE = "pole"
    BASE_POINT = "base point"


@dataclass(frozen=True)
class IsolatedPoint:
    """A real t at which surface number `surface` is not defined on the curve h = `value`.

    `axis` names the component, `factor` the irreducible factor of its denominator that vanishes.
    """

    surface: int
    axis: str
    t: float
    value: fmpq
    factor: str
    kind: PointKind

    def __str__(self) -> str:
        where = f"({self.t:.6g}, {short(plain(self.value))}), where {short(str(self.factor))} = 0"
        return f"surfaces[{self.surface}].{self.axis} has a {self.kind.value} at {where}"


@dataclass(frozen=True, init=False)
class BlendingData:
    """Surfaces and the value s_i of the second parameter at which each is met.

    `values` are distinct numbers, 0, 1, ..., n-1 where they are not given.  Surface i contributes the curve
    `surfaces[i](t, values[i])`.

    Raises `ValueError` or `TypeError` for fewer than two surfaces or equal values, `GeometryError` for a
    surface that is not defined at its value.
    """

    surfaces: tuple[ParametricSurface, ...]
    values: tuple[fmpq, ...]

    __repr__ = brief

    def __init__(self, surfaces: Sequence[ParametricSurface], values: Sequence[Exact] | None = None) -> None:
        items = tuple(surfaces)
        for i, item in enumerate(items):
            if not isinstance(item, ParametricSurface):
                raise TypeError(f"surfaces[{i}] must be a ParametricSurface, not {shown(item)}")
        if not 2 <= len(items) <= MOST_SURFACES:
            raise ValueError(f"a blend meets from 2 to {MOST_SURFACES} surfaces, not {len(items)}")
        at = distinct(range(len(items)) if values is None else values)
        if len(at) != len(items):
            raise ValueError(f"there are {len(items)} surfaces but {len(at)} values; give one value for each")
        set_fields(self, surfaces=items, values=at)
        for i, value in enumerate(at):
            self.require_defined(i, value)

    @property
    def ends(self) -> ExactDomain:
        """Where a blend is defined: the common t of all surfaces, h from the least value to the greatest; exact."""
        lows, highs = ([e for s in self.surfaces if (e := s.ends[0][side]) is not None] for side in (0, 1))
        low, high = max(lows, default=None), min(highs, default=None)
        if low is not None and high is not None and not low < high:
            raise GeometryError(
                f"the domains of the surfaces have no t in common (from {float(low):.6g} to {float(high):.6g})"
            )
        return (low, high), (to_fraction(min(self.values)), to_fraction(max(self.values)))

    @property
    def degrees(self) -> tuple[int, ...]:
        """The total degree of each surface."""
        return tuple(surface.degree for surface in self.surfaces)

    @property
    def curve_degrees(self) -> tuple[int, ...]:
        """The degree of each curve surfaces[i](t, values[i])."""
        return tuple(max(c.degree for c in self.curve(i)) for i in range(len(self.surfaces)))

    def curve(self, number: int) -> Components:
        """The exact curve surfaces[number](t, values[number])."""
        return self.coefficients(number, 0)[0]

    def coefficients(self, number: int, order: int) -> list[Components]:
        """Exact Taylor coefficients in h of one surface at its value, j = 0..order, as functions of t."""
        parts = (_series(c, self.values[number], order) for c in self.surfaces[number].components)
        return [three(row) for row in zip(*parts, strict=True)]

    def isolated_points(self, everywhere: bool = False) -> tuple[IsolatedPoint, ...]:
        """Every real t of the domain at which a surface is not defined on its curve, and why.

        With `everywhere` also on the curves of the others, which matters for weights.
        """
        return tuple(
            point
            for i, (surface, value) in enumerate(zip(self.surfaces, self.values, strict=True))
            for axis, component in zip(AXES, surface.components, strict=True)
            for at in (self.values if everywhere else (value,))
            for point in _isolated(i, axis, component, at, surface.ends[0])
        )

    def require_exact(self) -> None:
        """Raise `ValueError` unless all surfaces are exact."""
        for i, surface in enumerate(self.surfaces):
            if not surface.is_exact:
                raise ValueError(f"this needs exact surfaces; surfaces[{i}] is not one: {surface.inexact}")

    def require_defined(self, number: int, value: fmpq) -> None:
        """Raise `GeometryError` where surface `number` is not defined at h = `value`."""
        surface = self.surfaces[number]
        name = f"surfaces[{number}] is not defined at {surface.parameters[1]} = {short(plain(value))}"
        if not surface.contains(value, 1):
            low, high = surface.domain[1]
            raise GeometryError(f"{name}: its domain there is [{low:.6g}, {high:.6g}]")
        if surface.is_exact:
            for axis, component in zip(AXES, surface.components, strict=True):
                if taylor(component.denominator, value, 0)[0].is_zero():
                    raise GeometryError(f"{name}: the denominator of {axis} vanishes there for every t; move its value")
            return
        low, high = finite_part(surface.domain[0])
        places = low + (high - low) * np.array([1, 2, 3, 5, 6]) / 7
        if not np.isfinite(surface.with_domain(None).on_grid(places, to_float(value))).all(axis=-1).any():
            raise GeometryError(f"{name}: it has no finite value there")

    def __str__(self) -> str:
        return f"{len(self.surfaces)} surfaces at " + ", ".join(str(to_fraction(v)) for v in self.values)


def _series(component: RationalFunction, value: fmpq, order: int) -> list[RationalFunction]:
    """Division of series: c_j = N_j / d_0^(j+1), N_j = n_j d_0^j - sum_l d_l d_0^(l-1) N_(j-l)."""
    above = taylor(component.numerator, value, order)
    below = taylor(component.denominator, value, order)
    powers = [below[0] ** j for j in range(order + 2)]
    tops: list[fmpq_poly] = []
    for j in range(order + 1):
        rest = sum((below[m] * powers[m - 1] * tops[j - m] for m in range(1, j + 1)), fmpq_poly([0]))
        tops.append(above[j] * powers[j] - rest)
    return [
        RationalFunction.quotient(univariate(top, 0), univariate(bottom, 0))
        for top, bottom in zip(tops, powers[1:], strict=True)
    ]


def _isolated(number: int, axis: str, component: RationalFunction, value: fmpq, ends: Ends) -> list[IsolatedPoint]:
    above, below = (taylor(p, value, 0)[0] for p in (component.numerator, component.denominator))
    found = []
    for factor, _ in below.factor()[1]:
        kind = PointKind.BASE_POINT if above.gcd(factor).degree() > 0 else PointKind.POLE
        text = str(RationalFunction.quotient(univariate(factor, 0), ONE))
        roots = rounded_roots(factor, *(None if end is None else rational(end) for end in ends))
        found += [IsolatedPoint(number, axis, root, value, text, kind) for root in roots]
    return sorted(found, key=lambda p: p.t)


@dataclass(frozen=True)
class ParametricCertificate(Verdicts):
    """All verdicts about one blend: one on each contact, one on regularity."""

    contacts: tuple[Verdict, ...]
    regular: Verdict

    __repr__ = brief

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        return (*self.contacts, self.regular)


def contact_verdicts(surface: ParametricSurface, data: BlendingData, order: int) -> tuple[Verdict, ...]:
    """One verdict for each surface of the data on the contact of order `order` of any surface with it.

    Raises `ValueError` for a negative order.
    """
    k = check_order(order)
    return tuple(_contact(surface, data.surfaces[i], value, i, k) for i, value in enumerate(data.values))


def contact_order(first: RationalFunction, second: RationalFunction, value: fmpq, highest: int) -> int:
    """The greatest j <= highest up to which all derivatives in h agree at h = value; -1 for none."""
    if any(taylor(f.denominator, value, 0)[0].is_zero() for f in (first, second)):
        return -1
    difference = first.numerator * second.denominator - second.numerator * first.denominator
    return next((j - 1 for j, c in enumerate(taylor(difference, value, highest)) if not c.is_zero()), highest)


def _contact(surface: ParametricSurface, other: ParametricSurface, value: fmpq, number: int, order: int) -> Verdict:
    name = surface.parameters[1]
    claim = f"contact of order {order} with surfaces[{number}] at {name} = {short(plain(value))}"
    if not surface.is_exact or not other.is_exact:
        return _compared(surface, other, value, order, claim)
    for axis, mine, theirs in zip(AXES, surface.components, other.components, strict=True):
        reached = contact_order(mine, theirs, value, order)
        if reached < order:
            return Verdict(Status.REFUTED, claim, f"the derivatives of {axis} of order {reached + 1} differ")
    return Verdict(Status.PROVED, claim, f"all derivatives up to order {order} are identical")


def _compared(surface: ParametricSurface, other: ParametricSurface, value: fmpq, order: int, claim: str) -> Verdict:
    """The verdict by derivatives at points along the curve, where identities are out of reach."""
    samples, interval = 64, finite_part(surface.domain[0])
    points = np.column_stack([np.linspace(*interval, samples), np.full(samples, to_float(value))])
    worst, size, compared = 0.0, 0.0, 0
    for j in range(order + 1):
        both = np.stack([s.with_domain(None).derivative(points, 0, j) for s in (surface, other)])
        known = both[:, np.isfinite(both).all(axis=(0, 2))]
        size, compared = max(size, float(np.abs(known).max(initial=0.0))), compared + known.shape[1]
        off = float(np.abs(known[0] / 2 - known[1] / 2).max(initial=0.0))  # halves, whose difference is finite
        worst = max(worst, 2 * (off / size) if size > 0 else 0.0)
    if not compared:
        return Verdict(
            Status.UNDECIDED, claim, f"not exact data; no derivative is finite at the {samples} points tried"
        )
    reason = f"not exact data; the derivatives at {samples} points differ by {worst:.1e} of their size at most"
    agree = worst <= 1e-3  # differences in place of derivatives of the sixth order err by 1e-4
    return Verdict(Status.HOLDS_MEASURED if agree else Status.FAILS_MEASURED, claim, reason)
