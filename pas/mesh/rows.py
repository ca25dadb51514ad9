"""Arrays with a few columns and many rows: what is worked out of them faster than by numpy's sums."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from pas.algebra.bracket import Jets
from pas.arrays import Bools, Floats, Integers


def dots(u: Floats, v: Floats) -> Floats:
    """The products (N,) of vectors (N, 3), summed from the first to the third."""
    products = u * v
    return np.asarray(products[:, 0] + products[:, 1] + products[:, 2])


def norms(vectors: Floats) -> Floats:
    """The lengths (N,) of vectors (N, 3)."""
    return np.asarray(np.sqrt(dots(vectors, vectors)))


def off_zero(values: Floats, gradients: Floats) -> Floats:
    """How far points are from zeros of functions with values (N,) and gradients (N, 3) there, to first order, (N,)."""
    return np.asarray(np.abs(values) / np.maximum(norms(gradients), 1e-300))


def along_lines(jets: Callable[[Floats, Integers], Floats], starts: Floats, ways: Floats) -> Jets:
    """The values and slopes of functions on lines from points along vectors (N, 3), by the numbers of lines; `jets`
    gives values and gradients (K, 4) at points (K, 3) of lines that are numbered so (K,)."""

    def along(shares: Floats, rows: Integers) -> tuple[Floats, Floats]:
        own = ways.take(rows, axis=0)
        found = jets(starts.take(rows, axis=0) + shares[:, None] * own, rows)
        return found[:, 0], dots(found[:, 1:], own)

    return along


def cross(u: Floats, v: Floats) -> Floats:
    """Vector products of rows (N, 3); several times faster than `np.cross`."""
    x, y, z = u.T
    a, b, c = v.T
    return np.stack([y * c - z * b, z * a - x * c, x * b - y * a], axis=1)


def area_vectors(corners: Floats) -> Floats:
    """Vectors (T, 3) at right angles to triangles of corners (T, 3, 3), outwards, as long as twice their areas."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return cross(b - a, c - a)


def inside_sphere(corners: Floats, radius: float) -> float:
    """How far triangles with corners (T, 3, 3) on a sphere about 0 are inside it at most: where their planes come
    nearest to its centre."""
    normals = area_vectors(corners)
    heights = np.abs(dots(normals, corners[:, 0])) / np.maximum(norms(normals), 1e-300)
    return float((radius - heights).max(initial=0.0))


def spans(corners: Floats) -> tuple[Floats, Floats]:
    """The determinants (T,) of triangles (T, 3, 3), positive where they are seen from 0 with their outside away, and
    the products of the corners' distances from 0, (T,)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return dots(a, cross(b, c)), np.asarray(np.sqrt(dots(a, a) * dots(b, b) * dots(c, c)))


def any_of(table: Bools) -> Bools:
    """In which rows (N,) of a table (N, k) something is true."""
    result = table[:, 0].copy()
    for column in table.T[1:]:
        result |= column
    return result


def largest_of(table: Floats) -> Floats:
    """The largest entries (N,) of the rows of a table (N, k)."""
    result = table[:, 0].copy()
    for column in table.T[1:]:
        np.maximum(result, column, out=result)
    return result


def quarters(triangles: Floats) -> Floats:
    """The four parts (T, 4, 3, ...) of triangles (T, 3, ...), cut at the middles of their sides."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    p, q, r = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [np.stack(part, axis=1) for part in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))]
    return np.stack(parts, axis=1)


def counted_on(numbers: Sequence[Integers], sizes: Sequence[int]) -> Integers:
    """Numbers of points or faces of several parts one after the other, where each part has that many of its own."""
    starts = np.cumsum([0, *sizes])
    return np.concatenate([part + start for part, start in zip(numbers, starts, strict=False)])
