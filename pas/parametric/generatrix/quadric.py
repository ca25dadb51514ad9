"""Quadrics over the rationals, and pencils of two of them: matrices, inertia and kinds are decided exactly.

f = (x, y, z, 1) Q (x, y, z, 1)^T.  The kinds follow from the numbers of positive and negative eigenvalues of Q and of
its upper left 3 x 3 block (Salmon 1862); all eigenvalues being real, Descartes' rule of signs counts them
without rounding.

With two quadrics A, B every A + mu B passes through their intersection, and if that is more than points, one of these
is ruled (Levin 1976).  It is chosen by its inertia: a pair of planes, else a cone or cylinder (2, 1), else a quadric
(2, 2).  Projectively its straight lines are

    (2, 1): d(a) = e1 cos a + e2 sin a + e3,  through the apex V;
    (2, 2): d(a) = e1 cos a + e2 sin a + e3,  V(a) = -e1 sin a + e2 cos a + e4;

the point d + v V lies on the other quadric where  A(a) v^2 + 2 B(a) v + C(a) = 0, so that
v = (-B +- sqrt(D)) / A with the trigonometric polynomial D = B^2 - A C of degree at most four.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_poly

from pas.algebra.affine import quadratic_form, slope_at
from pas.algebra.brief import brief
from pas.algebra.expressions import as_text
from pas.algebra.inputs import set_fields, short
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Vector, square_root, three, to_floats, to_fraction
from pas.algebra.roots import between, real_roots
from pas.arrays import Floats
from pas.parametric.hermite import taylor_basis

Inertia = tuple[int, int]
"""Numbers of positive and of negative eigenvalues."""


class QuadricKind(Enum):
    """The kinds of real quadrics; the first six are those with closed plane sections."""

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
    """A polynomial of degree two in x, y, z, and its `text` as given; raises `ValueError` or `TypeError` for others."""

    polynomial: Polynomial
    text: str = field(compare=False, repr=False)

    __repr__ = brief

    def __init__(self, expression: PolynomialLike | Quadric, name: str = "the quadric") -> None:
        if isinstance(expression, Quadric):
            expression = expression.text
        polynomial = Polynomial(expression)
        if polynomial.degree != 2:
            raise ValueError(
                f"{name} must be a polynomial of degree 2, not {short(str(polynomial))} of degree {polynomial.degree}"
            )
        set_fields(self, polynomial=within_reach(polynomial), text=as_text(expression) or str(polynomial))

    @cached_property
    def matrix(self) -> fmpq_mat:
        """The symmetric 4 x 4 matrix Q."""
        return quadratic_form(self.polynomial)

    @cached_property
    def kind(self) -> QuadricKind:
        """The kind of the real zero set."""
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
    """The kind of the real zero set of the quadric with this matrix (not only of its last entry)."""
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


def read_plane(plane: PolynomialLike) -> tuple[Vector, fmpq]:
    """Normal n and offset d of the plane n . x = d given by a polynomial of degree one, such as "z - 1".

    The greatest entry of the normal is within `REACH`.
    """
    polynomial = Polynomial(plane)
    if polynomial.degree != 1:
        raise ValueError(f"the plane must be a polynomial of degree 1 such as 'z - 1', not {short(str(polynomial))}")
    normal = slope_at(polynomial)
    greatest = max(map(abs, normal))
    scale = 1 if REACH[0] <= to_fraction(greatest) <= REACH[1] else greatest
    return three(n / scale for n in normal), -polynomial.raw(0, 0, 0) / scale


def to_array(matrix: fmpq_mat) -> Floats:
    """The entries rounded to doubles."""
    return np.array([to_floats(row) for row in matrix.tolist()])


def plane_text(normal: Vector, offset: fmpq) -> str:
    """The plane's equation for a message."""
    x, y, z = normal
    equation = Polynomial({(1, 0, 0): x, (0, 1, 0): y, (0, 0, 1): z, (0, 0, 0): -offset})
    return f"{short(str(equation))} = 0"


PLANES = ((1, 1), (1, 0), (0, 1))

Member = tuple[fmpq_mat, Inertia]
"""A quadric of the pencil as a rational matrix, with its inertia."""


@dataclass(frozen=True)
class Rulings:
    """The straight lines of a ruled quadric and the quadratic equation for v on each (module docstring).

    `frame` holds e1, e2, e3, e4 (or V) as rows; `twisted` tells (2, 2) from (2, 1); `other` is a matrix of the
    quadric to be met.  Coordinates are homogeneous.
    """

    frame: Floats
    twisted: bool
    other: Floats

    def lines(self, angle: Floats) -> tuple[Floats, Floats]:
        """d and V at angles (n,): (n, 4) each."""
        e1, e2, e3, e4 = self.frame
        c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
        last = -s * e1 + c * e2 + e4 if self.twisted else np.broadcast_to(e4, (len(angle), 4))
        return c * e1 + s * e2 + e3, last

    def equation(self, angle: Floats) -> tuple[Floats, Floats, Floats]:
        """A, B, C at angles (n,)."""
        d, v = self.lines(angle)
        q = self.other
        return ((v @ q) * v).sum(axis=1), ((v @ q) * d).sum(axis=1), ((d @ q) * d).sum(axis=1)

    def discriminant(self, angle: Floats) -> Floats:
        """D at angles (n,)."""
        a, b, c = self.equation(angle)
        return b * b - a * c

    def points(self, angle: Floats, root: Floats) -> Floats:
        """Homogeneous points (n, 4) of length one for the value `root` (n,) of the signed square root of D.

        Of the two forms (root - B : A) and (C : -root - B) of v the one that does not cancel is taken.
        """
        a, b, c = self.equation(angle)
        d, v = self.lines(angle)
        first = np.abs(root - b) + np.abs(a) >= np.abs(c) + np.abs(root + b)
        top, bottom = np.where(first, root - b, c), np.where(first, a, -root - b)
        points = bottom[:, None] * d + top[:, None] * v
        return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


