"""Many polynomials evaluated together, and bounded over boxes.

All are evaluated by one matrix product.  Over a box a polynomial is bounded by its Taylor expansion about the centre,
which is exact: `|p(c + u) - p(c)| <= sum over a != 0 of |p^(a)(c)| / a! r^a` for `|u_i| <= r_i`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache, cached_property
from math import comb

import numpy as np

from pas.algebra.evaluation import evaluate
from pas.algebra.monomials import derivative_matrix, exponents, positions
from pas.algebra.polynomial import Polynomial
from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint

HELD = 1 << 22
"""Numbers held at once while boxes are bounded."""


class TaylorForms:
    """M polynomials as doubles."""

    def __init__(self, polynomials: Sequence[Polynomial]) -> None:
        self.polynomials = tuple(polynomials)

    def __len__(self) -> int:
        return len(self.polynomials)

    def values(self, points: Floats, chosen: Integers) -> Floats:
        """Values (m, N) of chosen polynomials at points (N, 3)."""
        return evaluate(points, self._matrix[:, chosen]).T if len(self) else np.empty((0, len(points)))

    def taylor(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Which polynomials (M, N) are certainly <= 0 and > 0 in boxes of half edges (N, 3), or (1, 3) for all."""
        yes, no = np.zeros((2, len(self), len(centers)), dtype=bool)
        for expansion in self._expansions:
            for part, values, powers in expansion.about(centers, halves):
                checkpoint()
                below, above = expansion.range_of(values, powers)
                yes[expansion.rows, part] = (above <= 0).T
                no[expansion.rows, part] = (below > 0).T
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

    @cached_property
    def _expansions(self) -> list[_Expansion]:
        """The polynomials by degree: those of low degree have short expansions."""
        degrees = np.array([max(p.degree, 1) for p in self.polynomials], dtype=np.intp)
        return [_Expansion(self.polynomials, np.flatnonzero(degrees == d), int(d)) for d in np.unique(degrees)]

    @cached_property
    def _matrix(self) -> Floats:
        """The coefficients as columns (count, M)."""
        degree = max(p.degree for p in self.polynomials)
        return np.stack([p.dense(degree) for p in self.polynomials], axis=1)


class _Expansion:
    """Taylor expansions of some of the polynomials (their `rows`), all of one degree."""

    def __init__(self, polynomials: Sequence[Polynomial], rows: Integers, degree: int) -> None:
        self.rows, self.degree, self.exponents = rows, degree, np.array(exponents(degree))
        where = positions(degree)
        size = len(self.exponents)
        self._table = np.zeros((size, len(rows), size))
        self._table[:, :, 0] = np.stack([polynomials[row].dense(degree) for row in rows], axis=1)
        operators = [derivative_matrix(degree, i) for i in range(3)]
        for e in exponents(degree)[1:]:  # p^(a) / a! from that of the lower exponent
            axis = next(i for i in range(3) if e[i])
            lower = tuple(v - (i == axis) for i, v in enumerate(e))
            self._table[:, :, where[e]] = operators[axis] @ self._table[:, :, where[lower]] / e[axis]

    def about(
        self, centers: Floats, halves: Floats, members: Integers | slice = slice(None)
    ) -> Iterator[tuple[slice, Floats, Floats]]:
        """Coefficients (n, m, count) about centres, powers (n or 1, count) of half edges, some boxes at a time."""
        table = self._table[:, members]
        step = max(1, HELD // max(1, table[0].size))
        for start in range(0, len(centers) if table.shape[1] else 0, step):
            part = slice(start, start + step)
            values = evaluate(centers[part], table.reshape(len(table), -1))
            yield (
                part,
                values.reshape(len(values), *table.shape[1:]),
                self._powers(halves if len(halves) == 1 else halves[part]),
            )

    def range_of(self, values: Floats, powers: Floats) -> tuple[Floats, Floats]:
        """The least and greatest values (n, count) that polynomials may have in boxes; see `about`.

        By the Taylor expansion, and where that leaves the sign open by B-coefficients: blends touch the walls in which
        they end, and beside a multiple zero the terms are large, of opposite signs.  Above degree 5 boxes have too many
        B-coefficients for what they tell.
        """
        middle, powers = values[:, :, 0], np.broadcast_to(powers, (len(values), powers.shape[1]))
        change = (np.abs(values[:, :, 1:]) @ powers[:, 1:, None])[..., 0]
        below, above = middle - change, middle + change
        boxes, members = np.nonzero((below <= 0) & (above > 0) & (2 <= self.degree <= 5))
        step = HELD // (self.degree + 1) ** 3
        for start in range(0, len(boxes), step):
            row, member = boxes[start : start + step], members[start : start + step]
            forms = (values[row, member] * powers[row]) @ b_forms(self.degree)
            noise = 1e-13 * change[row, member]  # what rounding leaves unknown of B-coefficients
            below[row, member], above[row, member] = forms.min(axis=1) - noise, forms.max(axis=1) + noise
        return below, above

    def _powers(self, half: Floats) -> Floats:
        """`r^a` for all exponents (N, count)."""
        powers = np.ones((*half.shape, int(self.exponents.max()) + 1))
        np.multiply.accumulate(np.broadcast_to(half[..., None], powers[..., 1:].shape), axis=-1, out=powers[..., 1:])
        x, y, z = (powers[:, axis, self.exponents[:, axis]] for axis in range(3))
        return np.asarray(x * y * z)


@cache
def b_forms(degree: int) -> Floats:
    """The matrix (count, (degree + 1)^3) from coefficients to B-coefficients of degree n in each of three in [-1, 1].

    Those of `u^a` are its polar form at i ones and n - i times -1: mean products of a of these.
    """
    ends = [np.repeat([1.0, -1.0], [i, degree - i]) for i in range(degree + 1)]
    sums = np.array([np.poly(-e) for e in ends]).T  # of all products of a of them
    polar = sums / np.array([comb(degree, a) for a in range(degree + 1)])[:, None]
    x, y, z = (polar[[e[axis] for e in exponents(degree)]] for axis in range(3))
    return np.asarray(np.einsum("ai,aj,ak->aijk", x, y, z).reshape(len(x), -1))
