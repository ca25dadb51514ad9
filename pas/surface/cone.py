"""Cones: circular cones that end at a plane across their axis, as contacts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Exact, Vector, VectorLike, dot, plain, rational, vector
from pas.surface.contact import Contact


@dataclass(frozen=True)
class Cone:
    """A circular cone, cut off by a plane normal to its axis: a `Pipe` whose radius grows along it.

    `radius` is that of the circle in the clip plane, which passes through `point + clip * axis`; the radius grows by
    `slope` for each length of `axis`, away from the point.  All numbers are exact; `slope` may be negative, and 0 makes
    a pipe.  With `w = x - point` and `u = w . axis / |axis|^2`, its polynomial is
    `|w|^2 - u^2 |axis|^2 - (radius + slope (u - clip))^2`.

    Raises `ValueError` for a zero axis or a radius that is not positive.
    """

    table: ClassVar[str] = "cones"

    axis: Vector
    radius: fmpq
    clip: fmpq
    slope: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(
        self, axis: VectorLike, radius: Exact, clip: Exact, slope: Exact, point: VectorLike = (0, 0, 0)
    ) -> None:
        object.__setattr__(self, "axis", vector(axis, "axis"))
        object.__setattr__(self, "radius", rational(radius, "radius"))
        object.__setattr__(self, "clip", rational(clip, "clip"))
        object.__setattr__(self, "slope", rational(slope, "slope"))
        object.__setattr__(self, "point", vector(point, "point"))
        if all(a == 0 for a in self.axis):
            raise ValueError("axis must not be the zero vector")
        if self.radius <= 0:
            raise ValueError(f"radius must be positive, not {plain(self.radius)}")

    @cached_property
    def contact(self) -> Contact:
        """The cone and its clip plane as polynomials."""
        length2 = dot(self.axis, self.axis)
        offset = [g - p for g, p in zip(GENERATORS, self.point, strict=True)]
        along = sum((w * a for w, a in zip(offset, self.axis, strict=True)), GENERATORS[0] * 0) * (1 / length2)
        radius = (along - self.clip) * self.slope + self.radius
        surface = sum((w * w for w in offset), GENERATORS[0] * 0) - along * along * length2 - radius * radius
        clip = (along - self.clip) * (1 if self.clip >= 0 else -1)
        return Contact(Polynomial.from_raw(surface), Polynomial.from_raw(clip))

    def __str__(self) -> str:
        axis, point = (", ".join(plain(c) for c in v) for v in (self.axis, self.point))
        return (
            f"cone along ({axis}) through ({point}), clipped at {plain(self.clip)} where its radius is "
            f"{plain(self.radius)}, with slope {plain(self.slope)}"
        )
