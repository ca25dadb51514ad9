"""Functions that are no polynomials along a curve: where they are certainly of one sign.

Distances from curves and faces (`pas.solid.tube`, `pas.solid.shell`) say of small boxes that they are
certainly inside or outside.  Boxes that may meet the curve and of which they do not say so are halved
until they are small; between the values that a linear form has in those left the truth is unknown.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from flint import arb, ctx, fmpq

from pas.algebra.curve import SpaceCurve
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.roots import FIRST_BITS, RealRoot, bounds, rational_root
from pas.algebra.zeros import RealZero, value_at
from pas.bernstein.search import Boxes, Fate, Fates, Limits, search
from pas.solid.reading import Leaf
from pas.solid.tree import Bools, Field

LIMITS = Limits(depth=7, cells=2000)
"""How often the solid's box is cut, and boxes left open at which that ends early."""

SMALL = 1e-12
"""Half of a box about a point, over the extent."""

OVERLAP = 1e-9
"""By which boxes are larger than their share, so that rounding leaves no gap between them."""

Interval = tuple[RealRoot, RealRoot]


class Nearby:
    """The leaves of a solid that are no polynomials, along a curve.

    `box()` gives two corners (2, 3) between which the solid lies; it is asked for only where it is needed.
    """

    def __init__(self, leaves: list[Leaf], curve: SpaceCurve, box: Callable[[], Floats]) -> None:
        self._outside = [leaf.outside for leaf in leaves]
        self._fields = {i: leaf.function for i, leaf in enumerate(leaves) if not isinstance(leaf.function, Polynomial)}
        self._box = box() if self._fields else np.zeros((2, 3))
        self._unknown = {i: self._intervals(field, curve) for i, field in self._fields.items()}

    def may_hold(self, point: RealZero) -> bool:
        """False only where the solid certainly does not reach a point."""
        p = np.array(point.point)
        return not self._fields or bool(((p >= self._box[0]) & (p <= self._box[1])).all())

    def holds(self, number: int, point: RealZero) -> bool | None:
        """Whether a leaf holds at a point; None where that is not certain."""
        half = np.full((1, 3), SMALL * np.ptp(self._box))
        inside, outside = self._fields[number].decided(np.array([point.point]), half)
        return bool(inside[0]) != self._outside[number] if inside[0] or outside[0] else None

    def distance(self, number: int, point: RealZero) -> float:
        """About how far the zeros of a leaf's function are from a point; 0 for polynomials."""
        field = self._fields.get(number)
        return 0.0 if field is None else abs(float(field.jets(np.array([point.point]))[0, 0]))

    def cuts(self, number: int) -> list[RealRoot]:
        """The ends of the intervals in which a leaf's truth is unknown."""
        return [end for interval in self._unknown[number] for end in interval]

    def is_fixed(self, number: int, slab: tuple[RealRoot | None, RealRoot | None]) -> bool:
        """Whether a leaf's truth is known in a slab that no end of an interval cuts."""
        low, high = slab
        return not any(
            (high is None or start < high) and (low is None or low < end) for start, end in self._unknown[number]
        )

    def _intervals(self, field: Field, curve: SpaceCurve) -> list[Interval]:
        """Disjoint intervals of the form's values in boxes where a function is not decided."""

        def judge(boxes: Boxes, _: int) -> Fates:
            return np.where(_may_change(field, curve, boxes), Fate.SPLIT, Fate.SETTLED)

        found = search(Boxes.of(self._box), judge, Boxes.eighths, LIMITS, "following a curve past a face").open
        values = sorted(bounds(_over(curve.form, *box)) for box in zip(found.centers, found.halves, strict=True))
        merged: list[tuple[fmpq, fmpq]] = []
        for low, high in values:
            if merged and low <= merged[-1][1]:
                merged[-1] = (merged[-1][0], max(merged[-1][1], high))
            else:
                merged.append((low, high))
        return [(rational_root(low), rational_root(high)) for low, high in merged]


def _may_change(field: Field, curve: SpaceCurve, boxes: Boxes) -> Bools:
    """Which boxes may meet the curve, without that a function says on which side they are."""
    reach = boxes.halves * (1 + OVERLAP)
    inside, outside = field.decided(boxes.centers, reach)
    result = ~(np.asarray(inside) | np.asarray(outside))
    for row in np.flatnonzero(result):
        result[row] = all(_over(p, boxes.centers[row], reach[row]).contains(0) for p in curve.pair)
    return result


def _over(polynomial: Polynomial, center: Floats, half: Floats) -> arb:
    """A ball that holds all values of a polynomial in a box, by its expansion about the centre."""
    shift = [Polynomial({(0, 0, 0): float(c), _unit(i): 1}) for i, c in enumerate(center)]
    with ctx.workprec(FIRST_BITS):
        return value_at(polynomial.compose(*shift), tuple(arb(0, float(h)) for h in half))


def _unit(axis: int) -> tuple[int, int, int]:
    return (int(axis == 0), int(axis == 1), int(axis == 2))
