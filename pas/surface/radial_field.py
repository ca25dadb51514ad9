"""A piecewise surface as a graph over directions: where rays from the centre meet it, and the curves it ends on.

The piece of a ray is that of the outer face it leaves the region through, so no point is ever located in a cell.
Values of one piece at many points are one product of matrices for each block of points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pas.algebra.monomials import Floats, exponents, monomial_values
from pas.algebra.rational import to_fraction
from pas.limits import checkpoint
from pas.mesh.field import Integers
from pas.surface.geometry import JETS, derived
from pas.surface.rings import Ring, rings_of

if TYPE_CHECKING:
    from pas.surface.piecewise import PiecewiseSurface

BLOCK = 2048
"""Points whose monomials are held at once: they stay in the second level cache up to degree 8."""

STEPS = 60
"""Along a ray at most: Newton's, each kept between the ends of a bracket that holds the root, else halved."""

SETTLED = 2e-15
"""Change of the share of a ray's length that ends the search."""

OUTWARDS = 1.5
"""The furthest step outwards along a ray of the skeleton, over the distance from it."""

STEEP = 0.4
"""Cosine between the surface's normal and a ray from the centre below which one from the skeleton is taken."""

AWAY = 10.0
"""How far, over the distance from the skeleton, such rays are followed at most."""

CLOSING, CLOSE = 6, 1e-11
"""Steps along gradients, for points very near the surface, and the last that is worth another."""

BENDS = sum(1 for e in JETS if sum(e) <= 2)
"""Entries of a jet up to second derivatives."""

SAMPLES = 32
"""Places along a ray where the sign of f is looked at."""


