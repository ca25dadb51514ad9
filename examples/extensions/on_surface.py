"""Energies of one's own that see the surface: its mean curvature, its area, its distance from a guide.

Each gives residuals at points of the surface, whose squares are integrated over it.  Their derivatives are taken by
differences; `MeanCurvature` shows how a class gives its own.  They are meant to go with the usual energy:
`pas.blend(pipes, order=2, energy=pas.CurvatureVariation() + MeanCurvature(wish=1) / 10)`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

import numpy as np

import pas


@pas.register_energy
@dataclass(frozen=True)
class MeanCurvature(pas.Energy):
    """`r^2 * integral of (H - wish)^2`, H the mean curvature, `wish` in 1 / unit of length."""

    kind: ClassVar[str] = "mean-curvature"

    wish: Any = 0

    def __post_init__(self) -> None:
        """What files and users write becomes exact."""
        object.__setattr__(self, "wish", Fraction(self.wish))

    def residuals(self, points: pas.SurfacePoints, sizes: pas.Sizes) -> Any:
        """One residual a point: (N, 1)."""
        return sizes.radius * (points.mean_curvatures - float(self.wish))[:, None]

    def slopes(self, points: pas.SurfacePoints, sizes: pas.Sizes) -> Any:
        """Its derivatives by the 14 quantities of a point, of which 7 and 9 are S11 and S22: (N, 1, 14)."""
        slopes = np.zeros((len(points), 1, 14))
        slopes[:, 0, [7, 9]] = sizes.radius / 2
        return slopes


@pas.register_energy
@dataclass(frozen=True)
class Area(pas.Energy):
    """The area over the square of the mean radius: another tension."""

    kind: ClassVar[str] = "area"

    def residuals(self, points: pas.SurfacePoints, sizes: pas.Sizes) -> Any:
        """The same at every point: (N, 1)."""
        return np.full((len(points), 1), 1 / sizes.radius)


@pas.register_energy
@dataclass(frozen=True)
class NearSphere(pas.Energy):
    """`1 / r^4 * integral of d^2`, d the distance of the surface from a sphere: a guide of which there is a formula."""

    kind: ClassVar[str] = "near-sphere"

    x: Any = 0
    y: Any = 0
    z: Any = 0
    radius: Any = 1

    def __post_init__(self) -> None:
        """What files and users write becomes exact."""
        for name in ("x", "y", "z", "radius"):
            object.__setattr__(self, name, Fraction(getattr(self, name)))

    def residuals(self, points: pas.SurfacePoints, sizes: pas.Sizes) -> Any:
        """The signed distance: (N, 1)."""
        center = np.array([float(self.x), float(self.y), float(self.z)])
        distance = np.linalg.norm(points.points - center, axis=1) - float(self.radius)
        return distance[:, None] / sizes.radius**2
