"""The pieces of a network's mesh, of its outside or of its cavity: one for each kind of nodes and of struts.

The blend of a class is meshed once, and turned into each kind by its exact rotation or reflection; each kind of strut
has one strip of triangles between two rings.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import acos, ceil, cos, pi
from typing import Any

import numpy as np

from pas.algebra.lengths import unit
from pas.arrays import Floats, Integers, Numbers
from pas.errors import MeshError
from pas.network.classes import Kinds, NodeClass, NodeKind, grouped, turn
from pas.network.rings import FEWEST, Span, angles_around, circle, flat_end, places_of, rings_of, strip
from pas.pipeline.result import Blend

FEW = 1 / 4
"""Of the triangles of nodes: so many more are laid on struts, at most, for the sake of their angles."""


@dataclass(frozen=True, eq=False)
class MeshPiece:
    """Triangles with normals at their corners that are in many places, in the model's units.

    `copies` (M, 1) are nodes, (M, 2) those at both ends of struts; `owners` (P,) says about which of these each of the
    `points` (P, 3) is.  A strut's first points are `shared`: vertices of these numbers of the pieces of its nodes.
    `rings` are the vertices on the circle of each arm of a node.  `deviation` is the largest distance from the surface,
    as measured.
    """

    points: Floats
    triangles: Integers
    normals: Floats
    deviation: float
    copies: Numbers
    owners: Integers
    shared: Integers = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    rings: tuple[Integers, ...] = ()


class NetworkSide:
    """The pieces of the outside within a tolerance (the model's units), or those of the cavity in an `outer` side.

    Those of struts of a cavity are turned inside out, and share vertices that come after those of the outer nodes.
    """

    def __init__(
        self, kinds: Kinds, blends: Mapping[Any, Blend], tolerance: float, outer: NetworkSide | None = None
    ) -> None:
        self.kinds, self.blends, self.tolerance, self.outer = kinds, blends, tolerance, outer
        self.step = float(kinds.network.grid)

    @cached_property
    def nodes(self) -> list[MeshPiece]:
        """The piece of each kind of nodes."""
        found = dict[int, MeshPiece]()
        for key, one in self.kinds.classes.items():
            try:
                made = self._node(one, self.blends.get(key))
            except MeshError as error:
                raise MeshError(f"the node {one.nodes[0]}, in steps of the grid: {error}") from None
            for number in one.numbers:
                kind = self.kinds.kinds[number]
                matrix, _ = turn(one.kind, kind).floats
                arms = dict(zip(kind.form.order, one.kind.form.order, strict=True))
                way = -1 if np.linalg.det(matrix) < 0 else 1  # a reflection turns the order of corners around
                found[number] = replace(
                    made,
                    points=made.points @ matrix.T,
                    triangles=made.triangles[:, ::way],
                    normals=(made.normals @ matrix.T)[:, ::way],
                    copies=self.kinds.nodes[number][:, None],
                    rings=tuple(made.rings[arms[i]] for i in range(len(arms))),
                )
        return [found[number] for number in range(len(found))]

    def _node(self, one: NodeClass, blend: Blend | None) -> MeshPiece:
        """The piece of the first kind of a class: of its blend, or a ring where a strut goes straight on or ends."""
        kind, copies = one.kind, one.nodes[:, None]
        if blend is not None:
            mesh = blend.surface.mesh(self.tolerance / self.step)
            rings = rings_of(mesh.points, mesh.boundary, unit(kind.vectors), one.circles / self.step)
            off = float("inf") if mesh.deviation is None else mesh.deviation * self.step
            known = mesh.points * self.step, mesh.triangles, mesh.normals, off
            return MeshPiece(*known, copies, np.zeros(len(mesh.points), np.int64), rings=rings)
        (radius, _), axis = self._radii(kind, 0), unit(kind.vectors[0])
        points = radius * circle(axis, count := self._fewest(radius))
        ring = np.arange(count)
        fan = flat_end(points, [ring], axis)[:, ::-1] if len(kind.arms) == 1 else np.zeros((0, 3), np.int64)
        normals = np.broadcast_to(-axis, (len(fan), 3, 3))
        return MeshPiece(points, fan, normals, 0.0, copies, 0 * ring, rings=(ring,) * len(kind.arms))

    def _radii(self, kind: NodeKind, arm: int) -> tuple[float, float]:
        """The radii of an arm here and at its other end."""
        here, there = (float(self.kinds.network.radii[size]) for size in kind.arms[arm][1:3])
        return here, there

    @cached_property
    def _arms(self) -> Any:
        """For each kind of strut the kinds of its nodes and its arms there: [[kind, arm], [kind, arm]]."""
        firsts = self.kinds.struts[1]
        at = self.kinds.of[self.kinds.network.edges[firsts]], self.kinds.slots[firsts]
        return np.stack(at, axis=2).tolist()

    @cached_property
    def _spans(self) -> list[Span]:
        """The rings at both ends of each kind of strut, and its vector."""
        vectors = self.kinds.network.vectors[self.kinds.struts[1]] * self.step
        rings = ([self.nodes[kind].points[self.nodes[kind].rings[arm]] for kind, arm in arms] for arms in self._arms)
        return [(first, second, vector) for (first, second), vector in zip(rings, vectors, strict=True)]

    @cached_property
    def _finest(self) -> tuple[bool, float]:
        """How struts are cut, so that all rings together add few triangles.

        Rings are as round as those of nodes if these are few, else as the tolerance asks, and then all struts are cut
        whose rings take fewer triangles than a bound.
        """
        few = FEW * sum(len(node.triangles) * len(node.copies) for node in self.nodes)
        for coarse in (False, True):
            costs = np.array([2.0 * n * len(places) for n, places in (self._cut(span, coarse) for span in self._spans)])
            cheapest = np.argsort(costs)
            sums = np.cumsum((costs * np.bincount(self.kinds.struts[0]))[cheapest])
            bound = float(costs[cheapest][sums > few].min(initial=np.inf))
            if bound == np.inf:
                break
        return coarse, bound

    @cached_property
    def struts(self) -> list[MeshPiece]:
        """The piece of each kind of strut."""
        found, network, (of, firsts) = [], self.kinds.network, self.kinds.struts
        for arms, span, numbers in zip(self._arms, self._spans, grouped(of, len(firsts)), strict=True):
            kind, arm = arms[0]
            (here, there), cut = self._radii(self.kinds.kinds[kind], arm), self._cut(span, *self._finest)
            points, triangles, normals, widest = strip(*span, there - here, *cut)
            off = float(network.thickness[numbers[0]]) * (1 - cos(widest / 2))
            owners = np.repeat([0, 1, 0], [*map(len, span[:2]), len(points)])
            shared = np.concatenate([self.vertices(*arm) for arm in arms])
            known = np.concatenate([*span[:2], points]), *self._faced(triangles, normals), off
            found.append(MeshPiece(*known, network.edges[numbers], owners, shared))
        return found

    def vertices(self, kind: int, arm: int) -> Integers:
        """The vertices on the circle of an arm, after those of the outer node."""
        return self.nodes[kind].rings[arm] + (len(self.outer.nodes[kind].points) if self.outer else 0)

    def _faced(self, triangles: Integers, normals: Floats) -> tuple[Integers, Floats]:
        """Triangles and normals, turned inside out in a cavity."""
        return (triangles[:, ::-1], -normals[:, ::-1]) if self.outer else (triangles, normals)

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

    def half(self, number: int, arm: int, cut: float) -> tuple[Integers, Floats, Integers, Floats, int]:
        """The strip from the ring of an arm to some part of its vector: the ring's vertices counterclockwise about the
        arm, the points of rings there, the last one at the end, the triangles over both, the normals at their corners,
        and how many points the last ring has."""
        kind, points, ring = self.kinds.kinds[number], self.nodes[number].points, self.nodes[number].rings[arm]
        vector = kind.vectors[arm] * self.step
        order = np.argsort(angles_around(points[ring], unit(vector)))
        span = points[ring[order]], np.zeros((0, 3)), cut * vector
        (here, there), (count, places) = self._radii(kind, arm), self._cut(span, *self._finest)
        own, triangles, normals, _ = strip(*span, cut * (there - here), count, places)
        return self.vertices(number, arm)[order], own, *self._faced(triangles, normals), count
