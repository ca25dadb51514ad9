"""A local frame: the exact change of coordinates in which the program computes.

`x = origin + scale * u` with a rational origin and a power of two as scale, so that the region
is of size about 1 around 0.  Exact results do not depend on it; floating-point work does: a
corner a kilometre from the origin would lose its digits in powers of large coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import fmpq

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, binary_exponent, dot, to_float, to_floats


@dataclass(frozen=True)
class Frame:
    """`x = origin + scale * u`, exact."""

    origin: Vector
    scale: fmpq

    @classmethod
    def around(cls, origin: Vector, points: Sequence[Vector]) -> Frame:
        """The frame at `origin` in which the furthest of `points` is at a distance of 1 to 2."""
        offsets = (tuple(a - b for a, b in zip(p, origin, strict=True)) for p in points)
        return cls(origin, fmpq(2) ** (binary_exponent(max(dot(d, d) for d in offsets)) // 2))

    def localise(self, polynomial: Polynomial) -> Polynomial:
        """The same function in local coordinates, exact."""
        return polynomial.compose(
            *(Polynomial.from_raw(self.scale * g + o) for g, o in zip(GENERATORS, self.origin, strict=True))
        )

    def globalise(self, polynomial: Polynomial) -> Polynomial:
        """The same function in the user's coordinates, exact."""
        inverse = 1 / self.scale
        return polynomial.compose(
            *(Polynomial.from_raw(inverse * (g - o)) for g, o in zip(GENERATORS, self.origin, strict=True))
        )

    def local_point(self, point: Sequence[fmpq]) -> Vector:
        """Local coordinates of a point, exact."""
        x, y, z = ((a - o) / self.scale for a, o in zip(point, self.origin, strict=True))
        return x, y, z

    def local_points(self, points: Floats) -> Floats:
        """Local coordinates of points (..., 3)."""
        return (np.asarray(points, dtype=float) - to_floats(self.origin)) / to_float(self.scale)

    def global_points(self, points: Floats) -> Floats:
        """The user's coordinates of local points (..., 3)."""
        return np.asarray(points, dtype=float) * to_float(self.scale) + to_floats(self.origin)
