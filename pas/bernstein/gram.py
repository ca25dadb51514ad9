"""Exact integrals of products of Bernstein polynomials."""

from __future__ import annotations

from functools import cache
from math import comb, prod

from flint import fmpq, fmpq_mat

from pas.algebra.monomials import homogeneous_exponents


@cache
def gram(degree: int, dimension: int) -> fmpq_mat:
    """Integrals of B_a B_b over a simplex of volume 1 (Lai and Schumaker 2007, section 2.11).

    `int B_a B_b = C(a+b, a) / (C(2n, n) C(2n+d, d))`, with the product of the entries'
    binomials in the numerator.
    """
    indices = homogeneous_exponents(degree, dimension + 1)
    scale = comb(2 * degree, degree) * comb(2 * degree + dimension, dimension)
    return fmpq_mat(
        len(indices),
        len(indices),
        [fmpq(prod(comb(i + j, i) for i, j in zip(a, b, strict=True)), scale) for a in indices for b in indices],
    )
