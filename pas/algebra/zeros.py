"""The real zeros of ideals that have finitely many: points with algebraic coordinates, exact.

The quotient by the ideal is an algebra of finite dimension.  Multiplication by a linear form whose
powers are a basis of it writes the coordinates of all zeros as polynomials in the roots of one
polynomial (Rouillier 1999; the shape lemma).  Signs of polynomials at such a point come from balls of
growing accuracy, and a value that stays near 0 is compared with 0 exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import count
from typing import Any

from flint import arb, arb_poly, ctx, fmpq_mat, fmpq_poly

from pas.algebra.ideal import Ideal
from pas.algebra.monomials import Exponents, leading_exponents
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, three, to_float
from pas.algebra.roots import RealRoot, accuracies, middle_of, real_roots

ENOUGH = 1024
"""Bits from which on a value near 0 is compared with 0 exactly."""


def linear_form(coefficients: tuple[int, int, int]) -> Polynomial:
    """The polynomial `a x + b y + c z`."""
    return Polynomial.from_raw(sum((g * c for g, c in zip(GENERATORS, coefficients, strict=True)), GENERATORS[0] * 0))


def linear_forms() -> Iterator[tuple[int, int, int]]:
    """Coefficients (1, n, n^2) of linear forms, no three of which are dependent: all but finitely many serve wherever
    one in general position does.  Smaller n would take points with small whole coordinates to one value."""
    return ((1, n, n * n) for n in count(5))


class Quotient:
    """Polynomials modulo an ideal with finitely many complex zeros, in the basis of standard monomials."""

    def __init__(self, ideal: Ideal, standard: list[Exponents]) -> None:
        self.ideal, self.standard = ideal, standard
        self._place = {e: i for i, e in enumerate(standard)}

    @classmethod
    def of(cls, ideal: Ideal) -> Quotient | None:
        """The quotient ring of an ideal; None where it has infinitely many zeros."""
        leads = [leading_exponents(g) for g in ideal.basis]
        powers = [min((e[i] for e in leads if sum(e) == e[i]), default=None) for i in range(3)]
        if any(p is None for p in powers):
            return None
        return cls(ideal, ideal.standard(sum(p - 1 for p in powers if p is not None)))

    def column(self, polynomial: Polynomial) -> fmpq_mat:
        """The coordinates of a polynomial's class, as a matrix with one column."""
        result = fmpq_mat(len(self.standard), 1)
        for e, c in self.ideal.reduce(polynomial.raw).to_dict().items():
            result[self._place[tuple(map(int, e))], 0] = c
        return result

    def times(self, linear: tuple[int, int, int]) -> fmpq_mat:
        """The matrix of multiplication by a linear form."""
        size = len(self.standard)
        result = fmpq_mat(size, size)
        for column, e in enumerate(self.standard):
            for axis, factor in enumerate(linear):
                product = tuple(d + (axis == i) for i, d in enumerate(e))
                for monomial, c in self.ideal.image(product).items() if factor else ():
                    row = self._place[monomial]
                    result[row, column] = result[row, column] + factor * c
        return result


def values_at_zeros(ideal: Ideal, linear: tuple[int, int, int]) -> list[RealRoot] | None:
    """Real numbers among which are the values of a linear form at all real zeros; None for infinitely many zeros."""
    quotient = Quotient.of(ideal)
    return None if quotient is None else real_roots(quotient.times(linear).charpoly())


def count_zeros(ideal: Ideal) -> int | None:
    """The number of distinct complex zeros of an ideal; None for infinitely many."""
    quotient = Quotient.of(ideal)
    radical = None if quotient is None else Quotient.of(_radical(ideal, quotient))
    return None if radical is None else len(radical.standard)


