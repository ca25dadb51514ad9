"""Matrices of whole and rational numbers: products that are not multiplied out, and short whole vectors.

The members of a solution space come as combinations of some generators.  On the generators numbers are short; in
the combinations, and in the products, they have hundreds or thousands of digits, of which most uses need few.

Whole combinations of given vectors miss most of the whole vectors in their span, and these may have many times fewer
digits.  All are found modulo the denominator of the reduced echelon form (Cohen 1993, section 2.4), and short ones
among them by lattice reduction (Lenstra, Lenstra and Lovasz 1982).
"""

from __future__ import annotations

import copyreg
import random
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from math import gcd, lcm
from typing import Any, TypeVar

import numpy as np
from flint import fmpq, fmpq_mat, fmpz, fmpz_mat, nmod_mat


def _reduced(matrix: Any) -> tuple[type, tuple[Any, ...]]:
    return type(matrix), (matrix.nrows(), matrix.ncols(), matrix.entries())


for kind in (fmpq_mat, fmpz_mat):  # which do not say themselves how they are pickled
    copyreg.pickle(kind, _reduced)


@dataclass(frozen=True, eq=False)
class Products:
    """The matrices `rows * tables[i] / denominator`: `rows` (m, N) and `tables[i]` (N, C_i) are whole."""

    rows: fmpz_mat
    tables: tuple[fmpz_mat, ...]
    denominator: int = 1
    given: tuple[fmpq_mat, ...] | None = None

    @classmethod
    def of(cls, matrices: Sequence[fmpq_mat]) -> Products:
        """Given matrices, of m rows each."""
        parts = [matrix.numer_denom() for matrix in matrices]
        common = lcm(*(int(denominator) for _, denominator in parts))
        tables = tuple(numerators * (common // int(denominator)) for numerators, denominator in parts)
        size = matrices[0].nrows()
        unit = fmpz_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
        return cls(unit, tables, common, tuple(matrices))

    @property
    def size(self) -> int:
        """The number m of rows."""
        return int(self.rows.nrows())

    @cached_property
    def matrices(self) -> tuple[fmpq_mat, ...]:
        """The products themselves, or what they were made from."""
        if self.given is not None:
            return self.given
        scale = fmpq(1, self.denominator)
        return tuple(fmpq_mat(self.rows * table) * scale for table in self.tables)

    def row(self, matrix: int, number: int) -> list[fmpz]:
        """One row of one of the products, times the denominator."""
        chosen = fmpz_mat(1, self.rows.ncols(), [self.rows[number, j] for j in range(self.rows.ncols())])
        return (chosen * self.tables[matrix]).entries()

    def combined(self, coefficients: fmpz_mat) -> list[fmpz_mat]:
        """Whole combinations (k, m) of the rows of each product, times the denominator."""
        on_generators = coefficients * self.rows
        return [on_generators * table for table in self.tables]


Table = list[list[int]]
K = TypeVar("K", bound=Hashable)


def leads(reduced: fmpq_mat | nmod_mat, rank: int) -> list[int]:
    """The columns of the leading entries of a reduced matrix, row by row."""
    return [next(j for j in range(reduced.ncols()) if reduced[i, j] != 0) for i in range(rank)]


def solved(table: fmpq_mat) -> tuple[list[fmpq], list[int]] | None:
    """A solution of equations (p, m + 1), right-hand sides last: 0 in free unknowns, with the numbers of those that are
    bound; None where they contradict."""
    reduced, rank = table.rref()
    bound, size = leads(reduced, rank), table.ncols() - 1
    if size in bound:
        return None
    result = [fmpq(0)] * size
    for row, lead in enumerate(bound):
        result[lead] = reduced[row, size]
    return result, bound


def whole_rows(rows: Sequence[Mapping[K, fmpq]], places: Mapping[K, int]) -> tuple[fmpz_mat, int]:
    """Rows (N, columns) of entries by keys, which have `places`, in whole numbers over one denominator."""
    common = lcm(*(int(v.q) for row in rows for v in row.values()))
    table = fmpz_mat(len(rows), len(places))
    for number, row in enumerate(rows):
        for key, value in row.items():
            table[number, places[key]] = int(value.p) * (common // int(value.q))
    return table, common


def short_products(rows: list[Any], tables: Sequence[list[Any]]) -> list[list[Any]]:
    """LLL-reduced bases: of whole rows, then of the rows of their products with some tables, side by side."""
    first = short_basis(fmpz_mat(rows))
    products = [(first * fmpz_mat(table)).tolist() for table in tables]
    short = short_basis(fmpz_mat([[v for row in parts for v in row] for parts in zip(*products, strict=True)])).tolist()
    starts = accumulate((len(table[0]) for table in tables), initial=0)
    return [[row[start:end] for row in short] for start, end in pairwise(starts)]


def short_basis(rows: fmpz_mat) -> fmpz_mat:
    """An LLL-reduced basis (m, N) of the whole vectors in the span of independent whole rows (m, N).

    With the reduced echelon form `E / d`, the columns of E span a lattice that holds all multiples of d; where those of
    H are a basis of it, the rows of `H^-1 E` are one of the whole vectors, and short already where H is reduced.
    """
    echelon, denominator = _echelon(rows).numer_denom()
    d, (size, columns) = int(denominator), (rows.nrows(), rows.ncols())
    # as many random sums of columns and some more span what all columns do, but for a chance of 2^-10
    mixed = random.Random(size)
    mix = fmpz_mat(columns, size + 10, [mixed.randint(-1, 1) for _ in range(columns * (size + 10))])
    square = _triangular([[int(v) for v in column] for column in (echelon * mix).transpose().tolist()], d)
    reduced = fmpz_mat(square).transpose().lll().transpose()
    inverse, scale = fmpq_mat(reduced).inv().numer_denom()
    spanning, _ = (fmpq_mat(inverse * echelon) * fmpq(1, scale)).numer_denom()
    return fmpz_mat(spanning.tolist()[::-1]).lll()  # the dual of a reduced basis is nearly reduced from its end


def _echelon(rows: fmpz_mat) -> fmpq_mat:
    """The reduced echelon form up to the order of rows and columns: at once where each row has a column of its own."""
    table = rows.tolist()
    own: dict[int, int] = {}
    for j, column in enumerate(rows.transpose().tolist()):
        places = [i for i, v in enumerate(column) if v != 0]
        if len(places) == 1:
            own.setdefault(places[0], j)
    if len(own) < len(table):
        return fmpq_mat(rows).rref()[0]
    return fmpq_mat([[fmpq(v, row[own[i]]) for v in row] for i, row in enumerate(table)])


def _triangular(vectors: Table, modulus: int) -> Table:
    """A triangular basis, as columns, of the lattice that vectors (k, m) and the multiples of a modulus span."""
    table: Any = np.array(vectors, dtype=object) % modulus
    size, basis = table.shape[1], []
    for place in range(size):
        pivot: Any = np.zeros(size, dtype=object)
        pivot[place] = modulus
        for number in np.nonzero(table[:, place])[0]:
            other, a, b = table[number], int(pivot[place]), int(table[number, place])
            g = gcd(a, b)
            u = pow(a // g, -1, b // g) if b != g else 0
            v = (g - u * a) // b
            pivot, table[number] = (u * pivot + v * other) % modulus, (a // g * other - b // g * pivot) % modulus
            pivot[place] = g
        basis.append(pivot)
    return [list(row) for row in np.array(basis, dtype=object).T]
