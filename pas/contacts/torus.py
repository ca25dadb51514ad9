"""Tori as contacts: bent pipes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, Vector, VectorLike, cross, dot, plain, vector
from pas.contacts.axial import Axial, listed, positive
from pas.contacts.contact import Contact
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
        major2, along = dot(self.arm, self.arm), self.along
        tube = self.square + (major2 - self.radius**2)
        surface = tube * tube - (self.square - along * along * dot(self.axis, self.axis)) * (4 * major2)
        tip = [p + a for p, a in zip(self.point, self.arm, strict=True)]
        return Contact(
            Polynomial.from_raw(surface), Polynomial.from_raw(self.part(cross(self.axis, self.arm))), near=tip
        )

    def __str__(self) -> str:
        return (
            f"torus of radius {plain(self.radius)} about ({listed(self.axis)}) through ({listed(self.point)}), "
            f"clipped at the arm ({listed(self.arm)})"
        )
