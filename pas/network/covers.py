"""Tetrahedra that hold the surfaces of a network's nodes: how far nodes reach, and which surely do not meet.

Of a node these are parts of the cells of its blend, turned as it is; of the straight part of a strut its axis, a
tetrahedron without volume, from which what is farther than the strut is thick is apart.  Two nodes are apart as the
sides of a wall are (`pas.certify.thickness`), mostly by a plane across the way from one point to the other, and so are
a node and an axis; that is decided once for all pairs that are placed alike.

Guaranteed of the surfaces in the regions of their blends, with room for rounding.  What is apart by less than some
250th of a node's size may stay undecided.  Of what meets a point inside of both is looked for where tetrahedra are left
open, and decided exactly (`pas.network.overlaps`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.rational import Vector, exact, rational, vector
from pas.arrays import Floats, Integers
from pas.bernstein.forms import corner_points, nearby_forms
from pas.bernstein.search import Fate, Fates, Limits, search
from pas.bernstein.simplices import Simplices
from pas.certify.thickness import parted, slices
from pas.network.classes import Kinds, ranked, turn
from pas.network.near import Capsules
from pas.network.overlaps import NodeSolid, StrutSolid, common_point
from pas.pipeline.result import Blend
from pas.verdicts import Status

SPARE = 2.0**-6
"""Of how far the circles at its clips are: by so much more a node is taken to reach, which saves halving."""

LIMITS = Limits(depth=36, cells=8192)
"""To parts of 2^-12 of a cell's size; surfaces that cross leave more and more open."""


class Separation(NamedTuple):
    """Whether two solids are proved to be apart, or a point inside of both, about the first one's in steps, if any."""

    proved: bool
    common: Vector | None = None


