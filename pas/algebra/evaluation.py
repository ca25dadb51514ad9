"""Values of polynomials at many points.

A few polynomials go by Horner's rule, over z inside y inside x (Higham 2002, section 5.1), every product and sum
rounded on its own in this order, so that values are the same doubles, bit for bit, on every machine.  The result at a
point x errs by at most `2 (n + 3) u / (1 - 2 (n + 3) u)` times the sum of |c| |x|^a over the terms c x^a, with
u = 2^-53 and the degree n: every term goes through at most that many roundings.

Many polynomials at the same points go by a matrix of monomials (see `evaluate`).  Several polynomials in two parameters
go by powers of the first times a matrix (BLAS), which give the coefficients in the second, then by Horner's rule; on
jets by that in both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.jets import Jet
from pas.algebra.monomials import count, monomial_values, positions
from pas.algebra.rational import to_float
from pas.arrays import Floats, Integers
from pas.kernels.library import compiled
from pas.limits import checkpoint

FEW = 4
"""Polynomials for which Horner's rule is faster than products of all monomials and a matrix."""

CHUNK_ENTRIES = 1 << 17
"""Entries of the monomial matrix held at once (1 MB): larger blocks fall out of the caches."""

BLOCK = 1 << 15
"""Points worked on between two looks at the clock."""


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
        """The batch of a `number` of polynomials on each piece, each by its coefficients (C(n+3, 3),) up to a degree n,
        in the order of `monomials.exponents`."""
        every = [column for own in pieces for column in own]
        degrees = [degree_of(len(column)) for column in every]
        ordered = [column[order_of_rule(n)] for column, n in zip(every, degrees, strict=True)]
        starts = np.cumsum([0, *(sum(map(len, own)) for own in pieces)], dtype=np.intp)[:-1]
        table = np.array(degrees, dtype=np.intp).reshape(len(pieces), number)
        return cls(table, starts, np.concatenate([np.empty(0), *ordered]))

    def __call__(self, points: Floats, pieces: Integers) -> Floats:
        """The values (N, m) at points (N, 3) in pieces of given numbers (N,); NaN in piece -1.

        In memory those of each polynomial follow one another.
        """
        number, result = len(points), np.empty((self.degrees.shape[1], len(points)))
        tables, places = (*self.degrees.shape, self.degrees, self.starts, self.coefficients), strided(points)
        for start in range(0, number, BLOCK):
            if start:
                checkpoint()
            here = number, start, min(start + BLOCK, number)
            compiled().call("pas_mixed", *tables, *here, *places, pieces, result)
        return result.T


def strided(points: Floats) -> tuple[Floats, int, int]:
    """Points (N, 3) as compiled code takes them: an array, how far apart points stand there, and coordinates."""
    return (points.T, 1, len(points)) if points.T.flags.c_contiguous else (points, 3, 1)


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


def degree_of(size: int, variables: int = 3) -> int:
    """The least degree up to which there are at least `size` monomials."""
    return next(n for n in range(size + 1) if count(n, variables) >= size)


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


