"""Solids over profiles, between two planes, with upright or leaning sides."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import pairwise, product

import numpy as np
from flint import fmpq

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import near, plain, square_root, to_float
from pas.arrays import Floats, Integers
from pas.errors import GeometryError
from pas.solid.edges import Loop, PlaneEdge, at, gradient, line, radius_of
from pas.solid.faces import COARSE, Faces, SolidBoundary, SweptBody, cross, flat
from pas.solid.formulas import PlaneSet, formula
from pas.solid.joints import Joint
from pas.solid.solid import Solid
from pas.solid.tree import Atom, Tree, combined

X, Y, Z = GENERATORS


def extruded(profile: PlaneSet, height: fmpq, taper: fmpq) -> Solid:
    """The solid over a profile; see `Profile.extrude`."""
    if height <= 0:
        raise ValueError(f"height must be positive, not {plain(height)}; translate the solid to put it elsewhere")
    if abs(taper) >= 90:
        raise ValueError(f"taper must be between -90 and 90 degrees, not {plain(taper)}")
    slope = near(math.tan(math.radians(to_float(taper)))) if taper else fmpq(0)

    def lift(loop: Loop, outside: bool) -> Tree:
        lean = Lean(-slope if outside else slope)
        lean.check(loop, height)
        return lean.tree(loop)

    ends = [Atom(Polynomial.from_raw(-Z), "bottom"), Atom(Polynomial.from_raw(Z - height), "top")]
    tree = combined(False, profile.tree(lift), *ends)
    loops = profile.boundary
    body: SolidBoundary | None = None
    if loops is not None:
        body = Prism(loops=loops, height=to_float(height), lean=Lean(slope))
        body.refuse_lost_top()
    elif not slope:
        body = profile.operands(lambda part: extruded(part, height, taper))
    claims = dict.fromkeys(claim for loop in loops or profile.all_loops for claim in joints(loop, Lean(slope)))
    return Solid(tree, tuple(claims), (), body)


@dataclass(frozen=True)
class Lean:
    """The lean of sides: by `slope` to the left of their edges for each unit of height."""

    slope: fmpq

    def surface(self, edge: PlaneEdge) -> Polynomial:
        """The surface over an edge, negative where its polynomial is."""
        if not self.slope:
            return edge.curve
        if edge.control is None:
            return edge.curve + Polynomial.from_raw(Z * (self.slope * square_root(square_of(edge))))
        center, radius = circle_of(edge)
        rest = radius - self.slope * edge.bow * Z
        return Polynomial.from_raw((X - center[0]) ** 2 + (Y - center[1]) ** 2 - rest * rest)

    def wall(self, edge: PlaneEdge) -> Polynomial:
        """The plane over the chord of an arc, through the apex of its cone."""
        chord = line(edge.start, edge.end)
        if not self.slope:
            return chord
        center, radius = circle_of(edge)
        apex = radius * edge.bow / self.slope
        return chord - Polynomial.from_raw(Z * (chord.raw(*center, 0) / apex))

    def tree(self, loop: Loop) -> Tree:
        """The set between the sides over a loop."""
        return formula(loop, lambda edge: Atom(self.surface(edge), edge.name), lambda edge: Atom(self.wall(edge), ""))

    def check(self, loop: Loop, height: fmpq) -> None:
        """Raise `GeometryError` where sides that lean have no such surfaces."""
        if not self.slope:
            return
        for edge in loop.edges:
            if edge.control is None:
                continue
            if radius_of(edge.curve) is None:
                raise GeometryError(f"the edge {edge.name!r} is no arc of a circle: its side cannot lean by a taper")
            _, radius = circle_of(edge)
            if radius <= self.slope * edge.bow * height:
                raise GeometryError(
                    f"the taper is too much for the edge {edge.name!r}: its radius, {plain(radius)}, is used up at "
                    f"height {to_float(radius / abs(self.slope)):.6g}"
                )
        for one, other in loop.corners:
            if (
                (one.control or other.control)
                and one.curve != other.curve
                and (one, other) not in [*loop.smooth_corners]
            ):
                raise GeometryError(
                    f"edges {one.name!r} and {other.name!r} meet with an angle at {at(one.end)}, one of them an arc: "
                    f"sides lean by a taper only where arcs go on in their neighbours' direction"
                )


def joints(loop: Loop, lean: Lean) -> Iterator[Joint]:
    """The claims that neighbouring sides continue one another smoothly."""
    for one, other in loop.smooth_corners:
        u, v = one.tangent(at_end=True)
        across = Polynomial.from_raw((X - one.end[0]) * u + (Y - one.end[1]) * v)
        flat_side = PlaneEdge.straight(one.end, (one.end[0] + u, one.end[1] + v), "")
        yield Joint(one.name, other.name, (lean.surface(flat_side), across), 1)


def _section(order: int, parts: int) -> Floats:
    """Points (parts + 1, 2) of the section 2 s t = (1 - s - t)^(order + 1) of a fillet: t and s of each.

    They are in the directions of points evenly along the circle that it is of order 1.
    """
    turns = np.linspace(0, np.pi / 2, parts + 1)
    circle = 1 - np.stack([np.sin(turns), np.cos(turns)], axis=1)
    shares = circle / circle.sum(axis=1)[:, None]
    low, high = np.zeros(parts + 1), np.ones(parts + 1)
    for _ in range(60):  # halvings, after which doubles are equal
        middle = (low + high) / 2
        inside = 2 * shares.prod(axis=1) * middle**2 < (1 - middle) ** (order + 1)
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.asarray(shares * high[:, None]) if order else shares


@dataclass(frozen=True)
class Rounds:
    """The faces, by name and surface, along the edges of a loop, by its number, in a plane across it at a `level`,
    above it if `up` is 1 and below if -1: rounds of an end of its solid, or, where `foot` is not 0, fillets around it.

    A fillet ends in the plane, in what the solid stands on, and begins where the sides are left.  Rounding would say
    which of two faces in one plane is in front, so that the row of the sides is moved on by `foot` beyond it.
    """

    loop: int
    level: float
    up: int
    foot: float
    radius: float
    order: int
    faces: tuple[tuple[str, Polynomial], ...]

    def fits(self, height: float) -> bool:
        """Whether they are beside a solid up to a height, or at one of its ends."""
        within = 0.0 <= self.level <= height and 0.0 < self.level + self.up * self.radius < height
        return within and (self.foot > 0 or self.level in (0.0, height))

    def rows(self, tolerance: float) -> Floats:
        """How far inwards, and how high, rows (N, 2) along them are, from above."""
        turns = max(2, math.ceil(0.9 * self.order * math.sqrt(3 * self.radius / tolerance)))
        arc = self.radius * _section(self.order, turns) * [-1 if self.foot else 1, self.up]
        beyond = np.array([[0.0, -self.up * self.foot]] if self.foot else np.empty((0, 2)))
        return np.concatenate([beyond, arc])[:: -self.up] + [0, self.level]


@dataclass(frozen=True, eq=False, kw_only=True)
class Prism(SweptBody):
    """A solid over loops up to a height; one that does not lean may have rounds, or fillets around it, along some."""

    height: float
    lean: Lean = field(default=Lean(fmpq(0)))
    rounds: tuple[Rounds, ...] = ()

    def made(self, tolerance: float) -> Faces:
        """Its faces, finer where they are nearly singular, as tori are that nearly meet themselves."""
        finer, finest = tolerance, min(tolerance, 2.0**-20 * self.extent)
        while (found := self._rows(finer)).deviation > tolerance and finer > finest:
            finer /= 4
        return found

    def _rows(self, tolerance: float) -> Faces:
        """Rows of the loops' polygons, moved along the rounds, all between them, and both ends."""
        made, (points, counts, _) = Faces(), self.polygons(tolerance / 3 if self.rounds else tolerance)
        polygons = enumerate(zip(points, counts, strict=True))
        rims = [self._put_sides(made, number, polygon, tolerance) for number, polygon in polygons]
        tops, bottoms = zip(*rims, strict=True)
        made.put_level("top", tops, 1)
        made.put_level("bottom", bottoms, -1)
        return made

    def _sections(
        self, made: Faces, number: int, polygon: tuple[Floats, list[int]], tolerance: float
    ) -> list[tuple[Integers, Rounds | None]]:
        """The rows of vertices of a loop, from above: those of its rounds, and others."""
        rounds = [one for one in self.rounds if one.loop == number]
        found: list[tuple[Floats, Rounds | None]] = [(one.rows(tolerance), one) for one in rounds]
        ends, slope = {self.height, 0.0} - {one.level for one in rounds}, to_float(self.lean.slope)
        found += [(np.array([[slope * z, z]]), None) for z in ends]
        sections = sorted(found, key=lambda section: -section[0][:, 1].mean())
        rows, last = np.concatenate([some for some, _ in sections]), np.cumsum([len(some) for some, _ in sections])
        falls = -np.diff(rows[:, 1])
        if falls.min() < 0 or falls[last[:-1] - 1].min() == 0:
            raise FloatingPointError("rounds meet")
        aside = rows[:, :1, None]
        moved = polygon[0] + aside * (self._ways(self.loops[number], *polygon) if aside.any() else 1.0)
        heights = np.broadcast_to(rows[:, 1, None, None], (*moved.shape[:2], 1))
        numbers = made.added(np.concatenate([moved, heights], axis=2).reshape(-1, 3)).reshape(len(rows), -1)
        for row, rim in zip(numbers, moved, strict=True):
            same = np.linalg.norm(rim - np.roll(rim, 1, axis=0), axis=1) < 2.0**-40 * self.extent
            row[:] = row[~same][np.cumsum(~same) - 1]  # of an arc of the radius one point is left
        return [*zip(np.split(numbers, last[:-1]), (one for _, one in sections), strict=True)]

    def _put_sides(
        self, made: Faces, number: int, polygon: tuple[Floats, list[int]], tolerance: float
    ) -> tuple[Integers, Integers]:
        """The faces of a loop but for both ends, whose rows of vertices are given back."""
        loop, sections = self.loops[number], self._sections(made, number, polygon, tolerance)
        bands: list[tuple[Integers, Rounds | None]] = [(rows, one) for rows, one in sections if one]
        bands += [(np.stack([above[-1], below[0]]), None) for (above, _), (below, _) in pairwise(sections)]
        for place, (rows, one) in enumerate(bands):
            if one and one.foot:
                *arc, rim, inner = rows[:: one.up]
                made.put_level(one.faces[0][0], (rim, inner[::-1]), -one.up)
                bands[place] = np.stack([*arc, rim])[:: one.up], one
        borders = np.cumsum([0, *polygon[1]])
        for (rows, one), (k, edge) in product(bands, enumerate(loop.edges)):
            name, surface = one.faces[0 if loop.whole else k] if one else (edge.name, self.lean.surface(edge))
            across = rows[:, np.arange(borders[k], borders[k + 1] + 1) % rows.shape[1]]
            made.put_side(name, [*across.T], surface.jets)
        return sections[0][0][0], sections[-1][0][-1]

    def _ways(self, loop: Loop, points: Floats, counts: list[int]) -> Floats:
        """The velocities (N, 2) of a loop's polygon's points as its sides move inwards by 1."""
        *starts, last = np.cumsum([0, *counts]).tolist()
        slopes = [
            edge.curve.gradient(np.pad(points[begin:end], ((0, 0), (0, 1))))[:, :2] * -(edge.bow or 1)
            for edge, (begin, end) in zip(loop.edges, pairwise([*starts, last]), strict=True)
        ]
        ways = np.concatenate([some / np.linalg.norm(some, axis=1)[:, None] for some in slopes])
        for number, start in enumerate(starts):
            mine, before = loop.edges[number], loop.edges[number - 1]
            if mine.control is None and before.control is None:  # at a corner both sides move
                pair = np.array([ways[start], ways[starts[number - 1]]])
                turned = float(np.linalg.det(pair))
                ways[start] = np.linalg.solve(pair, np.ones(2)) if abs(turned) > 1e-12 else ways[start]
        return ways

    def refuse_lost_top(self) -> None:
        """Raise `GeometryError` where the edges do not all reach the top in their order."""
        if not self.lean.slope:
            return
        tops = []
        for loop in self.loops:
            points, count = loop.polygon(COARSE)
            top = points + to_float(self.lean.slope) * self.height * self._ways(loop, points, count)
            chords = [np.roll(p, -1, axis=0) - p for p in (points, top)]
            lost = np.flatnonzero((chords[0] * chords[1]).sum(axis=1) <= 0)
            if len(lost):
                edge = loop.edges[int(np.searchsorted(np.cumsum(count), lost[0], side="right"))]
                raise GeometryError(
                    f"the taper is too much: the side of edge {edge.name!r} does not reach the top, at height "
                    f"{self.height:.6g}; take a smaller height or taper"
                )
            tops.append(top)
        areas = [cross(p, np.roll(p, -1, axis=0)).sum() for p in tops]
        signs = [1 if loop.is_counterclockwise else -1 for loop in self.loops]
        with suppress(FloatingPointError):
            flat(tops)
            if min(area * sign for area, sign in zip(areas, signs, strict=True)) > 0:
                return
        raise GeometryError("the taper is too much: sides meet below the top; take a smaller height or taper")


def square_of(edge: PlaneEdge) -> fmpq:
    """The squared length of the gradient of a straight edge's polynomial."""
    u, v = gradient(edge.curve, edge.start)
    return u * u + v * v


def circle_of(edge: PlaneEdge) -> tuple[tuple[fmpq, fmpq], fmpq]:
    """Centre and radius of an edge that is an arc of a circle, to rounding where that is not rational."""
    found = radius_of(edge.curve)
    assert found is not None
    return found[0], square_root(found[1])
