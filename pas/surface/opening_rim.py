"""The closed curve through which a region is open: where a surface cuts the nappe of a cone with its apex in 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.contacts.cones import first_met, nappe_rays
from pas.mesh.rows import dots

STEPS = 40
"""Of Newton's method along rays, none by more than a factor of two."""

SETTLED = 1e-9
"""Change of the share of a way that ends that: the next is about its square."""

AROUND = 64
"""Rays on which the middle is found."""


@dataclass(frozen=True, eq=False)
class OpeningRim:
    """The curve on `surface` along the nappe with the axes (3, 3) of `pas.contacts.cones.nappe`, of the cone `clip`.

    In the plane of a plate or in none, it is a graph over the angle about the axis.
    """

    surface: Polynomial
    clip: Polynomial
    axes: Floats
    fixed: ClassVar[bool] = False
    opening: ClassVar[bool] = True

    @cached_property
    def normal(self) -> Floats:
        """The unit vector (3,) along the axis, outwards."""
        return np.asarray(self.axes[0] / np.sqrt(self.axes[0] @ self.axes[0]))

    @cached_property
    def middle(self) -> Floats:
        """The point (3,) of the axis in the middle of the curve's height."""
        return np.asarray(float((self.round(AROUND) @ self.normal).mean()) * self.normal)

    def round(self, number: int) -> Floats:
        """So many points (N, 3) in turn; raises `ArithmeticError` where rays do not meet the surface."""
        rays = nappe_rays(self.axes, number)
        met = first_met(self.surface, rays)
        if not np.isfinite(met).all():
            raise ArithmeticError("the cone around an opening leaves its surface")
        return np.asarray(rays * met[:, None])

    def at(self, points: Floats) -> Floats:
        """Where the rays of the nappe at the angles of points (N, 3) meet the surface, found from there."""
        across = np.linalg.solve(self.axes.T, points.T)[1:]
        across = across / np.maximum(np.sqrt((across * across).sum(axis=0)), 1e-300)
        rays = self.axes[0] + across.T @ self.axes[1:]
        share = dots(points, rays) / dots(rays, rays)
        rows = np.arange(len(rays))
        for _ in range(STEPS):
            here = rays[rows] * share[rows, None]
            slope = dots(self.surface.gradient(here), rays[rows])
            with np.errstate(all="ignore"):
                step = share[rows] - self.surface(here) / slope
            step = np.where(slope > 0, np.clip(step, share[rows] / 2, share[rows] * 2), share[rows] * 2)
            moving = ~(np.abs(step - share[rows]) < SETTLED * step)
            share[rows] = step
            rows = rows[moving]
            if not len(rows):
                break
        return np.asarray(rays * share[:, None])

    def distances(self, points: Floats) -> Floats:
        """Distances (N,) of points from those of the curve at the same angles."""
        away = self.at(points) - points
        return np.asarray(np.sqrt(dots(away, away)))

    def off(self, points: Floats) -> Floats:
        """How far points (N, 3) are from the surface and the cone, to first order."""
        total = np.zeros(len(points))
        for p in (self.surface, self.clip):
            slope = p.gradient(points)
            total += np.abs(p(points)) / np.maximum(np.sqrt(dots(slope, slope)), 1e-300)
        return total

    def inside(self, units: Floats) -> np.ndarray:
        """Which rays (N, 3) from 0 pass through the curve."""
        return np.asarray((self.clip(units) <= 0) & (units @ self.normal > 0))
