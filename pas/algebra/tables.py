"""Polynomials of many pieces at points in these: several for each piece, such as a function and its derivatives."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.algebra.compiled import CompiledKernel, order_of_rule
from pas.algebra.kernels import Kernel, chosen
from pas.algebra.monomials import Floats, count
from pas.limits import checkpoint

BLOCK = 1 << 15
"""Points worked on between two looks at the clock."""

MANY, EACH = 8, 256
"""Pieces above which, and points of each below which, calls for each piece outweigh the work for numpy."""


class PieceTables:
    """The coefficients (P, m, C(n+3, 3)) of m polynomials on each of P pieces, number k of degree `degrees[k]`.

    Values are those of Horner's rule (see `pas.algebra.kernels`), the same bits on every machine.
    """

    def __init__(self, tables: Floats, degrees: tuple[int, ...]) -> None:
        self._tables, self._degrees = tables, degrees

    def first(self, number: int) -> PieceTables:
        """The first so many polynomials alone."""
        return PieceTables(self._tables[:, :number], self._degrees[:number])

    def __call__(self, points: Floats, pieces: NDArray[np.intp]) -> Floats:
        """The values (m, N) at points (N, 3) of pieces of given numbers (N,)."""
        result = np.empty((len(self._degrees), len(points)))
        kernel = chosen(self._tables[0].size * len(points))
        with np.errstate(all="ignore"):  # what overflows is infinite or NaN, without a word by any kernel
            for start in range(0, len(points), BLOCK):
                checkpoint()
                here = slice(start, start + BLOCK)
                whole = len(points) <= BLOCK
                out = result if whole else np.empty((len(result), len(points[here])))
                if isinstance(kernel, CompiledKernel):
                    kernel.on_pieces(self, points[here], pieces[here], out)
                else:
                    self._one_by_one(kernel, points[here], pieces[here], out)
                if not whole:
                    result[:, here] = out
        return result

    def _one_by_one(self, kernel: Kernel, points: Floats, pieces: NDArray[np.intp], out: Floats) -> None:
        """The same by calls for each piece and degree; where pieces have few points each, for each coefficient."""
        used = np.flatnonzero(np.bincount(pieces, minlength=len(self._tables)))
        if len(used) > MANY and len(points) < EACH * len(used):
            for number, degree in enumerate(self._degrees):
                out[number] = _rule(self._tables[pieces, number], degree, points)
            return
        for piece in used:
            rows = np.flatnonzero(pieces == piece)
            places = np.ascontiguousarray(points[rows].T)
            for degree in sorted(set(self._degrees)):
                numbers = np.flatnonzero(np.array(self._degrees) == degree)
                found = np.empty((len(numbers), len(rows)))
                kernel(self._tables[piece, numbers, : count(degree)], degree, places, found)
                out[np.ix_(numbers, rows)] = found

    @cached_property
    def ordered(self) -> tuple[NDArray[np.intp], Floats]:
        """The degrees (m,), and the tables of each piece as a row, in the order in which compiled code meets them."""
        rows = [self._tables[:, k, order_of_rule(n)] for k, n in enumerate(self._degrees)]
        return np.array(self._degrees, dtype=np.intp), np.ascontiguousarray(np.concatenate(rows, axis=1))


def _rule(coefficients: Floats, degree: int, points: Floats) -> Floats:
    """Horner's rule at points (N, 3), each with a polynomial of its own (N, C(n+3, 3) or more)."""
    (x, y, z), columns = points.T, iter(coefficients[:, order_of_rule(degree)].T)
    result = np.zeros(len(points))
    for i in range(degree + 1):
        in_y = np.zeros(len(points))
        for j in range(i + 1):
            in_z = next(columns)
            for _ in range(j):
                in_z = in_z * z + next(columns)
            in_y = in_y * y + in_z if j else in_z
        result = result * x + in_y if i else in_y
    return result
