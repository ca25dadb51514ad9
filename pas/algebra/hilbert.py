"""Hilbert functions of monomial ideals: how many monomials of a degree are members.

The Hilbert series of R/I has the denominator (1 - t)^variables, and its numerator follows from
`N(I + <m>) = N(I) - t^deg(m) N(I : m)` (Bayer and Stillman 1992; Bigatti 1997).  Exact, and as
fast for high degrees as for low ones.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from math import comb

from pas.algebra.monomials import Exponents


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
