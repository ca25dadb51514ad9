"""The borders of charts: curves given by functions and planes, with their corners, from the edges of a mesh.

A border is a chain of edges between the same two charts.  Its points are common zeros of what defines it: the functions
of both faces, those of the joint along which they continue each other, or the function of one face and the plane by
which it was cut.  A corner is on all of its borders.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from pas.algebra.lengths import arc_lengths, resampled
from pas.arrays import Floats, Integers
from pas.errors import GeometryError
from pas.exchange.step.charts import NEAR, Atlas, Functions, Sheet
from pas.exchange.step.parametrized import Wall
from pas.limits import checkpoint
from pas.mesh.halfedges import following
from pas.mesh.projection import CommonZeros
from pas.mesh.topology import chains

DEGREE = 5

EXACT = 1e-9
"""Distance of points from a line or conic, over their extent, up to which they are on it."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve from parameter `start` to `end`: origin + t first, origin + cos t first + sin t second, or a spline.

    `circle` tells a circle from other ellipses.
    """

    start: float
    end: float
    origin: Floats | None = None
    first: Floats | None = None
    second: Floats | None = None
    spline: BSpline | None = None
    circle: bool = False

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
        """A `number` of parameters from the start to the end."""
        return np.linspace(self.start, self.end, number)


def curve_through(points: Floats, placed: Callable[[Floats], Floats], tolerance: float) -> Curve:
    """The curve along points (N, 3) from the first to the last, which may be one; `placed` moves points onto it.

    Splines are within `tolerance`, or have as many points as there may be.
    """
    dense = _evened(points, max(33, len(points)), placed)
    found = _line(dense) or _conic(dense)
    if found is not None:
        return found
    number, most_points = 9, 1025
    while True:
        checkpoint()
        knots = _evened(dense, 2 * number - 1, placed)
        lengths = arc_lengths(knots)
        if np.diff(lengths).min() <= 0:
            raise GeometryError(f"the curve in which two faces meet is too short for splines, {lengths[-1]:.1e}")
        spline = make_interp_spline(lengths[::2], knots[::2], k=DEGREE)
        between = spline(np.concatenate([lengths[1::2], (lengths[1:] + lengths[:-1])[[0, 1, -2, -1]] / 2]))
        error = float(np.linalg.norm(placed(between) - between, axis=1).max())
        if error <= tolerance or number >= most_points:
            return Curve(0.0, float(lengths[-1]), spline=spline)
        number, dense = 2 * number - 1, max(dense, knots, key=len)


def _evened(points: Floats, number: int, placed: Callable[[Floats], Floats]) -> Floats:
    """A `number` of points evenly along others (N, 3), moved onto the curve; both ends stay."""
    moved = placed(resampled(points, number))
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
    return Curve(0.0, length, points[0], way) if off < EXACT * length else None


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
    return Curve(start, end, place, first, second, circle=radius > 0)


@dataclass(frozen=True, eq=False)
class ChartBorder:
    """The border of the chart on its left and the one on its right, along a `chain` of vertices.

    `functions` are those that are zero on it; `order` says with what smoothness GC^k the charts are meant to go on in
    each other, 0 where they are not.
    """

    left: int
    right: int
    chain: tuple[int, ...]
    functions: Functions
    order: int


class Borders:
    """All `borders` of an atlas; `points` (3,) are the corners between them, by vertex.

    `orders` is the order of the joint that is claimed between faces of two labels along points (N, 3).
    """

    def __init__(self, atlas: Atlas, orders: Callable[[int, int, Floats], int]) -> None:
        self.atlas = atlas
        twins, chart = atlas.twins, np.repeat(atlas.chart, 3)
        halves = np.flatnonzero(chart != chart[twins])
        ends = np.stack([atlas.triangles.ravel(), atlas.triangles[:, [1, 2, 0]].ravel()], axis=1)[halves]
        after = following(halves)  # on the border of the same chart, turning around the end within it
        while (inner := chart[after] == chart[twins[after]]).any():
            after[inner] = following(twins[after[inner]])
        self._halves = dict(zip(map(tuple, ends.tolist()), halves.tolist(), strict=True))
        self._after = dict(zip(halves.tolist(), after.tolist(), strict=True))
        sides = np.stack([chart[halves], chart[twins[halves]]], axis=1)
        once = sides[:, 0] < sides[:, 1]
        edges, sides = ends[once], sides[once]
        self.points = self._special(np.unique(edges))
        self.borders = []
        for found in chains(edges, {*self.points, *self._kinks(edges, sides)}):
            sided = [(int(chart[self._halves[a, b]]), way) for a, b, way in ((*found[:2], 1), (*found[1::-1], -1))]
            (left, way), (right, _) = sorted(sided)
            chain = found[::way]
            one, other = atlas.sheets[left], atlas.sheets[right]
            order = 9 if one is other else orders(one.label, other.label, atlas.points[chain])  # 9: one function
            functions = atlas.meeting(left, right, atlas.points[chain])
            self.borders.append(ChartBorder(left, right, tuple(chain.tolist()), functions, order))
        through: dict[int, dict[Sheet | Wall, None]] = defaultdict(dict)
        for border in self.borders:
            for end in (border.chain[0], border.chain[-1]):
                through[end] |= dict.fromkeys(border.functions)
        for vertex in through.keys() - self.points.keys():
            self.points[vertex] = CommonZeros((*through[vertex],)).placed(atlas.points[[vertex]])[0]

    def _special(self, vertices: Integers) -> dict[int, Floats]:
        """The vertices at singular points of faces, such as a cone's apex, which they are put on."""
        found: dict[int, Floats] = {}
        for point in self.atlas.field.special_points:
            off = np.linalg.norm(self.atlas.points[vertices] - point, axis=1)
            found |= dict.fromkeys(vertices[off < NEAR].tolist(), point)
        return found

    def _kinks(self, edges: Integers, sides: Integers) -> Iterator[int]:
        """The vertices in which curves cross that two quadrics share, in planes: borders turn there."""
        for left, right in np.unique(sides, axis=0).tolist():
            planes = self.atlas.planes_between(left, right)
            if len(planes) > 1:
                vertices = np.unique(edges[(sides == (left, right)).all(axis=1)])
                near = [np.abs(plane.heights(self.atlas.points[vertices])) < NEAR for plane in planes]
                yield from vertices[np.sum(near, axis=0) > 1].tolist()

    def curve(self, border: ChartBorder, tolerance: float) -> Curve:
        """The curve of a border, splines within a tolerance, in local coordinates."""
        points = np.array([self.points.get(v, self.atlas.points[v]) for v in border.chain])
        return curve_through(points, CommonZeros(border.functions).placed, tolerance)

    def loops(self, chart: int) -> list[list[tuple[int, bool]]]:
        """The borders around a chart, loop by loop, the chart on their left: numbers, and whether they run forward."""
        first: dict[int, tuple[int, bool]] = {}
        last: dict[tuple[int, bool], int] = {}
        for number, border in enumerate(self.borders):
            for side, forward in ((border.left, True), (border.right, False)):
                if side == chart:
                    chain = border.chain if forward else border.chain[::-1]
                    first[self._halves[chain[0], chain[1]]] = number, forward
                    last[number, forward] = self._halves[chain[-2], chain[-1]]
        found = []
        while first:
            begin = following_half = next(iter(first))
            loop = []
            while following_half in first:
                loop.append(first.pop(following_half))
                following_half = self._after[last[loop[-1]]]
            assert following_half == begin
            found.append(loop)
        return found
