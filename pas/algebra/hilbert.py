"""Hilbert functions of monomial ideals: how many monomials of a degree are members.

The Hilbert series of R/I has the denominator (1 - t)^variables, and its numerator follows from
`N(I + <m>) = N(I) - t^deg(m) N(I : m)` (Bayer and Stillman 1992; Bigatti 1997).  Exact, and as
fast for high degrees as for low ones.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from math import comb

from pas.algebra.monomials import Exponents


def minimal(monomials: Iterable[Exponents]) -> list[Exponents]:
    """The monomials that no other one of them divides, by ascending degree."""
    kept: list[Exponents] = []
    for m in sorted(set(monomials), key=lambda e: (sum(e), e)):
        if not any(divides(k, m) for k in kept):
            kept.append(m)
    return kept


def divides(divisor: Exponents, monomial: Exponents) -> bool:
    """Whether one monomial divides another."""
    return all(a <= b for a, b in zip(divisor, monomial, strict=True))


def count_members(monomials: Sequence[Exponents], degree: int, variables: int) -> int:
    """How many monomials of exactly `degree` lie in the ideal that the given ones generate."""
    total = sum(c * count_monomials(degree - d, variables) for d, c in _numerator(minimal(monomials)).items())
    return count_monomials(degree, variables) - total


def count_monomials(degree: int, variables: int) -> int:
    """How many monomials have exactly this degree."""
    return comb(degree + variables - 1, variables - 1) if degree >= 0 else 0


def _numerator(monomials: list[Exponents]) -> Counter[int]:
    """The numerator of the Hilbert series, as {exponent: coefficient}."""
    series = Counter({0: 1})
    for number, m in enumerate(monomials):
        colon = [tuple(max(a - b, 0) for a, b in zip(earlier, m, strict=True)) for earlier in monomials[:number]]
        shift = sum(m)
        for d, c in _numerator(minimal(colon)).items():
            series[d + shift] -= c
    return series
