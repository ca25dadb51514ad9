"""Contacts on surfaces that go on along an axis: they may end anywhere on it, also where the program finds room."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Any, Literal, Self

from flint import fmpq

from pas.algebra.inputs import shown
from pas.algebra.rational import Exact, VectorLike, dot, rational, to_float
from pas.contacts.axial import Axial, listed, positive
from pas.contacts.contact import Contact
from pas.errors import GeometryError

AUTO: Literal["auto"] = "auto"
"""The clip of a contact that ends where there is room; see `pas.layouts.clips`."""


class Endless(Axial):
    """A contact whose surface goes on along the axis, so that its clip may be moved: a number, or "auto".

    With "auto" it has no end and stands for no contact yet: `contact` and `rim` raise `GeometryError`.  `clipped` gives
    the same surface with an end.  To be inherited by frozen dataclasses.
    """

    def settle(self, axis: VectorLike, point: VectorLike, **numbers: Exact) -> None:
        """Make what was given exact, and check it; raises `ValueError` for a zero axis and a clip that is no number
        and not "auto"."""
        clip = numbers.pop("clip")
        super().settle(axis, point, **numbers)
        object.__setattr__(self, "clip", AUTO if _is_auto(clip) else rational(clip, "clip"))

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
        """Where it ends, in words."""
        return super().ending if self.ends else "clipped where there is room"

    def clipped(self, clip: Exact) -> Self:
        """The contact ended at `point + clip * axis`."""
        return replace(self, **self._changes(rational(clip, "clip")))  # type: ignore[type-var]  # all are dataclasses

    def width(self, clip: float) -> float:
        """The largest distance of its section at a clip from the axis; not positive where there is none."""
        raise NotImplementedError(f"{type(self).__name__} does not say how wide it is")

    def _changes(self, clip: fmpq) -> dict[str, Any]:
        """The fields that are others for another clip."""
        return {"clip": clip}


def _is_auto(clip: Any) -> bool:
    if isinstance(clip, str) and clip.strip().isalpha() and clip != AUTO:
        raise ValueError(f'clip must be an exact number or "auto", not {shown(clip)}')
    return isinstance(clip, str) and clip == AUTO


class Circular(Endless):
    """Where `|w|^2 - u^2 |axis|^2 - (radius + slope (u - clip))^2` is zero, `w = x - point`, `u = w . axis / |axis|^2`.

    It ends where u is `clip`, the blend on the side of `point`.  To be inherited by frozen dataclasses.
    """

    radius: fmpq
    slope: fmpq = fmpq(0)

    def settle(self, axis: VectorLike, point: VectorLike, **numbers: Exact) -> None:
        """Make what was given exact, and check it; raises `ValueError` for a zero axis or a radius not positive."""
        super().settle(axis, point, **numbers)
        positive(self.radius, "radius")

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip plane as polynomials."""
        radius = (self.along - self.end) * self.slope + self.radius
        return self.ended(self.square - self.along**2 * dot(self.axis, self.axis) - radius * radius)

    def width(self, clip: float) -> float:
        """The radius of the circle at a clip."""
        return to_float(self.radius) + to_float(self.slope) * (clip - to_float(self._known_at))

    @property
    def _known_at(self) -> fmpq:
        """The clip to which `radius` belongs: that of the point without one."""
        return self.end if self.ends else fmpq(0)

    def _changes(self, clip: fmpq) -> dict[str, Any]:
        return {"clip": clip, "radius": self.radius + self.slope * (clip - self._known_at)}
