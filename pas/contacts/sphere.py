"""Spheres as contacts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.rational import Exact, Vector, VectorLike, plain
from pas.contacts.axial import Axial, listed, positive
from pas.contacts.contact import Contact


@dataclass(frozen=True)
class Sphere(Axial):
    """A sphere around `point`, cut off by a plane across `axis`.

    The plane passes through `point + clip * axis`; the axis points away from the blend, whose side of the plane is that
    of -axis.  So with a negative clip most of the ball stays and a cap makes room for the blend, with a positive one a
    cap stays.  All numbers are exact.  With `w = x - point` its polynomial is `|w|^2 - radius^2`.

    Raises `ValueError` for a zero axis or a radius that is not positive, `GeometryError` where the plane misses the
    sphere.
    """

    table: ClassVar[str] = "spheres"

    axis: Vector
    radius: fmpq
    clip: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(self, axis: VectorLike, radius: Exact, clip: Exact, point: VectorLike = (0, 0, 0)) -> None:
        self.settle(axis, point, radius=radius, clip=clip)
        positive(self.radius, "radius")
        self.check_rim()

    __repr__ = brief

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip plane as polynomials."""
        return self.ended(self.square - self.radius**2, turned=False)

    def __str__(self) -> str:
        return (
            f"sphere of radius {plain(self.radius)} around ({listed(self.point)}), "
            f"{self.ending} along ({listed(self.axis)})"
        )
