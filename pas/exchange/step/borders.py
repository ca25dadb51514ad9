"""Where charts meet: curves given by functions and planes, with their corners, from the edges of a mesh.

A border is a chain of edges between the same two charts.  Its points are common zeros of what defines it: the functions
of both faces, those of the joint along which they continue each other, or the function of one face and the plane by
which it was cut.  A corner is on all of its borders.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from pas.algebra.monomials import Floats
from pas.exchange.step.charts import NEAR, Atlas, Integers
from pas.limits import checkpoint

DEGREE = 5

EXACT = 1e-9
"""Distance of points from a line or conic, over their extent, up to which they are on it."""


class CurveKind(Enum):
    """Kinds of curves."""

    LINE = "line"
    CIRCLE = "circle"
    ELLIPSE = "ellipse"
    SPLINE = "spline"


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve from parameter `start` to `end`: origin + t first, origin + cos t first + sin t second, or a spline.

    `error` is the largest distance from what it stands for that was measured.
    """

    kind: CurveKind
    start: float
    end: float
    error: float
    origin: Floats | None = None
    first: Floats | None = None
    second: Floats | None = None
    spline: BSpline | None = None

    def __call__(self, parameters: Floats) -> Floats:
        """Points (N, 3) at parameters (N,)."""
        t = np.asarray(parameters)[:, None]
        if self.spline is not None:
            return np.asarray(self.spline(parameters))
        assert self.origin is not None and self.first is not None
        if self.second is None:
            return np.asarray(self.origin + t * self.first)
        return np.asarray(self.origin + np.cos(t) * self.first + np.sin(t) * self.second)

    def parameters(self, number: int) -> Floats:
        """So many parameters from the start to the end."""
        return np.linspace(self.start, self.end, number)


def curve_through(points: Floats, placed: Callable[[Floats], Floats], tolerance: float) -> Curve:
    """The curve along points (N, 3) from the first to the last, which may be one; `placed` moves points onto it.

    Splines are within `tolerance`, or have as many points as there may be.
    """
    dense = resampled(points, max(33, len(points)), placed)
    found = _line(dense) or _conic(dense)
    if found is not None:
        return found
    number = 9
    most_points = 1025
    while True:
        checkpoint()
        knots = resampled(dense, 2 * number - 1, placed)
        lengths = _lengths(knots)
        spline = make_interp_spline(lengths[::2], knots[::2], k=DEGREE)
        between = spline(np.concatenate([lengths[1::2], (lengths[1:] + lengths[:-1])[[0, 1, -2, -1]] / 2]))
        error = float(np.linalg.norm(placed(between) - between, axis=1).max())
        if error <= tolerance or number >= most_points:
            return Curve(CurveKind.SPLINE, 0.0, float(lengths[-1]), error, spline=spline)
        number, dense = 2 * number - 1, knots


