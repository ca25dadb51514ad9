"""Real algebraic numbers: real roots of polynomials over the rationals, to any accuracy, compared exactly.

A root is that of an irreducible polynomial, so that two roots are equal iff polynomial and place in
its row of roots are.  Balls that certainly hold them come from Arb (Johansson 2017).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache, total_ordering
from itertools import count
from typing import Any

from flint import arb, ctx, fmpq, fmpq_mpoly, fmpq_poly, fmpz_poly

FIRST_BITS = 64
"""The first accuracy of balls in bits, before more are asked for."""


def accuracies() -> Iterator[int]:
    """Numbers of bits to be tried one after the other: 64, 128, 256, ..."""
    return (FIRST_BITS << doublings for doublings in count())


def of_coefficients(coefficients: Mapping[int, fmpq]) -> fmpq_poly:
    """The polynomial in one variable with some coefficients by their powers, the others 0."""
    return fmpq_poly([coefficients.get(power, 0) for power in range(max(coefficients, default=-1) + 1)])


def in_one(polynomial: fmpq_mpoly, index: int = 0) -> fmpq_poly:
    """A polynomial that depends on the variable number `index` alone, as one in one variable."""
    return of_coefficients({int(e[index]): c for e, c in polynomial.to_dict().items()})


@total_ordering
class RealRoot:
    """The root number `index` (from 0, ascending) of an irreducible polynomial with integer coefficients."""

    def __init__(self, polynomial: fmpz_poly, index: int) -> None:
        self.polynomial, self.index = polynomial, index
        self._key = tuple(map(int, polynomial.coeffs()))

    def ball(self, bits: int = FIRST_BITS) -> arb:
        """A ball of that relative accuracy that holds the root."""
        return _balls(self._key, bits)[self.index]

    def bounds(self, bits: int = FIRST_BITS) -> tuple[fmpq, fmpq]:
        """Two rational numbers between which the root lies."""
        return bounds(self.ball(bits))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RealRoot) and self._key == other._key and self.index == other.index

    def __hash__(self) -> int:
        return hash((self._key, self.index))

    def __lt__(self, other: RealRoot) -> bool:
        if self._key == other._key:
            return self.index < other.index
        balls = ((self.ball(bits), other.ball(bits)) for bits in accuracies())
        return next(bool(one < two) for one, two in balls if not one.overlaps(two))


@lru_cache(maxsize=1 << 12)
def _balls(key: tuple[int, ...], bits: int) -> tuple[arb, ...]:
    """The real roots of an irreducible polynomial, ascending."""
    with ctx.workprec(bits):
        if len(key) == 2:
            return (arb(fmpq(-key[0], key[1])),)
        pairs: Any = fmpz_poly(list(key)).complex_roots()
        return tuple(sorted((root.real for root, _ in pairs if root.imag.is_zero()), key=middle_of))


def real_roots(polynomial: fmpq_poly) -> list[RealRoot]:
    """The distinct real roots of a polynomial, in no order; of zero none."""
    result = []
    for factor, _ in polynomial.numer().factor()[1]:
        number = len(_balls(tuple(map(int, factor.coeffs())), FIRST_BITS))
        result += [RealRoot(factor, index) for index in range(number)]
    return result


def rational_root(number: fmpq) -> RealRoot:
    """A rational number as a root."""
    return RealRoot(fmpz_poly([-number.p, number.q]), 0)


def bounds(ball: arb) -> tuple[fmpq, fmpq]:
    """The ends of a ball, exact (Arb's own are rounded)."""
    middle, radius = middle_of(ball), middle_of(ball.rad())
    return middle - radius, middle + radius


def hull(low: fmpq, high: fmpq) -> arb:
    """A ball that holds all numbers between two."""
    return arb(low).union(arb(high))


def middle_of(number: arb) -> fmpq:
    """The rational number in the middle of a ball."""
    return number.mid().fmpq()


def between(left: RealRoot | None, right: RealRoot | None) -> fmpq:
    """A short rational number strictly between two different roots; None stands for an end of the line."""
    if left is None:
        return fmpq(0) if right is None else fmpq(right.bounds()[0].floor()) - 1
    if right is None:
        return fmpq(left.bounds()[1].ceil()) + 1
    gaps = ((left.bounds(bits)[1], right.bounds(bits)[0]) for bits in accuracies())
    return next(simplest(low, high) for low, high in gaps if low < high)


def simplest(low: fmpq, high: fmpq) -> fmpq:
    """The rational number with the least denominator strictly between two (Stern 1858, Brocot 1861)."""
    whole = fmpq(low.floor())
    if whole + 1 < high:
        return whole + 1
    rest = high - whole  # at most 1; low - whole is at least 0
    if low == whole:
        return whole + 1 / (fmpq((1 / rest).floor()) + 1)
    return whole + 1 / simplest(1 / rest, 1 / (low - whole))
