"""From a set with faces to a closed triangle mesh within a tolerance, each triangle on its face.

Guarantees, each checked on the result: the mesh is closed and a manifold, vertices lie on their
faces, curves and corners, no triangle is turned away from its face, and the measured deviation is
below the tolerance.  Not guaranteed: that details below the lattice's spacing are seen.  Cubes that
the boundary provably misses are the only ones left out, and the lattice is made finer until the next
finer ones have the same number of pieces and holes and the same faces, and all curves and corners come
out where they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.mesh.faces import Crossings, march_faces
from pas.mesh.field import FaceField, Floats, Integers, TriangleMesh
from pas.mesh.refine import split, with_longest
from pas.mesh.remesh import Labelled, collapse, cosines, flip, least_norm, pair_normals, project, smooth, untangle
from pas.mesh.triangulate import AIM, INNER, LARGEST, MeshError

FIRST_PARTS, FINER, LATTICES, COMPARED = 25, 1.6, 8, 3
"""Cubes along the longest side of the box in the first lattice, how many times more in each further
one, how many are tried, and how many at least must show the same pieces, holes and faces."""

SNAPS = (0.3, 0.15, 0.0)
"""Shares of a lattice edge within which crossings merge, tried in turn."""

HALVINGS = 3
SHORT = 0.55
"""Edges below this share of the mean length about both their ends are collapsed."""

SMOOTHINGS, LATER_SMOOTHINGS, REFINEMENTS = 3, 1, 40
FEW = 0.01
"""Share of the edges that must be split for the mesh to be smoothed again."""

FOLD = 0.2
"""Cosine of a triangle's normal and its face's below which it counts as folded."""

ON_FACE = 1e-7
"""Distance from its faces, over the lattice's spacing, up to which a vertex counts as placed."""


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
    mesh, spacing = _first(field, tolerance)
    for _ in range(REFINEMENTS):
        edges, far, worst = _far_edges(field, mesh, tolerance)
        if worst <= tolerance:
            return FaceMesh(mesh, pair_normals(mesh, field))
        if len(mesh.triangles) * (1 + 3 * len(far) / len(edges)) > LARGEST:
            raise MeshError(
                f"the tolerance {tolerance:.3g} needs more than {LARGEST} triangles; "
                f"{worst:.2g} is reached with {len(mesh.triangles)}"
            )
        points, triangles, parents = split(mesh.points, mesh.triangles, far)
        mesh = project(Labelled.of(points, triangles, mesh.labels[parents]), field, spacing)
        if len(far) > FEW * len(edges):
            for _ in range(LATER_SMOOTHINGS):
                mesh = flip(mesh, field, 2)
                mesh = smooth(mesh, field, spacing / 4)
        mesh = flip(mesh, field)
    raise MeshError(
        f"the tolerance {tolerance:g} was not reached with {len(mesh.triangles)} triangles ({worst:.2g} was); "
        "a face may have a singular point"
    )


def _first(field: FaceField, tolerance: float) -> tuple[Labelled, float]:
    """The mesh of the coarsest lattice that shows all faces soundly, and as all finer ones looked at do."""
    extent = float(np.ptp(field.box, axis=0).max())
    lattices = [extent / (FIRST_PARTS * FINER**i) for i in range(LATTICES)]
    marched: list[Crossings | None] = []
    reason = ""
    for number, spacing in enumerate(lattices[:-1]):
        wanted = max(number + 2, COMPARED)
        marched += [march_faces(field, lattices[i], HALVINGS) for i in range(len(marched), wanted)]
        shapes = {None if c is None else c.shape for c in marched[number:]}
        crossings = marched[number]
        marched[number] = None
        if crossings is None or len(shapes) > 1:
            reason = "its pieces, holes or faces are too small" if shapes != {None} else reason
            continue
        raw = next((m for snap in SNAPS if (m := crossings.mesh(field, snap)) is not None), None)
        if raw is None or (raw.labels < 0).any():
            reason = "too many faces meet in one place"
            continue
        mesh = _improved(raw, field, spacing)
        reason = _unsound(mesh, field, spacing, tolerance)
        if not reason:
            return mesh, spacing
    if not reason:
        raise MeshError(f"the solid is empty, or thinner everywhere than {_parts(lattices)} of its bounding box")
    raise MeshError(f"the solid could not be meshed with a lattice of {_parts(lattices)} of its bounding box: {reason}")


def _parts(lattices: list[float]) -> str:
    return f"1/{round(FIRST_PARTS * lattices[0] / lattices[-1])}"


def _improved(mesh: Labelled, field: FaceField, spacing: float) -> Labelled:
    mesh = _with_special_points(mesh, field, spacing)
    mesh = project(mesh, field, spacing / 2)

    def short(m: Labelled, edges: Integers) -> NDArray[np.bool_]:
        d = m.points[edges[:, 0]] - m.points[edges[:, 1]]
        length = np.sqrt((d * d).sum(axis=1))
        size = m.topology.size
        total = np.bincount(edges[:, 0], length, minlength=size) + np.bincount(edges[:, 1], length, minlength=size)
        mean = total / np.maximum(m.topology.valence, 1)
        return np.asarray(length < SHORT * np.minimum(mean[edges[:, 0]], mean[edges[:, 1]]))

    for _ in range(SMOOTHINGS):
        mesh = collapse(mesh, field, short)
        mesh = flip(mesh, field)
        mesh = smooth(mesh, field, spacing / 4)
    mesh = flip(collapse(mesh, field, short), field)
    return untangle(mesh, field, FOLD, spacing / 4)


def _with_special_points(mesh: Labelled, field: FaceField, spacing: float) -> Labelled:
    """The vertex nearest to each special point moved there."""
    points = mesh.points.copy()
    for special in field.special_points:
        square = ((points - special) ** 2).sum(axis=1)
        nearest = int(square.argmin())
        if square[nearest] < 4 * spacing**2:
            points[nearest] = special
    return mesh.moved(points)


def _unsound(mesh: Labelled, field: FaceField, spacing: float, tolerance: float) -> str:
    """Why the mesh cannot be trusted, or an empty string."""
    folded = np.flatnonzero(cosines(mesh, field) < FOLD)
    if len(folded):
        place = mesh.points[mesh.triangles[folded[0]]].mean(axis=0)
        return f"near {_place(place)} it is too thin or two faces meet too flatly"
    for labels, vertices in mesh.topology.groups:
        if len(labels) > 2:  # a corner may be one only within the tolerance
            steps = [least_norm(field, (label,), mesh.points[vertices]) for label in labels]
            away, limit = np.sqrt((np.array(steps) ** 2).sum(axis=2)).max(axis=0), CORNER * tolerance
        else:
            away = np.sqrt((least_norm(field, field.functions(labels), mesh.points[vertices]) ** 2).sum(axis=1))
            limit = ON_FACE * spacing
        if away.max() > limit:
            worst = mesh.points[vertices[away.argmax()]]
            return f"near {_place(worst)} faces come close without meeting"
    return ""


def _place(point: Floats) -> str:
    return "(" + ", ".join(f"{x:.4g}" for x in point) + ")"


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
