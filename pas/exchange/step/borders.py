"""Where charts meet: curves given by functions and planes, with their corners, from the edges of a mesh.

A border is a chain of edges between the same two charts.  Its points are common zeros of what defines it: the functions
of both faces, those of the joint along which they continue each other, or the function of one face and the plane by
which it was cut.  A corner is on all of its borders.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pas.algebra.monomials import Floats
from pas.exchange.step.charts import NEAR, Atlas
from pas.exchange.step.curves import Curve, curve_through
from pas.exchange.step.functions import Integers

STEP = 1e-5
"""Of the differences that give second derivatives, in local coordinates."""


@dataclass(frozen=True, eq=False)
class Border:
    """The border of the chart on its left and the one on its right, along a `chain` of vertices.

    `functions` are those that are zero on it, by number; `order` says with what smoothness GC^k the charts are meant to
    go on in each other, 0 where they are not.
    """

    left: int
    right: int
    chain: tuple[int, ...]
    functions: tuple[int, ...]
    order: int


@dataclass(eq=False)
class Borders:
    """All borders of an atlas, and what they are made of."""

    atlas: Atlas
    orders: Callable[[int, int], int]
    points: dict[int, Floats] = field(default_factory=dict)

    def __post_init__(self) -> None:
        twins, triangles = self.atlas._twins, self.atlas.triangles
        chart = np.repeat(self.atlas.chart, 3)
        starts, ends = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
        halves = np.flatnonzero(chart != chart[twins])
        self.sides = {(int(starts[h]), int(ends[h])): (int(chart[h]), int(chart[twins[h]])) for h in halves}
        self.chains = self._chains()
        self.borders = [self._border(*chain) for chain in self.chains]
        self._place_corners()

    def _chains(self) -> list[tuple[int, int, tuple[int, ...]]]:
        """Each border's charts, left and right, and its vertices; the left one has the lower number."""
        after: dict[int, list[tuple[int, int, int]]] = defaultdict(list)
        for (a, b), (left, right) in self.sides.items():
            if left < right:
                after[a].append((b, left, right))
                after[b].append((a, left, right))
        special = self._special(np.array(sorted(after), dtype=np.intp)) | self._kinks()
        self.corners = {
            v for v, found in after.items() if len(found) != 2 or found[0][1:] != found[1][1:] or v in special
        }
        chains, seen = [], set()
        for start in [*sorted(self.corners), *sorted(set(after) - self.corners)]:
            for way, left, right in after[start]:
                if frozenset((start, way)) in seen:
                    continue
                chain = [start, way]
                seen.add(frozenset(chain))
                while chain[-1] not in self.corners and chain[-1] != start:
                    last = next(x for x, _, _ in after[chain[-1]] if x != chain[-2])
                    seen.add(frozenset((chain[-1], last)))
                    chain.append(last)
                if self.sides[chain[0], chain[1]][0] != left:
                    chain.reverse()
                chains.append((left, right, tuple(chain)))
        return chains

    def _special(self, vertices: Integers) -> set[int]:
        """The vertices at singular points of faces, such as a cone's apex, which they are put on."""
        found = set()
        for point in self.atlas.field.special_points:
            off = np.linalg.norm(self.atlas.points[vertices] - point, axis=1)
            for vertex in vertices[off < NEAR].tolist():
                found.add(vertex)
                self.points[vertex] = point
        return found

    def _kinks(self) -> set[int]:
        """The vertices in which curves cross that two quadrics share, in planes: borders turn there."""
        pairs: dict[tuple[int, int], set[int]] = defaultdict(set)
        for edge, charts in self.sides.items():
            pairs[charts] |= set(edge)
        found = set()
        for (left, right), vertices in pairs.items():
            planes = self.atlas.planes_between(left, right)
            for vertex in vertices if len(planes) > 1 else ():
                found |= (
                    {vertex} if sum(abs(self.atlas.points[vertex] @ n - d) < NEAR for n, d in planes) > 1 else set()
                )
        return found

    def _border(self, left: int, right: int, chain: tuple[int, ...]) -> Border:
        functions, order = self.atlas.meeting(left, right, self.atlas.points[list(chain)])
        labels = self.atlas.sheets[left].label, self.atlas.sheets[right].label
        return Border(left, right, chain, functions, max(order, self.orders(*labels)))

    def _place_corners(self) -> None:
        through: dict[int, dict[int, None]] = defaultdict(dict)
        for border in self.borders:
            for end in (border.chain[0], border.chain[-1]):
                through[end] |= dict.fromkeys(border.functions)
        for vertex, numbers in through.items():
            if vertex in self.points:
                continue
            start = self.atlas.points[vertex]
            if len(numbers) == 2 and vertex in self.corners:
                start = self._touching(start, tuple(numbers))
            self.points[vertex] = self.atlas.functions.placed(start[None], tuple(numbers))[0]

    def _touching(self, point: Floats, numbers: tuple[int, ...]) -> Floats:
        """Where two surfaces touch and their curves cross: both are zero, and their gradients parallel."""
        around = STEP * np.concatenate([np.eye(3), -np.eye(3)])
        for _ in range(8):
            units, rows, values, bends = [], list[Floats](), list[float](), []
            for number in numbers:
                jets = self.atlas.functions.jets(point[None], number)[0]
                size = float(np.linalg.norm(jets[1:]))
                units.append(jets[1:] / size)
                values.append(jets[0] / size)
                slopes = self.atlas.functions.jets(point + around, number)[:, 1:]
                bends.append((slopes[:3] - slopes[3:]) / (2 * STEP * size))
            rows = [*units, *(np.cross(units[0], bends[1]) - np.cross(units[1], bends[0])).T]
            values += np.cross(*units).tolist()
            step = np.linalg.lstsq(np.array(rows), np.array(values), rcond=1e-6)[0]
            point = point - step
            if np.linalg.norm(step) < 1e-14:
                break
        return np.asarray(point)

    def curve(self, border: Border, tolerance: float) -> Curve:
        """The curve of a border, splines within a tolerance, in local coordinates."""
        points = np.array([self.points.get(v, self.atlas.points[v]) for v in border.chain])
        return curve_through(points, lambda x: self.atlas.functions.placed(x, border.functions), tolerance)

    def loops(self, chart: int) -> list[list[tuple[Border, bool]]]:
        """The borders around a chart, loop by loop, the chart on their left; each with whether it runs forward."""
        first: dict[tuple[int, int], tuple[Border, bool]] = {}
        for border in self.borders:
            if border.left == chart:
                first[border.chain[0], border.chain[1]] = border, True
            if border.right == chart:
                first[border.chain[-1], border.chain[-2]] = border, False
        found = []
        while first:
            begin = next(iter(first))
            loop = [first.pop(begin)]
            while True:
                border, forward = loop[-1]
                last, end = border.chain[-2:] if forward else border.chain[1::-1]
                following = self._next(last, end)
                if following == begin:
                    break
                loop.append(first.pop(following))
            found.append(loop)
        return found

    def _next(self, start: int, end: int) -> tuple[int, int]:
        """The half edge on the same chart's border that follows one, turning around its end within the chart."""
        chart = self.sides[start, end][0]
        corner = self._third[start, end]
        while (end, corner) not in self.sides or self.sides[end, corner][0] != chart:
            corner = self._third[corner, end]
        return end, corner

    @property
    def _third(self) -> dict[tuple[int, int], int]:
        if not hasattr(self, "_thirds"):
            triangles = self.atlas.triangles
            keys = np.stack([triangles, triangles[:, [1, 2, 0]]], axis=2).reshape(-1, 2).tolist()
            self._thirds = dict(zip(map(tuple, keys), triangles[:, [2, 0, 1]].ravel().tolist(), strict=True))
        return self._thirds
