"""Many polynomials evaluated together, and bounded over boxes.

All are evaluated by one matrix product.  Over a box a polynomial is bounded by its Taylor expansion
about the centre, which is exact: `|p(c + u) - p(c)| <= sum over a != 0 of |p^(a)(c)| / a! r^a` for
`|u_i| <= r_i`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from pas.algebra.monomials import CHUNK_ENTRIES, Floats, count, evaluate, exponents, positions
from pas.algebra.polynomial import Polynomial
from pas.solid.tree import Bools

BOX_CHUNK = 1 << 22
"""Numbers held at once while boxes are bounded."""


class Bank:
    """M polynomials as doubles."""

    def __init__(self, polynomials: Sequence[Polynomial]) -> None:
        self.polynomials = tuple(polynomials)
        self._jet_matrices: dict[int, Floats] = {}

    def __len__(self) -> int:
        return len(self.polynomials)

    def signs(self, points: Floats) -> Bools:
        """Which polynomials (M, N) are <= 0 at points (N, 3)."""
        result = np.empty((len(self), len(points)), dtype=bool)
        step = max(1, CHUNK_ENTRIES // max(len(self._matrix), 1))
        for start in range(0, len(points), step):
            result[:, start : start + step] = self.values(points[start : start + step]) <= 0
        return result

    def values(self, points: Floats) -> Floats:
        """Values (M, N) at points (N, 3)."""
        return evaluate(points, self._matrix).T

    def jets(self, number: int, points: Floats) -> Floats:
        """Values and gradients (N, 4) of one polynomial at points (N, 3)."""
        if number not in self._jet_matrices:
            p = self.polynomials[number]
            degree = max(p.degree, 0)
            columns = [q.dense(degree) for q in (p, *map(p.diff, range(3)))]
            self._jet_matrices[number] = np.stack(columns, axis=1)
        return evaluate(points, self._jet_matrices[number])

    def taylor(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools, Floats]:
        """Which polynomials (M, N) are certainly <= 0 and > 0 in boxes of half edges (N, 3).

        Also a bound (M, N) for the second-order part of what a polynomial changes inside the box.
        """
        yes, no = np.zeros((2, len(self), len(centers)), dtype=bool)
        second = np.zeros((len(self), len(centers)))
        table = self._derivatives
        size = table.shape[2]
        step = max(1, BOX_CHUNK // max(1, table.shape[1] * size))
        for start in range(0, len(centers) if len(self) else 0, step):
            part = slice(start, start + step)
            values = evaluate(centers[part], table.reshape(table.shape[0], -1))
            values = values.reshape(len(values), len(self), size)
            powers = _powers(halves[part], self._degree)
            change = np.einsum("nmk,nk->mn", np.abs(values[:, :, 1:]), powers[:, 1:])
            yes[:, part] = values[:, :, 0].T + change <= 0
            no[:, part] = values[:, :, 0].T - change > 0
            second[:, part] = np.einsum("nmk,nk->mn", np.abs(values) * self._second_order, powers)
        return yes, no, second

    def gradient_bounds(self, centers: Floats, half: float, second: Floats) -> tuple[Bools, Bools]:
        """As `taylor` for cubes, given bounds (M, N) of second-order changes for cubes of this size."""
        yes, no = np.zeros((2, len(self), len(centers)), dtype=bool)
        if len(self):
            jets = np.concatenate([self._gradient_matrix, self._matrix], axis=1)
            step = max(1, BOX_CHUNK // jets.shape[1])
            for start in range(0, len(centers), step):
                part = slice(start, start + step)
                values = evaluate(centers[part], jets).T.reshape(4, len(self), -1)
                change = np.abs(values[:3]).sum(axis=0) * half + second[:, part]
                yes[:, part], no[:, part] = values[3] + change <= 0, values[3] - change > 0
        return yes, no

    def shares(self, centers: Floats, half: Floats) -> Floats:
        """How much of its change in boxes each polynomial owes to each side (N, M, 3); sums are 1 or 0."""
        table = self._derivatives
        values = evaluate(centers, table.reshape(table.shape[0], -1))
        values = np.abs(values.reshape(len(centers), len(self), -1))
        terms = values * _powers(np.broadcast_to(half, (len(centers), 3)), self._degree)[:, None]
        parts = terms @ np.array(exponents(self._degree), dtype=float)
        return np.asarray(parts / np.maximum(parts.sum(axis=2, keepdims=True), 1e-300))

    @cached_property
    def _degree(self) -> int:
        return max((p.degree for p in self.polynomials), default=0)

    @cached_property
    def _matrix(self) -> Floats:
        """The coefficients as columns (count, M)."""
        matrix = np.zeros((count(self._degree), len(self)))
        for k, p in enumerate(self.polynomials):
            matrix[:, k] = p.dense(self._degree)
        return matrix

    @cached_property
    def _gradient_matrix(self) -> Floats:
        """Coefficients of all first derivatives, the x ones first (count, 3 M)."""
        return np.concatenate([_shift_operator(self._degree, i) @ self._matrix for i in range(3)], axis=1)

    @cached_property
    def _derivatives(self) -> Floats:
        """Coefficients (count, M, count) of `p^(a) / a!` for each polynomial and exponent a."""
        degree, matrix = self._degree, self._matrix
        where = positions(degree)
        table = np.zeros((len(matrix), len(self), len(matrix)))
        operators = [_shift_operator(degree, i) for i in range(3)]
        table[:, :, 0] = matrix
        for e in exponents(degree)[1:]:
            axis = next(i for i in range(3) if e[i])
            lower = tuple(v - (i == axis) for i, v in enumerate(e))
            table[:, :, where[e]] = operators[axis] @ table[:, :, where[lower]] / e[axis]
        return table

    @cached_property
    def _second_order(self) -> Floats:
        """How often each Taylor term counts in a bound of the second-order change: C(|a|, 2)."""
        orders = np.array([sum(e) for e in exponents(self._degree)])
        return orders * (orders - 1) / 2.0


def _powers(half: Floats, degree: int) -> Floats:
    """`r^a` for all exponents (N, count)."""
    table = np.array(exponents(degree))
    result = np.ones((len(half), len(table)))
    for axis in range(3):
        result *= half[:, axis, None] ** table[:, axis]
    return result


def _shift_operator(degree: int, axis: int) -> Floats:
    """The matrix that maps a polynomial's coefficients to those of its derivative."""
    where = positions(degree)
    result = np.zeros((len(where), len(where)))
    for e, column in where.items():
        if e[axis]:
            result[where[tuple(v - (i == axis) for i, v in enumerate(e))], column] = e[axis]
    return result
