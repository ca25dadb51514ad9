"""Real roots of polynomials in one variable over Q: isolated with certainty by ball arithmetic, then rounded."""

from __future__ import annotations

from typing import Any

from flint import ctx, fmpq, fmpq_poly

from pas.algebra.rational import to_float


def real_roots(polynomial: fmpq_poly) -> list[float]:
    """The distinct real roots, in order, rounded."""
    return sorted(map(float, _balls(polynomial)))


def roots_between(polynomial: fmpq_poly, low: fmpq, high: fmpq) -> list[float]:
    """The distinct real roots with low < root < high, in order, rounded; which these are is decided exactly."""
    return [root for root, inside in roots_and_sides(polynomial, low, high) if inside]


def roots_and_sides(polynomial: fmpq_poly, low: fmpq, high: fmpq) -> list[tuple[float, bool]]:
    """The distinct real roots, in order, rounded, and whether low < root < high, decided exactly."""
    rest, found = polynomial, []
    for end in (low, high):
        if rest.degree() > 0 and rest(end) == 0:
            found.append((to_float(end), False))
        while rest.degree() > 0 and rest(end) == 0:
            rest = rest / fmpq_poly([-end, 1])
    precision = ctx.prec
    try:
        while True:  # no root is an end any more, so balls part from the ends when they are small enough
            balls = _balls(rest)
            if all(ball < end or ball > end for ball in balls for end in (low, high)):
                return sorted([*found, *((float(ball), bool(low < ball < high)) for ball in balls)])
            ctx.prec *= 2
    finally:
        ctx.prec = precision


def _balls(polynomial: fmpq_poly) -> list[Any]:
    """A real ball around each real root."""
    if polynomial.degree() < 1:
        return []
    pairs: Any = polynomial.complex_roots()
    return [root.real for root, _ in pairs if root.imag == 0]
