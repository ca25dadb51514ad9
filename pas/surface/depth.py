"""The depths of points inside a surface: their distances from it, along straight lines that meet it at right angles.

A point's foot begins at the nearest of some thousand points of the surface, and goes on by Newton's method on the
polynomial of the piece that this one lies in, and then of the piece that it came into.  With the depth d of a point
below its foot and the shape operator S there, a foot that moves by u along the surface moves what lies d below it by
`u - d S u`.

Beyond a clip the contact's own surface takes its place.

Guaranteed: nothing; this is a measure, for what is fitted and for what is told.  Where the nearest foot jumps, as on
the axis of a pipe, so does the normal.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from pas.algebra.rational import to_float
from pas.arrays import Floats, Integers
from pas.surface.directions import Directions
from pas.surface.geometry import FIRST, SECOND, derivative_batch, tangent_frame

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

    from pas.surface.function import PiecewisePolynomial


class Depth:
    """The depths of points inside a surface that is seen from a centre, all in the user's units."""

    def __init__(self, surface: PiecewisePolynomial) -> None:
        samples = 2000  # points of the surface among which the nearest is looked for
        self._frame, columns = surface.partition.frame, surface.evaluator.columns
        rays = Directions.of(surface.placed, columns, surface.degree, samples)
        self._samples = rays.directions * rays.distances[:, None]
        self._numbers = rays.pieces
        self._location, self._tolerance = surface.local.location, surface.evaluator.tolerance
        self._joins = surface.joins
        ends = [join.contact.surface for join in surface.joins]
        self._batch = derivative_batch([*columns, *(end.dense(end.degree) for end in ends)], (0, 1, 2))

    @cached_property
    def samples(self) -> Floats:
        """Points (N, 3) of the surface, all over what is in use of it."""
        return self._frame.global_points(self._samples)

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(self._samples)

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """Depths (N,) of points (N, 3), negative outside, and the unit normals (N, 3) outwards at their feet.

        The depth of a point changes with it by the negative normal.
        """
        local = self._frame.local_points(points)
        _, nearest = self._tree.query(local)
        numbers, starts = self._numbers[nearest], self._samples[nearest]
        reach = np.linalg.norm(local - starts, axis=1)
        feet, normals = self._feet(local, starts, numbers)
        pieces = self._location.pieces(np.ascontiguousarray(feet.T), self._tolerance)
        other = np.flatnonzero((pieces >= 0) & (pieces != numbers))  # their feet crossed into a neighbour
        feet[other], normals[other] = self._feet(local[other], feet[other], pieces[other])
        first = len(self._batch.degrees) - len(self._joins)
        for number, join in enumerate(self._joins, start=first):
            here = np.flatnonzero(np.isin(numbers, join.pieces))
            found, across = self._feet(local[here], starts[here], np.full(len(here), number))
            beyond = (join.contact.clip(found) > 0) & (np.linalg.norm(local[here] - found, axis=1) <= reach[here])
            feet[here[beyond]], normals[here[beyond]] = found[beyond], across[beyond]
        return -((local - feet) * normals).sum(axis=1) * to_float(self._frame.scale), normals

    def _feet(self, points: Floats, near: Floats, numbers: Integers) -> tuple[Floats, Floats]:
        """The feet (N, 3) of local points on pieces of given numbers (N,), or the contacts' surfaces after these, from
        places near by, and the unit normals (N, 3) there."""
        steps, enough = 8, 1e-6  # a step as short as this, in local units, is the last: the next would be its square
        longest = 0.2  # in local units: at focal points Newton's step has no bound
        target, feet, normals = points.T, near.T, np.zeros(points.T.shape)
        for _ in range(steps if len(points) else 0):
            jet = self._batch(feet.T, numbers).T
            length = np.sqrt((jet[FIRST] * jet[FIRST]).sum(axis=0))
            normals, bending = jet[FIRST] / length, jet[SECOND] / length
            off = target - feet
            depths = -(off * normals).sum(axis=0)
            step = _tangential(off, depths, normals, bending) - jet[0] / length * normals
            lengths = np.sqrt((step * step).sum(axis=0))
            feet = feet + step * np.minimum(1.0, longest / np.maximum(lengths, enough))
            if lengths.max() < enough:
                break
        return feet.T, normals.T


def _tangential(off: Floats, depths: Floats, normals: Floats, bending: Floats) -> Floats:
    """The u (3, N) across the normals with `u - d S u` the part of `off` across them, S that of `bending` (3, 3, N)."""
    focal = 0.9  # depth times curvature counts as no more than this: it is 1 at focal points
    first, second = tangent_frame(normals)
    along, across = ((bending * t).sum(axis=1) for t in (first, second))
    s11, s12, s22 = ((a * b).sum(axis=0) for a, b in ((along, first), (along, second), (across, second)))
    most = focal / np.maximum(np.sqrt(s11 * s11 + 2 * s12 * s12 + s22 * s22), 1e-30)
    d = np.clip(depths, -most, most)
    p, q, r = 1 - d * s11, -d * s12, 1 - d * s22
    u, v = ((off * t).sum(axis=0) for t in (first, second))
    determinant = p * r - q * q
    return ((r * u - q * v) * first + (p * v - q * u) * second) / determinant
