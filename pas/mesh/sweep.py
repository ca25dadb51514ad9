"""Triangles on a cylinder between two circles and the curves of holes, with no vertices but those of these loops.

The cylinder is unrolled, and a line along it goes round (plane sweep, Hertel and Mehlhorn 1983).  In each gap between
loops what it has passed is triangulated up to a front, which bulges forwards; the next vertex is joined to all of the
front that it sees, but by triangles that are too slender.  So none goes further round than one step of a loop.

The line goes round twice.  All fronts of the second time are what they would be the third time, so that its triangles
are all there are.  That these end in the loops is looked at, and they are turned alike: so each point is covered once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise, takewhile
from math import hypot

import numpy as np

from pas.arrays import Floats, Integers
from pas.mesh.topology import Edges

TURN = 2 * np.pi

FLAT = 1e-12
"""Twice the area, over the square of the radius, from which triangles count: beyond rounding."""

Place = tuple[int, int]
"""A vertex, and the turn in which it is met."""


def between_loops(flat: Floats, circles: tuple[Integers, Integers], holes: Sequence[Integers]) -> Integers | None:
    """Triangles (T, 3), counterclockwise, between loops of points (N, 2): angles in radians, heights over the radius.

    All loops have what is between them to their left: the lower circle goes round with ascending angles, the upper one
    with descending ones.  None where a hole goes to and fro, or loops meet.
    """
    loops = (*circles, *holes)
    found = Sweep(flat, loops).triangles()
    rim = Edges(np.array(found or [], dtype=np.intp).reshape(-1, 3), len(flat)).rim
    ends = np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop in loops])
    return np.array(found) if {*map(tuple, rim.tolist())} == {*map(tuple, ends.tolist())} else None


class Sweep:
    """Points (N, 2), angles in radians and heights over the radius, in loops, of which the first two are circles; for
    each the next one `after` it and the one `before`, and how many turns these are further on.

    The line leans a little, so that it meets one by one what is above one another.
    """

    def __init__(self, flat: Floats, loops: Sequence[Integers]) -> None:
        leaning = 2.0**-24  # of a turn, from one end to the other
        heights, angles = flat[:, 1], flat[:, 0] + leaning * TURN * flat[:, 1] / np.ptp(flat[:, 1])
        self.after, self.before = dict[int, Place](), dict[int, Place]()
        for loop in loops:
            around = np.unwrap(angles[[*loop, loop[0]]])
            turns = [0] * (len(loop) - 1) + [round(float(around[-1] - angles[loop[0]]) / TURN)]
            angles[loop] = around[:-1]
            for here, there, turn in zip(loop.tolist(), np.roll(loop, -1).tolist(), turns, strict=True):
                self.after[here], self.before[there] = (there, turn), (here, -turn)
        self.angles, self.heights = angles.tolist(), heights.tolist()
        self.loops: list[list[int]] = [loop.tolist() for loop in loops]

    def triangles(self) -> list[tuple[int, int, int]] | None:
        """The triangles of the sweep's second turn; None where a vertex follows no front."""
        begin = self.angles[self.loops[0][0]]
        fronts = [[max(self._met(loop, begin - TURN, begin), key=self._angle) for loop in self.loops[:2]]]
        found: list[tuple[int, int, int]] = []
        for place in sorted(
            (p for loop in self.loops for p in self._met(loop, begin, begin + 2 * TURN)), key=self._angle
        ):
            before, after = self._beside(self.before, place), self._beside(self.after, place)
            above, below = (self._angle(p) < self._angle(place) for p in (before, after))
            # A lower loop comes here from before, what is between loops above it, an upper one from after, or neither.
            mine = [f for f in fronts if (above and f[0] == before) or (below and f[-1] == after)]
            mine = mine if above or below else [f for f in fronts if self._holds(f, place)]
            if len(mine) != max(1, above + below):
                return None
            lower, upper = list[Place](), list[Place]()
            for front in mine:
                fronts.remove(front)
                seen = [self._upright(a, place, b) for a, b in pairwise(front)]
                if above and front[0] == before:
                    low, high = 0, _leading(seen)
                    upper = front[high:]
                elif below:
                    low, high = len(seen) - _leading(seen[::-1]), len(seen)
                    lower = front[: low + 1]
                else:
                    low = _leading([not s for s in seen])
                    high = low + _leading(seen[low:])
                    lower, upper = front[: low + 1], front[high:]
                if self._angle(place) > begin + TURN:
                    found += [(a[0], place[0], b[0]) for a, b in pairwise(front[low : high + 1])]
            fronts += [[*lower, place, *upper]] if above or below else [[*lower, place], [place, *upper]]
        return found

    def _met(self, loop: list[int], begin: float, end: float) -> Iterator[Place]:
        """The places after an angle and up to another at which the line meets a loop, all of it if that is a hole."""
        first = min(self.angles[v] for v in loop) if self.after[loop[-1]][1] == 0 else np.inf
        for turn in range(-4, 5):
            if first + TURN * turn > begin:
                yield from ((v, turn) for v in loop if begin < self.angles[v] + TURN * turn <= end)

    def _angle(self, place: Place) -> float:
        return self.angles[place[0]] + TURN * place[1]

    @staticmethod
    def _beside(steps: dict[int, Place], place: Place) -> Place:
        vertex, turns = steps[place[0]]
        return vertex, place[1] + turns

    def _turned(self, first: Place, second: Place, third: Place) -> float:
        """Twice the area of a triangle, positive where it is turned counterclockwise."""
        (a, x), (b, y), (c, z) = ((self._angle(p), self.heights[p[0]]) for p in (first, second, third))
        return (b - a) * (z - x) - (c - a) * (y - x)

    def _upright(self, first: Place, second: Place, third: Place) -> bool:
        """Whether a triangle is turned counterclockwise, and its normal by less than 45 degrees from the cylinder's.

        So that its middle corner, on the cylinder, is farther from the line through both others than that is below the
        cylinder there.
        """
        (a, x), (b, _), (c, z) = sorted((self._angle(p), self.heights[p[0]]) for p in (first, second, third))
        below = (b - a) * (c - b) / 2
        return self._turned(first, second, third) > hypot(c - a, z - x) * below + FLAT

    def _holds(self, front: list[Place], place: Place) -> bool:
        """Whether a place is in the gap of a front: above the edge that goes on from its first vertex, and below the
        other."""
        after, before = self._beside(self.after, front[0]), self._beside(self.before, front[-1])
        return self._turned(front[0], after, place) > 0 > self._turned(front[-1], before, place)


def _leading(flags: Sequence[bool]) -> int:
    """How many are true before the first that is not."""
    return sum(1 for _ in takewhile(bool, flags))
