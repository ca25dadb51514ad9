"""Each triangle of a mesh cut into m^2, the new points on cubics that follow the normals at the corners."""

from __future__ import annotations

from functools import cache

import numpy as np

from pas.mesh.field import Floats, Integers
from pas.mesh.kernels import compiled
from pas.mesh.topology import distinct, numbered


def finer(points: Floats, triangles: Integers, normals: Floats, m: int) -> tuple[Floats, Integers]:
    """The points and triangles after m-fold subdivision; the old points come first.

    Edges are cubics tangent to the surface at both ends (Hermite); inside, their offsets are blended.
    """
    size = len(points)
    if m == 1:
        return points, triangles
    weights, cut, border = _template(m)
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    keys = np.minimum(start, end) * size + np.maximum(start, end)
    edges, place = numbered(keys)
    s = np.arange(1, m) / m
    shares = np.stack([1 - s, s, s * (1 - s) ** 2, s**2 * (1 - s)], axis=1)
    places = _corners(m), _sides(m), np.flatnonzero(border < 0)
    ends = np.stack([edges // size, edges % size], axis=1), place
    return compiled().finer(points, triangles, normals, ends, m, shares, weights, places, cut)


def points_on_edges(triangles: Integers, size: int, m: int, chosen: Integers) -> Integers:
    """The numbers (E, m - 1) that `finer` gives the new points of chosen edges (E, 2)."""
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    edges = distinct(np.minimum(start, end) * size + np.maximum(start, end))
    place = np.searchsorted(edges, chosen.min(axis=1) * size + chosen.max(axis=1))
    return np.asarray(size + place[:, None] * (m - 1) + np.arange(m - 1))


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


def fewest_parts(m: int, inside: Floats, along: Floats, tolerance: float) -> int:
    """Into how many parts edges that were cut into `m` should be, for few triangles after what is too far is halved:
    on a sphere all are as far as one another, and a few parts more do for all of them."""

    def expected(parts: int) -> float:
        limit = tolerance * (parts / m) ** 2  # distances fall with the square of lengths
        return float(len(inside) * (parts / m) ** 2 + (inside > limit).sum() + 2 * (along > limit).sum())

    return min(range(m, 2 * m), key=expected)
