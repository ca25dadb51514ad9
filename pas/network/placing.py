"""The meshes of a network's nodes in all their places, and the struts between their rings.

The blend of a class is meshed once, and turned into each kind by its exact rotation or reflection; each kind of strut,
told apart by the kinds of its nodes and its arms there, has one strip of triangles between two rings.  So a mesh of any
size is a few tables and a place for each node.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import acos, ceil, cos, pi
from typing import Any

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.rational import to_floats
from pas.arrays import Floats, Integers, Numbers
from pas.errors import MeshError
from pas.network.classes import Kinds, NodeKind, ranked, turn
from pas.network.graph import StrutGraph
from pas.network.rings import FEWEST, Span, angles_around, circle, lid, places_of, rings_of, strip
from pas.pipeline.result import Blend

FEW = 1 / 4
"""Of the triangles of nodes: so many more are laid on struts, at most, for the sake of their angles."""

AT_ONCE = 2**16
"""Triangles of a share that are made together."""


@dataclass(frozen=True, eq=False)
class NodePiece:
    """The mesh of one kind of node around the origin, in the model's units; `rings` are the vertices on each arm's
    circle, `deviation` is the largest distance from the surface, as measured."""

    points: Floats
    triangles: Integers
    normals: Floats
    rings: tuple[Integers, ...]
    deviation: float

    def turned(self, matrix: Floats, order: Any) -> NodePiece:
        """The image under a rotation or reflection, whose arm `order[i]` is the image of this one's arm i."""
        rings = [self.rings[0]] * len(self.rings)
        for place, ring in zip(order, self.rings, strict=True):
            rings[place] = ring
        way = -1 if np.linalg.det(matrix) < 0 else 1  # a reflection turns the order of corners around
        triangles, normals = self.triangles[:, ::way], (self.normals @ matrix.T)[:, ::way]
        return NodePiece(self.points @ matrix.T, triangles, normals, tuple(rings), self.deviation)


@dataclass(frozen=True, eq=False)
class StrutPiece:
    """The strip of one kind of strut: triangles over the vertices of its first ring, then of its second, then `points`
    of its own about the first node, in the model's units.

    `kinds` are those of its nodes, `slots` its arms there, `edges` the numbers of the struts.
    """

    kinds: tuple[int, int]
    slots: tuple[int, int]
    vector: Floats
    points: Floats
    triangles: Integers
    normals: Floats
    deviation: float
    edges: Numbers


