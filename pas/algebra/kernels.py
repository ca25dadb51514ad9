"""Values of polynomials at many points by Horner's rule.

The rule runs over z inside y inside x (Higham 2002, section 5.1), every product and sum rounded on its own in this
order, so that values are the same doubles, bit for bit, on every machine.

The result at a point x errs by at most `2 (n + 3) u / (1 - 2 (n + 3) u)` times the sum of |c| |x|^a over the
terms c x^a, with u = 2^-53 and the degree n: every term goes through at most that many roundings.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, count, monomial_values, positions
from pas.kernels.library import address_of, declared
from pas.limits import checkpoint

FEW = 4
"""Polynomials for which Horner's rule is faster than products of all monomials and a matrix."""

CHUNK_ENTRIES = 1 << 17
"""Entries of the monomial matrix held at once (1 MB): larger blocks fall out of the caches."""


def horner(coefficients: Floats, degree: int, points: Floats, out: Floats) -> None:
    """Write the values of m polynomials at N points into `out` (m, N).

    `coefficients` (m, C(n+3, 3)) stand in the order of `monomials.exponents(degree)`; `points` (3, N).
    """
    run = _rule()
    x, y, z = (np.ascontiguousarray(c, dtype=float) for c in points)
    table = np.ascontiguousarray(coefficients[:, order_of_rule(degree)], dtype=float)
    for row, column in zip(table, out, strict=True):
        values = column if column.flags.c_contiguous else np.empty(len(x))
        run(degree, len(x), *map(address_of, (row, x, y, z, values)))
        if values is not column:
            column[:] = values


def evaluate(points: Floats, coefficients: Floats) -> Floats:
    """Values of polynomials of one degree at many points.

    `points` (..., 3); `coefficients` (C(n+3, 3), m), a polynomial a column; result (..., m).  Of more than `FEW`
    polynomials the last digits depend on the machine's linear algebra library.
    """
    flat = np.ascontiguousarray(points, dtype=float).reshape(-1, 3)
    size, columns = coefficients.shape
    degree = next(n for n in range(size) if count(n) >= size)
    result = np.empty((len(flat), columns))
    step = max(1, CHUNK_ENTRIES // max(size, columns))
    for start in range(0, len(flat), step):
        checkpoint()
        block, out = flat[start : start + step], result[start : start + step]
        if columns > FEW:
            np.matmul(monomial_values(block, degree).T, coefficients, out=out)
            continue
        values = np.empty((columns, len(block)))
        horner(coefficients.T, degree, np.ascontiguousarray(block.T), values)
        out[...] = values.T
    return result.reshape(*np.shape(points)[:-1], columns)


@cache
def order_of_rule(degree: int) -> NDArray[np.intp]:
    """The order (C(n+3, 3),) in which the rule meets the coefficients: falling powers of z inside y inside x."""
    where = positions(degree)
    return np.array(
        [
            where[a, b, c]
            for a in range(degree, -1, -1)
            for b in range(degree - a, -1, -1)
            for c in range(degree - a - b, -1, -1)
        ],
        dtype=np.intp,
    )


@cache
def _rule() -> Callable[..., None]:
    return declared("pas_horner")
