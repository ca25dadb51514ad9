"""Fields of a design made exact: whatever its maker wrote is a `Fraction`, a `Polynomial` or points of these."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from fractions import Fraction
from typing import Any

from pas.algebra.inputs import shown
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, rational, to_fraction

Point = tuple[Fraction, ...]
Points = tuple[Point, ...]


def number(value: Any, name: str) -> Fraction:
    """The exact number that is meant; raises `ValueError` or `TypeError` that names it."""
    return to_fraction(rational(value, name))


def _polynomial(value: Any, name: str) -> Polynomial:
    try:
        return Polynomial(value)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name}: {error}") from None


def _point(value: Any, name: str) -> Point:
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise TypeError(f"{name} must be a point, as (2, 0.5), not {shown(value)}")
    return tuple(number(c, f"{name}[{i}]") for i, c in enumerate(value))


def _points(value: Any, name: str) -> Points:
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise TypeError(f"{name} must be a sequence of points, not {shown(value)}")
    found = tuple(_point(p, f"{name}[{i}]") for i, p in enumerate(value))
    for i, p in enumerate(found):
        if len(p) != len(found[0]):
            raise ValueError(f"{name}[{i}] has {len(p)} coordinates and {name}[0] has {len(found[0])}")
    return found


def _polynomials(value: Any, name: str) -> tuple[Polynomial, ...]:
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise TypeError(f"{name} must be a sequence of polynomials, not {shown(value)}")
    return tuple(_polynomial(p, f"{name}[{i}]") for i, p in enumerate(value))


def points(*rows: Sequence[Exact]) -> Points:
    """Points of any numbers, made exact: `points((1.5, 0.2), ("8/5", 1))`."""
    return _points(rows, "points")


READERS: dict[str, Callable[[Any, str], Any]] = {
    "Fraction": number,
    "Polynomial": _polynomial,
    "tuple[Polynomial, ...]": _polynomials,
    "Point": _point,
    "Points": _points,
}
"""How a field is read, by the type that it is declared with."""


def settle(design: Any) -> None:
    """Make the fields of a frozen dataclass what they are declared to be; to be called by its `__post_init__`."""
    for field in fields(design):
        object.__setattr__(design, field.name, READERS[str(field.type)](getattr(design, field.name), field.name))
