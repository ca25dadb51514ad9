"""Tori as contacts: bent pipes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.affine import away, height
from pas.algebra.brief import brief
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Exact, Vector, VectorLike, cross, dot, listed, plain, positive, vector
from pas.contacts.axial import Axial
from pas.contacts.contact import Contact
from pas.contacts.parallels import principal_axes_of, shrunk
from pas.errors import GeometryError


@dataclass(frozen=True)
class Torus(Axial):
    """A bent pipe: the torus that a circle around `point + arm` makes when it is turned about `axis` through `point`.

    `radius` is that of the circle; the major radius is the length of `arm`, a vector across the axis.  The contact is
    that circle: the clip plane holds the axis and the arm, and `axis x arm` points away from the blend, so that the
    pipe goes on counterclockwise seen from the axis' tip.  The plane cuts the torus in the circle across, too, which
    must stay outside the region of a blend.  All numbers are exact.  With `w = x - point` and `u = w . axis / |axis|^2`
    its polynomial is `(|w|^2 + |arm|^2 - radius^2)^2 - 4 |arm|^2 (|w|^2 - u^2 |axis|^2)`.

    Raises `ValueError` for a zero axis or arm, an arm that is not perpendicular to the axis or a radius that is not
    positive, `GeometryError` for a radius that is not below the length of the arm.
    """

    table: ClassVar[str] = "tori"
    noun: ClassVar[str] = "torus"

    axis: Vector
    arm: Vector
    radius: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(self, axis: VectorLike, arm: VectorLike, radius: Exact, point: VectorLike = (0, 0, 0)) -> None:
        self.settle(axis, point, radius=radius)
        object.__setattr__(self, "arm", vector(arm, "arm"))
        positive(self.radius, "radius")
        if all(a == 0 for a in self.arm):
            raise ValueError("arm must not be the zero vector")
        if dot(self.axis, self.arm) != 0:
            raise ValueError(
                f"arm must be perpendicular to the axis ({listed(self.axis)}), and ({listed(self.arm)}) is not"
            )
        if self.radius**2 >= dot(self.arm, self.arm):
            raise GeometryError(f"a torus of radius {plain(self.radius)} needs a longer arm than ({listed(self.arm)})")

    __repr__ = brief

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip plane as polynomials."""
        surface = torus_polynomial(self.point, self.axis, dot(self.arm, self.arm), self.radius**2)
        tip = [p + a for p, a in zip(self.point, self.arm, strict=True)]
        return Contact(surface, Polynomial.from_raw(self.part(cross(self.axis, self.arm))), near=tip)

    @staticmethod
    def inner_surface(contact: Contact, thickness: fmpq) -> Polynomial | None:
        """The parallel surface of a torus; None for another surface."""
        f = contact.surface
        lead = f.raw.to_dict().get((4, 0, 0), fmpq(0)) if f.degree == 4 else fmpq(0)
        if lead <= 0:
            return None
        terms = f.raw.to_dict()
        center = tuple(-terms.get(tuple(3 * (i == j) for j in range(3)), fmpq(0)) / (4 * lead) for i in range(3))
        w = away(center)
        square = dot(w, w)
        rest = Polynomial.from_raw(f.raw / lead - square * square)
        if rest.degree != 2:
            return None
        axes = principal_axes_of(rest, contact)
        if axes is None:
            return None
        axis, most = max(axes, key=lambda pair: pair[1])
        major2 = (most - min(value for _, value in axes)) / 4
        minor2 = major2 - most / 2

        def whole(square: fmpq) -> Polynomial:
            return torus_polynomial(center, axis, major2, square) * Polynomial.from_raw(GENERATORS[0] * 0 + lead)

        return whole(shrunk(minor2, thickness)) if minor2 > 0 and whole(minor2) == f else None

    def __str__(self) -> str:
        return (
            f"torus of radius {plain(self.radius)} about ({listed(self.axis)}) through ({listed(self.point)}), "
            f"clipped at the arm ({listed(self.arm)})"
        )


def torus_polynomial(center: Sequence[fmpq], axis: Vector, major2: fmpq, minor2: fmpq) -> Polynomial:
    """`(|w|^2 + R^2 - r^2)^2 - 4 R^2 (|w|^2 - (w . a)^2 / |a|^2)`, w from the centre, by the squares of its radii."""
    w, along = away(center), height(center, axis)
    square = dot(w, w)
    tube = square + (major2 - minor2)
    return Polynomial.from_raw(tube * tube - (square - along * along / dot(axis, axis)) * (4 * major2))
