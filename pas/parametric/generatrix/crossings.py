"""Whether a surface crosses itself: where the triangles of its mesh do, double points, and a proof that there are none.

A binary tree of boxes stands on the triangles in the order of a k-d tree; pairs of boxes that overlap are followed
down, all of a level at once.  Two triangles without a common vertex cross iff an edge of one passes through the other
(Moller 1997): by signs of 4-point determinants, each beyond its rounding error (Shewchuk 1997, the static filter), so
that only clear crossings count; touching and coplanar triangles do not.  It is a statement on the mesh: a surface
nearby may differ by as much as it is away from the mesh.

The proof: if for two vectors a, b the symmetric part of the matrix

    ( a . P_s   a . P_t )
    ( b . P_s   b . P_t )

is positive definite on the whole (convex) square, then for two places that differ by (u, v) the number
(u a + v b) . (P - P') is the mean of this form at (u, v) along the way between them, hence positive: P != P'
(the monotone case of Gale and Nikaido 1965).  With a, b dual to the mean tangents the matrix is near the unit
matrix for surfaces that do not bend too far.  The two inequalities are proved by Bernstein branch and bound.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from pas.algebra.lengths import exponent, lengths
from pas.algebra.monomials import Floats
from pas.algebra.rational import exact, rational, to_float, to_fraction
from pas.algebra.rational_function import RationalFunction, total
from pas.limits import checkpoint
from pas.mesh.rows import Integers
from pas.parametric.maps import ParametricMap
from pas.parametric.regularity import positive_on_unit_square


def crossings(points: Floats, triangles: Integers) -> tuple[Integers, Floats]:
    """Pairs (k, 2) of triangles that cross, and a point (k, 3) of each crossing."""
    power = exponent(points)
    points = np.ldexp(points, -power)
    pairs = _near_pairs(points[triangles])
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


def _near_pairs(corners: Floats) -> Integers:
    """Pairs (i < j) of triangles (n, 3, 3) whose boxes overlap."""
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
        a, b = level[pairs[:, 0]], level[pairs[:, 1]]
        pairs = pairs[((a[:, 0] <= b[:, 1]) & (b[:, 0] <= a[:, 1])).all(axis=1)]
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    return np.sort(order[pairs], axis=1)


def _cross(first: Floats, second: Floats) -> tuple[NDArray[np.bool_], Floats]:
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


def double_point(surface: ParametricMap, pairs: Floats, closed: bool) -> tuple[Floats, Floats, float] | None:
    """Two places (2, 2) of one point of a surface over [0, 1]^2 near one of some pairs (k, 2, 2), the point, the gap.

    By Newton's method from twelve of the pairs; None where it finds none.  Where `closed` the first parameter goes
    round.
    """
    places = pairs[np.linspace(0, len(pairs) - 1, min(12, len(pairs))).astype(int)]
    for _ in range(25):
        points, tangents = surface(places), surface.tangents(places)
        slopes = np.concatenate([tangents[:, 0], -tangents[:, 1]], axis=1).swapaxes(1, 2)
        gap = (points[:, 0] - points[:, 1])[..., None]
        places = places - (np.linalg.pinv(slopes) @ gap)[..., 0].reshape(-1, 2, 2)
        places[..., 0] = places[..., 0] % 1.0 if closed else np.clip(places[..., 0], 0.0, 1.0)
        places[..., 1] = np.clip(places[..., 1], 0.0, 1.0)
    points = surface(places)
    gaps = lengths(points[:, 0] - points[:, 1])
    extent = float(np.ptp(points, axis=(0, 1)).max()) or 1.0
    apart = np.abs(places[:, 0] - places[:, 1])
    apart[:, 0] = np.minimum(apart[:, 0], 1 - apart[:, 0]) if closed else apart[:, 0]
    good = np.flatnonzero((gaps < 1e-9 * extent) & (apart.max(axis=1) > 1e-3))
    return (places[good[0]], points[good[0], 0], float(gaps[good[0]])) if len(good) else None


def is_injective(surface: ParametricMap, effort: int = 4_000) -> bool:
    """Whether it is proved that an exact surface over [0, 1]^2 takes no point twice; False says nothing.

    Each coordinate is scaled exactly by the size of its mean slopes (at 5 x 5 places) first: that changes nothing.
    """
    along, across = ([c.diff(*order) for c in surface.components] for order in ((1, 0), (0, 1)))
    places = [fmpq(i, 4) for i in range(5)]
    try:
        means = [
            [sum((rational(f.at(u, v)) for u in places for v in places), fmpq(0)) / 25 for f in pair]
            for pair in zip(along, across, strict=True)
        ]
    except ValueError:  # a pole
        return False
    sizes = [max(map(abs, row)) or fmpq(1) for row in means]
    tangents = np.array([[to_float(x / size) for x in row] for row, size in zip(means, sizes, strict=True)])
    duals = np.linalg.pinv(tangents)
    if not np.abs(duals).max(axis=1).min() > 0:
        return False
    first, second = ([x / size for x, size in zip(_short(row), sizes, strict=True)] for row in duals)
    a, d = _product(first, along), _product(second, across)
    mixed = _product(first, across) + _product(second, along)
    return positive_on_unit_square(a, effort) and positive_on_unit_square(4 * a * d - mixed * mixed, effort)


def _short(vector: Floats) -> list[fmpq]:
    """A rational vector near, with short numbers: any vectors near will do."""
    scale = exact(2.0 ** np.round(np.log2(np.abs(vector).max())))
    return [rational(to_fraction(exact(float(x)) / scale).limit_denominator(64)) * scale for x in vector]


def _product(vector: Sequence[fmpq], functions: Sequence[RationalFunction]) -> RationalFunction:
    return total([f * x for f, x in zip(functions, vector, strict=True)])
