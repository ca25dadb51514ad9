"""Surfaces as the mesher of cells wants them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_fraction
from pas.partition.cells import OuterFace

if TYPE_CHECKING:
    from pas.surface.piecewise import PiecewiseSurface


class LocalField:
    """The surface in local coordinates, as the mesher wants it."""

    def __init__(self, surface: PiecewiseSurface) -> None:
        self.surface = surface
        self.scale = float(to_fraction(surface.partition.frame.scale))
        self.vertices = surface.local.points
        self.cells = np.array(surface.local.cells)
        self.faces = [surface.local.points[list(face.vertices)] for face in surface.local.outer_faces]
        self.walls, self.wall_of = np.unique(
            [_unit_plane(face) for face in surface.local.outer_faces], axis=0, return_inverse=True
        )
        self.curves = [join.curve() for join in surface.joins if np.isfinite(join.radius)]
        self.feature_size = min((join.radius for join in surface.joins), default=np.inf)

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""
        return self.surface.partition.frame.global_points(points)

    def nearest_walls(self, points: Floats) -> NDArray[np.intp]:
        """The numbers of the walls (N,) whose faces are nearest to points (N, 3)."""
        if not len(points):
            return np.empty(0, dtype=np.intp)
        nearest = np.argmin([_distances(points, face) for face in self.faces], axis=0)
        return np.asarray(self.wall_of.ravel()[nearest])

    def locate(self, points: Floats) -> np.ndarray:
        """The cell that holds, or is nearest to, each of points (N, 3)."""
        return self.surface.local.locate(points, tolerance=np.inf)

    def jets(self, points: Floats, cells: np.ndarray) -> Floats:
        """Values and gradients (N, 4) of given cells' patches at points (N, 3)."""
        return self.surface.local_jets(points, self.surface.partition.piece_of[cells])


def _unit_plane(face: OuterFace) -> tuple[float, ...]:
    """The unit normal and offset of a face's plane, (4,)."""
    constant, *slope = (face.plane.dense(1)[i] for i in range(4))
    length = np.linalg.norm(slope)
    return tuple(np.round([*(np.array(slope) / length), -constant / length], 14))


def _distances(points: Floats, triangle: Floats) -> Floats:
    """How far points (N, 3) are from a triangle (3, 3): from the point of it with the nearest barycentric coordinates
    that are not negative."""
    edges = (triangle[1:] - triangle[0]).T
    shares = np.linalg.lstsq(edges, (points - triangle[0]).T, rcond=None)[0]
    weights = np.maximum(np.stack([1 - shares.sum(axis=0), *shares]), 0)
    nearest = (weights / weights.sum(axis=0)).T @ triangle
    return np.asarray(np.linalg.norm(points - nearest, axis=1))
