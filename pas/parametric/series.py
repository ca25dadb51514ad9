"""Expansions and substitutions of exact rational functions: along h = constant, and into polynomials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import fmpq, fmpq_mpoly, fmpq_poly

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational_function import GENERATORS, ONE, RING, RationalFunction, homogenised, lcm


def composed(polynomial: Polynomial, functions: Sequence[RationalFunction]) -> RationalFunction:
    """The polynomial in x, y, z of three rational functions."""
    over = ONE
    for f in functions:
        over = lcm(over, f.denominator)
    tops = [f.numerator * (over / f.denominator) for f in functions]
    highest = max(polynomial.degree, 0)
    above = homogenised(polynomial.raw.to_dict(), tops, over, highest)
    return RationalFunction.quotient(above, over**highest, functions[0].names)


def univariate(coefficients: fmpq_poly, index: int) -> fmpq_mpoly:
    """A polynomial in one parameter (0 or 1) as a member of the ring."""
    powers = ((a, 0) if index == 0 else (0, a) for a in range(coefficients.length()))
    terms: dict[tuple[int, ...], fmpq] = dict(zip(powers, coefficients.coeffs(), strict=True))
    return RING.from_dict(terms)


def taylor(polynomial: fmpq_mpoly, at: fmpq, order: int | None = None) -> list[fmpq_poly]:
    """Coefficients of (h - at)^j as polynomials in t, j = 0..order (by default to the degree)."""
    moved = polynomial if at == 0 else polynomial.compose(GENERATORS[0], GENERATORS[1] + at, ctx=RING)
    rows: dict[int, dict[int, fmpq]] = {}
    for (a, b), c in moved.to_dict().items():
        rows.setdefault(int(b), {})[int(a)] = c
    last = max(rows, default=0) if order is None else order
    return [_dense(rows.get(j, {})) for j in range(last + 1)]


def _dense(row: Mapping[int, fmpq]) -> fmpq_poly:
    return fmpq_poly([row.get(a, fmpq(0)) for a in range(max(row, default=-1) + 1)])
