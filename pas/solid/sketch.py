"""Profiles drawn edge by edge, and the usual ones: polygons, rectangles, circles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NoReturn

from flint import fmpq

from pas.algebra.rational import Exact, dot, near, plain, positive, rational, square_root, to_float
from pas.errors import GeometryError, missing
from pas.solid.edges import Loop, PlaneEdge, Point, across, arc, at, minus, turn
from pas.solid.profile import Profile, plane_point


@dataclass(frozen=True)
class Sketch:
    """Edges drawn one after the other from a start; each method returns a longer sketch, `close` the profile.

    Edges are named "side 1", "side 2", ... unless `face` names them.
    """

    start: Point
    edges: tuple[PlaneEdge, ...] = ()
    count: int = 0

    @property
    def end(self) -> Point:
        """The point where the next edge begins."""
        return self.edges[-1].end if self.edges else self.start

    def __repr__(self) -> str:
        return f"<Sketch of {self.count} edges from {at(self.start)} to {at(self.end)}>"

    def line_to(self, x: Exact, y: Exact, face: str | None = None) -> Sketch:
        """A straight edge to a point."""
        end = self._target(x, y)
        return self._with(face, lambda name: [PlaneEdge.straight(self.end, end, name)])

    def arc_to(
        self,
        x: Exact,
        y: Exact,
        radius: Exact | None = None,
        *,
        through: Sequence[Exact] | None = None,
        clockwise: bool = False,
        large: bool = False,
        face: str | None = None,
    ) -> Sketch:
        """An arc of a circle to a point: of a radius, or through a third point, or continuing the last edge.

        With a radius it is the shorter arc, counterclockwise, unless `large` or `clockwise`; where the centre is not
        rational the radius is what was asked to within rounding of a double.  With neither it begins in the direction
        in which the last edge ends.  Raises `GeometryError` for a radius below half the distance, and where the circle
        would be a line.
        """
        end = self._target(x, y)
        if radius is not None and through is not None:
            raise TypeError("an arc takes a radius or a point to pass through, not both")
        chord = minus(end, self.end)
        if radius is not None:
            left, share = not clockwise, _share(self.end, end, rational(radius, "radius"))
            share = share if clockwise == large else -share
        else:
            if through is not None:
                third = plane_point(through, "through")
                ways = minus(third, self.end), minus(end, third)
                wrong = f"{at(self.end)}, {at(third)} and {at(end)} are in line: no circle passes them"
            elif self.edges:
                ways = self.edges[-1].tangent(at_end=True), chord
                wrong = f"the arc to {at(end)} would be straight: the last edge points there, or away from there"
            else:
                raise GeometryError(
                    "the first edge is no arc without a radius: there is no edge that it could continue"
                )
            side = across(*ways)  # both pairs of ways are at half the angle of the arc
            if side == 0:
                raise GeometryError(wrong)
            left, share = side > 0, dot(*ways) / (2 * side)
        (a, b), (c, d) = self.end, end
        center = (a + c) / 2 - share * chord[1], (b + d) / 2 + share * chord[0]
        return self._with(face, lambda name: arc(self.end, end, center, left, name))

    def curve_to(self, control: Sequence[Exact], x: Exact, y: Exact, face: str | None = None) -> Sketch:
        """A parabola's arc to a point: the Bezier curve of degree 2 with a control point."""
        middle, end = plane_point(control, "control"), self._target(x, y)
        return self._with(face, lambda name: [PlaneEdge.parabola(self.end, middle, end, name)])

    def close(self, face: str | None = None) -> Profile:
        """The profile inside the edges, with a straight one back to the start where they do not end there.

        Raises `GeometryError` where they cross, touch or turn back, or have nothing inside.
        """
        drawn = self if self.end == self.start else self.line_to(*self.start, face)
        return closed(drawn.edges)

    if not TYPE_CHECKING:  # else every name would be known

        def __getattr__(self, name: str) -> NoReturn:
            """Raises `AttributeError`; says what must be closed first for what profiles have."""
            if hasattr(Profile, name):
                way = f"close() goes from {at(self.end)} back to {at(self.start)}"
                raise AttributeError(f"an open sketch has no {name!r}, its profile has: {way}")
            raise missing("a sketch", name, dir(type(self)))

    def _target(self, x: Exact, y: Exact) -> Point:
        end = rational(x, "x"), rational(y, "y")
        if end == self.end:
            raise GeometryError(f"an edge from {at(end)} to {at(end)} has no length: give it another end")
        return end

    def _with(self, face: str | None, made: Any) -> Sketch:
        name = f"side {self.count + 1}" if face is None else face
        return replace(self, edges=(*self.edges, *made(name)), count=self.count + 1)


def closed(edges: Sequence[PlaneEdge], whole: bool = False) -> Profile:
    """The profile inside edges, in either direction; raises `GeometryError` where they are no boundary."""
    if len(edges) < 2 or all(
        edge.control is None and turn(edges[0].start, edges[0].end, edge.end) == 0 for edge in edges
    ):
        raise GeometryError("the profile has nothing inside: its edges are in one line")
    loop = Loop(tuple(edges), whole)
    if not whole:
        _ = loop.separated  # refuses what crosses
    return Profile(loop if loop.is_counterclockwise else loop.reversed)


