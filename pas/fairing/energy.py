"""Thin-plate energy `1/2 * integral of |Hess f|_F^2` over a region or a box.

Two ways to the matrix of inner products of Hessians: exactly, by moments of a box or by the
Gram matrix of Bernstein polynomials on tetrahedra, and in floating point, by a Gauss rule of the
right degree, which gives a factor J with `H = J^T J` and so a positive semidefinite matrix
whatever the rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_mpoly
from scipy.special import roots_jacobi, roots_legendre

from pas.algebra.inputs import MOST_PIECES, whole
from pas.algebra.monomials import Floats
from pas.algebra.rational import Vector, cross, dot, rational, vector
from pas.bernstein.forms import b_form, on_simplex
from pas.bernstein.gram import gram
from pas.partition.cells import Partition

SECOND_DERIVATIVES = ((0, 0, 1), (1, 1, 1), (2, 2, 1), (0, 1, 2), (0, 2, 2), (1, 2, 2))
"""The distinct entries (i, j) of a Hessian and how often each stands in it."""


@dataclass(frozen=True)
class Box:
    """An axis-parallel box from `lower` to `upper` (three exact numbers each)."""

    lower: Vector
    upper: Vector

    def __init__(self, lower: Any, upper: Any) -> None:
        object.__setattr__(self, "lower", vector(lower, "lower"))
        object.__setattr__(self, "upper", vector(upper, "upper"))
        if any(a >= b for a, b in zip(self.lower, self.upper, strict=True)):
            raise ValueError("each lower bound of a box must be below the upper one")


@dataclass(frozen=True)
class ThinPlate:
    """Thin-plate energy over `domain`.

    Without a domain, every patch over its own piece.  With a `Box`, the patch of piece number
    `piece` (from 0) over that box, as some of the literature has it.
    `weight` multiplies it: 0 leaves the choice to points and their least squares.
    """

    domain: Box | None = None
    piece: int = 0
    weight: fmpq = fmpq(1)

    def __post_init__(self) -> None:
        object.__setattr__(self, "weight", rational(self.weight, "weight"))
        whole(self.piece, "piece", 0, MOST_PIECES - 1)
        if self.weight < 0:
            raise ValueError(f"weight must not be negative, and is {self.weight}")
        if self.domain is not None and not isinstance(self.domain, Box):
            raise TypeError(f"domain must be a pas.Box or None, not {self.domain!r}")

    def piece_of(self, pieces: int) -> int:
        """The number of the piece whose patch counts, of so many; raises `ValueError` where there is none such."""
        return whole(self.piece, "piece", 0, pieces - 1, "the pieces of the partition, from 0")


def second_derivatives(patch: fmpq_mpoly) -> list[tuple[fmpq_mpoly, int]]:
    """The distinct second derivatives with their multiplicities in the Hessian."""
    return [(patch.derivative(i).derivative(j), times) for i, j, times in SECOND_DERIVATIVES]


def tetrahedron_products(patches: Sequence[fmpq_mpoly], corners: Sequence[Vector], degree: int) -> fmpq_mat:
    """Exact integrals of `<Hess g_i, Hess g_j>` over a tetrahedron (Bernstein Gram matrix)."""
    lower = max(degree - 2, 0)
    weights = gram(lower, 3)
    volume = (
        abs(dot(_minus(corners[1], corners[0]), cross(_minus(corners[2], corners[0]), _minus(corners[3], corners[0]))))
        / 6
    )
    total = fmpq_mat(len(patches), len(patches))
    for entry, (_, _, times) in enumerate(SECOND_DERIVATIVES):
        forms = [b_form(on_simplex(second_derivatives(g)[entry][0], corners), lower, 3) for g in patches]
        rows = fmpq_mat(len(forms), len(forms[0]), [c for form in forms for c in form])
        total += rows * weights * rows.transpose() * (volume * times)
    return total


def box_products(patches: Sequence[fmpq_mpoly], box: Box) -> fmpq_mat:
    """Exact integrals of `<Hess g_i, Hess g_j>` over a box, by its moments."""
    total = fmpq_mat(len(patches), len(patches))
    hessians = [second_derivatives(g) for g in patches]
    for i, left in enumerate(hessians):
        for j, right in enumerate(hessians[: i + 1]):
            value = sum(
                (_integral(a * b, box) * times for (a, times), (b, _) in zip(left, right, strict=True)), fmpq(0)
            )
            total[i, j] = total[j, i] = value
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


def box_rule(lower: Floats, upper: Floats, degree: int) -> tuple[Floats, Floats]:
    """Points (m, 3) and weights (m,) on a box, exact for polynomials of degree `degree`."""
    nodes, weights = roots_legendre(degree // 2 + 1)
    axes = [(lo + (hi - lo) * (nodes + 1) / 2, weights * (hi - lo) / 2) for lo, hi in zip(lower, upper, strict=True)]
    points = np.stack(np.meshgrid(*(a for a, _ in axes), indexing="ij"), axis=-1).reshape(-1, 3)
    products = np.einsum("i,j,k->ijk", *(w for _, w in axes)).ravel()
    return points, products


@lru_cache(maxsize=None)
def _conical_rule(points: int) -> tuple[Floats, Floats]:
    """Barycentric points and weights (of sum 1): the conical product of Gauss-Jacobi rules."""
    rules = []
    for power in (2, 1, 0):
        nodes, weights = roots_jacobi(points, power, 0)
        rules.append(((nodes + 1) / 2, weights / weights.sum()))
    (a, wa), (b, wb), (c, wc) = rules
    u, v, w = np.meshgrid(a, b, c, indexing="ij")
    first = u
    second = (1 - u) * v
    third = (1 - u) * (1 - v) * w
    stacked = np.stack([1 - first - second - third, first, second, third], axis=-1).reshape(-1, 4)
    return stacked, np.einsum("i,j,k->ijk", wa, wb, wc).ravel()


def _integral(polynomial: fmpq_mpoly, box: Box) -> fmpq:
    total = fmpq(0)
    for exponent, coefficient in polynomial.to_dict().items():
        term = coefficient
        for e, lo, hi in zip(exponent, box.lower, box.upper, strict=True):
            term *= (hi ** (e + 1) - lo ** (e + 1)) / (e + 1)
        total += term
    return total


def _minus(a: Vector, b: Vector) -> tuple[fmpq, fmpq, fmpq]:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]
