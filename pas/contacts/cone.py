"""Cones: circular cones that end at a plane across their axis, as contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from flint import fmpq

from pas.algebra.rational import Exact, Vector, VectorLike, plain
from pas.contacts.endless import Circular


@dataclass(frozen=True)
class Cone(Circular):
    """A circular cone, cut off by a plane normal to its axis: a `Pipe` whose radius grows along it.

    `radius` is that of the circle in the clip plane, which passes through `point + clip * axis`; the radius grows by
    `slope` for each length of `axis`, away from the point.  All numbers are exact; `slope` may be negative, and 0 makes
    a pipe.  With the clip "auto" the program ends it where a blend has room, and `radius` is that of the circle around
    `point`.  With `w = x - point` and `u = w . axis / |axis|^2`, its polynomial is
    `|w|^2 - u^2 |axis|^2 - (radius + slope (u - clip))^2`.

    Raises `ValueError` for a zero axis or a radius that is not positive.
    """

    table: ClassVar[str] = "cones"

    axis: Vector
    radius: fmpq
    clip: fmpq | Literal["auto"]
    slope: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(
        self, axis: VectorLike, radius: Exact, clip: Exact, slope: Exact, point: VectorLike = (0, 0, 0)
    ) -> None:
        self.settle(axis, point, radius=radius, clip=clip, slope=slope)

    def __str__(self) -> str:
        axis, point = (", ".join(plain(c) for c in v) for v in (self.axis, self.point))
        where = "where" if self.ends else "and at that point"
        return (
            f"cone along ({axis}) through ({point}), {self.ending} {where} its radius is {plain(self.radius)}, "
            f"with slope {plain(self.slope)}"
        )
