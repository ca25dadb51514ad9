"""Sums and products of B-forms in doubles, many simplices at once, with bounds on their rounding.

The coefficients of a product are `sum_(b + b' = a) C(a, b) / C(n + m, n) c_b c'_b'`, C(a, b) the product of the
entries' binomials (Farin 2002, chapter 17): means of products, whose weights are not negative and have the sum 1.
Of T terms, with weights that took at most five roundings, two products each and T - 1 sums, a coefficient errs by at
most 1.01 (T + 7) 2^-53 of the product of the largest sizes (Higham 2002, section 3.1).  That is counted twice, which
does for products of roundings and, where the largest coefficient is above `SMALLEST`, for underflow.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import comb

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, homogeneous_exponents
from pas.bernstein.forms import SMALLEST, UNIT_ROUNDOFF


@dataclass(frozen=True, eq=False)
class BoundedForms:
    """The B-coefficients (N, m) of polynomials on N tetrahedra, those of each off by at most `error` (N,)."""

    values: Floats
    degree: int
    error: Floats

    @property
    def size(self) -> Floats:
        """What no coefficient is larger than, (N,)."""
        return np.asarray(np.abs(self.values).max(axis=1) + self.error)

    def __add__(self, other: BoundedForms) -> BoundedForms:
        degree = max(self.degree, other.degree)
        first, second = self.raised(degree), other.raised(degree)
        error = first.error + second.error + 2 * UNIT_ROUNDOFF * (first.size + second.size)
        return BoundedForms(first.values + second.values, degree, error)

    def __sub__(self, other: BoundedForms) -> BoundedForms:
        return self + other * -1.0

    def __mul__(self, other: BoundedForms | float) -> BoundedForms:
        """The product with others, or with a number that is a rounded one."""
        if not isinstance(other, BoundedForms):
            return BoundedForms(
                self.values * other, self.degree, abs(other) * (self.error + 4 * UNIT_ROUNDOFF * self.size)
            )
        if len(other.values[0]) > len(self.values[0]):
            return other * self
        where, weights = _terms(self.degree, other.degree)
        result = np.zeros((len(homogeneous_exponents(self.degree + other.degree, 4)), len(self.values)))
        first = np.ascontiguousarray(self.values.T)
        for place, weight, factor in zip(where, weights, other.values.T, strict=True):
            result[place] += weight[:, None] * first * factor
        rounding = 2 * (len(where) + 7) * UNIT_ROUNDOFF * self.size * other.size
        error = self.size * other.error + self.error * other.size + rounding
        return BoundedForms(np.ascontiguousarray(result.T), self.degree + other.degree, error)

    def raised(self, degree: int) -> BoundedForms:
        """These polynomials as of a higher degree."""
        if degree == self.degree:
            return self
        one = np.ones((len(self.values), len(homogeneous_exponents(degree - self.degree, 4))))
        return self * BoundedForms(one, degree - self.degree, np.zeros(len(one)))

    def scaled(self) -> tuple[Floats, float]:
        """Coefficients (N, m) over the largest of each, and by how much one may be off: 1 below `SMALLEST`."""
        largest = np.abs(self.values).max(axis=1)
        known = largest > SMALLEST
        size = np.where(known, largest, 1.0)
        off = np.where(known, self.error / size, 1.0).max(initial=0.0)
        return self.values / size[:, None], float(off) + UNIT_ROUNDOFF


@cache
def _terms(degree: int, other: int) -> tuple[NDArray[np.intp], Floats]:
    """Of each multi-index b of the second degree, where those of the first plus b stand, and the weights, (k, m)."""
    first, second = (np.array(homogeneous_exponents(n, 4)) for n in (degree, other))
    whole = degree + other
    binomials = np.array([[comb(n, k) for k in range(whole + 1)] for n in range(whole + 1)], dtype=float)
    number = np.zeros((whole + 1,) * 3, dtype=np.intp)
    number[tuple(np.array(homogeneous_exponents(whole, 4)).T[:3])] = np.arange(comb(whole + 3, 3))
    total = second[:, None] + first
    weights = np.prod(binomials[total, second[:, None]], axis=2) / comb(whole, degree)
    return number[tuple(np.moveaxis(total, 2, 0)[:3])], weights
