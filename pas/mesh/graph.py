"""A mesh of a surface with what is known of the surface at its points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.mesh.field import Floats, Integers, SheetField
from pas.mesh.radial import Edges, upright
from pas.mesh.shading import unit_rows

FOLDED = 0.3
"""Cosine with the surface's normals below which a triangle counts as folded."""


class BadMeshError(ArithmeticError):
    """Why triangles are no good mesh, and near which point (3,), in the coordinates of the field."""

    def __init__(self, why: str, place: Floats) -> None:
        super().__init__(why)
        self.place = place


@dataclass(frozen=True)
class Graph:
    """Points (N, 3), triangles (T, 3), and at the points unit normals (N, 3) and the larger curvature's size (N,).

    `rim` (N,) is the number of the rim that a point is on, -1 inside.
    """

    points: Floats
    triangles: Integers
    rim: Integers
    normals: Floats
    bends: Floats

    @cached_property
    def edges(self) -> Edges:
        """All edges."""
        return Edges(self.triangles, len(self.points))

    def joined(self, more: Graph) -> Graph:
        """With more points behind these, and their triangles."""
        points, rim = np.concatenate([self.points, more.points]), np.concatenate([self.rim, more.rim])
        normals, bends = np.concatenate([self.normals, more.normals]), np.concatenate([self.bends, more.bends])
        return Graph(points, more.triangles, rim, normals, bends)

    @property
    def folded(self) -> NDArray[np.bool_]:
        """Which triangles (T,) are turned from the surface's normals."""
        return ~(upright(self.points, self.triangles, self.normals) >= FOLDED)

    def require_upright(self) -> None:
        """Raise `ArithmeticError` where triangles are folded."""
        folded = self.folded
        if folded.any():
            worst = self.triangles[folded.argmax()]
            raise BadMeshError("some triangles are folded", self.points[worst].mean(axis=0))


def looked_at(field: SheetField, points: Floats, triangles: Integers, rim: Integers) -> Graph:
    """With normals and curvatures."""
    gradients, bends = field.bending(points)
    return Graph(points, triangles, rim, unit_rows(gradients), bends)