@dataclass(frozen=True)
class Bundle:
    """Quotients of polynomials in t, h: `coefficients[a, b, i]` belongs to t^a h^b.

    Quotient i is polynomial `above[i]` over polynomial `below[i]` (None: it is a polynomial).
    """

    coefficients: Floats
    above: tuple[int, ...]
    below: tuple[int | None, ...]

    @classmethod
    def of_pairs(cls, pairs: Sequence[tuple[fmpq_mpoly, fmpq_mpoly]]) -> Bundle:
        """Numerators and denominators; equal denominators are evaluated once."""
        columns: list[dict[tuple[int, int], float]] = []
        seen: dict[str, int] = {}
        above, below = [], list[int | None]()
        for numerator, denominator in pairs:
            scale = max(abs(c) for c in denominator.coeffs())
            above.append(len(columns))
            if denominator.is_constant():
                columns.append(_terms(numerator, denominator.leading_coefficient()))
                below.append(None)
                continue
            columns.append(_terms(numerator, scale))
            key = str(denominator)
            if key not in seen:
                seen[key] = len(columns)
                columns.append(_terms(denominator, scale))
            below.append(seen[key])
        keys = [e for column in columns for e in column]
        table = np.zeros(
            (max((a for a, _ in keys), default=0) + 1, max((b for _, b in keys), default=0) + 1, len(columns))
        )
        for i, column in enumerate(columns):
            for e, c in column.items():
                table[(*e, i)] = c
        return cls(table, tuple(above), tuple(below))

    def __call__(self, t: Any, h: Any) -> list[Any]:
        """All polynomials, in the order of the last axis, at arrays or jets that broadcast."""
        if isinstance(t, Jet) or isinstance(h, Jet):
            return [self._jet(i, t, h) for i in range(self.coefficients.shape[2])]
        t, h = as_arrays(t, h)
        rows = combinations(t, self.coefficients)
        result = rows[-1]
        for row in rows[-2::-1]:
            result = result * h + row
        return list(result)

    def quotients(self, t: Any, h: Any) -> tuple[Any, ...]:
        """The quotients at arrays or jets; infinities and nan at poles."""
        with np.errstate(all="ignore"):
            values = self(t, h)
            return tuple(
                values[i] if j is None else values[i] / values[j] for i, j in zip(self.above, self.below, strict=True)
            )

    def _jet(self, number: int, t: Any, h: Any) -> Any:
        result: Any = None
        for column in self.coefficients[:, ::-1, number].T:
            inner = in_one_variable(column, t)
            result = inner if result is None else result * h + inner
        return result


def as_arrays(t: Any, h: Any) -> tuple[Floats, Floats]:
    """Two arrays with equally many axes, to broadcast."""
    first, second = np.asarray(t, dtype=float), np.asarray(h, dtype=float)
    size = max(first.ndim, second.ndim)
    return (
        first.reshape((1,) * (size - first.ndim) + first.shape),
        second.reshape((1,) * (size - second.ndim) + second.shape),
    )


def in_one_variable(coefficients: Sequence[float] | Floats, x: Any) -> Any:
    """The polynomial with these coefficients (lowest first) at an array or a jet."""
    if len(coefficients) == 1:
        return x * 0.0 + coefficients[0]
    result = x if coefficients[-1] == 1.0 else x * coefficients[-1]
    for place in range(len(coefficients) - 2, -1, -1):
        if coefficients[place] != 0.0:
            result = result + coefficients[place]
        if place > 0:
            result = result * x
    return result


def combinations(t: Floats, coefficients: Floats) -> Floats:
    """sum_a coefficients[a, ...] t^a: shape (..., *t.shape)."""
    size, rest = len(coefficients), coefficients.shape[1:]
    powers = np.empty((size, t.size))
    powers[0] = 1.0
    flat = t.reshape(-1)
    for a in range(1, size):
        np.multiply(powers[a - 1], flat, out=powers[a])
    return product(np.ascontiguousarray(coefficients.reshape(size, -1).T), powers).reshape(rest + t.shape)


def product(matrix: Floats, stacked: Floats) -> Floats:
    """sum_m matrix[..., m] stacked[m, ...], in blocks small enough for BLAS to stay in one thread."""
    # Multiplications in one matrix product: above, OpenBLAS starts threads, which costs more than it saves here.
    most = 1 << 18
    rows, flat = matrix.reshape(-1, matrix.shape[-1]), stacked.reshape(len(stacked), -1)
    result = np.empty((len(rows), flat.shape[1]))
    step = max(64, most // max(rows.size, 1))
    for start in range(0, flat.shape[1], step):
        np.matmul(rows, flat[:, start : start + step], out=result[:, start : start + step])
    return result.reshape(matrix.shape[:-1] + stacked.shape[1:])


def _terms(polynomial: fmpq_mpoly, scale: fmpq) -> dict[tuple[int, int], float]:
    return {(int(a), int(b)): to_float(c / scale) for (a, b), c in polynomial.to_dict().items()}
