"""The unevenness of the wall between a surface and one around it, as an energy.

    E = weight / r^2 * integral (s - 1)^2 + PRESS max(|s - 1| - NEAR, 0)^2 dA,    s = d / t,

over the inner surface; d is the depth of its points inside the outer one (see `pas.surface.depth`), t how thick the
wall is to be there, r the mean radius of the inner contacts.  The second term is a soft limit: with the first one alone
as large, walls would be evener than that at the cost of the limits of fairness.  It knows the outer surface, so that
files do not keep it: a hollow blend's inner side is kept with the energy that both sides have.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar, NoReturn

import numpy as np

from pas.arrays import Floats
from pas.fairing.energy import QUANTITIES, Energy, Sizes, SurfacePoints
from pas.surface.depth import Depth

WEIGHT = 100.0
"""Measured: with a tenth of it walls of crosses of GC^2 are 0.41 of what they should be at their thinnest, with this
0.64, and no inner side that was fair without it was not fair with it."""

NEAR, PRESS = 0.06, 2000.0
"""How far from 1 a wall's share of its thickness may be, softly, and the weight of the squares of what is beyond, over
that of all.  Measured: corners of a T and of a cross, which the limits of fairness round, have 0.89 and more of their
thickness.  With half of the weight a cross is no longer fair, with half as much again a T at 60 degrees is not."""


@dataclass(frozen=True, eq=False)
class Thickness:
    """How thick a wall is to be: `values` (M,) at `places` (M, 3), the middles of its ends, and between them a mean
    with the inverse squares of the distances for weights (Shepard 1968)."""

    places: Floats
    values: Floats

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """The thickness (N,) at points (N, 3), and its gradient (N, 3)."""
        if np.ptp(self.values) == 0:
            return np.full(len(points), self.values[0]), np.zeros_like(points)
        away = points[:, None] - self.places
        squares = (away * away).sum(axis=2)
        weights = 1 / squares
        total = weights.sum(axis=1)
        mean = weights @ self.values / total
        changes = -2 * away / (squares * squares)[:, :, None]
        return mean, ((self.values - mean[:, None])[:, :, None] * changes).sum(axis=1) / total[:, None]


@dataclass(frozen=True, eq=False)
class EvenWall(Energy):
    """The squared differences of a wall's thickness from what it is to be, over the inner surface."""

    kind: ClassVar[str] = "even-wall"

    depth: Depth
    thickness: Thickness
    weight: float = WEIGHT

    def shares(self, points: Floats) -> Floats:
        """The wall's thickness at points (N, 3) of the inner surface over what it is to be there (N,)."""
        return self.depth(points)[0] / self.thickness(points)[0]

    def residuals(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        off = self.shares(points.points) - 1
        beyond = sqrt(PRESS) * (off - np.clip(off, -NEAR, NEAR))
        return sqrt(self.weight) / sizes.radius * np.stack([off, beyond], axis=1)

    def slopes(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        depths, normals = self.depth(points.points)
        wanted, gradients = self.thickness(points.points)
        slopes = np.zeros((len(points), 2, QUANTITIES))
        by_place = -normals / wanted[:, None] - (depths / wanted**2)[:, None] * gradients
        beyond = sqrt(PRESS) * (np.abs(depths / wanted - 1) > NEAR)
        slopes[:, 0, :3] = sqrt(self.weight) / sizes.radius * by_place
        slopes[:, 1, :3] = beyond[:, None] * slopes[:, 0, :3]
        return slopes

    def to_record(self) -> NoReturn:
        """Raises `TypeError`: the outer surface is not written twice."""
        raise TypeError(f"the energy {self.kind!r} cannot be written; a hollow blend's inner side is without it")
