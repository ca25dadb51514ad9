"""Exact rational functions of two parameters over Q, in lowest terms.

Numerator and denominator are python-flint `fmpq_mpoly` of one ring for the whole program; the denominator has coprime
integers as coefficients, the leading one (grevlex) positive, so that equal functions have equal parts.  Arithmetic,
substitution, derivatives and Taylor coefficients are exact.  Calling a function on arrays is the only numerical thing:
it evaluates the expanded numerator and denominator, with infinities and nan where the denominator vanishes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, reduce
from typing import TYPE_CHECKING, Any, TypeAlias

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx
from numpy.typing import ArrayLike

from pas.algebra.brief import formula_repr, latex
from pas.algebra.evaluation import Bundle
from pas.algebra.expressions import OPERATIONS, Names, NotRationalError, as_text, evaluate
from pas.algebra.grammar import Step
from pas.algebra.inputs import MAXIMAL_DEGREE, check_digits, check_power, short, shown
from pas.algebra.polynomial import as_sympy, primitive
from pas.algebra.rational import Exact, Symbolic, rational, to_fraction

if TYPE_CHECKING:
    import sympy

PARAMETERS: Names = ("t", "h")
RING = fmpq_mpoly_ctx.get(PARAMETERS, Ordering.degrevlex)
GENERATORS: tuple[fmpq_mpoly, ...] = RING.gens()
ONE: fmpq_mpoly = RING.constant(1)

FunctionLike: TypeAlias = "RationalFunction | Exact | Symbolic"
"""What is taken for a function of the parameters, mostly a text; see `RationalFunction`."""


class RationalFunction:
    """A rational function of two parameters with rational coefficients, exact and immutable.

    `expression` is a string (`"2*t/(1 + t^2)"`), a sympy expression, a number or a
    RationalFunction; `names` are the parameters.  `numerator` and `denominator` are coprime.

    Raises `ValueError` (other variables, not rational, zero denominator) or `TypeError`.

    >>> f = RationalFunction("(t^2 - h^2)/(t - h) + 1/2")
    >>> str(f), f.degree, f.is_polynomial
    ('t + h + 1/2', 1, True)
    """

    def __init__(self, expression: FunctionLike, names: Names = PARAMETERS) -> None:
        made = _read(expression, names)
        self.numerator: fmpq_mpoly = made.numerator
        self.denominator: fmpq_mpoly = made.denominator
        self.names = names

    @classmethod
    def quotient(cls, numerator: fmpq_mpoly, denominator: fmpq_mpoly, names: Names = PARAMETERS) -> RationalFunction:
        """The quotient of two polynomials of the ring; raises `ValueError` for a zero denominator."""
        if denominator.is_zero():
            raise ValueError("the denominator of a rational function is zero")
        common = numerator.gcd(denominator)
        return cls.from_lowest_terms(numerator / common, denominator / common, names)

    @classmethod
    def from_lowest_terms(
        cls, numerator: fmpq_mpoly, denominator: fmpq_mpoly, names: Names = PARAMETERS
    ) -> RationalFunction:
        """Own a numerator and a denominator known to be coprime."""
        scaled = primitive(denominator)
        return cls._owned(numerator * (scaled.leading_coefficient() / denominator.leading_coefficient()), scaled, names)

    @classmethod
    def _owned(cls, numerator: fmpq_mpoly, denominator: fmpq_mpoly, names: Names) -> RationalFunction:
        result = cls.__new__(cls)
        result.numerator, result.denominator, result.names = numerator, denominator, names
        return result

    @property
    def degree(self) -> int:
        """The greater of the total degrees of numerator and denominator (0 for the zero function)."""
        return max(int(self.numerator.total_degree()), int(self.denominator.total_degree()))

    @property
    def degrees(self) -> tuple[int, int]:
        """The greater of the degrees of numerator and denominator in each parameter (0 for the zero function)."""
        above, below = self.numerator.degrees(), self.denominator.degrees()
        return max(int(above[0]), int(below[0])), max(int(above[1]), int(below[1]))

    @property
    def is_polynomial(self) -> bool:
        """Whether the denominator is constant."""
        return bool(self.denominator.is_constant())

    @property
    def is_zero(self) -> bool:
        """Whether this is the zero function."""
        return bool(self.numerator.is_zero())

    def diff(self, first: int = 0, second: int = 0) -> RationalFunction:
        """The partial derivative of these orders."""
        result = self
        for index, order in enumerate((first, second)):
            for _ in range(order):
                n, d = result.numerator, result.denominator
                part = n.derivative(index) * d - n * d.derivative(index)
                result = RationalFunction.quotient(part, d * d, self.names)
        return result

    def substitute(self, first: RationalFunction, second: RationalFunction) -> RationalFunction:
        """Exact substitution for the two parameters; raises `ValueError` where it divides by zero."""
        tops, over = over_common((first, second))
        highest = self.degree
        parts = [homogenised(p.to_dict(), tops, over, highest) for p in (self.numerator, self.denominator)]
        return RationalFunction.quotient(parts[0], parts[1], first.names)

    def at(self, t: Exact, h: Exact) -> Fraction:
        """The exact value at a rational point; raises `ValueError` at a pole."""
        where = rational(t, self.names[0]), rational(h, self.names[1])
        below = self.denominator(*where)
        if below == 0:
            raise ValueError(
                f"{short(str(self))} has a pole at {self.names[0]} = {shown(t)}, {self.names[1]} = {shown(h)}"
            )
        return to_fraction(self.numerator(*where) / below)

    def __call__(self, t: ArrayLike, h: ArrayLike) -> Any:
        """Values at arrays of parameters that broadcast: an array; at jets (`pas.algebra.jets`) a jet."""
        return self._bundle.quotients(t, h)[0]

    @cached_property
    def _bundle(self) -> Bundle:
        return Bundle.of_pairs([(self.numerator, self.denominator)])

    def to_sympy(self) -> sympy.Expr:
        """A sympy expression in the symbols of its parameters that is this function."""
        return as_sympy(self.numerator, self.names) / as_sympy(self.denominator, self.names)

    def __add__(self, other: FunctionLike) -> RationalFunction:
        return self._with(other, lambda a, b: total([a, b]))

    def __sub__(self, other: FunctionLike) -> RationalFunction:
        return self._with(other, lambda a, b: total([a, -b]))

    def __rsub__(self, other: FunctionLike) -> RationalFunction:
        return self._with(other, lambda a, b: total([b, -a]))

    def __mul__(self, other: FunctionLike) -> RationalFunction:
        return self._with(
            other, lambda a, b: RationalFunction.quotient(a.numerator * b.numerator, a.denominator * b.denominator)
        )

    def __truediv__(self, other: FunctionLike) -> RationalFunction:
        return self._with(other, _divided)

    def __rtruediv__(self, other: FunctionLike) -> RationalFunction:
        return self._with(other, lambda a, b: _divided(b, a))

    __radd__ = __add__
    __rmul__ = __mul__

    def __neg__(self) -> RationalFunction:
        return RationalFunction.from_lowest_terms(-self.numerator, self.denominator, self.names)

    def __pow__(self, exponent: int) -> RationalFunction:
        if not isinstance(exponent, int) or isinstance(exponent, bool):
            raise ValueError(f"the exponent must be a whole number, not {shown(exponent)}")
        base = self if exponent >= 0 else 1 / self
        n = abs(exponent)
        return RationalFunction.from_lowest_terms(base.numerator**n, base.denominator**n, self.names)

    def __eq__(self, other: object) -> bool:
        try:
            made = _read(other, self.names)
        except (TypeError, ValueError):  # it is none
            return NotImplemented
        return bool(self.numerator == made.numerator and self.denominator == made.denominator)

    def __hash__(self) -> int:
        return hash((str(self.numerator), str(self.denominator)))

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuilt, (_plain_terms(self.numerator), _plain_terms(self.denominator), self.names)

    def __str__(self) -> str:
        above, below = self._parts()
        return above if self.is_polynomial else f"({above})/({below})"

    def __repr__(self) -> str:
        return formula_repr("RationalFunction", str(self), f"degree {self.degree}")

    def _repr_latex_(self) -> str:
        above, below = (latex(part) for part in self._parts())
        return f"${above}$" if self.is_polynomial else f"$\\frac{{{above}}}{{{below}}}$"

    def _parts(self) -> tuple[str, str]:
        """Numerator and denominator as texts in the function's own names."""
        ring = fmpq_mpoly_ctx.get(tuple(name or "_" for name in self.names), Ordering.degrevlex)
        above, below = (str(ring.from_dict(p.to_dict())) for p in (self.numerator, self.denominator))
        return above, below

    def _with(
        self, other: FunctionLike, operation: Callable[[RationalFunction, RationalFunction], RationalFunction]
    ) -> RationalFunction:
        try:
            made = _read(other, self.names)
        except TypeError:
            return NotImplemented
        result = operation(self, made)
        return self._owned(result.numerator, result.denominator, self.names)


