"""A graph over directions as triangles: Delaunay's in directions first, then graded by curvature.

The first triangles are seen once from the centre, so they have the topology of the graph.  Splits, flips that make no
edge twice, and moves keep it (see `pas.mesh.graded`).  That the result is a manifold without folds is looked at, not
proved.
"""

from __future__ import annotations

import numpy as np

from pas.limits import checkpoint
from pas.mesh.field import Floats, Integers, RayField
from pas.mesh.graded import graded, remeshed
from pas.mesh.graph import Graph, looked_at
from pas.mesh.hull import hull, icosphere
from pas.mesh.mesh import Mesh
from pas.mesh.quality import AIM
from pas.mesh.radial import Edges, seen
from pas.mesh.refine import split
from pas.mesh.rows import dots
from pas.mesh.shading import unit_rows

LEVELS = (1, 2, 3)
"""Halvings of the icosahedron whose directions are tried in turn."""

PARTINGS = 6
"""Rounds in which edges between opposite sides are halved at most."""


def star(field: RayField, tolerance: float, most: int | None = None, aim: float = AIM) -> Mesh:
    """A mesh in the user's coordinates within a tolerance, measured, of at most `most` triangles.

    Raises `ArithmeticError` where the surface is no graph over directions, as far as its rays show, and `MeshError`
    where there would be too many triangles.
    """
    if field.first is None:
        raise ArithmeticError("a ray from the centre does not meet the surface once")
    beginning = field.first

    def coarse(tolerance: float) -> Graph:
        graph = remeshed(field, beginning, tolerance)
        require_once(field, graph.points[graph.rim < 0])
        return graph

    return graded(field, coarse, tolerance, aim, most)


def require_once(field: RayField, points: Floats) -> None:
    """Raise `ArithmeticError` where rays from the centre through points (N, 3) do not meet the surface once."""
    if not field.once(points):
        raise ArithmeticError("a ray from the centre does not meet the surface once")


def first(field: RayField) -> Graph:
    """Few triangles seen once from the centre; raises `ArithmeticError` where rays do not meet the surface once."""
    graph = _seen(field)
    if field.rims:
        require_once(field, graph.points[graph.rim < 0])
    return graph


def _seen(field: RayField) -> Graph:
    for level in LEVELS:
        if not field.rims:  # most of what is in boxes ends at their walls: a few rays say so
            require_once(field, icosphere(level)[0])
        checkpoint("triangulating directions")
        try:
            points, triangles = hull(field, level)
        except ArithmeticError:
            if level == LEVELS[-1]:
                raise
            continue
        return _parted(field, looked_at(field, points, triangles, rim_numbers(field, points, triangles)))
    raise AssertionError


def _parted(field: RayField, graph: Graph) -> Graph:
    """The triangles with edges between opposite sides of a thin arm halved until none is left.

    The arm goes on between them: the ray between those to the ends meets it there, while its points next to the middle
    of the edge may be on any side.
    """
    for _ in range(PARTINGS):
        inner, size = graph.edges.inner, len(graph.points)
        opposite = inner[dots(graph.normals[inner[:, 0]], graph.normals[inner[:, 1]]) < 0]
        if not len(opposite):
            break
        units, triangles, _ = split(unit_rows(graph.points), graph.triangles, opposite)
        fresh = field.met(units[size:])
        new = graph.joined(looked_at(field, fresh, triangles, np.full(len(fresh), -1)))
        if not seen(new.points, triangles).all():
            break
        graph = new
    return graph


def rim_numbers(field: RayField, points: Floats, triangles: Integers) -> Integers:
    """The rims (N,) on which points are, -1 inside; raises `ArithmeticError` where there are none to end on."""
    rim = np.unique(Edges(triangles, len(points)).rim)
    if len(rim) and not field.rims:
        raise ArithmeticError("the mesh ends where the surface has no contact")
    number = np.full(len(points), -1)
    if len(rim):
        number[rim] = np.argmin([curve.off(points[rim]) for curve in field.rims], axis=0)
    return number
