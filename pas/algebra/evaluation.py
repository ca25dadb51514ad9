"""Values of polynomials at many points.

A few polynomials go by Horner's rule, over z inside y inside x (Higham 2002, section 5.1), every product and sum
rounded on its own in this order, so that values are the same doubles, bit for bit, on every machine.  The result at a
point x errs by at most `2 (n + 3) u / (1 - 2 (n + 3) u)` times the sum of |c| |x|^a over the terms c x^a, with
u = 2^-53 and the degree n: every term goes through at most that many roundings.

Many polynomials at the same points go by a matrix of monomials (see `evaluate`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, count, monomial_values, positions
from pas.kernels.library import compiled
from pas.limits import checkpoint

FEW = 4
"""Polynomials for which Horner's rule is faster than products of all monomials and a matrix."""

CHUNK_ENTRIES = 1 << 17
"""Entries of the monomial matrix held at once (1 MB): larger blocks fall out of the caches."""

BLOCK = 1 << 15
"""Points worked on between two looks at the clock."""

Integers = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class PolynomialBatch:
    """m polynomials on each of P pieces, such as a function and its derivatives, at points each of a piece of its own.

    `degrees` (P, m) are theirs; `coefficients` are those of all, in the order in which Horner's rule meets them, those
    of each piece from `starts` (P,) on.
    """

    degrees: Integers
    starts: Integers
    coefficients: Floats

    @classmethod
    def of(cls, pieces: Sequence[Sequence[Floats]], number: int) -> PolynomialBatch:
        """That of a `number` of polynomials on each piece, each by its coefficients (C(n+3, 3),) up to a degree n, in
        the order of `monomials.exponents`."""
        every = [column for own in pieces for column in own]
        degrees = [degree_of(len(column)) for column in every]
        ordered = [column[order_of_rule(n)] for column, n in zip(every, degrees, strict=True)]
        starts = np.cumsum([0, *(sum(map(len, own)) for own in pieces)], dtype=np.intp)[:-1]
        table = np.array(degrees, dtype=np.intp).reshape(len(pieces), number)
        return cls(table, starts, np.concatenate([np.empty(0), *ordered]))

    @property
    def arrays(self) -> tuple[Integers, Integers, Floats]:
        """What compiled code takes."""
        return self.degrees, self.starts, self.coefficients

    def __call__(self, points: Floats, pieces: Integers) -> Floats:
        """The values (N, m) at points (N, 3) in pieces of given numbers (N,); NaN in piece -1.

        In memory those of each polynomial follow one another.
        """
        result = np.empty((self.degrees.shape[1], len(points)))
        tables = (*self.degrees.shape, *self.arrays)
        for start in range(0, len(points), BLOCK):
            checkpoint()
            here, whole = slice(start, start + BLOCK), len(points) <= BLOCK
            number = len(pieces[here])
            out = result if whole else np.empty((len(result), number))
            by_coordinates = whole and points.T.flags.c_contiguous
            places = (points.T, 1, number) if by_coordinates else (points[here], 3, 1)
            compiled().call("pas_mixed", *tables, number, *places, pieces[here], out)
            if not whole:
                result[:, here] = out
        return result.T


def horner(coefficients: Floats, degree: int, points: Floats) -> Floats:
    """The values (m, N) of m polynomials at N points.

    `coefficients` (m, C(n+3, 3)) stand in the order of `monomials.exponents(degree)`; `points` (3, N).
    """
    x, y, z = np.ascontiguousarray(points, dtype=float)
    table = np.ascontiguousarray(coefficients[:, order_of_rule(degree)], dtype=float)
    values = np.empty((len(table), len(x)))
    for row, out in zip(table, values, strict=True):
        compiled().call("pas_horner", degree, len(x), row, x, y, z, out)
    return values


def evaluate(points: Floats, coefficients: Floats) -> Floats:
    """Values of polynomials of one degree at many points.

    `points` (..., 3); `coefficients` (C(n+3, 3), m), a polynomial a column; result (..., m).  Of more than `FEW`
    polynomials the last digits depend on the machine's linear algebra library.
    """
    flat = np.ascontiguousarray(points, dtype=float).reshape(-1, 3)
    size, columns = coefficients.shape
    degree = degree_of(size)
    result = np.empty((len(flat), columns))
    step = max(1, CHUNK_ENTRIES // max(size, columns))
    for start in range(0, len(flat), step):
        checkpoint()
        block, out = flat[start : start + step], result[start : start + step]
        if columns > FEW:
            np.matmul(monomial_values(block, degree).T, coefficients, out=out)
        else:
            out[...] = horner(coefficients.T, degree, block.T).T
    return result.reshape(*np.shape(points)[:-1], columns)


def degree_of(size: int) -> int:
    """The least degree up to which there are so many monomials, or more."""
    return next(n for n in range(size + 1) if count(n) >= size)


@cache
def order_of_rule(degree: int) -> Integers:
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
