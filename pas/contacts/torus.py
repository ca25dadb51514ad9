"""Tori as contacts: bent pipes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.affine import away, height
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, Vector, VectorLike, cross, dot, listed, plain, positive, three, vector
from pas.contacts.axial import Axial
from pas.contacts.contact import Contact
from pas.contacts.parallels import axis_of_revolution, quadratic_terms, shrunk
from pas.errors import GeometryError


@dataclass(frozen=True, repr=False)
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

    @cached_property
    def contact(self) -> Contact:
        surface = torus_polynomial(self.point, self.axis, dot(self.arm, self.arm), self.radius**2)
        tip = [p + a for p, a in zip(self.point, self.arm, strict=True)]
        return Contact(surface, Polynomial.from_raw(self.part(cross(self.axis, self.arm))), near=tip)

    @staticmethod
    def inner_surface(contact: Contact, thickness: fmpq) -> Polynomial | None:
        """The parallel surface of a torus; None for another surface."""
        found = torus_of(contact.surface)
        if found is None or found.lead <= 0:
            return None
        parallel = torus_polynomial(found.center, found.axis, found.major2, shrunk(found.minor2, thickness))
        return Polynomial.from_raw(parallel.raw * found.lead)

    def __str__(self) -> str:
        return (
            f"torus of radius {plain(self.radius)} about ({listed(self.axis)}) through ({listed(self.point)}), "
            f"clipped at the arm ({listed(self.arm)})"
        )


@dataclass(frozen=True)
class FoundTorus:
    """A torus by its centre, axis and the squares of its radii; its polynomial is `lead` times `torus_polynomial`."""

    center: Vector
    axis: Vector
    major2: fmpq
    minor2: fmpq
    lead: fmpq


def torus_of(polynomial: Polynomial) -> FoundTorus | None:
    """The torus that is a polynomial's zeros, exact; None where they are none."""
    terms = polynomial.raw.to_dict()
    lead = terms.get((4, 0, 0), fmpq(0))
    if polynomial.degree != 4 or lead == 0:
        return None
    center = three(terms.get(cube, fmpq(0)) / (-4 * lead) for cube in ((3, 0, 0), (0, 3, 0), (0, 0, 3)))
    w = away(center)
    square = dot(w, w)
    rest = Polynomial.from_raw(polynomial.raw / lead - square * square)
    found = axis_of_revolution(quadratic_terms(rest)) if rest.degree == 2 else None
    if found is None:
        return None
    double, single, axis = found
    major2, minor2 = (single - double) / 4, (single - double) / 4 - single / 2
    made = torus_polynomial(center, axis, major2, minor2).raw * lead if min(major2, minor2) > 0 else None
    return FoundTorus(center, axis, major2, minor2, lead) if made == polynomial.raw else None


def torus_polynomial(center: Sequence[fmpq], axis: Vector, major2: fmpq, minor2: fmpq) -> Polynomial:
    """`(|w|^2 + R^2 - r^2)^2 - 4 R^2 (|w|^2 - (w . a)^2 / |a|^2)`, w from the centre, by the squares of its radii."""
    w, along = away(center), height(center, axis)
    square = dot(w, w)
    tube = square + (major2 - minor2)
    return Polynomial.from_raw(tube * tube - (square - along * along / dot(axis, axis)) * (4 * major2))
