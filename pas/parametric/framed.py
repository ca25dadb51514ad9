"""Finite rectangles of parameters, and surfaces in a frame of their own: over the unit square, and about as large as 1.

Bounds and meshes are made there, so that they do not depend on the units of space or parameters: squares of distances
neither vanish nor overflow, and the parameters of halved rectangles are exact.  Space is scaled by a power of two,
which rounds nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.jets import Jet
from pas.algebra.monomials import Floats
from pas.algebra.rational import rational, to_float
from pas.errors import GeometryError
from pas.parametric.domain import Domain, DomainLike, Interval
from pas.parametric.maps import ParametricMap

Rectangle = tuple[tuple[fmpq, fmpq], tuple[fmpq, fmpq]]


def exact_rectangle(surface: ParametricMap, domain: DomainLike = None) -> Rectangle:
    """The finite rectangle to mesh, exact as its ends are given: `domain`, completed by the surface's own.

    An interval None, or an end None, is that of the surface.  Raises `ValueError` naming a parameter that has no
    finite interval or one outside the surface's domain.
    """
    given, result = surface.with_domain(domain), []
    for axis, name in enumerate(surface.parameters):
        own = surface.domain[axis]
        low, high = (e if math.isfinite(e) else o for e, o in zip(given.domain[axis], own, strict=True))
        if not math.isfinite(high - low):
            sides = ["(-1, 1)" if not np.isfinite(side).all() else "None" for side in surface.domain]
            raise ValueError(
                f"the domain of {name} is infinite ({low:g} to {high:g}); "
                f"give a finite one, such as domain=({', '.join(sides)})"
            )
        if not own[0] <= low < high <= own[1]:
            raise ValueError(
                f"the interval [{low:g}, {high:g}] of {name} is not within the surface's domain "
                f"[{own[0]:g}, {own[1]:g}]"
            )
        lows, highs = zip(surface.ends[axis], given.ends[axis], strict=True)
        ends = max(rational(e) for e in lows if e is not None), min(rational(e) for e in highs if e is not None)
        result.append(ends)  # a double given for an end may lie outside by its rounding
    return result[0], result[1]


def finite_domain(surface: ParametricMap, domain: DomainLike = None) -> Domain:
    """The finite rectangle to mesh in doubles; raises as `exact_rectangle` does."""
    first, second = ((to_float(low), to_float(high)) for low, high in exact_rectangle(surface, domain))
    return first, second


@dataclass(frozen=True)
class Framed:
    """`surface` is P(low + (high - low) u, ...) / 2^exponent over [0, 1]^2, with `bounded` P and its finite domain."""

    bounded: ParametricMap
    surface: ParametricMap
    exponent: int
    size: float

    @classmethod
    def of(cls, bounded: ParametricMap) -> Framed:
        """Of a surface with a finite domain; raises as `extent` does."""
        size = extent(bounded)
        exponent = math.frexp(size)[1] - 1
        first, second = bounded.domain

        def values(u: Any, v: Any) -> tuple[Any, ...]:
            parts = bounded.values(_moved(u, first), _moved(v, second))
            return tuple(_scaled(part, -exponent) for part in parts)

        made = ParametricMap.from_parts(values, None, bounded.parameters, ((0, 1), (0, 1)), "it is framed")
        return cls(bounded, made, exponent, math.ldexp(size, -exponent))

    @property
    def unit(self) -> fmpq:
        """2^exponent."""
        return fmpq(2) ** self.exponent if self.exponent >= 0 else 1 / fmpq(2) ** -self.exponent

    def inside(self, length: float) -> float:
        """A length of the model's in this frame; at most 1e300."""
        return min(_ldexp(length, -self.exponent), 1e300)

    def outside(self, length: float) -> float:
        """A bound of this frame in the model's lengths, rounded upwards, points being rounded to doubles."""
        return math.nextafter(_ldexp(length, self.exponent), math.inf) + 2 * math.ulp(0.0)

    def points_outside(self, points: Floats) -> Floats:
        """Points of this frame in space."""
        return np.asarray(np.ldexp(points, self.exponent))

    def exact_parameters(self, shares: Sequence[fmpq]) -> list[fmpq]:
        """Exact parameters of the surface from those of the unit square; the domain must be finite."""
        found = []
        for share, (low, high) in zip(shares, self.bounded.ends, strict=True):
            assert low is not None and high is not None
            found.append(rational(low) + rational(high - low) * share)
        return found

    def parameters_outside(self, shares: Floats) -> Floats:
        """Parameters (..., 2) of the surface from those of the unit square."""
        parts = [_moved(shares[..., axis], interval) for axis, interval in enumerate(self.bounded.domain)]
        return np.stack(parts, axis=-1)


def extent(surface: ParametricMap) -> float:
    """The longest side of the box around a few points of a surface on a finite domain.

    Raises `GeometryError` where that is zero or infinite.
    """
    t, h = (_moved(np.linspace(0.0, 1.0, 17), interval) for interval in surface.domain)
    points = surface.on_grid(t, h).reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    with np.errstate(over="ignore"):
        size = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    if not 0 < size < math.inf:
        raise GeometryError("the surface is a single point, or has no finite points, on this domain")
    return size


def _moved(u: Any, interval: Interval) -> Any:
    """low + (high - low) u, at arrays or series, such that ends go to ends and nothing outside."""
    low, high = interval
    width = high - low
    share = u.value if isinstance(u, Jet) else np.asarray(u, dtype=float)
    place = np.clip(np.where(share <= 0.5, low + width * share, high - width * (1.0 - share)), low, high)
    if not isinstance(u, Jet):
        return place
    coefficients = u.coefficients * width
    coefficients[0, 0] = place
    return Jet(coefficients)


def _scaled(part: Any, exponent: int) -> Any:
    return Jet(np.ldexp(part.coefficients, exponent)) if isinstance(part, Jet) else np.ldexp(part, exponent)


def _ldexp(number: float, exponent: int) -> float:
    return float(np.ldexp(number, exponent))
