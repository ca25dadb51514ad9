"""What the user asks of the shape: points and a normalisation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from flint import fmpq

from pas.algebra.rational import Vector, plain, rational, vector

Points = tuple[Vector, ...]

DEFAULT_MARGIN = 1e-4
"""How far `inside` and `outside` points are kept from the surface, over the radius of the region:
far enough for rounding not to move them across, and for solvers to see a contradiction."""

KINDS = ("inside", "outside", "through", "handles")
"""Constraints that must hold; `near` is least squares."""

Handle = tuple[int, tuple[int, int, int, int]]
"""A B-coefficient: the number of a cell (tetrahedron) and a multi-index of its corners."""


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


@dataclass(frozen=True)
class UnitCoefficients:
    """The coefficients of the polynomials have Euclidean length 1 (over all monomials and pieces).

    With points to be `near` and no energy this is the least-squares fit with the normalised
    distance `sum w f(p)^2 / |f|^2`, a generalised Rayleigh quotient (Lou, Feng, Chen and Deng 2001).
    """


Normalization = MeanAlpha | SumOfCoefficients | ValueAt | UnitCoefficients


@dataclass(frozen=True)
class Constraints:
    """What shapes the surface, exact, in the user's coordinates.

    `inside`: f(p) <= -margin; `outside`: f(p) >= margin (by default `DEFAULT_MARGIN` times the
    region's radius); `through`: f(p) = 0, exactly; `near`: `sum w_i f(p_i)^2` is added to the
    energy, with the weights `near_weights`; `handles`: B-coefficients with given values, exactly.
    """

    inside: Points = ()
    outside: Points = ()
    through: Points = ()
    near: Points = ()
    near_weights: tuple[fmpq, ...] = ()
    handles: tuple[tuple[Handle, fmpq], ...] = ()
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
        handles: Any = (),
        margin: Any = None,
        normalize: Normalization | None = None,
    ) -> Constraints:
        """The constraints from whatever the user writes.

        Points are sequences of three numbers, `near_weight` a number for all points or one for
        each, `handles` a mapping from (cell, multi-index) to values.
        """
        distance = None if margin is None else rational(margin, "margin")
        if distance is not None and distance < 0:
            raise ValueError("margin must not be negative")
        if normalize is None:
            normalize = MeanAlpha()
        if not isinstance(normalize, Normalization):
            raise TypeError(
                "normalize must be pas.MeanAlpha(), pas.SumOfCoefficients(), pas.UnitCoefficients() or "
                f"pas.ValueAt(...), not {normalize!r}"
            )
        points = _points(near, "near")
        return cls(
            _points(inside, "inside"),
            _points(outside, "outside"),
            _points(through, "through"),
            points,
            _weights(near_weight, len(points)),
            _handles(handles),
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

        def kept(kind: str) -> Any:
            return tuple(p for i, p in enumerate(getattr(self, kind)) if (kind, i) not in dropped)

        return replace(self, **{kind: kept(kind) for kind in KINDS})

    def describe(self, item: tuple[str, int]) -> str:
        """A constraint in words: 'inside (1/2, 0, 0)', 'handle 0, (3, 0, 0, 0) = 1'."""
        kind, index = item
        if kind == "handles":
            (cell, corners), value = self.handles[index]
            return f"handle {cell}, {corners} = {plain(value)}"
        return f"{kind} ({', '.join(plain(c) for c in getattr(self, kind)[index])})"


def _points(value: Any, name: str) -> Points:
    if isinstance(value, str) or not hasattr(value, "__len__"):
        raise TypeError(f"{name} must be a sequence of points, each three numbers, not {value!r}")
    if len(value) == 3 and not any(hasattr(entry, "__len__") and not isinstance(entry, str) for entry in value):
        return (vector(value, name),)
    return tuple(vector(point, f"{name}[{i}]") for i, point in enumerate(value))


def _weights(value: Any, count: int) -> tuple[fmpq, ...]:
    if hasattr(value, "__len__") and not isinstance(value, str):
        if len(value) != count:
            raise ValueError(f"near_weight must be one number, or one for each of the {count} near points")
        weights = tuple(rational(w, f"near_weight[{i}]") for i, w in enumerate(value))
    else:
        weights = (rational(value, "near_weight"),) * max(count, 1)
    if any(w < 0 for w in weights):
        raise ValueError("near_weight must not be negative")
    return weights[:count]


def _handles(value: Any) -> tuple[tuple[Handle, fmpq], ...]:
    items = value.items() if isinstance(value, Mapping) else value
    result = []
    for item in items:
        try:
            (cell, (i, j, k, m)), number = item
            handle = (int(cell), (int(i), int(j), int(k), int(m)))
        except (TypeError, ValueError):
            raise ValueError(
                f"handles must map (cell, multi-index of four numbers) to values, as in {{(0, (3, 0, 0, 0)): 1}}, "
                f"not {item!r}"
            ) from None
        result.append((handle, rational(number, f"handles[{handle}]")))
    return tuple(result)