class RealZero:
    """A real point whose coordinates are polynomials in one real root."""

    def __init__(self, root: RealRoot, coordinates: tuple[fmpq_poly, fmpq_poly, fmpq_poly]) -> None:
        self.root = root
        modulus = fmpq_poly(root.polynomial)
        self._coordinates = tuple(c % modulus for c in coordinates)
        self._modulus = modulus
        self._balls: dict[int, tuple[arb, ...]] = {}

    def balls(self, bits: int) -> tuple[arb, ...]:
        """Three balls that hold the coordinates, of about that accuracy."""
        if bits not in self._balls:
            with ctx.workprec(bits):
                at = self.root.ball(bits)
                self._balls[bits] = tuple(arb_poly(c)(at) for c in self._coordinates)
        return self._balls[bits]

    def overlaps(self, other: RealZero, bits: int) -> bool:
        """Whether both may be one point, as far as such balls tell."""
        return all(p.overlaps(q) for p, q in zip(self.balls(bits), other.balls(bits), strict=True))

    def value(self, polynomial: Polynomial, bits: int) -> arb:
        """A ball that holds a polynomial's value."""
        with ctx.workprec(bits):
            return value_at(polynomial, self.balls(bits))

    def sign(self, polynomial: Polynomial) -> int:
        """The sign of a polynomial, exact."""
        for bits in accuracies():
            value = self.value(polynomial, bits)
            if not value.contains(0):
                return 1 if value > 0 else -1
            if bits == ENOUGH and self._vanishes(polynomial):
                return 0
        raise AssertionError

    def _vanishes(self, polynomial: Polynomial) -> bool:
        value = _evaluated(polynomial, self._coordinates, fmpq_poly([1]), lambda p: p % self._modulus)
        return bool(value.degree() < 0)

    @cached_property
    def point(self) -> tuple[float, float, float]:
        """The coordinates, rounded."""
        printed = 256  # bits of points that are rounded to doubles, enough for most coordinates however they cancel
        return three(to_float(middle_of(ball)) for ball in self.balls(printed))

    def near(self, bits: int) -> Vector:
        """A rational point close by."""
        return three(middle_of(ball) for ball in self.balls(bits))


def value_at(polynomial: Polynomial, balls: tuple[arb, ...]) -> arb:
    """A ball that holds the value of a polynomial at a point in three balls."""
    return _evaluated(polynomial, balls, arb(1))


def _evaluated(
    polynomial: Polynomial, values: Sequence[Any], one: Any, reduced: Callable[[Any], Any] = lambda value: value
) -> Any:
    """The value of a polynomial at three members of a ring, whose products are `reduced`."""
    powers: list[list[Any]] = [[one] for _ in values]
    total = one - one
    for e, c in polynomial.raw.to_dict().items():
        term = one * c
        for value, table, power in zip(values, powers, map(int, e), strict=True):
            while len(table) <= power:
                table.append(reduced(table[-1] * value))
            term = reduced(term * table[power]) if power else term
        total += term
    return total


def real_zeros(ideal: Ideal) -> list[RealZero] | None:
    """The distinct real zeros of an ideal, None where it has infinitely many complex ones."""
    if ideal.is_whole_ring:
        return []
    quotient = Quotient.of(ideal)
    if quotient is None:
        return None
    shape = _shape(quotient, next(linear_forms()))
    if shape is None:  # of a radical ideal, all forms serve but those that take two zeros to one value
        radical = Quotient.of(_radical(ideal, quotient))
        assert radical is not None
        shape = next(filter(None, (_shape(radical, form) for form in linear_forms())))
    polynomial, coordinates = shape
    return [RealZero(root, coordinates) for root in real_roots(polynomial)]


def _shape(
    quotient: Quotient, form: tuple[int, int, int]
) -> tuple[fmpq_poly, tuple[fmpq_poly, fmpq_poly, fmpq_poly]] | None:
    """The minimal polynomial of a linear form and the coordinates as polynomials in it; None where they are not."""
    times, powers = quotient.times(form), [quotient.column(Polynomial(1))]
    while len(powers) < len(quotient.standard):
        powers.append(times * powers[-1])
    matrix = fmpq_mat([power.entries() for power in powers]).transpose()
    if matrix.rank() < len(powers):
        return None
    targets = (quotient.column(Polynomial.from_raw(g)) for g in GENERATORS)
    return times.charpoly(), three(fmpq_poly(matrix.solve(target).entries()) for target in targets)


def _radical(ideal: Ideal, quotient: Quotient) -> Ideal:
    """The ideal of all polynomials that vanish at the zeros (Seidenberg 1974)."""
    parts = []
    for axis, g in enumerate(GENERATORS):
        unit = tuple(int(axis == i) for i in range(3))
        polynomial = quotient.times(unit).minpoly()  # type: ignore[arg-type]
        plain = polynomial / polynomial.gcd(polynomial.derivative())
        parts.append(Polynomial.from_raw(sum((g**k * c for k, c in enumerate(plain.coeffs())), 0 * g)))
    return Ideal(*ideal.generators, *parts)
