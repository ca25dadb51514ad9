"""How deep points lie inside a surface: their distances from it, along straight lines that meet it at right angles.

A point's foot begins at the nearest of some thousand points of the surface, and goes on by Newton's method on the
polynomial of the piece that this one lies in.  With the depth d of a point below its foot and the shape operator S
there, a foot that moves by u along the surface moves what lies d below it by `u - d S u`.

Beyond a clip the contact's own surface takes its place.

Guaranteed: nothing; this is a measure, for what is fitted and for what is told.  Where the nearest foot jumps, as on
the axis of a pipe, so does the normal.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from pas.algebra.monomials import Floats, monomial_values
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float, to_floats
from pas.surface.directions import Directions
from pas.surface.geometry import FIRST, SECOND, derived, tangent_frame

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

    from pas.surface.function import PiecewisePolynomial

SAMPLES = 2000
"""Points of the surface among which the nearest is looked for."""

STEPS, ENOUGH = 8, 1e-6
"""Newton steps at the most; a step as short as this, in local units, is the last: the next would be its square."""

LONGEST, FOCAL = 0.2, 0.9
"""A step is no longer than the first, in local units, and depth times curvature counts as no more than the other: at
focal points Newton's step has no bound."""


class Depth:
    """The depths of points inside a surface that is seen from a centre, all in the user's units."""

    def __init__(self, surface: PiecewisePolynomial) -> None:
        frame = surface.partition.frame
        self._origin, self._scale = np.array(to_floats(frame.origin)), to_float(frame.scale)
        self._pieces = [Sheet.of(patch, surface.degree) for patch in surface.scaled.polynomials]
        columns = [piece.column for piece in self._pieces]
        rays = Directions.of(surface.placed, columns, surface.degree, SAMPLES)
        self._samples = rays.directions * rays.distances[:, None]
        self._numbers = np.concatenate([np.full(here.stop - here.start, piece) for piece, here in rays.slices])
        self._ends = [
            [(join.contact.clip, Sheet.of(join.contact.surface)) for join in surface.joins if number in join.pieces]
            for number in range(len(self._pieces))
        ]

    @cached_property
    def samples(self) -> Floats:
        """Points (N, 3) of the surface, all over what is in use of it."""
        return self._origin + self._scale * self._samples

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(self._samples)

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """Depths (N,) of points (N, 3), negative outside, and the unit normals (N, 3) outwards at their feet.

        The depth of a point changes with it by the negative normal.
        """
        local = (points - self._origin) / self._scale
        _, nearest = self._tree.query(local)
        numbers, starts = self._numbers[nearest], self._samples[nearest]
        reach = np.linalg.norm(local - starts, axis=1)
        feet, normals = np.empty_like(local), np.empty_like(local)
        for number in np.unique(numbers).tolist():
            here = np.flatnonzero(numbers == number)
            feet[here], normals[here] = self._pieces[number].feet(local[here], starts[here])
            for clip, sheet in self._ends[number]:
                found, across = sheet.feet(local[here], starts[here])
                beyond = (clip(found) > 0) & (np.linalg.norm(local[here] - found, axis=1) <= reach[here])
                feet[here[beyond]], normals[here[beyond]] = found[beyond], across[beyond]
        return -((local - feet) * normals).sum(axis=1) * self._scale, normals


@dataclass(frozen=True, eq=False)
class Sheet:
    """One polynomial surface in local coordinates: its coefficients and degree."""

    column: Floats
    degree: int

    @classmethod
    def of(cls, polynomial: Polynomial, degree: int | None = None) -> Sheet:
        """That of a polynomial, which may be of lower degree than its neighbours."""
        degree = polynomial.degree if degree is None else degree
        return cls(polynomial.dense(degree), degree)

    def feet(self, points: Floats, near: Floats) -> tuple[Floats, Floats]:
        """The feet (N, 3) of points, from places near by, and the unit normals (N, 3) there."""
        target, feet, normals = points.T, near.T, np.zeros(points.T.shape)
        for _ in range(STEPS if len(points) else 0):
            jet = self._forms @ monomial_values(feet.T, self.degree)
            length = np.sqrt((jet[FIRST] * jet[FIRST]).sum(axis=0))
            normals, bending = jet[FIRST] / length, jet[SECOND] / length
            off = target - feet
            depths = -(off * normals).sum(axis=0)
            step = _tangential(off, depths, normals, bending) - jet[0] / length * normals
            lengths = np.sqrt((step * step).sum(axis=0))
            feet = feet + step * np.minimum(1.0, LONGEST / np.maximum(lengths, ENOUGH))
            if lengths.max() < ENOUGH:
                break
        return feet.T, normals.T

    @cached_property
    def _forms(self) -> Floats:
        """The coefficients of value, gradient and second derivatives: (10, C(n+3, 3))."""
        return derived(self.column, self.degree)[: 1 + SECOND.max()]


def _tangential(off: Floats, depths: Floats, normals: Floats, bending: Floats) -> Floats:
    """The u (3, N) across the normals with `u - d S u` the part of `off` across them, S that of `bending` (3, 3, N)."""
    first, second = tangent_frame(normals)
    along, across = ((bending * t).sum(axis=1) for t in (first, second))
    s11, s12, s22 = ((a * b).sum(axis=0) for a, b in ((along, first), (along, second), (across, second)))
    most = FOCAL / np.maximum(np.sqrt(s11 * s11 + 2 * s12 * s12 + s22 * s22), 1e-30)
    d = np.clip(depths, -most, most)
    p, q, r = 1 - d * s11, -d * s12, 1 - d * s22
    u, v = ((off * t).sum(axis=0) for t in (first, second))
    determinant = p * r - q * q
    step: Floats = ((r * u - q * v) * first + (p * v - q * u) * second) / determinant
    return step