def _lengths(points: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def resampled(points: Floats, number: int, placed: Callable[[Floats], Floats]) -> Floats:
    """So many points, evenly along others (N, 3), moved onto the curve; both ends stay."""
    lengths = _lengths(points)
    even = np.linspace(0, lengths[-1], number)
    spread = np.stack([np.interp(even, lengths, column) for column in points.T], axis=1)
    moved = placed(spread)
    moved[0], moved[-1] = points[0], points[-1]
    return moved


def _line(points: Floats) -> Curve | None:
    way = points[-1] - points[0]
    length = float(np.linalg.norm(way))
    if length < EXACT:
        return None
    way = way / length
    moved = points - points[0]
    off = float(np.linalg.norm(moved - (moved @ way)[:, None] * way, axis=1).max())
    return Curve(CurveKind.LINE, 0.0, length, off, points[0], way) if off < EXACT * length else None


def _conic(points: Floats) -> Curve | None:
    """The circle or ellipse through points, its parameter rising along them."""
    middle = points.mean(axis=0)
    size = float(np.ptp(points, axis=0).max())
    scaled = (points - middle) / size
    axes = np.linalg.svd(scaled, full_matrices=False)[2]
    if np.abs(scaled @ axes[2]).max() > EXACT:
        return None
    x, y = scaled @ axes[0], scaled @ axes[1]
    one = np.ones_like(x)
    circle = np.linalg.lstsq(np.stack([x, y, one], axis=1), -(x * x + y * y), rcond=None)[0]
    center = -circle[:2] / 2
    radius = float(np.sqrt(max(center @ center - circle[2], 0.0)))
    matrix = np.eye(2) / max(radius, 1e-300) ** 2
    if not 0 < radius < 1e4 or np.abs(np.hypot(x - center[0], y - center[1]) - radius).max() > EXACT:
        values = np.linalg.svd(np.stack([x * x, x * y, y * y, x, y, one], axis=1), full_matrices=False)
        a, b, c, d, e, f = values[2][-1]
        form, slope = np.array([[a, b / 2], [b / 2, c]]), np.array([d, e])
        if a * c - b * b / 4 < 1e-9 or values[1][-1] > EXACT or values[1][-2] < 1e-7:
            return None
        center = np.linalg.solve(form, -slope / 2)
        matrix = form / (center @ form @ center - f)
        radius = 0.0
    weights, ways = np.linalg.eigh(matrix)
    if weights[0] <= 0:
        return None
    place = middle + size * (center @ axes[:2])
    if radius:
        first = points[0] - place
        first = first * (radius * size / np.linalg.norm(first))
        second = np.cross(axes[0], axes[1])
        second = np.cross(second / np.linalg.norm(second), first)
    else:
        first, second = (size / np.sqrt(w) * (way @ axes[:2]) for w, way in zip(weights, ways.T, strict=True))

    def angles(flipped: Floats) -> Floats:
        moved = points - place
        return np.unwrap(np.arctan2(moved @ flipped / (flipped @ flipped), moved @ first / (first @ first)))

    turn = angles(second)
    if turn[-1] < turn[0]:
        second = -second
        turn = angles(second)
    turn = turn + 2 * np.pi * np.ceil(-turn[0] / (2 * np.pi) - EXACT)  # readers begin with positive angles
    whole = np.linalg.norm(points[-1] - points[0]) < EXACT * size
    start = float(turn[0])
    end = start + 2 * np.pi if whole else float(turn[-1])
    off = np.linalg.norm(place + np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second - points, axis=1).max()
    if off > 10 * EXACT * size or (np.diff(turn) <= 0).any():
        return None
    kind = CurveKind.CIRCLE if radius else CurveKind.ELLIPSE
    return Curve(kind, start, end, float(off), place, first, second)


@dataclass(frozen=True, eq=False)
class ChartBorder:
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

    def _border(self, left: int, right: int, chain: tuple[int, ...]) -> ChartBorder:
        functions, order = self.atlas.meeting(left, right, self.atlas.points[list(chain)])
        labels = self.atlas.sheets[left].label, self.atlas.sheets[right].label
        return ChartBorder(left, right, chain, functions, max(order, self.orders(*labels)))

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
        step = 1e-5  # of the differences that give second derivatives, in local coordinates
        around = step * np.concatenate([np.eye(3), -np.eye(3)])
        for _ in range(8):
            units, rows, values, bends = [], list[Floats](), list[float](), []
            for number in numbers:
                jets = self.atlas.functions.jets(point[None], number)[0]
                size = float(np.linalg.norm(jets[1:]))
                units.append(jets[1:] / size)
                values.append(jets[0] / size)
                slopes = self.atlas.functions.jets(point + around, number)[:, 1:]
                bends.append((slopes[:3] - slopes[3:]) / (2 * step * size))
            rows = [*units, *(np.cross(units[0], bends[1]) - np.cross(units[1], bends[0])).T]
            values += np.cross(*units).tolist()
            step = np.linalg.lstsq(np.array(rows), np.array(values), rcond=1e-6)[0]
            point = point - step
            if np.linalg.norm(step) < 1e-14:
                break
        return np.asarray(point)

    def curve(self, border: ChartBorder, tolerance: float) -> Curve:
        """The curve of a border, splines within a tolerance, in local coordinates."""
        points = np.array([self.points.get(v, self.atlas.points[v]) for v in border.chain])
        return curve_through(points, lambda x: self.atlas.functions.placed(x, border.functions), tolerance)

    def loops(self, chart: int) -> list[list[tuple[ChartBorder, bool]]]:
        """The borders around a chart, loop by loop, the chart on their left; each with whether it runs forward."""
        first: dict[tuple[int, int], tuple[ChartBorder, bool]] = {}
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
            starts, ends, thirds = (triangles[:, [k, (k + 1) % 3, (k + 2) % 3]].ravel().tolist() for k in range(3))
            self._thirds = dict(zip(zip(starts, ends, strict=True), thirds, strict=True))
        return self._thirds