def total(functions: Sequence[RationalFunction]) -> RationalFunction:
    """The sum, over the least common denominator, reduced once."""
    tops, over = over_common(functions)
    return RationalFunction.quotient(sum(tops, ONE * 0), over, functions[0].names if functions else PARAMETERS)


def over_common(functions: Sequence[RationalFunction]) -> tuple[list[fmpq_mpoly], fmpq_mpoly]:
    """The numerators of functions over their least common denominator, and that, up to a constant."""
    over = reduce(_lcm, (f.denominator for f in functions), ONE)
    return [f.numerator * (over / f.denominator) for f in functions], over


def _divided(a: RationalFunction, b: RationalFunction) -> RationalFunction:
    if b.is_zero:
        raise ZeroDivisionError("a rational function cannot be divided by zero")
    return RationalFunction.quotient(a.numerator * b.denominator, a.denominator * b.numerator)


def _lcm(a: fmpq_mpoly, b: fmpq_mpoly) -> fmpq_mpoly:
    """The least common multiple, up to a constant."""
    if a == b or b.is_constant():
        return a
    return b if a.is_constant() else a * (b / a.gcd(b))


def homogenised(
    terms: Mapping[tuple[int, ...], fmpq], tops: Sequence[fmpq_mpoly], over: fmpq_mpoly, highest: int
) -> fmpq_mpoly:
    """`over^highest` times the polynomial at `tops / over`."""
    ring = fmpq_mpoly_ctx.get([f"u{i}" for i in range(len(tops) + 1)], Ordering.degrevlex)
    lifted = ring.from_dict({(*map(int, e), highest - sum(map(int, e))): c for e, c in terms.items()})
    return lifted.compose(*tops, over, ctx=RING)