class NodeCovers:
    """Tetrahedra that hold the nodes of a network: `blends` has those of its classes by key, in steps of the grid.

    Distances are in the model's units.
    """

    def __init__(self, kinds: Kinds, blends: Mapping[Any, Blend]) -> None:
        self.network, self.kinds, self.blends = kinds.network, kinds, blends
        self._known: dict[tuple[int, ...], Separation] = {}

    @cached_property
    def _first(self) -> dict[Any, Simplices]:
        """For each class with a blend tetrahedra that hold it around its first kind's point, all with forms of one
        degree."""
        found, degree = {}, max((blend.surface.degree for blend in self.blends.values()), default=1)
        step = float(self.network.grid)
        for key in self.blends.keys() & self.kinds.classes:
            surface, one = self.blends[key].surface, self.kinds.classes[key]
            cells = [surface.local.corners(cell) for cell in surface.local.cells]
            forms, error = nearby_forms([surface.patches[p].raw for p in surface.local.piece_of], cells, degree)
            corners = surface.partition.frame.global_points(corner_points(cells)) * step
            found[key] = _held(Simplices.of([forms], corners, error), float(np.linalg.norm(one.circles, axis=1).max()))
        return found

    def held(self, node: int) -> Simplices:
        """Tetrahedra that hold a node, which has a blend, around its point, turned as it is."""
        key, turned = self._turned(node)
        matrix, cells = turned.floats[0], self._first[key]
        return replace(cells, corners=cells.corners @ matrix.T)

    def _turned(self, node: int) -> tuple[Any, Affine]:
        """The key of a node's class, and how the first kind of that is turned to it."""
        kind = self.kinds.kinds[self.kinds.of[node]]
        return kind.form.key, turn(self.kinds.classes[kind.form.key].kind, kind)

    @cached_property
    def reach(self) -> Floats:
        """The radius of a ball around each point (N,) that holds its node; 0 where the node has no blend."""
        found = np.zeros(len(self.kinds.kinds) + 1)  # the last is that of points without struts
        for key, cells in self._first.items():
            found[list(self.kinds.classes[key].numbers)] = reach_of(cells) + self.network.slack
        return found[self.kinds.of]

    @cached_property
    def nodes(self) -> Capsules:
        """The nodes that have a blend, as balls."""
        used = np.flatnonzero(self.reach)
        points, reach = self.network.points[used], self.reach[used]
        share, ends = np.zeros(len(used)), np.stack([used, used], axis=1)
        return Capsules(points, points, share, reach, float(reach.max(initial=0)), ends)

    @cached_property
    def struts(self) -> Capsules:
        """The struts where they are straight."""
        return self.network.capsules(self.kinds.ends)

    def node(self, number: int, about: int) -> NodeSolid:
        """The inside of a node that has a blend, about some point."""
        (key, turned), places = self._turned(number), self.network.places
        place = replace(turned, shift=vector((places[number] - places[about]).tolist()))
        return NodeSolid(self.blends[key].surface, place)

    def strut(self, number: int, about: int) -> StrutSolid:
        """The inside of what is straight of a strut, about some point; its ends are rounded inwards."""
        network = self.network
        start = network.places[network.edges[number, 0]] - network.places[about]
        here, there = (exact(np.nextafter(end, 1.0)) for end in self.kinds.at_ends(self.kinds.arm_ends, number))
        radii = tuple(rational(network.radii[size] / network.grid) for size in network.sizes[number])
        return StrutSolid(vector(start.tolist()), vector(network.vectors[number].tolist()), (here, 1 - there), radii)

    def apart(self, nodes: Integers, others: Capsules, rows: Integers) -> list[Separation]:
        """For pairs of nodes and others, or straight parts of struts (M,): whether they are proved not to meet.

        It is decided once for all pairs of the same kinds with the same relative position.
        """
        begin, straight = others.of[rows, 0], others is self.struts
        numbers, kinds = (rows, self.kinds.struts[0][rows]) if straight else (begin, self.kinds.of[begin])
        columns = [self.kinds.of[nodes], kinds, *(self.network.places[begin] - self.network.places[nodes]).T]
        of, firsts = ranked(columns)
        alike = [(straight, *row) for row in np.stack([column[firsts] for column in columns], axis=1).tolist()]
        for row, i in zip(alike, firsts.tolist(), strict=True):
            if row not in self._known:
                self._known[row] = self._found(int(nodes[i]), int(numbers[i]), straight)
        return [self._known[alike[n]] for n in of.tolist()]

    def _found(self, node: int, other: int, straight: bool) -> Separation:
        cells, points = self.held(node), self.network.points
        solid: Any = self.node(node, node)
        if straight:
            axis = self.struts.segments([other]) - points[node]
            beside = Simplices.of([np.zeros((1, cells.table.shape[1]))], axis[:, [0, 0, 1, 1]])
            ((start, end),) = axis
            way = np.cross(end - start, np.cross(start, end))  # from the point straight to the axis
            distance, solids = float(self.network.thickness[other]), [solid, self.strut(other, node)]
        else:
            there, way, distance = self.held(other), points[other] - points[node], 0.0
            beside, solids = replace(there, corners=there.corners + way), [solid, self.node(other, node)]
        found = parted(cells, beside, distance, self.network.slack, LIMITS, np.stack([way, *np.eye(3)]))[0]
        if found.status is Status.PROVED:
            return Separation(True)
        middles = found.open.corners.mean(axis=1) / float(self.network.grid)
        return Separation(False, common_point(middles, *solids))


def _held(cells: Simplices, far: float) -> Simplices:
    """Parts of tetrahedra that hold the same zeros, if possible only as far from the origin as this, with `SPARE`."""

    def judge(some: Simplices, _: int) -> Fates:
        found, there = slices(some)
        out = np.linalg.norm(found.corners, axis=2).max(axis=1) > (1 + SPARE) * far
        return np.where(there, np.where(out, Fate.SPLIT, Fate.KEEP), Fate.SETTLED).astype(np.intp)

    found = search(cells, judge, Simplices.halved, LIMITS, "bounding how far nodes reach")
    return found.open.joined([found.kept])


def reach_of(cells: Simplices) -> float:
    """How far from the origin the zeros in tetrahedra are at most."""
    return float(np.linalg.norm(slices(cells)[0].corners, axis=2).max())
