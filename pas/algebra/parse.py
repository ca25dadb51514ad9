"""Reads a polynomial from a string, exactly (the grammar: `pas.algebra.written`).

Decimals are the decimals written (0.1 is 1/10).  Nothing is evaluated but arithmetic, so a string from a file is
harmless.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NoReturn

from flint import fmpq, fmpq_mpoly

from pas.algebra.inputs import MAXIMAL_DEGREE, check_power, check_product, shown
from pas.algebra.written import Step, run, steps


def parse_polynomial(text: str, names: Mapping[str, fmpq_mpoly]) -> fmpq_mpoly:
    """The polynomial written in `text`; `names` gives the variables.

    Raises `ValueError` saying what is wrong and where.
    """
    if not text.strip():
        raise ValueError("the polynomial is empty; write for example 'x^2 + y^2 - 1/9'")
    try:
        return run(steps(text, names, equation=True), _Polynomials(names))
    except ValueError as error:
        raise ValueError(f"cannot read the polynomial {shown(text)}: {error}") from None


class _Polynomials:
    def __init__(self, names: Mapping[str, fmpq_mpoly]) -> None:
        self.names, self.one = names, next(iter(names.values())) ** 0

    def number(self, value: fmpq) -> fmpq_mpoly:
        return self.one * value

    def name(self, name: str) -> fmpq_mpoly:
        return self.names[name]

    def negative(self, value: fmpq_mpoly) -> fmpq_mpoly:
        return -value

    def call(self, name: str, argument: fmpq_mpoly) -> NoReturn:
        raise ValueError(f"{name} is not a polynomial")

    def combine(self, step: Step, left: fmpq_mpoly, right: fmpq_mpoly) -> fmpq_mpoly:
        if step.action == "+":
            return left + right
        if step.action == "-":
            return left - right
        if step.action == "**":
            return _power(step, left, right)
        if step.action == "/":
            right = _inverse(step, right)
        check_product(left, right)
        return left * right


def _inverse(step: Step, value: fmpq_mpoly) -> fmpq_mpoly:
    if not value.is_constant():
        raise ValueError(f"{step.written} divides by a polynomial")
    if value.is_zero():
        raise ValueError(f"{step.written} divides by zero")
    return value**0 * (1 / value.leading_coefficient())


def _power(step: Step, base: fmpq_mpoly, exponent: fmpq_mpoly) -> fmpq_mpoly:
    value = fmpq(0) if exponent.is_zero() else exponent.leading_coefficient()
    if not exponent.is_constant() or value.q != 1 or not 0 <= value <= MAXIMAL_DEGREE:
        raise ValueError(f"the exponent in {step.written} must be a whole number from 0 to {MAXIMAL_DEGREE}")
    try:
        check_power(base, int(value), MAXIMAL_DEGREE)
    except ValueError as error:
        raise ValueError(f"{step.written} is too large: {error}") from None
    return base ** int(value)
