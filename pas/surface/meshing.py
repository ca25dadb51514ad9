"""Meshes of piecewise surfaces: as graphs over the directions from the centre, else from a lattice in the cells."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from pas.errors import GeometryError, MeshError
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.mesh.star import star
from pas.mesh.triangulate import FoldedError, triangulate
from pas.surface.surface_mesh import SurfaceMesh

if TYPE_CHECKING:
    from pas.surface.piecewise import PiecewiseSurface

FINER = (1.0, 0.5, 0.25)
"""Shares of the tolerance that are tried in turn where triangles fold: finer ones need not."""

SHARP = 10.0
"""Times the neighbours' curvature beyond which a surface's own is named where it cannot be meshed."""


def meshed(surface: PiecewiseSurface, tolerance: float, most: int | None, quality: Quality) -> SurfaceMesh:
    """Triangles within a tolerance in the model's units, at most `most` of them where that is given.

    What its rays show to be no graph over directions (several sheets, a centre that is not inside, an open wall, a
    contact curve that is none around its middle) is meshed from a lattice.  Of several meshes the best of a quality is
    taken.
    """
    first, *others = quality.aims
    found = [_triangles(surface, tolerance, most, first)]
    for aim in others:
        with suppress(MeshError):  # too many triangles, or no good mesh: there is one already
            found.append(_triangles(surface, tolerance, most, aim))
    return SurfaceMesh.of_surface(quality.best(found), surface, tolerance)


def _triangles(surface: PiecewiseSurface, tolerance: float, most: int | None, aim: float) -> Mesh:
    field = surface.radial_field
    for share in () if field is None else FINER:
        assert field is not None
        try:
            with np.errstate(all="ignore"):  # what is not finite is no graph
                return star(field, share * tolerance / field.scale, most, aim)
        except ArithmeticError:
            pass
        except MeshError:  # too many triangles
            if share == 1:
                raise
            break
    lattice = surface.cell_field
    try:
        with np.errstate(all="ignore"):  # what is not finite is folded, and refused
            return triangulate(lattice, tolerance / lattice.scale, most, aim)
    except FoldedError as error:
        raise MeshError(f"{error}{_sharpest(surface)}") from None


def _sharpest(surface: PiecewiseSurface) -> str:
    """Where a surface bends much more than its neighbours, and what makes room, in words."""
    try:
        fair = surface.fairness()
    except GeometryError:
        return ""
    if not fair.sharpness > SHARP:
        return ""
    x, y, z = (f"{v:.4g}" for v in fair.sharpest)
    return (
        f"; near ({x}, {y}, {z}) it is {fair.sharpness:.3g} times as sharp as its neighbours, and clips that are "
        'farther out, as clip="auto" finds them, leave more room'
    )
