"""From polynomials on cells to a triangle mesh within a tolerance.

The cells are cut, where the surface passes, until its function rises all along one direction in nearly all parts, then
contoured; the triangles of that are coarsened and graded by curvature (see `pas.mesh.graded`).

Looked at on the result, not proved: that it is a manifold without folds, within the tolerance, that ends on the walls
and shows all curves on which it must end.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from pas.errors import MeshError
from pas.limits import checkpoint
from pas.mesh.contour import march
from pas.mesh.field import CellField, Floats, Integers
from pas.mesh.graded import AIM, Graph, coarsened, fineness, finished, looked_at, remeshed
from pas.mesh.improve import folded
from pas.mesh.lattice import Lattice, Subdivision
from pas.mesh.mesh import Mesh
from pas.mesh.radial import Edges
from pas.mesh.topology import is_manifold

LEAST, FINEST = 2, 8
"""Halvings of the cells, at least and at most."""

BENT = 0.02
"""Share of the tetrahedra in which the function may turn for a lattice that is tried."""

MANY = 400_000
"""Tetrahedra beyond which a lattice is not refined further."""

SNAPS = (0.42, 0.2, 0.0)
"""Shares of an edge within which crossings merge, tried in turn on each lattice."""


FOLDS = 0.03
"""Share of folded triangles, slivers mostly, that coarsening and smoothing may have to mend."""


def triangulate(field: CellField, tolerance: float, most: int | None = None) -> Mesh:
    """A mesh in the user's coordinates whose distance from the surface is at most `tolerance`, measured.

    Raises `MeshError` where there is no surface, where no good mesh of it is found, or where the tolerance needs more
    than `most` triangles.
    """
    cells, why = Subdivision(field), "there is no surface in the region: the function does not change sign"
    while len(cells.forms):
        if cells.parts >= 1 << LEAST and (cells.bent <= BENT or _finest(cells)):
            grid = cells.lattice
            if len(grid.tetrahedra):
                try:
                    return _from(field, grid, tolerance, most)
                except ArithmeticError as error:
                    why = f"no good mesh was found: {error}; the surface may have a singular point"
        if _finest(cells):
            break
        cells.halve()
    raise MeshError(why)


def _finest(cells: Subdivision) -> bool:
    return cells.parts >= 1 << FINEST or 8 * len(cells.forms) > MANY


def _from(field: CellField, grid: Lattice, tolerance: float, most: int | None) -> Mesh:
    """The mesh that begins with a lattice; raises `ArithmeticError` where that is no good."""
    graph = _first(field, grid)
    coarse = AIM * tolerance * fineness(field, tolerance) ** 2
    return finished(field, remeshed(field, coarsened(field, graph, coarse), coarse), tolerance, most)


def _first(field: CellField, grid: Lattice) -> Graph:
    for snap in SNAPS:
        checkpoint("contouring")
        points, triangles = march(grid, snap)
        if not len(triangles) or not is_manifold(triangles):
            continue
        rim = _rims(field, points, triangles)
        for number, curve in enumerate(field.rims):
            here = np.flatnonzero(rim == number)
            if len(here):
                points[here] = curve.at(points[here])
        inner = rim < 0
        points[inner] = field.near(points[inner])
        graph = looked_at(field, points, triangles, rim)
        if folded(points, triangles, graph.normals).mean() <= FOLDS and _shows_curves(field, graph):
            return graph
    raise ArithmeticError("triangles are folded, or a curve on which the surface ends is not seen")


def _rims(field: CellField, points: Floats, triangles: Integers) -> Integers:
    """The walls (N,), or the ends of curves between two of them, on which points are; -1 inside."""
    edges = Edges(triangles, len(points))
    result = np.full(len(points), -1)
    walls = field.nearest_walls(points[edges.rim].mean(axis=1))
    before, after = np.full((2, len(points)), -1)
    after[edges.rim[:, 0]], before[edges.rim[:, 1]] = walls, walls
    result[edges.rim[:, 0]] = walls
    numbers = {pair: field.walls + i for i, pair in enumerate(field.edges)}
    for v in np.flatnonzero(before != after).tolist():
        pair = (int(min(before[v], after[v])), int(max(before[v], after[v])))
        if pair not in numbers:
            raise ArithmeticError("a curve on which the surface ends leaves its wall where there is no edge")
        result[v] = numbers[pair]
    return result


def _shows_curves(field: CellField, graph: Graph) -> bool:
    """Whether each curve on which the surface must end is near the mesh's boundary all along."""
    ends = graph.points[graph.rim >= 0]
    if not len(ends):
        return not field.curves
    tree = cKDTree(ends)
    return all(tree.query(curve)[0].max(initial=0.0) < 2 * field.feature_size for curve in field.curves)
