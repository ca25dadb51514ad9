"""Differential geometry of a surface f = 0 at points, from the derivatives of f up to the third order.

In a frame T1, T2, n of principal directions and outward normal, with L = |grad f|:

    S_ab  = H_ab / L                                                       shape operator
    C_abc = (F_abc - S_ab H_cn - S_ca H_bn - S_cb H_an) / L                its covariant derivative

with the second derivatives H and the third F of f in the frame.  S is positive where the surface bends like a
ball that is inside.  C is symmetric (Codazzi).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise, product
from math import perm, prod

import numpy as np

from pas.algebra.evaluation import PolynomialBatch, degree_of
from pas.algebra.monomials import count, exponents, homogeneous_exponents, positions
from pas.arrays import Floats, Integers

JETS = tuple(e for d in range(4) for e in homogeneous_exponents(d, 3))
"""The derivatives of f that are used, by exponents: value, gradient, Hessian, third order; 20 in all."""

ORDERS = np.array([sum(e) for e in JETS])


def _places(order: int) -> Integers:
    """Where in a jet the derivatives (3, ..., 3) of an order along axes stand."""
    axes = product(range(3), repeat=order)
    return np.reshape([JETS.index((a.count(0), a.count(1), a.count(2))) for a in axes], (3,) * order)


FIRST, SECOND, THIRD = map(_places, range(1, 4))
"""Where the entries of gradient, Hessian and third derivatives stand in a jet."""


def symmetric(entries: Floats, order: int) -> Floats:
    """All derivatives (..., 3, ..., 3) of an order, from one of each kind (..., entries)."""
    return entries[..., _places(order) - JETS.index((order, 0, 0))]


def derivative_batch(columns: Sequence[Floats], orders: Sequence[int]) -> PolynomialBatch:
    """The partial derivatives of some orders up to 3 of polynomials, one on each piece, in the order of `JETS`.

    `columns` are the coefficients (C(n+3, 3),) of each.
    """
    rows = [row for row, order in enumerate(ORDERS.tolist()) if order in orders]
    pieces = []
    for column in columns:
        degree = degree_of(len(column))
        table = derived(column, degree)
        pieces.append([table[row][: count(max(degree - int(ORDERS[row]), 0))] for row in rows])
    return PolynomialBatch.of(pieces, len(rows))


def profile_batch(columns: Sequence[Floats], degree: int) -> PolynomialBatch:
    """The parts of each degree from 0 to n of polynomials, one on each piece: along the ray to a point x they are the
    coefficients of f(t x) at t^0, ..., t^n.  `columns` are all coefficients of each, up to n or a lower degree."""
    ends = [count(k) for k in range(-1, degree + 1)]
    pieces = []
    for column in columns:
        parts = np.zeros((degree + 1, ends[-1]))
        for k, (start, end) in enumerate(pairwise(ends)):
            parts[k, start : min(end, len(column))] = column[start:end]
        pieces.append([part[: ends[k + 1]] for k, part in enumerate(parts)])
    return PolynomialBatch.of(pieces, degree + 1)


def derived(column: Floats, degree: int) -> Floats:
    """The coefficients (20, C(n+3, 3)) of a polynomial and its derivatives, in the order of `JETS`."""
    places, sources, factors = _scattered(degree)
    result = np.zeros((len(JETS), len(column)))
    result.ravel()[places] = factors * column[sources]
    return result


class Geometry:
    """Frames, shape operators and their covariant derivatives, of jets (N, 20).

    Inside, the points come last, so that all components are worked out for all points at once: `axes` (3, 3, N), the
    vectors of the frame as rows, `second` (3, 3, N) and `third` (2, 2, 3, N), the derivatives in the frame.
    """

    def __init__(self, jets: Floats) -> None:
        jet = np.ascontiguousarray(jets.T)
        g, hessian, third = jet[FIRST], jet[SECOND], jet[THIRD]
        self.length = np.sqrt((g * g).sum(axis=0))
        n = g / self.length
        t1, t2 = tangent_frame(n)
        along, across = (hessian * t1).sum(axis=1), (hessian * t2).sum(axis=1)
        angle = 0.5 * np.arctan2(2 * (along * t2).sum(axis=0), (along * t1).sum(axis=0) - (across * t2).sum(axis=0))
        cos, sin = np.cos(angle), np.sin(angle)
        self.axes = np.stack([cos * t1 + sin * t2, cos * t2 - sin * t1, n])
        self.second = _along(_along(hessian, self.axes), self.axes)
        tangents = self.axes[:2]
        self.third = _along(_along(_along(third, self.axes), tangents), tangents)
        self._shape = self.second[:2, :2] / self.length
        s, h = self._shape, self.second[:2, 2]
        self._variation = (
            self.third[:, :, :2] - s[:, :, None] * h - s[:, None] * h[:, None] - s * h[:, None, None]
        ) / self.length

    @property
    def frame(self) -> Floats:
        """The vectors T1, T2, n of the frame as columns (N, 3, 3)."""
        return self.axes.transpose(2, 1, 0)

    @property
    def shape(self) -> Floats:
        """The shape operator in the frame (N, 2, 2)."""
        return self._shape.transpose(2, 0, 1)

    @property
    def variation(self) -> Floats:
        """Its covariant derivative in the frame (N, 2, 2, 2)."""
        return self._variation.transpose(3, 0, 1, 2)

    @property
    def normals(self) -> Floats:
        """Outward unit normals (N, 3)."""
        return self.axes[2].T

    @property
    def principal(self) -> Floats:
        """Principal curvatures (N, 2), the larger first."""
        return np.stack([self._shape[0, 0], self._shape[1, 1]], axis=1)


def tangent_frame(n: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors (3, N) across unit normals (3, N) and across one another."""
    zero = np.zeros_like(n[0])
    t1 = np.where(np.abs(n[0]) < 0.6, [zero, n[2], -n[1]], [-n[2], zero, n[0]])  # across the first or second axis
    t1 /= np.sqrt((t1 * t1).sum(axis=0))
    t2 = np.stack([n[1] * t1[2] - n[2] * t1[1], n[2] * t1[0] - n[0] * t1[2], n[0] * t1[1] - n[1] * t1[0]])
    return t1, t2


def _along(form: Floats, vectors: Floats) -> Floats:
    """A multilinear form (..., 3, N) with vectors (k, 3, N) for its last argument, which then comes first."""
    between = (1,) * (form.ndim - 2)
    return (form * vectors.reshape(len(vectors), *between, 3, -1)).sum(axis=-2)


@cache
def derivatives(degree: int) -> tuple[Integers, Floats]:
    """For each jet entry and monomial: the monomial that its derivative is a multiple of, and the factor."""
    where, table = positions(degree), exponents(degree)
    indices, factors = np.zeros((len(JETS), len(table)), dtype=np.intp), np.zeros((len(JETS), len(table)))
    for (row, jet), (column, e) in product(enumerate(JETS), enumerate(table)):
        factors[row, column] = prod(map(perm, e, jet))  # 0 where an exponent of the derivative is larger
        indices[row, column] = where.get(tuple(p - q for p, q in zip(e, jet, strict=True)), 0)
    return indices, factors


@cache
def _scattered(degree: int) -> tuple[Integers, Integers, Floats]:
    """Where in a table (20, C(n+3, 3)) the coefficients of derivatives stand, and of which they are what multiples."""
    indices, factors = derivatives(degree)
    rows, sources = np.nonzero(factors)
    return rows * factors.shape[1] + indices[rows, sources], sources, factors[rows, sources]
