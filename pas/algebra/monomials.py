"""The one order of monomials, their values, and how many of them lie in an ideal.

Monomials x^a y^b z^c are listed by total degree, so that those of degree <= m are the first
C(m+3, 3) of those of any higher degree; inside one degree, in descending lexicographic order.

The Hilbert series of R/I for an ideal I of monomials has the denominator (1 - t)^variables, and its numerator follows
from `N(I + <m>) = N(I) - t^deg(m) N(I : m)` (Bayer and Stillman 1992; Bigatti 1997).  Exact, and as fast for high
degrees as for low ones.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from functools import cache
from math import comb, factorial, prod
from typing import Any

import numpy as np

from pas.arrays import Floats

Exponents = tuple[int, ...]


def leading_exponents(polynomial: Any) -> Exponents:
    """The exponents of the leading monomial of a polynomial of python-flint in its own order."""
    return tuple(map(int, polynomial.monomial(0)))


@cache
def exponents(degree: int, variables: int = 3) -> tuple[Exponents, ...]:
    """All exponent tuples of total degree <= `degree`, in the order above."""
    return tuple(e for d in range(degree + 1) for e in homogeneous_exponents(d, variables))


@cache
def homogeneous_exponents(degree: int, variables: int = 3) -> tuple[Exponents, ...]:
    """All exponent tuples of total degree exactly `degree`, descending lexicographically."""
    if variables == 1:
        return ((degree,),)
    return tuple(
        (first, *rest)
        for first in range(degree, -1, -1)
        for rest in homogeneous_exponents(degree - first, variables - 1)
    )


@cache
def positions(degree: int, variables: int = 3) -> dict[Exponents, int]:
    """Where each exponent tuple stands in `exponents`."""
    return {e: i for i, e in enumerate(exponents(degree, variables))}


def count(degree: int, variables: int = 3) -> int:
    """How many monomials have total degree <= `degree` (none for a negative degree)."""
    return comb(degree + variables, variables) if degree >= 0 else 0


def multinomial(index: Exponents) -> int:
    """The number of words with so many letters of each kind."""
    return factorial(sum(index)) // prod(map(factorial, index))


@cache
def _products(degree: int) -> tuple[tuple[slice, slice, int], ...]:
    """How each block of monomials follows from earlier columns: (columns, parents, variable).

    The parents of a block follow one another, in the same order.
    """
    where = positions(degree)
    blocks: list[tuple[slice, slice, int]] = []
    for d in range(1, degree + 1):
        start = count(d - 1)
        parents: dict[int, list[int]] = {0: [], 1: [], 2: []}
        for a, b, c in homogeneous_exponents(d):
            variable = 0 if a else 1 if b else 2
            parents[variable].append(where[(a - 1, b, c) if a else (0, b - 1, c) if b else (0, 0, c - 1)])
        for variable, indices in parents.items():
            stop = start + len(indices)
            blocks.append((slice(start, stop), slice(indices[0], indices[-1] + 1), variable))
            start = stop
    return tuple(blocks)


def monomial_values(points: Floats, degree: int) -> Floats:
    """Values of all monomials of degree <= `degree` at `points` (N, 3): shape (count, N)."""
    values = np.empty((count(degree), len(points)))
    values[0] = 1.0
    coordinates = np.ascontiguousarray(points.T)
    for columns, parents, variable in _products(degree):
        np.multiply(values[parents], coordinates[variable], out=values[columns])
    return values


@cache
def derivative_matrix(degree: int, variable: int) -> Floats:
    """The map (count, count) from the coefficients of a polynomial up to a degree to those of its derivative, not to be
    written into."""
    where = positions(degree)
    matrix = np.zeros((len(where), len(where)))
    for e, column in where.items():
        if e[variable]:
            lower = tuple(power - (axis == variable) for axis, power in enumerate(e))
            matrix[where[lower], column] = e[variable]
    matrix.setflags(write=False)
    return matrix


def minimal(monomials: Iterable[Exponents]) -> list[Exponents]:
    """The monomials that no other one of them divides, by ascending degree."""
    kept: list[Exponents] = []
    for m in sorted(set(monomials), key=lambda e: (sum(e), e)):
        if not any(all(a <= b for a, b in zip(k, m, strict=True)) for k in kept):
            kept.append(m)
    return kept


def count_members(monomials: Iterable[Exponents], degree: int, variables: int) -> int:
    """How many monomials of exactly `degree` lie in the ideal that the given ones generate."""
    return count_monomials(degree, variables) - count_standard(numerator(monomials), degree, variables)


def count_standard(series: Mapping[int, int], degree: int, variables: int) -> int:
    """How many monomials of exactly `degree` lie in no ideal of this numerator: its Hilbert function."""
    return sum(c * count_monomials(degree - d, variables) for d, c in series.items())


def count_monomials(degree: int, variables: int) -> int:
    """How many monomials have exactly this degree."""
    return comb(degree + variables - 1, variables - 1) if degree >= 0 else 0


def numerator(monomials: Iterable[Exponents]) -> Counter[int]:
    """The numerator of the Hilbert series of R/I, as {exponent: coefficient}; of the zero ideal it is 1."""
    kept, series = minimal(monomials), Counter({0: 1})
    for number, m in enumerate(kept):
        shift = sum(m)
        colon = (tuple(max(a - b, 0) for a, b in zip(earlier, m, strict=True)) for earlier in kept[:number])
        for d, c in numerator(colon).items():
            series[d + shift] -= c
    return series
