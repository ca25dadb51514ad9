"""Quadrics by their axes as contacts: spheres, ellipsoids and paraboloids, elliptic pipes and hyperboloids.

Each ends at a plane across its axis; the last two go on along it, and may end anywhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import hypot
from typing import ClassVar, Literal

from flint import fmpq

from pas.algebra.rational import Exact, Vector, VectorLike, listed, plain, positive, to_float
from pas.contacts.axial import Axial, longest, perpendicular, vectors
from pas.contacts.contact import Contact
from pas.contacts.endless import Endless


@dataclass(frozen=True, repr=False)
class Sphere(Axial):
    """A sphere around `point`, cut off by a plane across `axis`.

    The plane passes through `point + clip * axis`; the axis points away from the blend, whose side of the plane is that
    of -axis.  So with a negative clip most of the ball stays and a cap makes room for the blend, with a positive one a
    cap stays.  All numbers are exact.  With `w = x - point` its polynomial is `|w|^2 - radius^2`.

    Raises `ValueError` for a zero axis or a radius that is not positive, `GeometryError` where the plane misses the
    sphere.
    """

    table: ClassVar[str] = "spheres"

    axis: Vector
    radius: fmpq
    clip: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(self, axis: VectorLike, radius: Exact, clip: Exact, point: VectorLike = (0, 0, 0)) -> None:
        self.settle(axis, point, radius=radius, clip=clip)
        positive(self.radius, "radius")
        self.check_rim()

    @cached_property
    def contact(self) -> Contact:
        return self.ended(self.square - self.radius**2, turned=False)

    def __str__(self) -> str:
        return (
            f"sphere of radius {plain(self.radius)} around ({listed(self.point)}), "
            f"{self.ending} along ({listed(self.axis)})"
        )


@dataclass(frozen=True, repr=False)
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
        object.__setattr__(self, "semiaxes", perpendicular(semiaxes, 3))
        self.check_rim()

    @cached_property
    def contact(self) -> Contact:
        return self.ended(self.squares(self.semiaxes) - 1, turned=False)

    def __str__(self) -> str:
        semiaxes = ", ".join(f"({listed(a)})" for a in self.semiaxes)
        return (
            f"ellipsoid with semi-axes {semiaxes} around ({listed(self.point)}), "
            f"{self.ending} along ({listed(self.axis)})"
        )


@dataclass(frozen=True, repr=False)
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
        self.settle(axis, point, semiaxes, clip=clip)
        if self.clip == 0:
            raise ValueError("clip must not be 0, where a paraboloid has its vertex")

    @cached_property
    def contact(self) -> Contact:
        return self.ended(self.squares(self.semiaxes) - self.along * (1 / self.clip))

    def __str__(self) -> str:
        return f"paraboloid {self.position} with semi-axes {vectors(self.semiaxes)}, {self.ending}"


@dataclass(frozen=True, repr=False)
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
        self.settle(axis, point, semiaxes, clip=clip)

    @cached_property
    def contact(self) -> Contact:
        return self.ended(self.squares(self.semiaxes) - 1)

    def width(self, clip: float) -> float:
        return longest(self.semiaxes)

    def __str__(self) -> str:
        return f"elliptic pipe {self.position} with semi-axes {vectors(self.semiaxes)}, {self.ending}"


@dataclass(frozen=True, repr=False)
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
        self.settle(axis, point, semiaxes, clip=clip, conjugate=conjugate)
        positive(self.conjugate, "conjugate")

    @cached_property
    def contact(self) -> Contact:
        return self.ended(self.squares(self.semiaxes) - (self.along * (1 / self.conjugate)) ** 2 - 1)

    def width(self, clip: float) -> float:
        return longest(self.semiaxes) * hypot(1, clip / to_float(self.conjugate))

    def __str__(self) -> str:
        curves = f"semi-axes {vectors(self.semiaxes)}, conjugate semi-axis {plain(self.conjugate)}"
        return f"hyperboloid {self.position} with {curves}, {self.ending}"
