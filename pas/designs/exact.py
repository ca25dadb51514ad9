"""The means of designs: exact fields, and polynomials fitted to points inside the ideals of their joints.

Whatever a maker wrote becomes a `Fraction`, a `Polynomial` or points of these; what is fitted is even in y.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from fractions import Fraction
from typing import Any

from flint import fmpq_mat

from pas.algebra.brief import brief
from pas.algebra.inputs import shown
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, rational, to_fraction
from pas.partition.boxes import SingleCell
from pas.pipeline.blend import solutions
from pas.pipeline.result import SolutionSpace

Point = tuple[Fraction, ...]
Points = tuple[Point, ...]


def number(value: Any, name: str) -> Fraction:
    """The exact number that is meant; raises `ValueError` or `TypeError` that names it."""
    return to_fraction(rational(value, name))


def _each(value: Any, name: str, what: str, read: Callable[[Any, str], Any]) -> tuple[Any, ...]:
    """The entries of a sequence, each read; raises `TypeError` for what is no sequence."""
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise TypeError(f"{name} must be {what}, not {shown(value)}")
    return tuple(read(entry, f"{name}[{i}]") for i, entry in enumerate(value))


def _point(value: Any, name: str) -> Point:
    return _each(value, name, "a point, as (2, 0.5)", number)


def _points(value: Any, name: str) -> Points:
    found = _each(value, name, "a sequence of points", _point)
    for i, p in enumerate(found):
        if len(p) != len(found[0]):
            raise ValueError(f"{name}[{i}] has {len(p)} coordinates and {name}[0] has {len(found[0])}")
    return found


def points(*rows: Sequence[Exact]) -> Points:
    """Points of any numbers, made exact: `points((1.5, 0.2), ("8/5", 1))`."""
    return _points(rows, "points")


READERS: dict[str, Callable[[Any, str], Any]] = {
    "Fraction": number,
    "Polynomial": Polynomial.named,
    "tuple[Polynomial, ...]": lambda value, name: _each(value, name, "a sequence of polynomials", Polynomial.named),
    "Point": _point,
    "Points": _points,
}
"""How a field is read, by the type that it is declared with."""


class Design:
    """The base of frozen dataclasses, without a repr of their own, whose fields become what they are declared to be."""

    __repr__ = brief

    def __post_init__(self) -> None:
        for field in fields(self):  # type: ignore[arg-type]  # all are dataclasses
            object.__setattr__(self, field.name, READERS[str(field.type)](getattr(self, field.name), field.name))


Contacts = Sequence[tuple[Polynomial, Polynomial]]


def even(contacts: Contacts, order: int, degree: int) -> SolutionSpace:
    """All polynomials of the degree that meet the contacts and are even in y."""
    space = solutions(contacts, order=order, degree=degree, partition=SingleCell())
    return space.restricted([m[0] for m in space.basis if all(e[1] % 2 == 0 for e in m[0].coefficients())])


def closest(
    space: SolutionSpace,
    points: Sequence[Any],
    inside: Point,
    by_gradient: bool = True,
) -> Polynomial:
    """The member at the least mean squared distance from the given points, negative at the one inside.

    Without `by_gradient` the distance is `|f(p)| / |f|`, |f| the length of the coefficients.
    """
    found = space.least_squares(points, by_gradient=by_gradient).coefficients
    # of ten digits: any member with rational coefficients keeps its joints
    member = space.member([f"{float(c):.9e}" for c in found]).polynomials[0]
    return -member if member.at(inside) > 0 else member


def nearest(space: SolutionSpace, given: Polynomial) -> Polynomial:
    """The member whose coefficients are at the least distance from those of a polynomial, exactly."""
    members = [m[0] for m in space.basis]
    rows = fmpq_mat([p.row(space.degree) for p in (*members, given)])
    products = (rows * rows.transpose()).tolist()
    gram = fmpq_mat([row[:-1] for row in products[:-1]])
    found = gram.solve(fmpq_mat([[row[-1]] for row in products[:-1]])).entries()
    return space.member(found).polynomials[0]
