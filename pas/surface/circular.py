"""What pipes and cones have in common: circles around an axis, and a plane across it that ends them."""

from __future__ import annotations

from functools import cached_property

from flint import fmpq

from pas.algebra.rational import Exact, VectorLike, dot
from pas.surface.axial import Axial, positive
from pas.surface.contact import Contact


class Circular(Axial):
    """Where `|w|^2 - u^2 |axis|^2 - (radius + slope (u - clip))^2` is zero, `w = x - point`, `u = w . axis / |axis|^2`.

    It ends where u is `clip`, the blend on the side of `point`.  To be inherited by frozen dataclasses.
    """

    radius: fmpq
    slope: fmpq = fmpq(0)

    def settle(self, axis: VectorLike, point: VectorLike, **numbers: Exact) -> None:
        """Make what was given exact, and check it; raises `ValueError` for a zero axis or a radius not positive."""
        super().settle(axis, point, **numbers)
        positive(self.radius, "radius")

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip plane as polynomials."""
        radius = (self.along - self.clip) * self.slope + self.radius
        return self.ended(self.square - self.along**2 * dot(self.axis, self.axis) - radius * radius)
