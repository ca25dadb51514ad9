"""What pipes and cones have in common: circles around an axis, and a plane across it that ends them."""

from __future__ import annotations

from functools import cached_property

from flint import fmpq

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Exact, Vector, VectorLike, dot, plain, rational, vector
from pas.surface.contact import Contact
from pas.surface.movable import Movable

ZERO = GENERATORS[0] * 0


class Circular(Movable):
    """Where `|w|^2 - u^2 |axis|^2 - (radius + slope (u - clip))^2` is zero, `w = x - point`, `u = w . axis / |axis|^2`.

    It ends where u is `clip`, the blend on the side of `point`.  To be inherited by frozen dataclasses.
    """

    axis: Vector
    radius: fmpq
    clip: fmpq
    point: Vector
    slope: fmpq = fmpq(0)

    def settle(self, axis: VectorLike, point: VectorLike, **numbers: Exact) -> None:
        """Make what was given exact, and check it; raises `ValueError` for a zero axis or a radius not positive."""
        exact = {name: rational(value, name) for name, value in numbers.items()}
        for name, value in ({"axis": vector(axis, "axis"), "point": vector(point, "point")} | exact).items():
            object.__setattr__(self, name, value)
        if all(a == 0 for a in self.axis):
            raise ValueError("axis must not be the zero vector")
        if self.radius <= 0:
            raise ValueError(f"radius must be positive, not {plain(self.radius)}")

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip plane as polynomials."""
        length2 = dot(self.axis, self.axis)
        offset = [g - p for g, p in zip(GENERATORS, self.point, strict=True)]
        along = sum((w * a for w, a in zip(offset, self.axis, strict=True)), ZERO) * (1 / length2)
        radius = (along - self.clip) * self.slope + self.radius
        surface = sum((w * w for w in offset), ZERO) - along * along * length2 - radius * radius
        clip = (along - self.clip) * (self.clip_scale if self.clip >= 0 else -self.clip_scale)
        return Contact(Polynomial.from_raw(surface), Polynomial.from_raw(clip))

    @property
    def clip_scale(self) -> fmpq:
        """The factor of the clip polynomial, which is (u - clip) else."""
        return fmpq(1)
