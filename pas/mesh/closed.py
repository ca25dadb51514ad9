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
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from pas.mesh.collapse import collapse, untangle
from pas.mesh.faces import Crossings
from pas.mesh.field import FaceField, Floats, Integers, TriangleMesh
from pas.mesh.octree import BASE, DEEPEST, NOWHERE, QUIET, Octree
from pas.mesh.refine import split, with_longest
from pas.mesh.remesh import Labelled, cosines, flip, least_norm, pair_normals, project, smooth
from pas.mesh.triangulate import AIM, INNER, LARGEST, MeshError

FIRST_PARTS, HALVINGS, COMPARED = 25, 9, 3
"""Small cubes along the longest side of the box in the first lattice, how many finer ones are tried at most,
and how many must show the same pieces, holes and faces, unless all of the boundary is clear."""

MANY = 0.01
"""Share of the cubes in which more than one sheet may be, above which a lattice is made finer without a look."""

SHORT = 0.55
"""Edges below this share of the mean length about both their ends are collapsed."""

SMOOTHINGS, LATER_SMOOTHINGS, REFINEMENTS = 3, 1, 40
FEW = 0.01
"""Share of the edges that must be split for the mesh to be smoothed again."""

MORE_THAN_ENOUGH = 0.25
"""Share of the length that the tolerance allows below which edges go."""

FOLD = 0.2
"""Cosine of a triangle's normal and its face's below which it counts as folded."""

ON_FACE = 1e-7
"""Distance from its faces, over the length of its edges, up to which a vertex counts as placed."""


CORNER = 0.5
"""How far a corner may be off each of its faces, over the tolerance."""


@dataclass(frozen=True)
class FaceMesh:
    """A closed mesh whose triangles carry labels, with outward unit normals of each vertex's faces.

    `mesh` holds points (N, 3), triangles (T, 3) and labels (T,); `normals` (P, 3) belongs to the rows
    of `mesh.topology.pairs`, the (vertex, label) pairs.
    """

    mesh: Labelled
    normals: Floats

    @cached_property
    def triangle_mesh(self) -> TriangleMesh:
        """The same without labels; a vertex's normal is the mean of its faces'."""
        total = np.zeros_like(self.mesh.points)
        np.add.at(total, self.mesh.topology.pairs[:, 0], self.normals)
        length = np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
        return TriangleMesh(self.mesh.points, self.mesh.triangles, total / length)


def triangulate_faces(field: FaceField, tolerance: float) -> FaceMesh:
    """A closed mesh whose distance from the boundary is at most `tolerance`, measured.

    Raises `MeshError` where the set is empty, too thin for the finest lattice, or the tolerance
    needs too many triangles.
    """
    mesh = _first(field, tolerance)
    for _ in range(REFINEMENTS):
        mesh = untangle(mesh, field, FOLD)
        edges, far, worst = _far_edges(field, mesh, tolerance)
        if worst <= tolerance:
            reason, _ = _unsound(mesh, field, tolerance)
            if reason:
                raise MeshError(f"the tolerance {tolerance * field.scale:.3g} was not reached: {reason}")
            return FaceMesh(mesh, pair_normals(mesh, field))
        if len(mesh.triangles) * (1 + 3 * len(far) / len(edges)) > LARGEST:
            raise MeshError(
                f"the tolerance {tolerance * field.scale:.3g} needs more than {LARGEST} triangles; "
                f"{worst * field.scale:.2g} is reached with {len(mesh.triangles)}"
            )
        points, triangles, parents = split(mesh.points, mesh.triangles, far)
        mesh = Labelled.of(points, triangles, mesh.labels[parents])
        mesh = project(mesh, field, mesh.sizes)
        if len(far) > FEW * len(edges):
            for _ in range(LATER_SMOOTHINGS):
                mesh = smooth(flip(mesh, field, 2), field)
        mesh = flip(mesh, field)
    raise MeshError(
        f"the tolerance {tolerance * field.scale:g} was not reached with {len(mesh.triangles)} triangles "
        f"({worst * field.scale:.2g} was); a face may have a singular point"
    )


