"""Charts as graphs of quintic splines over planes, fitted to the zeros of a polynomial.

Least squares on a grid over the chart's rectangle, whose heights Newton's method finds: a chart is on one smooth
function, which goes on beyond it, so that splines converge fast, and only coefficients that no point of the chart
depends on are held by nothing but their smoothness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import solveh_banded
from scipy.spatial import cKDTree

from pas.algebra.monomials import Floats
from pas.exchange.step.charts import Bools, Sheet
from pas.limits import checkpoint

DEGREE = 5

SIZES = (9, 14, 21, 31)
"""Coefficients a side that are tried; a chart that needs more is divided."""

SLOPE = 0.15
"""Cosine between a graph's plane and its surface below which the graph is too steep to be followed."""

HELD = 1e-12
"""What third differences of coefficients count, beside points: coefficients must be held by something."""


@dataclass(frozen=True, eq=False)
class Graph:
    """Heights over a plane: `frame` (3, 3) has the plane's axes and normal as rows, `origin` (3,) is on it.

    `knots` are those of the two directions, `heights` (m, m) the coefficients.  `distance` is the largest from the
    function's zeros, in local coordinates, and `angle` between the normals there, at many points of the chart.
    """

    origin: Floats
    frame: Floats
    knots: tuple[Floats, Floats]
    heights: Floats
    distance: float
    angle: float

    def uv(self, points: Floats) -> Floats:
        """The parameters (N, 2) of points (N, 3)."""
        return np.asarray((points - self.origin) @ self.frame[:2].T)

    @property
    def poles(self) -> Floats:
        """The control points (m, m, 3)."""
        u, v = (np.array([k[i + 1 : i + 1 + DEGREE].mean() for i in range(len(k) - DEGREE - 1)]) for k in self.knots)
        flat = np.stack([*np.meshgrid(u, v, indexing="ij"), self.heights], axis=-1)
        return np.asarray(self.origin + flat @ self.frame)


def fitted(sheet: Sheet, points: Floats, frame: Floats, tolerance: float, angle: float) -> Graph | None:
    """The graph through a chart with some points (N, 3) near it, within a distance and an angle; None where there is none."""
    origin = points.mean(axis=0)
    local = (points - origin) @ frame.T
    known, good = _heights(sheet, origin, frame, local[:, :2], local[:, 2])
    if not good.all():
        return None
    tree = cKDTree(local[:, :2])
    low, high = local[:, :2].min(axis=0), local[:, :2].max(axis=0)
    width = (high - low).max()
    low, high = low - 0.02 * width, high + 0.02 * width
    before = np.inf
    for size in SIZES:
        checkpoint()
        knots = [
            np.r_[[a] * DEGREE, np.linspace(a, b, size - DEGREE + 1), [b] * DEGREE]
            for a, b in zip(low, high, strict=True)
        ]
        step = float((high - low).max()) / (size - DEGREE)
        share = (np.arange(3 * (size - DEGREE)) + 0.5) / (3 * (size - DEGREE))
        places = [a + share * (b - a) for a, b in zip(low, high, strict=True)]
        grid = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).reshape(-1, 2)
        far, near = tree.query(grid)
        close = far < 2.5 * step
        weights, heights = np.zeros(len(grid)), np.zeros(len(grid))
        found, ok = _heights(sheet, origin, frame, grid[close], known[near[close]])
        weights[close] = ok / (1 + (far[close] / step) ** 4)
        heights[close] = np.where(ok, found, 0.0)
        coefficients = _least_squares(knots, places, heights, weights)
        graph = Graph(origin, frame, (knots[0], knots[1]), coefficients, np.inf, np.inf)
        distance, off = _errors(sheet, graph, local[:, :2])
        if distance <= tolerance and off <= angle:
            return Graph(origin, frame, (knots[0], knots[1]), coefficients, distance, off)
        worst = max(distance / tolerance, off / angle)
        if worst > before / 3:  # it does not converge
            return None
        before = worst
    return None


