"""Charts divided until each has parameters: those of its plane, quadric or torus, those of another surface that has
some, by which a quintic spline goes through points of it, or a graph over a plane.

A graph is a quintic spline, fitted by least squares on a grid over the chart's rectangle, whose heights Newton's method
finds: a chart is on one smooth function, which goes on beyond it, so that splines converge fast, and only coefficients
on which no point of the chart depends are held by nothing but their smoothness.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import BSpline, NdBSpline, make_interp_spline
from scipy.linalg import solveh_banded
from scipy.sparse import diags_array, eye_array, kron, triu
from scipy.spatial import cKDTree

from pas.algebra.affine import quadratic_form
from pas.algebra.lengths import across
from pas.algebra.rational import to_float
from pas.arrays import Bools, Floats, Integers
from pas.errors import GeometryError
from pas.exchange.step.borders import DEGREE
from pas.exchange.step.carriers import LEAST, Carrier, Plane
from pas.exchange.step.charts import Atlas, Sheet
from pas.exchange.step.parameters import (
    GAP,
    Parameters,
    ParametrizedPatch,
    SeenPatch,
    SplinePatch,
    carrier_parameters,
    free,
    quadric_patch,
)
from pas.exchange.step.parametrized import ParameterWall, PlacedSurface, Wall
from pas.limits import checkpoint
from pas.mesh.field import place_of
from pas.parametric.fitting import even_knots, sites

STEEP = 0.55
"""Cosine between a chart's mean normal and the others' below which it is divided before a graph is looked for."""

_CORNERS = np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4
_SAMPLES = 1.15 * (_CORNERS - 1 / 3) + 1 / 3
"""Barycentric coordinates of points in and a little beyond a triangle, for curved edges are beyond their chords."""


def divide(atlas: Atlas, tolerance: float, angle: float) -> dict[int, Parameters]:
    """The parameters of each chart, with graphs within a distance (local) and an angle; divides the atlas.

    Raises `GeometryError` where that takes too many charts of one.
    """
    found: dict[int, Parameters] = {}
    cuts, most_cuts = dict.fromkeys(atlas.sheets, 0), 600  # what needs more has a place where nothing converges: a cusp
    waiting = [(chart, chart) for chart in atlas.sheets]
    while waiting:
        checkpoint(f"dividing faces ({len(atlas.sheets)} parts)")
        chart, first = waiting.pop()
        sheet, rows = atlas.sheets[chart], atlas.rows(chart)
        corners = atlas.points[atlas.triangles[rows]]
        made: Parameters | Wall | None = None
        if isinstance(sheet.carrier, Carrier):
            filled = np.einsum("sk,tkx->tsx", _CORNERS, corners).reshape(-1, 3)
            made = carrier_parameters(sheet.carrier, filled, _corners(atlas, rows))
        elif sheet.carrier is not None:
            made = _by_parameters(sheet, sheet.carrier, corners, _corners(atlas, rows), tolerance, angle)
        made = made or _graph(sheet, corners, tolerance, angle)
        if not isinstance(made, Wall):
            found[chart] = made
            continue
        if cuts[first] > most_cuts:
            raise GeometryError(
                f"no spline follows the face {atlas.field.face(sheet.label)!r} near "
                f"{place_of(atlas.field, corners.mean(axis=(0, 1)))}, even in small parts; write it with a coarser "
                "tolerance, or as triangles"
            )
        cuts[first] += 1
        waiting += ((part, first) for part in atlas.cut(chart, made))
    return found


def _corners(atlas: Atlas, rows: Integers) -> Floats:
    """Points (K, 3) of a chart at which it and two others meet at least."""
    corners, mine = np.unique(atlas.triangles[rows]), np.zeros(len(atlas.points), dtype=bool)
    mine[corners] = True
    some = mine[atlas.triangles]
    pairs = np.unique(np.stack([atlas.triangles[some], atlas.chart[np.nonzero(some)[0]]], axis=1), axis=0)
    times = np.bincount(pairs[:, 0], minlength=len(atlas.points))
    return np.asarray(atlas.points[corners[times[corners] > 2]])


def _by_parameters(
    sheet: Sheet, surface: PlacedSurface, corners: Floats, nodes: Floats, tolerance: float, angle: float
) -> ParametrizedPatch | ParameterWall | None:
    """A chart of triangles with corners (T, 3, 3) by its surface's parameters, or the wall that divides it where it
    goes all the way around, away from nodes (K, 3); None where the parameters have a pole or nothing converges."""
    samples, tips = np.einsum("sk,tkx->tsx", _SAMPLES, corners), _CORNERS.max(axis=1) == 1
    outer, start, regular = np.concatenate([samples[:, tips], corners]).reshape(-1, 3), np.zeros(2), 1 / 32
    checked = samples.reshape(-1, 3)[:: 1 + samples.size // 16384]
    places = surface.places(outer)
    areas = np.linalg.norm(np.cross(*surface.slopes(places)), axis=1)
    if not areas.min() > regular * areas.max():
        return None
    for axis in np.flatnonzero(surface.periods).tolist():
        period = surface.periods[axis]
        gap, start[axis] = free(places[:, axis], period)
        if gap < GAP / (2 * np.pi) * period:
            return ParameterWall(surface, axis, free(surface.places(nodes)[:, axis], period / 2)[1])
    places = surface.unwound(places, start)
    low, high = places.min(axis=0), places.max(axis=0)
    room = 0.02 * (high - low)  # by which a patch is larger than its chart, where there is more of the surface
    least, most = np.where(surface.periods > 0, [[-np.inf], [np.inf]], surface.domain.T)
    ends = np.clip([low - room, high + room], least, most)
    within = np.clip(surface.unwound(surface.places(checked), start), *ends)
    return _interpolated(sheet, surface, start, within, ends, tolerance, angle)


def _interpolated(
    sheet: Sheet, surface: PlacedSurface, start: Floats, places: Floats, ends: Floats, tolerance: float, angle: float
) -> ParametrizedPatch | None:
    """The spline through points of a surface at even parameters between ends (2, 2), half as many more in one direction
    or the other until edges are on it, and it is within a distance and angle at places (N, 2).

    None where that takes too many.
    """
    counts, most = [9, 9], 1 << 15
    while counts[0] * counts[1] < most:
        checkpoint()
        fine = [np.linspace(a, b, 2 * count - 1) for a, b, count in zip(*ends.tolist(), counts, strict=True)]
        grid = np.stack(np.meshgrid(*fine, indexing="ij"), axis=-1)
        points = surface.at(grid.reshape(-1, 2)).reshape(*grid.shape[:2], 3)
        first = make_interp_spline(fine[0][::2], points[::2, ::2], k=DEGREE)
        second = make_interp_spline(fine[1][::2], first.c, k=DEGREE, axis=1)
        knots, poles = (first.t, second.t), second.c.swapaxes(0, 1)
        patch = ParametrizedPatch(degree=DEGREE, knots=knots, poles=poles, surface=surface, start=start)
        off = np.linalg.norm(BSpline(first.t, second(fine[1]), DEGREE)(fine[0]) - points, axis=2)
        turns = np.array([off[1::2, ::2].max(), off[::2, 1::2].max()]) / [f[1] - f[0] for f in fine]
        if off.max() < LEAST / 4:
            distance, turned = _errors(sheet, patch, places)
            if distance <= tolerance and turned <= angle:
                return replace(patch, distance=distance)
            if turns.max() < angle / 16:  # it follows the surface, but there the function is not zero
                return None
        counts[turns.argmax()] += counts[turns.argmax()] // 2
    return None


def _graph(sheet: Sheet, corners: Floats, tolerance: float, angle: float) -> SeenPatch | Plane:
    """A chart of triangles with corners (T, 3, 3) on a quadric or as a graph, or a plane that divides it."""
    middles = corners.mean(axis=1)
    normals = sheet.normals(middles)
    mean = normals.mean(axis=0)
    size = float(np.linalg.norm(mean))
    samples = np.einsum("sk,tkx->tsx", _SAMPLES, corners).reshape(-1, 3)
    if sheet.polynomial is not None and sheet.polynomial.degree == 2:
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        exact, weighted = quadratic_form(sheet.polynomial), areas / areas.sum()
        matrix = np.array([[to_float(exact[i, j]) for j in range(4)] for i in range(4)])
        way = weighted @ normals
        patch = quadric_patch(matrix, samples, weighted @ middles, way / max(float(np.linalg.norm(way)), 1e-300))
        if patch is not None:
            return patch
    if (normals @ mean).min() < STEEP * size or size < STEEP:
        return _dividing(middles, corners, normals)
    frame = _frame(corners.reshape(-1, 3), mean / size)
    found = fitted(sheet, samples, frame, tolerance, angle)
    if found is not None:
        return found
    along = middles @ frame[0]
    low, high = (corners @ frame[0]).min(), (corners @ frame[0]).max()
    middle = float(np.clip((low + high) / 2, np.quantile(along, 0.2), np.quantile(along, 0.8)))
    return Plane.of(frame[0], middle + 0.0013 * (high - low))


def _frame(points: Floats, normal: Floats) -> Floats:
    """Axes (3, 3) as rows, the last one the normal, the first along the longer side of the smallest rectangle."""
    first, second = across(normal)
    turns = np.linspace(0, np.pi, 48, endpoint=False)
    ways = np.outer(np.cos(turns), first) + np.outer(np.sin(turns), second)
    sides = np.ptp(points @ ways.T, axis=0)
    other = np.roll(sides, -24)  # those at a right angle
    best = int(np.lexsort((-np.round(sides, 9), np.round(sides * other, 9)))[0])
    return np.stack([ways[best], np.cross(normal, ways[best]), normal])


def _dividing(middles: Floats, corners: Floats, normals: Floats) -> Plane:
    """The plane through the middle of a chart, of some tried, that crosses it most steeply.

    A plane that nearly touches the chart somewhere would leave an edge there that has no stable place.
    """
    moved, turned = middles - middles.mean(axis=0), normals - normals.mean(axis=0)
    turning = np.linalg.svd(turned, full_matrices=False)[2][0]
    rise = np.linalg.lstsq(moved, turned @ turning, rcond=None)[0]
    ways = [rise / np.linalg.norm(rise), *np.linalg.svd(moved, full_matrices=False)[2]]
    best, found = -1.0, Plane.of(ways[0], float(np.median(middles @ ways[0])))
    for number, way in enumerate(ways):
        for share in (0.5, 0.4, 0.6, 0.3, 0.7):
            plane = Plane.of(way, np.quantile(middles @ way, share) + 0.0013 * np.std(middles @ way))
            over = plane.heights(corners)
            crossed = (over.min(axis=1) < 0) & (over.max(axis=1) > 0)
            sine = np.sqrt(np.maximum(1 - (normals[crossed] @ way) ** 2, 0)).min(initial=1.0)
            sine *= 1 if number == 0 else 0.8  # the way in which normals turn most makes the flattest parts
            if crossed.any() and sine > best + 0.05:
                best, found = sine, plane
        if best > 0.5:
            break
    return found


def fitted(sheet: Sheet, points: Floats, frame: Floats, tolerance: float, angle: float) -> SeenPatch | None:
    """The graph through a chart with points (N, 3) near it, within a distance and angle; None where there is none."""
    origin = points.mean(axis=0)
    local = (points - origin) @ frame.T
    known, good = _heights(sheet, origin, frame, local[:, :2], local[:, 2])
    if not good.all():
        return None
    tree = cKDTree(local[:, :2])
    low, high = local[:, :2].min(axis=0), local[:, :2].max(axis=0)
    room = 0.02 * (high - low).max()
    low, high = low - room, high + room
    before = np.inf
    for size in (9, 14, 21, 31):  # coefficients a side; a chart that needs more is divided
        checkpoint()
        knots = [even_knots(ends, size - DEGREE, DEGREE) for ends in zip(low, high, strict=True)]
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
        patch = _through(origin, frame, knots, _least_squares(knots, places, heights, weights))
        distance, off = _errors(sheet, patch, local[:, :2])
        if distance <= tolerance and off <= angle:
            return replace(patch, distance=distance)
        worst = max(distance / tolerance, off / angle)
        if worst > before / 3:  # it does not converge
            return None
        before = worst
    return None


def _through(origin: Floats, frame: Floats, knots: list[Floats], heights: Floats) -> SeenPatch:
    """The graph of a spline with coefficients (m, m)."""
    u, v = (sites(k, DEGREE) for k in knots)
    poles = origin + np.stack([*np.meshgrid(u, v, indexing="ij"), heights], axis=-1) @ frame
    return SeenPatch(degree=DEGREE, knots=(knots[0], knots[1]), poles=poles, origin=origin, frame=frame)


def _heights(sheet: Sheet, origin: Floats, frame: Floats, uv: Floats, start: Floats) -> tuple[Floats, Bools]:
    """Heights (N,) over a plane at parameters (N, 2) by Newton's method, and whether they are found, not too steep."""
    heights, base, normal = start.copy(), origin + uv @ frame[:2], frame[2]
    most = 0.1 * float(np.ptp(uv, axis=0).max(initial=0.0))
    rows, good = np.arange(len(uv)), np.zeros(len(uv), dtype=bool)
    for _ in range(12):
        jets = sheet.jets(base[rows] + heights[rows, None] * normal)
        slope, size = jets[:, 1:] @ normal, np.linalg.norm(jets[:, 1:], axis=1)
        steep = slope < 0.15 * size  # too steep to be followed
        step = np.where(steep, 0.0, jets[:, 0] / np.where(steep, 1.0, slope))
        heights[rows] -= np.clip(step, -most, most)
        good[rows] = ~steep & (np.abs(step) < 1e-9)
        rows = rows[~steep & (np.abs(step) >= 1e-13)]
        if not len(rows):
            break
    return heights, good & (np.abs(heights - start) < 5 * most)


