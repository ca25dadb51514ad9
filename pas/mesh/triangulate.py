"""From a field on cells to a triangle mesh within a tolerance.

A coarse mesh from a lattice is refined where it is further from the surface than the tolerance,
so triangles are small where the surface bends and large where it is flat.

Guarantees, each checked on the result: vertices on the surface (|f| / |grad f| below 1e-9 of
the size), boundary vertices on the walls, a manifold mesh without folds, and a measured
deviation below the tolerance.  Not guaranteed: that features below the first lattice's size are
seen; on surfaces proved to be of one sheet there are no separate ones.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from pas.errors import MeshError
from pas.limits import checkpoint
from pas.mesh.contour import march
from pas.mesh.field import CellField, Floats, Integers
from pas.mesh.improve import boundary_of, flip, folded, project, smooth
from pas.mesh.lattice import lattice
from pas.mesh.mesh import Mesh
from pas.mesh.refine import far_edges, farthest_inside, inner_points, not_reached, require_room, split
from pas.mesh.shading import unit_rows

RESOLUTION = 1.8
"""The first lattice's spacing over the size of the smallest feature: about what shows a pipe of
that radius; whether it did is checked, and refinement does the rest."""

COARSEST, FINEST = 12, 288
"""Subdivisions of a cell's edge in the first lattice, at least and at most."""

FINER = 1.5
"""Each further first lattice is this many times finer."""

SNAPS = (0.3, 0.15)
"""Shares of an edge within which crossings merge, tried in turn on each lattice."""

FIRST_SMOOTHINGS, LATER_SMOOTHINGS = 5, 2
REFINEMENTS = 16


def triangulate(field: CellField, tolerance: float, most: int | None = None) -> Mesh:
    """A mesh in the user's coordinates whose distance from the surface is at most `tolerance`, measured.

    Raises `MeshError` where there is no surface, or the tolerance needs more than `most` triangles.
    """
    mesh = _first(field)
    for step in range(REFINEMENTS + 1):
        checkpoint(f"refining the mesh ({len(mesh.triangles)} triangles)")
        distances = _edge_distances(field, mesh), _inner_distances(field, mesh)
        reached = float(max(distances[0].max(), distances[1].max()))
        if reached <= tolerance:
            points, deviation = field.world(mesh.points), reached * field.scale
            return Mesh.smooth(points, mesh.triangles, mesh.point_normals, deviation=deviation)
        if step == REFINEMENTS:
            break
        edges = mesh.edges[0]
        far = far_edges(mesh.points, mesh.triangles, edges, distances, tolerance)
        require_room(field, len(mesh.triangles), len(far) / len(edges), tolerance, reached, most)
        mesh = _refined(field, mesh, far)
    raise not_reached(field, len(mesh.triangles), tolerance, reached, "; the surface may have a singular point")


def _edge_distances(field: CellField, mesh: Mesh) -> Floats:
    """Distances |f| / |grad f| of the edges' midpoints (E,), on the boundary in the wall's plane."""
    edges, times = mesh.edges
    middles = mesh.points[edges].mean(axis=1)
    normals = np.zeros_like(middles)
    rim = np.flatnonzero(times == 1)
    if len(rim):
        normals[rim] = field.walls[field.nearest_walls(middles[rim]), :3]
    return _distances(field, middles, normals)


def _inner_distances(field: CellField, mesh: Mesh) -> Floats:
    return farthest_inside(_distances(field, inner_points(mesh.points[mesh.triangles]), None))


def _distances(field: CellField, points: Floats, normals: Floats | None) -> Floats:
    jets = field.jets(points, field.locate(points))
    gradient = jets[:, 1:]
    if normals is not None:
        gradient = gradient - (gradient * normals).sum(axis=1, keepdims=True) * normals
    return np.abs(jets[:, 0]) / np.maximum(np.sqrt((gradient * gradient).sum(axis=1)), 1e-300)


def _first(field: CellField) -> Mesh:
    """The mesh of the coarsest lattice that shows all contact curves, manifold and without folds.

    Else that of the finest, as it is.
    """
    corners = field.vertices[field.cells]
    longest = float(np.sqrt(((corners[:, :, None] - corners[:, None]) ** 2).sum(axis=-1)).max())
    wanted = float(np.clip(longest / (RESOLUTION * field.feature_size), COARSEST, FINEST))
    empty = True
    while wanted <= FINEST:
        halvings = int(np.floor(np.log2(wanted / 5)))
        grid = lattice(field, int(np.ceil(wanted / 2**halvings)), halvings)
        wanted *= FINER
        if not len(grid.tetrahedra):
            continue
        empty = False
        for snap in SNAPS:
            mesh = _improved(field, *march(grid, snap), FIRST_SMOOTHINGS)
            sound = mesh.is_manifold and not folded(mesh.points, mesh.triangles, mesh.point_normals).any()
            if sound and _shows_curves(field, mesh):
                return mesh
    if empty:
        raise MeshError("there is no surface in the region: the function does not change sign")
    return _improved(field, *march(grid, 0.0), FIRST_SMOOTHINGS)


def _shows_curves(field: CellField, mesh: Mesh) -> bool:
    """Whether each curve on which the surface must end is near the mesh's boundary all along."""
    if not len(mesh.boundary):
        return not field.curves
    tree = cKDTree(mesh.points[mesh.boundary])
    return all(tree.query(curve)[0].max(initial=0.0) < 2 * field.feature_size for curve in field.curves)


def _refined(field: CellField, mesh: Mesh, edges: Integers) -> Mesh:
    points, triangles, _ = split(mesh.points, mesh.triangles, edges)
    return _improved(field, points, triangles, LATER_SMOOTHINGS)


def _improved(field: CellField, points: Floats, triangles: Integers, smoothings: int) -> Mesh:
    boundary = boundary_of(points, triangles, field)
    points = project(points, field, boundary)
    for _ in range(smoothings):
        checkpoint()
        normals = _normals(field, points)
        triangles = flip(points, triangles, normals)
        points = project(smooth(points, triangles, normals, boundary), field, boundary)
    normals = _normals(field, points)
    return Mesh.smooth(points, flip(points, triangles, normals), normals)


def _normals(field: CellField, points: Floats) -> Floats:
    return unit_rows(field.jets(points, field.locate(points))[:, 1:])
