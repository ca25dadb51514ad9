"""A solid along a curve: the arcs on which nothing changes, and what of its boundary meets in each.

The values of a linear form at which surfaces of the solid cross the curve, touch one another there or are
singular cut the curve into arcs.  At one exact point of each it is seen on which sides of which surfaces
the solid lies; only those inequalities cut on which that rests.  Nothing here is approximate, but for
functions that are no polynomials: of distances from curves and faces (`pas.solid.tube`, `pas.solid.shell`) it is known
that small boxes are certainly inside or outside.  Boxes that may meet the curve and of which they do not say so are
halved until they are small; between the values that the sweeping form has in those left the truth is unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from flint import arb, ctx, fmpq

from pas.algebra.curve import SpaceCurve
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import exact_vector
from pas.algebra.roots import FIRST_BITS, RealRoot, between, bounds, rational_root
from pas.algebra.zeros import RealZero, value_at
from pas.arrays import Bools, Floats
from pas.bernstein.search import Boxes, Fate, Fates, Limits, search
from pas.limits import checkpoint
from pas.solid.germs import Ray, Sheets
from pas.solid.tree import Atom, ScalarField
from pas.solid.truths import LeafTree, depends_on, support_of, value_of

Slab = tuple[RealRoot | None, RealRoot | None]
"""Two values of the sweeping form (None: without end), between which arcs are looked at."""


@dataclass(frozen=True)
class Border:
    """A ray on the boundary of the solid, with those of the names asked for whose faces it lies on."""

    ray: Ray
    names: frozenset[str]


@dataclass(frozen=True)
class Arc:
    """A point of the curve with the `borders` of the solid there and, alike, all along its arc.

    The sweeping form has the value `plane` there.  `unknown` is a leaf, by number, on which the borders
    depend, but of which it is not known whether it holds there.
    """

    point: RealZero
    plane: fmpq
    borders: tuple[Border, ...]
    unknown: int | None


def arcs(
    sheets: Sheets, solid: LeafTree, nearby: AlongCurve, names: Sequence[str], walls: Sequence[Polynomial] = ()
) -> list[Arc]:
    """All arcs of a part of a curve, each once or in pieces that adjoin; the part must be reduced.

    None of them crosses one of some walls.
    """
    part = sheets.part
    assert part.turns is not None
    at_walls = (root for wall in walls if not part.contains(wall) for root in part.crossings(wall))
    slabs = _slabs(None, {*part.turns, *sheets.cuts, *at_walls}, None)
    result = []
    while slabs:
        checkpoint("looking at a solid along a curve")
        slab = slabs.pop()
        plane = between(*slab)
        views = [Around(sheets, solid, nearby, point, slab) for point in part.points(plane)]
        found = [view.arc(plane, names) for view in views]
        cuts = {root for view in views for leaf in view.doubts for root in view.cuts(leaf)}
        if cuts:
            slabs += _slabs(slab[0], cuts, slab[1])
        else:
            result += found
    return result


def _slabs(low: RealRoot | None, cuts: set[RealRoot], high: RealRoot | None) -> list[Slab]:
    return list(pairwise([low, *sorted(cuts), high]))


class Around:
    """A solid near one point of a curve, and how far along the arc that stays valid in a slab.

    `doubts` are leaves, by number, on which answers rested, and which may change their truth in the slab.
    """

    def __init__(self, sheets: Sheets, solid: LeafTree, nearby: AlongCurve, point: RealZero, slab: Slab) -> None:
        self.sheets, self.solid, self.nearby, self.point, self.slab = sheets, solid, nearby, point, slab
        self.doubts: set[int] = set()
        self.cuts, self._sign = cache(self._cuts), cache(lambda number: point.sign(solid.polynomials[number]))

    def arc(self, plane: fmpq, names: Sequence[str]) -> Arc:
        """The borders along the arc, if there is no doubt."""
        borders = tuple(self._borders(names)) if self.nearby.may_hold(self.point) else ()
        return Arc(self.point, plane, borders, min(self.doubts, default=None))

    def may_matter(self, number: int) -> bool:
        """Whether the solid may depend on a leaf close to the point."""
        unknown = dict.fromkeys(range(len(self.sheets.regular)))
        return depends_on(self.solid.code, number, lambda n: self._holds(n, unknown))

    def _cuts(self, number: int) -> list[RealRoot]:
        """Values inside the slab at which the truth of a leaf may change."""
        polynomial, _ = self.solid.signed[number]
        if polynomial in self.sheets.factors:
            return []
        crossings = self.sheets.part.crossings
        roots = self.nearby.cuts(number) if polynomial < 0 else crossings(self.solid.polynomials[polynomial])
        low, high = self.slab
        return [r for r in roots if (low is None or low < r) and (high is None or r < high)]

    def _borders(self, names: Sequence[str]) -> Iterator[Border]:
        for sheet, regular in enumerate(self.sheets.regular):
            if not regular:  # where its rays are is not known
                self.doubts |= {n for n in self._across(sheet) if self.may_matter(n)}
            for side in (1, -1) if regular else ():
                ray = Ray(sheet, side)
                signs = self.sheets.signs(ray, self.point)
                sides = [{**signs, sheet: sign} for sign in (-1, 1)]
                plain = [self._says(there, ()) for there in sides]
                if plain[0] is plain[1]:
                    continue
                own = {n: [i for i in self._across(sheet) if self.solid.leaves[i].face == n] for n in names}
                turned = {n: [self._says(there, leaves) for there in sides] for n, leaves in own.items()}
                yield Border(ray, frozenset(n for n, found in turned.items() if found != plain))

    def _across(self, sheet: int) -> list[int]:
        """The leaves that change their truth across a sheet, by number."""
        powers = {number: dict(f.sheets).get(sheet, 0) for number, f in self.sheets.factors.items()}
        return [i for i, (polynomial, _) in enumerate(self.solid.signed) if powers.get(polynomial, 0) % 2]

    def _says(self, signs: dict[int, int | None], turned: Sequence[int]) -> bool | None:
        """Whether the solid is where sheets have given signs, with some leaves negated; records doubts."""
        known: dict[int, bool | None] = {}

        def truth(number: int) -> bool | None:
            if number not in known:
                holds = self._holds(number, signs)
                known[number] = not holds if number in turned and holds is not None else holds
            return known[number]

        said = value_of(self.solid.code, truth)
        if said is None:
            self.doubts |= {n for n in [*known] if known[n] is None and depends_on(self.solid.code, n, truth)}
        else:
            self.doubts |= support_of(self.solid.code, said, truth, self._is_fixed)
        return said

    def _holds(self, number: int, signs: dict[int, int | None]) -> bool | None:
        polynomial, _ = self.solid.signed[number]
        if polynomial < 0:
            return self.nearby.holds(number, self.point)
        factors = self.sheets.factors.get(polynomial)
        if factors is None:
            sign = self._sign(polynomial)
            return self.solid.holds(number, sign) if sign else None
        sign = factors.sign
        for sheet in (sheet for sheet, power in factors.sheets if power % 2):
            found = signs[sheet]
            if found is None:
                return None
            sign *= found
        for other, power in factors.others:
            sign *= self.point.sign(other) ** power
        return self.solid.holds(number, sign) if sign else None

    def _is_fixed(self, number: int) -> bool:
        if self.solid.signed[number][0] < 0 and not self.nearby.is_fixed(number, self.slab):
            return False
        return not self.cuts(number)


class AlongCurve:
    """The leaves of a solid that are no polynomials, along a curve.

    `box()` gives two corners (2, 3) between which the solid lies; it is asked for only where it is needed.
    """

    def __init__(self, leaves: Sequence[Atom], curve: SpaceCurve, box: Callable[[], Floats]) -> None:
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
        half = np.full((1, 3), 1e-12 * np.ptp(self._box))  # a point's coordinates are rounded
        inside, outside = self._fields[number].decided(np.array([point.point]), half)
        return bool(inside[0]) != self._outside[number] if inside[0] or outside[0] else None

    def distance(self, number: int, point: RealZero) -> float:
        """About how far the zeros of a leaf's function are from a point; 0 for polynomials."""
        field = self._fields.get(number)
        return 0.0 if field is None else abs(float(field.jets(np.array([point.point]))[0, 0]))

    def cuts(self, number: int) -> list[RealRoot]:
        """The ends of the intervals in which a leaf's truth is unknown."""
        return [end for interval in self._unknown[number] for end in interval]

    def is_fixed(self, number: int, slab: Slab) -> bool:
        """Whether a leaf's truth is known in a slab that no end of an interval cuts."""
        low, high = slab
        return not any(
            (high is None or start < high) and (low is None or low < end) for start, end in self._unknown[number]
        )

    def _intervals(self, field: ScalarField, curve: SpaceCurve) -> list[tuple[RealRoot, RealRoot]]:
        """Disjoint intervals of the form's values in boxes where a function is not decided.

        A box of the solid that is cut seven times into eighths is a 128th of it, and 2000 of them are a long curve's.
        """

        def judge(boxes: Boxes, _: int) -> Fates:
            return np.where(_may_change(field, curve, boxes), Fate.SPLIT, Fate.SETTLED)

        found = search(Boxes.of(self._box), judge, Boxes.eighths, Limits(7, 2000), "following a curve past a face").open
        values = sorted(bounds(_over(curve.form, *box)) for box in zip(found.centers, found.halves, strict=True))
        merged: list[tuple[fmpq, fmpq]] = []
        for low, high in values:
            if merged and low <= merged[-1][1]:
                merged[-1] = (merged[-1][0], max(merged[-1][1], high))
            else:
                merged.append((low, high))
        return [(rational_root(low), rational_root(high)) for low, high in merged]


def _may_change(field: ScalarField, curve: SpaceCurve, boxes: Boxes) -> Bools:
    """Which boxes may meet the curve, without that a function says on which side they are."""
    reach = boxes.halves * (1 + 1e-9)  # rounding leaves no gap between them
    inside, outside = field.decided(boxes.centers, reach)
    result = ~(np.asarray(inside) | np.asarray(outside))
    for row in np.flatnonzero(result):
        result[row] = all(_over(p, boxes.centers[row], reach[row]).contains(0) for p in curve.pair)
    return result


def _over(polynomial: Polynomial, center: Floats, half: Floats) -> arb:
    """A ball that holds all values of a polynomial in a box, by its expansion about the centre."""
    shift = [Polynomial.from_raw(g + c) for g, c in zip(GENERATORS, exact_vector(center.tolist()), strict=True)]
    with ctx.workprec(FIRST_BITS):
        return value_at(polynomial.compose(*shift), tuple(arb(0, float(h)) for h in half))
