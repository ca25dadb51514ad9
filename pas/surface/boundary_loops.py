"""Boundary loops: the closed curves on which a surface ends, each a graph over the angle about its middle.

One lies in the plane of a clip, or it is that through which a region is open, where the surface cuts the nappe of a
cone with its apex in 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from pas.algebra.bracket import Jets
from pas.algebra.lengths import across
from pas.algebra.polynomial import Polynomial
from pas.arrays import Bools, Floats, Integers
from pas.contacts.cones import first_met, nappe_rays
from pas.contacts.joins import Join
from pas.mesh.rows import along_lines, dots, norms, off_zero
from pas.surface.geometry import derivative_batch

STEPS = 40
"""The most steps of Newton's method along rays towards a loop, none by more than a factor of two."""

SETTLED = 1e-9
"""Change of the share of a ray that ends that: the next is about its square."""


@dataclass(frozen=True, eq=False)
class ConeLoop:
    """The curve on `surface` along the nappe with the axes (3, 3) of `pas.contacts.cones.nappe`, of the cone `clip`.

    In the plane of a plate or in none, it is a graph over the angle about the axis.
    """

    surface: Polynomial
    clip: Polynomial
    axes: Floats
    opening: ClassVar[bool] = True

    @cached_property
    def normal(self) -> Floats:
        """The unit vector (3,) along the axis, outwards."""
        return np.asarray(self.axes[0] / np.sqrt(self.axes[0] @ self.axes[0]))

    @cached_property
    def middle(self) -> Floats:
        """The point (3,) of the axis in the middle of the curve's height."""
        rays = 64  # a curve's height is that of a polynomial of low degree in the angle, near enough
        return np.asarray(float((self.round(rays) @ self.normal).mean()) * self.normal)

    def round(self, number: int) -> Floats:
        """A `number` of points (N, 3) in turn; raises `ArithmeticError` where rays do not meet the surface."""
        rays = nappe_rays(self.axes, number)
        met = first_met(self.surface, rays)
        if not np.isfinite(met).all():
            raise ArithmeticError("the cone around an opening leaves its surface")
        return np.asarray(rays * met[:, None])

    def at(self, points: Floats) -> Floats:
        """Where the rays of the nappe at the angles of points (N, 3) meet the surface, found from there."""
        aside = np.linalg.solve(self.axes.T, points.T)[1:]
        aside = aside / np.maximum(np.sqrt((aside * aside).sum(axis=0)), 1e-300)
        rays = self.axes[0] + aside.T @ self.axes[1:]
        jets = along_lines(lambda here, _: self.surface.jets(here), np.zeros_like(rays), rays)
        return np.asarray(rays * _settled(jets, dots(points, rays) / dots(rays, rays))[:, None])

    def distances(self, points: Floats) -> Floats:
        """Distances (N,) of points from those of the curve at the same angles."""
        return norms(self.at(points) - points)

    def off(self, points: Floats) -> Floats:
        """How far points (N, 3) are from the surface and the cone, to first order."""
        first, second = (off_zero(p(points), p.gradient(points)) for p in (self.surface, self.clip))
        return first + second

    def inside(self, units: Floats) -> Bools:
        """Which rays (N, 3) from 0 pass through the curve."""
        return np.asarray((self.clip(units) <= 0) & (units @ self.normal > 0))


