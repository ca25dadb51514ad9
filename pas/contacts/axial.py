"""The base of contacts with an axis: exact coordinates along it and across, and a plane that ends them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any, Literal

from flint import fmpq, fmpq_mpoly

from pas.algebra.affine import away, height
from pas.algebra.inputs import set_fields, shown
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Exact, Vector, VectorLike, dot, listed, plain, rational, to_float, vector
from pas.contacts.contact import Contact, Movable

ZERO = GENERATORS[0] * 0


class Axial(Movable):
    """A contact around an axis that ends at the plane across it through `point + clip * axis`.

    With `w = x - point`, `along` is `u = w . axis / |axis|^2` and the plane is where u is `clip`.  To be inherited by
    frozen dataclasses.
    """

    axis: Vector
    clip: fmpq | Literal["auto"]
    point: Vector

    def settle(
        self, axis: VectorLike, point: VectorLike, semiaxes: Sequence[VectorLike] | None = None, **numbers: Exact
    ) -> None:
        """Make what was given exact, and check it; raises `ValueError` for a zero axis, and for semi-axes, if there are
        some, that are not two across the axis and one another."""
        exact = {name: rational(value, name) for name, value in numbers.items()}
        set_fields(self, axis=vector(axis, "axis"), point=vector(point, "point"), **exact)
        if all(a == 0 for a in self.axis):
            raise ValueError("axis must not be the zero vector")
        if semiaxes is not None:
            object.__setattr__(self, "semiaxes", perpendicular(semiaxes, 2, to=self.axis))

    @property
    def end(self) -> fmpq:
        """The clip as a number."""
        return rational(self.clip, "clip")

    @property
    def ending(self) -> str:
        """Where it ends, in words."""
        return f"clipped at {plain(self.end)}"

    @property
    def position(self) -> str:
        """Its axis and point, in words."""
        return f"along ({listed(self.axis)}) through ({listed(self.point)})"

    @property
    def along(self) -> fmpq_mpoly:
        """The coordinate along the axis, 0 at the point and 1 at the tip of the axis."""
        return self.part(self.axis)

    @property
    def square(self) -> fmpq_mpoly:
        """The square of the distance from the point."""
        w = away(self.point)
        return dot(w, w)

    def part(self, direction: Vector) -> fmpq_mpoly:
        """The coordinate along any vector, 0 at the point and 1 at the vector's tip."""
        return height(self.point, direction) * (1 / dot(direction, direction))

    def squares(self, semiaxes: Sequence[Vector]) -> fmpq_mpoly:
        """The sum of the squared coordinates along some vectors."""
        return sum((self.part(a) ** 2 for a in semiaxes), ZERO)

    def ended(self, surface: fmpq_mpoly, turned: bool = True) -> Contact:
        """The contact of a surface with the clip plane; `turned` to the point where `clip` is negative."""
        scale = -self.clip_scale if turned and self.end < 0 else self.clip_scale
        return Contact(Polynomial.from_raw(surface), Polynomial.from_raw((self.along - self.end) * scale))

    @property
    def clip_scale(self) -> fmpq:
        """The factor of the clip polynomial, relative to (u - clip)."""
        return fmpq(1)


def perpendicular(semiaxes: Any, number: int, to: Vector | None = None) -> tuple[Vector, ...]:
    """So many exact semi-axes, across one another and across the vector `to`; none of them zero.

    Raises `ValueError` or `TypeError` for others.
    """
    if isinstance(semiaxes, str) or not isinstance(semiaxes, Sequence) or len(semiaxes) != number:
        raise ValueError(f"semiaxes must be {number} vectors across one another, not {shown(semiaxes)}")
    found = tuple(vector(v, f"semiaxes[{i}]") for i, v in enumerate(semiaxes))
    for i, v in enumerate(found):
        if all(c == 0 for c in v):
            raise ValueError(f"semiaxes[{i}] must not be the zero vector")
        if to is not None and dot(v, to) != 0:
            raise ValueError(f"semiaxes[{i}] must be perpendicular to ({listed(to)}), and ({listed(v)}) is not")
    for (i, a), (j, b) in combinations(enumerate(found), 2):
        if dot(a, b) != 0:
            raise ValueError(f"semiaxes must be perpendicular to one another, and number {i + 1} and {j + 1} are not")
    return found


def longest(values: Sequence[Vector]) -> float:
    """The largest length."""
    return max(to_float(dot(v, v)) for v in values) ** 0.5


def vectors(values: Sequence[Vector]) -> str:
    """Vectors as a sentence has them."""
    return " and ".join(f"({listed(v)})" for v in values)
