"""A solid along a curve: the arcs on which nothing changes, and what of its boundary meets in each.

The values of a linear form at which surfaces of the solid cross the curve, touch one another there or are
singular cut the curve into arcs.  At one exact point of each it is seen on which sides of which surfaces
the solid lies; only those inequalities cut on which that rests.  Nothing here is approximate, but for
functions that are no polynomials (see `pas.solid.leaves`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from flint import fmpq

from pas.algebra.roots import RealRoot, between
from pas.algebra.zeros import RealZero
from pas.limits import checkpoint
from pas.solid.germs import Ray, Sheets
from pas.solid.leaves import AlongCurve, LeafTree

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


def arcs(sheets: Sheets, solid: LeafTree, nearby: AlongCurve, names: Sequence[str]) -> list[Arc]:
    """All arcs of a part of a curve, each once or in pieces that adjoin; the part must be reduced."""
    part = sheets.part
    assert part.turns is not None
    slabs = _slabs(None, {*part.turns, *sheets.cuts}, None)
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
    """A solid around one point of a curve, and what of that holds along its arc in a slab.

    `doubts` are leaves, by number, on which answers rested, and which may change their truth in the slab.
    """

    def __init__(self, sheets: Sheets, solid: LeafTree, nearby: AlongCurve, point: RealZero, slab: Slab) -> None:
        self.sheets, self.solid, self.nearby, self.point, self.slab = sheets, solid, nearby, point, slab
        self.doubts: set[int] = set()
        self._signs: dict[int, int] = {}
        self._cuts: dict[int, list[RealRoot]] = {}

    def arc(self, plane: fmpq, names: Sequence[str]) -> Arc:
        """What is on the boundary along the arc, if there is no doubt."""
        borders = tuple(self._borders(names)) if self.nearby.may_hold(self.point) else ()
        return Arc(self.point, plane, borders, min(self.doubts, default=None))

    def may_matter(self, number: int) -> bool:
        """Whether the solid may depend on a leaf close to the point."""
        unknown = dict.fromkeys(range(len(self.sheets.regular)))
        return self.solid.matters(number, lambda n: self._holds(n, unknown))

    def cuts(self, number: int) -> list[RealRoot]:
        """Values inside the slab at which the truth of a leaf may change."""
        if number not in self._cuts:
            self._cuts[number] = self._found_cuts(number)
        return self._cuts[number]

    def _found_cuts(self, number: int) -> list[RealRoot]:
        leaf = self.solid.leaves[number]
        if leaf.number in self.sheets.factors:
            return []
        polynomial = leaf.number >= 0
        crossings = self.sheets.part.crossings if polynomial else None
        roots = crossings(self.solid.polynomials[leaf.number]) if crossings else self.nearby.cuts(number)
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
        return [i for i, leaf in enumerate(self.solid.leaves) if powers.get(leaf.number, 0) % 2]

    def _says(self, signs: dict[int, int | None], turned: Sequence[int]) -> bool | None:
        """Whether the solid is where sheets have given signs, with some leaves' truth turned round; notes doubts."""
        known: dict[int, bool | None] = {}

        def truth(number: int) -> bool | None:
            if number not in known:
                holds = self._holds(number, signs)
                known[number] = not holds if number in turned and holds is not None else holds
            return known[number]

        says = self.solid.says(truth)
        if says is None:
            self.doubts |= {n for n in [*known] if known[n] is None and self.solid.matters(n, truth)}
        else:
            self.doubts |= self.solid.rests_on(says, truth, self._is_fixed)
        return says

    def _holds(self, number: int, signs: dict[int, int | None]) -> bool | None:
        leaf = self.solid.leaves[number]
        if leaf.number < 0:
            return self.nearby.holds(number, self.point)
        factors = self.sheets.factors.get(leaf.number)
        if factors is None:
            sign = self._sign(leaf.number)
            return leaf.holds(sign) if sign else None
        sign = factors.sign
        for sheet in (sheet for sheet, power in factors.sheets if power % 2):
            found = signs[sheet]
            if found is None:
                return None
            sign *= found
        for other, power in factors.others:
            sign *= self.point.sign(other) ** power
        return leaf.holds(sign) if sign else None

    def _sign(self, number: int) -> int:
        if number not in self._signs:
            self._signs[number] = self.point.sign(self.solid.polynomials[number])
        return self._signs[number]

    def _is_fixed(self, number: int) -> bool:
        leaf = self.solid.leaves[number]
        if leaf.number < 0 and not self.nearby.is_fixed(number, self.slab):
            return False
        return not self.cuts(number)
