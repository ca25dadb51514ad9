"""Reads expressions in two parameters: exact rational functions, or formulas for arrays.

The grammar is that of `pas.algebra.written` with, where exactness is not asked, the constants pi and E and
elementary functions.  Decimals are the decimals written.  Nothing is evaluated but arithmetic, so a string from a file
is harmless.  Sympy expressions are read through the string that sympy writes for them.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Protocol, TypeVar

import numpy as np
from flint import fmpq

from pas.algebra.inputs import shown
from pas.algebra.rational import rational, to_float
from pas.algebra.written import Step, Values, run, steps

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


def read_formula(expression: Any, names: Names) -> Formula:
    """The same expression, or one with elementary functions, as a function of arrays or jets."""
    text = as_text(expression)
    if text is None:
        raise TypeError(
            f"write the expression as a string in {' and '.join(filter(None, names))}, not {shown(expression)}"
        )
    parsed = program(text, names)

    def formula(t: Any, h: Any) -> Any:
        return run(parsed, _Numeric(names, t, h))

    return formula


def as_text(expression: Any) -> str | None:
    """The expression as a string, None for a number."""
    if isinstance(expression, str):
        return expression
    if not hasattr(expression, "free_symbols"):
        return None
    import sympy

    exact = {number: sympy.Rational(str(rational(number))) for number in expression.atoms(sympy.Float)}
    return str(expression.xreplace(exact))


class ExpressionValues(Values[V], Protocol[V]):
    """Values with the names of their two parameters."""

    @property
    def names(self) -> Names: ...


def program(text: str, names: Names) -> tuple[Step, ...]:
    """The steps of an expression in two parameters, elementary functions and constants; raises `ValueError`."""
    if not text.strip():
        raise ValueError("the expression is empty; write for example '2*t/(1 + t^2)'")
    with _named(text):
        return steps(text, [*filter(None, names), *CONSTANTS], FUNCTIONS)


def evaluate(text: str, values: ExpressionValues[V]) -> V:
    """What an expression comes to in some kind of values; raises `ValueError` saying what is wrong."""
    parsed = program(text, values.names)
    with _named(text):
        return run(parsed, values)


@contextmanager
def _named(text: str) -> Iterator[None]:
    try:
        yield
    except NotRationalError as error:
        raise NotRationalError(f"{shown(text)} is not a rational function: {error}") from None
    except (ValueError, ZeroDivisionError) as error:
        raise ValueError(f"cannot read the expression {shown(text)}: {error}") from None


class _Numeric:
    """Values at arrays of parameters."""

    def __init__(self, names: Names, t: Any, h: Any) -> None:
        self.values = {**CONSTANTS, names[1]: h, names[0]: t}

    def number(self, value: fmpq) -> Any:
        return to_float(value)

    def name(self, name: str) -> Any:
        return self.values[name]

    def negative(self, value: Any) -> Any:
        return -value

    def combine(self, step: Step, left: Any, right: Any) -> Any:
        return OPERATIONS[step.action](left, right)

    def call(self, name: str, argument: Any) -> Any:
        return FUNCTIONS[name](argument)
