"""How far a surface is from the bilinear interpolants of cells' corners: bounds for exact surfaces, samples for others.

Bounds hold with rounding counted in: `slack` is what the coefficients of P - B may be off by, over the least weight.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.lengths import lengths
from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.bernstein.boxes import product
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.limits import checkpoint
from pas.mesh.rows import Integers
from pas.parametric.maps import ParametricMap
from pas.parametric.nets import SMALLEST, Framed, Nets, bernstein_at
from pas.parametric.tiling import GRID, Placing

PRODUCT = 32 * UNIT_ROUNDOFF
"""Relative error of a coefficient of a product of nets by bilinear ones: some 20 operations."""


@dataclass(frozen=True)
class CellErrors:
    """What was seen of C cells: P - B (C, a, b, 3), first and last rows on the sides, and corners (C, 2, 2, 3).

    `slack` (C,) is what rounding may add to |P - B|, `least` the part of it that no halving takes away.
    """

    errors: Floats
    corners: Floats
    slack: Floats
    least: Floats

    @property
    def bounds_and_axes(self) -> tuple[Floats, Integers]:
        """The bound 2 e + q/4 of each cell, infinite where there is none, and the axis across which to halve it."""
        away = lengths(self.errors)
        corners = self.corners
        twist = lengths(corners[:, 0, 0] - corners[:, 0, 1] - corners[:, 1, 0] + corners[:, 1, 1])
        largest = away.max(axis=(1, 2))
        bounds = 2 * (largest + self.slack) + twist / 4
        along_t, along_h = away[:, :, [0, -1]].max(axis=(1, 2)), away[:, [0, -1]].max(axis=(1, 2))
        sides = [lengths(np.diff(corners, axis=axis)).sum(axis=(1, 2)) for axis in (1, 2)]
        clear = np.maximum(along_t, along_h) > np.maximum(largest / 2, twist / 8)
        wider = np.where(clear, along_t < along_h, sides[0] < sides[1])
        return np.where(np.isfinite(bounds), bounds, np.inf), wider.astype(np.intp)


Examination = Callable[[Any, Integers], CellErrors]
"""From nets (None where there are none) and cells."""


def bounded(nets: Nets, _: Integers) -> CellErrors:
    """Of exact surfaces: coefficients of P - B over the least weight, infinite where that is not positive."""
    points, weights = nets.table[..., :3], nets.table[..., 3:]
    with np.errstate(all="ignore"):
        corners = points[:, [0, 0, -1, -1], [0, -1, 0, -1]] / weights[:, [0, 0, -1, -1], [0, -1, 0, -1]]
        corners = corners.reshape(-1, 2, 2, 3)
        errors = product(points, np.ones((1, 2, 2, 1))) - product(weights, corners)
        least = weights.min(axis=(1, 2, 3)) - nets.off
        positive = least > 0
        least = np.where(positive, least, 1.0)
        far = 1.0 + np.abs(corners).max(axis=(1, 2, 3))
        greatest = np.abs(nets.table).max(axis=(1, 2, 3))
        slack = 2 * far * (nets.off + PRODUCT * greatest) / least  # 2 > sqrt(3) coordinates
        errors = np.where(positive[:, None, None, None], errors / least[:, None, None, None], np.inf)
        floor = 2 * nets.off / weights.max(axis=(1, 2, 3))
    return CellErrors(errors, corners, np.where(positive, slack, np.inf), np.where(positive, floor, 0.0))


def measured(surface: ParametricMap) -> Examination:
    """Of other surfaces over the unit square: P - B at 5 x 5 points of each cell, and a tenth more.

    Of a parabola these may miss a sixteenth.
    """
    share = np.linspace(0.0, 1.0, 5)

    def examine(_: None, cells: Integers) -> CellErrors:
        places = cells / GRID
        t, h = (places[:, i, None] * (1 - share) + places[:, i + 1, None] * share for i in (0, 2))
        points = np.stack(np.broadcast_arrays(t[:, :, None], h[:, None, :]), axis=-1)
        values = surface(np.clip(points, 0.0, 1.0))
        corners = values[:, [0, 0, -1, -1], [0, -1, 0, -1]].reshape(-1, 2, 2, 3)
        hats = np.stack([1 - share, share])
        errors = values - np.einsum("ia,jb,cijx->cabx", hats, hats, corners)
        none = np.zeros(len(cells))
        return CellErrors(np.where(np.isfinite(errors), 1.1 * errors, np.inf), np.nan_to_num(corners), none, none)

    return examine


def surface_points(surface: ParametricMap) -> Placing:
    """Points of a surface over the unit square as it is evaluated."""
    return lambda places: (surface(places / GRID), np.zeros(len(places)))


@dataclass(frozen=True)
class NetPoints:
    """Points of an exact surface at parameters of its frame that are multiples of 1 / GRID, and bounds on their errors.

    A Bernstein sum of degrees (m, n) errs by (2 m + 2 n + 24) 2^-53 of the same sum of absolute values at most, 24
    being the operations that do not grow with the degrees (Higham 2002, section 3.1).  Where that is more than
    `allowed` the point is worked out exactly.
    """

    framed: Framed
    table: Floats
    allowed: float

    def __call__(self, places: Integers) -> tuple[Floats, Floats]:
        """Points (N, 3) at places (N, 2) on the grid, and what they may be off by (N,)."""
        points, off = np.empty((len(places), 3)), np.empty(len(places))
        step = 1 << 13
        for start in range(0, len(places), step):
            checkpoint("placing the vertices of a mesh", start / len(places))
            rows = slice(start, start + step)
            points[rows], off[rows] = self._summed(places[rows] / GRID)
        for number in np.flatnonzero(~(off <= self.allowed)):
            checkpoint("placing vertices exactly")
            points[number] = self._exact(places[number])
            off[number] = 2 * UNIT_ROUNDOFF * (1 + np.abs(points[number]).max())
        return points, off

    def _summed(self, shares: Floats) -> tuple[Floats, Floats]:
        bases = [bernstein_at(size - 1, shares[:, axis]) for axis, size in enumerate(self.table.shape[:2])]
        m, n = (size - 1 for size in self.table.shape[:2])
        four, most = (
            np.einsum("nj,njx->nx", bases[1], np.tensordot(bases[0], table, 1))
            for table in (self.table, np.abs(self.table))
        )
        error = (2 * m + 2 * n + 24) * UNIT_ROUNDOFF * most + SMALLEST
        with np.errstate(all="ignore"):
            points = four[:, :3] / four[:, 3:]
            least = four[:, 3] - error[:, 3]
            far = np.abs(points).max(axis=1)
            off = 2 * (error[:, :3].max(axis=1) + error[:, 3] * far) / least + UNIT_ROUNDOFF * far
        return points, np.where(least > 0, off, np.inf)

    def _exact(self, place: Integers) -> list[float]:
        at = self.framed.exact_parameters([fmpq(int(k), GRID) for k in place])
        return [
            to_float(c.numerator(*at) / c.denominator(*at) / self.framed.unit) for c in self.framed.bounded.components
        ]
