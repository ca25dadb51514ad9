"""What pipes and cones have in common: circles around an axis, and a plane across it that ends them."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from flint import fmpq

from pas.algebra.rational import Exact, VectorLike, dot, to_float
from pas.contacts.axial import positive
from pas.contacts.contact import Contact
from pas.contacts.endless import Endless


class Circular(Endless):
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
        radius = (self.along - self.end) * self.slope + self.radius
        return self.ended(self.square - self.along**2 * dot(self.axis, self.axis) - radius * radius)

    def width(self, clip: float) -> float:
        """The radius of the circle at a clip."""
        return to_float(self.radius) + to_float(self.slope) * (clip - to_float(self._known_at))

    @property
    def _known_at(self) -> fmpq:
        """The clip to which `radius` belongs: that of the point without one."""
        return self.end if self.ends else fmpq(0)

    def _changes(self, clip: fmpq) -> dict[str, Any]:
        return {"clip": clip, "radius": self.radius + self.slope * (clip - self._known_at)}
