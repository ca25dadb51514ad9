"""Values, gradients and curvatures of the pieces of a surface at many points, in local coordinates.

Values of one piece at many points are one product of matrices for each block of points.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from pas.algebra.monomials import Floats, monomial_values
from pas.algebra.rational import to_fraction
from pas.limits import checkpoint
from pas.mesh.field import Integers
from pas.surface.geometry import JETS, derived

if TYPE_CHECKING:
    from pas.surface.piecewise import PiecewiseSurface

BLOCK = 2048
"""Points whose monomials are held at once: they stay in the second level cache up to degree 8."""

CLOSING, CLOSE = 6, 1e-11
"""Steps along gradients, for points very near the surface, and the last that is worth another."""

BENDS = sum(1 for e in JETS if sum(e) <= 2)
"""Entries of a jet up to second derivatives."""


class PatchField(ABC):
    """The function of a piecewise surface; how a point's piece is found is left to those who know."""

    def __init__(self, surface: PiecewiseSurface) -> None:
        local, self.degree = surface.local, max(surface.degree, 1)
        self.frame = surface.partition.frame
        self.scale = float(to_fraction(self.frame.scale))
        self.reach = float(np.sqrt((local.points**2).sum(axis=1).max()))
        self._columns = np.array([p.dense(self.degree) for p in surface.patches])
        self._jets = np.array([derived(column, self.degree)[:BENDS] for column in self._columns])

    @abstractmethod
    def pieces(self, points: Floats) -> Integers:
        """The numbers of the pieces (N,) that hold points (N, 3)."""

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""
        return self.frame.global_points(points)

    def _products(self, tables: Floats, points: Floats, pieces: Integers) -> Floats:
        """The tables (pieces, m, C(n+3, 3)) times the monomials at points of given pieces: (m, N)."""
        result = np.empty((tables.shape[1], len(points)))
        order = np.argsort(pieces, kind="stable")
        sizes = np.bincount(pieces, minlength=len(tables))
        ends = np.cumsum(sizes)
        ordered = points[order]
        sorted_result = np.empty_like(result)
        for start in range(0, len(points), BLOCK):
            checkpoint()
            stop = min(start + BLOCK, len(points))
            monomials = monomial_values(ordered[start:stop], self.degree)
            for piece in range(int(np.searchsorted(ends, start, side="right")), len(tables)):
                low, high = max(int(ends[piece] - sizes[piece]), start), min(int(ends[piece]), stop)
                if low >= stop:
                    break
                if high > low:
                    sorted_result[:, low:high] = tables[piece] @ monomials[:, low - start : high - start]
        result[:, order] = sorted_result
        return result

    def values(self, points: Floats) -> Floats:
        """The values (N,) at points (N, 3)."""
        return self._products(self._jets[:, :1], points, self.pieces(points))[0]

    def distances(self, points: Floats) -> Floats:
        """The distances |f| / |grad f| (N,) of points (N, 3), to first order."""
        jets = self._jets_at(points)
        return np.asarray(np.abs(jets[0]) / np.maximum(np.sqrt((jets[1:] * jets[1:]).sum(axis=0)), 1e-300))

    def gradients(self, points: Floats) -> Floats:
        """The gradients (N, 3) at points (N, 3)."""
        return self._products(self._jets[:, 1:4], points, self.pieces(points)).T

    def bending(self, points: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) and the larger of the principal curvatures' sizes (N,) at points on the surface."""
        jets = self._products(self._jets, points, self.pieces(points))
        g = jets[1:4]
        length = np.maximum(np.sqrt((g * g).sum(axis=0)), 1e-300)
        n = g / length
        rows = {e: jets[i] for i, e in enumerate(JETS[:BENDS])}
        h = [[rows[tuple(int(k == i) + int(k == j) for k in range(3))] / length for j in range(3)] for i in range(3)]
        hn = [sum(h[i][j] * n[j] for j in range(3)) for i in range(3)]
        nhn = sum(n[i] * hn[i] for i in range(3))
        trace = h[0][0] + h[1][1] + h[2][2] - nhn
        square = sum(h[i][j] ** 2 for i in range(3) for j in range(3)) - 2 * sum(v * v for v in hn) + nhn**2
        # k1 + k2 and k1^2 + k2^2 give the larger size
        apart = np.sqrt(np.maximum(2 * square - trace**2, 0.0))
        return g.T, np.asarray((np.abs(trace) + apart) / 2)

    def closed(self, points: Floats) -> tuple[Floats, Floats]:
        """Points (N, 3) very near the surface moved onto it along gradients, and the gradients (N, 3) there."""
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
        return self._products(self._jets[:, :4], points, self.pieces(points))
