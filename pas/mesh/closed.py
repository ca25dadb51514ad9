"""From a set with faces to a closed triangle mesh within a tolerance, each triangle on its face.

Guarantees, each checked on the result: the mesh is closed and a manifold, vertices lie on their
faces, curves and corners, no triangle is turned away from its face, and the measured deviation is
below the tolerance.  The lattice is fine where the boundary is not proved to be one sheet, and is made
finer there until the next one has the same number of pieces and holes and the same faces, and all
curves and corners come out where they are.  Not guaranteed: that details are seen that are so small
that neither lattice has a node in them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pas.errors import MeshError
from pas.limits import checkpoint
from pas.mesh.collapse import RINGS, untangle
from pas.mesh.deviation import Deviation, edge_distances
from pas.mesh.field import FaceField, Floats, Integers, Wall
from pas.mesh.first import FOLD, first_lattice, first_mesh, unsound
from pas.mesh.hollowed import mesh_hollowed, too_thick
from pas.mesh.kissing import mesh_touching
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.octree import Octree
from pas.mesh.polish import polished
from pas.mesh.quality import Quality
from pas.mesh.refine import AIM, far_edges, not_reached, require_room, split
from pas.mesh.remesh import flip, pair_normals, project, smooth
from pas.mesh.rows import any_of
from pas.mesh.shells import mesh_apart, together
from pas.mesh.straight import coarser, straightened
from pas.mesh.trouble import find_trouble

LATER_SMOOTHINGS, REFINEMENTS, LAST_REFINEMENTS = 1, 40, 4
THIN = 0.3
"""Share of the cubes of the first lattice that do not show one sheet, above which surfaces are meshed one by one."""

FEW, SMOOTHED = 0.01, 1
"""Share of the edges that must be split for all of the mesh to be smoothed again; where fewer are, edges are flipped
about the new vertices alone, and so many rings of vertices about these are smoothed."""


@dataclass(frozen=True)
class FaceMesh:
    """A closed mesh whose triangles carry labels, with outward unit normals of each vertex's faces.

    `mesh` holds points (N, 3), triangles (T, 3) and labels (T,); `normals` (P, 3) belongs to the rows
    of `mesh.topology.pairs`, the (vertex, label) pairs; `deviation` is the measured distance from the set.
    """

    mesh: Labelled
    normals: Floats
    deviation: float

    def named(self, field: FaceField) -> Mesh:
        """The mesh in the user's coordinates, with the names of the field's faces; equal names are one face.

        Each connected piece of a label is named by itself, so that faces that are apart keep their names.
        """
        mesh = self.mesh
        corners = mesh.points[mesh.triangles]
        low, high = corners.min(axis=1) - self.deviation, corners.max(axis=1) + self.deviation
        centers, halves = (low + high) / 2, (high - low) / 2
        pieces = mesh.topology.pieces
        labels = [int(mesh.labels[rows[0]]) for rows in pieces]
        titles = [
            field.face_within(label, centers[rows], halves[rows]) for label, rows in zip(labels, pieces, strict=True)
        ]
        names = tuple(dict.fromkeys(title for _, title in sorted(zip(labels, titles, strict=True))))
        numbers = np.empty(len(mesh.triangles), dtype=np.intp)
        for rows, title in zip(pieces, titles, strict=True):
            numbers[rows] = names.index(title)
        return Mesh(
            field.world(mesh.points),
            mesh.triangles,
            numbers,
            names,
            self.normals[mesh.topology.corner_pairs],
            deviation=self.deviation * field.scale,
        )


def triangulate_faces(field: FaceField, tolerance: float, quality: Quality = Quality.BALANCED) -> FaceMesh:
    """A closed mesh of some quality whose distance from the boundary is at most `tolerance`, measured.

    Raises `MeshError` where the set is empty, too thin for the finest lattice, or the tolerance
    needs too many triangles.
    """
    wall = field.wall()
    make = _apart_or_whole if wall is None else partial(_hollowed, wall)
    mesh, reached = make(field, tolerance, quality)
    return FaceMesh(mesh, pair_normals(mesh, field), reached)


def _hollowed(wall: Wall, field: FaceField, tolerance: float, quality: Quality) -> tuple[Labelled, float]:
    """The mesh of a shell and its measured distance: both sides by one mesh, or from a lattice that shows the wall."""

    def of_solid(solid: FaceField, aim: float) -> Labelled:
        return triangulate_faces(solid, aim, quality).mesh

    found = mesh_hollowed(field, wall, tolerance, of_solid, partial(_refined, quality=quality))
    if found is not None:
        return found
    try:
        return _apart_or_whole(field, tolerance, quality)
    except MeshError:
        reason = too_thick(of_solid(wall.solid, tolerance), wall)
        if reason:
            raise MeshError(reason) from None
        raise


def _apart_or_whole(field: FaceField, tolerance: float, quality: Quality) -> tuple[Labelled, float]:
    """The mesh of a boundary and its measured distance, surface by surface if most of it is not one sheet."""
    octree = first_lattice(field)
    shells = field.shells() if octree.open_share > THIN else []
    found = mesh_apart(field, shells, tolerance, partial(_triangulated, quality=quality)) if len(shells) > 1 else None
    return _whole(field, tolerance, octree, quality) if found is None else found


def _whole(field: FaceField, tolerance: float, octree: Octree, quality: Quality) -> tuple[Labelled, float]:
    """The mesh of a boundary and its measured distance; of one that touches itself in points, surface by surface."""
    try:
        return _triangulated(field, tolerance, octree, quality)
    except MeshError:
        surfaces = field.touching()
        mesher = partial(_triangulated, quality=quality)
        found = mesh_touching(field, surfaces, tolerance, mesher) if len(surfaces) > 1 else None
        if found is None:
            raise
        return found


def _triangulated(
    field: FaceField, tolerance: float, octree: Octree | None = None, quality: Quality = Quality.BALANCED
) -> tuple[Labelled, float]:
    """The mesh and its measured distance; where it does not come out, without functions that others imply."""
    try:
        return _made(field, tolerance, octree, quality)
    except MeshError as refusal:
        needed = field.needed()
        if needed is field:
            raise
        try:
            mesh, reached = _made(needed, tolerance, None, quality)
        except MeshError:
            raise refusal from None  # which names all faces that meet there
        return together(field, [needed], [mesh]), reached


def _made(field: FaceField, tolerance: float, octree: Octree | None, quality: Quality) -> tuple[Labelled, float]:
    """The same of one field; where long triangles do not come out, without them."""
    first, plain = first_mesh(field, tolerance, octree, quality is Quality.ANGLES), field.without_lines()
    try:
        return _refined(first, plain if quality is Quality.ANGLES else field, tolerance, quality)
    except MeshError:
        if plain is field or quality is Quality.ANGLES:
            raise
        return _refined(first, plain, tolerance, quality)


def _refined(first: Labelled, field: FaceField, tolerance: float, quality: Quality) -> tuple[Labelled, float]:
    mesh = _with_fine_curves(first, field, tolerance)
    aim = AIM * tolerance
    mesh = coarser(mesh, field, np.full(len(mesh.points), tolerance), aim, quality)
    near, known = None, None
    for _ in range(REFINEMENTS):
        checkpoint(f"refining the mesh ({len(mesh.triangles)} triangles)")
        mesh = untangle(mesh, field, FOLD, aim, near)
        known = Deviation.of(mesh, field, known)
        if known.worst <= tolerance:
            return _finished(known, field, tolerance, quality)
        far = _far(known, tolerance)
        mesh, near = _halved(known, field, tolerance, far)
    found = find_trouble(field, mesh.points[far].mean(axis=1), float(mesh.lengths.max()))
    why = "a face may have a singular point" if found is None else found.sentence
    raise not_reached(field, len(mesh.triangles), tolerance, known.worst if known else np.inf, f": {why}")


def _far(known: Deviation, tolerance: float) -> Integers:
    """The edges (E, 2) that are to be halved."""
    mesh, inside = known.mesh, known.inside.copy()
    rows = np.flatnonzero(inside > AIM * tolerance)
    inside[rows[any_of(known.edges[_edges_of(mesh, rows)] > AIM * tolerance)]] = 0.0  # those are halved anyhow
    return far_edges(mesh.points, mesh.triangles, mesh.topology.edges, (known.edges, inside), tolerance)


def _halved(
    known: Deviation, field: FaceField, tolerance: float, far: Integers
) -> tuple[Labelled, NDArray[np.bool_] | None]:
    """The mesh with edges halved and others about them flipped; about which vertices (N,), if not about all."""
    mesh, share = known.mesh, len(far) / len(known.edges)
    require_room(field, len(mesh.triangles), share, tolerance, known.worst)
    old, mesh = len(mesh.points), _split(mesh, field, far)
    aim, near = AIM * tolerance, None
    if share > FEW:
        for _ in range(LATER_SMOOTHINGS):
            mesh = smooth(flip(mesh, field, 2, aim), field)
    else:
        new = np.arange(old, len(mesh.points))
        near = mesh.topology.around(new, RINGS)
        mesh = smooth(flip(mesh, field, 2, aim, near), field, mesh.topology.around(new, SMOOTHED))
    return flip(mesh, field, limit=aim, near=near), near


def _finished(known: Deviation, field: FaceField, tolerance: float, quality: Quality) -> tuple[Labelled, float]:
    """The mesh without what refining left on straight lines, where that is as near and as sound; and how near.

    Raises `MeshError` where the mesh itself is not sound.
    """
    aim, mesh = AIM * tolerance, known.mesh
    longer = straightened(mesh, field, np.full(len(mesh.points), aim), aim, quality)
    further = None
    for _ in range(LAST_REFINEMENTS if longer is not mesh else 0):
        further = Deviation.of(longer, field, further)
        if further.worst > tolerance:
            longer = _halved(further, field, tolerance, _far(further, tolerance))[0]
            continue
        longer, worst = polished(longer, field, further.worst, tolerance)
        if unsound(longer, field, tolerance)[0]:
            break
        return longer, worst
    mesh, worst = polished(mesh, field, known.worst, tolerance)
    reason, _ = unsound(mesh, field, tolerance)
    if reason:
        raise MeshError(f"the tolerance {tolerance * field.scale:.3g} was not reached: {reason}")
    return mesh, worst


def _with_fine_curves(mesh: Labelled, field: FaceField, tolerance: float) -> Labelled:
    """The mesh with the edges along the curves around faces with lines halved until they are near enough to these."""
    for _ in range(REFINEMENTS):
        around = np.flatnonzero(mesh.topology.seam_mask & field.lines(mesh.topology.edge_table[1]).any(axis=1))
        distances = edge_distances(field, mesh, around)
        far = around[distances > AIM * tolerance]
        if not len(far):
            break
        require_room(field, len(mesh.triangles), len(far) / len(mesh.topology.edges), tolerance, float(distances.max()))
        checkpoint(f"refining curves ({len(mesh.triangles)} triangles)")
        mesh = flip(_split(mesh, field, mesh.topology.edges[far]), field, limit=AIM * tolerance)
    return mesh


def _split(mesh: Labelled, field: FaceField, edges: Integers) -> Labelled:
    points, triangles, parents = split(mesh.points, mesh.triangles, edges)
    finer = Labelled.of(points, triangles, mesh.labels[parents], mesh.topology.pinned)
    return project(finer, field, finer.sizes, np.arange(len(mesh.points), len(points)))


def _edges_of(mesh: Labelled, rows: Integers) -> Integers:
    """The rows of the edges (K, 3) of triangles in given rows."""
    ends = np.sort(np.stack([mesh.triangles[rows], mesh.triangles[rows][:, [1, 2, 0]]], axis=2), axis=2)
    weights = np.array([mesh.topology.size, 1])
    return np.searchsorted(mesh.topology.edges @ weights, ends @ weights)
