"""Polynomials of many pieces at points in these: several for each piece, such as a function and its derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
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


@dataclass(frozen=True)
class Rows:
    """The degrees (P, m) of m polynomials on each of P pieces, and all their coefficients, in the order in which
    compiled code meets them; those of each piece begin at `starts` (P,)."""

    degrees: NDArray[np.intp]
    starts: NDArray[np.intp]
    coefficients: Floats


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
        kernel = chosen()
        if isinstance(kernel, CompiledKernel):
            return _in_blocks(kernel, self.ordered, points, pieces)
        result = np.empty((len(self._degrees), len(points)))
        with np.errstate(all="ignore"):  # what overflows is infinite or NaN, without a word by any kernel
            for start in range(0, len(points), BLOCK):
                checkpoint()
                here = slice(start, start + BLOCK)
                self._one_by_one(kernel, points[here], pieces[here], result[:, here])
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
    def ordered(self) -> Rows:
        """The tables as compiled code wants them."""
        rows = np.concatenate([self._tables[:, k, order_of_rule(n)] for k, n in enumerate(self._degrees)], axis=1)
        degrees = np.tile(np.array(self._degrees, dtype=np.intp), (len(rows), 1))
        return Rows(degrees, np.arange(len(rows)) * rows.shape[1], rows.ravel())


class MixedTables:
    """The same of pieces whose polynomials may have other degrees on each; given are tables of pieces of equal degrees,
    and of each piece which table it is in, and where."""

    def __init__(self, tables: Sequence[PieceTables], kinds: NDArray[np.intp], places: NDArray[np.intp]) -> None:
        self._tables, self._kinds, self._places = tables, kinds, places

    def __call__(self, points: Floats, pieces: NDArray[np.intp]) -> Floats:
        """The values (m, N) at points (N, 3) of pieces of given numbers (N,)."""
        kinds = self._kinds[pieces]
        found = np.flatnonzero(np.bincount(kinds))
        if len(found) == 1:
            return self._tables[int(found[0])](points, self._places[pieces])
        kernel = chosen()
        if isinstance(kernel, CompiledKernel):
            return _in_blocks(kernel, self._ordered, points, pieces)
        result = np.empty((self._ordered.degrees.shape[1], len(points)))
        for kind in found.tolist():
            rows = np.flatnonzero(kinds == kind)
            result[:, rows] = self._tables[kind](points[rows], self._places[pieces[rows]])
        return result

    @cached_property
    def _each(self) -> int:
        """Coefficients of a piece in the mean."""
        return len(self._ordered.coefficients) // max(len(self._kinds), 1)

    @cached_property
    def _ordered(self) -> Rows:
        every = [table.ordered for table in self._tables]
        first = np.cumsum([0, *(len(rows.coefficients) for rows in every)])
        degrees = np.array([every[k].degrees[p] for k, p in zip(self._kinds, self._places, strict=True)])
        starts = [first[k] + every[k].starts[p] for k, p in zip(self._kinds, self._places, strict=True)]
        return Rows(degrees, np.array(starts), np.concatenate([rows.coefficients for rows in every]))


def _in_blocks(kernel: CompiledKernel, rows: Rows, points: Floats, pieces: NDArray[np.intp]) -> Floats:
    """Values (m, N) by compiled code."""
    result = np.empty((rows.degrees.shape[1], len(points)))
    for start in range(0, len(points), BLOCK):
        checkpoint()
        here, whole = slice(start, start + BLOCK), len(points) <= BLOCK
        out = result if whole else np.empty((len(result), len(points[here])))
        kernel.on_pieces(rows, points[here], pieces[here], out)
        if not whole:
            result[:, here] = out
    return result


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
