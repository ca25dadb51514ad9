"""Meshes of surfaces that move: the vertices of one are put onto the next, which is faster than to begin anew."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pas.mesh.field import Floats, Integers
from pas.mesh.mesh import Mesh
from pas.mesh.sheet import followed
from pas.mesh.star import require_once, rim_numbers
from pas.mesh.triangulate import wall_numbers

if TYPE_CHECKING:
    from pas.partition.cells import OuterFace
    from pas.surface.piecewise import PiecewiseSurface


def around_centre(surface: PiecewiseSurface) -> bool:
    """Whether there is a centre, inside the surface, and all contacts end on outer faces of the region.

    Where there are none, the middles of these must be outside.
    """
    return (
        surface.partition.center is not None
        and all(patch.at((0, 0, 0)) < 0 for patch in surface.patches)
        and all(join.confined for join in surface.joins)
        and (len(surface.joins) > 0 or all(_outside(surface, face) for face in surface.local.outer_faces))
    )


def _outside(surface: PiecewiseSurface, face: OuterFace) -> bool:
    """Whether the middle of an outer face is."""
    corners = [surface.local.vertices[v] for v in face.vertices]
    x, y, z = (sum(c) / 3 for c in zip(*corners, strict=True))
    return surface.patches[face.piece].at((x, y, z)) > 0


def on_surface(surface: PiecewiseSurface, points: Floats, triangles: Integers, tolerance: float) -> Mesh:
    """The mesh of points (N, 3) and triangles (T, 3) near a surface moved onto it, within a tolerance, measured.

    Raises `ArithmeticError` where that folds triangles or leaves some too far.
    """
    with np.errstate(all="ignore"):  # what is not finite is folded, and refused
        local = surface.partition.frame.local_points(points)
        field = surface.radial_field
        if field is not None:
            try:
                rim = rim_numbers(field, local, triangles)
                require_once(field, local[rim < 0])
                return followed(field, local, triangles, rim, tolerance / field.scale)
            except ArithmeticError:  # no graph over directions
                pass
        cells = surface.cell_field
        return followed(cells, local, triangles, wall_numbers(cells, local, triangles), tolerance / cells.scale)
