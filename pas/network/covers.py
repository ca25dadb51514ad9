"""Tetrahedra that hold the surfaces of a network's nodes: how far nodes reach, and which surely do not meet.

Of a node these are parts of the cells of its blend, turned as it is; of the straight part of a strut its axis, a
tetrahedron without volume, from which what is farther than the strut is thick is apart.  Two nodes are apart by a plane
across the way from one point to the other, or as the sides of a wall are (`pas.certify.thickness`), and so are a node
and an axis; that is decided once for all pairs that are placed alike.

Guaranteed of the surfaces in the regions of their blends, with room for rounding.  What is apart by less than some
250th of a node's size may stay undecided.  Of what meets a point inside of both is looked for where tetrahedra are left
open, and decided exactly (`pas.network.overlaps`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.lengths import unit
from pas.algebra.rational import Vector, exact, rational, to_floats, vector
from pas.arrays import Floats, Integers
from pas.bernstein.forms import corner_points, nearby_forms
from pas.bernstein.search import Fate, Fates, Limits, search
from pas.bernstein.simplices import Simplices
from pas.certify.thickness import parted, slices
from pas.network.classes import Kinds, ranked, turn
from pas.network.overlaps import NodeSolid, StrutSolid, common_point
from pas.pipeline.result import Blend
from pas.verdicts import Status

SPARE = 2.0**-6
"""Of how far the circles at its clips are: by so much more a node is taken to reach, which saves halving."""

LIMITS = Limits(depth=36, cells=8192)
"""To parts of 2^-12 of a cell's size; surfaces that cross leave more and more open."""


Found = Vector | bool
"""True where things are proved to be apart, a point inside of both, about the first one's in steps, or False."""


