"""Slender triangles of a mesh of one surface mended, where it is graded and halved already: see `pas.mesh.mending`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.mesh.field import Floats, Integers, SheetField
from pas.mesh.mending import Mending
from pas.mesh.places import at_vertices
from pas.mesh.shading import unit_rows

GOOD = 0.4226
"""Sine of the angle, 31 degrees, below which a triangle away from the boundary is mended."""

ROUNDS = 6
"""Of moves and flips."""


def shaped(
    field: SheetField, points: Floats, triangles: Integers, normals: Floats, rim: Integers, tolerance: float
) -> Mending:
    """Points (N, 3), triangles (T, 3) and normals (N, 3), those mended that can be within a tolerance.

    Vertices on the boundary, whose number of a `rim` (N,) is not -1, stay, and so do those next to them, so that none
    leaves the region.
    """
    free = rim < 0
    free[triangles[at_vertices(triangles, rim >= 0)]] = False
    labels, own = np.zeros(len(triangles), dtype=np.intp), np.where(free[:, None], normals, 0.0)
    mending = Mending(points.copy(), triangles.copy(), labels, own, free, _Sheet(field), GOOD, tolerance)
    mending.mend(ROUNDS)
    mending.normals[~free] = normals[~free]
    return mending


@dataclass(frozen=True)
class _Sheet:
    """A surface on which vertices move."""

    field: SheetField

    def placed(self, points: Floats, labels: Integers) -> tuple[Floats, Floats]:
        """Points (K, 3) moved onto the surface, and the unit normals there."""
        moved = self.field.near(points)
        return moved, unit_rows(self.field.gradients(moved))

    def farthest(self, corners: Floats, labels: Integers) -> Floats:
        """The largest distance of the centres of triangles (T, 3, 3) and the middles of their edges."""
        middles = ((corners + corners[:, [1, 2, 0]]) / 2).reshape(-1, 3)
        found = self.field.distances(np.concatenate([corners.mean(axis=1), middles]))
        return np.maximum(found[: len(corners)], found[len(corners) :].reshape(-1, 3).max(axis=1))
