"""Exact work in one parameter: expansions along h = constant, polynomials in one variable and their real roots."""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq, fmpq_mpoly, fmpq_poly

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float
from pas.algebra.rational_function import GENERATORS, RING, RationalFunction, homogenised, over_common
from pas.algebra.roots import middle_of, of_coefficients, rational_root, real_roots

Components = tuple[RationalFunction, RationalFunction, RationalFunction]


def composed(polynomial: Polynomial, functions: Sequence[RationalFunction]) -> RationalFunction:
    """The polynomial in x, y, z of three rational functions."""
    tops, over = over_common(functions)
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
    return [of_coefficients(rows.get(j, {})) for j in range(last + 1)]


def rounded_roots(polynomial: fmpq_poly, low: fmpq | None = None, high: fmpq | None = None) -> list[float]:
    """The distinct real roots with low <= root <= high, in order, rounded; which these are is decided exactly."""
    roots = sorted(real_roots(polynomial))
    if low is not None:
        roots = [root for root in roots if rational_root(low) <= root]
    if high is not None:
        roots = [root for root in roots if root <= rational_root(high)]
    return [to_float(middle_of(root.ball())) for root in roots]
