"""Exact B-forms of polynomials on segments, triangles and tetrahedra, their rounding, and integrals of products.

`BoundedForms` are added and multiplied in doubles, on many simplices at once, with bounds on their rounding.  The
coefficients of a product are `sum_(b + b' = a) C(a, b) / C(n + m, n) c_b c'_b'`, C(a, b) the product of the
entries' binomials (Farin 2002, chapter 17): means of products, whose weights are not negative and have the sum 1.
Of T terms, with weights that took at most five roundings, two products each and T - 1 sums, a coefficient errs by at
most 1.01 (T + 7) 2^-53 of the product of the largest sizes (Higham 2002, section 3.1).  That is counted twice, which
does for products of roundings and, where the largest coefficient is above `SMALLEST`, for underflow.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from math import comb, lcm, prod

import numpy as np
from flint import Ordering, fmpq, fmpq_mat, fmpq_mpoly, fmpq_mpoly_ctx

from pas.algebra.monomials import Exponents, exponents, homogeneous_exponents, multinomial, positions
from pas.algebra.polynomial import GENERATORS, RING, Polynomial
from pas.algebra.rational import Vector, to_floats
from pas.algebra.scaling import scaled
from pas.arrays import Floats, Integers

UNIT_ROUNDOFF = 2.0**-53

LARGEST_ERROR, SMALLEST = 2.0**-36, 1e-200
"""The largest error of forms in doubles, over their largest coefficient, which is to be far from underflow."""


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

    Made homogeneous by the sum of all barycentric coordinates, which is 1, it has them as its coefficients over the
    numbers `n! / (a_0! .. a_d!)`.
    """
    ring, coordinates, factors = _homogeneous(degree, dimension)
    lifted = ring.from_dict({(degree - sum(e), *e[:dimension]): c for e, c in restricted.to_dict().items()})
    terms = lifted.compose(*coordinates, ctx=ring).to_dict()
    return [terms.get(index, 0) * factor for index, factor in factors.items()]


@cache
def _homogeneous(degree: int, dimension: int) -> tuple[fmpq_mpoly_ctx, list[fmpq_mpoly], dict[Exponents, fmpq]]:
    """The ring of all barycentric coordinates, their sum followed by all but the first, and for each multi-index
    1 over its multinomial coefficient."""
    ring = fmpq_mpoly_ctx.get([f"b{i}" for i in range(dimension + 1)], Ordering.degrevlex)
    first, *others = ring.gens()
    indices = homogeneous_exponents(degree, dimension + 1)
    factors = {index: fmpq(1, multinomial(index)) for index in indices}
    return ring, [sum(others, first), *others], factors


def polar_row(arguments: Sequence[Vector]) -> list[fmpq]:
    """The polar forms of all monomials of degree <= n at n points, in the order of `exponents(n)`.

    With the corners of a tetrahedron as arguments, each as often as a multi-index says, these are the monomials'
    B-coefficients at that multi-index (Ramshaw 1989).  The polar form of x^a y^b z^c is `a! b! c! (n-a-b-c)! / n!`
    times the coefficient of s^a t^b u^c in the product of all `1 + s x_i + t y_i + u z_i`.
    """
    degree = len(arguments)
    whole = RING.constant(1)
    for point in arguments:
        whole *= sum((g * c for g, c in zip(GENERATORS, point, strict=True)), RING.constant(1))
    terms = whole.to_dict()
    return [terms.get(e, 0) * fmpq(1, multinomial((degree - sum(e), *e))) for e in exponents(degree)]


