"""Planes, cylinders, cones, spheres and tori, told from polynomials by exact algebra.

A polynomial's zeros are such a surface where an identity between its coefficients says so; nothing is fitted, and what
differs from one in the last digit is none.  The numbers of the surface are then rounded to doubles.

With f = x.Ax + 2 b.x + c: the zeros are a quadric of revolution where A = l I + m a.a, so where the
characteristic polynomial of A has a double root l.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from flint import fmpq_mat

from pas.algebra.affine import quadratic_form
from pas.algebra.lengths import unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import dot, three, to_float, to_floats
from pas.arrays import Floats
from pas.contacts.parallels import axis_of_revolution
from pas.contacts.torus import torus_of
from pas.parametric.generatrix.quadric import inertia, planes_of, rational_zeros

LEAST = 1e-7
"""Open Cascade's smallest tolerance."""


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
    rows = matrix.tolist()
    form, slope, constant = fmpq_mat([row[:3] for row in rows[:3]]), three(row[3] for row in rows[:3]), rows[3][3]
    found = axis_of_revolution(form)
    if found is None:
        return None
    double, single, axis = found
    way = unit(to_floats(axis))
    if double == 0:
        return None
    if single in (double, 0):
        if single == 0 and dot(axis, slope) != 0:
            return None
        center = three(-c / double for c in slope)
        square = dot(center, center) - constant / double
        kind = CarrierKind.SPHERE if double == single else CarrierKind.CYLINDER
        return Carrier(kind, np.array(to_floats(center)), way, to_float(square) ** 0.5) if square > 0 else None
    apex = three(form.solve(fmpq_mat(3, 1, [-c for c in slope])).entries())
    if single / double > 0 or dot(slope, apex) + constant != 0:
        return None
    return Carrier(CarrierKind.CONE, np.array(to_floats(apex)), way, to_float(-single / double) ** 0.5)


def _torus(polynomial: Polynomial) -> Carrier | None:
    found = torus_of(polynomial)
    if found is None:
        return None
    major, minor = to_float(found.major2) ** 0.5, to_float(found.minor2) ** 0.5
    where = np.array(to_floats(found.center)), unit(to_floats(found.axis))
    return Carrier(CarrierKind.TORUS, *where, major, minor) if minor < major else None


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
