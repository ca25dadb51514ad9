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
from pas.errors import GeometryError
from pas.exchange.step.carriers import reducible_planes
from pas.exchange.step.charts import Atlas, Integers, Plane, Sheet
from pas.exchange.step.curves import Curve, curve_through
from pas.mesh.field import place_of
from pas.mesh.projection import newton

REACH = 0.05
"""How far a step may move a point of a mesh, in local coordinates, when it is put on its curve."""

NEAR = 1e-6
"""Distance, in local coordinates, within which all points of a border are on the plane that it was cut by."""


STEP = 1e-5
"""Of the differences that give second derivatives, in local coordinates."""


class Functions:
    """Functions by number, in a solid's local coordinates, as `pas.mesh.projection` wants them."""

    def __init__(self) -> None:
        self._jets: list[Callable[[Floats], Floats]] = []
        self._numbers: dict[object, int] = {}

    def number(self, key: object, jets: Callable[[Floats], Floats]) -> int:
        """That of a function, by a key."""
        if key not in self._numbers:
            self._numbers[key] = len(self._jets)
            self._jets.append(jets)
        return self._numbers[key]

    def plane(self, plane: Plane) -> int:
        """That of a plane."""
        normal, height = plane

        def jets(points: Floats) -> Floats:
            values = points @ normal - height
            return np.concatenate([values[:, None], np.broadcast_to(normal, points.shape)], axis=1)

        return self.number((*normal.tolist(), height), jets)

    def jets(self, points: Floats, label: int | Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3) of one function, or of each point's own (N,)."""
        labels = np.asarray(label, dtype=np.intp)
        if labels.ndim == 0 or (labels == labels[:1]).all():
            return self._jets[int(labels.ravel()[0])](points)
        result = np.empty((len(points), 4))
        for number in np.unique(labels):
            rows = labels == number
            result[rows] = self._jets[int(number)](points[rows])
        return result

    def placed(self, points: Floats, numbers: tuple[int, ...]) -> Floats:
        """Points (N, 3) moved onto the common zeros of functions."""
        if not len(points):
            return points
        each = np.tile(np.array(numbers, dtype=np.intp), (len(points), 1))
        return newton(points, self, each, np.full(len(points), REACH))


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
    functions: Functions = field(default_factory=Functions)
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
        special = self._special(np.array(sorted(after), dtype=np.intp))
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

    def _border(self, left: int, right: int, chain: tuple[int, ...]) -> Border:
        sheets = self.atlas.sheets[left], self.atlas.sheets[right]
        labels = sheets[0].label, sheets[1].label
        if labels[0] == labels[1]:
            points = self.atlas.points[list(chain)]
            planes = self.atlas.planes[labels[0]]
            off = [float(np.abs(points @ n - d).max()) for n, d in planes]
            if not off or min(off) > NEAR:
                place = place_of(self.atlas.field, points[len(points) // 2])
                raise GeometryError(f"the face {self.atlas.field.face(labels[0])!r} meets itself near {place}")
            plane = self.functions.plane(planes[int(np.argmin(off))])
            return Border(left, right, chain, (self._sheet(sheets[0]), plane), 9)
        placing = self.atlas.field.functions(tuple(sorted(labels)))
        order = self.orders(*labels)
        if {p // 2 for p in placing} != {label // 2 for label in labels}:
            numbers = [self.functions.number(p, lambda x, p=p: self.atlas.field.jets(x, p)) for p in placing]
            return Border(left, right, chain, tuple(numbers), max(order, 1))
        if sheets[0].polynomial is not None and sheets[1].polynomial is not None:
            points = self.atlas.points[list(chain)]
            planes = reducible_planes(sheets[0].polynomial, sheets[1].polynomial)
            off = [float(np.abs(points @ n - d).max()) for n, d in planes]
            if off:
                plane = self.functions.plane(planes[int(np.argmin(off))])
                return Border(left, right, chain, (self._sheet(sheets[0]), plane), order)
        return Border(left, right, chain, (self._sheet(sheets[0]), self._sheet(sheets[1])), order)

    def _sheet(self, sheet: Sheet) -> int:
        return self.functions.number(sheet, sheet.jets)

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
            self.points[vertex] = self.functions.placed(start[None], tuple(numbers))[0]

    def _touching(self, point: Floats, numbers: tuple[int, ...]) -> Floats:
        """Where two surfaces touch and their curves cross: both are zero, and their gradients parallel."""
        around = STEP * np.concatenate([np.eye(3), -np.eye(3)])
        for _ in range(8):
            units, rows, values, bends = [], list[Floats](), list[float](), []
            for number in numbers:
                jets = self.functions.jets(point[None], number)[0]
                size = float(np.linalg.norm(jets[1:]))
                units.append(jets[1:] / size)
                values.append(jets[0] / size)
                slopes = self.functions.jets(point + around, number)[:, 1:]
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
        return curve_through(points, lambda x: self.functions.placed(x, border.functions), tolerance)

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
