"""Charts divided until each has parameters: those of its plane, quadric or torus, or a graph over a plane."""

from __future__ import annotations

import numpy as np

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.errors import GeometryError
from pas.exchange.step.charts import Atlas, Sheet
from pas.exchange.step.functions import Integers, Plane
from pas.exchange.step.graphs import Graph, fitted
from pas.exchange.step.parameters import CarrierParameters, carrier_parameters
from pas.exchange.step.quadrics import QuadricPatch, quadric_patch
from pas.mesh.field import place_of
from pas.solid.field import quadric

Parameters = CarrierParameters | QuadricPatch | Graph

MOST_CHARTS = 600
"""A solid that needs more has a place at which nothing converges, such as a cusp."""

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
    waiting = list(atlas.sheets)
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
        if len(atlas.sheets) > MOST_CHARTS:
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
    exact = quadric(sheet.polynomial)
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
