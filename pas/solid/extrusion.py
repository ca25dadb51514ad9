"""Solids over profiles, between two planes, with upright or leaning sides."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from flint import fmpq

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import near, plain, square_root, to_float
from pas.errors import GeometryError
from pas.mesh.rows import Floats
from pas.solid.edges import Loop, PlaneEdge, at, gradient, line, radius_of
from pas.solid.faces import COARSE, Faces, SweptBody, cross, flat, jets_of
from pas.solid.formulas import PlaneSet, formula
from pas.solid.joints import Joint
from pas.solid.linked import SolidBoundary
from pas.solid.operands import Operands
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
        return formula(loop, lambda edge: Atom(lean.surface(edge), edge.name), lambda edge: Atom(lean.wall(edge), ""))

    ends = [Atom(Polynomial.from_raw(-Z), "bottom"), Atom(Polynomial.from_raw(Z - height), "top")]
    tree = combined(False, profile.tree(lift), *ends)
    loops = profile.boundary
    body: SolidBoundary | None = None
    if loops is not None:
        body = Prism(loops=loops, height=to_float(height), lean=Lean(slope))
        body.refuse_lost_top()
    elif not slope:
        body = Operands.of(*profile.operands(lambda part: extruded(part, height, taper)))
    claims = dict.fromkeys(claim for loop in loops or profile.all_loops for claim in joints(loop, Lean(slope)))
    return Solid(tree, tuple(claims), (), body)


@dataclass(frozen=True)
class Lean:
    """How sides lean: by `slope` to the left of their edges for each unit of height."""

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
    """The claims that sides go on smoothly in one another."""
    for one, other in loop.smooth_corners:
        u, v = one.tangent(at_end=True)
        across = Polynomial.from_raw((X - one.end[0]) * u + (Y - one.end[1]) * v)
        flat_side = PlaneEdge.straight(one.end, (one.end[0] + u, one.end[1] + v), "")
        yield Joint(one.name, other.name, (lean.surface(flat_side), across), 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class Prism(SweptBody):
    """A solid over loops up to a height."""

    height: float
    lean: Lean

    def made(self, tolerance: float) -> Faces | None:
        """Its faces: rows of the loops' polygons at both ends, and between them the sides."""
        found = self.polygons(tolerance)
        if found is None:
            return None
        polygons, counts, triangles = found
        tops = [self._top(*some) for some in zip(self.loops, polygons, counts, strict=True)]
        levels = (np.concatenate(polygons), 0.0), (np.concatenate(tops), self.height)
        made = Faces([np.pad(p, ((0, 0), (0, 1)), constant_values=z) for p, z in levels], 0.0)
        n, first = len(levels[0][0]), 0
        for loop, points, count in zip(self.loops, polygons, counts, strict=True):
            borders = np.cumsum([0, *count])
            for edge, (a, b) in zip(loop.edges, pairwise(borders.tolist()), strict=True):
                below, above = (first + np.arange(a, b + 1) % len(points) + up for up in (0, n))
                made.put_side(edge.name, [*np.stack([above, below], axis=1)], jets_of(self.lean.surface(edge)))
            first += len(points)
        made.put_flat("bottom", triangles[:, ::-1], np.array([0.0, 0.0, -1.0]))
        top = flat(tops) if self.lean.slope else triangles
        if top is None:
            return None
        made.put_flat("top", n + top, np.array([0.0, 0.0, 1.0]))
        return made

    def _top(self, loop: Loop, points: Floats, counts: list[int]) -> Floats:
        """Where the points (N, 2) of a loop's polygon come to at the top."""
        if not self.lean.slope:
            return points
        by = to_float(self.lean.slope) * self.height
        ways, starts = np.concatenate(inwards(loop, points, counts)), np.cumsum([0, *counts[:-1]])
        for number, start in enumerate(starts.tolist()):
            mine, before = loop.edges[number], loop.edges[number - 1]
            if mine.control is None and before.control is None:  # at a corner both sides lean
                pair = np.array([ways[start], ways[starts[number - 1]]])
                turned = float(np.linalg.det(pair))
                ways[start] = np.linalg.solve(pair, np.ones(2)) if abs(turned) > 1e-12 else ways[start]
        return np.asarray(points + by * ways)

    def refuse_lost_top(self) -> None:
        """Raise `GeometryError` where the edges do not all reach the top in their order."""
        if not self.lean.slope:
            return
        tops = []
        for loop in self.loops:
            points, count = loop.polygon(COARSE)
            top = self._top(loop, points, count)
            chords = [np.roll(p, -1, axis=0) - p for p in (points, top)]
            lost = np.flatnonzero((chords[0] * chords[1]).sum(axis=1) <= 0)
            if len(lost):
                edge = loop.edges[int(np.searchsorted(np.cumsum(count), lost[0], side="right"))]
                raise GeometryError(
                    f"the taper is too much: the side of edge {edge.name!r} does not reach the top, at height "
                    f"{self.height:.6g}; take a smaller height or taper"
                )
            tops.append(top)
        if (
            flat(tops) is None
            or min(cross(p, np.roll(p, -1, axis=0)).sum() * s for p, s in zip(tops, self._signs, strict=True)) <= 0
        ):
            raise GeometryError("the taper is too much: sides meet below the top; take a smaller height or taper")

    @property
    def _signs(self) -> list[int]:
        return [1 if loop.is_counterclockwise else -1 for loop in self.loops]


def inwards(loop: Loop, points: Floats, counts: list[int]) -> list[Floats]:
    """Unit normals (N, 2) of each edge inwards at the points of a loop's polygon."""
    normals = []
    for edge, begin, count in zip(loop.edges, np.cumsum([0, *counts]).tolist(), counts, strict=False):
        slopes = edge.curve.gradient(np.pad(points[begin : begin + count], ((0, 0), (0, 1))))[:, :2]
        normals.append(-slopes / np.linalg.norm(slopes, axis=1)[:, None] * (edge.bow or 1))
    return normals


def square_of(edge: PlaneEdge) -> fmpq:
    """The squared length of the gradient of a straight edge's polynomial."""
    u, v = gradient(edge.curve, edge.start)
    return u * u + v * v


def circle_of(edge: PlaneEdge) -> tuple[tuple[fmpq, fmpq], fmpq]:
    """Centre and radius of an edge that is an arc of a circle, to rounding where that is not rational."""
    found = radius_of(edge.curve)
    assert found is not None
    return found[0], square_root(found[1])
