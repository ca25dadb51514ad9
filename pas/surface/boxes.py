"""Surfaces of single polynomials in boxes."""

from __future__ import annotations

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import VectorLike
from pas.partition.single_cell import SingleCell
from pas.surface.piecewise import PiecewiseSurface


def boxed(polynomial: Polynomial, lower: VectorLike, upper: VectorLike) -> PiecewiseSurface:
    """The zeros of a polynomial in a box, which meet nothing; see `pas.Polynomial.surface`."""
    return PiecewiseSurface.from_polynomials(SingleCell(lower, upper), (), 0, [polynomial])
