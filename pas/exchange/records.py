"""Forms of exact objects in project files: what their records look like, and what is made of them and they of it.

The forms of files in general, polynomials among them, stand in `pas.exchange.schema`.
"""

from __future__ import annotations

from dataclasses import replace
from operator import methodcaller
from typing import Any

from pas.algebra.inputs import shown
from pas.algebra.rational_function import RING, RationalFunction
from pas.contacts.contact import Contact
from pas.exchange import schema
from pas.exchange.schema import (
    EQUATION,
    NUMBER,
    POINT,
    REAL,
    TEXT,
    WHOLE,
    Table,
    choice,
    list_of,
    maybe,
    one_of,
    read_by,
    read_terms,
    row,
    terms_record,
)
from pas.fairing.energy import read_energy
from pas.fairing.wishes import MeanAlpha, Normalization, SumOfCoefficients, UnitCoefficients, ValueAt
from pas.parametric.surface import ParametricSurface
from pas.partition.cells import read_partition
from pas.piecewise import PiecewiseSurface
from pas.verdicts import Status

PARTITION = read_by(schema.PARTITION, read_partition, methodcaller("to_record"))
ENERGY = read_by(Table({"kind": TEXT}, open=True), read_energy, methodcaller("to_record"))
VERDICT = Table(
    {
        "claim": TEXT,
        "status": one_of([status.value for status in Status]),
        "reason": TEXT,
        "witness": maybe(list_of(REAL, 3)),
        "measure": WHOLE,
    }
)
SURFACE = Table(
    {
        **schema.SURFACE.needs,
        "partition": PARTITION,
        "contacts": list_of(Table({"surface": EQUATION, "clip": EQUATION}, make=Contact)),
    },
    make=lambda patches, **others: PiecewiseSurface.from_polynomials(polynomials=patches, **others),
    names={"patches": "polynomials"},
)

NORMALIZATIONS: dict[str, type[Any]] = {
    "mean-alpha": MeanAlpha,
    "sum-of-coefficients": SumOfCoefficients,
    "unit-coefficients": UnitCoefficients,
    "value-at": ValueAt,
}


def normalization(kind: str, point: Any = None, value: Any = -1) -> Normalization:
    """The normalisation of a kind, of a value at a point with these; raises `ValueError`."""
    if kind not in NORMALIZATIONS:
        raise ValueError(f"kind must be one of {', '.join(NORMALIZATIONS)}, not {shown(kind)}")
    if kind == "value-at" and point is None:
        raise ValueError("a normalisation by a value needs its point")
    return ValueAt(point, value) if kind == "value-at" else NORMALIZATIONS[kind]()


def _of_normalization(normalization: Normalization) -> dict[str, Any]:
    kind = next(name for name, made in NORMALIZATIONS.items() if type(normalization) is made)
    return {"kind": kind, **vars(normalization)}


CONSTRAINTS = Table(
    {
        **dict.fromkeys(("inside", "outside", "through", "near"), list_of(POINT)),
        "near_weight": list_of(NUMBER),
        "handles": list_of(row(row(WHOLE, list_of(WHOLE, 4)), NUMBER)),
        "margin": maybe(NUMBER),
        "normalize": Table(
            {"kind": one_of(tuple(NORMALIZATIONS))},
            {"point": POINT, "value": NUMBER},
            make=normalization,
            entries=_of_normalization,
        ),
    },
    {"coefficients": list_of(row(WHOLE, NUMBER))},
    names={"near_weight": "near_weights"},
)
"""The points and the normalisation of a blend: read as the keywords of `Wishes`."""

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
