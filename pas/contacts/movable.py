"""What all kinds of contacts can do: be moved exactly, and say along which closed curve they meet a blend."""

from __future__ import annotations

from dataclasses import fields
from functools import cached_property
from typing import Any, Protocol, Self

from pas.algebra.affine import Affine, rotation, translation
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, Vector, VectorLike
from pas.contacts.rims import Rim, rim_of

POINTS = ("point", "near")
"""Fields that are points of space; other triples of numbers are vectors."""


class Pair(Protocol):
    """A contact by its polynomials."""

    @property
    def surface(self) -> Polynomial:
        """The surface, negative inside."""

    @property
    def clip(self) -> Polynomial:
        """The clip, negative on the blend's side."""

    @property
    def near(self) -> Vector | None:
        """A point next to the closed curve that is meant, where there are several."""


class Movable:
    """A kind of contact; to be inherited by frozen dataclasses whose fields are the arguments of their constructor.

    A field is moved as what it is: polynomials by their zero sets, the fields `point` and `near` as points, other
    triples of numbers and tuples of them as vectors; numbers stay.
    """

    @property
    def contact(self) -> Pair:
        """The surface and its clip as polynomials."""
        raise NotImplementedError(f"{type(self).__name__} does not say which contact it stands for")

    @cached_property
    def rim(self) -> Rim:
        """The closed plane curve along which the blend is met; `GeometryError` says why where there is none."""
        return rim_of(self.contact.surface, self.contact.clip, self.contact.near)

    def check_rim(self) -> None:
        """Raise `GeometryError` where there is no closed plane curve."""
        _ = self.rim

    def translate(self, offset: VectorLike) -> Self:
        """The contact moved by three numbers."""
        return self._moved(translation(offset))

    def rotate(self, axis: VectorLike, degrees: Exact, center: VectorLike = (0, 0, 0)) -> Self:
        """The contact turned about an axis through `center`, counterclockwise seen from the axis' tip.

        Exact rotations by rational matrices, as those of solids: the angle is `degrees` up to rounding, and exact for
        multiples of 90 about an axis of rational length.
        """
        return self._moved(rotation(axis, degrees, center))

    def _moved(self, map_: Affine) -> Self:
        arguments = {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]
        points = {name: map_.exact(arguments[name]) for name in POINTS if arguments.get(name) is not None}
        return type(self)(**{name: _image(value, map_) for name, value in arguments.items()} | points)


def _image(value: Any, map_: Affine) -> Any:
    if isinstance(value, Polynomial):
        return map_.polynomial(value)
    if isinstance(value, tuple):
        inner = isinstance(value[0], tuple)
        return tuple(_image(v, map_) for v in value) if inner else map_.direction(value)
    return value
