"""A graph over directions as triangles: Delaunay's in directions first, then graded by curvature.

The first triangles are seen once from the centre, so they have the topology of the graph.  What the remesher does keeps
it (see `pas.mesh.remesher`).  That the result is a manifold without folds is looked at, not proved.
"""

from __future__ import annotations

import numpy as np

from pas.limits import checkpoint
from pas.mesh.edges import Edges
from pas.mesh.field import RayField
from pas.mesh.grading import Settings
from pas.mesh.halfedges import HalfEdges
from pas.mesh.hull import hull, icosphere, seen
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.quality import AIM
from pas.mesh.rows import Floats, Integers, dots
from pas.mesh.shading import unit_rows
from pas.mesh.sheet import open_mesh, remeshed

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
    settings = Settings(aim=aim) if most is None else Settings(aim=aim, most=most)
    return remeshed(field, field.first, tolerance, settings, lambda points: require_once(field, points))


def require_once(field: RayField, points: Floats) -> None:
    """Raise `ArithmeticError` where rays from the centre through points (N, 3) do not meet the surface once."""
    if not field.once(points):
        raise ArithmeticError("a ray from the centre does not meet the surface once")


def first(field: RayField) -> Labelled:
    """Few triangles seen once from the centre; raises `ArithmeticError` where rays do not meet the surface once."""
    mesh = _seen(field)
    if field.rims:
        inside = np.setdiff1d(np.arange(len(mesh.points)), Edges(mesh.triangles, len(mesh.points)).rim)
        require_once(field, mesh.points[inside])
    return mesh


def _seen(field: RayField) -> Labelled:
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
        return _parted(field, open_mesh(field, points, triangles, rim_numbers(field, points, triangles)))
    raise AssertionError


def _parted(field: RayField, mesh: Labelled) -> Labelled:
    """The triangles with edges between opposite sides of a thin arm halved until none is left.

    The arm goes on between them: the ray between those to the ends meets it there, while its points next to the middle
    of the edge may be on any side.
    """
    for _ in range(PARTINGS):
        halves, size = HalfEdges(mesh, np.zeros(1, dtype=np.int8)), len(mesh.points)
        normals, corners, ends = field.gradients(mesh.points), halves.corners, halves.ends
        opposite = np.flatnonzero(dots(normals[corners], normals[ends]) < 0)
        opposite = opposite[halves.twins[opposite] > opposite]
        if not len(opposite):
            break
        units = unit_rows(mesh.points)
        middles = units[corners[opposite]] + units[ends[opposite]]
        halves.split(opposite)
        halves.points[size:] = field.met(unit_rows(middles))
        if not seen(halves.points, halves.triangles).all():
            break
        mesh = halves.value
    return mesh


def rim_numbers(field: RayField, points: Floats, triangles: Integers) -> Integers:
    """The rims (N,) on which points are, -1 inside; raises `ArithmeticError` where there are none to end on."""
    rim = np.unique(Edges(triangles, len(points)).rim)
    if len(rim) and not field.rims:
        raise ArithmeticError("the mesh ends where the surface has no contact")
    number = np.full(len(points), -1)
    if len(rim):
        number[rim] = np.argmin([curve.off(points[rim]) for curve in field.rims], axis=0)
    return number
