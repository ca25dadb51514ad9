"""Reads expressions in two parameters: exact rational functions, or formulas for arrays.

The grammar is Python's, restricted to numbers, the parameters' names, + - * / ** (or ^),
parentheses and, where exactness is not asked, the constant pi and elementary functions; signs of
products may be left out (see `pas.algebra.written`).
Decimals are the decimals written.  Nothing is evaluated but arithmetic, so a string from a file
is harmless.  Sympy expressions are read through the string that sympy writes for them.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import numpy as np
from flint import fmpq

from pas.algebra.inputs import check_text, shown
from pas.algebra.parse import literal, segment, syntax_tree
from pas.algebra.rational import rational, to_float
from pas.algebra.written import python_expression

Names = tuple[str, str]
Formula = Callable[[Any, Any], Any]
"""A function of two arrays (or jets)."""

FUNCTIONS: Mapping[str, Callable[[Any], Any]] = {
    **{name: getattr(np, name) for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "sqrt")},
    **{"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "Abs": np.absolute, "abs": np.absolute},
}
CONSTANTS = {"pi": float(np.pi), "E": float(np.e)}


class NotRationalError(ValueError):
    """The expression is no rational function with rational coefficients."""


def read_formula(expression: Any, names: Names) -> Formula:
    """The same expression, or one with elementary functions, as a function of arrays or jets."""
    text = as_text(expression)
    if text is None:
        raise TypeError(f"write the expression as a string in {' and '.join(filter(None, names))}, not {expression!r}")
    return evaluate(text, _Numeric(names))


def as_text(expression: Any) -> str | None:
    """The expression as a string, None for a number."""
    if isinstance(expression, str):
        return expression
    if not hasattr(expression, "free_symbols"):
        return None
    import sympy

    exact = {number: sympy.Rational(str(rational(number))) for number in expression.atoms(sympy.Float)}
    return str(expression.xreplace(exact))


class Values(Protocol):
    """What the reader needs to know of the values that it computes."""

    names: Names

    def number(self, value: fmpq) -> Any: ...
    def name(self, name: str) -> Any: ...
    def combine(self, operator: ast.operator, left: Any, right: Any) -> Any: ...
    def power(self, base: Any, exponent: Any) -> Any: ...
    def call(self, name: str, argument: Any) -> Any: ...


def evaluate(text: str, values: Values) -> Any:
    """What an expression comes to in some kind of values; raises `ValueError` saying what is wrong."""
    return _Reader(text, values).value()


class _Reader:
    def __init__(self, text: str, values: Values) -> None:
        self.text, self.values, self.source = text, values, ""

    def value(self) -> Any:
        if not self.text.strip():
            raise ValueError("the expression is empty; write for example '2*t/(1 + t^2)'")
        known = [*filter(None, self.values.names), *CONSTANTS]
        try:
            self.source = python_expression(check_text(self.text), known, FUNCTIONS)
            return self.read(syntax_tree(self.source))
        except RecursionError:
            raise ValueError(f"cannot read the expression {shown(self.text)}: it is nested too deeply") from None
        except NotRationalError as error:
            raise NotRationalError(f"{shown(self.text)} is not a rational function: {error}") from None
        except (ValueError, ZeroDivisionError) as error:
            raise ValueError(f"cannot read the expression {shown(self.text)}: {error}") from None

    def read(self, node: ast.expr) -> Any:
        if isinstance(node, ast.BinOp):
            return self._binary(node)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
            inner = self.read(node.operand)
            zero = self.values.number(fmpq(0))
            return inner if isinstance(node.op, ast.UAdd) else self.values.combine(ast.Sub(), zero, inner)
        if isinstance(node, ast.Name):
            return self.values.name(node.id)
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return self.values.number(literal(self._segment(node)))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and len(node.args) == 1 and not node.keywords:
            return self.values.call(node.func.id, self.read(node.args[0]))
        raise ValueError(f"{shown(self._segment(node))} is not arithmetic")

    def _binary(self, node: ast.BinOp) -> Any:
        left, right = self.read(node.left), self.read(node.right)
        if isinstance(node.op, ast.Pow):
            return self.values.power(left, right)
        if isinstance(node.op, ast.Add | ast.Sub | ast.Mult | ast.Div):
            return self.values.combine(node.op, left, right)
        raise ValueError(f"{shown(self._segment(node))} uses an operator other than + - * / ^")

    def _segment(self, node: ast.expr) -> str:
        return segment(self.source.encode(), node)


class _Numeric:
    def __init__(self, names: Names) -> None:
        self.names = names

    def number(self, value: fmpq) -> Formula:
        rounded = to_float(value)
        return lambda t, h: rounded

    def name(self, name: str) -> Formula:
        if name in self.names:
            return (lambda t, h: t) if name == self.names[0] else (lambda t, h: h)
        return lambda t, h: CONSTANTS[name]

    def combine(self, operator: ast.operator, left: Formula, right: Formula) -> Formula:
        if isinstance(operator, ast.Add):
            return lambda t, h: left(t, h) + right(t, h)
        if isinstance(operator, ast.Sub):
            return lambda t, h: left(t, h) - right(t, h)
        if isinstance(operator, ast.Mult):
            return lambda t, h: left(t, h) * right(t, h)
        return lambda t, h: left(t, h) / right(t, h)

    def power(self, base: Formula, exponent: Formula) -> Formula:
        return lambda t, h: base(t, h) ** exponent(t, h)

    def call(self, name: str, argument: Formula) -> Formula:
        function = FUNCTIONS[name]
        return lambda t, h: function(argument(t, h))
