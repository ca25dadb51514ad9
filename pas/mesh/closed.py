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

from pas.errors import MeshError
from pas.mesh.cleaning import FOLD
from pas.mesh.face_ground import FaceGround
from pas.mesh.field import FaceField, ShellWall
from pas.mesh.first import first_lattice, first_mesh, unsound
from pas.mesh.grading import Settings
from pas.mesh.hollowed import mesh_hollowed, too_thick
from pas.mesh.kissing import mesh_touching
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.octree import Octree
from pas.mesh.projection import pair_normals
from pas.mesh.quality import Quality
from pas.mesh.refine import LARGEST, not_reached, too_many
from pas.mesh.remesher import Failure, Remesher
from pas.mesh.rows import Floats
from pas.mesh.shells import mesh_apart, together
from pas.mesh.trouble import find_trouble

THIN = 0.3
"""Share of the cubes of the first lattice that do not show one sheet, above which surfaces are meshed one by one."""

LONGER = 2.5
"""Edges over those of the first mesh, which are a quarter of what the tolerance and the room between sheets allow."""

UPRIGHT = 0.3
"""Cosine with the normals below which triangles are untangled before they are cut."""


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


def _hollowed(wall: ShellWall, field: FaceField, tolerance: float, quality: Quality) -> tuple[Labelled, float]:
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
    """The mesh of one field and its measured distance."""
    return _refined(first_mesh(field, tolerance, octree, quality is Quality.ANGLES), field, tolerance, quality)


def _refined(first: Labelled, field: FaceField, tolerance: float, quality: Quality) -> tuple[Labelled, float]:
    """A first mesh remeshed, and its measured distance.  Raises `MeshError` where it is not sound."""
    ground = FaceGround(field, int(first.labels.max()) + 1, long=quality is not Quality.ANGLES)
    remesher = Remesher(ground, tolerance, Settings(folded=FOLD, flat=quality.flat))
    mesh = remesher.begun(first)
    mesh.caps[:] = LONGER * first.sizes  # so that sheets that the lattice keeps apart do not touch
    remesher.graded(mesh, remesher.parts)
    remesher.untangle(mesh, UPRIGHT)
    found = remesher.refined(mesh)
    if isinstance(found, Failure):
        raise _refusal(found, field, tolerance)
    reason, _ = unsound(found.mesh, field, tolerance)
    if reason:
        raise MeshError(f"the tolerance {tolerance * field.scale:.3g} was not reached: {reason}")
    return found.mesh, found.deviation


def _refusal(found: Failure, field: FaceField, tolerance: float) -> MeshError:
    """Why a mesh did not come out, in words."""
    if found.crowded:
        return too_many(field, found.triangles, LARGEST, tolerance, found.reached)
    trouble = find_trouble(field, found.place[None], found.size)
    why = "a face may have a singular point" if trouble is None else trouble.sentence
    return not_reached(field, found.triangles, tolerance, found.reached, f": {why}")
