"""Exact polynomials in x, y, z over the rationals.

A thin, immutable owner of a python-flint `fmpq_mpoly` (one ring for the whole program, graded
reverse lexicographic order with x > y > z).  Arithmetic, comparison and differentiation are
exact; calling a polynomial on an array is the only numerical thing it does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, nmod_mpoly, nmod_mpoly_ctx, nmod_poly
from numpy.typing import ArrayLike

from pas.algebra.brief import formula_repr, latex
from pas.algebra.evaluation import evaluate
from pas.algebra.expressions import read_polynomial
from pas.algebra.inputs import MAXIMAL_DEGREE, check_power, natural, points_of, shown
from pas.algebra.monomials import Exponents, count, exponents, positions
from pas.algebra.rational import Exact, Symbolic, VectorLike, rational, to_float, to_fraction
from pas.arrays import Floats
from pas.registry import loaded

if TYPE_CHECKING:
    import sympy

VARIABLES = ("x", "y", "z")
RING = fmpq_mpoly_ctx.get(VARIABLES, Ordering.degrevlex)
GENERATORS: tuple[fmpq_mpoly, ...] = RING.gens()
RESIDUES = nmod_mpoly_ctx.get(VARIABLES, modulus=2**31 - 1, ordering=Ordering.degrevlex)

BOXED = "pas.piecewise:boxed"
"""The function that makes a surface of a polynomial, in a layer above."""

PolynomialLike: TypeAlias = "Polynomial | Exact | Symbolic | Mapping[tuple[int, ...], Exact]"
"""What is taken for a polynomial; see `Polynomial`."""


class Polynomial:
    """A polynomial in x, y, z with rational coefficients, exact and immutable.

    `expression` is a string (`"x^2 + y**2/4 - 1/9"`; decimals are taken as written), a sympy
    expression in x, y, z, a mapping from exponent triples to numbers, a number, or a Polynomial.

    Raises `ValueError` (other variables, not polynomial, not finite) or `TypeError`.

    >>> p = Polynomial("x^2 + y^2 - 1/9")
    >>> p.degree, p.coefficients()[0, 0, 0]
    (2, Fraction(-1, 9))
    """

    def __init__(self, expression: PolynomialLike) -> None:
        self.raw: fmpq_mpoly = _read(expression)

    @classmethod
    def from_raw(cls, raw: fmpq_mpoly) -> Polynomial:
        """Own an `fmpq_mpoly` of the program's ring."""
        result = cls.__new__(cls)
        result.raw = raw
        return result

    @classmethod
    def named(cls, expression: PolynomialLike, name: str, constant: bool = True, of: str = "") -> Polynomial:
        """The polynomial of an argument, which errors name; raises `ValueError` for a constant that is not wanted."""
        try:
            result = cls(expression)
        except (ValueError, TypeError) as error:
            raise type(error)(f"{name}: {error}") from None
        if result.degree < 1 and not constant:
            title = f"the {name} of {of}" if of else name
            raise ValueError(f"{title} must be a polynomial that is not constant, not {result}")
        return result

    @classmethod
    def from_row(cls, row: Iterable[fmpq], degree: int) -> Polynomial:
        """The polynomial with given coefficients, in the order of `monomials.exponents(degree)`."""
        terms = {e: c for e, c in zip(exponents(degree), row, strict=True) if c != 0}
        return cls.from_raw(RING.from_dict(terms))

    def row(self, degree: int) -> list[fmpq]:
        """The exact coefficients in the order of `monomials.exponents(degree)`.

        Raises `ValueError` for a polynomial of a higher degree.
        """
        if self.degree > degree:
            raise ValueError(f"the polynomial {self} is of a degree above {degree}")
        terms = self.raw.to_dict()
        return [terms.get(e, fmpq(0)) for e in exponents(degree)]

    @property
    def degree(self) -> int:
        """Total degree; -1 for the zero polynomial."""
        return -1 if self.raw.is_zero() else int(self.raw.total_degree())

    @property
    def is_zero(self) -> bool:
        """Whether this is the zero polynomial."""
        return bool(self.raw.is_zero())

    def coefficients(self) -> dict[tuple[int, int, int], Fraction]:
        """The nonzero coefficients by exponent triple."""
        return {(int(i), int(j), int(k)): to_fraction(c) for (i, j, k), c in self.raw.to_dict().items()}

    def diff(self, variable: str | int) -> Polynomial:
        """The partial derivative with respect to "x", "y", "z" (or 0, 1, 2)."""
        index = VARIABLES.index(variable) if variable in VARIABLES else variable
        if index not in (0, 1, 2):
            raise ValueError(f"the variable must be x, y or z, not {variable!r}")
        return Polynomial.from_raw(self.raw.derivative(index))

    def compose(self, x: Polynomial, y: Polynomial, z: Polynomial) -> Polynomial:
        """Exact substitution of polynomials for the three variables."""
        return Polynomial.from_raw(self.raw.compose(x.raw, y.raw, z.raw, ctx=RING))

    def at(self, point: VectorLike) -> Fraction:
        """The exact value at one rational point."""
        return to_fraction(self.raw(*(rational(entry, "coordinate") for entry in point)))

    def __call__(self, points: ArrayLike) -> Floats:
        """Values at `points` (..., 3), as floats of shape (...)."""
        return self._evaluate(points, self._columns[:, :1])[..., 0]

    def gradient(self, points: ArrayLike) -> Floats:
        """Gradients at `points` (..., 3), shape (..., 3)."""
        return self._evaluate(points, self._columns[:, 1:])

    def jets(self, points: ArrayLike) -> Floats:
        """Values and gradients at `points` (..., 3), shape (..., 4)."""
        return self._evaluate(points, self._columns)

    def hessian(self, points: ArrayLike) -> Floats:
        """Matrices of second derivatives at `points` (..., 3), shape (..., 3, 3)."""
        degree = max(self.degree, 0)
        columns = np.stack([self.diff(i).diff(j).dense(degree) for i in range(3) for j in range(3)], 1)
        return self._evaluate(points, columns).reshape(*np.shape(points)[:-1], 3, 3)

    def dense(self, degree: int | None = None) -> Floats:
        """Coefficients rounded to doubles, in the order of `monomials.exponents(degree)`."""
        degree = max(self.degree, 0) if degree is None else degree
        result = np.zeros(count(degree))
        result[: len(self._dense)] = self._dense  # raises where the degree is lower
        return result

    @cached_property
    def _dense(self) -> Floats:
        degree = max(self.degree, 0)
        result, where = np.zeros(count(degree)), positions(degree)
        for exponent, coefficient in self.raw.to_dict().items():
            result[where[exponent]] = to_float(coefficient)
        return result

    @cached_property
    def _columns(self) -> Floats:
        degree = max(self.degree, 0)
        parts = (self, *(self.diff(i) for i in range(3)))
        return np.stack([part.dense(degree) for part in parts], axis=1)

    @staticmethod
    def _evaluate(points: ArrayLike, columns: Floats) -> Floats:
        return evaluate(points_of(points), columns)

    def surface(self, lower: VectorLike, upper: VectorLike) -> Any:
        """Its zeros in the box from `lower` to `upper` (three exact numbers each): a `pas.PiecewiseSurface`.

        Raises `ValueError` for a constant, which has no surface, and for a box that is empty or inverted.
        """
        if self.degree < 1:
            where = "everywhere" if self.is_zero else "nowhere"
            raise ValueError(f"the polynomial {self} is constant: it vanishes {where}, so it has no surface")
        return loaded(BOXED)(self, lower, upper)

    def primitive(self) -> Polynomial:
        """The multiple with coprime integers as coefficients, the leading one (grevlex) positive."""
        return self._primitive

    @cached_property
    def _primitive(self) -> Polynomial:
        return Polynomial.from_raw(primitive(self.raw))

    @cached_property
    def residues(self) -> nmod_mpoly:
        """The primitive multiple modulo a prime."""
        terms = self._primitive.raw.to_dict().items()
        return RESIDUES.from_dict({e: int(c.p) % RESIDUES.modulus() for e, c in terms})

    def to_sympy(self) -> sympy.Expr:
        """A sympy expression in the symbols x, y, z that is this polynomial."""
        return as_sympy(self.raw, VARIABLES)

    def __add__(self, other: PolynomialLike) -> Polynomial:
        return self._combine(other, lambda a, b: a + b)

    def __sub__(self, other: PolynomialLike) -> Polynomial:
        return self._combine(other, lambda a, b: a - b)

    def __rsub__(self, other: PolynomialLike) -> Polynomial:
        return self._combine(other, lambda a, b: b - a)

    def __mul__(self, other: PolynomialLike) -> Polynomial:
        return self._combine(other, lambda a, b: a * b)

    __radd__ = __add__
    __rmul__ = __mul__

    def __truediv__(self, other: PolynomialLike) -> Polynomial:
        divisor = rational(other, "the divisor")
        if divisor == 0:
            raise ZeroDivisionError("a polynomial cannot be divided by zero")
        return Polynomial.from_raw(self.raw * (1 / divisor))

    def __pow__(self, exponent: int) -> Polynomial:
        natural(exponent, "the exponent")
        try:
            check_power(self.raw, exponent)
        except ValueError as error:
            raise ValueError(f"a power with the exponent {shown(exponent)} is too large: {error}") from None
        return Polynomial.from_raw(self.raw**exponent)

    def __neg__(self) -> Polynomial:
        return Polynomial.from_raw(-self.raw)

    def __eq__(self, other: object) -> bool:
        try:
            return bool(self.raw == _read(other))
        except (TypeError, ValueError):  # it is none
            return NotImplemented

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash(frozenset(self.raw.to_dict().items()))

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuilt, (self.coefficients(),)

    def __str__(self) -> str:
        return str(self.raw)

    def __repr__(self) -> str:
        return formula_repr("Polynomial", str(self), f"degree {self.degree} with {len(self.raw)} terms")

    def _repr_latex_(self) -> str:
        return f"${latex(str(self))}$"

    def _combine(self, other: PolynomialLike, operation: Callable[[fmpq_mpoly, fmpq_mpoly], fmpq_mpoly]) -> Polynomial:
        try:
            raw = _read(other)
        except TypeError:
            return NotImplemented
        return Polynomial.from_raw(operation(self.raw, raw))


