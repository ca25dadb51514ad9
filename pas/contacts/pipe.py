"""Pipes: circular cylinders that end at a plane across their axis, as contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from flint import fmpq

from pas.algebra.rational import Exact, Vector, VectorLike, dot, plain
from pas.contacts.endless import Circular


@dataclass(frozen=True)
class Pipe(Circular):
    """An infinite circular cylinder, cut off by a plane normal to its axis.

    `axis` is its direction (any nonzero rational vector, of any length), `radius` its radius,
    `point` a point on its axis.  The clip plane passes through `point + clip * axis`; the blend's
    side of it is the one with `point` (the side in the direction of -axis where `clip` is 0).
    With the clip "auto" `pas.blend` ends it where there is room among the other contacts.  All
    numbers are exact (see `pas.Polynomial`).  Its polynomials are rational, since nothing is
    normalised by a square root: `|w|^2 - (w . axis)^2 / |axis|^2 - radius^2` with `w = x - point`.

    Raises `ValueError` for a zero axis or a radius that is not positive.
    """

    table: ClassVar[str] = "pipes"

    axis: Vector
    radius: fmpq
    clip: fmpq | Literal["auto"]
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(self, axis: VectorLike, radius: Exact, clip: Exact, point: VectorLike = (0, 0, 0)) -> None:
        self.settle(axis, point, radius=radius, clip=clip)

    @property
    def clip_scale(self) -> fmpq:
        """See `Circular.clip_scale`: `w . axis - clip |axis|^2` is what project files have."""
        return dot(self.axis, self.axis)

    def __str__(self) -> str:
        axis, point = (", ".join(plain(c) for c in v) for v in (self.axis, self.point))
        return f"pipe of radius {plain(self.radius)} along ({axis}) through ({point}), {self.ending}"
