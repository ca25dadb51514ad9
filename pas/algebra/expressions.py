"""The values of texts in the grammar of `pas.algebra.grammar`: an exact polynomial, or a function of two arrays.

Decimals are the decimals written (0.1 is 1/10).  Nothing is evaluated but arithmetic and elementary functions, so a
text from a file is harmless.  Sympy expressions are read through the text that sympy writes for them.  Exact rational
functions are read by `pas.algebra.rational_function`.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NoReturn, TypeVar

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.grammar import Step, Values, run, steps
from pas.algebra.inputs import MAXIMAL_DEGREE, check_power, check_product, shown
from pas.algebra.rational import rational, to_float

V = TypeVar("V")
Names = tuple[str, str]
Formula = Callable[[Any, Any], Any]
"""A function of two arrays (or jets)."""

FUNCTIONS: Mapping[str, Callable[[Any], Any]] = {
    **{name: getattr(np, name) for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "sqrt")},
    **{"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "Abs": np.absolute, "abs": np.absolute},
}
OPERATIONS: Mapping[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "**": operator.pow,
}
CONSTANTS = {"pi": float(np.pi), "E": float(np.e)}


class NotRationalError(ValueError):
    """The expression is no rational function with rational coefficients."""


def as_text(expression: Any) -> str | None:
    """The expression as a string, None for a number."""
    if isinstance(expression, str):
        return expression
    if not hasattr(expression, "free_symbols"):
        return None
    import sympy

    exact = {number: sympy.Rational(str(rational(number))) for number in expression.atoms(sympy.Float)}
    return str(expression.xreplace(exact))


def read_polynomial(text: str, names: Mapping[str, fmpq_mpoly]) -> fmpq_mpoly:
    """The polynomial written in `text`, where `f = g` stands for f - g; `names` gives the variables.

    Raises `ValueError` saying what is wrong and where.
    """
    if not text.strip():
        raise ValueError("the polynomial is empty; write for example 'x^2 + y^2 - 1/9'")
    with _named(text, "polynomial"):
        return run(steps(text, names, equation=True), _Polynomials(names))


def read_formula(expression: Any, names: Names) -> Formula:
    """An expression in two parameters, with elementary functions or without, as a function of arrays or jets."""
    text = as_text(expression)
    if text is None:
        raise TypeError(
            f"write the expression as a string in {' and '.join(filter(None, names))}, not {shown(expression)}"
        )
    program = _program(text, names)
    return lambda t, h: run(program, _Arrays({**CONSTANTS, names[1]: h, names[0]: t}))


def evaluate(text: str, names: Names, values: Values[V]) -> V:
    """The value of a text in two parameters, in some kind of values; raises `ValueError` saying what is wrong."""
    program = _program(text, names)
    with _named(text):
        return run(program, values)


def _program(text: str, names: Names) -> tuple[Step, ...]:
    if not text.strip():
        raise ValueError("the expression is empty; write for example '2*t/(1 + t^2)'")
    with _named(text):
        return steps(text, [*filter(None, names), *CONSTANTS], FUNCTIONS)


@contextmanager
def _named(text: str, what: str = "expression") -> Iterator[None]:
    try:
        yield
    except NotRationalError as error:
        raise NotRationalError(f"{shown(text)} is not a rational function: {error}") from None
    except (ValueError, ZeroDivisionError) as error:
        raise ValueError(f"cannot read the {what} {shown(text)}: {error}") from None


class _Arrays:
    """Values at arrays of parameters."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.name = values.__getitem__

    def number(self, value: fmpq) -> Any:
        return to_float(value)

    def negative(self, value: Any) -> Any:
        return -value

    def combine(self, step: Step, left: Any, right: Any) -> Any:
        return OPERATIONS[step.action](left, right)

    def call(self, name: str, argument: Any) -> Any:
        return FUNCTIONS[name](argument)


class _Polynomials:
    """Polynomials in given variables."""

    def __init__(self, names: Mapping[str, fmpq_mpoly]) -> None:
        self.name, self.one = names.__getitem__, next(iter(names.values())) ** 0

    def number(self, value: fmpq) -> fmpq_mpoly:
        return self.one * value

    def negative(self, value: fmpq_mpoly) -> fmpq_mpoly:
        return -value

    def call(self, name: str, argument: fmpq_mpoly) -> NoReturn:
        raise ValueError(f"{name} is not a polynomial")

    def combine(self, step: Step, left: fmpq_mpoly, right: fmpq_mpoly) -> fmpq_mpoly:
        if step.action == "**":
            return self._power(step, left, right)
        if step.action == "/":
            if not right.is_constant():
                raise ValueError(f"{step.written} divides by a polynomial")
            if right.is_zero():
                raise ValueError(f"{step.written} divides by zero")
            right = self.one * (1 / right.leading_coefficient())
        if step.action in "*/":
            check_product(left, right)
            return left * right
        return left + right if step.action == "+" else left - right

    def _power(self, step: Step, base: fmpq_mpoly, exponent: fmpq_mpoly) -> fmpq_mpoly:
        value = fmpq(0) if exponent.is_zero() else exponent.leading_coefficient()
        if not exponent.is_constant() or value.q != 1 or not 0 <= value <= MAXIMAL_DEGREE:
            raise ValueError(f"the exponent in {step.written} must be a whole number from 0 to {MAXIMAL_DEGREE}")
        try:
            check_power(base, int(value), MAXIMAL_DEGREE)
        except ValueError as error:
            raise ValueError(f"{step.written} is too large: {error}") from None
        return base ** int(value)
