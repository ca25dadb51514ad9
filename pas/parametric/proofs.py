"""What is proved of a parametric blend: its contacts, by exact identities, and that it is regular.

Contact of order k at h = s_i: for T = A/B and P_i = C/D the Taylor coefficients of A D - C B in h at s_i
vanish up to order k, as polynomials in t, and B, D do not vanish identically at s_i.  Then (and only
then) all partial derivatives up to order k agree along the curve.  How T was made is not used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from flint import fmpq, fmpq_poly

from pas.algebra.brief import brief
from pas.algebra.inputs import check_order, short
from pas.algebra.rational import plain, to_float
from pas.algebra.rational_function import RationalFunction
from pas.parametric.data import AXES, BlendingData
from pas.parametric.series import taylor
from pas.parametric.surface import ParametricSurface
from pas.verdicts import Status, Verdict, Verdicts


@dataclass(frozen=True)
class ParametricCertificate(Verdicts):
    """All verdicts about one blend: one on each contact, one on regularity."""

    contacts: tuple[Verdict, ...]
    regular: Verdict

    __repr__ = brief

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """All verdicts in the order of proof."""
        return (*self.contacts, self.regular)


def contact_verdicts(surface: ParametricSurface, data: BlendingData, order: int) -> tuple[Verdict, ...]:
    """One verdict for each surface of the data on the contact of order `order` of any surface with it.

    Raises `ValueError` for a negative order.
    """
    k = check_order(order)
    return tuple(_contact(surface, data.surfaces[i], value, i, k) for i, value in enumerate(data.values))


def contact_order(first: RationalFunction, second: RationalFunction, value: fmpq, highest: int) -> int:
    """The greatest j <= highest up to which all derivatives in h agree at h = value; -1 for none."""
    parts = (first.numerator, first.denominator, second.numerator, second.denominator)
    a, b, c, d = (taylor(p, value, highest) for p in parts)
    if b[0].is_zero() or d[0].is_zero():
        return -1
    for j in range(highest + 1):
        difference = sum((a[m] * d[j - m] - c[m] * b[j - m] for m in range(j + 1)), fmpq_poly([0]))
        if not difference.is_zero():
            return j - 1
    return highest


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
    """What derivatives at points along the curve say, where identities are out of reach."""
    samples, (low, high) = 64, surface.domain[0]
    start = low if math.isfinite(low) else min(-1.0, high - 1.0)
    stop = high if math.isfinite(high) else start + 2.0
    points = np.column_stack([np.linspace(start, stop, samples), np.full(samples, to_float(value))])
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
