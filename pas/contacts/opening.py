"""Openings: surfaces that a cone around a point inside them cuts, for nozzles on vessels and bosses on balls."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.inputs import short
from pas.algebra.polynomial import GENERATORS, Polynomial, PolynomialLike
from pas.algebra.rational import Exact, Vector, VectorLike, dot, plain, rational, vector
from pas.contacts.axial import listed, positive
from pas.contacts.cones import WIDEST
from pas.contacts.contact import Contact
from pas.contacts.movable import Movable
from pas.errors import GeometryError


@dataclass(frozen=True)
class Opening(Movable):
    """A surface out of which a blend rises along the curve that a cone cuts, in a plane or in none.

    `surface` is a polynomial, negative inside; the cone has its apex in `point`, which is inside, opens along `axis`,
    and is `slope` wide at a distance of one: the tangent of half of its angle.  With `w = x - point` the clip is
    `|w|^2 |axis|^2 - (1 + slope^2) (w . axis)^2`: the blend is inside the cone, the surface stays outside.

    A blend of an opening and one other contact is proved around the apex (see `pas.certify.openings`).

    Raises `ValueError` for a zero axis and a slope that is not from 1e-6 to 1e6, `GeometryError` for a point that is
    not inside.
    """

    table: ClassVar[str] = "openings"

    surface: Polynomial
    axis: Vector
    slope: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(self, surface: PolynomialLike, axis: VectorLike, slope: Exact, point: VectorLike = (0, 0, 0)) -> None:
        try:
            polynomial = Polynomial(surface)
        except (ValueError, TypeError) as error:
            raise type(error)(f"surface: {error}") from None
        object.__setattr__(self, "surface", polynomial)
        object.__setattr__(self, "axis", vector(axis, "axis"))
        object.__setattr__(self, "slope", rational(slope, "slope"))
        object.__setattr__(self, "point", vector(point, "point"))
        if not any(self.axis):
            raise ValueError("axis must not be the zero vector")
        positive(self.slope, "slope")
        if not 1 <= self.slope * fmpq(int(WIDEST)) <= int(WIDEST) ** 2:
            raise ValueError(
                f"slope must be from {1 / WIDEST:g} to {WIDEST:g}, not {short(plain(self.slope))}: it is the tangent "
                "of half of the cone's angle"
            )
        if polynomial.raw(*self.point) >= 0:
            raise GeometryError(
                f"the point ({', '.join(map(plain, self.point))}) must be inside the surface, where {polynomial} is "
                "negative: the cone opens from there"
            )

    __repr__ = brief

    @cached_property
    def contact(self) -> Contact:
        """The surface and the cone as polynomials."""
        w = [g - c for g, c in zip(GENERATORS, self.point, strict=True)]
        along = sum((c * a for c, a in zip(w, self.axis, strict=True)), 0 * w[0])
        square = sum((c * c for c in w), 0 * w[0])
        clip = square * dot(self.axis, self.axis) - (1 + self.slope**2) * along * along
        return Contact(self.surface, Polynomial.from_raw(clip))

    def __str__(self) -> str:
        return (
            f"opening of {self.surface} = 0 along ({listed(self.axis)}), {plain(self.slope)} wide at a distance of 1 "
            f"from ({listed(self.point)})"
        )
