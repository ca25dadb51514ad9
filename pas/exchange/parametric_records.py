"""Parametric surfaces and their rational functions in project files: everything exact, and back.

Rational components are kept as terms of numerators and denominators, others as the expressions that were written;
domains by their exact ends.

Guaranteed: what is read is equal to what was written.  Not possible: callables, which have no text.
"""

from __future__ import annotations

from typing import Any

from flint import fmpq, fmpq_mpoly

from pas.algebra.inputs import HIGHEST_POWER, shown
from pas.algebra.rational import plain, rational
from pas.algebra.rational_function import RING, RationalFunction
from pas.exchange.schema import NUMBER, TEXT, WHOLE, Choice, List, Maybe, Row, Table
from pas.parametric.surface import ParametricSurface

TERMS = List(Row((WHOLE, WHOLE, NUMBER)), words="a list of terms")
COMPONENTS = List(Row((TERMS, TERMS)), 3)
DOMAIN = List(Row((Maybe(NUMBER), Maybe(NUMBER))), 2)
_PARAMETERS = List(TEXT, 2)
SURFACE = Choice(
    (
        Table({"components": COMPONENTS, "parameters": _PARAMETERS, "domain": DOMAIN}),
        Table({"expressions": List(TEXT, 3), "parameters": _PARAMETERS, "domain": DOMAIN}),
    ),
    "a surface: a table with components or expressions",
)


def surface_record(surface: ParametricSurface) -> dict[str, Any]:
    """Everything that defines a surface; raises `ValueError` for one made of callables."""
    record: dict[str, Any] = {"parameters": list(surface.parameters), "domain": domain_record(surface)}
    if surface.is_exact:
        return record | {"components": [function_record(c) for c in surface.components]}
    if surface.text is None:
        raise ValueError(f"a surface without expressions cannot be saved ({surface.inexact}); write them as strings")
    return record | {"expressions": list(surface.text)}


def read_surface(record: dict[str, Any]) -> ParametricSurface:
    """The surface of `surface_record`."""
    first, second = record["parameters"]
    if "expressions" in record:
        a, b, c = record["expressions"]
        return ParametricSurface(a, b, c, (first, second), record["domain"])
    x, y, z = (read_function(part, (first, second)) for part in record["components"])
    return ParametricSurface(x, y, z, (first, second), record["domain"])


def function_record(function: RationalFunction) -> list[list[list[Any]]]:
    """Terms [i, j, "p/q"] of t^i h^j of the numerator and of the denominator."""
    parts = (function.numerator, function.denominator)
    return [[[int(i), int(j), plain(c)] for (i, j), c in part.to_dict().items()] for part in parts]


def read_function(record: Any, names: tuple[str, str]) -> RationalFunction:
    """The function of `function_record`."""
    above, below = map(_read_terms, record)
    return RationalFunction.quotient(above, below, names)


def _read_terms(record: Any) -> fmpq_mpoly:
    terms: dict[tuple[int, ...], fmpq] = {}
    for i, j, coefficient in record:
        if min(i, j) < 0 or i + j > HIGHEST_POWER or (i, j) in terms:
            wrong = "stands twice" if (i, j) in terms else f"must have exponents >= 0 of sum up to {HIGHEST_POWER}"
            raise ValueError(f"the term {shown([i, j, coefficient])} of a component {wrong}")
        terms[i, j] = rational(coefficient, "a coefficient")
    return RING.from_dict(terms)


def domain_record(surface: ParametricSurface) -> list[list[str | None]]:
    """The exact ends of the domain, null for infinite ones."""
    return [[None if end is None else str(end) for end in interval] for interval in surface.ends]
