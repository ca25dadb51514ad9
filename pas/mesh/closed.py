"""From a set with faces to a closed triangle mesh within a tolerance, each triangle on its face.

Guarantees, each checked on the result: the mesh is closed and a manifold, vertices lie on their faces, curves and
corners, no triangle is turned away from its face, and the measured deviation is below the tolerance.  The lattice is
fine where the boundary is not proved to be one sheet, and is made finer there until the next one has the same number of
pieces and holes and the same faces, and all curves and corners come out where they are.  Not guaranteed: that details
are seen that are so small that neither lattice has a node in them.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.spatial import cKDTree

from pas.arrays import Bools, Floats, Integers
from pas.mesh.cleaning import FOLD, cleaned
from pas.mesh.crossings import crossings, near_pairs
from pas.mesh.diagnostics import PLACES, diagnosis
from pas.mesh.face_ground import FaceGround
from pas.mesh.field import FaceField, bounds_set, extent_of, place_of
from pas.mesh.first import THIN, first_lattice, first_mesh, unsound
from pas.mesh.grading import LARGEST, Settings
from pas.mesh.hollowed import mesh_apart, mesh_hollowed, together, too_thick
from pas.mesh.labelled import Labelled
from pas.mesh.nodes import SAME, Nodes, check_crossing_edges, contracted, flat_nodes, pinched_at
from pas.mesh.octree import Octree
from pas.mesh.projection import distances, newton, project
from pas.mesh.quality import Quality
from pas.mesh.refusals import FaceMesh, RefusalError, attempted, not_reached, too_many
from pas.mesh.remesher import Failure, Remesher
from pas.mesh.rows import norms
from pas.mesh.topology import connected

UPRIGHT = 0.3
"""Cosine with the normals below which triangles are untangled before they are cut."""


def triangulate_faces(
    field: FaceField, tolerance: float, quality: Quality = Quality.BALANCED, first: Labelled | None = None
) -> FaceMesh:
    """A closed mesh of some quality whose distance from the boundary is at most `tolerance`, measured.

    It is made of a `first` mesh, where such a one is known and shows all of the boundary, and of lattices elsewhere.
    Raises `MeshError` where the set is empty, too thin for the finest lattice, or the tolerance needs too many
    triangles.
    """
    made = None if first is None else _from_first(first, field, tolerance, quality)
    found = _bounded(field, tolerance, quality) if made is None else made
    if first is not None:
        missing = {*first.labels.tolist()} - {*found.mesh.labels.tolist()}
        lost = sorted(field.face(label) for label in missing if _begins(first, field, tolerance, label))
        if lost:
            raise RefusalError(
                f"the solid could not be meshed: {', '.join(lost)} did not come out; set another tolerance"
            )
    if made is None:
        _check_apart(found.mesh, field, tolerance)
    return found


def _from_first(first: Labelled, field: FaceField, tolerance: float, quality: Quality) -> FaceMesh | None:
    """The mesh of a boundary from a first one that need not be good; None where it is not of all of the boundary, or
    that is no surface."""
    joined = _joined(first, field)
    mesh = joined and cleaned(joined, field, tolerance)
    if mesh is None or unsound(mesh, field, tolerance)[0]:
        return None
    found = attempted(partial(refined_faces, mesh, field, tolerance, quality))
    if isinstance(found, RefusalError) or not _bounding(found.mesh, field, tolerance):
        return None
    _check_apart(found.mesh, field, tolerance)
    return found


def _check_apart(mesh: Labelled, field: FaceField, tolerance: float) -> None:
    """Raise `RefusalError` where pieces touch: in a vertex of one, near where one is nearest to faces of others, or
    where edges cross."""
    pieces, room = connected(mesh.topology.edges, len(mesh.points)), 4 * tolerance  # between a vertex and such a face
    owners, close = pieces[mesh.triangles[:, 0]], SAME * extent_of(field)
    if pieces.max() == 0:
        return
    corners, labels = mesh.points[mesh.triangles], mesh.labels
    close_by = near_pairs(np.concatenate([corners - room, corners + room], axis=1))
    close_by = close_by[owners[close_by] @ (1, -1) != 0]
    sides = np.stack([owners[close_by].ravel(), labels[close_by[:, ::-1]].ravel()], axis=1)
    beside = 10 * close * np.concatenate([np.eye(3), -np.eye(3)])
    for piece, label in np.unique(sides, axis=0).tolist():
        if piece in owners[labels == label]:
            continue
        here = mesh.points[pieces == piece]
        off = distances(field, here, np.full(len(here), label))
        on, near = here[off < close], here[off < room]
        around = (on[:, None] + beside).reshape(-1, 3)
        around, begins = _beginning(field, around, np.full(len(around), label), 10 * close)
        if begins.any():
            raise pinched_at(field, around[begins][0])
        feet, begins = _beginning(field, near, np.full(len(near), label), room)
        gaps = np.where(begins, norms(near - feet), np.inf)
        nearest = np.argsort(gaps)[: min(PLACES, np.isfinite(gaps).sum())]
        trouble = diagnosis(field, feet[nearest], room)
        if trouble is not None and trouble.stays:
            raise RefusalError(f"the solid could not be meshed: {trouble.sentence}")
    edges, sides = mesh.topology.edge_table
    rows = np.flatnonzero((sides[:, 0] != sides[:, 1]) & np.isin(pieces[edges[:, 0]], owners[close_by]))
    if not len(rows):
        return
    ends = mesh.points[edges[rows]]
    pairs = near_pairs(np.concatenate([ends - room, ends + room], axis=1))
    pairs = pairs[pieces[edges[rows[pairs], 0]] @ (1, -1) != 0]
    reach = norms(np.diff(ends, axis=1)[:, 0])[pairs].min(axis=1)
    check_crossing_edges(field, ends[pairs], sides[rows[pairs]].reshape(-1, 4), reach, room)


def _joined(mesh: Labelled, field: FaceField) -> Labelled | None:
    """A mesh with vertices that their faces put in one place made one, as corners are in which more faces meet, and
    with one where two faces touch in a point of their curve.

    None where it is no surface then.
    """
    placed = project(mesh, field, mesh.sizes / 2)
    close = SAME * extent_of(field)
    near = cKDTree(placed.points).query_pairs(close, output_type="ndarray")
    firsts = np.unique(connected(near, len(placed.points))[near[:, 0]], return_index=True)[1]
    for nodes in (Nodes(placed.points[near[firsts, 0]], np.full(len(firsts), 2 * close)), flat_nodes(field, placed)):
        drawn = contracted(field, placed.points, placed.triangles, placed.labels, nodes)
        if isinstance(drawn, Nodes):
            return None
        placed = Labelled.of(*drawn)
    return placed


def _begins(mesh: Labelled, field: FaceField, tolerance: float, label: int) -> bool:
    """Whether the set begins at the middle of a triangle of a label: not where faces in one plane cover one another."""
    middles = mesh.points[mesh.triangles[mesh.labels == label]].mean(axis=1)
    return bool(_beginning(field, middles, np.full(len(middles), label), tolerance)[1].any())


def _bounding(mesh: Labelled, field: FaceField, tolerance: float) -> bool:
    """Whether the set begins at all triangles: with the face's function alone it changes from inside to outside.

    As ten points of each show, where these are farther from the sides than the mesh may be from the boundary.
    """
    corners, parts = mesh.points[mesh.triangles], 6
    sides = np.roll(corners, -1, axis=1) - corners
    heights = norms(np.cross(sides[:, 0], sides[:, 1])) / np.sqrt((sides**2).sum(axis=2)).max(axis=1)
    rows = np.flatnonzero(heights > 2 * parts * tolerance)
    weights = np.array([(i, j, parts - i - j) for i in range(1, parts) for j in range(1, parts - i)]) / parts
    points = np.einsum("wc,tcx->twx", weights, corners[rows]).reshape(-1, 3)
    labels = np.repeat(mesh.labels[rows], len(weights))
    return bool(_beginning(field, points, labels, tolerance)[1].all())


def _beginning(field: FaceField, points: Floats, labels: Integers, reach: float) -> tuple[Floats, Bools]:
    """Points (N, 3) moved onto the faces of their labels (N,), by at most `reach`, and whether the set begins there."""
    placed = newton(points, field, labels[:, None], np.full(len(points), reach))
    return placed, bounds_set(field, placed, labels)


def _bounded(field: FaceField, tolerance: float, quality: Quality) -> FaceMesh:
    """The mesh of a boundary: of a shell from that of its solid where that does, of all else from lattices."""
    wall = field.wall()
    if wall is None:
        return _from_lattices(field, tolerance, quality)
    mesh, refined = (partial(make, quality=quality) for make in (_bounded, refined_faces))
    hollowed = attempted(partial(mesh_hollowed, field, wall, tolerance, mesh, refined))
    lattices = partial(_from_lattices, field, tolerance, quality)
    found = hollowed if isinstance(hollowed, FaceMesh) else attempted(lattices)
    if isinstance(found, FaceMesh):
        return found
    reason = too_thick(_bounded(wall.solid, tolerance, quality).mesh, wall)
    raise RefusalError(reason) if reason else found


def _from_lattices(field: FaceField, tolerance: float, quality: Quality) -> FaceMesh:
    """The mesh of a boundary from lattices, by the first of three ways that serves, or why the first that tells fails.

    These are: all of it at once, surface by surface, and without functions that others imply, if what is left bounds
    the set.  Surface by surface comes first if most of the boundary is not one sheet in the first lattice.
    """
    octree, mesh = first_lattice(field), partial(_made, quality=quality)

    def apart() -> FaceMesh | None:
        shells = field.shells()
        return mesh_apart(field, shells, tolerance, mesh) if len(shells) > 1 else None

    def needed() -> FaceMesh | None:
        rest = field.needed(tolerance / 4)
        if rest is field:
            return None
        found = mesh(rest, tolerance)
        labelled = together(field, [rest], [found.mesh])
        return FaceMesh(labelled, found.deviation) if _bounding(labelled, field, tolerance) else None

    whole = partial(mesh, field, tolerance, octree=octree)
    refusals = list[RefusalError]()
    for way in (apart, whole, needed) if octree.open_share > THIN else (whole, apart, needed):
        found = attempted(way)
        if isinstance(found, RefusalError):
            refusals.append(found)
        elif found is not None:
            return found
    raise refusals[0]


def _made(field: FaceField, tolerance: float, quality: Quality, octree: Octree | None = None) -> FaceMesh:
    """The mesh of one field with the functions that it has."""
    return refined_faces(first_mesh(field, tolerance, octree), field, tolerance, quality)


def refined_faces(first: Labelled, field: FaceField, tolerance: float, quality: Quality) -> FaceMesh:
    """A closed mesh with the faces of a first one, otherwise as of `triangulate_faces`; raises `RefusalError` where
    it would not be sound."""
    ground = FaceGround(field, int(first.labels.max()) + 1, long=quality is not Quality.ANGLES)
    remesher = Remesher(ground, tolerance, Settings(folded=FOLD, flat=quality.flat))
    mesh = remesher.begun(first)
    # Edges over those of the first mesh, which are a quarter of what the tolerance and the room between sheets allow.
    longer = 2.5
    mesh.caps[:] = longer * first.sizes  # so that sheets that the lattice keeps apart do not touch
    if quality is Quality.ANGLES:
        remesher.halve_long(mesh, remesher.parts)
    remesher.graded(mesh, remesher.parts)
    remesher.untangle(mesh, UPRIGHT)
    found = remesher.refined(mesh)
    if isinstance(found, Failure):
        if found.crowded:
            raise too_many(field.scale, found.triangles, LARGEST, tolerance, found.reached)
        trouble = diagnosis(field, found.place[None], found.size)
        why = "a face may have a singular point" if trouble is None else trouble.sentence
        raise not_reached(field, found.triangles, tolerance, found.reached, why)
    reason, _ = unsound(found.mesh, field, tolerance)
    if reason:
        raise RefusalError(f"the tolerance {tolerance * field.scale:.3g} was not reached: {reason}")
    pairs, places = crossings(found.mesh.points, found.mesh.triangles)
    if len(pairs):
        names = " and ".join(sorted({repr(field.face(label)) for label in found.mesh.labels[pairs[0]].tolist()}))
        where = f"near {place_of(field, places[0])} triangles of {names} cross, as it is no thicker there"
        raise RefusalError(f"the tolerance {tolerance * field.scale:.3g} was not reached: {where}; take a finer one")
    return found
