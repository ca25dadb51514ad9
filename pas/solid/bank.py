"""Many polynomials evaluated together, and bounded over boxes.

All are evaluated by one matrix product.  Over a box a polynomial is bounded by its Taylor expansion
about the centre, which is exact: `|p(c + u) - p(c)| <= sum over a != 0 of |p^(a)(c)| / a! r^a` for
`|u_i| <= r_i`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.algebra.kernels import CHUNK_ENTRIES, evaluate, horner
from pas.algebra.monomials import Floats, count, exponents, positions
from pas.algebra.polynomial import Polynomial
from pas.limits import checkpoint
from pas.solid.tree import Bools

Integers = NDArray[np.intp]

BOX_CHUNK = 1 << 22
"""Numbers held at once while boxes are bounded."""


class Bank:
    """M polynomials as doubles."""

    def __init__(self, polynomials: Sequence[Polynomial]) -> None:
        self.polynomials = tuple(polynomials)
        self._jet_tables: dict[int, Floats] = {}

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
        return evaluate(points, self._matrix).T if len(self) else np.empty((0, len(points)))

    def jets(self, number: int, points: Floats) -> Floats:
        """Values and gradients (N, 4) of one polynomial at points (N, 3)."""
        checkpoint()
        degree = max(self.polynomials[number].degree, 0)
        if number not in self._jet_tables:
            p = self.polynomials[number]
            self._jet_tables[number] = np.stack([q.dense(degree) for q in (p, *map(p.diff, range(3)))])
        values = np.empty((4, len(points)))
        horner(self._jet_tables[number], degree, np.ascontiguousarray(points.T), values)
        return values.T

    def jets_of(self, numbers: Integers, points: Floats) -> Floats:
        """Values and gradients (N, 4) at points (N, 3), each of a polynomial of its own (N,).

        Planes and quadrics, of which machines have hundreds, are evaluated together.
        """
        result = np.empty((len(points), 4))
        table, low = self._quadrics
        rows = np.flatnonzero(low[numbers])
        p, (constant, slopes, bends) = points[rows], np.split(table[numbers[rows]], (1, 4), axis=1)
        bent = np.einsum("nij,nj->ni", bends.reshape(-1, 3, 3), p)
        result[rows, 0] = constant[:, 0] + ((slopes + bent / 2) * p).sum(axis=1)
        result[rows, 1:] = slopes + bent
        rows = np.flatnonzero(~low[numbers])
        rows = rows[np.argsort(numbers[rows], kind="stable")]
        for own in np.split(rows, np.flatnonzero(np.diff(numbers[rows])) + 1):
            if len(own):
                result[own] = self.jets(int(numbers[own[0]]), points[own])
        return result

    @cached_property
    def _quadrics(self) -> tuple[Floats, Bools]:
        """Value, gradient and second derivatives at 0 (M, 13) of polynomials, and which (M,) are told by these."""
        low = np.array([p.degree <= 2 for p in self.polynomials], dtype=bool)
        table = np.zeros((len(self), 13))
        for row in np.flatnonzero(low):
            p = self.polynomials[row]
            slopes = [p.diff(i) for i in range(3)]
            known = (p, *slopes, *(s.diff(i) for s in slopes for i in range(3)))
            table[row] = [q.dense(max(q.degree, 0))[0] for q in known]
        return table, low

    def taylor(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Which polynomials (M, N) are certainly <= 0 and > 0 in boxes of half edges (N, 3), or (1, 3) for all."""
        yes, no = np.zeros((2, len(self), len(centers)), dtype=bool)
        for expansion in self._expansions:
            for part, values, powers in expansion.about(centers, halves):
                change = (np.abs(values[:, :, 1:]) @ powers[:, 1:, None])[..., 0]
                yes[expansion.rows, part] = (values[:, :, 0] + change <= 0).T
                no[expansion.rows, part] = (values[:, :, 0] - change > 0).T
        return yes, no

    def slopes(self, chosen: Integers, centers: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """Gradients (m, N, 3) of chosen polynomials at the centres of boxes, and bounds of their changes in these."""
        gradients, changes = np.zeros((2, len(chosen), len(centers), 3))
        for expansion in self._expansions:
            own = np.flatnonzero(np.isin(chosen, expansion.rows))
            table = expansion.exponents
            orders = np.where(table.sum(axis=1, keepdims=True) > 1, table, 0)  # of each term's derivative by x, y, z
            units = [int(np.flatnonzero((table == unit).all(axis=1))[0]) for unit in np.eye(3, dtype=int)]
            members = np.searchsorted(expansion.rows, chosen[own])
            for part, values, powers in expansion.about(centers, halves, members):
                gradients[own, part] = values[:, :, units].transpose(1, 0, 2)
                terms = (np.abs(values) * powers[:, None]) @ orders
                changes[own, part] = terms.transpose(1, 0, 2) / (halves if len(halves) == 1 else halves[part])
        return gradients, changes

    def never_both(self, centers: Floats, halves: Floats) -> Bools:
        """Where two polynomials certainly do not vanish together in boxes (N,): where p - m q has one sign."""
        p, q = self.polynomials
        result = np.zeros(len(centers), dtype=bool)
        for part, values, powers in _Expansion((p, q), np.arange(2), max(p.degree, q.degree, 1)).about(centers, halves):
            terms = values * powers[:, None]
            slopes = terms[:, :, 1:4]
            square = np.maximum((slopes[:, 1] ** 2).sum(axis=1), 1e-300)
            share = (slopes[:, 0] * slopes[:, 1]).sum(axis=1) / square
            both = terms[:, 0] - share[:, None] * terms[:, 1]
            result[part] = np.abs(both[:, 0]) > np.abs(both[:, 1:]).sum(axis=1)
        return result

    @cached_property
    def _expansions(self) -> list[_Expansion]:
        """The polynomials by degree: those of low degree have short expansions."""
        degrees = np.array([max(p.degree, 1) for p in self.polynomials], dtype=np.intp)
        return [_Expansion(self.polynomials, np.flatnonzero(degrees == d), int(d)) for d in np.unique(degrees)]

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


class _Expansion:
    """Taylor expansions of some of the polynomials (their `rows`), all of one degree."""

    def __init__(self, polynomials: Sequence[Polynomial], rows: Integers, degree: int) -> None:
        self.rows, self.exponents = rows, np.array(exponents(degree))
        where = positions(degree)
        size = len(self.exponents)
        self._table = np.zeros((size, len(rows), size))
        self._table[:, :, 0] = np.stack([polynomials[row].dense(degree) for row in rows], axis=1)
        operators = [_shift_operator(degree, i) for i in range(3)]
        for e in exponents(degree)[1:]:  # p^(a) / a! from that of the lower exponent
            axis = next(i for i in range(3) if e[i])
            lower = tuple(v - (i == axis) for i, v in enumerate(e))
            self._table[:, :, where[e]] = operators[axis] @ self._table[:, :, where[lower]] / e[axis]

    def about(
        self, centers: Floats, halves: Floats, members: Integers | slice = slice(None)
    ) -> Iterator[tuple[slice, Floats, Floats]]:
        """Coefficients (n, m, count) about centres, powers (n or 1, count) of half edges, some boxes at a time."""
        table = self._table[:, members]
        step = max(1, BOX_CHUNK // max(1, table[0].size))
        for start in range(0, len(centers) if table.shape[1] else 0, step):
            part = slice(start, start + step)
            values = evaluate(centers[part], table.reshape(len(table), -1))
            yield (
                part,
                values.reshape(len(values), *table.shape[1:]),
                self._powers(halves if len(halves) == 1 else halves[part]),
            )

    def _powers(self, half: Floats) -> Floats:
        """`r^a` for all exponents (N, count)."""
        powers = half[..., None] ** np.arange(self.exponents.max() + 1)
        return np.asarray(np.prod([powers[:, axis, self.exponents[:, axis]] for axis in range(3)], axis=0))


def _shift_operator(degree: int, axis: int) -> Floats:
    """The matrix that maps a polynomial's coefficients to those of its derivative."""
    where = positions(degree)
    result = np.zeros((len(where), len(where)))
    for e, column in where.items():
        if e[axis]:
            result[where[tuple(v - (i == axis) for i, v in enumerate(e))], column] = e[axis]
    return result
