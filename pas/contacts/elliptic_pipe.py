"""Elliptic pipes: elliptic cylinders that end at a plane across their axis, as contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.rational import Exact, Vector, VectorLike
from pas.contacts.axial import longest, perpendicular, vectors
from pas.contacts.contact import Contact
from pas.contacts.endless import Endless


@dataclass(frozen=True)
class EllipticPipe(Endless):
    """An infinite elliptic cylinder, cut off by a plane normal to its axis.

    `semiaxes` are the two of its section, vectors across the axis and one another; the rest is as for a `Pipe`: the
    clip plane passes through `point + clip * axis`, the blend's side of it is the one with `point` (that of -axis where
    `clip` is 0), and the clip "auto" ends it where there is room.  All numbers are exact.  With `w = x - point` and
    semi-axes a, b its polynomial is `(w.a/|a|^2)^2 + (w.b/|b|^2)^2 - 1`.

    Raises `ValueError` for a zero axis or semi-axes that are not perpendicular.
    """

    table: ClassVar[str] = "elliptic_pipes"

    axis: Vector
    semiaxes: tuple[Vector, ...]
    clip: fmpq | Literal["auto"]
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(
        self, axis: VectorLike, semiaxes: Sequence[VectorLike], clip: Exact, point: VectorLike = (0, 0, 0)
    ) -> None:
        self.settle(axis, point, clip=clip)
        object.__setattr__(self, "semiaxes", perpendicular(semiaxes, "semiaxes", 2, to=self.axis))

    __repr__ = brief

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip plane as polynomials."""
        return self.ended(self.squares(self.semiaxes) - 1)

    def width(self, clip: float) -> float:
        """The longer semi-axis, at every clip."""
        return longest(self.semiaxes)

    def __str__(self) -> str:
        return f"elliptic pipe {self.position} with semi-axes {vectors(self.semiaxes)}, {self.ending}"
