"""Charts divided until each has parameters: those of its plane, quadric or torus, or a graph over a plane.

A graph is a quintic spline, fitted by least squares on a grid over the chart's rectangle, whose heights Newton's method
finds: a chart is on one smooth function, which goes on beyond it, so that splines converge fast, and only coefficients
on which no point of the chart depends are held by nothing but their smoothness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import solveh_banded
from scipy.spatial import cKDTree

from pas.algebra.affine import quadratic_form
from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.errors import GeometryError
from pas.exchange.step.borders import DEGREE
from pas.exchange.step.charts import Atlas, Bools, Integers, Plane, Sheet
from pas.exchange.step.parameters import CarrierParameters, QuadricPatch, carrier_parameters, quadric_patch
from pas.limits import checkpoint
from pas.mesh.field import place_of


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
    """The graph through a chart with points (N, 3) near it, within a distance and angle; None where there is none."""
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
    # Coefficients a side that are tried; a chart that needs more is divided.
    sizes = (9, 14, 21, 31)
    for size in sizes:
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
    # Cosine between a graph's plane and its surface below which the graph is too steep to be followed.
    least_slope = 0.15
    for _ in range(12):
        jets = sheet.jets(base[rows] + heights[rows, None] * normal)
        slope, size = jets[:, 1:] @ normal, np.linalg.norm(jets[:, 1:], axis=1)
        steep = slope < least_slope * size
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
    # Coefficients must be held by something beside points: third differences of them count a little.
    smooth, held = third.T @ third, 1e-12 * float(weights.max()) * 9
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
                values += held * _diagonal(smooth, di)[:, None]
            if di == 0:
                values += held * _diagonal(smooth, dj)[None, :]
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


Parameters = CarrierParameters | QuadricPatch | Graph


STEEP = 0.55
"""Cosine between a chart's mean normal and the others' below which it is divided before a graph is looked for."""

_CORNERS = np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4
_SAMPLES = 1.15 * (_CORNERS - 1 / 3) + 1 / 3
"""Barycentric coordinates of points in and a little beyond a triangle, for curved edges are beyond their chords."""


def divide(atlas: Atlas, tolerance: float, angle: float) -> dict[int, Parameters]:
    """The parameters of each chart, with graphs within a distance (local) and an angle; divides the atlas.

    Raises `GeometryError` where that takes too many charts.
    """
    found: dict[int, Parameters] = {}
    made: Parameters | Plane
    waiting = list(atlas.sheets)
    # A solid that needs more has a place at which nothing converges, such as a cusp.
    most_charts = 600
    while waiting:
        chart = waiting.pop()
        sheet, rows = atlas.sheets[chart], atlas.rows(chart)
        if sheet.carrier is not None:
            filled = np.einsum("sk,tkx->tsx", _CORNERS, atlas.points[atlas.triangles[rows]]).reshape(-1, 3)
            made = carrier_parameters(sheet.carrier, filled, _corners(atlas, rows))
        else:
            made = _graph(sheet, atlas.points[atlas.triangles[rows]], tolerance, angle)
        if not isinstance(made, tuple):
            found[chart] = made
            continue
        if len(atlas.sheets) > most_charts:
            middle = atlas.points[atlas.triangles[rows]].mean(axis=(0, 1))
            raise GeometryError(
                f"no spline follows the face {atlas.field.face(sheet.label)!r} near {place_of(atlas.field, middle)}, "
                "even in small parts; write it with a coarser tolerance, or as triangles"
            )
        waiting += atlas.cut(chart, made)
    return found


def _corners(atlas: Atlas, rows: Integers) -> Floats:
    """Points (K, 3) of a chart at which it and two others meet at least."""
    corners = np.unique(atlas.triangles[rows])
    pairs = np.unique(np.stack([atlas.triangles.ravel(), np.repeat(atlas.chart, 3)], axis=1), axis=0)
    times = np.bincount(pairs[:, 0], minlength=len(atlas.points))
    return np.asarray(atlas.points[corners[times[corners] > 2]])


def _graph(sheet: Sheet, corners: Floats, tolerance: float, angle: float) -> QuadricPatch | Graph | Plane:
    """A chart of triangles with corners (T, 3, 3) on a quadric or as a graph, or a plane that divides it."""
    middles = corners.mean(axis=1)
    normals = sheet.normals(middles)
    mean = normals.mean(axis=0)
    size = float(np.linalg.norm(mean))
    samples = np.einsum("sk,tkx->tsx", _SAMPLES, corners).reshape(-1, 3)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    weighted = areas / areas.sum()
    exact = _on_quadric(sheet, samples, weighted @ middles, weighted @ normals)
    if exact is not None:
        return exact
    if (normals @ mean).min() < STEEP * size or size < STEEP:
        return _dividing(middles, corners, normals)
    frame = _frame(corners.reshape(-1, 3), mean / size)
    found = fitted(sheet, samples, frame, tolerance, angle)
    if found is not None:
        return found
    along = middles @ frame[0]
    low, high = (corners @ frame[0]).min(), (corners @ frame[0]).max()
    middle = float(np.clip((low + high) / 2, np.quantile(along, 0.2), np.quantile(along, 0.8)))
    return frame[0], middle + 0.0013 * (high - low)


def _on_quadric(sheet: Sheet, points: Floats, middle: Floats, normal: Floats) -> QuadricPatch | None:
    """The exact patch of a chart on a quadric, with its mean point and normal (3,); None where there is none."""
    if sheet.polynomial is None or sheet.polynomial.degree != 2:
        return None
    exact = quadratic_form(sheet.polynomial)
    matrix = np.array([[to_float(exact[i, j]) for j in range(4)] for i in range(4)])
    return quadric_patch(matrix, points, middle, normal / max(float(np.linalg.norm(normal)), 1e-300))


def _frame(points: Floats, normal: Floats) -> Floats:
    """Axes (3, 3) as rows, the last one the normal, the first along the longer side of the smallest rectangle."""
    first = np.cross(normal, np.eye(3)[int(np.argmin(np.round(np.abs(normal), 6)))])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    flat = points @ np.stack([first, second]).T
    turns = np.linspace(0, np.pi / 2, 24, endpoint=False)
    ways = np.stack([np.cos(turns), np.sin(turns)])
    sides = np.ptp(flat @ ways, axis=0), np.ptp(flat @ np.stack([-ways[1], ways[0]]), axis=0)
    best = int(np.argmin(np.round(sides[0] * sides[1], 9)))
    x, y = ways[:, best]
    axes = x * first + y * second, -y * first + x * second
    if sides[0][best] < sides[1][best]:
        axes = axes[1], -axes[0]
    return np.stack([*axes, normal])


def _dividing(middles: Floats, corners: Floats, normals: Floats) -> Plane:
    """Of some planes through the middle of a chart the one that crosses it most steeply.

    A plane that nearly touches the chart somewhere would leave an edge there that has no stable place.
    """
    moved = middles - middles.mean(axis=0)
    turning = np.linalg.svd(normals - normals.mean(axis=0), full_matrices=False)[2][0]
    rise = np.linalg.lstsq(moved, (normals - normals.mean(axis=0)) @ turning, rcond=None)[0]
    ways = [rise / np.linalg.norm(rise), *np.linalg.svd(moved, full_matrices=False)[2]]
    best: tuple[float, Plane] | None = None
    for number, way in enumerate(ways):
        for share in (0.5, 0.4, 0.6, 0.3, 0.7):
            height = float(np.quantile(middles @ way, share) + 0.0013 * np.std(middles @ way))
            over = corners @ way - height
            crossed = (over.min(axis=1) < 0) & (over.max(axis=1) > 0)
            sine = np.sqrt(np.maximum(1 - (normals[crossed] @ way) ** 2, 0)).min(initial=1.0) * (
                1 if number == 0 else 0.8
            )
            if crossed.any() and (best is None or sine > best[0] + 0.05):
                best = float(sine), (way, height)
        if best is not None and best[0] > 0.5:
            break
    assert best is not None
    return best[1]
