"""Exact B-forms of polynomials on segments, triangles and tetrahedra, and their rounding."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import factorial, lcm, prod

import numpy as np
from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpz, fmpz_mat

from pas.algebra.monomials import Floats, exponents, homogeneous_exponents, positions
from pas.algebra.polynomial import GENERATORS, RING
from pas.algebra.rational import Vector

LARGEST_TABLE = 14
"""Up to this degree B-forms are made by a table of integers, which is kept; it would be too large beyond."""


def on_simplex(polynomial: fmpq_mpoly, vertices: Sequence[Vector]) -> fmpq_mpoly:
    """The polynomial as a function of the barycentric coordinates b_1 .. b_d.

    They are the first d variables of the ring; `b_0 = 1 - b_1 - ... - b_d`.
    """
    base, *others = vertices
    coordinates = [
        sum((g * (v[i] - base[i]) for g, v in zip(GENERATORS, others, strict=False)), RING.constant(base[i]))
        for i in range(3)
    ]
    return polynomial.compose(*coordinates, ctx=RING)


def b_form(restricted: fmpq_mpoly, degree: int, dimension: int) -> list[fmpq]:
    """Exact B-coefficients, as of degree `degree`, of what `on_simplex` returned.

    `x^b = sum_a (n-|b|)! a! / (n! (a-b)!) B_a`, in integers over one denominator.
    """
    if degree > LARGEST_TABLE:
        return _elevated(restricted, degree, dimension)
    where = positions(degree, dimension)
    terms = restricted.to_dict()
    denominator = lcm(*(int(c.q) for c in terms.values())) if terms else 1
    column = fmpz_mat(len(where), 1)
    for exponent, c in terms.items():
        column[where[exponent[:dimension]], 0] = int(c.p) * (denominator // int(c.q))
    scale = fmpz(denominator) * factorial(degree)
    product = _power_to_bernstein(degree, dimension) * column
    return [fmpq(product[i, 0], scale) for i in range(len(where))]


def polar_row(arguments: Sequence[Vector]) -> list[fmpq]:
    """The polar forms of all monomials of degree <= n at n points, in the order of `exponents(n)`.

    With the corners of a tetrahedron as arguments, each as often as a multi-index says, these are
    the monomials' B-coefficients at that multi-index (Ramshaw 1989).  The polar form of
    x^a y^b z^c is `a! b! c! (n-a-b-c)! / n!` times the coefficient of s^a t^b u^c in the product
    of all `1 + s x_i + t y_i + u z_i`.
    """
    degree = len(arguments)
    whole = RING.constant(1)
    for point in arguments:
        whole *= sum((g * c for g, c in zip(GENERATORS, point, strict=True)), RING.constant(1))
    terms = whole.to_dict()
    row = []
    for e in exponents(degree):
        times = factorial(degree - sum(e)) * factorial(e[0]) * factorial(e[1]) * factorial(e[2])
        row.append(terms.get(e, fmpq(0)) * fmpq(times, factorial(degree)))
    return row


def _elevated(restricted: fmpq_mpoly, degree: int, dimension: int) -> list[fmpq]:
    """The same as a homogeneous polynomial in all barycentric coordinates, whose sum is 1, degree after degree."""
    ring = fmpq_mpoly_ctx.get([f"b{i}" for i in range(dimension + 1)], Ordering.degrevlex)
    whole = sum(ring.gens(), ring.constant(0))
    parts: dict[int, dict[tuple[int, ...], fmpq]] = {}
    for exponent, c in restricted.to_dict().items():
        parts.setdefault(sum(exponent), {})[0, *exponent[:dimension]] = c
    raised = ring.constant(0)
    for d in range(degree + 1):
        raised = raised * whole + ring.from_dict(parts.get(d, {}))
    terms = raised.to_dict()
    top = factorial(degree)
    result = []
    for index in homogeneous_exponents(degree, dimension + 1):
        value = terms.get(index, fmpq(0))
        result.append(value * fmpq(prod(map(factorial, index)), top))
    return result


@cache
def _power_to_bernstein(degree: int, dimension: int) -> fmpz_mat:
    where = positions(degree, dimension)
    indices = homogeneous_exponents(degree, dimension + 1)
    matrix = fmpz_mat(len(indices), len(where))
    for row, (_, *index) in enumerate(indices):
        for exponent, column in where.items():
            entry = factorial(degree - sum(exponent))
            for a, b in zip(index, exponent, strict=True):
                entry *= factorial(a) // factorial(a - b) if a >= b else 0
            matrix[row, column] = entry
    return matrix


def rounded(values: Sequence[fmpq]) -> Floats:
    """Coefficients scaled to a largest absolute value of 1 and rounded to the nearest doubles.

    The scale is positive, so signs are kept, and each result errs by at most 2^-53.
    """
    largest = max((abs(v) for v in values), default=fmpq(0))
    if largest == 0:
        return np.zeros(len(values))
    return np.array([int(q.p) / int(q.q) for q in (v / largest for v in values)])


def rounded_forms(polynomial: fmpq_mpoly, simplices: Sequence[Sequence[Vector]], degree: int | None = None) -> Floats:
    """The rounded B-coefficients of one polynomial on simplices of one dimension, (N, m).

    As of degree `degree`, by default the polynomial's own.
    """
    degree = max(int(polynomial.total_degree()), 0) if degree is None else degree
    return np.array([rounded(b_form(on_simplex(polynomial, s), degree, len(s) - 1)) for s in simplices])
