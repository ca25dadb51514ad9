"""Ellipsoids as contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.rational import Exact, Vector, VectorLike
from pas.contacts.axial import Axial, listed, perpendicular
from pas.contacts.contact import Contact


@dataclass(frozen=True)
class Ellipsoid(Axial):
    """An ellipsoid around `point` with three `semiaxes`, vectors across one another, cut off by a plane across `axis`.

    The plane passes through `point + clip * axis`; the axis, any vector, points away from the blend, whose side of the
    plane is that of -axis, as for a `Sphere`.  All numbers are exact.  With `w = x - point` and semi-axes a, b, c its
    polynomial is `(w.a/|a|^2)^2 + (w.b/|b|^2)^2 + (w.c/|c|^2)^2 - 1`.

    Raises `ValueError` for a zero axis or semi-axes that are not perpendicular, `GeometryError` where the plane misses
    the ellipsoid.
    """

    table: ClassVar[str] = "ellipsoids"

    axis: Vector
    semiaxes: tuple[Vector, ...]
    clip: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(
        self, axis: VectorLike, semiaxes: Sequence[VectorLike], clip: Exact, point: VectorLike = (0, 0, 0)
    ) -> None:
        self.settle(axis, point, clip=clip)
        object.__setattr__(self, "semiaxes", perpendicular(semiaxes, "semiaxes", 3))
        self.check_rim()

    __repr__ = brief

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip plane as polynomials."""
        return self.ended(self.squares(self.semiaxes) - 1, turned=False)

    def __str__(self) -> str:
        semiaxes = ", ".join(f"({listed(a)})" for a in self.semiaxes)
        return (
            f"ellipsoid with semi-axes {semiaxes} around ({listed(self.point)}), "
            f"{self.ending} along ({listed(self.axis)})"
        )
