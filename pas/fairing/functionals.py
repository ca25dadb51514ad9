"""What a polynomial is integrated and evaluated by: values at points, B-coefficients, and integrals over tetrahedra
and boxes.

Values, B-coefficients and integrals of products are exact, by the Gram matrix of Bernstein polynomials on a
tetrahedron or by the moments of a box.  Gauss rules are exact but for rounding, and have positive weights, so that
integrals of squares come as sums of squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_mpoly
from scipy.special import roots_jacobi, roots_legendre

from pas.algebra.monomials import count, exponents
from pas.algebra.rational import Vector, VectorLike, cross, dot, minus, to_floats, vector
from pas.arrays import Floats
from pas.bernstein.forms import b_form, gram, on_simplex, polar_row
from pas.partition.cells import Partition

Handle = tuple[int, tuple[int, int, int, int]]
"""A B-coefficient: the number of a cell (tetrahedron) and a multi-index of its corners."""

REFERENCE = tuple(vector(corner) for corner in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
"""The tetrahedron of the B-form where the partition is all of space."""


@dataclass(frozen=True)
class Functional:
    """A linear functional of polynomials on one piece: a column (C(n+3, 3), 1) on coefficients in local coordinates."""

    piece: int
    column: fmpq_mat

    def on(self, patches: Sequence[fmpq_mat]) -> list[fmpq]:
        """Its value on each member of a basis given by `patches[p]` (m, C(n+3, 3))."""
        return (patches[self.piece] * self.column).entries()


def value_at(partition: Partition, point: Vector, degree: int, name: str = "the point") -> Functional:
    """The value at a point (user's coordinates).  Raises `ValueError` outside the region."""
    piece, local = partition.place(point, name)
    x, y, z = ([c**i for i in range(degree + 1)] for c in local)
    return Functional(piece, fmpq_mat(count(degree), 1, [x[a] * y[b] * z[c] for a, b, c in exponents(degree)]))


def b_coefficient(partition: Partition, handle: Handle, degree: int) -> Functional:
    """The B-coefficient of a cell at a multi-index, as of degree `degree`.

    Raises `ValueError` for a cell or an index that does not exist.
    """
    cell, index = handle
    cells = max(len(partition.cells), 1)
    if not 0 <= cell < cells:
        raise ValueError(f"the handle {handle} is in no cell: cells are numbered from 0 to {cells - 1}")
    if min(index) < 0 or sum(index) != degree:
        raise ValueError(f"the multi-index of handle {handle} must be four numbers >= 0 with the sum {degree}")
    corners = partition.local.corners(partition.cells[cell]) if partition.cells else REFERENCE
    arguments = [corner for corner, times in zip(corners, index, strict=True) for _ in range(times)]
    piece = int(partition.piece_of[cell]) if partition.cells else 0
    return Functional(piece, fmpq_mat(count(degree), 1, polar_row(arguments)))


@dataclass(frozen=True)
class Box:
    """An axis-parallel box from `lower` to `upper` (three exact numbers each)."""

    lower: Vector
    upper: Vector

    def __init__(self, lower: VectorLike, upper: VectorLike) -> None:
        object.__setattr__(self, "lower", vector(lower, "lower"))
        object.__setattr__(self, "upper", vector(upper, "upper"))
        if any(a >= b for a, b in zip(self.lower, self.upper, strict=True)):
            raise ValueError("each lower bound of a box must be below the upper one")


def tetrahedron_products(functions: Sequence[fmpq_mpoly], corners: Sequence[Vector], degree: int) -> fmpq_mat:
    """Exact integrals of products of functions of degree <= `degree` over a tetrahedron, (m, m)."""
    if not functions:
        return fmpq_mat(0, 0)
    a, b, c, d = corners
    volume = abs(dot(minus(b, a), cross(minus(c, a), minus(d, a)))) / 6
    forms = [b_form(on_simplex(g, corners), degree, 3) for g in functions]
    rows = fmpq_mat(len(forms), len(forms[0]), [c for form in forms for c in form])
    return rows * gram(degree, 3) * rows.transpose() * volume


def box_products(functions: Sequence[fmpq_mpoly], box: Box) -> fmpq_mat:
    """Exact integrals of products of functions over a box, by its moments, (m, m)."""
    total = fmpq_mat(len(functions), len(functions))
    for i, left in enumerate(functions):
        for j, right in enumerate(functions[: i + 1]):
            total[i, j] = total[j, i] = _integral(left * right, box)
    return total


def tetrahedra_rule(partition: Partition, degree: int) -> list[tuple[Floats, Floats]]:
    """For each cell, points (m, 3) and weights (m,) exact for polynomials of degree `degree`."""
    barycentric, weights = _conical_rule(degree // 2 + 1)
    rules = []
    for cell in partition.cells:
        corners = partition.points[list(cell)]
        volume = abs(np.linalg.det(corners[1:] - corners[0])) / 6
        rules.append((barycentric @ corners, weights * volume))
    return rules


def box_rule(box: Box, degree: int) -> tuple[Floats, Floats]:
    """Points (m, 3) and weights (m,) on a box, exact for polynomials of degree `degree`."""
    nodes, weights = roots_legendre(degree // 2 + 1)
    ends = zip(to_floats(box.lower), to_floats(box.upper), strict=True)
    axes = [(lo + (hi - lo) * (nodes + 1) / 2, weights * (hi - lo) / 2) for lo, hi in ends]
    points = np.stack(np.meshgrid(*(a for a, _ in axes), indexing="ij"), axis=-1).reshape(-1, 3)
    products = np.einsum("i,j,k->ijk", *(w for _, w in axes)).ravel()
    return points, products


@cache
def _conical_rule(points: int) -> tuple[Floats, Floats]:
    """Barycentric points and weights (of sum 1): the conical product of Gauss-Jacobi rules."""
    rules = []
    for power in (2, 1, 0):
        nodes, weights = roots_jacobi(points, power, 0)
        rules.append(((nodes + 1) / 2, weights / weights.sum()))
    (a, wa), (b, wb), (c, wc) = rules
    u, v, w = np.meshgrid(a, b, c, indexing="ij")
    second, third = (1 - u) * v, (1 - u) * (1 - v) * w
    stacked = np.stack([1 - u - second - third, u, second, third], axis=-1).reshape(-1, 4)
    return stacked, np.einsum("i,j,k->ijk", wa, wb, wc).ravel()


def _integral(polynomial: fmpq_mpoly, box: Box) -> fmpq:
    total = fmpq(0)
    for exponent, coefficient in polynomial.to_dict().items():
        term = coefficient
        for e, lo, hi in zip(exponent, box.lower, box.upper, strict=True):
            term *= (hi ** (e + 1) - lo ** (e + 1)) / (e + 1)
        total += term
    return total
