"""Contours of values on a grid, as other programs make them, to the same largest error as a mesh of ours.

The error is the largest |f| / |grad f| over vertices, middles of edges and centres of triangles.  A peer gets the
coarsest grid, found by trying, whose contour is as near; its time is that of the grid's values, by the same evaluator
as ours, and of the contour.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from measured import Prepare, Work

import pas

FINEST_GRID, FIRST_GRID = 400, 12

Contour = Callable[[np.ndarray, float], tuple[np.ndarray, np.ndarray]]
"""From values on a grid and its step to points, with the grid's first point at 0, and triangles."""


@dataclass(frozen=True)
class Grids:
    """Values of a surface on grids of its region's box."""

    evaluator: pas.Evaluator
    low: np.ndarray
    high: np.ndarray

    @classmethod
    def of(cls, surface: pas.PiecewiseSurface) -> Grids:
        """Around the region of a surface."""
        points = surface.partition.points
        return cls(pas.Evaluator(surface), points.min(axis=0), points.max(axis=0))

    def values(self, number: int) -> tuple[np.ndarray, float]:
        """Values, NaN outside of the region, with so many points on the longest side, and the step."""
        step = float((self.high - self.low).max()) / (number - 1)
        counts = np.ceil((self.high - self.low) / step - 1e-9).astype(int) + 1
        axes = [low + step * np.arange(n) for low, n in zip(self.low, counts, strict=True)]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        return self.evaluator.values(points).reshape(counts), step

    def error(self, points: np.ndarray, triangles: np.ndarray) -> float:
        """The largest |f| / |grad f| where the surface is."""
        finite = np.asarray(np.isfinite(points).all(axis=1))  # outside there is nothing
        corners = points[triangles[finite[triangles].all(axis=1)]]
        if not len(corners):
            return float(np.inf)
        middles = [(corners[:, i] + corners[:, (i + 1) % 3]) / 2 for i in range(3)]
        at = np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1), *middles])
        steepness = np.linalg.norm(self.evaluator.gradients(at), axis=1)
        return float(np.nanmax(np.abs(self.evaluator.values(at)) / steepness))

    def as_near(self, aim: float, contour: Contour) -> int:
        """The points on the longest side of the coarsest grid tried whose contour is as near as that."""
        number = FIRST_GRID
        while number < FINEST_GRID:
            values, step = self.values(number)
            points, triangles = contour(values, step)
            reached = self.error(points + self.low, triangles)
            if reached <= aim:
                break
            number = 1 + int(number * np.clip(np.sqrt(reached / aim), 1.05, 1.6))
        return number


def flying_edges(values: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """By VTK (Schroeder, Maynard and Geveci 2015)."""
    import pyvista

    image = pyvista.ImageData(dimensions=values.shape, spacing=(step,) * 3)
    image["f"] = values.ravel(order="F")
    found = image.contour([0.0], scalars="f", method="flying_edges", compute_normals=False)
    return np.asarray(found.points, dtype=float), found.regular_faces


def marching_cubes(values: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """By scikit-image (Lewiner and others 2003)."""
    from skimage.measure import marching_cubes as marched

    points, triangles, _, _ = marched(values, 0.0, spacing=(step,) * 3)
    return points, triangles


def as_near(surface: Callable[[], pas.PiecewiseSurface], share: float, contour: Contour) -> Prepare:
    """The work of a peer whose contour is as near as our mesh with a tolerance of that share of the longest side."""

    def prepare() -> Work:
        shape = surface()
        grids = Grids.of(shape)
        mesh = shape.mesh(share * float((grids.high - grids.low).max()))
        number = grids.as_near(grids.error(mesh.points, mesh.triangles), contour)

        def work() -> Any:
            return contour(*grids.values(number))

        return work

    return prepare
