"""Collapsing edges of a closed mesh whose triangles carry labels, so that its topology stays.

Only edges go that meet the link condition (Dey et al. 1999) and keep every triangle on its side of the
face, many at once where they do not touch.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pas.limits import checkpoint
from pas.mesh.field import FaceField, Floats, Integers
from pas.mesh.kernels import compiled
from pas.mesh.labelled import Labelled, Topology
from pas.mesh.remesh import cosines, flip, pair_normals, smooth
from pas.mesh.rows import any_of, dots, norms

KEPT = 0.35
"""Cosine between a triangle's new normal and its face's, below which a collapse is refused."""

HELD, TURNED = 0.8, 0.5
"""The same where edges may become long, and with the face's normal at each corner alone, so that no triangle goes
through a bar."""

UNTANGLINGS, MANY, SOME = 8, 0.01, 40
"""How often folded triangles are removed, and their share above which that is hopeless, if there are more than some:
a mesh of planes has few triangles, of which a corner where many faces meet folds a large share."""

RINGS = 2
"""Of triangles about what is mended, in which edges are flipped and vertices move."""

FEW = 0.005
"""Share of the vertices that must have gone for going on."""

ROUNDS = 6
"""In which collapses are chosen that do not touch."""


def collapse(
    mesh: Labelled, field: FaceField, short: Callable[[Labelled, Integers], NDArray[np.bool_]], passes: int = 4
) -> Labelled:
    """Edges for which `short(mesh, edges)` holds are collapsed, the shortest first."""
    for _ in range(passes):
        checkpoint()
        found = _collapse_once(mesh, field, np.flatnonzero(short(mesh, mesh.topology.edges)))
        if found is None:
            break
        mesh = found[0]
    return mesh


def coarsen(
    mesh: Labelled,
    field: FaceField,
    chosen: Callable[[Labelled, Integers, NDArray[np.bool_]], Integers],
    most: Floats | None = None,
    limit: float | None = None,
    slenderest: Floats | None = None,
) -> Labelled:
    """Edges are collapsed and others flipped until hardly any vertex goes; all others stay where they are.

    `chosen(mesh, numbers, fresh)` gives the rows of the edges that may go, of those with a vertex that is `fresh` (N,),
    whose triangles are not those of the last time; `numbers` (N,) are the vertices' numbers in the mesh at first.
    `most` (N,) says how far edges may be from their faces and curves that take the place of those of a vertex that
    goes, and none makes triangles whose height over their longest side is less than `slenderest` says of their labels
    (2, L), where vertices on curves go and those inside, but where there are such already; `limit` is that of `flip`.
    """
    numbers, fresh = np.arange(len(mesh.points)), np.ones(len(mesh.points), dtype=bool)
    near = None
    while True:
        checkpoint(f"coarsening the mesh ({len(mesh.triangles)} triangles)")
        rows = chosen(mesh, numbers, fresh)
        found = _collapse_once(mesh, field, rows, None if most is None else most[numbers], fresh, slenderest)
        if found is None:
            return mesh
        smaller, used, fresh = found
        mesh, gone = flip(smaller, field, 2, limit, None if near is None else fresh), len(mesh.points) - len(used)
        fresh[mesh.triangles[any_of(mesh.triangles != smaller.triangles)]] = True
        numbers, near = numbers[used], fresh
        if gone < FEW * len(numbers):
            return mesh


def _collapse_once(
    mesh: Labelled,
    field: FaceField,
    rows: Integers,
    most: Floats | None = None,
    fresh: NDArray[np.bool_] | None = None,
    slenderest: Floats | None = None,
) -> tuple[Labelled, Integers, NDArray[np.bool_]] | None:
    """The mesh after collapses of edges in given rows, which vertices are left, and which of them (N,) have triangles
    that were not there; None where none can be done."""
    rows = rows[np.argsort(mesh.lengths[rows], kind="stable")]
    removed, kept = _directed(mesh.topology, rows)
    if fresh is not None:
        removed, kept = removed[fresh[removed]], kept[fresh[removed]]
    if most is not None and len(removed):
        straight = _off_chords(mesh, removed, kept) <= most[removed]
        removed, kept = removed[straight], kept[straight]
    if not len(removed):
        return None
    size, normals = len(mesh.points), pair_normals(mesh, field)
    free = _independent(mesh, normals, removed, kept, most, slenderest)
    removed, kept = removed[free], kept[free]
    if not len(removed):
        return None
    target = np.arange(size)
    target[removed] = kept
    triangles = target[mesh.triangles]
    a, b, c = triangles.T
    distinct = (a != b) & (b != c) & (c != a)
    stays = np.zeros(size, dtype=bool)
    stays[triangles[distinct]] = True
    used, number = np.flatnonzero(stays), np.cumsum(stays) - 1
    pinned = mesh.topology.pinned
    pinned = number[pinned[stays[pinned]]]
    topology = Topology(number[triangles[distinct]], mesh.labels[distinct], len(used), pinned)
    known = normals[mesh.topology.rows(used[topology.pairs[:, 0]], topology.pairs[:, 1])]
    changed = np.zeros(len(used), dtype=bool)
    changed[topology.triangles[any_of(triangles != mesh.triangles)[distinct]]] = True
    return Labelled(mesh.points[used], topology, known), used, changed


def _directed(topology: Topology, rows: Integers) -> tuple[Integers, Integers]:
    """Which ends (K,) of the edges in given rows may go, edge by edge, and to which others (K,).

    A vertex inside a face may go anywhere; one on a curve only along it; a corner stays.
    """
    edges, is_seam = topology.edges[rows], topology.seam_mask[rows]
    may = (topology.label_count[edges] == 1) | (is_seam[:, None] & ~topology.fixed[edges])
    return edges[may], edges[:, ::-1][may]


def untangle(
    mesh: Labelled,
    field: FaceField,
    fold: float,
    limit: float | None = None,
    near: NDArray[np.bool_] | None = None,
) -> Labelled:
    """The mesh without folded triangles, as far as collapsing their edges and smoothing about them removes them.

    Where many are folded the mesh is left as it is: it is too coarse.  `limit` is that of `flip`; with `near` (N,),
    only triangles at these vertices are looked at, at first.
    """
    for _ in range(UNTANGLINGS):
        rows = np.arange(len(mesh.triangles)) if near is None else np.flatnonzero(any_of(near[mesh.triangles]))
        folded, near = rows[cosines(mesh, field, rows) < fold], None
        if not len(folded) or len(folded) > max(MANY * len(mesh.triangles), SOME):
            break
        marked = np.zeros(mesh.topology.size, dtype=bool)
        marked[mesh.triangles[folded]] = True

        def short(m: Labelled, edges: Integers, marked: NDArray[np.bool_] = marked) -> NDArray[np.bool_]:
            return any_of(marked[edges])

        mesh = collapse(mesh, field, short, 1)
        left = cosines(mesh, field) < fold
        if left.any():
            about = mesh.topology.around(mesh.triangles[left].ravel(), RINGS)
            mesh = smooth(flip(mesh, field, limit=limit, near=about), field, about)
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
    square = np.maximum(dots(chord, chord), 1e-300)
    foot = a + np.clip(((p - a) * chord).sum(axis=1) / square, 0.0, 1.0)[:, None] * chord
    result[rows] = norms(p - foot)
    return result


def _independent(
    mesh: Labelled, normals: Floats, removed: Integers, kept: Integers, most: Floats | None, slenderest: Floats | None
) -> NDArray[np.bool_]:
    """A subset of the collapses that keep the topology and the sides of triangles, earlier ones preferred.

    They may be done together: of any two, neither vertex of one is next to the removed one of the other, so
    that they change no edge and no triangle twice.  Chosen in rounds (after Luby 1986).
    """
    tables = mesh.triangles, mesh.topology.corner_pairs, mesh.labels
    both, limits = (mesh.topology.edges, mesh.topology.label_count), (most, slenderest)
    least = (KEPT, HELD, TURNED, ROUNDS)
    return compiled().merged_faces(mesh.points, tables, normals, both, (removed, kept), limits, least)
