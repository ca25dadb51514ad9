"""Meshes of hollow networks: an outer and an inner network of the same kinds, the inner one turned inside out.

Both have the same struts in the same order, so that each piece is one of both: rings have the vertices of the outer
circle and then those of the inner one, and flat ends are rings.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from pas.algebra.lengths import unit
from pas.arrays import Floats, Integers
from pas.network.placing import NodePiece, PlacedPieces, StrutPiece
from pas.network.rings import lid


class HollowPieces(PlacedPieces):
    """The pieces of what is between an `outer` and an `inner` network."""

    def __init__(self, outer: PlacedPieces, inner: PlacedPieces) -> None:
        super().__init__(outer.network, outer.kinds, outer.blends, outer.tolerance)
        self.outer, self.inner = outer, inner

    @cached_property
    def nodes(self) -> list[NodePiece]:
        """The piece of each kind."""
        made = []
        for kind, (outer, inner) in enumerate(zip(self.outer.nodes, self.inner.nodes, strict=True)):
            points, count = np.concatenate([outer.points, inner.points]), len(outer.points)
            rings = tuple(np.concatenate([a, count + b]) for a, b in zip(outer.rings, inner.rings, strict=True))
            if len(rings) == 1:  # of an end, which is flat
                axis = -unit(self.kinds.kinds[kind].vectors[0])
                triangles = lid(points, [outer.rings[0], count + inner.rings[0]], axis)
                normals = np.broadcast_to(axis, (len(triangles), 3, 3))
            else:
                triangles = np.concatenate([outer.triangles, count + inner.triangles[:, ::-1]])
                normals = np.concatenate([outer.normals, -inner.normals[:, ::-1]])
            made.append(NodePiece(points, triangles, normals, rings, max(outer.deviation, inner.deviation)))
        return made

    @cached_property
    def struts(self) -> list[StrutPiece]:
        """The piece of each kind of strut."""
        made, sides = [], (self.outer, self.inner)
        for outer, inner in zip(self.outer.struts, self.inner.struts, strict=True):
            rings = [p.nodes[k].rings[s] for k, s in zip(outer.kinds, outer.slots, strict=True) for p in sides]
            counts = [*map(len, rings), len(outer.points), len(inner.points)]
            numbers = np.split(np.arange(sum(counts)), np.cumsum(counts)[:-1])  # of both sides in turn
            own, within = (np.concatenate(numbers[side::2]) for side in (0, 1))
            points = np.concatenate([outer.points, inner.points])
            triangles = np.concatenate([own[outer.triangles], within[inner.triangles[:, ::-1]]])
            normals = np.concatenate([outer.normals, -inner.normals[:, ::-1]])
            off = max(outer.deviation, inner.deviation)
            made.append(replace(outer, points=points, triangles=triangles, normals=normals, deviation=off))
        return made

    def halves(self, kind: int, arm: int, cut: float) -> list[tuple[Integers, Floats, Integers, Floats, int]]:
        """The strips of an arm outside and inside, see `PlacedPieces.halves`."""
        ((ring, there, found, outward, last),) = self.inner.halves(kind, arm, cut)
        inside = len(self.outer.nodes[kind].points) + ring, there, found[:, ::-1], -outward[:, ::-1], last
        return [*self.outer.halves(kind, arm, cut), inside]
