"""Parametric surfaces in project files: terms of numerators and denominators, else the expressions as written."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pas.algebra.rational_function import RING, RationalFunction
from pas.exchange.schema import (
    NUMBER,
    TEXT,
    WHOLE,
    Table,
    choice,
    list_of,
    maybe,
    read_terms,
    row,
    terms_record,
)
from pas.parametric.surface import ParametricSurface

_TERMS = replace(
    list_of(row(WHOLE, WHOLE, NUMBER), words="a list of terms"),
    read=lambda record: RING.from_dict(read_terms(record, "a component")),
    write=terms_record,
)
_QUOTIENT = row(_TERMS, _TERMS)
COMPONENTS = list_of(replace(_QUOTIENT, write=lambda f: _QUOTIENT.write((f.numerator, f.denominator))), 3)
DOMAIN = list_of(row(maybe(NUMBER), maybe(NUMBER)), 2)
_COMMON = {"parameters": list_of(TEXT, 2), "domain": DOMAIN}


def exact_surface(components: Any, parameters: Any, domain: Any) -> ParametricSurface:
    """A surface of rational functions, each as its numerator and its denominator."""
    first, second = parameters
    x, y, z = (RationalFunction.quotient(above, below, (first, second)) for above, below in components)
    return ParametricSurface(x, y, z, (first, second), domain)


def _written(expressions: Any, parameters: Any, domain: Any) -> ParametricSurface:
    (x, y, z), (first, second) = expressions, parameters
    return ParametricSurface(x, y, z, (first, second), domain)


def _entries(surface: ParametricSurface) -> dict[str, Any]:
    """Everything that defines a surface; raises `ValueError` for one made of callables."""
    common = {"parameters": surface.parameters, "domain": surface.ends}
    if surface.is_exact:
        return common | {"components": surface.components}
    if surface.text is None:
        raise ValueError(f"a surface without expressions cannot be saved ({surface.inexact}); write them as strings")
    return common | {"expressions": surface.text}


PARAMETRIC = choice(
    "a surface: a table with components or expressions",
    Table(
        {"components": COMPONENTS, **_COMMON}, make=exact_surface, entries=_entries, of=lambda surface: surface.is_exact
    ),
    Table({"expressions": list_of(TEXT, 3), **_COMMON}, make=_written, entries=_entries),
)