def _plain_terms(polynomial: fmpq_mpoly) -> dict[tuple[int, int], Fraction]:
    return {(int(a), int(b)): to_fraction(c) for (a, b), c in polynomial.to_dict().items()}


def _rebuilt(above: Mapping[Any, Fraction], below: Mapping[Any, Fraction], names: Names) -> RationalFunction:
    parts = [RING.from_dict({e: rational(c) for e, c in part.items()}) for part in (above, below)]
    return RationalFunction.from_lowest_terms(parts[0], parts[1], names)


def _read(expression: Any, names: Names) -> RationalFunction:
    if isinstance(expression, RationalFunction):
        return expression
    if callable(expression) and not hasattr(expression, "free_symbols"):
        raise TypeError(f"a callable is not exact; write the expression as a string in {' and '.join(names)}")
    text = as_text(expression)
    if text is not None:
        return evaluate(text, names, _Exact(names))
    return RationalFunction.from_lowest_terms(RING.constant(rational(expression, "the expression")), ONE, names)


class _Exact:
    """Exact values for the reader of expressions."""

    def __init__(self, names: Names) -> None:
        made = (RationalFunction.from_lowest_terms(g, ONE, names) for g in GENERATORS)
        self.names, self.variables = names, dict(zip(names, made, strict=True))

    def number(self, value: fmpq) -> RationalFunction:
        return RationalFunction.from_lowest_terms(RING.constant(value), ONE, self.names)

    def name(self, name: str) -> RationalFunction:
        if name in self.variables:
            return self.variables[name]
        raise NotRationalError(f"{name} is not rational")

    def negative(self, value: RationalFunction) -> RationalFunction:
        return value * -1

    def combine(self, step: Step, left: RationalFunction, right: RationalFunction) -> RationalFunction:
        if step.action == "**":
            return self._power(left, right)
        if step.action == "/" and right.is_zero:
            raise ValueError("it divides by zero")
        if step.action in "*/":
            check_digits(left.numerator, right.numerator)
            check_digits(left.denominator, right.denominator)
        result: RationalFunction = OPERATIONS[step.action](left, right)
        if result.degree > MAXIMAL_DEGREE:
            raise ValueError(f"it is of degree {result.degree}, above {MAXIMAL_DEGREE}")
        return result

    def _power(self, base: RationalFunction, exponent: RationalFunction) -> RationalFunction:
        if exponent.degree > 0:
            raise NotRationalError("an exponent depends on the parameters")
        value = fmpq(0) if exponent.is_zero else exponent.numerator.leading_coefficient()
        if value.q != 1:
            raise NotRationalError(f"the exponent {value} is not a whole number")
        if abs(value) * max(base.degree, 1) > MAXIMAL_DEGREE:
            raise ValueError(f"a power is of degree or exponent above {MAXIMAL_DEGREE}")
        for part in (base.numerator, base.denominator):
            check_power(part, abs(int(value)), MAXIMAL_DEGREE)
        if value < 0 and base.is_zero:
            raise ValueError("it divides by zero")
        return base ** int(value)

    def call(self, name: str, argument: RationalFunction) -> RationalFunction:
        raise NotRationalError(f"{name} is not rational")
