"""Halves of simplices by products with matrices: another way than that of the package, for comparison."""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np

from pas.algebra.monomials import homogeneous_exponents
from pas.arrays import Floats
from pas.bernstein.simplices import edges


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
