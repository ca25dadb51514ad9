"""Marching tetrahedra with snapping, after Labelle and Shewchuk (2007).

A crossing close to a lattice node is moved to that node's own crossing point, so that the sliver
triangles of plain marching tetrahedra collapse.  The topology is that of the piecewise linear
interpolant unless snapping pinched it, which the caller checks.
"""

from __future__ import annotations

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.rows import area_vectors
from pas.mesh.topology import distinct, first_rows, numbered

KINDS = ((1, 2, 4, 8), (14, 13, 11, 7), (3,), (5,), (9,), (6,), (10,), (12,))
"""Tetrahedra by the bits of their corners on the negative side: with one there or elsewhere, and with two and two."""


def _cut(mask: int) -> list[list[tuple[int, int]]]:
    """Two triangles whose corners are on crossed edges, of which the second counts for two corners on each side."""
    inside = [k for k in range(4) if mask >> k & 1]
    outside = [k for k in range(4) if not mask >> k & 1]
    if len(inside) == len(outside) == 2:
        (a, b), (c, d) = inside, outside
        return [[(a, c), (a, d), (b, d)], [(a, c), (b, d), (b, c)]]
    (apex,), others = sorted((inside, outside), key=len)
    return 2 * [[(apex, k) for k in others]]


CUTS = np.array([_cut(mask) if 0 < mask < 15 else np.zeros((2, 3, 2), dtype=int) for mask in range(16)])
"""The ends (16, 2, 3, 2) of the edges that triangles of a tetrahedron cross, by the bits of its corners."""


def snapped(
    points: Floats, triangles: Integers, edges: Integers, t: Floats, snap: float, free: Bools
) -> tuple[Floats, Integers, Integers]:
    """The mesh with all crossings within the share `snap` of their edge from a node merged.

    Crossings do not merge at nodes that are `free` (N,).  Also the crossing (a row of `edges`, the one nearest to
    its node) that each vertex comes from.
    """
    a, b = edges[:, 0], edges[:, 1]
    group = np.arange(len(edges)) + len(free)
    group = np.where((t < snap) & ~free[a], a, np.where((t > 1 - snap) & ~free[b], b, group))
    order = np.argsort(np.minimum(t, 1 - t), kind="stable")
    found, label = numbered(group[order])
    first = first_rows(label, len(found))
    back = np.empty(len(order), dtype=np.intp)
    back[order] = label
    merged = np.zeros((len(first), 3))
    np.add.at(merged, back, points)
    merged /= np.bincount(back)[:, None]
    corners = back[triangles]
    distinct = (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])
    checkpoint()
    used, inverse = numbered(_without_doubles(corners[distinct]).ravel())
    return merged[used], inverse.reshape(-1, 3), order[first][used]


def knotted(triangles: Integers, edges: Integers, t: Floats, snap: float, count: int) -> Bools:
    """The nodes (count,) whose crossings within `snap` are no disc, so that merging them would change the topology."""
    size, number = count + 1, len(edges)  # the last one collects those that do not merge
    group = np.where(t < snap, edges[:, 0], np.where(t > 1 - snap, edges[:, 1], count))
    ends = triangles[:, [1, 2, 0]]
    same = group[triangles] == group[ends]
    low, high = np.minimum(triangles, ends)[same], np.maximum(triangles, ends)[same]
    sides = np.bincount(group[distinct(low * number + high) // max(number, 1)], minlength=size)
    insides = np.bincount(group[triangles[same[:, 0] & same[:, 1], 0]], minlength=size)
    members = np.bincount(group, minlength=size)
    return np.asarray((members - sides + insides != 1) & (members > 0))[:-1]


def crossings(negative: Bools, tets: Integers) -> tuple[Integers, Integers]:
    """The crossed edges (E, 2) as node numbers and triangles (T, 3) as edge numbers.

    `negative` (N,) says on which side each node is, `tets` (M, 4) are node numbers.
    """
    size, sides = len(negative), negative[tets] @ np.array([1, 2, 4, 8])
    triangles = []
    for masks in KINDS:
        rows = np.flatnonzero(np.isin(sides, masks))
        ends = tets[rows[:, None, None, None], CUTS[sides[rows]]]
        keys = ends.min(axis=3) * size + ends.max(axis=3)
        parts = 1 if masks in KINDS[:2] else 2
        triangles += [keys[:, part] for part in range(parts)]
    unique, inverse = numbered(np.concatenate(triangles).ravel())
    return np.stack([unique // size, unique % size], axis=1), inverse.reshape(-1, 3)


def oriented(nodes: Floats, negative: Bools, edges: Integers, points: Floats, triangles: Integers) -> Integers:
    """The triangles turned so that their normals point to the positive side.

    Before snapping, a triangle of the interpolant is normal to its gradient, which points from the negative to the
    positive ends of the edges through its corners; moving a corner along its edge does not change the side.
    """
    a, b = edges[triangles].transpose(2, 1, 0)
    ways = (nodes[b] - nodes[a]) * np.where(negative[a], 1.0, -1.0)[:, :, None]
    sides = (area_vectors(points[triangles]) * (ways[0] + ways[1] + ways[2])).sum(axis=1)
    return np.where(sides[:, None] < 0, triangles[:, [0, 2, 1]], triangles)


def _without_doubles(triangles: Integers) -> Integers:
    """Triangles that snapping folded onto one another vanish in pairs."""
    size = int(triangles.max(initial=0)) + 1
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    inverse = numbered((low * size + triangles.sum(axis=1) - low - high) * size + high)[1]
    return triangles[np.bincount(inverse)[inverse] == 1]
