"""De Casteljau's subdivision at a middle: of forms on simplices across an edge, of forms on boxes across a parameter.

Two ways of one algorithm, of which proofs need one or the other.  As a product with `halving`'s matrices, whose weights
are exact in floating point, many forms are halved at once, each coefficient with an error of at most (n+2) 2^-53 of
the greatest; by repeated means (`halves`), with n 2^-53, exact for exact numbers.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, homogeneous_exponents


@cache
def edges(vertices: int) -> tuple[tuple[int, int], ...]:
    """The edges of a simplex with that many vertices, as pairs of vertex numbers."""
    return tuple(combinations(range(vertices), 2))


@cache
def raised(degree: int, vertices: int) -> NDArray[np.intp]:
    """For each multi-index of degree - 1 where those of `degree` with one more in each place stand, (m, vertices).

    B-coefficients of the derivative along barycentric u, sum 0, are `degree` times the sums of u_k b at these places.
    """
    where = {a: i for i, a in enumerate(homogeneous_exponents(degree, vertices))}
    lower = homogeneous_exponents(degree - 1, vertices)
    return np.array([[where[tuple(v + (i == k) for i, v in enumerate(a))] for k in range(vertices)] for a in lower])


@cache
def halving(degree: int, vertices: int, edge: int) -> tuple[Floats, Floats]:
    """Matrices from the B-coefficients on a simplex to those on its two halves.

    The first half has the midpoint of `edges(vertices)[edge]` in place of the edge's second
    vertex, the other half in place of its first.  Rows are convex combinations with weights
    `C(m, j) / 2^m`, exact in floating point.
    """
    first, second = edges(vertices)[edge]
    return _half(degree, vertices, first, second), _half(degree, vertices, second, first)


def _half(degree: int, vertices: int, stays: int, moves: int) -> Floats:
    indices = homogeneous_exponents(degree, vertices)
    where = {a: i for i, a in enumerate(indices)}
    matrix = np.zeros((len(indices), len(indices)))
    for row, index in enumerate(indices):
        m = index[moves]
        for j in range(m + 1):
            source = list(index)
            source[moves] = j
            source[stays] += m - j
            matrix[row, where[tuple(source)]] = comb(m, j) / 2**m
    return matrix


def halves(coefficients: NDArray[Any], axis: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Both halves of forms on boxes, at the middle of the parameter along `axis`, by repeated means.

    The numbers may be doubles, or exact ones in an array of objects.
    """
    row = np.moveaxis(coefficients, axis, 0)
    size = len(row)
    left, right = np.empty_like(row), np.empty_like(row)
    for i in range(size):
        left[i], right[size - 1 - i] = row[0], row[-1]
        row = (row[:-1] + row[1:]) / 2
    return np.moveaxis(left, 0, axis), np.moveaxis(right, 0, axis)


def halved(nets: Floats, axis: int) -> tuple[Floats, Floats]:
    """Both halves of nets (C, m+1, n+1, d) along parameter `axis`, by matrices."""
    matrices = halving(nets.shape[1 + axis] - 1, 2, 0)
    if axis == 0:
        flat = nets.reshape(*nets.shape[:2], -1)
        left, right = (np.matmul(matrix, flat).reshape(nets.shape) for matrix in matrices)
    else:
        left, right = (np.matmul(matrix, nets) for matrix in matrices)
    return left, right