class RadialField:
    """A surface of one sheet around the centre of its partition, in local coordinates with the centre 0."""

    def __init__(self, surface: PiecewiseSurface) -> None:
        local, self.degree = surface.local, max(surface.degree, 1)
        self.frame = surface.partition.frame
        self.scale = float(to_fraction(self.frame.scale))
        self.reach = float(np.sqrt((local.points**2).sum(axis=1).max()))
        columns = np.array([p.dense(self.degree) for p in surface.patches])
        self._jets = np.array([derived(column, self.degree)[:BENDS] for column in columns])
        degrees = np.array([sum(e) for e in exponents(self.degree)])
        self._parts = np.equal.outer(np.arange(self.degree + 1), degrees) * columns[:, None]
        corners = np.array([local.points[list(face.vertices)] for face in local.outer_faces])
        self._weights = np.linalg.inv(corners.transpose(0, 2, 1))
        self._piece = np.array([face.piece for face in local.outer_faces], dtype=np.intp)
        self.rings: list[Ring] = rings_of(surface)

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""
        return self.frame.global_points(points)

    def leaving(self, points: Floats) -> tuple[Floats, Integers]:
        """The multiples (N,) of points (N, 3) at which their rays leave the region, and the pieces (N,)."""
        total, piece = np.empty(len(points)), np.empty(len(points), dtype=np.intp)
        flat = self._weights.reshape(-1, 3)
        for start in range(0, len(points), BLOCK):
            here = slice(start, start + BLOCK)
            weights = (flat @ points[here].T).reshape(-1, 3, len(points[here]))
            face = weights.min(axis=1).argmax(axis=0)
            total[here] = weights.sum(axis=1)[face, np.arange(len(face))]
            piece[here] = self._piece[face]
        return 1.0 / total, piece

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
        return self._products(self._jets[:, :1], points, self.leaving(points)[1])[0]

    def distances(self, points: Floats) -> Floats:
        """The distances |f| / |grad f| (N,) of points (N, 3), to first order."""
        jets = self._jets_at(points)
        return np.asarray(np.abs(jets[0]) / np.maximum(np.sqrt((jets[1:] * jets[1:]).sum(axis=0)), 1e-300))

    def gradients(self, points: Floats) -> Floats:
        """The gradients (N, 3) at points (N, 3)."""
        return self._products(self._jets[:, 1:4], points, self.leaving(points)[1]).T

    def bending(self, points: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) and the larger of the principal curvatures' sizes (N,) at points on the surface."""
        jets = self._products(self._jets, points, self.leaving(points)[1])
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

    def profiles(self, points: Floats) -> tuple[Floats, Floats]:
        """Coefficients (n + 1, N) of f along the rays to points, in multiples of these, and where they leave (N,)."""
        leave, pieces = self.leaving(points)
        return self._products(self._parts, points, pieces), leave

    def met(self, points: Floats) -> Floats:
        """Where the rays through points (N, 3) meet the surface, found from there."""
        profiles, leave = self.profiles(points)
        low, high = np.zeros(len(points)), leave.copy()
        share = np.minimum(1.0, 0.5 * (low + high) + 0.5 * (high > 1.0))
        result, rows = share.copy(), np.arange(len(points))
        for _ in range(STEPS):
            value, slope = _with_slope(profiles, share)
            below = value < 0
            low, high = np.where(below, share, low), np.where(below, high, share)
            with np.errstate(all="ignore"):
                step = share - value / slope
            step = np.where((step >= low) & (step <= high) & (slope > 0), step, (low + high) / 2)
            result[rows] = step
            moving = np.abs(step - share) > SETTLED * step
            if not moving.any():
                break
            rows, share = rows[moving], step[moving]
            low, high, profiles = low[moving], high[moving], profiles[:, moving]
        return points * result[:, None]

    def near(self, points: Floats) -> Floats:
        """The surface's points (N, 3) on the rays through points, from the skeleton where those from 0 graze it."""
        found = self.met(points)
        g = self._jets_at(found)[1:]
        square = (found * found).sum(axis=1) * (g * g).sum(axis=0)
        steep = np.flatnonzero(~((found * g.T).sum(axis=1) > STEEP * np.sqrt(square)))
        found[steep] = self._around(points[steep], found[steep])
        return found

    def _around(self, points: Floats, otherwise: Floats) -> Floats:
        """Where the rays to points (N, 3) from the nearest points of the skeleton meet the surface, found from there.

        The skeleton joins the centre with the middle of each ring: all of it is inside a surface of one sheet, and near
        a ring such rays stay in the region, however thin the surface is there.  Points that they do not meet nearby are
        those given `otherwise`.
        """
        foot = self._feet(points)
        way = way_ = points - foot
        low, high, share = np.zeros(len(points)), np.full(len(points), np.inf), np.ones(len(points))
        result, rows = share.copy(), np.arange(len(points))
        for _ in range(STEPS):
            jets = self._jets_at(foot + share[:, None] * way)
            value, slope = jets[0], (jets[1:].T * way).sum(axis=1)
            below = value < 0
            low, high = np.where(below, share, low), np.where(below, high, share)
            with np.errstate(all="ignore"):
                step = share - value / slope
            most = np.minimum(high, OUTWARDS * share)
            good = (step >= low) & (step <= most) & (slope > 0)
            step = np.where(good, step, np.where(np.isfinite(high), (low + high) / 2, most))
            result[rows] = step
            moving = np.abs(step - share) > SETTLED * step
            if not moving.any():
                break
            rows, share, low, high = rows[moving], step[moving], low[moving], high[moving]
            foot, way = foot[moving], way[moving]
        foot = self._feet(points)
        found = foot + result[:, None] * (points - foot)
        lost = ~(((found - points) ** 2).sum(axis=1) <= AWAY**2 * (way_ * way_).sum(axis=1))
        found[lost] = otherwise[lost]
        return np.asarray(found)

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

    def _jets_at(self, points: Floats) -> Floats:
        """Values and gradients (4, N) at points (N, 3)."""
        return self._products(self._jets[:, :4], points, self.leaving(points)[1])

    def _feet(self, points: Floats) -> Floats:
        """The nearest points (N, 3) of the skeleton."""
        best, least = np.zeros_like(points), (points * points).sum(axis=1)
        for ring in self.rings:
            along = np.clip(points @ ring.middle / (ring.middle @ ring.middle), 0.0, 1.0)
            foot = along[:, None] * ring.middle
            distance = ((points - foot) ** 2).sum(axis=1)
            nearer = distance < least
            best[nearer], least = foot[nearer], np.minimum(least, distance)
        return best

    def once(self, points: Floats) -> bool:
        """Whether f changes its sign once, from inside to outside, along all rays to points, as sampled."""
        profiles, leave = self.profiles(points)
        shares = np.linspace(0.0, 1.0, SAMPLES + 1)[:, None] * leave
        values = np.zeros_like(shares)
        for row in profiles[::-1]:
            values = values * shares + row
        inside = values < 0
        return bool(inside[0].all() and not inside[-1].any() and (inside[:-1] >= inside[1:]).all())


def _with_slope(profiles: Floats, share: Floats) -> tuple[Floats, Floats]:
    value, slope = profiles[-1], np.zeros(len(share))
    for row in profiles[-2::-1]:
        slope = slope * share + value
        value = value * share + row
    return value, slope
