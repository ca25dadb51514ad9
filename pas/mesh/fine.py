"""Each triangle of a mesh cut into m^2, the new points on cubics that follow the normals at the corners."""

from __future__ import annotations

from functools import cache

import numpy as np

from pas.mesh.field import Floats, Integers
from pas.mesh.topology import distinct, numbered


def finer(points: Floats, triangles: Integers, normals: Floats, m: int) -> tuple[Floats, Integers]:
    """The points and triangles after m-fold subdivision; the old points come first.

    Edges are cubics tangent to the surface at both ends (Hermite); inside, their offsets are blended.
    """
    size, count = len(points), len(triangles)
    weights, cut, border = _template(m)
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    keys = np.minimum(start, end) * size + np.maximum(start, end)
    edges, place = numbered(keys)
    low, high = edges // size, edges % size
    s = (np.arange(1, m) / m)[None, :, None]
    p, q = points[low][:, None], points[high][:, None]
    first, last = (
        ((q - p) * normals[v][:, None]).sum(axis=2, keepdims=True) * normals[v][:, None] for v in (low, high)
    )
    on_edges = (1 - s) * p + s * q - s * (1 - s) ** 2 * first + s**2 * (1 - s) * last
    inner = _inside(points, triangles, normals, weights) if len(weights) else np.empty((0, 3))
    grid = np.empty((count, len(border)), dtype=np.intp)
    inside = border < 0
    grid[:, inside] = size + on_edges.shape[0] * (m - 1) + np.arange(count * inside.sum()).reshape(count, -1)
    grid[:, _corners(m)] = triangles
    step, forward = np.arange(m - 1), start < end
    rows = size + place[:, None] * (m - 1) + np.where(forward[:, None], step, m - 2 - step)
    grid[:, _sides(m)] = rows.reshape(count, -1)
    return np.concatenate([points, on_edges.reshape(-1, 3), inner.reshape(-1, 3)]), grid[:, cut].reshape(-1, 3)


def points_on_edges(triangles: Integers, size: int, m: int, chosen: Integers) -> Integers:
    """The numbers (E, m - 1) that `finer` gives the new points of chosen edges (E, 2)."""
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    edges = distinct(np.minimum(start, end) * size + np.maximum(start, end))
    place = np.searchsorted(edges, chosen.min(axis=1) * size + chosen.max(axis=1))
    return np.asarray(size + place[:, None] * (m - 1) + np.arange(m - 1))


def _inside(points: Floats, triangles: Integers, normals: Floats, weights: Floats) -> Floats:
    """The points (T, K, 3) inside triangles at barycentric coordinates (K, 3)."""
    corners = points[triangles]
    result = np.asarray(np.einsum("kc,tcx->tkx", weights, corners))
    for e in range(3):
        a, b = e, (e + 1) % 3
        way = corners[:, b] - corners[:, a]
        n, k = normals[triangles[:, a]], normals[triangles[:, b]]
        bow = (way * k).sum(axis=1)[:, None] * k - (way * n).sum(axis=1)[:, None] * n
        result += 0.5 * (weights[:, a] * weights[:, b])[None, :, None] * bow[:, None]
    return result


@cache
def _indices(m: int) -> dict[tuple[int, int], int]:
    return {ij: k for k, ij in enumerate((i, j) for i in range(m + 1) for j in range(m + 1 - i))}


@cache
def _corners(m: int) -> Integers:
    where = _indices(m)
    return np.array([where[0, 0], where[m, 0], where[0, m]])


@cache
def _sides(m: int) -> Integers:
    """The inner points of the sides from the first to the second corner, on to the third, and back."""
    where = _indices(m)
    sides = [[(i, 0) for i in range(1, m)], [(m - i, i) for i in range(1, m)], [(0, m - i) for i in range(1, m)]]
    return np.array([where[ij] for side in sides for ij in side], dtype=np.intp)


@cache
def _template(m: int) -> tuple[Floats, Integers, Integers]:
    """Barycentric coordinates (K, 3) of points inside, the small triangles (m^2, 3), and -1 for points inside."""
    where = _indices(m)
    inside = [(i, j) for i, j in where if i and j and i + j < m]
    weights = np.array([((m - i - j) / m, i / m, j / m) for i, j in inside]).reshape(-1, 3)
    up = [(where[i, j], where[i + 1, j], where[i, j + 1]) for i in range(m) for j in range(m - i)]
    down = [(where[i + 1, j], where[i + 1, j + 1], where[i, j + 1]) for i in range(m) for j in range(m - 1 - i)]
    border = np.array([-1 if ij in set(inside) else 0 for ij in where])
    return weights, np.array(up + down), border
