"""Rational matrices as products of whole ones, multiplied out only where that is asked for.

The members of a solution space come as combinations of some generators.  On the generators numbers are short; in
the combinations, and in the products, they have hundreds or thousands of digits, of which most uses need few.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import lcm

from flint import fmpq, fmpq_mat, fmpz, fmpz_mat


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
