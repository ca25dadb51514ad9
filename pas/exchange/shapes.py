"""What project files say of polynomials, partitions and surfaces: the shapes of their records, and polynomials read.

Nothing but polynomials is made here, so that the independent checker reads files by the same rules and makes of them
what it will.
"""

from __future__ import annotations

from typing import Any

from flint import fmpq

from pas.algebra.inputs import HIGHEST_POWER, shown
from pas.algebra.polynomial import RING, Polynomial
from pas.algebra.rational import plain, rational
from pas.exchange.schema import NUMBER, TEXT, WHOLE, Table, choice, list_of, maybe, row

POLYNOMIAL = list_of(row(WHOLE, WHOLE, WHOLE, NUMBER), words="a list of terms")
EQUATION = choice("a polynomial", TEXT, POLYNOMIAL)
POINT = list_of(NUMBER, 3, words="a point of three numbers")
_PARTITION_DATA = {"legs": list_of(POINT, 3), "lower": POINT, "upper": POINT, "vertices": list_of(POINT)}
PARTITION = Table(
    {"kind": TEXT, "center": maybe(POINT)},
    {**_PARTITION_DATA, "cells": list_of(list_of(WHOLE, 4)), "pieces": list_of(list_of(WHOLE))},
    open=True,
)
SURFACE = Table(
    {
        "partition": PARTITION,
        "contacts": list_of(Table({"surface": EQUATION, "clip": EQUATION})),
        "order": WHOLE,
        "degree": WHOLE,
        "patches": list_of(POLYNOMIAL),
    }
)
LONGEST_EQUATION = 1000
"""Characters up to which a contact is written as a formula, for people to read; longer ones as terms."""


def polynomial_record(polynomial: Polynomial) -> list[list[Any]]:
    """Terms [i, j, k, "p/q"] of x^i y^j z^k."""
    return [[*map(int, e), plain(c)] for e, c in polynomial.raw.to_dict().items()]


def read_polynomial(record: Any) -> Polynomial:
    """The polynomial of `polynomial_record`, of any degree that can be evaluated, or of a formula."""
    if isinstance(record, str):
        return Polynomial(record)
    terms: dict[tuple[int, ...], fmpq] = {}
    for i, j, k, coefficient in record:
        if min(i, j, k) < 0 or i + j + k > HIGHEST_POWER or (i, j, k) in terms:
            wrong = "stands twice" if (i, j, k) in terms else f"must have exponents >= 0 of sum up to {HIGHEST_POWER}"
            raise ValueError(f"the term {shown([i, j, k, coefficient])} of a polynomial {wrong}")
        terms[i, j, k] = rational(coefficient, "a coefficient")
    return Polynomial.from_raw(RING.from_dict(terms))


def equation_record(polynomial: Polynomial) -> str | list[list[Any]]:
    """A formula for people where it is short, else terms."""
    text = str(polynomial)
    return text if len(text) <= LONGEST_EQUATION else polynomial_record(polynomial)
