"""Exact values of a solution space's members at points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from flint import fmpq_mat

from pas.algebra.monomials import count, exponents
from pas.algebra.rational import Vector, vector

if TYPE_CHECKING:
    from pas.blending.space import SolutionSpace


def values_at(space: SolutionSpace, points: Sequence[Any]) -> fmpq_mat:
    """Values of the basis members at points (three exact numbers each): (points, dimension).

    Raises `ValueError` for a point outside the region.
    """
    places = [space.partition.place(vector(p, f"points[{i}]"), f"points[{i}]") for i, p in enumerate(points)]
    result = fmpq_mat(len(places), space.dimension)
    for row, (piece, local) in enumerate(places):
        values = space.patches[piece] * monomials_at(local, space.degree)
        for j in range(space.dimension):
            result[row, j] = values[j, 0]
    return result


def monomials_at(point: Vector, degree: int) -> fmpq_mat:
    """Exact values of all monomials at a point, as a column."""
    x, y, z = ([c**i for i in range(degree + 1)] for c in point)
    return fmpq_mat(count(degree), 1, [x[a] * y[b] * z[c] for a, b, c in exponents(degree)])
