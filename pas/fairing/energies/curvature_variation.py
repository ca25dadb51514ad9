"""Curvature variation of a surface, with a gauge and tension.

    E = r^2 * integral |grad S|^2 dA  +  gauge / r^2 * integral ln^2 |grad f| dA  +  tension / l^2 * integral dA
        +  sum over runs of straight / R^4 * integral w d^2 dA

S is the shape operator, r the mean radius of the contact curves, l their mean distance from the centre, |grad f| is
over its mean on the contact curves.  The first term is the full variation of curvature (Moreton and Sequin 1992 take
two of its components).  A surface is the zero set of many functions: the gauge prefers the one like a
distance.  Tension keeps balloons away, which have no variation of curvature.  Where contacts continue one another in a
straight line, the surface's distance d from the tube of radius R between them is kept small (see
`pas.surface.straight_runs`): the least variation of curvature alone pinches the tube opposite to a branch.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from flint import fmpq

from pas.algebra.rational import Exact, amount, rational, to_float
from pas.arrays import Floats
from pas.fairing.energy import QUANTITIES, STEP, Energy, Sizes, SurfacePoints, slopes_by_place
from pas.surface.straight_runs import guided

TIMES = np.sqrt([1.0, 3.0, 3.0, 1.0])
"""The roots of how often each of C111, C112, C122, C222 stands in the symmetric tensor grad S."""

TENSION = fmpq(23, 5)
"""Measured: thin pipes on long clips keep their arcs, and equal pipes bulge least."""

STRAIGHT = fmpq(10000)
"""Measured: waists of T junctions fall from .19 to .01 of the radius at the same degrees; 1000 leaves .035."""


@dataclass(frozen=True)
class CurvatureVariation(Energy):
    """The variation of a surface's curvature, which is least where it bends evenly (Moreton and Sequin 1992).

    `tension` (no unit, >= 0) is the weight of the surface's area: 0 is full, large is slim.  `gauge` (no unit, >= 0)
    keeps |grad f| even on the surface.  `straight` (no unit, >= 0) keeps straight what runs straight through a node:
    0 lets it go.  Raises `ValueError` for negative numbers.
    """

    kind: ClassVar[str] = "curvature-variation"

    tension: Exact = TENSION
    gauge: Exact = fmpq(1)
    straight: Exact = STRAIGHT

    def __post_init__(self) -> None:
        for name in ("tension", "gauge", "straight"):
            object.__setattr__(self, name, amount(getattr(self, name), name))

    def residuals(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        tension, gauge = self._roots(sizes)
        bent = sizes.radius * TIMES * points.variation
        gauged = gauge * np.log(points.gradients)
        stretched = np.full((len(points), 1), tension)
        return np.concatenate([bent, gauged[:, None], stretched, self._off_runs(points.points, sizes)], axis=1)

    def slopes(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        slopes = np.zeros((len(points), 6 + len(sizes.runs), QUANTITIES))
        for i in range(4):
            slopes[:, i, 10 + i] = sizes.radius * TIMES[i]
        slopes[:, 4, 6] = self._roots(sizes)[1] / points.gradients
        if sizes.runs:
            step = STEP * sizes.radius
            slopes[:, 6:, :3] = slopes_by_place(lambda moved: self._off_runs(moved, sizes), points.points, step)
        return slopes

    def _off_runs(self, points: Floats, sizes: Sizes) -> Floats:
        """The residuals of the distances from the runs (N, number of runs)."""
        root = float(np.sqrt(to_float(rational(self.straight, "straight"))))
        if not sizes.runs:
            return np.empty((len(points), 0))
        distances, shares = guided(sizes.runs, points - sizes.center)
        return root * distances * np.sqrt(shares) / np.array([run.radius**2 for run in sizes.runs])

    def _roots(self, sizes: Sizes) -> tuple[float, float]:
        tension, gauge = to_float(rational(self.tension, "tension")), to_float(rational(self.gauge, "gauge"))
        return float(np.sqrt(tension)) / sizes.clip, float(np.sqrt(gauge)) / sizes.radius
