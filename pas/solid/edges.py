"""Edges and loops of plane profiles, exact: straight ones and arcs of conics, each with rational ends.

A conic is a rational Bezier curve of degree 2 (Farin 2002): an arc lies in the triangle of its ends and of the point
where its tangents there meet.  So loops whose triangles are apart do not meet, and what is looked at here is exact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

import numpy as np
from flint import fmpq

from pas.algebra.inputs import shown_point
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import dot, exact, plain, rational, to_float, to_floats
from pas.arrays import Floats
from pas.errors import GeometryError

Point = tuple[fmpq, fmpq]


@dataclass(frozen=True)
class PlaneEdge:
    """A piece of a profile's boundary from `start` to `end`, with what is inside to its left.

    `curve`, a polynomial in x and y, is 0 on it.  That of a straight edge is linear, negative to the left, and there is
    no `control`; that of an arc is negative on the concave side, and `control` is where the tangents at its ends meet.
    """

    start: Point
    end: Point
    control: Point | None
    curve: Polynomial
    name: str

    @classmethod
    def straight(cls, start: Point, end: Point, name: str) -> PlaneEdge:
        """The segment between two different points."""
        return cls(start, end, None, line(start, end), name)

    @classmethod
    def parabola(cls, start: Point, control: Point, end: Point, name: str) -> PlaneEdge:
        """The Bezier curve of degree 2 with three control points, straight where these are in line."""
        area = turn(start, control, end)
        if area == 0:
            return cls.straight(start, end, name)
        u, v, w = (line(a, b) * (1 / area) for a, b in ((end, control), (start, end), (control, start)))
        return cls(start, end, control, v * v - u * w * 4, name)

    @property
    def bow(self) -> int:
        """1 where it bows out, away from what is inside; -1 where it bows in; 0 where it is straight."""
        return 0 if self.control is None else 1 if turn(self.start, self.end, self.control) < 0 else -1

    @property
    def hull(self) -> tuple[Point, ...]:
        """The corners of the segment or triangle that it lies in."""
        return (self.start, self.end) if self.control is None else (self.start, self.control, self.end)

    def tangent(self, at_end: bool) -> Point:
        """A vector along it, in its direction, at its start or end."""
        ends = (self.control or self.start, self.end) if at_end else (self.start, self.control or self.end)
        return minus(ends[1], ends[0])

    @property
    def reversed(self) -> PlaneEdge:
        """The edge of what is on its other side."""
        return replace(self, start=self.end, end=self.start, curve=self.curve if self.control else -self.curve)

    @cached_property
    def halves(self) -> tuple[PlaneEdge, PlaneEdge]:
        """Two arcs that make it, joined at a rational point near its middle."""
        assert self.control is not None
        x, y = (exact(c) for c in self.points(2)[1].tolist())
        ways = minus((x, y), self.start), minus(self.control, self.start)
        middle = beyond(self.curve, self.start, simplest(*ways))
        parts = [
            replace(self, start=a, end=b, control=tangents_meet(self.curve, a, b))
            for a, b in ((self.start, middle), (middle, self.end))
        ]
        return parts[0], parts[1]

    def points(self, parts: int) -> Floats:
        """The ends (parts + 1, 2) of pieces of it, all on the curve to rounding."""
        a, b = np.array(to_floats(self.start)), np.array(to_floats(self.end))
        t = np.linspace(0, 1, parts + 1)[:, None]
        if self.control is None:
            return np.asarray(a + t * (b - a))
        c, middle = self.control, tuple((s + e) / 2 for s, e in zip(self.start, self.end, strict=True))
        weight = math.sqrt(to_float(-self.curve.raw(*middle, 0) / self.curve.raw(*c, 0)))
        basis = (1 - t) ** 2, 2 * weight * t * (1 - t), t**2
        total = basis[0] * a + basis[1] * np.array(to_floats(c)) + basis[2] * b
        found = np.asarray(total / sum(basis))
        found[0], found[-1] = a, b
        return found

    def pieces(self, tolerance: float) -> int:
        """How many chords between `points` come within a tolerance of it."""
        if self.control is None:
            return 1
        few = 2
        found = self.points(2 * few)
        sag = np.linalg.norm(found[1::2] - (found[:-1:2] + found[2::2]) / 2, axis=1).max()
        return max(1, math.ceil(1.1 * few * math.sqrt(float(sag) / tolerance)))  # sags fall with the square


def line(start: Point, end: Point) -> Polynomial:
    """The polynomial of the line through two points, negative to the left of it, `turn` from it otherwise."""
    x, y, _ = GENERATORS
    (a, b), (c, d) = start, end
    return Polynomial.from_raw((x - a) * (d - b) - (y - b) * (c - a))


def turn(a: Point, b: Point, c: Point) -> fmpq:
    """Twice the area of a triangle, positive where its corners are counterclockwise."""
    return across(minus(b, a), minus(c, a))


def across(u: Point, v: Point) -> fmpq:
    """The determinant of two vectors, positive where the second is to the left of the first."""
    return u[0] * v[1] - u[1] * v[0]


def minus(a: Point, b: Point) -> Point:
    """The vector from the second point to the first."""
    return a[0] - b[0], a[1] - b[1]


def simplest(vector: Point, other: Point) -> Point:
    """A vector of short numbers in nearly the direction of one, on the same side of another."""
    u, v = to_floats(vector), to_floats(other)
    sine = abs(u[0] * v[1] - u[1] * v[0]) / (math.hypot(*u) * math.hypot(*v))
    x, y = (Fraction(c / math.hypot(*u)).limit_denominator(math.ceil(64 / sine)) for c in u)
    return rational(x), rational(y)


def beyond(curve: Polynomial, start: Point, direction: Point) -> Point:
    """The other point in which the line through a point of a conic meets it."""
    slope = dot(gradient(curve, start), direction)
    bend = curve.raw(start[0] + direction[0], start[1] + direction[1], 0) - slope
    return start[0] - slope / bend * direction[0], start[1] - slope / bend * direction[1]


def gradient(curve: Polynomial, point: Point) -> Point:
    """The gradient of a polynomial in x and y."""
    return curve.diff(0).raw(*point, 0), curve.diff(1).raw(*point, 0)


def tangents_meet(curve: Polynomial, a: Point, b: Point) -> Point:
    """Where the tangents of a conic at two of its points meet, which must not be parallel."""
    p, q = gradient(curve, a), gradient(curve, b)
    s, t, d = dot(p, a), dot(q, b), across(p, q)
    return (s * q[1] - t * p[1]) / d, (t * p[0] - s * q[0]) / d


def radius_of(curve: Polynomial) -> tuple[Point, fmpq] | None:
    """Centre and squared radius of a circle; None where a polynomial in x and y, negative inside, is none."""
    x, y, _ = GENERATORS
    a = curve.raw.to_dict().get((2, 0, 0), fmpq(0))
    if curve.degree != 2 or a <= 0:
        return None
    p, q = (g / (-2 * a) for g in gradient(curve, (fmpq(0), fmpq(0))))
    square = -curve.raw(p, q, 0) / a
    if curve.raw != a * ((x - p) ** 2 + (y - q) ** 2 - square):
        return None
    return (p, q), square


def arc(start: Point, end: Point, center: Point, left: bool, name: str) -> list[PlaneEdge]:
    """The arc of a circle between two different points of it, to the left or right, as edges of at most 100 degrees."""
    x, y, _ = GENERATORS
    radius = minus(start, center)
    curve = Polynomial.from_raw((x - center[0]) ** 2 + (y - center[1]) ** 2 - dot(radius, radius))
    u, v = (to_floats(minus(p, center)) for p in (start, end))
    angle = math.atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])
    angle = angle % (2 * math.pi) if left else -(-angle % (2 * math.pi))
    widest = math.radians(100)  # of longer arcs the tangents at the ends meet far off
    if abs(angle) <= widest:
        return [PlaneEdge(start, end, tangents_meet(curve, start, end), curve, name)]
    half = angle / 2
    to_middle = (
        u[0] * (math.cos(half) - 1) - u[1] * math.sin(half),
        u[0] * math.sin(half) + u[1] * (math.cos(half) - 1),
    )
    tangent = center[1] - start[1], start[0] - center[0]
    middle = beyond(curve, start, simplest((exact(to_middle[0]), exact(to_middle[1])), tangent))
    return [*arc(start, middle, center, left, name), *arc(middle, end, center, left, name)]


@dataclass(frozen=True)
class Loop:
    """Edges one after the other, the last of which ends where the first begins; what is inside is to their left.

    `whole` says that it is all of one closed curve, as a circle, which is the `curve` of each edge.
    """

    edges: tuple[PlaneEdge, ...]
    whole: bool = False

    @property
    def reversed(self) -> Loop:
        """The loop around what is outside."""
        return replace(self, edges=tuple(edge.reversed for edge in self.edges[::-1]))

    @cached_property
    def separated(self) -> tuple[PlaneEdge, ...]:
        """Its edges, at least three, with arcs cut until no two have more than a common end.

        Raises `GeometryError` where it crosses or touches itself, or turns back at a point.
        """
        edges = self.edges
        if len(edges) < 3:
            edges = tuple(half for edge in edges for half in (edge.halves if edge.control else (edge,)))
        return apart(edges, self.complaint)

    def complaint(self, one: PlaneEdge, other: PlaneEdge) -> GeometryError:
        """The error for two of its edges that meet."""
        if one.end == other.start or other.end == one.start:
            corner = one.end if one.end == other.start else one.start
            return GeometryError(
                f"the profile turns back on itself at {at(corner)}: edges {one.name!r} and {other.name!r} "
                f"leave it in one direction; let them meet at an angle, or end in a short edge across the tip"
            )
        return GeometryError(
            f"the profile crosses or touches itself near {near(one, other)}, where edges {one.name!r} and "
            f"{other.name!r} meet; its boundary must be a curve that does not"
        )

    @property
    def is_counterclockwise(self) -> bool:
        """Whether it is around what is inside, not around a hole."""
        x, y = self.polygon(0.02)[0].T
        return bool((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > 0)

    @cached_property
    def size(self) -> float:
        """The longest side of its box."""
        return float(np.ptp(np.array([to_floats(p) for e in self.edges for p in e.hull]), axis=0).max())

    def polygon(self, relative: float) -> tuple[Floats, list[int]]:
        """Points (N, 2) whose chords are within `relative` of its size from it, and how many are of each edge."""
        found = [edge.points(edge.pieces(relative * self.size))[:-1] for edge in self.edges]
        return np.concatenate(found), [len(points) for points in found]

    @property
    def corners(self) -> Iterator[tuple[PlaneEdge, PlaneEdge]]:
        """Each two edges that follow one another."""
        yield from zip(self.edges, self.edges[1:] + self.edges[:1], strict=True)

    @property
    def smooth_corners(self) -> Iterator[tuple[PlaneEdge, PlaneEdge]]:
        """The corners between different curves that continue in one direction."""
        for one, other in self.corners:
            u, v = one.tangent(at_end=True), other.tangent(at_end=False)
            if across(u, v) == 0 and dot(u, v) > 0 and one.curve.primitive() != other.curve.primitive():
                yield one, other


def apart(edges: Sequence[PlaneEdge], complaint: Callable[[PlaneEdge, PlaneEdge], Exception]) -> tuple[PlaneEdge, ...]:
    """Edges with arcs cut until no two have more than a common end.

    Raises what `complaint` makes of two where that does not end, as arcs of one curve that overlap.
    """
    # Of an arc, after which its triangle is 4^-12 of its length thin: what is still not apart touches.
    halvings = 12
    found = [(edge, 0) for edge in edges]
    while met := _meeting([edge for edge, _ in found]):
        cut: set[int] = set()
        for pair in met:
            able = {n for n in pair if found[n][0].control and found[n][1] < halvings}
            if not able or _overlap(*(found[n][0] for n in pair)):
                raise complaint(*(found[n][0] for n in pair))
            cut |= able
        parts = [(edge.halves, level + 1) if n in cut else ((edge,), level) for n, (edge, level) in enumerate(found)]
        found = [(part, level) for some, level in parts for part in some]
    return tuple(edge for edge, _ in found)


def _meeting(edges: Sequence[PlaneEdge]) -> list[tuple[int, int]]:
    """The pairs of edges, by number, whose hulls have more in common than ends."""
    corners = [np.array([to_floats(p) for p in edge.hull]) for edge in edges]
    low, high = (np.array([f(c, axis=0) for c in corners]) for f in (np.min, np.max))
    near = np.triu(((low[:, None] <= high[None]) & (low[None] <= high[:, None])).all(axis=2), 1)
    return [(i, j) for i, j in np.argwhere(near).tolist() if not _are_apart(edges[i], edges[j])]


def _are_apart(one: PlaneEdge, other: PlaneEdge) -> bool:
    """Whether the hulls of two edges have at most one end of both in common."""
    common = {one.start, one.end} & {other.start, other.end}
    if len(common) != 1:
        return not common and any(
            _separates(axis, one.hull, other.hull) for e in (one, other) for axis in _axes(e.hull)
        )
    (point,) = common
    cones = [[minus(p, point) for p in edge.hull if p != point] for edge in (one, other)]
    return not any(_holds(cones[1 - i], ray) for i in (0, 1) for ray in cones[i])


def _overlap(one: PlaneEdge, other: PlaneEdge) -> bool:
    """Whether arcs of one curve have more than ends in common: one has an end of the other in its triangle."""
    common = {one.start, one.end} & {other.start, other.end}
    ends = ((a.hull, p) for a, b in ((one, other), (other, one)) for p in (b.start, b.end) if p not in common)
    inside = (len({turn(a, b, p) > 0 for a, b in zip(h, h[1:] + h[:1], strict=True)}) == 1 for h, p in ends)
    return one.curve.primitive() == other.curve.primitive() and (len(common) == 2 or any(inside))


def _axes(hull: tuple[Point, ...]) -> Iterator[Point]:
    for a, b in zip(hull, hull[1:] + hull[:1], strict=True):
        d = minus(b, a)
        yield -d[1], d[0]
        if len(hull) == 2:
            yield d


def _separates(axis: Point, one: tuple[Point, ...], other: tuple[Point, ...]) -> bool:
    a, b = ([dot(axis, p) for p in hull] for hull in (one, other))
    return max(a) < min(b) or max(b) < min(a)


def _holds(cone: list[Point], ray: Point) -> bool:
    """Whether a cone of one or two directions, less than half a turn wide, has a ray."""
    if len(cone) == 1:
        return across(cone[0], ray) == 0 and dot(cone[0], ray) > 0
    first, last = cone if across(cone[0], cone[1]) > 0 else cone[::-1]
    return across(first, ray) >= 0 and across(ray, last) >= 0


def near(one: PlaneEdge, other: PlaneEdge) -> str:
    """A place at which two edges meet, to be read."""
    points = one.points(64), other.points(64)
    gaps = np.linalg.norm(points[0][:, None] - points[1][None], axis=2)
    i, j = np.unravel_index(gaps.argmin(), gaps.shape)
    return shown_point((points[0][i] + points[1][j]) / 2)


def at(point: Point) -> str:
    """A point, to be read."""
    return f"({plain(point[0])}, {plain(point[1])})"
