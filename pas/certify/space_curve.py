"""Space curves V(f, d) in a region: where they are proved not to be, and points proved to be on them.

A point is proved by a parallelogram around it on whose opposite sides f, and on whose other two d,
have opposite signs: there is a common zero in it (Miranda 1940).  A sign that a polynomial has on all
of the parallelogram it has at that zero.  These signs are exact, by B-coefficients over the rationals;
where the parallelogram is laid is found in floating point, by Newton's method.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from flint import fmpq_mpoly
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, homogeneous_exponents
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, exact_vector, to_floats
from pas.bernstein.forms import b_form, on_simplex, rounded_forms
from pas.bernstein.signs import prove_apart, prove_positive
from pas.partition.cells import Partition
from pas.verdicts import Status

START_LATTICE = 4
"""Subdivisions of a cell's edge for the points at which Newton's method starts."""

REACHES = (1.0, 8.0, 64.0)
"""Half sizes of the cubes in which points of the curve are looked for where there is no region."""

NEWTON_STEPS, ARRIVED = 24, 1e-10
"""Steps of Newton's method, and the last one's length at which it has arrived (local units)."""

HALF_SIDES = (2.0**-20, 2.0**-28, 2.0**-12)
"""Half sides of the parallelograms, tried in turn: small, since signs must not change on them, and
large against the 1e-15 that the middle is off the curve."""

PARALLEL = 1e-12
"""The squared sine of the angle between gradients from which on they count as parallel."""

MOST_TRIED = 12
"""Points that are tried for one proof, those that promise most first."""


@dataclass(frozen=True)
class Enclosure:
    """A parallelogram (its corners in cyclic order) with a common zero of two polynomials in it."""

    middle: Floats
    corners: tuple[Vector, Vector, Vector, Vector]

    def sign(self, polynomial: fmpq_mpoly) -> int:
        """1 or -1 where a polynomial has that sign on all of it, else 0."""
        a, b, c, e = self.corners
        return _sign(polynomial, ((a, b, c), (a, c, e)))


class Curve:
    """The curve V(f, d) in a region, or in all of space where there are no cells."""

    def __init__(self, f: Polynomial, d: Polynomial, partition: Partition) -> None:
        self.f, self.d, self.partition = f, d, partition

    def closed(self) -> bool:
        """Whether the curve is proved not to meet the region's boundary."""
        faces = [face.vertices for face in self.partition.outer_faces]
        exact = [self.partition.corners(face) for face in faces]
        zeros = [rounded_forms(p.raw, exact) for p in (self.f, self.d)]
        return prove_apart(zeros, self.partition.points[np.array(faces)]).status is Status.PROVED

    def positive(self, value: Polynomial) -> bool:
        """Whether a polynomial is proved positive on the curve."""
        exact = [self.partition.corners(cell) for cell in self.partition.cells]
        value_forms, *zeros = (rounded_forms(p.raw, exact) for p in (value, self.f, self.d))
        points = self.partition.points[np.array(self.partition.cells)]
        return prove_positive(value_forms, points, zeros).status is Status.PROVED

    def enclosures(self, size: Polynomial | None = None) -> Iterator[Enclosure]:
        """Proved points of the curve in the region; those first where `size` is largest, if it is positive."""
        points = self.points
        if size is not None:
            values = _scaled(size)(points)
            points = points[np.argsort(-values)][: np.count_nonzero(values > 0)]
        for point in points[:MOST_TRIED]:
            for half in HALF_SIDES:
                enclosure = self.enclosure(point, half)
                if enclosure is not None:
                    yield enclosure

    def enclosure(self, point: Floats, half: float) -> Enclosure | None:
        """A parallelogram around a point with half sides `half`, if it is proved to be in the region and to hold
        a common zero of f and d."""
        along_f, along_d, _ = _dual(_scaled(self.f).gradient(point[None]), _scaled(self.d).gradient(point[None]))
        p, u, w = (exact_vector(v.tolist()) for v in (point, *(half * _unit(a[0]) for a in (along_f, along_d))))
        a, b, c, e = (_moved(p, u, s, w, t) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
        f, d = self.f.raw, self.d.raw
        met = _sign(f, [(a, e)]) < 0 < _sign(f, [(b, c)]) and _sign(d, [(a, b)]) < 0 < _sign(d, [(c, e)])
        return Enclosure(point, (a, b, c, e)) if met and self._holds((a, b, c, e)) else None

    @property
    def points(self) -> Floats:
        """Points (m, 3) on the curve and in the region, up to rounding, by Newton's method."""
        f, d = _scaled(self.f), _scaled(self.d)
        points = self._starts()
        reach = 4 * float(np.abs(points).max())
        for _ in range(NEWTON_STEPS):
            along_f, along_d, regular = _dual(f.gradient(points), d.gradient(points))
            step = f(points)[:, None] * along_f + d(points)[:, None] * along_d
            kept = regular & (np.abs(points - step).max(axis=1) < reach)
            points, step = (points - step)[kept], step[kept]
        points = points[np.linalg.norm(step, axis=1) < ARRIVED]
        inside = self.partition.locate(points) >= 0 if self.partition.cells else np.full(len(points), True)
        return points[inside]

    def _starts(self) -> Floats:
        corners = self.partition.points[np.array(self.partition.cells)] if self.partition.cells else _cubes()
        vertices = corners.shape[1]
        weights = np.array(homogeneous_exponents(START_LATTICE, vertices)) / START_LATTICE
        return np.unique((weights @ corners).reshape(-1, 3), axis=0)

    def _holds(self, corners: tuple[Vector, ...]) -> bool:
        """Whether the hull of some points is proved to be in the region.

        It is if it is in one cell, or on the inner side of the planes of all outer faces.
        """
        if not self.partition.cells:
            return True
        near = self.partition.locate(np.array([to_floats(c) for c in corners]), tolerance=np.inf)
        around = [face.plane for face in self.partition.outer_faces]
        return any(
            all(plane.raw(*c) <= 0 for plane in planes for c in corners)
            for planes in (self.partition.planes(int(near[0])), around)
        )


def _sign(polynomial: fmpq_mpoly, simplices: Sequence[Sequence[Vector]]) -> int:
    """1 or -1 where all B-coefficients on some simplices have that sign, else 0."""
    degree = max(int(polynomial.total_degree()), 0)
    values = [v for s in simplices for v in b_form(on_simplex(polynomial, s), degree, len(s) - 1)]
    return 1 if min(values) > 0 else -1 if max(values) < 0 else 0


def _dual(f: Floats, d: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """The vectors in the span of two gradients (N, 3) along which one function rises by 1 and the other stays.

    And where they exist, (N,): where the gradients are not parallel.
    """
    ff, fd, dd = ((a * b).sum(axis=1, keepdims=True) for a, b in ((f, f), (f, d), (d, d)))
    determinant = ff * dd - fd * fd
    regular = determinant > PARALLEL * ff * dd
    scale = np.where(regular, determinant, 1.0)
    return (dd * f - fd * d) / scale, (ff * d - fd * f) / scale, regular[:, 0]


def _scaled(polynomial: Polynomial) -> Polynomial:
    """The multiple of largest absolute coefficient 1."""
    return Polynomial.from_raw(polynomial.raw * (1 / max(abs(c) for c in polynomial.raw.coeffs())))


def _cubes() -> Floats:
    """The corners of cubes around the origin, cut into no cells: (cubes, 8, 3)."""
    corners = np.array(list(product((-1.0, 1.0), repeat=3)))
    return np.array([reach * corners for reach in REACHES])


def _moved(p: Vector, u: Vector, s: int, w: Vector, t: int) -> Vector:
    x, y, z = (a + s * b + t * c for a, b, c in zip(p, u, w, strict=True))
    return x, y, z


def _unit(v: Floats) -> Floats:
    return v / np.linalg.norm(v)
