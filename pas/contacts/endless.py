"""Contacts on surfaces that go on along an axis, which may end anywhere on it, also where the program finds room.

Pipes and cones are the circular ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Literal, Self

from flint import fmpq

from pas.algebra.inputs import shown
from pas.algebra.rational import Exact, Vector, VectorLike, dot, listed, plain, positive, rational, to_float
from pas.contacts.axial import Axial
from pas.contacts.contact import Contact
from pas.errors import GeometryError

AUTO: Literal["auto"] = "auto"
"""The clip of a contact that ends where there is room; see `pas.layouts.clips`."""


class Endless(Axial):
    """A contact whose surface goes on along the axis, so that its clip may be moved: a number, or "auto".

    With "auto" it has no end and stands for no contact yet: `contact` and `rim` raise `GeometryError`.  `clipped` gives
    the same surface with an end.  To be inherited by frozen dataclasses.
    """

    def settle(
        self, axis: VectorLike, point: VectorLike, semiaxes: Sequence[VectorLike] | None = None, **numbers: Exact
    ) -> None:
        """Make what was given exact, and check it; raises `ValueError` for a zero axis and a clip that is no number
        and not "auto"."""
        clip = numbers.pop("clip")
        super().settle(axis, point, semiaxes, **numbers)
        if isinstance(clip, str) and clip.strip().isalpha() and clip != AUTO:
            raise ValueError(f'clip must be an exact number or "auto", not {shown(clip)}')
        object.__setattr__(self, "clip", AUTO if isinstance(clip, str) and clip == AUTO else rational(clip, "clip"))

    @property
    def ends(self) -> bool:
        """Whether it has an end."""
        return self.clip != AUTO

    @property
    def end(self) -> fmpq:
        """The clip as a number; raises `GeometryError` where it is "auto"."""
        if isinstance(self.clip, str):
            raise GeometryError(
                f'the clip of the {type(self).__name__} along ({listed(self.axis)}) is "auto", so it has no end before '
                "pas.blend or pas.solutions places it among other contacts; clipped(number) gives it one"
            )
        return self.clip

    @property
    def ending(self) -> str:
        return super().ending if self.ends else "clipped where there is room"

    def clipped(self, clip: Exact) -> Self:
        """The contact ended at `point + clip * axis`."""
        return replace(self, **self._changes(rational(clip, "clip")))  # type: ignore[type-var]  # all are dataclasses

    def width(self, clip: float) -> float:
        """The largest distance of its section at a clip from the axis; not positive where there is none."""
        raise NotImplementedError(f"{type(self).__name__} does not say how wide it is")

    def _changes(self, clip: fmpq) -> dict[str, Any]:
        """The changed fields for another clip."""
        return {"clip": clip}


class Circular(Endless):
    """Where `|w|^2 - u^2 |axis|^2 - (radius + slope (u - clip))^2` is zero, `w = x - point`, `u = w . axis / |axis|^2`.

    It ends where u is `clip`, the blend on the side of `point`.  To be inherited by frozen dataclasses.
    """

    radius: fmpq
    slope: fmpq = fmpq(0)

    def settle(
        self, axis: VectorLike, point: VectorLike, semiaxes: Sequence[VectorLike] | None = None, **numbers: Exact
    ) -> None:
        """Make what was given exact, and check it; raises `ValueError` for a zero axis or a radius not positive."""
        super().settle(axis, point, semiaxes, **numbers)
        positive(self.radius, "radius")

    @cached_property
    def contact(self) -> Contact:
        radius = (self.along - self.end) * self.slope + self.radius
        return self.ended(self.square - self.along**2 * dot(self.axis, self.axis) - radius * radius)

    def width(self, clip: float) -> float:
        return to_float(self.radius) + to_float(self.slope) * (clip - to_float(self._known_at))

    @property
    def _known_at(self) -> fmpq:
        """The clip to which `radius` belongs: that of the point without one."""
        return self.end if self.ends else fmpq(0)

    def _changes(self, clip: fmpq) -> dict[str, Any]:
        return {"clip": clip, "radius": self.radius + self.slope * (clip - self._known_at)}


@dataclass(frozen=True)
class Pipe(Circular):
    """An infinite circular cylinder, cut off by a plane normal to its axis.

    `axis` is its direction (any nonzero rational vector, of any length), `radius` its radius, `point` a point on its
    axis.  The clip plane passes through `point + clip * axis`; the blend's side of it is the one with `point` (the side
    in the direction of -axis where `clip` is 0).  With the clip "auto" `pas.blend` ends it where there is room among
    the other contacts.  All numbers are exact (see `pas.Polynomial`).  Its polynomials are rational, since nothing is
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
        return dot(self.axis, self.axis)  # `w . axis - clip |axis|^2` is what project files have

    def __str__(self) -> str:
        return f"pipe of radius {plain(self.radius)} {self.position}, {self.ending}"


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
        where = "where" if self.ends else "and at that point"
        return (
            f"cone {self.position}, {self.ending} {where} its radius is {plain(self.radius)}, "
            f"with slope {plain(self.slope)}"
        )
