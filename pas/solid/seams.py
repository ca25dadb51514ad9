"""The curves along which faces of a solid touch, each given by two functions that vanish on it.

Where two faces touch, their own two functions do not say where.  What says it is a claimed joint; the line along which
a plane touches a cylinder or cone; a plane face on which the one goes on as the other; else a wall that
cuts one of the surfaces where the other one touches it.  Two faces may touch along several curves, as a blend does
along both circles in which a pipe that goes through it ends: where all of them are cut from one surface f by functions
h, the faces' seam is f = 0 with the product of the h, so that each point is sought on the curve that is nearest to it.
And where two faces continue each other across a plane, that is no boundary, though a lattice sees three functions.

A plane face may also cut two others that touch there and go on smoothly, as where a bend joins a pipe.  That they touch
all along the section is proved.  That the one bounds the solid before the plane and the other behind it is seen at some
places; where it is not so, they may cross elsewhere, and the section says nothing of that.

Not guaranteed: of curves that have no function in common only the first is a seam.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, combinations_with_replacement, product
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.affine import slope_at
from pas.algebra.ideal import Ideal
from pas.algebra.lengths import lengths, unit
from pas.algebra.polynomial import Polynomial, residue_place
from pas.algebra.rational import cross, to_floats
from pas.arrays import Bools, Floats
from pas.solid.evaluator import TreeEvaluator
from pas.solid.functions import polynomials_of
from pas.solid.sections import SLACK, multiples, smooth_sections, tangent_line, touch_along
from pas.solid.tree import Tree, atoms

Curve = tuple[Polynomial, Polynomial]


@dataclass(frozen=True)
class Seam:
    """Two functions, and the ideals of the curves that are their common zeros; the order is 0 where faces cross."""

    functions: Curve
    curves: tuple[Ideal, ...]
    order: int = 1

    @cached_property
    def _place(self) -> list[fmpq] | None:
        """A point of the curve where that is a line."""
        if any(f.degree != 1 for f in self.functions):
            return None
        rows = [slope_at(f) for f in self.functions]
        if not any(along := cross(*rows)):
            return None
        heights = [-f.raw(0, 0, 0) for f in self.functions]
        return list(fmpq_mat([*rows, [*along]]).solve(fmpq_mat(3, 1, [*heights, fmpq(0)])).entries())

    @cached_property
    def marks(self) -> list[tuple[int, ...] | None]:
        """A place modulo a prime for each curve, where members of its ideal vanish; see `residue_place`."""
        return [residue_place(*curve.generators) for curve in self.curves]

    def joins(self, first: Sequence[Polynomial], second: Sequence[Polynomial]) -> bool:
        """Whether surfaces that hold the curves touch along each, or may cross; else they may cross elsewhere, too."""
        pairs = [*product(first, second)]
        return self.order == 0 or all(any(touch_along(*pair, curve) for pair in pairs) for curve in self.curves)

    def is_on(self, surfaces: Sequence[Polynomial]) -> bool:
        """Whether each of the curves is on one of some surfaces."""
        return all(
            any(curve.contains(f) for f in surfaces if mark is None or not f.residues(*mark))
            for curve, mark in zip(self.curves, self.marks, strict=True)
        )


def seams_of(tree: Tree, claimed: Mapping[Curve, int], box: Floats | None = None) -> list[Seam]:
    """The seams of claimed curves and of those along which faces of a tree touch, those of several curves first.

    `claimed` are orders of continuity by curves.  Plane sections are among the seams where the `box` (2, 3) is given.
    """
    curves = {**claimed, **dict.fromkeys(_lines(tree), 1)}
    cut = () if box is None else smooth_sections(tree, box)
    sections = [Seam((plane, curve), (Ideal(plane, curve),)) for plane, curve in cut]
    single = [Seam(curve, (Ideal(*curve),), order) for curve, order in curves.items()]
    cutting: dict[Polynomial, list[int]] = {}
    for number, curve in enumerate(curves):
        for function in curve:
            cutting.setdefault(function.primitive(), []).append(number)
    surfaces = (polynomials_of(f) for f in dict.fromkeys(atom.function for atom in atoms(tree) if atom.face))
    places = places_of(single)
    held = [held_by(some, single, places) for some in surfaces]
    several: dict[tuple[Polynomial, frozenset[int]], Seam] = {}
    for common, numbers in cutting.items():
        if len(numbers) > 1:
            times = Counter(frozenset(known.intersection(numbers)) for known in held)
            for first, second in combinations_with_replacement(times, 2):
                shared = first & second if first != second or times[first] > 1 else frozenset()
                if len(shared) > 1:
                    several[common, shared] = _united(common, [single[n] for n in sorted(shared)])
    return [*sorted(several.values(), key=lambda seam: -len(seam.curves)), *single, *sections]


def places_of(seams: Sequence[Seam]) -> Floats:
    """A point (N, 3) of each seam that is a line, to rounding; not numbers of others."""
    return np.array([to_floats(seam._place or ()) or [np.nan] * 3 for seam in seams]).reshape(-1, 3)


def held_by(surfaces: Sequence[Polynomial], seams: Sequence[Seam], places: Floats) -> set[int]:
    """The numbers of the seams that surfaces hold, of which there may be thousands: so values tell most others."""
    open_, far = np.isnan(places[:, 0]), np.maximum(1.0, np.abs(places).max(axis=1))
    for surface in surfaces:
        largest = np.abs(surface.dense(surface.degree)).sum() * far**surface.degree
        open_ |= np.abs(surface(places)) <= 2.0**-40 * largest
    return {number for number in np.flatnonzero(open_).tolist() if seams[number].is_on(surfaces)}


def _lines(tree: Tree) -> list[Curve]:
    """The lines along which faces on planes touch others on cylinders or cones: each plane, and one across it."""
    faces = dict.fromkeys(a.function.primitive() for a in atoms(tree) if a.face and isinstance(a.function, Polynomial))
    pairs = product((f for f in faces if f.degree == 1), (f for f in faces if f.degree == 2))
    return [(plane, across) for plane, quadric in pairs if (across := tangent_line(plane, quadric)) is not None]


def _united(common: Polynomial, seams: Sequence[Seam]) -> Seam:
    """The seam of several that have a function in common, up to its factor; each curve once."""
    curves: list[Ideal] = []
    others = Polynomial(1)
    for seam in seams:
        if not any(all(map(known.contains, seam.functions)) for known in curves):
            first, second = seam.functions
            other = second if first.primitive() == common else first
            curves += seam.curves
            others = Polynomial.from_raw(others.raw * other.raw / others.raw.gcd(other.raw))
    return Seam((common, others), tuple(curves), min(seam.order for seam in seams))


class Seams:
    """Where faces of an evaluator meet and do not cross; its extra columns are the functions of given seams, in pairs.

    `box` (2, 3) holds the set, in the evaluator's coordinates.  What is found out about columns is kept.
    """

    def __init__(self, evaluator: TreeEvaluator, given: Sequence[Seam], box: Floats) -> None:
        self._evaluator, self.given, self._box = evaluator, tuple(given), box
        self._found: dict[tuple[int, int], tuple[int, ...]] = {}
        self._same: dict[tuple[int, int, int], bool] = {}
        self._on: dict[int, set[int]] = {}

    def between(self, a: int, b: int) -> tuple[int, ...]:
        """The columns of the curves in which two columns' faces touch, or nothing where they cross."""
        if (a, b) not in self._found:
            self._found[a, b] = self._find(a, b)
        return self._found[a, b]

    def _find(self, a: int, b: int) -> tuple[int, ...]:
        columns, used = self._evaluator.columns, self._evaluator.used
        first, second = (polynomials_of(columns[c].function) for c in (a, b))
        for number in sorted(self.of(a) & self.of(b)):
            if self._evaluator.walls[[a, b]].any() or self.given[number].joins(first, second):
                return used + 2 * number, used + 2 * number + 1
        if len(first) != 1 or len(second) != 1 or first[0].degree == second[0].degree == 1:
            return ()  # planes cross
        near = self._near[:, self._near[a] & self._near[b]].any(axis=1)
        for number in np.flatnonzero(self._evaluator.walls & near).tolist():
            w = columns[number].function
            for kept, p, q in ((a, *first, *second), (b, *second, *first)):
                if isinstance(w, Polynomial) and number not in (a, b):
                    ideal = Ideal(p, w)
                    if ideal.contains(q) and not ideal.is_whole_ring and touch_along(p, q, ideal):
                        return kept, number
        return ()

    @cached_property
    def _places(self) -> Floats:
        return places_of(self.given)

    @cached_property
    def _near(self) -> Bools:
        """Which columns (M, N) the set depends on in each of the cubes of its box."""
        (low, high), parts = self._box, 16  # of each side
        halves = (high - low) / (2 * parts)
        centers = np.stack(np.meshgrid(*np.linspace(low + halves, high - halves, parts).T), axis=-1).reshape(-1, 3)
        below, above = self._evaluator.relevant(*self._evaluator.taylor(centers, halves[None]))
        return np.asarray(below | above)

    def of(self, column: int) -> set[int]:
        """The numbers of the seams on which a column's faces are."""
        if column not in self._on:
            surfaces = polynomials_of(self._evaluator.columns[column].function)
            self._on[column] = held_by(surfaces, self.given, self._places)
        return self._on[column]

    def pinched(self) -> Iterator[tuple[Floats, int, int, bool]]:
        """Points of lines along which two columns' faces touch, and whether beside these the set is on both sides, if
        it is on both or on neither, and not so between them: there its parts touch, or it has no thickness."""
        on, middle = [list[int]() for _ in self.given], self._box.mean(axis=0)
        for column, number in ((c, n) for c in range(self._evaluator.used) for n in self.of(c)):
            on[number].append(column)
        found = list[tuple[Floats, Floats, int, int, list[int]]]()
        for number in (n for n, seam in enumerate(self.given) if seam._place):
            values, *slopes = self._jets(np.stack([middle] * 2), self._evaluator.used + 2 * number + np.arange(2)).T
            way = unit(np.cross(*np.transpose(slopes)))
            with np.errstate(divide="ignore", invalid="ignore"):
                start = middle - np.linalg.pinv(np.transpose(slopes)) @ values
                ends = np.sort((self._box - start) / way, axis=0)
            low, high = np.nanmax(ends[0]), np.nanmin(ends[1])
            if low >= high:  # the line misses the box
                continue
            points = start + np.linspace(low, high, 66)[1:-1, None] * way
            faces = (c for c in on[number] if not self._evaluator.walls[c])
            ways = np.broadcast_to(way, points.shape)
            found += ((points, ways, *pair, on[number]) for pair in combinations(faces, 2))
        for first in range(0, len(found), 256):
            yield from self._pinched(found[first : first + 256])

    def _pinched(
        self, some: Sequence[tuple[Floats, Floats, int, int, list[int]]]
    ) -> Iterator[tuple[Floats, int, int, bool]]:
        """Those of lines: for each 64 points and directions (64, 3), two columns, and all columns that hold it."""
        points, ways = (np.concatenate([one[i] for one in some]) for i in range(2))
        pair, rows = np.repeat([(one[2], one[3]) for one in some], 64, axis=0).T, np.arange(len(points))
        f, g = (unit(self._jets(points, columns)[:, 1:]) for columns in pair)
        aside = points + 2.0**-8 * np.cross(ways, f)
        jets = [self._jets(aside, columns) for columns in pair]
        between = aside - sum(j[:, :1] * j[:, 1:] / (j[:, 1:] ** 2).sum(axis=1)[:, None] for j in jets) / 2
        alike, held = (f * g).sum(axis=1) > 0, []
        signs, there = self._evaluator.signs(points), self._evaluator.signs(between)
        for number, (*_, on) in enumerate(some):  # 0 here, so of no sign
            signs[on, 64 * number : 64 * number + 64] = there[on, 64 * number : 64 * number + 64]
        for side in ((True, alike), (False, ~alike), there[pair, rows]):
            signs[pair, rows] = np.broadcast_arrays(*side)
            held.append(self._evaluator.inside(signs))
        touch = (lengths(np.cross(f, g)) < SLACK) & (held[0] == held[1]) & (held[1] != held[2])
        for number, (own, (*_, a, b, _)) in enumerate(zip(touch.reshape(-1, 64), some, strict=True)):
            if len(where := np.flatnonzero(own)):
                row = 64 * number + where[len(where) // 2]
                yield points[row], a, b, bool(held[0][row])

    def _jets(self, points: Floats, column: Any) -> Floats:
        return self._evaluator.jets(points, np.broadcast_to(column, len(points)))

    def hidden(self, yes: Bools, no: Bools, below: Bools, above: Bools) -> Bools:
        """The planes (M, N) that matter from both sides in cubes and are no boundary there: on them two faces meet.

        `yes` and `no` say where columns are certainly <= 0 and > 0, `below` and `above` from which sides they matter.
        They are looked for one by one, so not in more than 2000 cubes.
        """
        both, matter = below & above, below | above
        result = np.zeros_like(both)
        cubes = np.flatnonzero((both.sum(axis=0) == 1) & (matter.sum(axis=0) == 3))
        for cube in cubes[:2000].tolist():
            plane = int(both[:, cube].argmax())
            a, b = (int(i) for i in np.flatnonzero(matter[:, cube]) if i != plane)
            result[plane, cube] = self._same_on(plane, a, b) and self._passes(yes[:, cube], no[:, cube], plane, (a, b))
        return result

    def _passes(self, yes: Bools, no: Bools, plane: int, pair: tuple[int, int]) -> bool:
        """Whether the tree is the same on both sides of a plane, where two columns have the same sign."""
        signs = np.repeat(yes[:, None], 4, axis=1), np.repeat(no[:, None], 4, axis=1)
        for table, side in zip(signs, (True, False), strict=True):
            table[plane] = np.array([side, not side, side, not side])
            table[list(pair)] = np.array([side, side, not side, not side])
        holds = self._evaluator.holds(*signs)
        return bool(holds[0] == holds[1] and holds[2] == holds[3])

    def _same_on(self, plane: int, a: int, b: int) -> bool:
        """Whether two columns are positive multiples of one another on a plane."""
        key = plane, a, b
        if key not in self._same:
            found = [self._evaluator.columns[i].function for i in key]
            known = [p for p in found if isinstance(p, Polynomial)]
            self._same[key] = len(known) == 3 and known[0].degree == 1 and multiples(*known)
        return self._same[key]
