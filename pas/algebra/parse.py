"""Reads a polynomial from a string, exactly.

The grammar is Python's expression grammar restricted to numbers, the variables' names, the
operators + - * / and ** (or ^), and parentheses, with what people leave out (`2x^2y`) and with
equations, `f = g` for `f - g` (see `pas.algebra.written`).  Decimals are the decimals written (0.1
is 1/10).  Nothing is evaluated but arithmetic, so a string from a file is harmless.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping

from flint import fmpq, fmpq_mpoly

from pas.algebra.inputs import MAXIMAL_DEGREE, check_power, check_product, check_text, shown
from pas.algebra.rational import written
from pas.algebra.written import python_expression


def parse_polynomial(text: str, names: Mapping[str, fmpq_mpoly]) -> fmpq_mpoly:
    """The polynomial written in `text`; `names` gives the variables.

    Raises `ValueError` saying what is wrong and where.
    """
    if not text.strip():
        raise ValueError("the polynomial is empty; write for example 'x^2 + y^2 - 1/9'")
    one = next(iter(names.values())) ** 0
    try:
        source = python_expression(check_text(text), names, equation=True)
        return _Reader(source, names, one).read(syntax_tree(source))
    except RecursionError:
        raise ValueError(f"cannot read the polynomial {shown(text)}: it is nested too deeply") from None
    except ValueError as error:
        raise ValueError(f"cannot read the polynomial {shown(text)}: {error}") from None


class _Reader:
    def __init__(self, source: str, names: Mapping[str, fmpq_mpoly], one: fmpq_mpoly) -> None:
        self.source, self.names, self.one = source.encode(), names, one

    def read(self, node: ast.expr) -> fmpq_mpoly:
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
            return self._sum(node)
        if isinstance(node, ast.BinOp):
            return self._binary(node)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            return -self.read(node.operand)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd):
            return self.read(node.operand)
        if isinstance(node, ast.Name):
            return self.names[node.id]
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return self.one * literal(self._segment(node))
        raise ValueError(f"{shown(self._segment(node))} is not a polynomial expression in {', '.join(self.names)}")

    def _sum(self, node: ast.expr) -> fmpq_mpoly:
        """A sum of many terms, which the parser nests to the left, without deep recursion."""
        total = self.one * 0
        while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
            term = self.read(node.right)
            total = total + term if isinstance(node.op, ast.Add) else total - term
            node = node.left
        return total + self.read(node)

    def _binary(self, node: ast.BinOp) -> fmpq_mpoly:
        left, right = self.read(node.left), self.read(node.right)
        if isinstance(node.op, ast.Mult):
            check_product(left, right)
            return left * right
        if isinstance(node.op, ast.Div):
            if not right.is_constant():
                raise ValueError(f"{shown(self._segment(node))} divides by a polynomial")
            if right.is_zero():
                raise ValueError(f"{shown(self._segment(node))} divides by zero")
            return left * (1 / right.leading_coefficient())
        if isinstance(node.op, ast.Pow):
            return self._power(left, right, node)
        raise ValueError(f"{shown(self._segment(node))} uses an operator other than + - * / ^")

    def _power(self, base: fmpq_mpoly, exponent: fmpq_mpoly, node: ast.BinOp) -> fmpq_mpoly:
        value = fmpq(0) if exponent.is_zero() else exponent.leading_coefficient()
        if not exponent.is_constant() or value.q != 1 or not 0 <= value <= MAXIMAL_DEGREE:
            raise ValueError(
                f"the exponent in {shown(self._segment(node))} must be a whole number from 0 to {MAXIMAL_DEGREE}"
            )
        try:
            check_power(base, int(value), MAXIMAL_DEGREE)
        except ValueError as error:
            raise ValueError(f"{shown(self._segment(node))} is too large: {error}") from None
        return base ** int(value)

    def _segment(self, node: ast.expr) -> str:
        return segment(self.source, node)


def syntax_tree(source: str) -> ast.expr:
    """The tree of an expression on one line; raises `ValueError` where it is beyond Python's parser."""
    try:
        return ast.parse(source, mode="eval").body
    except SyntaxError:  # all else that could be wrong with it was found before
        raise ValueError("a number in it has more than 4300 digits") from None
    except (RecursionError, MemoryError):
        raise ValueError("it is too long, or nested too deeply") from None


def segment(source: bytes, node: ast.expr) -> str:
    """What a node of the tree of `source` was written as."""
    return source[node.col_offset : node.end_col_offset].decode()


def literal(text: str) -> fmpq:
    """The number of a literal; raises `ValueError` naming it."""
    try:
        return written(text)
    except ValueError as error:
        raise ValueError(f"the number {shown(text)} {error}") from None
