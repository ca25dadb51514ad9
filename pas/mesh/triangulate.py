"""From a field on cells to a triangle mesh within a tolerance.

Guarantees, each checked on the result: vertices on the surface (|f| / |grad f| below 1e-9 of
the size), boundary vertices on the walls, a manifold mesh, and a measured deviation below the
tolerance.  Not guaranteed: that features below the lattice's size are seen; for surfaces proved
to be of one sheet there are none.
"""

from __future__ import annotations

import numpy as np

from pas.errors import PasError
from pas.mesh.contour import march
from pas.mesh.field import CellField, Floats, Integers, TriangleMesh
from pas.mesh.improve import boundary_of, flip, folded, project, smooth
from pas.mesh.lattice import lattice

SNAPS = (0.3, 0.2, 0.1, 0.0)
"""Shares of an edge within which crossings merge, tried in turn until the mesh is manifold."""

SMOOTHINGS = 5
COARSEST, FINEST = 6, 160
"""Subdivisions of a cell's edge: fewer miss the shape, more exhaust memory."""

SAFETY = 0.8
"""Aim below the tolerance, since the deviation falls with the square of the size only about."""


class MeshError(PasError):
    """The surface has no mesh of this tolerance; the message says why."""


def triangulate(field: CellField, tolerance: float) -> TriangleMesh:
    """A mesh whose distance from the surface is at most `tolerance`, measured.

    Raises `MeshError` where there is no surface, or the tolerance needs too fine a lattice.
    """
    subdivisions = COARSEST * 2
    while True:
        mesh = _attempt(field, subdivisions)
        reached = deviation(field, mesh)
        if reached <= tolerance:
            return mesh
        wanted = int(np.ceil(subdivisions * np.sqrt(reached / (SAFETY * tolerance))))
        if subdivisions >= FINEST:
            raise MeshError(
                f"the tolerance {tolerance:g} needs a finer lattice than {FINEST} subdivisions of a cell; "
                f"{reached:.2g} was reached"
            )
        subdivisions = min(FINEST, max(wanted, subdivisions + 2))


def deviation(field: CellField, mesh: TriangleMesh) -> float:
    """The largest distance |f| / |grad f| of the mesh's edges and triangles from the surface.

    Measured at edge midpoints and at seven points inside each triangle; on the boundary the
    distance is taken in the wall's plane.
    """
    p = mesh.points[mesh.triangles]
    weights = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [2, 2, 1], [2, 1, 2], [1, 2, 2]], dtype=float)
    weights /= weights.sum(axis=1, keepdims=True)
    inner = np.einsum("wk,tkx->wtx", weights, p).reshape(-1, 3)
    edges, times = mesh.edges
    middle = mesh.points[edges].mean(axis=1)
    largest = max(_distances(field, inner).max(), _distances(field, middle[times == 2]).max(initial=0.0))
    rim = edges[times == 1]
    if len(rim):
        walls = field.walls
        middle = mesh.points[rim].mean(axis=1)
        nearest = np.abs(middle @ walls[:, :3].T - walls[:, 3]).argmin(axis=1)
        largest = max(largest, _distances(field, middle, walls[nearest, :3]).max())
    return float(largest)


def _distances(field: CellField, points: Floats, normals: Floats | None = None) -> Floats:
    jets = field.jets(points, field.locate(points))
    gradient = jets[:, 1:]
    if normals is not None:
        gradient = gradient - (gradient * normals).sum(axis=1, keepdims=True) * normals
    return np.abs(jets[:, 0]) / np.maximum(np.linalg.norm(gradient, axis=1), 1e-300)


def _attempt(field: CellField, subdivisions: int) -> TriangleMesh:
    grid = lattice(field, subdivisions)
    if not len(grid.tetrahedra):
        raise MeshError("there is no surface in the region: the function does not change sign")
    for snap in SNAPS:
        mesh = _improved(field, *march(grid, snap))
        if mesh.is_manifold and not folded(mesh.points, mesh.triangles, mesh.normals).any():
            break
    return mesh


def _improved(field: CellField, points: Floats, triangles: Integers) -> TriangleMesh:
    boundary = boundary_of(points, triangles, field)
    points = project(points, field, boundary)
    for _ in range(SMOOTHINGS):
        normals = _normals(field, points)
        triangles = flip(points, triangles, normals)
        points = project(smooth(points, triangles, normals, boundary), field, boundary)
    normals = _normals(field, points)
    return TriangleMesh(points, flip(points, triangles, normals), normals)


def _normals(field: CellField, points: Floats) -> Floats:
    gradient = field.jets(points, field.locate(points))[:, 1:]
    return gradient / np.maximum(np.linalg.norm(gradient, axis=1, keepdims=True), 1e-300)


