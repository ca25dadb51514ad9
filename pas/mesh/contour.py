"""Marching tetrahedra with snapping, after Labelle and Shewchuk (2007).

A crossing close to a lattice node is moved to that node's own crossing point, so that the sliver
triangles of plain marching tetrahedra collapse.  The topology is that of the piecewise linear
interpolant unless snapping pinched it, which the caller checks.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pas.kernels.library import compiled
from pas.limits import checkpoint
from pas.mesh.rows import Floats, Integers
from pas.mesh.topology import distinct, numbered


def snapped(
    points: Floats, triangles: Integers, edges: Integers, t: Floats, snap: float, free: NDArray[np.bool_]
) -> tuple[Floats, Integers, Integers]:
    """The mesh with all crossings within the share `snap` of their edge from a node merged.

    Crossings do not merge at nodes that are `free` (N,).  Also the crossing (a row of `edges`, the one nearest to
    its node) that each vertex comes from.
    """
    a, b = edges[:, 0], edges[:, 1]
    group = np.arange(len(edges)) + len(free)
    group = np.where((t < snap) & ~free[a], a, np.where((t > 1 - snap) & ~free[b], b, group))
    order = np.argsort(np.minimum(t, 1 - t), kind="stable")
    label = numbered(group[order])[1]
    first = np.empty(label.max(initial=-1) + 1, dtype=np.intp)
    first[label[::-1]] = np.arange(len(label))[::-1]  # the last to be written is the first there is
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


def knotted(triangles: Integers, edges: Integers, t: Floats, snap: float, count: int) -> NDArray[np.bool_]:
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


def crossings(negative: NDArray[np.bool_], tets: Integers) -> tuple[Integers, Integers]:
    """The crossed edges (E, 2) as node numbers and triangles (T, 3) as edge numbers.

    `negative` (N,) says on which side each node is, `tets` (M, 4) are node numbers.
    """
    size, number = len(negative), np.empty(1, dtype=np.intp)
    keys = np.empty(6 * len(tets), dtype=np.intp)
    compiled().call("pas_crossings", len(tets), tets, size, negative, keys, number)
    unique, inverse = numbered(keys[: 3 * number[0]])
    return np.stack([unique // size, unique % size], axis=1), inverse.reshape(-1, 3)


def oriented(
    nodes: Floats, negative: NDArray[np.bool_], edges: Integers, points: Floats, triangles: Integers
) -> Integers:
    """The triangles turned so that their normals point to the positive side.

    Before snapping, a triangle of the interpolant is normal to its gradient, which points from the
    negative to the positive ends of the edges through its corners; moving a corner along its edge
    does not change the side.
    """
    result = triangles.copy()
    compiled().call("pas_oriented", len(result), result, points, edges, nodes, negative)
    return result


def _without_doubles(triangles: Integers) -> Integers:
    """Triangles that snapping folded onto one another vanish in pairs."""
    size = int(triangles.max(initial=0)) + 1
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    inverse = numbered((low * size + triangles.sum(axis=1) - low - high) * size + high)[1]
    return triangles[np.bincount(inverse)[inverse] == 1]