def sketch(start: Sequence[Exact] = (0, 0)) -> Sketch:
    """A sketch that begins at a point, two exact numbers.

    Raises `TypeError` or `ValueError` for anything else.

        solid.sketch((0, 0)).line_to(4, 0).arc_to(4, 1, radius="1/2").line_to(0, 1).close()
    """
    return Sketch(plane_point(start, "start"))


def polygon(points: Sequence[Sequence[Exact]], face: str = "side") -> Profile:
    """The profile inside a polygon with given corners, in either order; its edges are named "side 1", ...

    Raises `ValueError` for less than three corners, `GeometryError` where it crosses or touches itself.
    """
    corners = [plane_point(p, f"points[{i}]") for i, p in enumerate(points)]
    if len(corners) < 3:
        raise ValueError(f"a polygon has at least three corners, not {len(corners)}")
    for i, (a, b) in enumerate(zip(corners, corners[1:] + corners[:1], strict=True)):
        if a == b:
            raise GeometryError(
                f"corners {i + 1} and {(i + 1) % len(corners) + 1} of the polygon are one point, {at(a)}"
            )
    ends = zip(corners, corners[1:] + corners[:1], strict=True)
    return closed([PlaneEdge.straight(a, b, f"{face} {i + 1}") for i, (a, b) in enumerate(ends)])


def rectangle(width: Exact, height: Exact, corner: Sequence[Exact] = (0, 0), face: str = "side") -> Profile:
    """The rectangle with sides along the axes and its lower left corner at a point; lengths in the model's units.

    Raises `ValueError` for lengths that are not positive.
    """
    w, h = positive(width, "width"), positive(height, "height")
    x, y = plane_point(corner, "corner")
    return polygon([(x, y), (x + w, y), (x + w, y + h), (x, y + h)], face)


def rounded_rectangle(
    width: Exact, height: Exact, radius: Exact, corner: Sequence[Exact] = (0, 0), face: str = "side"
) -> Profile:
    """A rectangle with corners rounded by quarter circles, which continue its sides smoothly.

    Lengths are in the model's units.  Raises `ValueError` for a radius that is more than half of a side and for lengths
    that are not positive.
    """
    w, h, r = positive(width, "width"), positive(height, "height"), positive(radius, "radius")
    if 2 * r > min(w, h):
        raise ValueError(f"radius must be at most {plain(min(w, h) / 2)}, half of the shorter side, not {plain(r)}")
    x, y = plane_point(corner, "corner")
    places = [((x + r, y), (x + w - r, y)), ((x + w, y + r), (x + w, y + h - r))]
    places += [((x + w - r, y + h), (x + r, y + h)), ((x, y + h - r), (x, y + r))]
    centers = [(x + w - r, y + r), (x + w - r, y + h - r), (x + r, y + h - r), (x + r, y + r)]
    edges: list[PlaneEdge] = []
    for i, ((start, end), center) in enumerate(zip(places, centers, strict=True)):
        if start != end:
            edges.append(PlaneEdge.straight(start, end, f"{face} {2 * i + 1}"))
        edges += arc(end, places[(i + 1) % 4][0], center, True, f"{face} {2 * i + 2}")
    return closed(edges)


def circle(center: Sequence[Exact], radius: Exact, face: str = "circle") -> Profile:
    """The disc of a radius about a centre, in the model's units; raises `ValueError` for one that is not positive."""
    (x, y), r = plane_point(center, "center"), positive(radius, "radius")
    ends = [(x + r, y), (x, y + r), (x - r, y), (x, y - r)]
    quarters = [arc(a, b, (x, y), True, face) for a, b in zip(ends, ends[1:] + ends[:1], strict=True)]
    return closed([edge for some in quarters for edge in some], whole=True)


def regular_polygon(sides: int, radius: Exact, center: Sequence[Exact] = (0, 0), face: str = "side") -> Profile:
    """The polygon with equal sides whose corners are on a circle; the first is to the right of the centre.

    The corners are rational points exactly on the circle, at angles right to within rounding of a double; its radius is
    in the model's units.  Raises `ValueError` for less than three sides and a radius that is not positive.
    """
    if not isinstance(sides, int) or isinstance(sides, bool) or sides < 3:
        raise ValueError(f"sides must be a whole number of at least 3, not {sides!r}")
    (x, y), r = plane_point(center, "center"), positive(radius, "radius")
    corners = []
    for k in range(sides):
        if 2 * k == sides:
            corners.append((x - r, y))
            continue
        t = near(math.tan(math.pi * k / sides))
        corners.append((x + r * (1 - t * t) / (1 + t * t), y + r * 2 * t / (1 + t * t)))
    return polygon(corners, face)


def _share(start: Point, end: Point, radius: fmpq) -> fmpq:
    """How far from the middle of a chord the centre of a circle of a radius is, over the length of the chord."""
    chord = minus(end, start)
    square = dot(chord, chord)
    rest = radius * radius / square - fmpq(1, 4)
    if radius <= 0 or rest < 0:
        half = math.sqrt(to_float(square)) / 2
        raise GeometryError(
            f"radius must be at least {half:.6g}, half the distance from {at(start)} to {at(end)}, not {plain(radius)}"
        )
    return square_root(rest)
