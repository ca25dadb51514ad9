"""Pairs of triangles that cross each other.

A binary tree of boxes stands on the triangles in the order of a k-d tree; pairs of boxes that overlap are followed
down, all of a level at once.  Two triangles without a common vertex cross iff an edge of one passes through the other
(Moller 1997): by signs of 4-point determinants, each beyond its rounding error (Shewchuk 1997, the static filter), so
that only clear crossings count; touching and coplanar triangles do not.  It is a statement on the mesh: a surface
nearby may differ by as much as it is away from the mesh.
"""

from __future__ import annotations

import numpy as np

from pas.algebra.lengths import exponent
from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint


def crossings(points: Floats, triangles: Integers) -> tuple[Integers, Floats]:
    """Pairs (k, 2) of triangles that cross, and a point (k, 3) of each crossing."""
    power = exponent(points)
    points = np.ldexp(points, -power)
    pairs = near_pairs(points[triangles])
    shared = (triangles[pairs[:, 0], :, None] == triangles[pairs[:, 1], None, :]).any(axis=(1, 2))
    pairs = pairs[~shared]
    found, places = [np.empty((0, 2), dtype=np.intp)], [np.empty((0, 3))]
    size = 1 << 18
    for start in range(0, len(pairs), size):
        checkpoint("looking for self-intersections", start / len(pairs))
        block = pairs[start : start + size]
        hit, place = _cross(points[triangles[block[:, 0]]], points[triangles[block[:, 1]]])
        found.append(block[hit])
        places.append(place[hit])
    return np.concatenate(found), np.ldexp(np.concatenate(places), power)


def near_pairs(corners: Floats) -> Integers:
    """Pairs (i < j) of triangles (n, 3, 3), or other sets of points, whose boxes overlap."""
    from scipy.spatial import cKDTree

    low, high = corners.min(axis=1), corners.max(axis=1)
    order = cKDTree((low + high) / 2).indices
    boxes = np.full((1 << max(1, int(np.ceil(np.log2(max(len(order), 2))))), 2, 3), np.inf)
    boxes[:, 1] = -np.inf
    boxes[: len(order), 0], boxes[: len(order), 1] = low[order], high[order]
    levels = [boxes]
    while len(levels[-1]) > 1:
        halves = levels[-1].reshape(-1, 2, 2, 3)
        levels.append(np.stack([halves[:, :, 0].min(axis=1), halves[:, :, 1].max(axis=1)], axis=1))
    pairs = np.zeros((1, 2), dtype=np.intp)
    for level in reversed(levels[:-1]):
        checkpoint("looking for self-intersections")
        base, same = 2 * pairs, pairs[:, 0] == pairs[:, 1]
        pairs = np.concatenate([base, base + 1, base + (0, 1), base[~same] + (1, 0)])
        for low, high in np.ascontiguousarray(level.transpose(2, 1, 0)):
            a, b = pairs.T
            pairs = pairs[(low[a] <= high[b]) & (low[b] <= high[a])]
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    return np.sort(order[pairs], axis=1)


def _cross(first: Floats, second: Floats) -> tuple[Bools, Floats]:
    """Whether triangles (n, 3, 3) cross each other, and where (nan where not)."""
    hit, place = np.zeros(len(first), dtype=bool), np.full((len(first), 3), np.nan)
    for one, two in ((first, second), (second, first)):
        heights = np.stack([_volume(two[:, 0], two[:, 1], two[:, 2], one[:, i]) for i in range(3)], axis=1)
        for i, j in ((0, 1), (1, 2), (2, 0)):
            rows = np.flatnonzero(heights[:, i] * heights[:, j] < 0)
            p, q, t = one[rows, i], one[rows, j], two[rows]
            sides = np.stack([_volume(p, q, t[:, k], t[:, (k + 1) % 3]) for k in range(3)], axis=1)
            through = (sides > 0).all(axis=1) | (sides < 0).all(axis=1)
            share = heights[rows, i] / (heights[rows, i] - heights[rows, j])
            place[rows[through]] = (p + share[:, None] * (q - p))[through]
            hit[rows[through]] = True
    return hit, place


def _volume(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Six times the signed volume of tetrahedra (n, 3 each), zero where rounding could have made the sign."""
    u, v, w = b - a, c - a, d - a
    minors = np.stack([v[:, (k + 1) % 3] * w[:, (k + 2) % 3] - v[:, (k + 2) % 3] * w[:, (k + 1) % 3] for k in range(3)])
    value = (u * minors.T).sum(axis=1)
    sizes = np.abs(np.stack([u, v, w])).max(axis=2)
    bound = 96 * 2.0**-53 * sizes.prod(axis=0)
    largest = 2.0**-50 * np.abs(np.stack([a, b, c, d])).max(axis=(0, 2))
    return np.where(np.abs(value) > bound + largest * sizes.max(axis=0) ** 2, value, 0.0)
