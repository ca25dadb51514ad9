"""Elliptic paraboloids that end at a plane across their axis, as contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.rational import Exact, Vector, VectorLike
from pas.contacts.axial import Axial, perpendicular, vectors
from pas.contacts.contact import Contact


@dataclass(frozen=True)
class Paraboloid(Axial):
    """An elliptic paraboloid, cut off by a plane normal to its axis.

    Its vertex is `point`; the clip plane passes through `point + clip * axis`, and `semiaxes` are those of the ellipse
    there, vectors across the axis and one another, as the radius of a `Cone` is that of the circle in its clip plane.
    The blend's side of the plane is that of the vertex, and the inside that of the focus.  All numbers are exact.  With
    `w = x - point`, `u = w . axis / |axis|^2` and semi-axes a, b its polynomial is
    `(w.a/|a|^2)^2 + (w.b/|b|^2)^2 - u/clip`.

    Raises `ValueError` for a zero axis or clip, or semi-axes that are not perpendicular.
    """

    table: ClassVar[str] = "paraboloids"

    axis: Vector
    semiaxes: tuple[Vector, ...]
    clip: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(
        self, axis: VectorLike, semiaxes: Sequence[VectorLike], clip: Exact, point: VectorLike = (0, 0, 0)
    ) -> None:
        self.settle(axis, point, clip=clip)
        object.__setattr__(self, "semiaxes", perpendicular(semiaxes, "semiaxes", 2, to=self.axis))
        if self.clip == 0:
            raise ValueError("clip must not be 0, where a paraboloid has its vertex")

    __repr__ = brief

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip plane as polynomials."""
        return self.ended(self.squares(self.semiaxes) - self.along * (1 / self.clip))

    def __str__(self) -> str:
        return f"paraboloid {self.position} with semi-axes {vectors(self.semiaxes)}, {self.ending}"
