"""Meshes of piecewise surfaces.

Graphs over the directions from the centre are remeshed in directions, bisected where triangles fold; what is no graph
is meshed from a lattice in the cells.
"""

from __future__ import annotations

from contextlib import suppress
from functools import cached_property, partial

import numpy as np

from pas.arrays import Floats, Integers
from pas.mesh.grading import LARGEST, Settings
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.surface.bisection import bisected
from pas.surface.function import PiecewisePolynomial
from pas.surface.graph import first, require_once, rim_numbers
from pas.surface.local_field import LocalField
from pas.surface.radial_field import RadialField
from pas.surface.sheet import followed, remeshed
from pas.surface.triangulate import Beginnings, triangulate, wall_numbers


class Mesher:
    """The meshers of one surface, which move meshes onto it as well."""

    def __init__(self, surface: PiecewisePolynomial) -> None:
        self.surface = surface

    @cached_property
    def radial_field(self) -> RadialField | None:
        """The surface as a graph over directions, to be meshed, None where it is none."""
        try:
            with np.errstate(all="ignore"):  # what is not finite is no graph
                return RadialField(self.surface) if around_centre(self.surface) else None
        except ArithmeticError:
            return None

    @cached_property
    def cell_field(self) -> LocalField:
        """The surface in the cells, to be meshed from lattices."""
        return LocalField(self.surface)

    @cached_property
    def first(self) -> Labelled | None:
        """Few triangles, with which meshes of a graph over directions begin, None where rays show that it is none."""
        try:
            return None if self.radial_field is None else first(self.radial_field)
        except ArithmeticError:
            return None

    @cached_property
    def beginnings(self) -> Beginnings:
        """The first meshes on lattices."""
        return Beginnings(self.cell_field)

    def mesh(self, tolerance: float, most: int | None, quality: Quality) -> Mesh:
        """Triangles within a tolerance in the model's units, at most `most` of them where that is given.

        What its rays show to be no graph over directions (several sheets, a centre that is not inside, an open wall,
        a contact curve that is none around its middle) is meshed from a lattice.  Of several meshes the best of a
        quality is taken.
        """
        return quality.best_of(partial(self._triangles, tolerance, most, aim) for aim in quality.aims)

    @np.errstate(all="ignore")  # what is not finite is no graph, or folded, and refused
    def moved(self, points: Floats, triangles: Integers, tolerance: float) -> Mesh:
        """The mesh of points (N, 3) and triangles (T, 3) near the surface moved onto it, within a tolerance, measured.

        It is faster than to begin anew.  Raises `ArithmeticError` where that folds triangles or leaves some too far.
        """
        local, field = self.surface.partition.frame.local_points(points), self.radial_field
        if field is not None:
            with suppress(ArithmeticError):  # no graph over directions
                rim = rim_numbers(field, local, triangles)
                require_once(field, local[rim < 0])
                return followed(field, local, triangles, rim, tolerance / field.scale)
        cells = self.cell_field
        return followed(cells, local, triangles, wall_numbers(cells, local, triangles), tolerance / cells.scale)

    @np.errstate(all="ignore")  # what is not finite is no graph, or folded, and refused
    def _triangles(self, tolerance: float, most: int | None, aim: float) -> Mesh:
        field, settings = self.radial_field, Settings(aim=aim, most=LARGEST if most is None else most)
        if field is not None and self.first is not None:
            with suppress(ArithmeticError):
                return remeshed(field, self.first, tolerance / field.scale, settings, partial(require_once, field))
            with suppress(ArithmeticError):
                return bisected(field, tolerance / field.scale, settings)
        return triangulate(self.beginnings, tolerance / self.cell_field.scale, settings)


def around_centre(surface: PiecewisePolynomial) -> bool:
    """Whether there is a centre, inside the surface, and all contacts end on outer faces of the region.

    Where there are none, the middles of these must be outside.
    """
    ends = ((face.piece, surface.local.corners(face.vertices)) for face in surface.local.outer_faces)
    middles = ((surface.patches[piece], [sum(c) / 3 for c in zip(*corners, strict=True)]) for piece, corners in ends)
    return (
        surface.partition.center is not None
        and all(patch.at((0, 0, 0)) < 0 for patch in surface.patches)
        and all(join.confined for join in surface.joins)
        and (len(surface.joins) > 0 or all(patch.at(middle) > 0 for patch, middle in middles))
    )
