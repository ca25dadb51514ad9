"""Quadrics over the rationals: their symmetric matrices, inertia and kind, all decided exactly.

f = (x, y, z, 1) Q (x, y, z, 1)^T.  The kinds follow from the numbers of positive and negative eigenvalues of Q and of
its upper left 3 x 3 block (Salmon 1862); all eigenvalues being real, Descartes' rule of signs counts them
without rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.brief import brief
from pas.algebra.inputs import short
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Vector, rational, to_float, to_fraction

Inertia = tuple[int, int]
"""Numbers of positive and of negative eigenvalues."""


class QuadricKind(Enum):
    """What a real quadric is; the first six are those with closed plane sections."""

    ELLIPSOID = "ellipsoid"
    CYLINDER = "elliptic cylinder"
    CONE = "elliptic cone"
    PARABOLOID = "elliptic paraboloid"
    ONE_SHEET = "hyperboloid of one sheet"
    TWO_SHEETS = "hyperboloid of two sheets"
    SADDLE = "hyperbolic paraboloid"
    HYPERBOLIC_CYLINDER = "hyperbolic cylinder"
    PARABOLIC_CYLINDER = "parabolic cylinder"
    PLANES = "pair of planes"
    PLANE = "double plane"
    LINE = "straight line"
    POINT = "point"
    EMPTY = "empty set"


REACH = (Fraction(1, 10**50), Fraction(10**50))
"""Greatest coefficients of polynomials that are worked with as they are."""

KINDS: dict[tuple[Inertia, Inertia], QuadricKind] = {
    ((3, 0), (3, 1)): QuadricKind.ELLIPSOID,
    ((3, 0), (3, 0)): QuadricKind.POINT,
    ((3, 0), (4, 0)): QuadricKind.EMPTY,
    ((2, 1), (2, 2)): QuadricKind.ONE_SHEET,
    ((2, 1), (3, 1)): QuadricKind.TWO_SHEETS,
    ((2, 1), (2, 1)): QuadricKind.CONE,
    ((2, 0), (2, 1)): QuadricKind.CYLINDER,
    ((2, 0), (3, 1)): QuadricKind.PARABOLOID,
    ((2, 0), (2, 0)): QuadricKind.LINE,
    ((2, 0), (3, 0)): QuadricKind.EMPTY,
    ((1, 1), (2, 2)): QuadricKind.SADDLE,
    ((1, 1), (2, 1)): QuadricKind.HYPERBOLIC_CYLINDER,
    ((1, 1), (1, 2)): QuadricKind.HYPERBOLIC_CYLINDER,
    ((1, 1), (1, 1)): QuadricKind.PLANES,
    ((1, 0), (2, 1)): QuadricKind.PARABOLIC_CYLINDER,
    ((1, 0), (1, 1)): QuadricKind.PLANES,
    ((1, 0), (1, 0)): QuadricKind.PLANE,
    ((1, 0), (2, 0)): QuadricKind.EMPTY,
}
"""By the inertia of the 3 x 3 block and of Q, the sign of f chosen so that the former has more positive ones."""


@dataclass(frozen=True, init=False)
class Quadric:
    """A polynomial of degree two in x, y, z; raises `ValueError` or `TypeError` for anything else."""

    polynomial: Polynomial

    __repr__ = brief

    def __init__(self, expression: PolynomialLike | Quadric, name: str = "the quadric") -> None:
        if isinstance(expression, Quadric):
            expression = expression.polynomial
        polynomial = Polynomial(expression)
        if polynomial.degree != 2:
            raise ValueError(
                f"{name} must be a polynomial of degree 2, not {short(str(polynomial))} of degree {polynomial.degree}"
            )
        object.__setattr__(self, "polynomial", within_reach(polynomial))

    @cached_property
    def matrix(self) -> fmpq_mat:
        """The symmetric 4 x 4 matrix Q."""
        rows = [[fmpq(0)] * 4 for _ in range(4)]
        for exponents, value in self.polynomial.coefficients().items():
            i, j = [axis for axis, e in enumerate((*exponents, 2 - sum(exponents))) for _ in range(e)]
            rows[i][j] += rational(value) / 2
            rows[j][i] += rational(value) / 2
        return fmpq_mat(rows)

    @cached_property
    def kind(self) -> QuadricKind:
        """What the real zero set is."""
        return kind_of(self.matrix)

    def require_curved(self, name: str) -> None:
        """Raise `ValueError` for sets that are no curved surface."""
        if self.kind not in list(QuadricKind)[:9]:
            raise ValueError(
                f"{name} must be a curved surface such as x^2 + y^2 - 1; {short(str(self.polynomial))} = 0 is a(n) "
                f"{self.kind.value}"
            )


def within_reach(polynomial: Polynomial) -> Polynomial:
    """The polynomial itself, or over its greatest coefficient where doubles would hold no products of that."""
    greatest = max((abs(c) for c in polynomial.coefficients().values()), default=Fraction(1))
    return polynomial if REACH[0] <= greatest <= REACH[1] else polynomial / greatest


def kind_of(matrix: fmpq_mat) -> QuadricKind:
    """What the real zero set of the quadric with this matrix (not only of its last entry) is."""
    small = inertia(fmpq_mat([[matrix[i, j] for j in range(3)] for i in range(3)]))
    large = inertia(matrix)
    if small[0] < small[1]:
        small, large = small[::-1], large[::-1]
    return KINDS[small, large]


def inertia(matrix: fmpq_mat) -> Inertia:
    """The numbers of positive and negative eigenvalues of a symmetric rational matrix."""
    coefficients = [c for c in matrix.charpoly().coeffs() if c != 0]
    positive = sum(a * b < 0 for a, b in pairwise(coefficients))
    return positive, int(matrix.rank()) - positive


def read_plane(plane: PolynomialLike, name: str = "the plane") -> tuple[Vector, fmpq]:
    """Normal n and offset d of the plane n . x = d given by a polynomial of degree one, such as "z - 1".

    The greatest entry of the normal is within `REACH`.
    """
    polynomial = Polynomial(plane)
    if polynomial.degree != 1:
        raise ValueError(f"{name} must be a polynomial of degree 1 such as 'z - 1', not {short(str(polynomial))}")
    c = {e: rational(v) for e, v in polynomial.coefficients().items()}
    zero = fmpq(0)
    normal = (c.get((1, 0, 0), zero), c.get((0, 1, 0), zero), c.get((0, 0, 1), zero))
    greatest = to_fraction(max(map(abs, normal)))
    scale = fmpq(1) if REACH[0] <= greatest <= REACH[1] else rational(greatest)
    x, y, z = (n / scale for n in normal)
    return (x, y, z), -c.get((0, 0, 0), zero) / scale


def to_array(matrix: fmpq_mat) -> Floats:
    """The entries rounded to doubles."""
    return np.array([[to_float(c) for c in row] for row in matrix.tolist()])


def text(point: Any) -> str:
    """A point for a message."""
    return "(" + ", ".join(f"{float(x) if not isinstance(x, fmpq) else to_float(x):.6g}" for x in point) + ")"


def plane_text(normal: Vector, offset: fmpq) -> str:
    """The plane's equation for a message."""
    x, y, z = normal
    equation = Polynomial({(1, 0, 0): x, (0, 1, 0): y, (0, 0, 1): z, (0, 0, 0): -offset})
    return f"{short(str(equation))} = 0"