@dataclass(frozen=True, eq=False)
class MeshShare:
    """A part of a network's mesh: `shapes`, triangles with corners (T, 3, 3) about the nodes that they belong to, which
    of these each corner has (T, 3), and the nodes of all copies (M, k), as numbers of `places` (N, 3)."""

    shapes: Sequence[tuple[Floats, Integers, Numbers]]
    places: Floats

    @property
    def count(self) -> int:
        """The number of triangles."""
        return sum(len(corners) * len(copies) for corners, _, copies in self.shapes)

    def triangles(self) -> Iterator[Floats]:
        """The corners (n, 3, 3) of all triangles, some copies at a time, so that memory is bounded."""
        for corners, owners, copies in self.shapes:
            for some in np.array_split(copies, 1 + len(copies) * len(corners) // AT_ONCE):
                yield (corners + self.places[some][:, owners]).reshape(-1, 3, 3)


class PlacedPieces:
    """All pieces of a network's mesh within a tolerance (the model's units)."""

    def __init__(self, network: StrutGraph, kinds: Kinds, blends: dict[Any, Blend], tolerance: float) -> None:
        self.network, self.kinds, self.blends, self.tolerance = network, kinds, blends, tolerance

    @cached_property
    def nodes(self) -> list[NodePiece]:
        """The piece of each kind."""
        found: list[NodePiece] = [None] * len(self.kinds.kinds)  # type: ignore[list-item]
        for key, numbers in self.kinds.classes.items():
            first = self.kinds.kinds[numbers[0]]
            try:
                made = self._piece(first, self.kinds.ends[numbers[0]], self.blends.get(key))
            except MeshError as error:
                raise MeshError(f"the node {self.kinds.nodes(numbers)[0]}, in steps of the grid: {error}") from None
            for number in numbers:
                kind = self.kinds.kinds[number]
                matrix = np.array([to_floats(row) for row in turn(first, kind)])
                order = [kind.form.order[first.form.order.index(i)] for i in range(len(kind.arms))]
                found[number] = made.turned(matrix, order)
        return found

    def _piece(self, kind: NodeKind, ends: Floats, blend: Blend | None) -> NodePiece:
        step = float(self.network.grid)
        if blend is None:
            return self._ring(kind)
        mesh = blend.surface.mesh(self.tolerance / step)
        radii = [self._width(kind, i, ends[i]) / step for i in range(len(kind.arms))]
        rings = rings_of(mesh.points, mesh.boundary, zip(kind.vectors * 1.0, ends, radii, strict=False))
        deviation = float("inf") if mesh.deviation is None else mesh.deviation * step
        return NodePiece(mesh.points * step, mesh.triangles, mesh.normals, rings, deviation)

    def _width(self, kind: NodeKind, arm: int, at: float = 0.0) -> float:
        """The radius of an arm at some part of its vector."""
        here, there = (float(self.network.radii[size]) for size in kind.arms[arm][1:3])
        return here + (there - here) * at

    def _ring(self, kind: NodeKind) -> NodePiece:
        """A ring where a strut goes straight on; a flat end where there is no other."""
        radius, axis = self._width(kind, 0), unit(kind.vectors[0])
        points = radius * circle(axis, count := self._fewest(radius))
        ring = np.arange(count)
        if len(kind.arms) > 1:
            return NodePiece(points, np.zeros((0, 3), np.int64), np.zeros((0, 3, 3)), (ring, ring), 0.0)
        fan = lid(points, [ring], axis)[:, ::-1]
        return NodePiece(points, fan, np.broadcast_to(-axis, (len(fan), 3, 3)), (ring,), 0.0)

    @cached_property
    def _strips(self) -> tuple[bool, float, list[StrutPiece]]:
        """The piece of each kind of strut, and how they are cut, so that all rings together add few triangles.

        Rings are as round as those of nodes if these are few, else as the tolerance asks, and then all struts are cut
        whose rings take fewer triangles than a bound.
        """
        edges, kinds, slots = self.network.edges, self.kinds.of, self.kinds.slots
        rows = kinds[edges[:, 0]], slots[:, 0], kinds[edges[:, 1]], slots[:, 1]
        of, firsts = ranked(rows)
        different = np.stack([row[firsts] for row in rows], axis=1).tolist()
        order = np.argsort(of, kind="stable").astype(np.int32)
        groups = np.split(order, np.cumsum(np.bincount(of))[:-1]) if len(of) else []
        step = float(self.network.grid)
        vectors = [self.network.vectors[numbers[0]] * step for numbers in groups]
        spans = [
            (self._circle(a, i), self._circle(b, j), v) for (a, i, b, j), v in zip(different, vectors, strict=True)
        ]
        few = FEW * np.dot([len(node.triangles) for node in self.nodes], self.kinds.counts)
        for coarse in (False, True):
            cuts = [self._cut(span, coarse) for span in spans]
            costs = np.array([2.0 * count * len(places) for count, places in cuts])
            cheapest = np.argsort(costs)
            sums = np.cumsum((costs * list(map(len, groups)))[cheapest])
            bound = float(costs[cheapest][sums > few].min(initial=np.inf))
            if bound == np.inf:
                break
        cuts = [self._cut(span, coarse, bound) for span in spans]
        found = []
        for (a, i, b, j), numbers, span, cut in zip(different, groups, spans, cuts, strict=True):
            rise = self._width(self.kinds.kinds[a], i, 1.0) - self._width(self.kinds.kinds[a], i)
            points, triangles, normals, widest = strip(*span, rise, *cut)
            off = float(self.network.thickness[numbers[0]]) * (1 - cos(widest / 2))
            found.append(StrutPiece((a, b), (i, j), span[2], points, triangles, normals, off, numbers))
        return coarse, bound, found

    @property
    def struts(self) -> list[StrutPiece]:
        """The piece of each kind of strut."""
        return self._strips[2]

    def _fewest(self, radius: float) -> int:
        """The vertices that a ring must have to be within the tolerance."""
        return max(FEWEST, ceil(pi / acos(max(0.0, 1 - min(self.tolerance / radius, 1.0)))))

    def _cut(self, span: Span, coarse: bool, bound: float = np.inf) -> tuple[int, Floats]:
        """The vertices of rings between two, and their places, if those of a whole strut take fewer triangles."""
        axis, given = unit(span[2]), [ring for ring in span[:2] if len(ring)]
        count = self._fewest(float(np.linalg.norm(np.cross(np.concatenate(given), axis), axis=1).max()))
        if not coarse:
            count = max(count, min(map(len, given)))
        places, end = places_of(*span, count), np.ones(2 - len(given))
        return count, places if 2 * count * (len(places) - len(end)) * (1 + len(end)) < bound else end

    def _circle(self, kind: int, slot: int) -> Floats:
        """The points on the circle of an arm."""
        return self.nodes[kind].points[self.nodes[kind].rings[slot]]

    @cached_property
    def deviation(self) -> float:
        """The largest distance of any triangle from the surface, as measured, rounding of places included."""
        far = float(np.abs(self.network.points).max(initial=0)) + max(np.abs(n.points).max() for n in self.nodes)
        largest = max([n.deviation for n in self.nodes] + [s.deviation for s in self.struts])
        return largest + far * 2.0**-50

    def mesh(self) -> tuple[Floats, Integers, Floats, Integers]:
        """Points (N, 3), triangles (T, 3), normals at their corners (T, 3, 3), and whether each is of a strut (T,)."""
        of, edges = self.kinds.of, self.network.edges
        sizes = np.append([len(n.points) for n in self.nodes], 0)[of]  # the last is that of points without struts
        starts = np.cumsum(sizes) - sizes
        count = int(sizes.sum())
        points = np.empty((count + sum(len(s.points) * len(s.edges) for s in self.struts), 3))
        triangles, normals = [np.zeros((0, 3), dtype=np.int64)], [np.zeros((0, 3, 3))]
        for kind, piece in enumerate(self.nodes):
            own = np.flatnonzero(of == kind)
            points[starts[own][:, None] + np.arange(len(piece.points))] = (
                piece.points + self.network.points[own][:, None]
            )
            triangles.append((piece.triangles + starts[own][:, None, None]).reshape(-1, 3))
            normals.append(np.tile(piece.normals, (len(own), 1, 1)))
        many = sum(map(len, triangles))
        for strut in self.struts:
            rings = [self.nodes[kind].rings[slot] for kind, slot in zip(strut.kinds, strut.slots, strict=True)]
            corners = [starts[edges[strut.edges, end]][:, None] + rings[end] for end in (0, 1)]
            own = strut.points + self.network.points[edges[strut.edges, 0]][:, None]
            corners.append(count + np.arange(own.size // 3).reshape(own.shape[:2]))
            points[count : count + own.size // 3] = own.reshape(-1, 3)
            count += own.size // 3
            triangles.append(np.concatenate(corners, axis=1)[:, strut.triangles].reshape(-1, 3))
            normals.append(np.tile(strut.normals, (len(strut.edges), 1, 1)))
        found = np.concatenate(triangles)
        return points, found, np.concatenate(normals), (np.arange(len(found)) >= many).astype(np.int64)

    def share(self, nodes: Integers, edges: Integers) -> MeshShare:
        """The part of the mesh that has some nodes and struts."""
        links, of = self.network.edges[edges], self.kinds.of[nodes]
        needed = np.union1d(nodes, links)
        shapes = []
        for kind in np.unique(of[of >= 0]).tolist():
            corners = self.nodes[kind].points[self.nodes[kind].triangles]
            copies = np.searchsorted(needed, nodes[of == kind])[:, None]
            shapes.append((corners, np.zeros(corners.shape[:2], dtype=np.int64), copies.astype(np.int32)))
        for kind in np.unique(self._strut_kinds[edges]).tolist():
            strut = self.struts[kind]
            first, second = (self._circle(*end) for end in zip(strut.kinds, strut.slots, strict=True))
            copies = np.searchsorted(needed, links[self._strut_kinds[edges] == kind])
            owners = np.repeat([0, 1, 0], [len(first), len(second), len(strut.points)])[strut.triangles]
            corners = np.concatenate([first, second, strut.points])[strut.triangles]
            shapes.append((corners, owners, copies.astype(np.int32)))
        return MeshShare(shapes, self.network.points[needed])

    @cached_property
    def _strut_kinds(self) -> Any:
        """The number of the piece of each strut (E,)."""
        found = np.zeros(len(self.network.edges), dtype=np.int32)
        for number, strut in enumerate(self.struts):
            found[strut.edges] = number
        return found

    @cached_property
    def digest(self) -> str:
        """A name for the mesh, which another one does not have."""
        found = hashlib.sha256()
        tables: list[Any] = [self.network.places, self.network.edges, self.kinds.of, self.kinds.slots]
        for array in (*tables, *(a for node in self.nodes for a in (node.points, node.triangles))):
            found.update(array.tobytes())
        return found.hexdigest()

    @cached_property
    def volume(self) -> float:
        """The volume inside the triangles, by the divergence theorem about the network's middle."""
        middle = self.network.points.mean(axis=0)
        total = 0.0
        for kind, piece in enumerate(self.nodes):
            places = self.network.points[self.kinds.of == kind] - middle
            total += _volume(piece.points[piece.triangles], places)
        for strut in self.struts:
            first, second = (self._circle(*end) for end in zip(strut.kinds, strut.slots, strict=True))
            corners = np.concatenate([first, second + strut.vector, strut.points])[strut.triangles]
            total += _volume(corners, self.network.points[self.network.edges[strut.edges, 0]] - middle)
        return total

    def bodies(self) -> list[tuple[Floats, Integers, Floats, Integers]]:
        """Closed meshes that together make the whole: points, triangles, normals at their corners, and the numbers of
        the nodes where each is.

        A node has its struts up to the middle of what is straight of them, where they are cut off flat.
        """
        edges, kinds = self.network.edges, self.kinds
        at = np.array([kinds.ends[strut.kinds, strut.slots] for strut in self.struts])
        cuts, codes = np.unique(((1 + at - at[:, ::-1]) / 2).round(9), return_inverse=True)
        table = np.zeros((len(kinds.of), kinds.ends.shape[1]), dtype=np.int32)
        table[edges, kinds.slots] = codes.reshape(at.shape).astype(np.int32)[self._strut_kinds]
        used = np.flatnonzero(kinds.of >= 0)
        of, firsts = ranked([kinds.of[used], *table[used].T])
        made = [self._body(int(kinds.of[node]), cuts[table[node]]) for node in used[firsts]]
        return [(*body, used[of == number]) for number, body in enumerate(made)]

    def _body(self, kind: int, cuts: Floats) -> tuple[Floats, Integers, Floats]:
        piece, count = self.nodes[kind], len(self.nodes[kind].points)
        points, triangles, normals = [piece.points], [piece.triangles], [piece.normals]
        for arm, axis in enumerate(unit(self.kinds.kinds[kind].vectors)):
            rings = []
            for ring, there, found, outward, last in self.halves(kind, arm, float(cuts[arm])):
                own = count + np.arange(len(there))
                rings.append(own[-last:])
                points.append(there)
                triangles.append(np.concatenate([ring, own])[found])
                normals.append(outward)
                count += len(there)
            triangles.append(lid(np.concatenate(points), rings, axis))
            normals.append(np.broadcast_to(axis, (len(triangles[-1]), 3, 3)))
        return np.concatenate(points), np.concatenate(triangles), np.concatenate(normals)

    def halves(self, kind: int, arm: int, cut: float) -> list[tuple[Integers, Floats, Integers, Floats, int]]:
        """The strip from each ring of an arm to some part of its vector: the ring's vertices counterclockwise about the
        arm, the points of rings there, the last one at the end, the triangles over both, the normals at their corners,
        and how many points the last ring has."""
        one, piece = self.kinds.kinds[kind], self.nodes[kind]
        vector, ring = one.vectors[arm] * float(self.network.grid), piece.rings[arm]
        axis, rise = unit(vector), self._width(one, arm, 1.0) - self._width(one, arm)
        own = ring[np.argsort(angles_around(piece.points[ring], axis))]
        span = piece.points[own], np.zeros((0, 3)), cut * vector
        count, places = self._cut(span, *self._strips[:2])
        points, found, outward, _ = strip(*span, cut * rise, count, places)
        return [(own, points, found, outward, count)]


def _volume(corners: Floats, places: Floats) -> float:
    """Six-fold sums of triangles (T, 3, 3) at each place, as volumes under the origin."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    own = np.einsum("ni,ni->", a, np.cross(b, c)) / 6
    across_ = np.cross(b - a, c - a).sum(axis=0) / 6
    return float(own * len(places) + places.sum(axis=0) @ across_)
