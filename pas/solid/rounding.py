"""Solids with plane faces whose edges are rounded together with the corners where three of them meet.

Of a face f = 0 let q = 1 + f / a: 1 on it, and 0 at the depth a in the solid, which is the radius times the length of
the gradient.  The patch of an edge has the q of two faces, that of a corner of three.

Order 1: with C the cosines between the faces' normals and c = C^-1 q it is

    q . c = 1  where all c >= 0,

the cylinder or the sphere of a ball that rolls inside (Rossignac and Requicha 1984).  Where gradients have no rational
lengths these are rounded to six digits: the ball is an ellipsoid then, by as much, and all contacts are exact.

Order k > 1: with c = q it is P(q_1) + P(q_2) + ... = 1, where P'' is a multiple of (x (1 - x))^(k-1), P(0) = P'(0) = 0
and P(1) = 1.  As P vanishes at 0 to order k + 1, each patch has contact of order k with those of fewer faces.  All are
convex; edges of order 2 between planes at right angles bend by 1.25 over the radius at most, by 1.78 if P were x^3.

Guaranteed of solids all of which the planes bound: the joints hold, as each point of it has planes with q > 0 that meet
in one edge or corner, as long as no edge is used up (`StraightEdge.largest`).  `Solid.verdicts` proves them all the
same, from the solid alone.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, compress
from math import ceil, comb, sqrt

import numpy as np
from flint import fmpq, fmpq_mat
from numpy.polynomial import Polynomial as Series

from pas.algebra.inputs import check_order, shown_point
from pas.algebra.lengths import across, unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, cross, dot, plain, to_float, to_floats
from pas.arrays import Floats, Integers
from pas.errors import GeometryError, meant
from pas.solid.face_seams import PlaneFace
from pas.solid.faces import FacedBody, Faces, SolidBoundary, flat
from pas.solid.joints import Joint
from pas.solid.operands import Operands
from pas.solid.solid import Solid
from pas.solid.tree import Atom, Tree, combined, complement, parts_of


@dataclass(frozen=True)
class EdgeEnd:
    """A plane in which an edge ends, where along it, and how that changes as each plane moves in by a radius of 1."""

    plane: PlaneFace
    place: fmpq
    moves: Mapping[PlaneFace, fmpq]


@dataclass(frozen=True)
class StraightEdge:
    """The edge of two planes between two others, in the direction of the vector product of their normals."""

    planes: tuple[PlaneFace, PlaneFace]
    ends: tuple[EdgeEnd, EdgeEnd]

    @property
    def vertices(self) -> tuple[frozenset[PlaneFace], frozenset[PlaneFace]]:
        """The planes that meet at its start and at its end."""
        start, end = (frozenset((*self.planes, end.plane)) for end in self.ends)
        return start, end

    def largest(self, rounds: Set[frozenset[PlaneFace]], order: int) -> fmpq | None:
        """The radius up to which all lines along it, in which rounds of pairs of planes end, certainly have a length.

        On a plane each ends as far from the other as a ball or level surface touches it; between two the ends of a
        round are looked at where these meet.  None where no radius is too large.
        """
        start, end = self.ends
        rates = [fmpq(0), fmpq(0), fmpq(0)]
        for number, face in enumerate(self.planes):
            for plane in (p for p in {*start.moves, *end.moves} if frozenset((face, p)) in rounds):
                depth = 1 - face.cosine(plane) if order == 1 else fmpq(1)
                rates[number] += depth * (start.moves.get(plane, fmpq(0)) - end.moves.get(plane, fmpq(0)))
        for at, sign in ((start, 1), (end, -1)):
            if {frozenset(pair) for pair in combinations((*self.planes, at.plane), 2)} <= rounds:
                rates[2] += sign * (sum(at.moves.values(), fmpq(0)) if order == 1 else at.moves[at.plane])
        return (end.place - start.place) / max(rates) if max(rates) > 0 else None


@dataclass(frozen=True, eq=False)
class RoundPatch:
    """The surface of an edge or corner between planes, with the functions that are positive where it is."""

    planes: tuple[PlaneFace, ...]
    surface: Polynomial
    walls: tuple[Polynomial, ...]
    cosines: fmpq_mat
    order: int

    @classmethod
    def of(cls, planes: Sequence[PlaneFace], radius: fmpq, order: int) -> RoundPatch:
        """The patch of two or three planes."""
        q = [1 + plane.polynomial * (1 / (radius * plane.length)) for plane in planes]
        cosines = fmpq_mat([[a.cosine(b) for b in planes] for a in planes])
        terms = [(power, term) for power, term in enumerate(_terms(order), 1) if term]
        walls, parts = q, [sum((x**power * term for power, term in terms), Polynomial(0)) for x in q]
        if order == 1:
            inverse = cosines.inv().tolist()
            walls = [sum((x * c for x, c in zip(q, row, strict=True)), Polynomial(0)) for row in inverse]
            parts = [x * wall for x, wall in zip(q, walls, strict=True)]
        return cls(tuple(planes), sum(parts, Polynomial(-1)), tuple(walls), cosines, order)

    @property
    def face(self) -> str:
        """Its name, after the planes."""
        return " / ".join(plane.name for plane in self.planes)

    @property
    def rest(self) -> Tree:
        """The set of points that it does not cut off."""
        return combined(True, *(Atom(wall, "") for wall in self.walls), Atom(self.surface, self.face))

    def heights(self, weights: Floats) -> Floats:
        """The q (N, m) of points where the functions c are in proportion to weights (N, m)."""
        if self.order == 1:
            q = weights @ np.array([to_floats(row) for row in self.cosines.tolist()])
            return np.asarray(q / np.sqrt((q * weights).sum(axis=1))[:, None])
        norm = Series([0.0, *to_floats(_terms(self.order))])
        scale = 1 / weights.max(axis=1, keepdims=True)
        for _ in range(32):  # Newton's steps for a convex function go down to its zero from here
            q = scale * weights
            scale -= (norm(q).sum(axis=1) - 1)[:, None] / (norm.deriv()(q) * weights).sum(axis=1)[:, None]
        return np.asarray(scale * weights)


def _terms(order: int) -> list[fmpq]:
    """The coefficients of x, x^2, ... in P(x), whose second derivative is a multiple of (x (1 - x))^(order - 1)."""
    terms = [fmpq((-1) ** j * comb(order - 1, j), (order + j) * (order + 1 + j)) for j in range(order)]
    return [fmpq(0)] * order + [term / sum(terms, fmpq(0)) for term in terms]


def rounded(solid: Solid, faces: Sequence[str] | None, radius: fmpq, order: int) -> Solid:
    """The solid with the edges between plane faces rounded, and the corners where three meet; see `Solid.rounded`."""
    if check_order(order) < 1:
        raise ValueError("order must be at least 1; chamfer cuts edges off flatly")
    parts = parts_of(solid.tree, union=False)
    found = [plane for part in parts if (plane := PlaneFace.of(part)) is not None]
    sides = dict[tuple[Polynomial, bool], PlaneFace]()
    for plane in sorted(found, key=lambda plane: not plane.name):  # of equal ones the first that has a name
        sides.setdefault((plane.polynomial.primitive(), max(plane.normal, key=abs) > 0), plane)
    planes = [*sides.values()]
    known = list(dict.fromkeys(plane.name for plane in planes if plane.name))
    for name in faces or ():
        if name not in known:
            hint = meant(name, known) or "; edges are rounded between planes of a convex solid, or of one with holes"
            raise GeometryError(f"the solid has no plane face {name!r} that bounds all of it{hint}")
    chosen = {plane for plane in planes if plane.name and (faces is None or plane.name in faces)}
    body = RoundedBody(planes=tuple(planes), chosen=tuple(p in chosen for p in planes), radius=radius, order=order)
    edges, patches = body.edges, body.patches
    rounds = {some for some in patches if len(some) == 2}
    if not rounds:
        raise GeometryError("no two of the faces are planes that meet in an edge of a convex solid, or one with holes")
    most = min((limit for edge in edges if (limit := edge.largest(rounds, order)) is not None), default=None)
    if most is not None and radius >= most:
        raise GeometryError(f"radius must be below {to_float(most):.6g}, where an edge is used up, not {plain(radius)}")
    if again := {*solid.faces}.intersection(patch.face for patch in patches.values()):
        raise GeometryError(f"the edge {min(again)!r} is rounded already")
    rests = [patch.rest for patch in patches.values()]
    simple = {*Counter(vertex for edge in edges for vertex in edge.vertices).values()} == {3}
    sheets: SolidBoundary | None = body if simple else None
    if sheets and (others := [part for part in parts if PlaneFace.of(part) is None]):
        whole = Solid(combined(False, *(p for p in parts if p not in others), *rests), sheets=body)
        sheets = Operands.of((whole, *(Solid(complement(part)) for part in others)), "Subtract")
    joints = *solid.joints, *_claims(patches)
    return replace(solid, tree=combined(False, solid.tree, *rests), joints=joints, sheets=sheets)


def _edges(planes: Sequence[PlaneFace], chosen: set[PlaneFace]) -> Iterator[StraightEdge]:
    """The edges of the convex polyhedron that planes bound; planes that only touch it have none and end none.

    Raises `GeometryError` where one of two chosen planes has no end, or ends in several planes.
    """
    lines = list[tuple[tuple[PlaneFace, PlaneFace], list[fmpq], Vector, list[list[EdgeEnd]]]]()
    for pair in combinations(planes, 2):
        one, other = pair
        way = cross(one.normal, other.normal)
        square = dot(way, way)
        if square == 0:
            continue
        steps = {one: cross(way, other.normal), other: cross(one.normal, way)}  # as its offset grows by the square
        start = [sum((p.offset * step[i] for p, step in steps.items()), fmpq(0)) / square for i in range(3)]
        ends: list[list[EdgeEnd]] = [[], []]
        for plane in planes:
            slope, value = dot(plane.normal, way), dot(plane.normal, start) + plane.offset
            if slope == 0:
                if value > 0 or (value == 0 and any(dot(plane.normal, step) > 0 for step in steps.values())):
                    break
                continue
            moves = {p: -p.length * dot(plane.normal, step) / (square * slope) for p, step in steps.items()}
            found = EdgeEnd(plane, -value / slope, {**moves, plane: -plane.length / slope})
            side = int(slope > 0)
            ahead = (found.place - ends[side][0].place) * (1 if side else -1) if ends[side] else fmpq(-1)
            if ahead <= 0:
                ends[side] = [*ends[side], found] if ahead == 0 else [found]
            if all(ends) and ends[1][0].place <= ends[0][0].place:
                break
        else:
            lines.append((pair, start, way, ends))
    bounding = {plane for pair, *_ in lines for plane in pair}
    for (one, other), start, way, both in lines:
        ends = [[end for end in some if end.plane in bounding] for some in both]
        for some in ends if chosen.issuperset((one, other)) else ():
            if len(some) == 1:
                continue
            at = [to_float(x + end.place * w) for end in some[:1] for x, w in zip(start, way, strict=True)]
            where = f"ends in {len(some)} planes near {shown_point(at)}" if some else "does not end"
            raise GeometryError(
                f"the edge of {one.name!r} and {other.name!r} {where}: only corners of three planes are rounded"
            )
        if all(ends):
            yield StraightEdge((one, other), (ends[0][0], ends[1][0]))


def _claims(patches: Mapping[frozenset[PlaneFace], RoundPatch]) -> Iterator[Joint]:
    """The joints of each patch with those of its planes but one, of which the function is 0 there."""
    for patch in patches.values():
        for plane, wall in zip(patch.planes, patch.walls, strict=True):
            others = frozenset(patch.planes) - {plane}
            ground = patches.get(others)
            name, surface = (ground.face, ground.surface) if ground else next((p.name, p.polynomial) for p in others)
            yield Joint(patch.face, name, (surface, wall), patch.order)


@dataclass(frozen=True, eq=False, kw_only=True)
class RoundedBody(FacedBody):
    """The boundary of a rounded polyhedron three edges of which meet at each vertex."""

    planes: tuple[PlaneFace, ...]
    chosen: tuple[bool, ...]
    radius: fmpq
    order: int

    @cached_property
    def edges(self) -> tuple[StraightEdge, ...]:
        """The edges of the polyhedron."""
        return tuple(_edges(self.planes, {*compress(self.planes, self.chosen)}))

    @cached_property
    def patches(self) -> dict[frozenset[PlaneFace], RoundPatch]:
        """The rounds of edges between chosen planes, and of corners of three, by their planes."""
        chosen = {*compress(self.planes, self.chosen)}
        among = [edge for edge in self.edges if chosen.issuperset(edge.planes)]
        corners = (vertex for edge in among for vertex in edge.vertices if chosen.issuperset(vertex))
        meeting = dict.fromkeys([*(frozenset(edge.planes) for edge in among), *corners])
        return {some: RoundPatch.of([p for p in self.planes if p in some], self.radius, self.order) for some in meeting}

    @property
    def extent(self) -> float:
        corners = [_corner(tuple(vertex), np.ones((1, 3)), 0.0) for edge in self.edges for vertex in edge.vertices]
        return float(np.ptp(np.concatenate(corners), axis=0).max())

    def made(self, tolerance: float) -> Faces:
        """Its faces, all arcs in as many parts as it takes."""
        parts, finest = 4, 1 << 10
        while True:
            found = self._in_parts(parts)
            if found.deviation <= tolerance or parts >= finest:
                return found
            parts = ceil(parts * max(1.1, sqrt(found.deviation / tolerance)))

    def _in_parts(self, n: int) -> Faces:
        made, arcs = Faces(), dict[tuple[frozenset[PlaneFace], frozenset[PlaneFace]], Integers]()
        outlines: dict[PlaneFace, list[Integers]] = {}
        curved, radius = list[tuple[RoundPatch, Integers]](), to_float(self.radius)
        for vertex in dict.fromkeys(vertex for edge in self.edges for vertex in edge.vertices):
            pairs = [some for some in self.patches if len(some) == 2 and some < vertex]
            patch = self.patches.get(vertex) or (self.patches[pairs[0]] if pairs else None)
            if patch is None:
                here = made.added(_corner(tuple(vertex), np.ones((1, 3)), radius))
                for plane in (plane for plane in self.planes if plane in vertex):
                    outlines.setdefault(plane, []).append(here)
                continue
            planes = (*patch.planes, *(vertex - {*patch.planes}))
            weights, triangles = _weights_and_triangles(n, len(patch.planes))
            q = np.ones((len(weights), 3))
            q[:, : len(patch.planes)] = patch.heights(weights / n)
            numbers = made.added(_corner(planes, q, radius))
            for number, plane in enumerate(patch.planes):
                outlines.setdefault(plane, []).append(numbers[weights[:, number] == n])
            for pair in pairs:
                first, last = (patch.planes.index(plane) for plane in patch.planes if plane in pair)
                on = np.flatnonzero(weights[:, [first, last]].sum(axis=1) == n)
                arcs[pair, vertex] = numbers[on[np.argsort(weights[on, last])]]
            if len(patch.planes) == 2:
                outlines.setdefault(planes[2], []).append(numbers)
            else:
                turned = np.linalg.det([to_floats(plane.normal) for plane in planes]) < 0
                curved.append((patch, numbers[triangles[:, ::-1] if turned else triangles]))
        for edge in self.edges:
            pair = frozenset(edge.planes)
            if pair in self.patches:
                patch = self.patches[pair]
                start, end = (arcs[pair, vertex] for vertex in edge.vertices)
                made.put_side(patch.face, [*np.stack([end, start], axis=1)], patch.surface.jets)
        for patch, triangles in curved:
            made.put_curved(patch.face, triangles, patch.surface.jets)
        points = made.points
        for plane, parts in outlines.items():
            normal = unit(to_floats(plane.normal))
            numbers = np.concatenate(parts)
            away = points[numbers] - points[numbers].mean(axis=0)
            shown = away @ across(normal).T
            order = np.argsort(np.arctan2(shown[:, 1], shown[:, 0]))
            made.put_flat(plane.name, numbers[order][flat([shown[order]])], normal)
        return made


def _weights_and_triangles(n: int, many: int) -> tuple[Integers, Integers]:
    """Weights (N, many) of two or three corners, whole numbers that add up to n, and triangles (T, 3) between them."""
    if many == 2:
        return np.stack([n - np.arange(n + 1), np.arange(n + 1)], axis=1), np.empty((0, 3), dtype=np.intp)
    u, v = np.nonzero(np.add.outer(np.arange(n + 1), np.arange(n + 1)) <= n)
    number = np.zeros((n + 2, n + 2), dtype=np.intp)
    number[u, v] = np.arange(len(u))
    up, down = u + v < n, u + v < n - 1
    first = np.stack([number[u, v], number[u + 1, v], number[u, v + 1]], axis=1)[up]
    second = np.stack([number[u + 1, v], number[u + 1, v + 1], number[u, v + 1]], axis=1)[down]
    return np.stack([n - u - v, u, v], axis=1), np.concatenate([first, second])


def _corner(planes: Sequence[PlaneFace], q: Floats, radius: float) -> Floats:
    """The points (N, 3) that have values q (N, 3) over three planes."""
    normals = np.array([to_floats(plane.normal) for plane in planes])
    offsets, lengths = np.array([to_floats((plane.offset, plane.length)) for plane in planes]).T
    return np.asarray(np.linalg.solve(normals, (radius * lengths * (q - 1) - offsets).T).T)