def members(first: Quadric, second: Quadric) -> list[Member]:
    """The two quadrics, and members for each rational zero of det(A + mu B) and between neighbouring real ones."""
    a, b = first.matrix, second.matrix
    determinant = _determinant(a, b)
    ends = [] if determinant.is_zero() else pairwise([None, *sorted(real_roots(determinant)), None])
    mixed = (a + b * mu for mu in (*rational_zeros(a, b), *(between(low, high) for low, high in ends)))
    return [(m, inertia(m)) for m in (a, b, *mixed)]


def rational_zeros(a: fmpq_mat, b: fmpq_mat) -> list[fmpq]:
    """The rational mu for which A + mu B is singular; some of them where all are."""
    determinant = _determinant(a, b)
    if determinant.is_zero():
        return [fmpq(n) for n in (1, -1, 2, -2)]
    return [-factor[0] / factor[1] for factor, _ in determinant.factor()[1] if factor.degree() == 1]


def _determinant(a: fmpq_mat, b: fmpq_mat) -> fmpq_poly:
    """det(A + mu B), of degree four at most."""
    places = [fmpq(i) for i in range(5)]
    terms = (taylor_basis(places, i, 0)[0] * (a + b * mu).det() for i, mu in enumerate(places))
    return sum(terms, fmpq_poly([0]))


def rulings(first: Quadric, second: Quadric, found: list[Member]) -> Rulings | None:
    """The straight lines of the simplest ruled member; None where there is none (no common curve).

    Preferred are those with closed plane sections, among them the first quadric, then the second, then cones.
    """
    ruled = [m for m in found if m[1] in ((2, 1), (1, 2), (2, 2))]
    if not ruled:
        return None
    given = [m for m in ruled if m is found[0] or m is found[1]]
    mixed = sorted((m for m in ruled if m not in given), key=lambda m: sum(m[1]))
    round_ones = QuadricKind.CONE, QuadricKind.CYLINDER, QuadricKind.ONE_SHEET
    member = min([*given, *mixed], key=lambda m: kind_of(m[0]) not in round_ones)
    other = second if member is not found[1] else first
    return Rulings(_frame(*member), member[1] == (2, 2), to_array(other.matrix))


def _frame(matrix: fmpq_mat, signs: Inertia) -> Floats:
    """Vectors e_i with  sum x_i e_i  on the quadric iff x1^2 + x2^2 = x3^2 (+ x4^2), as rows."""
    q = to_array(matrix)
    if signs[0] < signs[1]:
        q = -q
    values, vectors = np.linalg.eigh(q)
    order = np.argsort(-values)
    if signs != (2, 2):  # the one that is zero comes last
        zero = int(np.abs(values).argmin())
        order, values[zero] = np.array([*order[order != zero], zero]), 1.0
    return np.asarray(vectors[:, order].T / np.sqrt(np.abs(values[order]))[:, None])


def planes_of(matrix: fmpq_mat) -> list[tuple[fmpq, ...]]:
    """The planes of a matrix of rank one or two: one or two, exact where they are rational, else to 2^-60.

    Q = sum d_i (row_i)^2 by completing squares; d1 x^2 - d2 y^2 = 0 are the planes x +- sqrt(d2 / d1) y.
    """
    squares = _squares(matrix)
    if len(squares) == 1:
        return [tuple(squares[0][1])]
    (d1, x), (d2, y) = squares
    ratio = square_root(abs(d2 / d1))
    return [tuple(a + sign * ratio * b for a, b in zip(x, y, strict=True)) for sign in (1, -1)]


def _squares(matrix: fmpq_mat) -> list[tuple[fmpq, list[fmpq]]]:
    """Lagrange's reduction to squares, for matrices of rank at most two."""
    m, found = matrix, list[tuple[fmpq, list[fmpq]]]()
    while any(c != 0 for c in m.entries()):
        pivot = next((i for i in range(4) if m[i, i] != 0), None)
        if pivot is None:  # no square: with x + y for x there is one
            i, j = next((i, j) for i in range(4) for j in range(4) if m[i, j] != 0)
            row, value = [m[i, k] + m[j, k] for k in range(4)], 2 * m[i, j]
        else:
            row, value = [m[pivot, k] for k in range(4)], m[pivot, pivot]
        found.append((1 / value, row))
        line = fmpq_mat([row])
        m = m - line.transpose() * line * (1 / value)
    return found
