"""Plates: planes with a circle or an ellipse as contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.affine import slope_at
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, Vector, VectorLike, dot, listed, positive
from pas.contacts.axial import Axial, vectors
from pas.contacts.contact import Contact
from pas.contacts.parallels import root


@dataclass(frozen=True, repr=False)
class Plate(Axial):
    """A solid with a plane face, out of which a blend rises along a circle or an ellipse around `point`.

    `axis` is the normal of the plane through `point` and points out of the solid, which is inside.  The curve is a
    circle of a `radius`, or an ellipse with two `semiaxes`, vectors in the plane across one another.  All numbers are
    exact.  With `w = x - point` the surface is `w . axis` and the clip, the cylinder across the plane through the
    curve, `|w|^2 - (w . axis)^2 / |axis|^2 - radius^2` or `(w.a/|a|^2)^2 + (w.b/|b|^2)^2 - 1`: the blend is inside the
    cylinder, the plate stays outside.

    What holds: a surface meets the plate with GC^k iff it is in `<w . axis, clip^(k+1)>`, so solution spaces are
    complete and exact.  A blend of a plate and one other contact is a single polynomial, seen from below through the
    plate's curve, with that cone as the clip (see `pas.certify.contact_proofs`); on the plane it is the same
    ideal.  In a
    region that is given it is solved and proved along its curve, and whether it is enclosed stays undecided.

    Raises `ValueError` for a zero axis, for a radius that is not positive, for semi-axes that are not perpendicular,
    and unless just one of radius and semi-axes is given.
    """

    table: ClassVar[str] = "plates"

    axis: Vector
    radius: fmpq | None = None
    semiaxes: tuple[Vector, ...] | None = None
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(
        self,
        axis: VectorLike,
        radius: Exact | None = None,
        semiaxes: Sequence[VectorLike] | None = None,
        point: VectorLike = (0, 0, 0),
    ) -> None:
        if (radius is None) == (semiaxes is None):
            raise ValueError("radius or semiaxes must be given, and not both: a circle or an ellipse")
        self.settle(axis, point, semiaxes)
        if radius is not None:
            object.__setattr__(self, "radius", positive(radius, "radius"))

    @cached_property
    def contact(self) -> Contact:
        length2, along = dot(self.axis, self.axis), self.along
        if self.radius is not None:
            cylinder = self.square - along * along * length2 - self.radius**2
        else:
            cylinder = self.squares(self.semiaxes or ()) - 1
        return Contact(Polynomial.from_raw(along * length2), Polynomial.from_raw(cylinder))

    @staticmethod
    def inner_surface(contact: Contact, thickness: fmpq) -> Polynomial | None:
        """The plane inside a plane; None for other surfaces."""
        f = contact.surface
        if f.degree != 1:
            return None
        slope = slope_at(f)
        return f + Polynomial(thickness * root(dot(slope, slope)))

    def __str__(self) -> str:
        semiaxes = vectors(self.semiaxes or ())
        curve = f"an ellipse with semi-axes {semiaxes}" if self.radius is None else f"a circle of radius {self.radius}"
        return f"plate with the normal ({listed(self.axis)}) and {curve} around ({listed(self.point)})"
