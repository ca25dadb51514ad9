"""Polynomials of low degree fitted by least squares inside the ideals of their joints, symmetric in y."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, rational
from pas.designs.exact import Point
from pas.fairing.energies.thin_plate import ThinPlate
from pas.fairing.quadrature import Box
from pas.fairing.wishes import ValueAt
from pas.partition.boxes import SingleCell
from pas.pipeline.space import SolutionSpace, solutions

Contacts = Sequence[tuple[Polynomial, Polynomial]]

PART_BOX = Box((Fraction(6, 5), Fraction(-3, 10), Fraction(-3, 5)), (3, Fraction(3, 10), Fraction(11, 10)))
"""Where the energy is taken."""


def even(contacts: Contacts, order: int, degree: int) -> SolutionSpace:
    """All polynomials of the degree that meet the contacts and are even in y."""
    space = solutions(contacts, order=order, degree=degree, partition=SingleCell())
    return space.restricted([m[0] for m in space.basis if all(e[1] % 2 == 0 for e in m[0].coefficients())])


def continued(
    contacts: Contacts, order: int, points: Sequence[Point], center: Point, inside: Sequence[Point] = ()
) -> Polynomial:
    """The cubic that meets the contacts, is -1 at the centre and least in squares at the given points.

    At points `inside` it is below 0 by 20.  The thin-plate energy has a small part, 1/2000, in what is minimised.
    """
    space = even(contacts, order, 3)
    best = space.optimum(
        ThinPlate(PART_BOX, weight=rational("1/2000")), near=points, near_weight=1, inside=inside, margin=20,
        normalize=ValueAt(center, -1),
    )  # fmt: skip
    return _rounded(space, best.coefficients)


def closest(
    space: SolutionSpace, points: Sequence[Any], inside: Point, weights: Sequence[Exact] | None = None
) -> Polynomial:
    """The member at the least mean squared distance from the given points, negative at the one inside."""
    member = _rounded(space, space.least_squares(points, weights, by_gradient=True).coefficients)
    return -member if member.at(inside) > 0 else member


def _rounded(space: SolutionSpace, coefficients: Iterable[Any]) -> Polynomial:
    """The member with coefficients of ten digits: any with rational coefficients keeps its joints."""
    return space.member([f"{float(c):.9e}" for c in coefficients]).polynomials[0]
