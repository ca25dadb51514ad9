"""What an energy sees of a surface: its differential geometry at sample points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pas.algebra.monomials import Floats
from pas.surface.straight_runs import StraightRun

QUANTITIES = 14
"""Numbers that `SurfacePoints.quantities` has for each point."""

NAMES = ("points",) * 3 + ("normals",) * 3 + ("gradients",) + ("shape",) * 3 + ("variation",) * 4
"""The array that each quantity belongs to."""


@dataclass(frozen=True, eq=False, repr=False)
class SurfacePoints:
    """The geometry of a surface f = 0 at N points, in the user's units.

    `points` and `normals` (N, 3), which point outwards; `gradients` (N,): |grad f| over its mean on the contact curves;
    `shape` (N, 3): S11, S12, S22 of the shape operator, positive where the surface bends like a ball around
    its inside, in the `frame` (N, 3, 2) of principal directions, the larger curvature first, so that S12 is 0 and
    S11, S22 are the principal curvatures; `variation` (N, 4): C111, C112, C122, C222 of its covariant derivative.

    The sum of squares of what an energy makes of them must not change with a turn of the frame, as that of
    C111, sqrt(3) C112, sqrt(3) C122, C222 does not.
    """

    points: Floats
    normals: Floats
    gradients: Floats
    shape: Floats
    variation: Floats
    frame: Floats

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        return f"<SurfacePoints: {len(self)} points>"

    @property
    def mean_curvatures(self) -> Floats:
        """The mean of the principal curvatures (N,)."""
        return (self.shape[:, 0] + self.shape[:, 2]) / 2

    @property
    def gauss_curvatures(self) -> Floats:
        """The product of the principal curvatures (N,)."""
        return self.shape[:, 0] * self.shape[:, 2] - self.shape[:, 1] ** 2

    @cached_property
    def quantities(self) -> Floats:
        """Points, normals, gradients, shape and variation side by side (N, 14)."""
        return np.concatenate([self.points, self.normals, self.gradients[:, None], self.shape, self.variation], axis=1)

    def with_quantities(self, quantities: Floats) -> SurfacePoints:
        """These points with other quantities (N, 14), in the same frame."""
        q = quantities
        return replace(
            self, points=q[:, :3], normals=q[:, 3:6], gradients=q[:, 6], shape=q[:, 7:10], variation=q[:, 10:14]
        )

    def __getitem__(self, chosen: slice) -> SurfacePoints:
        return replace(self, **{name: value[chosen] for name, value in self.arrays().items()})

    def arrays(self) -> dict[str, Floats]:
        """The arrays by their names."""
        names = ("points", "normals", "gradients", "shape", "variation", "frame")
        return {name: getattr(self, name) for name in names}


@dataclass(frozen=True, eq=False)
class Sizes:
    """Lengths of a problem, in the user's units.

    `radius`: the mean radius of the contact curves; `clip`: the mean distance of their middles from the centre;
    `center` (3,): the centre; `runs`: the straight tubes between contacts in line, relative to it.
    """

    radius: float
    clip: float
    center: Floats = field(default_factory=lambda: np.zeros(3))
    runs: tuple[StraightRun, ...] = ()


STEP = 1e-6
"""Of differences, over the largest value of the quantity: half of the digits."""


def differences(residuals: Callable[[SurfacePoints], Floats], points: SurfacePoints) -> Floats:
    """The derivatives (N, R, 14) of residuals (N, R) by the quantities, by central differences."""
    start = points.quantities
    sizes = np.abs(start).max(axis=0, initial=0.0)
    columns = []
    for i in range(QUANTITIES):
        step = STEP * (float(sizes[i]) or float(sizes[7:].max(initial=0.0)) or 1.0)
        found = []
        for sign in (1.0, -1.0):
            moved = start.copy()
            moved[:, i] += sign * step
            found.append(residuals(points.with_quantities(moved)))
        columns.append((found[0] - found[1]) / (2 * step))
    return np.stack(columns, axis=2)
