"""Bernstein forms of a polynomial and its gradient on many triangles, with a bound on their rounding.

Values at the lattice points of each triangle, times the inverse of the Bernstein polynomials' values there, which is
exact before it is rounded.  With |x| <= r in each coordinate, the points err by 4 u r, and by 2 u r for each time that
a triangle was cut at middles of its sides, in all by at most 20 u r, values by Horner's rule by
2 (n + 3) u sum |c| r^|a| (see `pas.algebra.evaluation`), the product with m columns by (m + 2) u times the sizes, and
so does the one that raises the degree.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from math import comb, prod

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.evaluation import horner, order_of_rule
from pas.algebra.monomials import exponents, homogeneous_exponents, multinomial
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float
from pas.arrays import Bools, Floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.kernels.library import compiled
from pas.limits import checkpoint

ELEVATED = 3
"""Values are bounded by B-coefficients of a degree so many times as high, which are nearer."""


class TriangleForms:
    """The conversion of one polynomial, as of one degree, to forms on triangles with coordinates up to `reach`.

    B-coefficients are off by at most `value_error`, those of its gradient by `gradient_error`.
    """

    def __init__(self, polynomial: Polynomial, degree: int, reach: float) -> None:
        self.degree = degree
        self._value = polynomial.dense(degree)[None]
        self._gradient = np.array([polynomial.diff(axis).dense(degree - 1) for axis in range(3)])
        self.value_error = _rounding(self._value, degree, reach)
        self.gradient_error = _rounding(self._gradient, degree - 1, reach)

    def ranges(self, corners: Floats, closer: bool = False) -> tuple[Floats, Floats]:
        """The least and the largest B-coefficient (T,) of f on triangles (T, 3, 3), `closer` those of a higher degree,
        which are nearer to its values."""
        raising = elevation(self.degree, ELEVATED * self.degree) if closer else None
        table, (places, inverse, _) = self._value[0, order_of_rule(self.degree)], lattice(self.degree)
        higher = (0, places) if raising is None else (len(raising), raising)
        low, high = np.empty((2, len(corners)))
        for here in _blocks(len(corners)):
            given = (self.degree, len(places), places, inverse, *higher, table, len(corners[here]), corners[here])
            compiled().call("pas_ranges", *given, low[here], high[here])
        return low, high

    def slopes(self, corners: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """On triangles (T, 3, 3) the least B-coefficient (T,) of the derivative along normals (T, 3), and the largest
        size (T,) of those of the gradient."""
        degree = self.degree - 1
        table, (places, inverse, _) = self._gradient[:, order_of_rule(degree)], lattice(degree)
        least, sizes = np.empty((2, len(corners)))
        for here in _blocks(len(corners)):
            given = (degree, len(places), places, inverse, table, len(corners[here]), corners[here], normals[here])
            compiled().call("pas_slopes", *given, least[here], sizes[here])
        return least, np.sqrt(sizes)

    def gradients(self, corners: Floats) -> Floats:
        """The B-coefficients (3, k, T) of its gradient on triangles (T, 3, 3)."""
        places, inverse, _ = lattice(self.degree - 1)
        points = np.ascontiguousarray(np.tensordot(places, corners, axes=(1, 1)).transpose(2, 0, 1))
        values = horner(self._gradient, self.degree - 1, points.reshape(3, -1))
        return np.asarray(np.matmul(inverse, values.reshape(3, len(places), -1)))


def _blocks(number: int) -> Iterator[slice]:
    size = 4096  # what is needed of so many triangles stays in the caches
    for start in range(0, number, size):
        checkpoint(f"bounding the function on triangles ({start} of {number})")
        yield slice(start, start + size)


def _rounding(tables: Floats, degree: int, reach: float) -> float:
    """How much B-coefficients on triangles may be off."""
    powers = np.array([sum(e) for e in exponents(degree)])
    size = float((np.abs(tables) * reach**powers).sum(axis=1).max())
    slope = float((np.abs(tables) * powers * reach ** np.maximum(powers - 1, 0)).sum(axis=1).max())
    places, _, norm = lattice(degree)
    each = (2 * (degree + 3) + 2 * len(places) + 5) * size + 20 * reach * slope
    return 2 * norm * UNIT_ROUNDOFF * each  # twice, for products of roundings, which are left out


@cache
def lattice(degree: int) -> tuple[Floats, Floats, float]:
    """The lattice points' barycentric coordinates (m, 3), the matrix (m, m) from values there to B-coefficients in the
    order of `homogeneous_exponents(degree, 3)`, and its largest row sum of sizes."""
    indices = homogeneous_exponents(degree, 3)
    if degree == 0:
        return np.full((1, 3), 1 / 3), np.ones((1, 1)), 1.0
    weights = list(map(multinomial, indices))
    entries = [
        fmpq(w * prod(p**e for p, e in zip(point, a, strict=True)), degree**degree)
        for point in indices
        for a, w in zip(indices, weights, strict=True)
    ]
    inverse = fmpq_mat(len(indices), len(indices), entries).inv()
    matrix = np.array([[to_float(v) for v in row] for row in inverse.tolist()])
    return np.array(indices) / degree, matrix, float(np.abs(matrix).sum(axis=1).max())


@cache
def elevation(degree: int, higher: int) -> Floats:
    """The matrix from B-coefficients on triangles to those of a higher degree; rows are weights of sum 1."""
    source, target = homogeneous_exponents(degree, 3), homogeneous_exponents(higher, 3)
    whole = comb(higher, degree)
    rows = [[prod(comb(e, s) for e, s in zip(high, low, strict=True)) / whole for low in source] for high in target]
    return np.array(rows)


@cache
def on_corners(degree: int, corners: int = 3) -> Bools:
    """Which B-coefficients (2^n, m) on a simplex of n corners are those on the part that some of these span: those of
    the numbers k for which the bit 2^k is set."""
    used = np.array(homogeneous_exponents(degree, corners)) > 0
    marked = np.arange(1 << corners)[:, None] >> np.arange(corners) & 1 > 0
    return np.asarray((marked[:, None] | ~used).all(axis=2))
