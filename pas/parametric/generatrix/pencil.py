"""A ruled member of the pencil of two quadrics, and the curve common to both along its straight lines.

Levin (1976): with two quadrics A, B every A + mu B passes through their intersection, and if that is more than
points, one of these is ruled.  Here the member is chosen by the exact inertia of rational 4 x 4 matrices: a pair of
planes, else a cone or cylinder (2, 1), else a quadric (2, 2).  Projectively its straight lines are

    (2, 1): d(a) = e1 cos a + e2 sin a + e3,  through the apex V;
    (2, 2): d(a) = e1 cos a + e2 sin a + e3,  V(a) = -e1 sin a + e2 cos a + e4;

the point d + v V lies on the other quadric where  A(a) v^2 + 2 B(a) v + C(a) = 0, so that
v = (-B +- sqrt(D)) / A with the trigonometric polynomial D = B^2 - A C of degree at most four.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_poly

from pas.algebra.monomials import Floats
from pas.algebra.rational import exact, to_float
from pas.algebra.roots import between, real_roots
from pas.parametric.generatrix.quadric import Inertia, Quadric, QuadricKind, inertia, kind_of, to_array
from pas.parametric.hermite import taylor_basis
from pas.parametric.series import square_root

DEGREE = 4
"""Of D in cos a, sin a."""

PLANES = ((1, 1), (1, 0), (0, 1))


@dataclass(frozen=True)
class Member:
    """A quadric of the pencil as a rational matrix, with its inertia."""

    matrix: fmpq_mat
    inertia: Inertia


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
    """The two quadrics, and a member for each interval and each rational multiple root of det(A + mu B)."""
    a, b = first.matrix, second.matrix
    mixed = (a + b * mu for mu in _candidates(a, b))
    return [Member(m, inertia(m)) for m in (a, b, *mixed)]


def _candidates(a: fmpq_mat, b: fmpq_mat) -> Iterator[fmpq]:
    """Rational zeros of det(A + mu B), then a simple number between neighbouring real ones."""
    places = [fmpq(i) for i in range(5)]
    values = [(a + b * mu).det() for mu in places]
    determinant = sum((taylor_basis(places, i, 0)[0] * v for i, v in enumerate(values)), fmpq_poly([0]))
    if determinant.is_zero():
        yield from (fmpq(n) for n in (1, -1, 2, -2))
        return
    for factor, _ in determinant.factor()[1] if determinant.degree() > 0 else ():
        if factor.degree() == 1:
            yield -factor[0] / factor[1]
    roots = sorted(real_roots(determinant)) if determinant.degree() > 0 else []
    for low, high in pairwise([None, *roots, None]):
        yield between(low, high)


def rulings(first: Quadric, second: Quadric, found: list[Member]) -> Rulings | None:
    """The straight lines of the simplest ruled member; None where there is none (no common curve).

    Preferred are those with closed plane sections, among them the first quadric, then the second, then cones.
    """
    ruled = [m for m in found if m.inertia in ((2, 1), (1, 2), (2, 2))]
    if not ruled:
        return None
    given = [m for m in ruled if m is found[0] or m is found[1]]
    mixed = sorted((m for m in ruled if m not in given), key=lambda m: sum(m.inertia))
    round_ones = QuadricKind.CONE, QuadricKind.CYLINDER, QuadricKind.ONE_SHEET
    member = min([*given, *mixed], key=lambda m: kind_of(m.matrix) not in round_ones)
    other = second if member is not found[1] else first
    return Rulings(_frame(member), member.inertia == (2, 2), to_array(other.matrix))


def _frame(member: Member) -> Floats:
    """Vectors e_i with  sum x_i e_i  on the quadric iff x1^2 + x2^2 = x3^2 (+ x4^2), as rows."""
    q = to_array(member.matrix)
    if member.inertia[0] < member.inertia[1]:
        q = -q
    values, vectors = np.linalg.eigh(q)
    order = np.argsort(-values)
    if member.inertia != (2, 2):  # the one that is zero comes last
        zero = int(np.abs(values).argmin())
        order, values[zero] = np.array([*order[order != zero], zero]), 1.0
    return np.asarray(vectors[:, order].T / np.sqrt(np.abs(values[order]))[:, None])


def planes_of(member: Member) -> list[tuple[fmpq, ...]]:
    """The planes of a member of rank one or two: one or two, exact where they are rational, else rounded to doubles.

    Q = sum d_i (row_i)^2 by completing squares; d1 x^2 - d2 y^2 = 0 are the planes x +- sqrt(d2 / d1) y.
    """
    squares = _squares(member.matrix)
    if len(squares) == 1:
        return [tuple(squares[0][1])]
    (d1, x), (d2, y) = squares
    root = square_root(abs(d2 / d1))
    ratio = exact(to_float(abs(d2 / d1)) ** 0.5) if root is None else root
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
