"""Collapsing edges of a closed mesh whose triangles carry labels, so that its topology stays.

Only edges go that meet the link condition (Dey et al. 1999) and keep every triangle on its side of the
face, many at once where they do not touch.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from pas.limits import checkpoint
from pas.mesh.field import FaceField, Floats, Integers
from pas.mesh.improve import cross
from pas.mesh.labelled import Labelled, Topology
from pas.mesh.remesh import cosines, flip, pair_normals, sags, smooth

KEPT = 0.35
"""Cosine between a triangle's new normal and its face's, below which a collapse is refused."""

HELD, SLENDER = 0.8, 0.025
"""The same where edges may become long; and height over the longest side of the slenderest triangles made there."""

UNTANGLINGS, MANY = 8, 0.01
"""How often folded triangles are removed, and their share above which that is hopeless."""

ROUNDS = 6
"""In which collapses are chosen that do not touch."""


def collapse(
    mesh: Labelled,
    field: FaceField,
    short: Callable[[Labelled, Integers], NDArray[np.bool_]],
    passes: int = 4,
    most: Callable[[Labelled], Floats] | None = None,
) -> Labelled:
    """Edges for which `short(mesh, edges)` holds are collapsed, the shortest first.

    `most(mesh)` says how far (N,) the edges may be from their faces and curves that take the place of those of a
    vertex that goes.
    """
    for _ in range(passes):
        checkpoint()
        smaller = _collapse_once(mesh, field, short, most)
        if smaller is None:
            break
        mesh = smaller
    return mesh


def _collapse_once(
    mesh: Labelled,
    field: FaceField,
    short: Callable[[Labelled, Integers], NDArray[np.bool_]],
    most: Callable[[Labelled], Floats] | None,
) -> Labelled | None:
    edges = mesh.topology.edges
    chosen = np.flatnonzero(short(mesh, edges))
    chosen = chosen[np.argsort(mesh.lengths[chosen], kind="stable")]
    removed, kept = _directed(mesh.topology, chosen)
    if most is not None and len(removed):
        straight = _off_chords(mesh, removed, kept) <= most(mesh)[removed]
        removed, kept = removed[straight], kept[straight]
    if not len(removed):
        return None
    size, normals = len(mesh.points), pair_normals(mesh, field)
    free = _independent(mesh, normals, removed, kept, None if most is None else most(mesh))
    removed, kept = removed[free], kept[free]
    if not len(removed):
        return None
    target = np.arange(size)
    target[removed] = kept
    triangles = target[mesh.triangles]
    distinct = (
        (triangles[:, 0] != triangles[:, 1])
        & (triangles[:, 1] != triangles[:, 2])
        & (triangles[:, 2] != triangles[:, 0])
    )
    stays = np.zeros(size, dtype=bool)
    stays[triangles[distinct]] = True
    used, number = np.flatnonzero(stays), np.cumsum(stays) - 1
    topology = Topology(number[triangles[distinct]], mesh.labels[distinct], len(used))
    return Labelled(
        mesh.points[used], topology, normals[mesh.topology.rows(used[topology.pairs[:, 0]], topology.pairs[:, 1])]
    )


def _directed(topology: Topology, rows: Integers) -> tuple[Integers, Integers]:
    """Which ends (K,) of the edges in given rows may go, edge by edge, and to which others (K,).

    A vertex inside a face may go anywhere; one on a curve only along it; a corner stays.
    """
    edges, is_seam = topology.edges[rows], topology.seam_mask[rows]
    may = (topology.label_count[edges] == 1) | (is_seam[:, None] & ~topology.fixed[edges])
    return edges[may], edges[:, ::-1][may]


def untangle(mesh: Labelled, field: FaceField, fold: float, near: NDArray[np.bool_] | None = None) -> Labelled:
    """The mesh without folded triangles, as far as collapsing their edges and smoothing removes them.

    Where many are folded the mesh is left as it is: it is too coarse.  With `near` (N,), only where some are at these
    vertices.
    """
    if near is not None and (cosines(mesh, field, np.flatnonzero(near[mesh.triangles].any(axis=1))) >= fold).all():
        return mesh
    for _ in range(UNTANGLINGS):
        folded = cosines(mesh, field) < fold
        if not folded.any() or folded.sum() > MANY * len(folded):
            break
        marked = np.zeros(mesh.topology.size, dtype=bool)
        marked[mesh.triangles[folded]] = True

        def short(m: Labelled, edges: Integers, marked: NDArray[np.bool_] = marked) -> NDArray[np.bool_]:
            return np.asarray(marked[edges].any(axis=1))

        mesh = collapse(mesh, field, short, 1)
        mesh = smooth(flip(mesh, field), field)
    return mesh


def _off_chords(mesh: Labelled, removed: Integers, kept: Integers) -> Floats:
    """How far vertices on curves (K,) are from the chords that are left when they move to `kept`; else 0."""
    seams = mesh.topology.seams
    both = np.concatenate([seams, seams[:, ::-1]])
    total = np.bincount(both[:, 0], both[:, 1], minlength=mesh.topology.size).astype(np.intp)
    result = np.zeros(len(removed))
    rows = np.flatnonzero(mesh.topology.label_count[removed] > 1)  # with two neighbours along their curve
    p, a = mesh.points[removed[rows]], mesh.points[kept[rows]]
    chord = mesh.points[total[removed[rows]] - kept[rows]] - a
    square = np.maximum((chord * chord).sum(axis=1), 1e-300)
    foot = a + np.clip(((p - a) * chord).sum(axis=1) / square, 0.0, 1.0)[:, None] * chord
    result[rows] = np.sqrt(((p - foot) ** 2).sum(axis=1))
    return result


def _keeps_orientation(
    mesh: Labelled, normals: Floats, removed: Integers, kept: Integers, most: Floats | None
) -> NDArray[np.bool_]:
    """Whether every triangle around `removed` is on its side of the face when that vertex moves to `kept`, and new
    edges are as near to it as `most` (N,) says."""
    order, ends = mesh.topology.corners
    counts = mesh.topology.valence[removed]
    starts = ends[removed] - counts
    row = np.repeat(np.arange(len(removed)), counts)
    slot = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts) + np.repeat(starts, counts)
    triangle = order[slot] // 3
    old = mesh.triangles[triangle]
    stays = ~(old == kept[row][:, None]).any(axis=1)
    row, triangle, old = row[stays], triangle[stays], old[stays]
    new = np.where(old == removed[row][:, None], kept[row][:, None], old)
    p = mesh.points[new]
    area = cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal = normals[mesh.topology.corner_pairs[triangle]].sum(axis=1)
    side = (area * normal).sum(axis=1)
    least = KEPT if most is None else HELD
    bad = side <= least * np.sqrt((area * area).sum(axis=1) * (normal * normal).sum(axis=1))
    if most is not None:
        bad |= _flat(p)
        at_kept = mesh.topology.rows(kept[row], mesh.labels[triangle])
        for i in range(3):
            ends = np.stack([kept[row], new[:, i]], axis=1)
            rows = np.stack([at_kept, mesh.topology.rows(new[:, i], mesh.labels[triangle])], axis=1)
            bad |= sags(mesh.points, normals, ends, rows) > most[removed[row]]
    good = np.ones(len(removed), dtype=bool)
    good[row[bad]] = False
    return good


def _flat(corners: Floats) -> NDArray[np.bool_]:
    """Which triangles (T, 3, 3) are too slender."""
    sides = [corners[:, (i + 1) % 3] - corners[:, i] for i in range(3)]
    area = cross(sides[0], sides[1])
    longest = np.max([(side * side).sum(axis=1) for side in sides], axis=0)
    return np.asarray((area * area).sum(axis=1) < (SLENDER * longest) ** 2)


def _independent(
    mesh: Labelled, normals: Floats, removed: Integers, kept: Integers, most: Floats | None = None
) -> NDArray[np.bool_]:
    """A subset of the collapses that keep the topology and the sides of triangles, earlier ones preferred.

    They may be done together: of any two, neither vertex of one is next to the removed one of the other, so
    that they change no edge and no triangle twice.  Chosen in rounds (after Luby 1986).
    """
    edges, size = mesh.topology.edges, mesh.topology.size
    adjacency = csr_array((np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), shape=(size, size))
    adjacency = (adjacency + adjacency.T).tocsr()
    chosen = np.zeros(len(removed), dtype=bool)
    open_ = np.arange(len(removed))
    for _ in range(ROUNDS):
        checkpoint()
        won = open_[_touching(open_, open_, edges, removed, kept, size) == open_]
        common = adjacency[removed[won]].multiply(adjacency[kept[won]]).sum(axis=1)
        good = won[np.asarray(common).ravel() == 2]
        good = good[_keeps_orientation(mesh, normals, removed[good], kept[good], most)]
        chosen[good] = True
        blocked = _touching(open_, good, edges, removed, kept, size) < len(removed)
        blocked[np.searchsorted(open_, won)] = True
        open_ = open_[~blocked]
        if not len(open_):
            break
    return chosen


def _touching(
    rows: Integers, others: Integers, edges: Integers, removed: Integers, kept: Integers, size: int
) -> Integers:
    """The first of other collapses that cannot be done together with each row (their number where there is none)."""
    at_removed = np.full(size, len(removed))
    np.minimum.at(at_removed, removed[others], others)
    at_either = at_removed.copy()
    np.minimum.at(at_either, kept[others], others)
    near_either, near_removed = _spread(at_either, edges), _spread(at_removed, edges)
    return np.minimum(near_either[removed[rows]], np.minimum(near_removed[kept[rows]], at_either[kept[rows]]))


def _spread(values: Integers, edges: Integers) -> Integers:
    """The least value of each vertex (N,) and those next to it."""
    result = values.copy()
    np.minimum.at(result, edges[:, 0], values[edges[:, 1]])
    np.minimum.at(result, edges[:, 1], values[edges[:, 0]])
    return result