def _least_squares(knots: list[Floats], places: list[Floats], heights: Floats, weights: Floats) -> Floats:
    """The coefficients (m, m) of a tensor spline with given weighted heights on a grid."""
    size = len(knots[0]) - DEGREE - 1
    basis = kron(*(BSpline.design_matrix(p, k, DEGREE) for p, k in zip(places, knots, strict=True)), format="csr")
    third = np.diff(np.eye(size), 3, axis=0)
    # coefficients must be held by something beside points: third differences of them count a little
    smooth = 9e-12 * float(weights.max()) * third.T @ third
    matrix = basis.T @ diags_array(weights) @ basis
    matrix = triu(matrix + kron(smooth, eye_array(size)) + kron(eye_array(size), smooth), format="coo")
    band = DEGREE * (size + 1)
    upper = np.zeros((band + 1, size * size))
    upper[band + matrix.row - matrix.col, matrix.col] = matrix.data
    return np.asarray(solveh_banded(upper, basis.T @ (weights * heights))).reshape(size, size)


def _errors(sheet: Sheet, patch: SplinePatch, uv: Floats) -> tuple[float, float]:
    """The largest distance of a graph's points from the zeros, to first order, and angle between the normals there."""
    surface = NdBSpline(patch.knots, patch.poles, DEGREE)
    points, by_u, by_v = (surface(uv, nu=nu) for nu in ((0, 0), (1, 0), (0, 1)))
    jets = sheet.jets(points)
    slopes, normals = np.linalg.norm(jets[:, 1:], axis=1), np.cross(by_u, by_v)
    sines = np.linalg.norm(np.cross(normals, jets[:, 1:]), axis=1) / (slopes * np.linalg.norm(normals, axis=1))
    return float((np.abs(jets[:, 0]) / slopes).max()), float(sines.max())
