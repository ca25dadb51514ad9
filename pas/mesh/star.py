"""A graph over directions as triangles: Delaunay's in directions first, then graded by curvature.

The first triangles are seen once from the centre, so they have the topology of the graph.  Splits, flips that make no
edge twice, and moves keep it (see `pas.mesh.graded`).  That the result is a manifold without folds is looked at, not
proved.
"""

from __future__ import annotations

import numpy as np

from pas.limits import checkpoint
from pas.mesh.field import Floats, Integers, RayField
from pas.mesh.graded import Graph, fineness, finished, looked_at, remeshed
from pas.mesh.hull import hull, icosphere
from pas.mesh.mesh import Mesh
from pas.mesh.quality import AIM
from pas.mesh.radial import Edges

LEVELS = (1, 2, 3)
"""Halvings of the icosahedron whose directions are tried in turn."""


def star(field: RayField, tolerance: float, most: int | None = None, aim: float = AIM) -> Mesh:
    """A mesh in the user's coordinates within a tolerance, measured, of at most `most` triangles.

    Raises `ArithmeticError` where the surface is no graph over directions, as far as its rays show, and `MeshError`
    where there would be too many triangles.
    """
    if field.first is None:
        raise ArithmeticError("a ray from the centre does not meet the surface once")
    m = fineness(field, tolerance)
    graph = remeshed(field, field.first, aim * tolerance * m**2)
    require_once(field, graph.points[graph.rim < 0])
    return finished(field, graph, tolerance, m, most)


def require_once(field: RayField, points: Floats) -> None:
    """Raise `ArithmeticError` where rays from the centre through points (N, 3) do not meet the surface once."""
    if not field.once(points):
        raise ArithmeticError("a ray from the centre does not meet the surface once")


def first(field: RayField) -> Graph:
    """Few triangles seen once from the centre; raises `ArithmeticError` where rays do not meet the surface once."""
    graph = _seen(field)
    require_once(field, graph.points[graph.rim < 0])
    return graph


def _seen(field: RayField) -> Graph:
    if not field.rims:  # most of what is in boxes ends at their walls: a few rays say so
        require_once(field, icosphere(LEVELS[0])[0])
    for level in LEVELS:
        checkpoint("triangulating directions")
        try:
            points, triangles = hull(field, level)
        except ArithmeticError:
            if level == LEVELS[-1]:
                raise
            continue
        return looked_at(field, points, triangles, rim_numbers(field, points, triangles))
    raise AssertionError


def rim_numbers(field: RayField, points: Floats, triangles: Integers) -> Integers:
    """The rims (N,) on which points are, -1 inside; raises `ArithmeticError` where there are none to end on."""
    rim = np.unique(Edges(triangles, len(points)).rim)
    if len(rim) and not field.rims:
        raise ArithmeticError("the mesh ends where the surface has no contact")
    number = np.full(len(points), -1)
    if len(rim):
        number[rim] = np.argmin([curve.off(points[rim]) for curve in field.rims], axis=0)
    return number
