"""Generatrix blends in project files (`.pas.json`): the plain data of their boundaries and shape, and back.

Boundaries are kept as the tables from which they were read (`pas.exchange.boundaries`) and how they were turned, so
that reading searches nothing; shape functions as their exact coefficients.

Guaranteed: what is read is the same blend.  Not possible: boundaries and middle curves that are callables.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

from pas.algebra.rational import plain, rational
from pas.exchange.boundaries import boundary_from
from pas.exchange.schema import (
    ANYTHING,
    FLAG,
    NUMBER,
    REAL,
    TEXT,
    WHOLE,
    Choice,
    Kind,
    List,
    Maybe,
    Shape,
    Table,
    TableOf,
)
from pas.generatrix.align import Alignment
from pas.generatrix.blend import GeneratrixBlend
from pas.generatrix.boundary import Boundary
from pas.generatrix.shape import MANY, GeneratrixShape, ShapeFunction

VALUES = ("l1", "l2", "lambda1", "lambda2")

_FUNCTION = Choice(
    (Table({"cosine": List(REAL, 3)}), Table({"coefficients": List(NUMBER)})),
    "a shape function: a table with a cosine or coefficients",
)
_ALIGNMENT = {"reversed": FLAG, "shift": REAL, "distance": REAL, "opposed": FLAG, "reason": TEXT}
GENERATRIX_DATA: dict[str, Shape] = {
    "boundaries": List(Table({"table": TableOf(ANYTHING), "phase": REAL, "backwards": FLAG}), 2),
    "signs": List(Kind("1 or -1", lambda value: WHOLE.fits(value) and value in (1, -1)), 2),
    "unit": FLAG,
    "shape": Table(dict.fromkeys(VALUES, _FUNCTION) | {"middle": Maybe(List(Choice((TEXT, WHOLE), "a formula"), 3))}),
    "alignment": Table(_ALIGNMENT, {"by_length": FLAG}),
}
"""What a project file of a generatrix blend holds."""


def generatrix_record(blend: GeneratrixBlend) -> dict[str, Any]:
    """Everything that defines a blend; raises `ValueError` for one made of callables."""
    return {
        "boundaries": [_boundary_record(boundary) for boundary in blend.boundaries],
        "signs": list(blend.frames.signs),
        "unit": blend.frames.unit,
        "shape": {name: _function_record(getattr(blend.shape, name)) for name in VALUES} | {"middle": _middle(blend)},
        "alignment": asdict(blend.alignment),
    }


def read_generatrix(content: dict[str, Any]) -> GeneratrixBlend:
    """The blend of `generatrix_record`."""
    first, second = map(_read_boundary, content["boundaries"])
    record = content["shape"]
    shape = GeneratrixShape(**{n: _read_function(record[n]) for n in VALUES}, middle=record["middle"])
    a, b = content["signs"]
    return GeneratrixBlend.of_turned((first, second), (a, b), shape, Alignment(**content["alignment"]), content["unit"])


def _boundary_record(boundary: Boundary) -> dict[str, Any]:
    if boundary.source is None:
        raise ValueError(
            f"{boundary.name} was not made of plain data and cannot be saved; make it by pas.boundary_from or a "
            "problem file"
        )
    return {"table": dict(boundary.source), "phase": boundary.phase, "backwards": boundary.backwards}


def _read_boundary(record: dict[str, Any]) -> Boundary:
    made = boundary_from(record["table"])
    return replace(made, phase=float(record["phase"]), backwards=record["backwards"])


def _function_record(function: ShapeFunction) -> dict[str, Any]:
    if function.wave is not None:
        return {"cosine": list(function.wave)}
    return {"coefficients": [plain(rational(c)) for c in function.coefficients]}


def _read_function(record: dict[str, Any]) -> ShapeFunction:
    if "cosine" in record:
        low, high, start = map(float, record["cosine"])
        return ShapeFunction.cosine(low, high, start)
    if not 0 < len(record["coefficients"]) <= MANY:
        raise ValueError(f"a shape function must have 1 to {MANY} coefficients, not {len(record['coefficients'])}")
    constant = [ShapeFunction.constant(c).coefficients for c in record["coefficients"]]
    return ShapeFunction(tuple(c for (c,) in constant))


def _middle(blend: GeneratrixBlend) -> list[Any] | None:
    middle = blend.shape.middle
    if middle is None:
        return None
    if not isinstance(middle, list | tuple) or not all(isinstance(part, str | int) for part in middle):
        raise ValueError("a middle curve that is no list of three expressions in s, as strings, cannot be saved")
    return list(middle)
