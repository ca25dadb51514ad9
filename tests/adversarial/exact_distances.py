"""Distances between surfaces and what was made of them, in exact arithmetic: no rounding can hide a false bound."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

from pas.mesh.mesh import Mesh
from pas.parametric.fitting import DEGREE, FittedPatch
from pas.parametric.surface import ParametricSurface

GRID = 1 << 26
"""Of the parameters of a mesh's vertices over the domain: `pas.parametric.tiling`."""

Point = tuple[Fraction, ...]


def square_distance(first: Any, second: Any) -> Fraction:
    """The square of the distance of two points."""
    return sum(((a - b) ** 2 for a, b in zip(first, second, strict=True)), Fraction(0))


def off_mesh(surface: ParametricSurface, mesh: Mesh, draw: Random) -> Fraction:
    """The square of the distance of a point of a triangle from the surface at equal parameters.

    `surface` has the mesh's domain; its vertices stand at multiples of 1 / GRID of it.
    """
    corners = mesh.triangles[draw.randrange(len(mesh.triangles))]
    shares = [Fraction(draw.randint(0, 8)) for _ in range(3)]
    total = sum(shares) or 1
    shares = [s / total for s in shares] if any(shares) else [Fraction(1), Fraction(0), Fraction(0)]
    places = [on_grid(surface, mesh.parameters[i]) for i in corners]
    place = [sum((s * p[axis] for s, p in zip(shares, places, strict=True)), Fraction(0)) for axis in (0, 1)]
    point = [
        sum((s * Fraction(float(mesh.points[i, axis])) for s, i in zip(shares, corners, strict=True)), Fraction(0))
        for axis in range(3)
    ]
    return square_distance(point, surface.at(*place))


def on_grid(surface: ParametricSurface, parameters: Any) -> list[Fraction]:
    """The exact parameters of a vertex."""
    found = []
    for x, (low, high) in zip(parameters, surface.ends, strict=True):
        assert low is not None and high is not None
        found.append(low + (high - low) * Fraction(round((Fraction(float(x)) - low) / (high - low) * GRID), GRID))
    return found


def off_spline(surface: ParametricSurface, patch: FittedPatch, draw: Random) -> Fraction:
    """The square of the distance of a point of a B-spline from the surface at equal parameters."""
    knots = [[Fraction(float(k)) for k in row] for row in patch.knots]
    place = []
    for row, (low, high) in zip(knots, surface.ends, strict=True):
        assert low is not None and high is not None
        first, last = max(row[0], low), min(row[-1], high)
        place.append(first + (last - first) * Fraction(draw.randint(0, 10**6), 10**6))
    columns = [
        spline(knots[1], [[Fraction(float(c)) for c in point] for point in row], place[1]) for row in patch.points
    ]
    return square_distance(spline(knots[0], columns, place[0]), surface.at(*place))


def spline(knots: list[Fraction], points: list[list[Fraction]], t: Fraction) -> list[Fraction]:
    """A point of a B-spline curve by de Boor's algorithm."""
    last = len(points) - 1
    span = max(i for i in range(DEGREE, last + 1) if knots[i] <= t)
    row = [points[span - DEGREE + i] for i in range(DEGREE + 1)]
    for level in range(1, DEGREE + 1):
        for i in range(DEGREE, level - 1, -1):
            left = knots[span - DEGREE + i]
            share = (t - left) / (knots[span + i - level + 1] - left)
            row[i] = [a + share * (b - a) for a, b in zip(row[i - 1], row[i], strict=True)]
    return row[DEGREE]