def _heights(sheet: Sheet, origin: Floats, frame: Floats, uv: Floats, start: Floats) -> tuple[Floats, Bools]:
    """Heights (N,) over a plane at parameters (N, 2) by Newton's method, and whether they are found, not too steep."""
    heights, base, normal = start.copy(), origin + uv @ frame[:2], frame[2]
    most = 0.1 * float(np.ptp(uv, axis=0).max(initial=0.0))
    rows, good = np.arange(len(uv)), np.zeros(len(uv), dtype=bool)
    for _ in range(12):
        jets = sheet.jets(base[rows] + heights[rows, None] * normal)
        slope, size = jets[:, 1:] @ normal, np.linalg.norm(jets[:, 1:], axis=1)
        steep = slope < SLOPE * size
        step = np.where(steep, 0.0, jets[:, 0] / np.where(steep, 1.0, slope))
        heights[rows] -= np.clip(step, -most, most)
        done = ~steep & (np.abs(step) < 1e-13)
        good[rows[done]] = True
        rows = rows[~(done | steep)]
        if not len(rows):
            break
    good[rows] = np.abs(step[~(done | steep)]) < 1e-9
    good &= np.abs(heights - start) < 5 * most
    return heights, good


def _least_squares(knots: list[Floats], places: list[Floats], heights: Floats, weights: Floats) -> Floats:
    """The coefficients (m, m) of a tensor spline with given weighted heights on a grid.

    The normal equations are put together of products in one direction each, and are banded.
    """
    size, band = len(knots[0]) - DEGREE - 1, DEGREE + 1
    u, v = (BSpline.design_matrix(p, k, DEGREE).toarray() for p, k in zip(places, knots, strict=True))
    w = weights.reshape(len(places[0]), -1)
    right = u.T @ (w * heights.reshape(w.shape)) @ v
    bands = np.zeros((size, size, band * 2 - 1, band * 2 - 1))  # by coefficient, and by the offsets of the other one
    pairs = [[np.zeros((len(p), size)) for _ in range(2 * band - 1)] for p in places]
    for b, pair in zip((u, v), pairs, strict=True):
        for offset in range(-band + 1, band):
            a, c = max(0, -offset), min(size, size - offset)
            pair[offset + band - 1][:, a:c] = b[:, a:c] * b[:, a + offset : c + offset]
    for i, one in enumerate(pairs[0]):
        half = one.T @ w
        for j, other in enumerate(pairs[1]):
            bands[:, :, i, j] = half @ other
    third = np.diff(np.eye(size), 3, axis=0)
    smooth, most = third.T @ third, float(weights.max()) * 9
    upper = np.zeros((size * (band - 1) + band, size * size))
    rows = np.arange(size * size)
    for i in range(2 * band - 1):
        for j in range(2 * band - 1):
            di, dj = i - band + 1, j - band + 1
            shift = di * size + dj
            if shift < 0:
                continue
            values = bands[:, :, i, j].copy()
            if dj == 0:
                values += HELD * most * _diagonal(smooth, di)[:, None]
            if di == 0:
                values += HELD * most * _diagonal(smooth, dj)[None, :]
            column = rows + shift
            inside = (np.arange(size)[None, :] + dj >= 0) & (np.arange(size)[None, :] + dj < size)
            inside = (inside & (np.arange(size)[:, None] + di < size)).ravel()
            upper[len(upper) - 1 - shift, column[inside]] += values.ravel()[inside]
    return np.asarray(solveh_banded(upper, right.ravel())).reshape(size, size)


def _diagonal(matrix: Floats, offset: int) -> Floats:
    """The entries (m,) beside the diagonal of a matrix (m, m), by rows, zero where there are none."""
    result = np.zeros(len(matrix))
    a, c = max(0, -offset), min(len(matrix), len(matrix) - offset)
    result[a:c] = np.diagonal(matrix, offset)
    return result


def _errors(sheet: Sheet, graph: Graph, uv: Floats) -> tuple[float, float]:
    """The largest distance of a graph's points from the zeros, to first order, and angle between the normals there."""
    values = []
    for orders in ((0, 0), (1, 0), (0, 1)):
        sides = [_spline(k, order) for k, order in zip(graph.knots, orders, strict=True)]
        u, v = (side(uv[:, i]) for i, side in enumerate(sides))
        values.append(np.einsum("ni,ij,nj->n", u, graph.heights, v, optimize=True))
    height, by_u, by_v = values
    jets = sheet.jets(graph.origin + np.c_[uv, height] @ graph.frame)
    size = np.linalg.norm(jets[:, 1:], axis=1)
    normals = np.stack([-by_u, -by_v, np.ones(len(uv))], axis=1) @ graph.frame
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    sines = np.linalg.norm(np.cross(normals, jets[:, 1:] / size[:, None]), axis=1)
    return float((np.abs(jets[:, 0]) / size).max()), float(sines.max())


def _spline(knots: Floats, order: int) -> BSpline:
    """All basis functions, or their derivatives."""
    basis = BSpline(knots, np.eye(len(knots) - DEGREE - 1), DEGREE)
    return basis.derivative(order) if order else basis
