"""Planes, cylinders, cones, spheres and tori, told from polynomials by exact algebra.

A polynomial's zeros are such a surface where an identity between its coefficients says so; nothing is fitted, and what
differs from one in the last digit is none.  The numbers of the surface are then rounded to doubles.

With f = x.Ax + 2 b.x + c: the zeros are a quadric of revolution where A = l I + m a.a, so where the
characteristic polynomial of A has a double root l.  They are a torus where f is a multiple of

    (|y|^2 + R^2 - r^2)^2 - 4 R^2 (|y|^2 - (y.a)^2),   y = x - center, |a| = 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.affine import quadratic_form
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import to_float, to_floats
from pas.parametric.generatrix.quadric import inertia, planes_of, rational_zeros


@dataclass(frozen=True)
class Plane:
    """The points with normal.x = height, where `normal` is of length 1."""

    normal: tuple[float, float, float]
    height: float

    @classmethod
    def of(cls, normal: Floats, height: float) -> Plane:
        """The plane with a unit normal (3,)."""
        x, y, z = normal.tolist()
        return cls((x, y, z), float(height))

    def heights(self, points: Floats) -> Floats:
        """How far points (..., 3) are above it (...)."""
        return np.asarray(points @ np.array(self.normal) - self.height)

    def jets(self, points: Floats) -> Floats:
        """Heights and their gradients (N, 4) at points (N, 3)."""
        return np.concatenate([self.heights(points)[:, None], np.broadcast_to(self.normal, points.shape)], axis=1)


class CarrierKind(Enum):
    """The surfaces that every CAD program has."""

    PLANE = "plane"
    CYLINDER = "cylinder"
    CONE = "cone"
    SPHERE = "sphere"
    TORUS = "torus"


@dataclass(frozen=True)
class Carrier:
    """A surface on which a face lies, in doubles.

    `place` (3,) is a point of a plane or of a cylinder's axis, a cone's apex, or the centre; `axis` (3,) the unit
    normal or axis, of a sphere any; `radius` that of a cylinder or sphere, the tangent of a cone's half angle, or a
    torus's major radius; `minor` its minor one.
    """

    kind: CarrierKind
    place: Floats
    axis: Floats
    radius: float = 0.0
    minor: float = 0.0


def carrier_of(polynomial: Polynomial) -> Carrier | None:
    """The plane, quadric of revolution or torus that is the polynomial's zeros; None where they are none of these."""
    if polynomial.degree == 1:
        plane = polynomial.dense(1)
        size = float(np.linalg.norm(plane[1:]))
        return Carrier(CarrierKind.PLANE, -plane[0] / size**2 * plane[1:], plane[1:] / size)
    if polynomial.degree == 2:
        return _quadric(quadratic_form(polynomial))
    torus_degree = 4
    return _torus(polynomial) if polynomial.degree == torus_degree else None


def _quadric(matrix: fmpq_mat) -> Carrier | None:
    """The quadric of revolution of a symmetric matrix (4, 4)."""
    form = fmpq_mat(3, 3, [matrix[i, j] for i in range(3) for j in range(3)])
    slope, constant = fmpq_mat(3, 1, [matrix[i, 3] for i in range(3)]), matrix[3, 3]
    found = _of_revolution(form)
    if found is None:
        return None
    double, single, axis = found
    if double == 0:
        return None
    if single in (double, 0):
        if single == 0 and (axis.transpose() * slope)[0, 0] != 0:
            return None
        center = slope * (-1 / double)
        square = (center.transpose() * center)[0, 0] - constant / double
        kind = CarrierKind.SPHERE if double == single else CarrierKind.CYLINDER
        return Carrier(kind, _floats(center), _unit(axis), to_float(square) ** 0.5) if square > 0 else None
    apex = form.solve(slope * fmpq(-1))
    if single / double > 0 or (slope.transpose() * apex)[0, 0] + constant != 0:
        return None
    return Carrier(CarrierKind.CONE, _floats(apex), _unit(axis), to_float(-single / double) ** 0.5)


def _torus(polynomial: Polynomial) -> Carrier | None:
    terms = polynomial.raw.to_dict()
    lead = terms.get((4, 0, 0), fmpq(0))
    if lead == 0:
        return None
    center = [terms.get(e, fmpq(0)) / (-4 * lead) for e in ((3, 0, 0), (0, 3, 0), (0, 0, 3))]
    moved = polynomial.raw.compose(*(g + c for g, c in zip(GENERATORS, center, strict=True))) / lead
    rest = Polynomial.from_raw(moved - sum(g**2 for g in GENERATORS) ** 2)
    if rest.degree != 2:
        return None
    matrix = quadratic_form(rest)  # with 2 (R^2 - r^2) I - 4 R^2 (I - a.a) and the constant (R^2 - r^2)^2
    found = _of_revolution(fmpq_mat(3, 3, [matrix[i, j] for i in range(3) for j in range(3)]))
    if found is None or any(matrix[i, 3] != 0 for i in range(3)):
        return None
    double, single, axis = found
    major, minor = (single - double) / 4, (single - double) / 4 - single / 2
    if double == single or major <= 0 or minor <= 0 or matrix[3, 3] != (single / 2) ** 2:
        return None
    radii = to_float(major) ** 0.5, to_float(minor) ** 0.5
    at = np.array([to_float(c) for c in center])
    return Carrier(CarrierKind.TORUS, at, _unit(axis), *radii) if radii[1] < radii[0] else None


def _of_revolution(form: fmpq_mat) -> tuple[fmpq, fmpq, fmpq_mat] | None:
    """The double and the other eigenvalue of a symmetric matrix (3, 3), and an eigenvector (3, 1) of the latter."""
    characteristic = form.charpoly()
    common = characteristic.gcd(characteristic.derivative())
    identity = fmpq_mat(3, 3, [fmpq(i == j) for i in range(3) for j in range(3)])
    if common.degree() == 0:
        return None
    root = (-common[0] / common[1]) if common.degree() == 1 else -common[1] / (2 * common[2])
    other = sum((form[i, i] for i in range(3)), fmpq(0)) - 2 * root
    rest = form - identity * root
    axis = next((j for j in range(3) if any(rest[i, j] != 0 for i in range(3))), None)
    column = [fmpq(0), fmpq(0), fmpq(1)] if axis is None else [rest[i, axis] for i in range(3)]
    return root, other, fmpq_mat(3, 1, column)


def reducible_planes(first: Polynomial, second: Polynomial) -> list[Plane]:
    """Planes that hold all common points of two quadrics, where there are such.

    That is so where two planes are a member of the quadrics' pencil: they meet in conics, as cylinders of one radius do
    whose axes cross.
    """
    if not first.degree == second.degree == 2:
        return []
    one, two = quadratic_form(first), quadratic_form(second)
    pairs = [m for m in (one + two * root for root in rational_zeros(one, two)) if inertia(m) == (1, 1)]
    rows = (np.array(to_floats(row)) for pair in pairs for row in planes_of(pair))
    return [Plane.of(row[:3] / size, -row[3] / size) for row in rows if (size := np.linalg.norm(row[:3])) > 0]


def _floats(column: fmpq_mat) -> Floats:
    return np.array([to_float(column[i, 0]) for i in range(3)])


def _unit(column: fmpq_mat) -> Floats:
    vector = _floats(column)
    return np.asarray(vector / np.linalg.norm(vector))
