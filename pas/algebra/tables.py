"""Polynomials of many pieces at points in these: several for each piece, such as a function and its derivatives.

Values are those of Horner's rule (see `pas.algebra.kernels`), the same bits on every machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from pas.algebra.kernels import order_of_rule
from pas.algebra.monomials import Floats
from pas.kernels.library import Functions
from pas.limits import checkpoint

BLOCK = 1 << 15
"""Points worked on between two looks at the clock."""


@dataclass(frozen=True)
class Rows:
    """The degrees (P, m) of m polynomials on each of P pieces, and all their coefficients, in the order in which
    Horner's rule meets them; those of each piece begin at `starts` (P,)."""

    degrees: NDArray[np.intp]
    starts: NDArray[np.intp]
    coefficients: Floats

    @classmethod
    def of_kinds(cls, tables: Sequence[PieceTables], kinds: NDArray[np.intp], places: NDArray[np.intp]) -> Rows:
        """Those of P pieces, each of which stands in the table number `kinds` (P,) at `places` (P,)."""
        every = [table.ordered for table in tables]
        first = np.cumsum([0, *(len(rows.coefficients) for rows in every)])
        degrees = np.array([every[k].degrees[p] for k, p in zip(kinds, places, strict=True)])
        starts = [first[k] + every[k].starts[p] for k, p in zip(kinds, places, strict=True)]
        return cls(degrees, np.array(starts), np.concatenate([rows.coefficients for rows in every]))

    def __call__(self, points: Floats, pieces: NDArray[np.intp]) -> Floats:
        """The values (m, N) at points (N, 3) of pieces of given numbers (N,)."""
        result = np.empty((self.degrees.shape[1], len(points)))
        tables = (*self.degrees.shape, self.degrees, self.starts, self.coefficients)
        for start in range(0, len(points), BLOCK):
            checkpoint()
            here, whole = slice(start, start + BLOCK), len(points) <= BLOCK
            out = result if whole else np.empty((len(result), len(points[here])))
            _functions().call("pas_mixed", *tables, len(points[here]), points[here], pieces[here], out)
            if not whole:
                result[:, here] = out
        return result


class PieceTables:
    """The coefficients (P, m, C(n+3, 3)) of m polynomials on each of P pieces, number k of degree `degrees[k]`."""

    def __init__(self, tables: Floats, degrees: tuple[int, ...]) -> None:
        self._tables, self._degrees = tables, degrees

    def first(self, number: int) -> PieceTables:
        """The first so many polynomials alone."""
        return PieceTables(self._tables[:, :number], self._degrees[:number])

    def __call__(self, points: Floats, pieces: NDArray[np.intp]) -> Floats:
        """The values (m, N) at points (N, 3) of pieces of given numbers (N,)."""
        return self.ordered(points, pieces)

    @cached_property
    def ordered(self) -> Rows:
        """The coefficients in the order of Horner's rule."""
        rows = np.concatenate([self._tables[:, k, order_of_rule(n)] for k, n in enumerate(self._degrees)], axis=1)
        degrees = np.tile(np.array(self._degrees, dtype=np.intp), (len(rows), 1))
        return Rows(degrees, np.arange(len(rows)) * rows.shape[1], rows.ravel())


@cache
def _functions() -> Functions:
    return Functions()
