"""The meshes of a network's nodes and struts in all their places: as one mesh, by blocks, and by closed bodies.

A mesh of any size is a few pieces (see `pas.network.sides`) and a place for each node.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from pas.algebra.lengths import unit
from pas.arrays import Floats, Integers, Numbers
from pas.mesh.rows import area_vectors, cross
from pas.network.classes import grouped, ranked
from pas.network.rings import flat_end
from pas.network.sides import MeshPiece, NetworkSide

AT_ONCE = 2**16
"""Triangles of a share that are made together."""


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
    """All pieces of a network's mesh: those of its outside, and of its cavity if it is hollow."""

    def __init__(self, sides: Sequence[NetworkSide]) -> None:
        self.sides, self.kinds, self.tolerance = sides, sides[0].kinds, sides[0].tolerance
        self.network = self.kinds.network

    @cached_property
    def nodes(self) -> list[MeshPiece]:
        """The piece of each kind of node: of a hollow one its outer vertices and then the inner ones."""
        outer, *cavity = (side.nodes for side in self.sides)
        return [self._walled(kind, *both) for kind, both in enumerate(zip(outer, *cavity, strict=True))]

    def _walled(self, kind: int, outer: MeshPiece, inner: MeshPiece | None = None) -> MeshPiece:
        if inner is None:
            return outer
        points, count = np.concatenate([outer.points, inner.points]), len(outer.points)
        triangles = np.concatenate([outer.triangles, count + inner.triangles[:, ::-1]])
        normals = np.concatenate([outer.normals, -inner.normals[:, ::-1]])
        if len(outer.rings) == 1:  # of an end, which is flat
            axis = -unit(self.kinds.kinds[kind].vectors[0])
            triangles = flat_end(points, [outer.rings[0], count + inner.rings[0]], axis)
            normals = np.broadcast_to(axis, (len(triangles), 3, 3))
        off, owners = max(outer.deviation, inner.deviation), np.zeros(len(points), np.int64)
        return MeshPiece(points, triangles, normals, off, outer.copies, owners)

    @property
    def struts(self) -> list[MeshPiece]:
        """The pieces of all kinds of struts."""
        return [strut for side in self.sides for strut in side.struts]

    @property
    def pieces(self) -> list[MeshPiece]:
        """All of them."""
        return [*self.nodes, *self.struts]

    @cached_property
    def deviation(self) -> float:
        """The largest distance of any triangle from the surface, as measured, rounding of places included."""
        far = float(np.abs(self.network.points).max(initial=0)) + max(np.abs(n.points).max() for n in self.nodes)
        return max(piece.deviation for piece in self.pieces) + far * 2.0**-50

    @property
    def count(self) -> int:
        """The number of triangles."""
        return sum(len(piece.triangles) * len(piece.copies) for piece in self.pieces)

    def mesh(self) -> tuple[Floats, Integers, Integers, tuple[str, ...], Floats]:
        """Points (N, 3), triangles (T, 3), their faces (T,), the names of these, and normals at corners (T, 3, 3)."""
        starts, count = np.zeros(len(self.network.points), dtype=np.int64), 0
        points, triangles, normals = [], [np.zeros((0, 3), dtype=np.int64)], [np.zeros((0, 3, 3))]
        for piece in self.pieces:
            size, copies = len(piece.shared), len(piece.copies)
            points.append((piece.points[size:] + self.network.points[piece.copies[:, :1]]).reshape(-1, 3))
            own = count + np.arange(len(points[-1])).reshape(copies, -1)
            count += own.size
            if not size:
                starts[piece.copies] = own[:, :1]
            shared = starts[piece.copies[:, piece.owners[:size]]] + piece.shared
            triangles.append(np.concatenate([shared, own], axis=1)[:, piece.triangles].reshape(-1, 3))
            normals.append(np.tile(piece.normals, (copies, 1, 1)))
        of_nodes = sum(map(len, triangles[: 1 + len(self.nodes)]))
        faces = (np.arange(sum(map(len, triangles))) >= of_nodes).astype(np.int64)
        return np.concatenate(points), np.concatenate(triangles), faces, ("nodes", "struts"), np.concatenate(normals)

    def shares(self, block: Integers, count: int) -> Iterator[MeshShare]:
        """The shares of the mesh of each of `count` blocks of nodes, given by numbers (N,), with the struts that begin
        there."""
        copies = [[piece.copies[some] for some in grouped(block[piece.copies[:, 0]], count)] for piece in self.pieces]
        shapes = [(p.points[p.triangles], p.owners[p.triangles]) for p in self.pieces]
        for mine in zip(*copies, strict=True):
            needed = np.unique(np.concatenate([some.ravel() for some in mine]))
            local = (np.searchsorted(needed, some).astype(np.int32) for some in mine)
            made = [(*shape, own) for shape, own in zip(shapes, local, strict=True) if len(own)]
            yield MeshShare(made, self.network.points[needed])

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
        total, step, middle = 0.0, float(self.network.grid), self.network.points.mean(axis=0)
        for piece in self.pieces:
            ends, places = self.network.places[piece.copies[0]], self.network.points[piece.copies[:, 0]] - middle
            corners = (piece.points + ((ends - ends[0]) * step)[piece.owners])[piece.triangles]
            a, b, c = np.moveaxis(corners, 1, 0)
            across = area_vectors(corners).sum(axis=0)
            total += float(np.einsum("ni,ni->", a, cross(b, c)) * len(places) + places.sum(axis=0) @ across) / 6
        return total

    def bodies(self) -> list[tuple[Floats, Integers, Floats, Integers]]:
        """Closed meshes that together make the whole: points, triangles, normals at their corners, and the numbers of
        the nodes where each is.

        A node has its struts up to the middle of what is straight of them, where they are cut off flat.
        """
        kinds, (of, firsts) = self.kinds, self.kinds.struts
        at = kinds.at_ends(kinds.arm_ends, firsts)
        cuts, codes = np.unique(((1 + at - at[:, ::-1]) / 2).round(9), return_inverse=True)
        table = np.zeros((len(kinds.of), kinds.arm_ends.shape[1]), dtype=np.int32)
        table[self.network.edges, kinds.slots] = codes.reshape(at.shape).astype(np.int32)[of]
        used = np.flatnonzero(kinds.of >= 0)
        same, firsts = ranked([kinds.of[used], *table[used].T])
        made = [self._body(int(kinds.of[node]), cuts[table[node]]) for node in used[firsts]]
        return [(*body, used[rows]) for body, rows in zip(made, grouped(same, len(made)), strict=True)]

    def _body(self, kind: int, cuts: Floats) -> tuple[Floats, Integers, Floats]:
        piece, count = self.nodes[kind], len(self.nodes[kind].points)
        points, triangles, normals = [piece.points], [piece.triangles], [piece.normals]
        for arm, axis in enumerate(unit(self.kinds.kinds[kind].vectors)):
            rings = []
            for side in self.sides:
                ring, there, found, outward, last = side.half(kind, arm, float(cuts[arm]))
                own = count + np.arange(len(there))
                rings.append(own[-last:])
                points.append(there)
                triangles.append(np.concatenate([ring, own])[found])
                normals.append(outward)
                count += len(there)
            triangles.append(flat_end(np.concatenate(points), rings, axis))
            normals.append(np.broadcast_to(axis, (len(triangles[-1]), 3, 3)))
        return np.concatenate(points), np.concatenate(triangles), np.concatenate(normals)
