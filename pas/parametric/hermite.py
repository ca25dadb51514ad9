"""Hermite interpolation: the basis L_ij whose derivatives up to order k at given values are unit vectors, and blends.

With W = prod (h - s_l)^(k+1) and i, j fixed, L_ij is the Taylor polynomial of (h - s_i)^(k+1) / W at
s_i, cut off at degree k - j, times (h - s_i)^j / j! and W / (h - s_i)^(k+1) (Spitzbart 1960; used
for blending by Perez-Diaz and Sendra 2003).  The degree is n(k+1) - 1 at most, and the basis is
unique since the confluent Vandermonde determinant does not vanish.

The Hermite blend is T = sum_i sum_{j<=k} (d^j P_i/dh^j)(t, s_i) L_ij(h) (Perez-Diaz and Sendra 2003, algorithm 1).

In doubles it is evaluated without expanding it, fast and stable: T = sum_i w_i(h) S_i(t, h - s_i),
w_i = prod_{l != i} ((h - s_l)/(s_i - s_l))^(k+1) and S_i the Taylor polynomial of degree k of P_i / w_i at s_i.  The
factors w_i stay factored, and the coefficients of S_i come from Taylor arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, reduce
from itertools import combinations
from math import factorial, prod
from operator import add, mul
from typing import Any

import numpy as np
from flint import fmpq, fmpq_poly

from pas.algebra.evaluation import as_arrays
from pas.algebra.inputs import check_order, short, shown
from pas.algebra.jets import Jet, along, constant, nilpotency, power, variables
from pas.algebra.rational import Exact, plain, rational, to_float, to_fraction
from pas.algebra.rational_function import ONE, RationalFunction
from pas.parametric.series import univariate
from pas.parametric.surface import ParametricSurface


def hermite_basis(values: Sequence[Exact], order: int) -> tuple[tuple[RationalFunction, ...], ...]:
    """The polynomials L[i][j] in h, i = 0..n-1, j = 0..order.

    The m-th derivative of L[i][j] at values[l] is 1 for (l, m) = (i, j), else 0, for m <= order (Spitzbart 1960).
    Raises `ValueError` for equal values or a negative order.
    """
    at, k = distinct(values), check_order(order)
    return tuple(
        tuple(
            RationalFunction.from_lowest_terms(univariate(p * fmpq(1, factorial(j)), 1), ONE)
            for j, p in enumerate(taylor_basis(at, i, k))
        )
        for i in range(len(at))
    )


def hermite_determinant(values: Sequence[Exact], order: int) -> Fraction:
    """The determinant of the interpolation problem, in rows d^j/dh^j at values[i] (i outer, j inner).

    `prod_j (j!)^n prod_{i<r} (s_r - s_i)^((k+1)^2)`, j = 0..k: not zero, so there is one solution (Spitzbart 1960).

    Raises `ValueError` for equal values or an order out of range.
    """
    at, k = distinct(values), check_order(order)
    differences = prod(((b - a) ** ((k + 1) ** 2) for a, b in combinations(at, 2)), start=fmpq(1))
    return to_fraction(differences * prod(factorial(j) ** len(at) for j in range(k + 1)))


def blending_polynomial(values: Sequence[fmpq], order: int) -> fmpq_poly:
    """W = prod (h - s_l)^(k+1)."""
    return prod((fmpq_poly([-s, 1]) for s in values), start=fmpq_poly([1])) ** (order + 1)


def taylor_basis(values: Sequence[fmpq], number: int, order: int) -> list[fmpq_poly]:
    """The basis for Taylor coefficients instead of derivatives: j! L_ij, j = 0..order."""
    node = values[number]
    step = fmpq_poly([-node, 1])
    outer = prod((fmpq_poly([-o / (node - o), 1 / (node - o)]) for o in _others(values, number)), start=fmpq_poly([1]))
    inverse = inverse_series(values, number, order)
    return [outer ** (order + 1) * inverse.truncate(order - j + 1)(step) * step**j for j in range(order + 1)]


def inverse_series(values: Sequence[fmpq], number: int, order: int) -> fmpq_poly:
    """The Taylor polynomial at s_i of prod_{l != i} ((s_i - s_l) / (h - s_l))^(k+1)."""
    node = values[number]
    series = fmpq_poly([1])
    for other in _others(values, number):
        geometric = fmpq_poly([(-1 / (node - other)) ** m for m in range(order + 1)])
        series = series.mul_low(geometric, order + 1)
    return series.pow_trunc(order + 1, order + 1)


def _others(values: Sequence[fmpq], number: int) -> list[fmpq]:
    return [value for i, value in enumerate(values) if i != number]


def distinct(values: Sequence[Exact]) -> tuple[fmpq, ...]:
    """Exact values, checked to be at least one and distinct."""
    if isinstance(values, str) or not hasattr(values, "__len__") or len(values) == 0:
        raise TypeError(f"values must be a sequence of numbers, not {shown(values)}")
    exact = tuple(rational(value, f"values[{i}]") for i, value in enumerate(values))
    for (i, a), (j, b) in combinations(enumerate(exact), 2):
        if a == b:
            raise ValueError(f"values[{i}] and values[{j}] are both {short(plain(a))}; give each surface its own value")
    return exact


@dataclass(frozen=True, eq=False)
class HermiteValues:
    """The coordinates of the Hermite blend at two arrays or jets, prepared when first asked for."""

    surfaces: tuple[ParametricSurface, ...]
    values: tuple[fmpq, ...]
    order: int

    def __call__(self, t: Any, h: Any) -> tuple[Any, ...]:
        if isinstance(t, Jet) or isinstance(h, Jet):
            like = t if isinstance(t, Jet) else h
            t, h = (x if isinstance(x, Jet) else constant(x, like) for x in (t, h))
        else:
            t, h = as_arrays(t, h)
        steps = [h - to_float(value) for value in self.values]
        total: list[Any] = [0.0, 0.0, 0.0]
        with np.errstate(all="ignore"):
            for number, step in enumerate(steps):
                outer = self._outer(steps, number)
                for axis, coefficients in enumerate(self._series(number, t)):
                    inner = coefficients[-1]
                    for coefficient in coefficients[-2::-1]:
                        inner = inner * step + coefficient
                    total[axis] = total[axis] + inner * outer
        return tuple(total)

    def _outer(self, steps: Sequence[Any], number: int) -> Any:
        """w_i(h) from all h - s_l."""
        widths = [to_float(self.values[number] - other) for other in _others(self.values, number)]
        factors = (step for place, step in enumerate(steps) if place != number)
        return power(reduce(mul, factors) * (1.0 / prod(widths)), self.order + 1)

    @cached_property
    def _inverses(self) -> list[list[float]]:
        """For each surface the Taylor coefficients of 1 / w_i at s_i."""
        found = [inverse_series(self.values, number, self.order) for number in range(len(self.values))]
        return [[to_float(series[j]) for j in range(self.order + 1)] for series in found]

    def _series(self, number: int, t: Any) -> list[list[Any]]:
        """The coefficients j = 0..k of (h - s_i)^j in P_i / w_i, of each coordinate, at t."""
        base = t.value if isinstance(t, Jet) else t
        at = variables(base, to_float(self.values[number]), (nilpotency(t), self.order))
        rows = (_rows(part, t, self.order + 1) for part in self.surfaces[number].values(*at))
        return [_times(row, self._inverses[number]) for row in rows]


def _rows(part: Any, t: Any, size: int) -> list[Any]:
    """The Taylor coefficients in the second parameter of a series, at an array or along a jet t."""
    if not isinstance(part, Jet):
        return [part + 0.0 * t, *[0.0 * t] * (size - 1)]
    table = part.coefficients
    return [along(t, list(table[:, j])) if isinstance(t, Jet) else table[0, j] for j in range(size)]


def _times(first: Sequence[Any], second: Sequence[Any]) -> list[Any]:
    """The coefficients of a product of series."""
    return [reduce(add, (first[m] * second[j - m] for m in range(j + 1))) for j in range(len(second))]