def _first(field: FaceField, tolerance: float) -> Labelled:
    """The mesh of the coarsest lattice that shows all faces soundly, and as all finer ones looked at do."""
    extent = float(np.ptp(field.box, axis=0).max())
    octree = Octree(field, extent / FIRST_PARTS)
    while octree.open_share > MANY and octree.levels < DEEPEST:
        octree = octree.refined()
    ahead = [_Lattice(field, octree)]
    reason = ""
    for _ in range(HALVINGS):
        first, places = ahead[0].crossings, NOWHERE
        raw = first.mesh()
        if not isinstance(raw, Labelled):
            reason, places = f"near {_place(field, raw[0])} too many faces meet", raw
        else:
            while len(ahead) < COMPARED and ahead[-1].octree.open_share > 0:
                ahead.append(_Lattice(field, ahead[-1].octree.refined()))
            if any(first.shape != other.crossings.shape for other in ahead[1:]):
                reason = "its pieces or holes are too small"
            elif not all(first.shows_faces_of(other.crossings) for other in ahead[1:]):
                reason = "its faces are too small"
            elif len(first.edges):
                mesh = _improved(raw, field, tolerance)
                reason, places = _unsound(mesh, field, tolerance)
                if not reason:
                    return mesh
        if not any(len(one.crossings.edges) for one in ahead):
            ahead = [_Lattice(field, ahead[-1].octree.refined(least=QUIET))]
        elif len(places) or len(ahead) == 1:
            ahead = [_Lattice(field, ahead[0].octree.refined(places))]
        else:
            ahead = ahead[1:]
    finest = f"1/{FIRST_PARTS << (ahead[-1].octree.levels - BASE)}"
    if not reason:
        raise MeshError(f"the solid is empty, or thinner everywhere than {finest} of its bounding box")
    raise MeshError(f"the solid could not be meshed with a lattice of {finest} of its bounding box: {reason}")


@dataclass(frozen=True)
class _Lattice:
    """An octree and where the boundary crosses it."""

    field: FaceField
    octree: Octree

    @cached_property
    def crossings(self) -> Crossings:
        return Crossings(self.field, *self.octree.tetrahedra())


def _improved(mesh: Labelled, field: FaceField, tolerance: float) -> Labelled:
    mesh = _with_special_points(mesh, field)
    mesh = project(mesh, field, mesh.sizes / 2)
    mesh = _coarsened(mesh, field, tolerance)

    def short(m: Labelled, edges: Integers) -> NDArray[np.bool_]:
        return np.asarray(m.lengths < SHORT * m.sizes[edges].min(axis=1))

    for _ in range(SMOOTHINGS):
        mesh = collapse(mesh, field, short)
        mesh = flip(mesh, field)
        mesh = smooth(mesh, field)
    mesh = flip(collapse(mesh, field, short), field)
    return untangle(mesh, field, FOLD)


def _coarsened(mesh: Labelled, field: FaceField, tolerance: float) -> Labelled:
    """Without the vertices that are far more than the tolerance needs, such as those in the middle of a plane."""
    aim = np.minimum(tolerance, mesh.sizes / 4)  # so that sheets that the lattice keeps apart do not touch
    longest = MORE_THAN_ENOUGH * np.sqrt(8 * aim / np.maximum(_bend(mesh, field), 1e-9))
    tree = cKDTree(mesh.points)

    def spare(m: Labelled, edges: Integers) -> NDArray[np.bool_]:
        return np.asarray(m.lengths < longest[tree.query(m.points)[1]][edges].min(axis=1))

    while True:
        smaller = flip(collapse(mesh, field, spare, 2), field, 1)
        if len(smaller.points) > (1 - FEW) * len(mesh.points):
            return mesh
        mesh = smaller


