"""Hyperboloids of one sheet that end at a plane across their axis, as contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import hypot
from typing import ClassVar, Literal

from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.rational import Exact, Vector, VectorLike, plain, to_float
from pas.contacts.axial import longest, perpendicular, positive, vectors
from pas.contacts.contact import Contact
from pas.contacts.endless import Endless


@dataclass(frozen=True)
class Hyperboloid(Endless):
    """An elliptic hyperboloid of one sheet, cut off by a plane normal to its axis.

    `semiaxes` are those of its waist, the ellipse around `point`, vectors across the axis and one another; `conjugate`
    is the semi-axis along the axis, in lengths of it: at `u = conjugate` the ellipse is as large as the waist times the
    root of 2.  The clip plane and the blend's side of it are as for a `Pipe`.  All numbers are exact.  With
    `w = x - point`, `u = w . axis / |axis|^2` and semi-axes a, b its polynomial is
    `(w.a/|a|^2)^2 + (w.b/|b|^2)^2 - (u/conjugate)^2 - 1`.

    Raises `ValueError` for a zero axis, a conjugate that is not positive, or semi-axes that are not perpendicular.
    """

    table: ClassVar[str] = "hyperboloids"

    axis: Vector
    semiaxes: tuple[Vector, ...]
    clip: fmpq | Literal["auto"]
    conjugate: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(
        self,
        axis: VectorLike,
        semiaxes: Sequence[VectorLike],
        clip: Exact,
        conjugate: Exact,
        point: VectorLike = (0, 0, 0),
    ) -> None:
        self.settle(axis, point, clip=clip, conjugate=conjugate)
        object.__setattr__(self, "semiaxes", perpendicular(semiaxes, "semiaxes", 2, to=self.axis))
        positive(self.conjugate, "conjugate")

    __repr__ = brief

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip plane as polynomials."""
        return self.ended(self.squares(self.semiaxes) - (self.along * (1 / self.conjugate)) ** 2 - 1)

    def width(self, clip: float) -> float:
        """The longer semi-axis of the ellipse at a clip."""
        return longest(self.semiaxes) * hypot(1, clip / to_float(self.conjugate))

    def __str__(self) -> str:
        curves = f"semi-axes {vectors(self.semiaxes)}, conjugate semi-axis {plain(self.conjugate)}"
        return f"hyperboloid {self.position} with {curves}, {self.ending}"
