"""What the user asks of the shape: points and a normalisation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from flint import fmpq

from pas.algebra.rational import Vector, plain, rational, vector

Points = tuple[Vector, ...]

DEFAULT_MARGIN = 1e-4
"""How far `inside` and `outside` points are kept from the surface, over the radius of the region:
far enough for rounding not to move them across, and for solvers to see a contradiction."""

KINDS = ("inside", "outside", "through")


@dataclass(frozen=True)
class MeanAlpha:
    """The mean of alpha over all contact curves is 1, each contact being scaled to unit mean
    gradient on its curve: so f is near the distance from the contacts, and not a multiple."""


@dataclass(frozen=True)
class SumOfCoefficients:
    """The coefficients in the basis of the solution space add up to 1 (depends on the basis)."""


@dataclass(frozen=True)
class ValueAt:
    """The surface's function has the given value at a point (three exact numbers)."""

    point: Vector
    value: fmpq = fmpq(-1)

    def __init__(self, point: Any, value: Any = -1) -> None:
        object.__setattr__(self, "point", vector(point, "point"))
        object.__setattr__(self, "value", rational(value, "value"))
        if self.value == 0:
            raise ValueError("value must not be 0, or the zero function would be an answer")


Normalization = MeanAlpha | SumOfCoefficients | ValueAt


@dataclass(frozen=True)
class Constraints:
    """Points that shape the surface, exact, in the user's coordinates.

    `inside`: f(p) <= -margin; `outside`: f(p) >= margin (by default `DEFAULT_MARGIN` times the
    region's radius); `through`: f(p) = 0, exactly; `near`:
    `near_weight * sum f(p)^2` is added to the energy.
    """

    inside: Points = ()
    outside: Points = ()
    through: Points = ()
    near: Points = ()
    near_weight: fmpq = fmpq(100)
    margin: fmpq | None = None
    normalize: Normalization = field(default_factory=MeanAlpha)

    @classmethod
    def of(
        cls,
        *,
        inside: Any = (),
        outside: Any = (),
        through: Any = (),
        near: Any = (),
        near_weight: Any = 100,
        margin: Any = None,
        normalize: Normalization | None = None,
    ) -> Constraints:
        """The constraints from whatever the user writes: sequences of points of three numbers."""
        weight = rational(near_weight, "near_weight")
        distance = None if margin is None else rational(margin, "margin")
        if weight < 0 or (distance is not None and distance < 0):
            raise ValueError("near_weight and margin must not be negative")
        if normalize is None:
            normalize = MeanAlpha()
        if not isinstance(normalize, MeanAlpha | SumOfCoefficients | ValueAt):
            raise TypeError(
                f"normalize must be pas.MeanAlpha(), pas.SumOfCoefficients() or pas.ValueAt(...), not {normalize!r}"
            )
        return cls(
            _points(inside, "inside"),
            _points(outside, "outside"),
            _points(through, "through"),
            _points(near, "near"),
            weight,
            distance,
            normalize,
        )

    def hard(self) -> Iterator[tuple[str, int]]:
        """The points that must hold, as (kind, index)."""
        for kind in KINDS:
            for index in range(len(getattr(self, kind))):
                yield kind, index

    def without(self, dropped: Sequence[tuple[str, int]]) -> Constraints:
        """The same constraints less some points."""

        def kept(kind: str) -> Points:
            return tuple(p for i, p in enumerate(getattr(self, kind)) if (kind, i) not in dropped)

        return replace(self, inside=kept("inside"), outside=kept("outside"), through=kept("through"))

    def describe(self, item: tuple[str, int]) -> str:
        """A constraint in words: 'inside (1/2, 0, 0)'."""
        kind, index = item
        return f"{kind} ({', '.join(plain(c) for c in getattr(self, kind)[index])})"


def _points(value: Any, name: str) -> Points:
    if isinstance(value, str) or not hasattr(value, "__len__"):
        raise TypeError(f"{name} must be a sequence of points, each three numbers, not {value!r}")
    if len(value) == 3 and not any(hasattr(entry, "__len__") and not isinstance(entry, str) for entry in value):
        return (vector(value, name),)
    return tuple(vector(point, f"{name}[{i}]") for i, point in enumerate(value))