def _bend(mesh: Labelled, field: FaceField) -> Floats:
    """The largest curvature of faces and curves at each vertex (N,), from its edges."""
    topology, points = mesh.topology, mesh.points
    normals = pair_normals(mesh, field)
    result = np.zeros(topology.size)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = mesh.triangles[:, i], mesh.triangles[:, j]
        turn = normals[topology.corner_pairs[:, i]] - normals[topology.corner_pairs[:, j]]
        along = points[a] - points[b]
        bend = np.sqrt((turn * turn).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-300))
        np.maximum.at(result, a, bend)
        np.maximum.at(result, b, bend)
    ends = np.concatenate([topology.seams, topology.seams[:, ::-1]])
    along = points[ends[:, 1]] - points[ends[:, 0]]
    length = np.sqrt((along * along).sum(axis=1))
    units = along / np.maximum(length, 1e-300)[:, None]
    turns = np.stack([np.bincount(ends[:, 0], u, minlength=topology.size) for u in units.T], axis=1)
    span = np.bincount(ends[:, 0], length, minlength=topology.size)
    bent = np.sqrt((turns * turns).sum(axis=1)) / np.maximum(span / 2, 1e-300)
    return np.maximum(result, np.where(topology.fixed, 0.0, bent))


def _with_special_points(mesh: Labelled, field: FaceField) -> Labelled:
    """The vertex nearest to each special point moved there."""
    points = mesh.points.copy()
    for special in field.special_points:
        square = ((points - special) ** 2).sum(axis=1)
        nearest = int(square.argmin())
        if square[nearest] < (2 * mesh.sizes[nearest]) ** 2:
            points[nearest] = special
    return mesh.moved(points)


def _unsound(mesh: Labelled, field: FaceField, tolerance: float) -> tuple[str, Floats]:
    """Why the mesh cannot be trusted, or an empty string; and where (K, 3)."""
    folded = np.flatnonzero(cosines(mesh, field) < FOLD)
    if len(folded):
        places = mesh.points[mesh.triangles[folded]].mean(axis=1)
        return f"near {_place(field, places[0])} it is too thin or two faces meet too flatly", places
    far = np.zeros(len(mesh.points))
    for labels, vertices in mesh.topology.groups:
        if len(labels) > 2:  # a corner may be one only within the tolerance
            each = np.array([least_norm(field, (label,), mesh.points[vertices]) for label in labels])
            far[vertices] = np.sqrt((each * each).sum(axis=2)).max(axis=0) / (CORNER * tolerance)
        else:
            steps = least_norm(field, field.functions(labels), mesh.points[vertices])
            far[vertices] = np.sqrt((steps * steps).sum(axis=1)) / (ON_FACE * mesh.sizes[vertices])
    if far.max() > 1:
        place = _place(field, mesh.points[far.argmax()])
        return f"near {place} faces come close without meeting", mesh.points[far > 1]
    return "", NOWHERE


def _place(field: FaceField, point: Floats) -> str:
    return "(" + ", ".join(f"{x:.4g}" for x in field.world(point)) + ")"


def _far_edges(field: FaceField, mesh: Labelled, tolerance: float) -> tuple[Integers, Integers, float]:
    """All edges; those to split: too far themselves, or the longest of a triangle that is; the largest distance."""
    edges = mesh.topology.edges
    distances = edge_distances(field, mesh)
    inner = inner_distances(field, mesh)
    worst = float(max(distances.max(), inner.max()))
    far = edges[distances > AIM * tolerance]
    return edges, with_longest(mesh.points, mesh.triangles[inner > AIM * tolerance], far), worst


def edge_distances(field: FaceField, mesh: Labelled) -> Floats:
    """First-order distances of the edges' midpoints from their face or curve (E,)."""
    edges = mesh.topology.edges
    result = np.zeros(len(edges))
    for labels, rows in mesh.topology.edge_groups:
        middles = (mesh.points[edges[rows, 0]] + mesh.points[edges[rows, 1]]) / 2
        step = least_norm(field, field.functions(labels), middles)
        result[rows] = np.sqrt((step * step).sum(axis=1))
    return result


def inner_distances(field: FaceField, mesh: Labelled) -> Floats:
    """The largest first-order distance of some inner points of each triangle from its face (T,)."""
    result = np.zeros(len(mesh.triangles))
    for label, _, rows in mesh.topology.label_rows:
        points = np.einsum("wk,tkx->twx", INNER, mesh.points[mesh.triangles[rows]]).reshape(-1, 3)
        steps = least_norm(field, (label,), points)
        result[rows] = np.sqrt((steps * steps).sum(axis=1)).reshape(-1, len(INNER)).max(axis=1)
    return result