@dataclass(frozen=True)
class PlaneLoop:
    """A closed curve around `middle` (3,), in the plane through it with the unit `normal` (3,) pointing outwards.

    `column` (C(n+3, 3),) are the coefficients of its function; `size` is its largest radius.
    """

    middle: Floats
    normal: Floats
    column: Floats
    size: float
    opening: ClassVar[bool] = False

    @cached_property
    def _alone(self) -> Loops:
        return Loops([self])

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) of its function at points (N, 3)."""
        return self._alone.jets(points, np.zeros(len(points), dtype=np.intp))

    def at(self, points: Floats) -> Floats:
        """Where the rays from the middle through points (N, 3) near the plane meet the curve."""
        return self._alone.at(points, np.zeros(len(points), dtype=np.intp))

    def round(self, number: int) -> Floats:
        """A `number` of points (N, 3) at equal angles, counterclockwise seen from outside."""
        first = self.size * across(self.normal)[0]
        second = np.cross(self.normal, first)
        angles = 2 * np.pi * np.arange(number)[:, None] / number
        return self.at(self.middle + np.cos(angles) * first + np.sin(angles) * second)

    def distances(self, points: Floats) -> Floats:
        """Distances (N,) of points in the plane from the curve, to first order."""
        return self._alone.distances(points, np.zeros(len(points), dtype=np.intp))

    def off(self, points: Floats) -> Floats:
        """How far points (N, 3) are from the curve, out of its plane or in it, to first order."""
        return self.distances(points) + np.abs((points - self.middle) @ self.normal)

    def inside(self, units: Floats) -> Bools:
        """Which rays (N, 3) from 0 pass through the curve."""
        offset = float(self.middle @ self.normal)
        along = units @ self.normal
        with np.errstate(all="ignore"):
            way = units * (offset / along)[:, None] - self.middle
        near = (along > 0) & ((way * way).sum(axis=1) < (1.01 * self.size) ** 2)
        edge = self.at(self.middle + np.where(near[:, None], way, self.size * across(self.normal)[0]))
        return np.asarray(near & ((way * way).sum(axis=1) <= ((edge - self.middle) ** 2).sum(axis=1)))


BoundaryLoop = PlaneLoop | ConeLoop


class Loops:
    """Several loops, for points each of which belongs to one of them."""

    def __init__(self, curves: Sequence[BoundaryLoop]) -> None:
        self._openings = {number: curve for number, curve in enumerate(curves) if isinstance(curve, ConeLoop)}
        loops = [curve for curve in curves if isinstance(curve, PlaneLoop)]
        self._flat = np.array([isinstance(curve, PlaneLoop) for curve in curves], dtype=bool)
        self._place = np.cumsum(self._flat, dtype=np.intp) - 1
        self._middles = np.array([loop.middle for loop in loops]).reshape(-1, 3)
        self._normals = np.array([loop.normal for loop in loops]).reshape(-1, 3)
        self.jets = derivative_batch([loop.column for loop in loops], (0, 1))

    def at(self, points: Floats, numbers: Integers) -> Floats:
        """Where rays from the middles of curves of given numbers (N,) through points (N, 3) meet these."""
        result, flat = np.empty_like(points), self._flat[numbers]
        places = self._place[numbers[flat]]
        middles, normals = self._middles.take(places, axis=0), self._normals.take(places, axis=0)
        ways = points[flat] - middles
        ways = ways - dots(ways, normals)[:, None] * normals
        jets = along_lines(lambda here, rows: self.jets(here, places[rows]), middles, ways)
        result[flat] = middles + _settled(jets, np.ones(len(ways)))[:, None] * ways
        for number, curve in self._openings.items():
            result[numbers == number] = curve.at(points[numbers == number])
        return result

    def distances(self, points: Floats, numbers: Integers) -> Floats:
        """Distances (N,) of points from curves of given numbers (N,), in whose planes they are."""
        result, flat = np.empty(len(points)), self._flat[numbers]
        places = self._place[numbers[flat]]
        jets, normals = self.jets(points[flat], places), self._normals.take(places, axis=0)
        slopes = jets[:, 1:] - dots(jets[:, 1:], normals)[:, None] * normals
        result[flat] = off_zero(jets[:, 0], slopes)
        for number, curve in self._openings.items():
            result[numbers == number] = curve.distances(points[numbers == number])
        return result


def _settled(jets: Jets, shares: Floats) -> Floats:
    """Where functions of the shares of rays (N,), rising there, are 0, by Newton's method from near by."""
    rows = np.arange(len(shares))
    for _ in range(STEPS):
        here = shares[rows]
        values, slopes = jets(here, rows)
        rising = slopes > 0
        found = np.where(rising, here - values / np.where(rising, slopes, 1.0), np.inf)
        found = np.minimum(np.maximum(found, here / 2), here * 2)
        shares[rows] = found
        rows = rows[~(np.abs(found - here) < SETTLED * found)]
        if not len(rows):
            break
    return shares


def boundary_loops(joins: Sequence[Join]) -> list[BoundaryLoop]:
    """The curves on which surfaces with contacts in place end; raises `ArithmeticError` where one is no graph over the
    angle."""
    found: list[BoundaryLoop] = []
    for join in joins:
        if join.opening:
            found.append(ConeLoop(join.contact.surface, join.contact.clip, join.nappe))
            continue
        if not join.faces:
            continue
        column = join.contact.surface.dense(join.contact.surface.degree)
        curves = [points for points, _ in join.measured_curves()]
        for plane in join.planes:
            curve = np.concatenate([c for c, face in zip(curves, join.faces, strict=True) if face in plane.faces])
            if len(curve):
                found.append(_plane_loop(curve, plane.plane, column))
    return found


def _plane_loop(curve: Floats, plane: Polynomial, column: Floats) -> PlaneLoop:
    normal = plane.dense(1)[1:4]
    offset = -plane.dense(1)[0] / np.sqrt(normal @ normal)
    normal = normal / np.sqrt(normal @ normal)
    middle = (curve.min(axis=0) + curve.max(axis=0)) / 2
    middle = middle + (offset - middle @ normal) * normal
    size = float(np.sqrt(((curve - middle) ** 2).sum(axis=1).max()))
    most = 1e-9 * size  # how far points may be from the curve that is a graph over the angle
    loop = PlaneLoop(middle, normal, column, size)
    with np.errstate(all="ignore"):
        ends = loop.at(np.concatenate([curve, loop.round(64)]))
        off = loop.jets(ends)
        lost = np.abs(off[:, 0]) > most * np.sqrt((off[:, 1:] ** 2).sum(axis=1))
        apart = np.sqrt(((ends[: len(curve)] - curve) ** 2).sum(axis=1)) > most
    if not np.isfinite(ends).all() or lost.any() or apart.any() or loop.jets(middle[None])[0, 0] >= 0:
        raise ArithmeticError("a contact curve is not one graph over the angle about its middle")
    return loop
