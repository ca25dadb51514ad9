"""Collapsing short edges of a mesh with a boundary, so that its topology stays, many at once.

Only edges go that meet the link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999), leave no edge too long and turn
no triangle away from the surface's normals.  Of edges chosen together no end is next to an end of another.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from pas.mesh.field import Floats, Integers
from pas.mesh.kernels import compiled
from pas.mesh.radial import TURNED, Edges, upright
from pas.mesh.rows import dots

SHORT = 0.7
"""Edges this many times as long as they should be are collapsed."""

LONGER = 1.3
"""No edge is made longer than so many times as long as it should be."""


ROUNDS = 4
"""In which collapses are chosen that do not touch those chosen before."""


def collapsed(
    points: Floats, edges: Edges, normals: Floats, rim: Integers, fixed: np.ndarray, sizes: Floats
) -> tuple[Integers, Integers]:
    """The vertices (M,) that are left, and the triangles of them, after one pass.

    Edges should be as long as `sizes` (N,) say.  Vertices of the boundary (`rim` >= 0) go only along it, the `fixed`
    (N,) stay.
    """
    triangles = edges.triangles
    kernel = compiled()
    if kernel is None:
        target = _target(points, edges, normals, rim, fixed, sizes)
    else:
        limits, every = (SHORT, LONGER, TURNED, ROUNDS), (edges.every, len(edges.inner))
        target = kernel.collapsed(points, triangles, normals, sizes, every, rim, fixed, limits)
    triangles = target[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    left = np.zeros(len(points), dtype=bool)
    left[triangles] = True
    return np.flatnonzero(left), (np.cumsum(left) - 1)[triangles]


def _target(points: Floats, edges: Edges, normals: Floats, rim: Integers, fixed: np.ndarray, sizes: Floats) -> Integers:
    """Into which vertex each goes (N,), itself where it stays."""
    size, every = len(points), edges.every
    ratio = _ratio(points, sizes, every[:, 0], every[:, 1])
    order = np.argsort(ratio, kind="stable")
    order = order[ratio[order] < SHORT]
    on_rim = order >= len(edges.inner)
    removed, kept = _directed(every[order], on_rim, rim, fixed)
    may = removed >= 0
    removed, kept, common = removed[may], kept[may], np.where(on_rim[may], 1, 2)
    around = _Around(points, edges.triangles, normals, sizes, every)
    target, blocked = np.arange(size), np.zeros(size, dtype=bool)
    for _ in range(ROUNDS):
        alone = _apart(every, removed, kept, size)
        good = np.flatnonzero(alone)
        good = good[around.sound(removed[good], kept[good], common[good])]
        target[removed[good]] = kept[good]
        blocked[removed[good]] = blocked[kept[good]] = True
        near = blocked.copy()
        near[every[blocked[every[:, 0]], 1]] = near[every[blocked[every[:, 1]], 0]] = True
        left = ~alone & ~near[removed] & ~near[kept]
        removed, kept, common = removed[left], kept[left], common[left]
        if not len(removed):
            break
    return target


def _ratio(points: Floats, sizes: Floats, a: Integers, b: Integers) -> Floats:
    way = points[b] - points[a]
    return np.asarray(2 * np.sqrt(dots(way, way)) / (sizes[a] + sizes[b]))


def _directed(edges: Integers, on_rim: np.ndarray, rim: Integers, fixed: np.ndarray) -> tuple[Integers, Integers]:
    """Which end of edges (E, 2) goes and which stays (-1 where neither may go)."""
    a, b = edges.T
    free_a, free_b = ((rim[v] < 0) | (on_rim & ~fixed[v]) for v in (a, b))
    removed = np.where(free_b, b, np.where(free_a, a, -1))
    return removed, np.where(free_b, a, b)


class _Around:
    """The vertices and triangles around each vertex of a mesh."""

    def __init__(self, points: Floats, triangles: Integers, normals: Floats, sizes: Floats, edges: Integers) -> None:
        size = len(points)
        self.points, self.triangles, self.normals, self.sizes = points, triangles, normals, sizes
        next_to = csr_array((np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), shape=(size, size))
        self._next_to = (next_to + next_to.T).tocsr()
        self._order = np.argsort(triangles.ravel(), kind="stable")
        self._counts = np.bincount(triangles.ravel(), minlength=size)
        self._starts = np.cumsum(self._counts) - self._counts

    def sound(self, removed: Integers, kept: Integers, common: Integers) -> np.ndarray:
        """Which collapses (C,) keep the topology, the sides of triangles, and edges from being too long.

        `common` (C,) is the number of vertices that the two ends of the edge may have next to both.
        """
        if not len(removed):
            return np.zeros(0, dtype=bool)
        shared = self._next_to[removed].multiply(self._next_to[kept]).sum(axis=1)
        counts = self._counts[removed]
        last = (counts == 2 * common - 1) & (self._counts[kept] == counts)  # a tetrahedron, or a triangle, by itself
        good = np.asarray(np.asarray(shared).ravel() == common) & ~last
        row = np.repeat(np.arange(len(removed)), counts)
        slot = np.arange(len(row)) + np.repeat(self._starts[removed] - (np.cumsum(counts) - counts), counts)
        old = self.triangles[self._order[slot] // 3]
        stays = ~(old == kept[row][:, None]).any(axis=1)
        row, old = row[stays], old[stays]
        goes = old == removed[row][:, None]
        new = np.where(goes, kept[row][:, None], old)
        least = np.minimum(upright(self.points, old, self.normals), TURNED)
        good[row[upright(self.points, new, self.normals) < least]] = False
        for i in range(3):
            long = _ratio(self.points, self.sizes, old[:, i], kept[row]) > LONGER
            good[row[long & ~goes[:, i]]] = False
        return good


def _apart(edges: Integers, removed: Integers, kept: Integers, size: int) -> np.ndarray:
    """Of collapses in order of preference, those before all others with an end at or next to an end of theirs."""
    rank = np.arange(len(removed))
    first = np.full(size, len(removed))
    np.minimum.at(first, removed, rank)
    np.minimum.at(first, kept, rank)
    near = first.copy()
    np.minimum.at(near, edges[:, 0], first[edges[:, 1]])
    np.minimum.at(near, edges[:, 1], first[edges[:, 0]])
    return np.asarray((near[removed] == rank) & (near[kept] == rank))