def rounded(values: Sequence[fmpq]) -> Floats:
    """Coefficients scaled to a largest absolute value of 1 and rounded to the nearest doubles.

    The scale is positive, so signs are kept, and each result errs by at most 2^-53.
    """
    denominator = lcm(*(int(v.q) for v in values))
    whole = [int(v.p) * (denominator // int(v.q)) for v in values]
    largest = max(map(abs, whole), default=0)
    if largest == 0:
        return np.zeros(len(whole))
    return np.array([v / largest for v in whole])


def corner_points(simplices: Sequence[Sequence[Vector]]) -> Floats:
    """The corners (N, d + 1, 3) of simplices of one dimension, of which many may have some in common, as doubles."""
    known = {id(c): to_floats(c) for c in {id(c): c for s in simplices for c in s}.values()}
    return np.array([[known[id(c)] for c in s] for s in simplices])


def rounded_form(polynomial: fmpq_mpoly, simplex: Sequence[Vector], degree: int) -> Floats:
    """The rounded B-coefficients (m,) of a polynomial on a simplex, as of a degree."""
    return rounded(b_form(on_simplex(polynomial, simplex), degree, len(simplex) - 1))


def nearby_forms(
    polynomials: Sequence[fmpq_mpoly], simplices: Sequence[Sequence[Vector]], degree: int
) -> tuple[Floats, float]:
    """B-coefficients (N, m) of a polynomial on each of N simplices of one dimension, and by how much each may be off.

    Scaled as by `rounded`, but worked out in doubles, for all simplices at once, by polar forms (Ramshaw 1989) whose
    arguments are put in one after the other.  Where that may be off by more than `LARGEST_ERROR`, they are `rounded`.

    Each of the `degree` steps multiplies by coordinates, which are rounded, and adds four products; the first factors
    are coefficients times weights, both rounded.  So a B-coefficient is a sum of products, each with at most
    `5 degree + 3` factors 1 + e, |e| <= 2^-53, and is off by at most 1.01 times so many 2^-53 of the sum of their sizes
    (Higham 2002, section 3.1).  That sum is found in the same way and with the same relative error: the bound is
    doubled.  Scaling adds 2^-53.
    """
    if not polynomials:
        return np.empty((0, 0)), UNIT_ROUNDOFF
    near = {key: scaled(Polynomial.from_raw(p)) for key, p in {id(p): p for p in polynomials}.items()}
    with np.errstate(all="ignore"):  # what is not finite is rounded
        forms, errors = polar_forms([near[id(p)] for p in polynomials], corner_points(simplices), degree)
        largest = np.abs(forms).max(axis=1)
        errors = errors / largest + UNIT_ROUNDOFF
        forms /= largest[:, None]
    sure = (errors <= LARGEST_ERROR) & (largest > SMALLEST)
    for i in np.flatnonzero(~sure).tolist():
        forms[i] = rounded_form(polynomials[i], simplices[i], degree)
    return forms, float(errors[sure].max(initial=UNIT_ROUNDOFF))


def polar_forms(
    polynomials: Sequence[Polynomial], corners: Floats, degree: int, moved: int = 0, reach: float = 0.0
) -> tuple[Floats, Floats]:
    """B-coefficients (N, m), not scaled, of a polynomial on each of N simplices (N, d + 1, 3), and by how much each
    simplex' may be off (N,): see `nearby_forms`.

    Corners may be off by so many roundings of `reach`, besides their own one.
    """
    known = {id(p): p.dense(degree) * _polar_weights(degree) for p in {id(p): p for p in polynomials}.values()}
    table = np.stack([known[id(p)] for p in polynomials], axis=1)  # most are many times
    places = np.concatenate([np.ones((*corners.shape[:2], 1)), corners], axis=2).transpose(1, 2, 0)
    both = np.concatenate([table, np.abs(table)], axis=1)
    at = np.concatenate([places, np.maximum(np.abs(places), reach)], axis=2)
    forms, sizes = np.split(np.stack(list(_blossom(both, degree, at)), axis=1), 2)
    return forms, 2 * ((5 + moved) * degree + 3) * UNIT_ROUNDOFF * sizes.max(axis=1)


@cache
def _polar_weights(degree: int) -> Floats:
    """The factors from coefficients to values of the polar form: 1 over multinomial coefficients."""
    return np.array([1 / multinomial((degree - sum(e), *e)) for e in exponents(degree)])


def _blossom(table: Floats, degree: int, places: Floats) -> Iterator[Floats]:
    """A polar form with all choices of `degree` of the places (d + 1, 4, N), in descending lexicographic order."""
    place, rest = places[0], places[1:]
    forms = [table]
    for left in range(degree, 0, -1):
        forms.append((forms[-1][_steps(left - 1)] * place).sum(axis=1))  # one more argument is this place
    if not len(rest):
        yield forms[-1][0]
        return
    for times in range(degree, -1, -1):
        yield from _blossom(forms[times], degree - times, rest)


@cache
def _steps(degree: int) -> Integers:
    """Where monomials of degree <= `degree`, times 1, x, y and z, stand: (C(n+3, 3), 4)."""
    where, units = positions(degree + 1), ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    return np.array([[where[a + i, b + j, c + k] for i, j, k in units] for a, b, c in exponents(degree)])


@cache
def gram(degree: int, dimension: int) -> fmpq_mat:
    """Integrals of B_a B_b over a simplex of volume 1 (Lai and Schumaker 2007, section 2.11).

    `int B_a B_b = C(a+b, a) / (C(2n, n) C(2n+d, d))`, with the product of the entries' binomials in the numerator.
    """
    indices = homogeneous_exponents(degree, dimension + 1)
    scale = comb(2 * degree, degree) * comb(2 * degree + dimension, dimension)
    return fmpq_mat(
        len(indices),
        len(indices),
        [fmpq(prod(comb(i + j, i) for i, j in zip(a, b, strict=True)), scale) for a in indices for b in indices],
    )


@dataclass(frozen=True, eq=False)
class BoundedForms:
    """The B-coefficients (N, m) of polynomials on N tetrahedra, those of each off by at most `error` (N,)."""

    values: Floats
    degree: int
    error: Floats

    @property
    def size(self) -> Floats:
        """An upper bound (N,) of the coefficients in absolute value."""
        return np.asarray(np.abs(self.values).max(axis=1) + self.error)

    def __add__(self, other: BoundedForms) -> BoundedForms:
        degree = max(self.degree, other.degree)
        first, second = self.raised(degree), other.raised(degree)
        error = first.error + second.error + 2 * UNIT_ROUNDOFF * (first.size + second.size)
        return BoundedForms(first.values + second.values, degree, error)

    def __sub__(self, other: BoundedForms) -> BoundedForms:
        return self + other * -1.0

    def __mul__(self, other: BoundedForms | float) -> BoundedForms:
        """The product with others, or with a number that is a rounded one."""
        if not isinstance(other, BoundedForms):
            return BoundedForms(
                self.values * other, self.degree, abs(other) * (self.error + 4 * UNIT_ROUNDOFF * self.size)
            )
        if len(other.values[0]) > len(self.values[0]):
            return other * self
        where, weights = _terms(self.degree, other.degree)
        result = np.zeros((len(homogeneous_exponents(self.degree + other.degree, 4)), len(self.values)))
        first = np.ascontiguousarray(self.values.T)
        for place, weight, factor in zip(where, weights, other.values.T, strict=True):
            result[place] += weight[:, None] * first * factor
        rounding = 2 * (len(where) + 7) * UNIT_ROUNDOFF * self.size * other.size
        error = self.size * other.error + self.error * other.size + rounding
        return BoundedForms(np.ascontiguousarray(result.T), self.degree + other.degree, error)

    def raised(self, degree: int) -> BoundedForms:
        """These polynomials as of a higher degree."""
        if degree == self.degree:
            return self
        one = np.ones((len(self.values), len(homogeneous_exponents(degree - self.degree, 4))))
        return self * BoundedForms(one, degree - self.degree, np.zeros(len(one)))

    def scaled(self) -> tuple[Floats, float]:
        """Coefficients (N, m) over the largest of each, and by how much one may be off: 1 below `SMALLEST`."""
        largest = np.abs(self.values).max(axis=1)
        known = largest > SMALLEST
        size = np.where(known, largest, 1.0)
        off = np.where(known, self.error / size, 1.0).max(initial=0.0)
        return self.values / size[:, None], float(off) + UNIT_ROUNDOFF


@cache
def _terms(degree: int, other: int) -> tuple[Integers, Floats]:
    """For each multi-index b of the second degree the positions of the first degree's plus b, and weights, (k, m)."""
    first, second = (np.array(homogeneous_exponents(n, 4)) for n in (degree, other))
    whole = degree + other
    binomials = np.array([[comb(n, k) for k in range(whole + 1)] for n in range(whole + 1)], dtype=float)
    number = np.zeros((whole + 1,) * 3, dtype=np.intp)
    number[tuple(np.array(homogeneous_exponents(whole, 4)).T[:3])] = np.arange(comb(whole + 3, 3))
    total = second[:, None] + first
    weights = np.prod(binomials[total, second[:, None]], axis=2) / comb(whole, degree)
    return number[tuple(np.moveaxis(total, 2, 0)[:3])], weights