class NodeCovers:
    """What holds the nodes of a network: `blends` has those of its classes by their keys, in steps of the grid.

    Distances are in the model's units.
    """

    def __init__(self, kinds: Kinds, blends: Mapping[Any, Blend]) -> None:
        self.network, self.kinds, self.blends = kinds.network, kinds, blends
        self._known: dict[tuple[int, ...], Found] = {}

    @cached_property
    def _first(self) -> dict[Any, tuple[Simplices, Floats]]:
        """Of each class with a blend tetrahedra that hold it around its first kind's point, all with forms of one
        degree, and points (M, 3) whose convex hull does."""
        found, degree = {}, max((blend.surface.degree for blend in self.blends.values()), default=1)
        radii, step = np.array([float(radius) for radius in self.network.radii]), float(self.network.grid)
        for key in self.blends.keys() & self.kinds.classes:
            surface, one = self.blends[key].surface, self.kinds.classes[key]
            cells = [surface.local.corners(cell) for cell in surface.local.cells]
            forms, error = nearby_forms([surface.patches[p].raw for p in surface.local.piece_of], cells, degree)
            corners = surface.partition.frame.global_points(corner_points(cells)) * step
            ends, vectors = np.array(one.ends)[:, None], one.kind.vectors * step
            sizes, units = radii[np.array([arm[1:3] for arm in one.kind.arms])], np.asarray(unit(vectors))
            widths = sizes[:, :1] + ends * (sizes[:, 1:] - sizes[:, :1])
            sines = np.sqrt(np.maximum(1 - (units @ units.T) ** 2, 0))
            along = (ends * vectors @ units.T + widths * sines).max(axis=0)
            far = float(np.hypot(ends[:, 0] * np.linalg.norm(vectors, axis=1), widths[:, 0]).max())
            found[key] = _held(Simplices.of([forms], corners, error), units / along[:, None], far)
        return found

    def held(self, node: int) -> tuple[Simplices, Floats] | None:
        """Tetrahedra and points that hold a node around its point, turned as it is; None without a blend."""
        kind = self.kinds.kinds[self.kinds.of[node]]
        if kind.form.key not in self._first:
            return None
        first, (cells, hull) = self.kinds.classes[kind.form.key].kind, self._first[kind.form.key]
        matrix = np.array([to_floats(row) for row in turn(first, kind)]).T
        return replace(cells, corners=cells.corners @ matrix), hull @ matrix

    @cached_property
    def reach(self) -> Floats:
        """The radius of a ball around each point (N,) that holds its node; 0 where the node has no blend."""
        found = np.zeros(len(self.kinds.kinds))
        for key, (_, hull) in self._first.items():
            found[list(self.kinds.classes[key].numbers)] = np.linalg.norm(hull, axis=1).max() + self.network.slack
        return np.where(self.kinds.of >= 0, found[self.kinds.of], 0.0)

    @cached_property
    def ends(self) -> Floats:
        """Where each strut begins and ends (E, 2), in parts of its length."""
        return self.kinds.ends

    def axes(self, struts: Any) -> Floats:
        """The axes (M, 2, 3) of some struts where these are straight."""
        first, second = (self.network.points[self.network.edges[struts, end]] for end in (0, 1))
        here, there = (self.ends[struts, end, None] for end in (0, 1))
        return np.stack([first + here * (second - first), second - there * (second - first)], axis=1)

    def node(self, number: int, about: int) -> NodeSolid:
        """The inside of a node that has a blend, about some point."""
        kind, places = self.kinds.kinds[self.kinds.of[number]], self.network.places
        first = self.kinds.classes[kind.form.key].kind
        place = Affine(turn(first, kind), vector((places[number] - places[about]).tolist()))
        return NodeSolid(self.blends[kind.form.key].surface, place)

    def strut(self, number: int, about: int) -> StrutSolid:
        """The inside of what is straight of a strut, about some point; its ends are rounded inwards."""
        network = self.network
        start = network.places[network.edges[number, 0]] - network.places[about]
        here, there = (exact(np.nextafter(end, 1.0)) for end in self.ends[number])
        radii = tuple(rational(network.radii[size] / network.grid) for size in network.sizes[number])
        return StrutSolid(vector(start.tolist()), vector(network.vectors[number].tolist()), (here, 1 - there), radii)

    def nodes_apart(self, first: Integers, second: Integers) -> list[Found]:
        """What is found of pairs of nodes (M,): whether their surfaces do not meet."""
        places, of = self.network.places, self.kinds.of

        def prove(i: int) -> Found:
            one, other = self.held(first[i]), self.held(second[i])
            if one is None or other is None:
                return False
            way = self.network.points[second[i]] - self.network.points[first[i]]
            between = (other[1] @ way).min() + way @ way - (one[1] @ way).max()
            if between > self.network.slack * np.linalg.norm(way):  # by a plane across the way from one to the other
                return True
            solids = self.node(first[i], first[i]), self.node(second[i], first[i])
            return self._parted(one[0], replace(other[0], corners=other[0].corners + way), 0.0, way, *solids)

        return self._each([of[first], of[second], *(places[second] - places[first]).T], prove)

    def struts_apart(self, nodes: Integers, struts: Integers) -> list[Found]:
        """What is found of nodes and struts (M,): whether they do not meet, where the struts are straight."""
        network, of = self.network, self.kinds.of
        links = network.edges[struts]
        ways = network.places[links] - network.places[nodes][:, None]
        columns = [of[nodes], *ways.reshape(-1, 6).T, *of[links].T, *self.kinds.slots[struts].T]

        def prove(i: int) -> Found:
            if (held := self.held(nodes[i])) is None:
                return False
            cells, _ = held
            axis = self.axes(struts[i : i + 1]) - network.points[nodes[i]]
            segment = Simplices.of([np.zeros((1, cells.table.shape[1]))], axis[:, [0, 0, 1, 1]])
            ((start, end),) = axis
            way = np.cross(end - start, np.cross(start, end))  # from the point straight to the axis
            solids = self.node(nodes[i], nodes[i]), self.strut(struts[i], nodes[i])
            return self._parted(cells, segment, float(network.thickness[struts[i]]), way, *solids)

        return self._each(columns, prove)

    def _each(self, columns: Any, prove: Callable[[int], Found]) -> list[Found]:
        """What is found of each row of some columns, once of equal ones."""
        of, firsts = ranked(columns)
        rows = list(zip(*(column[firsts].tolist() for column in columns), strict=True))
        for row, i in zip(rows, firsts.tolist(), strict=True):
            if row not in self._known:
                self._known[row] = prove(i)
        return [self._known[rows[n]] for n in of.tolist()]

    def _parted(self, one: Simplices, other: Simplices, distance: float, way: Floats, *solids: Any) -> Found:
        ways = np.stack([way, *np.eye(3)])
        found = parted(one, other, distance, self.network.slack, LIMITS, ways)[0]
        if found.status is Status.PROVED:
            return True
        return common_point(found.open.corners.mean(axis=1) / float(self.network.grid), *solids) or False


def _held(cells: Simplices, ways: Floats, far: float) -> tuple[Simplices, Floats]:
    """Parts of tetrahedra that hold the same zeros, and points (M, 3) whose convex hull does.

    If possible they are as far from the origin as this, and along some ways (M, 3) as far as 1, with `SPARE`.
    """
    most, hull = 1 + SPARE, list[Floats]()

    def judge(some: Simplices, _: int) -> Fates:
        found, there = slices(some)
        out = np.linalg.norm(found.corners, axis=2).max(axis=1) > most * far
        out |= ((found.corners @ ways.T) > most).any(axis=(1, 2))
        hull.append(found.corners[there & ~out].reshape(-1, 3))
        return np.where(there, np.where(out, Fate.SPLIT, Fate.KEEP), Fate.SETTLED).astype(np.intp)

    found = search(cells, judge, Simplices.halved, LIMITS, "bounding how far nodes reach")
    hull.append(slices(found.open)[0].corners.reshape(-1, 3))
    return found.open.joined([found.kept]), np.concatenate(hull)
