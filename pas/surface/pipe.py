"""Pipes: circular cylinders that end at a plane across their axis, as contacts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Exact, Vector, VectorLike, dot, plain, rational, vector
from pas.surface.contact import Contact


@dataclass(frozen=True)
class Pipe:
    """An infinite circular cylinder, cut off by a plane normal to its axis.

    `axis` is its direction (any nonzero rational vector, of any length), `radius` its radius,
    `point` a point on its axis.  The clip plane passes through `point + clip * axis`; the blend's
    side of it is the one with `point` (the side in the direction of -axis where `clip` is 0).
    All numbers are exact (see `pas.Polynomial`).  Its polynomials are rational, since nothing is
    normalised by a square root: `|w|^2 - (w . axis)^2 / |axis|^2 - radius^2` with `w = x - point`.

    Raises `ValueError` for a zero axis or a radius that is not positive.
    """

    table: ClassVar[str] = "pipes"

    axis: Vector
    radius: fmpq
    clip: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(self, axis: VectorLike, radius: Exact, clip: Exact, point: VectorLike = (0, 0, 0)) -> None:
        object.__setattr__(self, "axis", vector(axis, "axis"))
        object.__setattr__(self, "radius", rational(radius, "radius"))
        object.__setattr__(self, "clip", rational(clip, "clip"))
        object.__setattr__(self, "point", vector(point, "point"))
        if all(a == 0 for a in self.axis):
            raise ValueError("axis must not be the zero vector")
        if self.radius <= 0:
            raise ValueError(f"radius must be positive, not {plain(self.radius)}")

    @cached_property
    def contact(self) -> Contact:
        """The cylinder and its clip plane as polynomials."""
        length2 = dot(self.axis, self.axis)
        offset = [g - p for g, p in zip(GENERATORS, self.point, strict=True)]
        along = sum((w * a for w, a in zip(offset, self.axis, strict=True)), GENERATORS[0] * 0)
        surface = sum((w * w for w in offset), GENERATORS[0] * 0) - along * along * (1 / length2)
        clip = along - self.clip * length2
        if self.clip < 0:
            clip = -clip
        return Contact(Polynomial.from_raw(surface - self.radius * self.radius), Polynomial.from_raw(clip))

    def __str__(self) -> str:
        axis, point = (", ".join(plain(c) for c in v) for v in (self.axis, self.point))
        return f"pipe of radius {plain(self.radius)} along ({axis}) through ({point}), clipped at {plain(self.clip)}"
