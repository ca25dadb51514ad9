"""Collapsing short edges of a mesh with a boundary, so that its topology stays, many at once.

Only edges go that meet the link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999), leave no edge too long and turn
no triangle away from the surface's normals.  Of edges chosen together no end is next to an end of another.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from pas.mesh.field import Floats, Integers
from pas.mesh.radial import TURNED, Edges, upright

SHORT = 0.7
"""Edges this many times as long as they should be are collapsed."""

LONGER = 1.3
"""No edge is made longer than so many times as long as it should be."""


def collapsed(
    points: Floats, triangles: Integers, normals: Floats, rim: Integers, fixed: np.ndarray, sizes: Floats
) -> tuple[Integers, Integers]:
    """The vertices (M,) that are left, and the triangles of them, after one pass.

    Edges should be as long as `sizes` (N,) say.  Vertices of the boundary (`rim` >= 0) go only along it, the `fixed`
    (N,) stay.
    """
    size = len(points)
    edges = Edges(triangles, size)
    every = edges.every
    ratio = _ratio(points, sizes, every[:, 0], every[:, 1])
    order = np.argsort(ratio, kind="stable")
    order = order[ratio[order] < SHORT]
    removed, kept = _directed(every, order >= len(edges.inner), order, rim, fixed)
    may = removed >= 0
    order, removed, kept = order[may], removed[may], kept[may]
    good = _sound(points, triangles, normals, sizes, edges, order, removed, kept)
    removed, kept = removed[good], kept[good]
    alone = _apart(every, removed, kept, size)
    target = np.arange(size)
    target[removed[alone]] = kept[alone]
    triangles = target[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    left = np.unique(triangles)
    number = np.empty(size, dtype=np.intp)
    number[left] = np.arange(len(left))
    return left, number[triangles]


def _ratio(points: Floats, sizes: Floats, a: Integers, b: Integers) -> Floats:
    way = points[b] - points[a]
    return np.asarray(2 * np.sqrt(np.einsum("ni,ni->n", way, way)) / (sizes[a] + sizes[b]))


def _directed(
    edges: Integers, on_rim: np.ndarray, rows: Integers, rim: Integers, fixed: np.ndarray
) -> tuple[Integers, Integers]:
    """Which end of the edges in given rows goes and which stays (-1 where neither may go)."""
    a, b = edges[rows].T
    free_a, free_b = ((rim[v] < 0) | (on_rim & ~fixed[v]) for v in (a, b))
    removed = np.where(free_b, b, np.where(free_a, a, -1))
    return removed, np.where(free_b, a, b)


def _sound(
    points: Floats,
    triangles: Integers,
    normals: Floats,
    sizes: Floats,
    edges: Edges,
    rows: Integers,
    removed: Integers,
    kept: Integers,
) -> np.ndarray:
    """Which collapses (C,) keep the topology, the sides of triangles, and edges from being too long."""
    size, every = len(points), edges.every
    next_to = csr_array((np.ones(len(every), dtype=np.int8), (every[:, 0], every[:, 1])), shape=(size, size))
    next_to = (next_to + next_to.T).tocsr()
    common = np.asarray(next_to[removed].multiply(next_to[kept]).sum(axis=1)).ravel()
    good = np.asarray(common == np.where(rows < len(edges.inner), 2, 1))
    around = np.argsort(triangles.ravel(), kind="stable")
    counts = np.bincount(triangles.ravel(), minlength=size)
    ends = np.cumsum(counts)
    row = np.repeat(np.arange(len(removed)), counts[removed])
    first = np.cumsum(counts[removed]) - counts[removed]
    slot = np.arange(len(row)) + np.repeat(ends[removed] - counts[removed] - first, counts[removed])
    triangle = around[slot] // 3
    old = triangles[triangle]
    stays = ~(old == kept[row][:, None]).any(axis=1)
    row, old = row[stays], old[stays]
    goes = old == removed[row][:, None]
    new = np.where(goes, kept[row][:, None], old)
    least = np.minimum(upright(points, old, normals), TURNED)
    good[row[upright(points, new, normals) < least]] = False
    for i in range(3):
        other = old[:, i]
        long = ~goes[:, i] & (_ratio(points, sizes, other, kept[row]) > LONGER)
        good[row[long]] = False
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