def as_sympy(raw: fmpq_mpoly, names: Sequence[Any]) -> sympy.Expr:
    """A polynomial of any ring as a sympy expression in symbols, or in those of given names."""
    import sympy

    symbols = [sympy.Symbol(name) if isinstance(name, str) else name for name in names]
    terms = {e: sympy.Rational(int(c.p), int(c.q)) for e, c in raw.to_dict().items()}
    return sympy.Poly(terms or {(0,) * len(names): 0}, *symbols).as_expr()


def primitive(raw: fmpq_mpoly) -> fmpq_mpoly:
    """The multiple of a polynomial of any ring with coprime integers as coefficients, the leading one positive."""
    if raw.is_zero():
        return raw
    values = raw.coeffs()
    denominator = lcm(*(int(c.q) for c in values))
    divisor = gcd(*(int(c.p) * (denominator // int(c.q)) for c in values))
    return raw * fmpq(denominator if values[0] > 0 else -denominator, divisor)


def residue_place(first: Polynomial, second: Polynomial) -> tuple[int, ...] | None:
    """A place modulo a prime in which the residues of all members of an ideal of a plane and another function vanish.

    On the plane a member is a multiple of that function, by a polynomial without the prime in its denominators (Gauss's
    lemma), as neither the plane's slope nor the function on a line in it vanishes modulo the prime.  None where neither
    is a plane, or no such line has a place.
    """
    plane, other = sorted((first, second), key=lambda f: f.degree)
    slopes, modulus = [int(plane.residues.derivative(i)(0, 0, 0)) for i in range(3)], RESIDUES.modulus()
    if plane.degree != 1 or not any(slopes):
        return None
    axis, step = next(i for i in range(3) if slopes[i]), RESIDUES.gens()[0]
    for start in range(2, 12):  # two of three lines have one
        line = [start**9 + step, start**8 + start**7 * step]
        line.insert(axis, 0 * step)
        line[axis] = plane.residues.compose(*line) * -pow(slopes[axis], -1, modulus)
        along = {e[0]: c for e, c in other.residues.compose(*line).to_dict().items()}
        roots = nmod_poly([along.get(i, 0) for i in range(max(along) + 1)], modulus).roots() if along else ()
        if roots:
            return tuple(int(part(int(roots[0][0]), 0, 0)) for part in line)
    return None


def _rebuilt(terms: Mapping[tuple[int, int, int], Fraction]) -> Polynomial:
    """A polynomial that there was before, of any degree."""
    return Polynomial.from_raw(RING.from_dict({e: rational(c) for e, c in terms.items()}))


def _read(expression: Any) -> fmpq_mpoly:
    if isinstance(expression, Polynomial):
        return expression.raw
    if isinstance(expression, str):
        return read_polynomial(expression, dict(zip(VARIABLES, GENERATORS, strict=True)))
    if isinstance(expression, Mapping):
        return RING.from_dict(_checked_terms(expression))
    if hasattr(expression, "free_symbols"):
        return _from_sympy(expression)
    return RING.constant(rational(expression, "the polynomial"))


def _checked_terms(terms: Mapping[tuple[int, ...], Exact]) -> dict[Exponents, fmpq]:
    checked: dict[Exponents, fmpq] = {}
    for key, value in terms.items():
        valid = isinstance(key, tuple) and len(key) == 3
        if not valid or any(not isinstance(e, int) or isinstance(e, bool) or e < 0 for e in key):
            raise ValueError(f"exponents must be three whole numbers >= 0, such as (2, 0, 1), not {shown(key)}")
        if sum(key) > MAXIMAL_DEGREE:
            raise ValueError(f"the exponents {shown(key)} are of degree {shown(sum(key))}, above {MAXIMAL_DEGREE}")
        checked[key] = rational(value, f"the coefficient of {key}")
    return checked


def _from_sympy(expression: Any) -> fmpq_mpoly:
    import sympy

    strange = sorted(str(s) for s in expression.free_symbols if str(s) not in VARIABLES)
    if strange:
        raise ValueError(
            f"the variables must be x, y, z; {', '.join(strange)} is not one of them; put numbers for parameters, "
            "or ask pas.existence for which parameters there is a solution"
        )
    powers = expression.atoms(sympy.Pow) if hasattr(expression, "atoms") else ()
    if any(p.exp.is_Integer and p.exp > MAXIMAL_DEGREE for p in powers):
        raise ValueError(f"{shown(expression)} has powers above {MAXIMAL_DEGREE}")
    symbols = [next((s for s in expression.free_symbols if str(s) == v), sympy.Symbol(v)) for v in VARIABLES]
    try:
        terms = sympy.Poly(expression, *symbols).terms()
    except sympy.PolynomialError:
        raise ValueError(f"{shown(expression)} is not a polynomial in x, y, z") from None
    return RING.from_dict({e: rational(c, f"the coefficient of {e}") for e, c in terms})
