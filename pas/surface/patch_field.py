"""Values, gradients and curvatures of the pieces of a surface at many points, in local coordinates."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_fraction
from pas.algebra.tables import PieceTables
from pas.mesh.field import Integers
from pas.mesh.rows import dots
from pas.surface.function import PiecewisePolynomial
from pas.surface.geometry import JETS, derived
from pas.surface.kernels import Faces, compiled

CLOSING, CLOSE = 6, 1e-11
"""Steps along gradients, for points very near the surface, and the last that is worth another."""

LEFT = 0.1
"""Share of a step along the gradient that the next one would have, above which points are not near the surface."""

INSIDE = 1e-11
"""How far outside the region a point may be by rounding: in local units, barycentric coordinates, or over the way to
where its ray leaves."""


BENDS = sum(1 for e in JETS if sum(e) <= 2)
"""Entries of a jet up to second derivatives."""


class PatchField(ABC):
    """The function of a piecewise surface, scaled; how a point's piece is found is left to those who know.

    Compiled code serves where the piece is known by the outer face that a ray leaves through, or is the only one (see
    `outer`); where points are located in cells, numpy does the same, to the bit.
    """

    def __init__(self, surface: PiecewisePolynomial) -> None:
        local, self.degree = surface.local, max(surface.degree, 1)
        self.frame = surface.partition.frame
        self.scale = float(to_fraction(self.frame.scale))
        self.reach = float(np.sqrt((local.points**2).sum(axis=1).max()))
        self._columns = np.array([p.dense(self.degree) for p in surface.scaled.polynomials])
        jets = np.array([derived(column, self.degree)[:BENDS] for column in self._columns])
        self._bends = PieceTables(jets, tuple(max(self.degree - sum(e), 0) for e in JETS[:BENDS]))
        self._jets, self._value = self._bends.first(4), self._bends.first(1)

    outer: Faces | None = None
    """By which compiled code finds pieces; None where these are those of cells in which points must be located."""

    @abstractmethod
    def pieces(self, points: Floats) -> Integers:
        """The numbers of the pieces (N,) that hold points (N, 3)."""

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""
        return self.frame.global_points(points)

    def values(self, points: Floats) -> Floats:
        """The values (N,) at points (N, 3)."""
        return self._value(points, self.pieces(points))[0]

    def distances(self, points: Floats) -> Floats:
        """The distances |f| / |grad f| (N,) of points (N, 3), to first order."""
        if self.outer is not None:
            return compiled().distances(self.outer, self._jets.ordered, points)
        jets = self._jets_at(points)
        return np.asarray(np.abs(jets[0]) / np.maximum(np.sqrt((jets[1:] * jets[1:]).sum(axis=0)), 1e-300))

    def gradients(self, points: Floats) -> Floats:
        """The gradients (N, 3) at points (N, 3)."""
        return self._jets_at(points)[1:].T

    @abstractmethod
    def near(self, points: Floats) -> Floats:
        """Points (N, 3) of the surface near points inside or outside it."""

    def drawn(self, points: Floats, still: NDArray[np.bool_]) -> tuple[Floats, Floats, Floats]:
        """Points (N, 3) near the surface drawn towards it, but for those that are `still` (N,), and gradients and
        curvatures there.

        By a step along the gradient, or as `near` does where that leaves more than `LEFT` of the way.
        """
        moved, gradients, bends, lost = self._stepped(points, still)
        if lost.any():
            moved[lost] = self.near(points[lost])
            gradients[lost], bends[lost] = self.bending(moved[lost])
        return moved, gradients, bends

    def _stepped(self, points: Floats, still: NDArray[np.bool_]) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
        """Points moved by a step alone, gradients and curvatures there, and which points (N,) are not near."""
        if self.outer is not None:
            rows, limits = (self._jets.ordered, self._bends.ordered), (LEFT**2, CLOSE**2)
            return compiled().drawn(self.outer, rows, points, still, limits)
        jets = self._jets_at(points)
        g = jets[1:]
        way = -jets[0] / np.maximum(g[0] * g[0] + g[1] * g[1] + g[2] * g[2], 1e-300) * g
        moved = np.where(still[:, None], points, points + way.T)
        value, gradients, bends = self._bent(moved)
        square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2]
        lost = ~still & ~(value**2 <= (LEFT**2 * square + CLOSE**2) * dots(gradients, gradients))
        return moved, gradients, bends, lost

    def bending(self, points: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) and the larger of the principal curvatures' sizes (N,) at points on the surface."""
        return self._bent(points)[1:]

    def _bent(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Values (N,), gradients (N, 3) and the larger of the principal curvatures' sizes (N,)."""
        if self.outer is not None:
            return compiled().bent(self.outer, self._bends.ordered, points)
        f, gx, gy, gz, xx, xy, xz, yy, yz, zz = self._bends(points, self.pieces(points))
        length = np.maximum(np.sqrt(gx * gx + gy * gy + gz * gz), 1e-300)
        nx, ny, nz = gx / length, gy / length, gz / length
        x, y, z = xx * nx + xy * ny + xz * nz, xy * nx + yy * ny + yz * nz, xz * nx + yz * ny + zz * nz
        along = nx * x + ny * y + nz * z
        trace = xx + yy + zz - along
        square = xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz)
        square += along * along - 2 * (x * x + y * y + z * z)
        # k1 + k2 and k1^2 + k2^2, times the length, give the larger size
        apart = np.sqrt(np.maximum(2 * square - trace * trace, 0.0))
        return f, np.stack([gx, gy, gz], axis=1), np.asarray((np.abs(trace) + apart) / (2 * length))

    def closed(self, points: Floats) -> tuple[Floats, Floats]:
        """Points (N, 3) very near the surface moved onto it along gradients, and the gradients (N, 3) there."""
        if self.outer is not None:
            return compiled().closed(self.outer, self._jets.ordered, points, (CLOSING, CLOSE))
        points = points.copy()
        gradients = np.empty_like(points)
        rows = np.arange(len(points))
        for _ in range(CLOSING):
            jets = self._jets_at(points[rows])
            g = jets[1:]
            step = -jets[0] * g / np.maximum((g * g).sum(axis=0), 1e-300)
            points[rows] += step.T
            gradients[rows] = g.T
            rows = rows[np.abs(step).max(axis=0, initial=0.0) > CLOSE]
            if not len(rows):
                break
        return points, gradients

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) at points (N, 3)."""
        return self._jets_at(points).T

    def _jets_at(self, points: Floats) -> Floats:
        """Values and gradients (4, N) at points (N, 3)."""
        return self._jets(points, self.pieces(points))
