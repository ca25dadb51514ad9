"""Where vertices leave the triangles about them least slender.

Each vertex tries places in its tangent plane: where triangles on the edges opposite to it would be equilateral, in the
mean and with most weight on the worst, the mean of its triangles' centres, and places about the best of these (after
Freitag and Ollivier-Gooch 1997).  The one is taken that leaves the least of what is too slender, and no triangle more
slender than it may be; whether it can be taken on the surface is not looked at here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pas.mesh.field import Floats, Integers
from pas.mesh.kernels import compiled
from pas.mesh.rows import any_of, cross, dots

STEPS = (1.0, 0.5)
"""Shares of the ways that are tried."""

TURNS = ((1.0, 0.0), (0.7, 0.7), (0.0, 1.0), (-0.7, 0.7), (-1.0, 0.0), (-0.7, -0.7), (0.0, -1.0), (0.7, -0.7))
AROUND = 0.15
"""Ways about the best of those places that are tried as well, and how long they are, over the edges opposite."""

HEIGHT = 0.8660254037844386
"""Of an equilateral triangle, over its sides."""

SHARPEST = 0.05
"""Sine below which triangles do not weigh more."""


@dataclass(frozen=True)
class Stars:
    """The triangles about some `vertices` (V,), vertex by vertex: where each one's start (V,), their `rows` (K,), and
    the ends of the edges opposite, `first` and `second` (K,)."""

    vertices: Integers
    starts: Integers
    rows: Integers
    first: Integers
    second: Integers

    @classmethod
    def of(cls, triangles: Integers, rows: Integers, chosen: NDArray[np.bool_]) -> Stars:
        """Those of triangles (T, 3) about chosen vertices (N,), of which each has some, all among given rows."""
        corners = triangles[rows].ravel()
        at = np.flatnonzero(chosen[corners])
        at = at[np.argsort(corners[at], kind="stable")]
        found = corners[at]
        starts = np.flatnonzero(np.concatenate([[True], found[1:] != found[:-1]])) if len(at) else at
        rows, corner = rows[at // 3], at % 3
        return cls(found[starts], starts, rows, *(triangles[rows, (corner + i) % 3] for i in (1, 2)))

    @property
    def owner(self) -> Integers:
        """Which of the vertices each triangle is about (K,)."""
        return np.repeat(np.arange(len(self.vertices)), np.diff(self.starts, append=len(self.rows)))

    def least(self, values: Floats) -> Floats:
        """The least (V,) of values (K,) about each vertex."""
        return np.minimum.reduceat(values, self.starts) if len(values) else values


@dataclass(frozen=True)
class Asked:
    """What the sines of triangles should be: each is too slender by the square of what its own is below the `aim`,
    times its weight (K,), and must not be below its own of `floors` (K,), which are not negative."""

    aim: float
    weights: Floats
    floors: Floats


def at_vertices(triangles: Integers, chosen: NDArray[np.bool_]) -> Integers:
    """The rows of the triangles (T, 3) at chosen vertices (N,)."""
    return np.flatnonzero(any_of(chosen[triangles]))


def sines(a: Floats, b: Floats, c: Floats) -> tuple[Floats, Floats]:
    """The sine of the smallest angle of triangles with corners (T, 3), and vectors (T, 3) across them, outwards."""
    u, v, w = b - a, c - a, c - b
    across = cross(u, v)
    x, y, z = dots(u, u), dots(v, v), dots(w, w)
    longest = np.maximum(np.maximum(x * y, y * z), z * x)
    return np.sqrt(dots(across, across) / np.maximum(longest, 1e-300)), across


def all_sines(points: Floats, triangles: Integers) -> Floats:
    """The sine of the smallest angle of each triangle (T,)."""
    return compiled().sines(points, triangles)


def better_places(
    stars: Stars, points: Floats, normals: Floats, before: Floats, asked: Asked
) -> tuple[Floats, Floats, Floats]:
    """The best places (V, 3) for vertices, and how much too slender their triangles are (V,), where they are and there.

    Of points (N, 3) with unit normals (N, 3); `before` (K,) are the sines of the triangles' smallest angles.
    """
    tables, ways = (stars.vertices, stars.starts, stars.first, stars.second), (np.array(STEPS), np.array(TURNS))
    values, limits = (before, asked.weights, asked.floors), (asked.aim, SHARPEST, HEIGHT, AROUND)
    return compiled().better_places(tables, points, normals, values, limits, ways)
