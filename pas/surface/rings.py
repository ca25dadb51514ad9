"""The closed curves on which a surface ends: each in the plane of a clip, a graph over the angle about its middle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from pas.algebra.evaluation import PolynomialBatch, evaluate
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.kernels.library import compiled
from pas.mesh.field import Integers
from pas.surface.opening_rim import OpeningRim

if TYPE_CHECKING:
    from pas.contacts.joins import Join

STEPS = 40
"""Of Newton's method towards the middle of a curve or away from it, none by more than a factor of two."""

SETTLED = 1e-9
"""Change of the share of a way from a middle that ends that: the next is about its square."""

OFF = 1e-9
"""Over a curve's size: how far points may be from the curve that is a graph over the angle."""


@dataclass(frozen=True)
class Ring:
    """A closed curve around `middle` (3,), in the plane through it with the unit `normal` (3,) pointing outwards.

    `columns` (C(n+3, 3), 4) are the coefficients of its function and of the derivatives; `size` its largest radius.
    """

    middle: Floats
    normal: Floats
    columns: Floats
    size: float
    fixed: ClassVar[bool] = False
    opening: ClassVar[bool] = False

    @cached_property
    def _alone(self) -> Rings:
        return Rings([self])

    def at(self, points: Floats) -> Floats:
        """Where the rays from the middle through points (N, 3) near the plane meet the curve."""
        return self._alone.at(points, np.zeros(len(points), dtype=np.intp))

    def round(self, number: int) -> Floats:
        """So many points (N, 3) at equal angles, counterclockwise seen from outside."""
        first = np.eye(3)[np.abs(self.normal).argmin()]
        first = first - (first @ self.normal) * self.normal
        first *= self.size / np.sqrt(first @ first)
        second = np.cross(self.normal, first)
        angles = 2 * np.pi * np.arange(number)[:, None] / number
        return self.at(self.middle + np.cos(angles) * first + np.sin(angles) * second)

    def distances(self, points: Floats) -> Floats:
        """Distances (N,) of points in the plane from the curve, to first order."""
        jets = self._alone.jets(points, np.zeros(len(points), dtype=np.intp))
        slope = jets[:, 1:] - np.outer(jets[:, 1:] @ self.normal, self.normal)
        return np.asarray(np.abs(jets[:, 0]) / np.maximum(np.sqrt((slope * slope).sum(axis=1)), 1e-300))

    def off(self, points: Floats) -> Floats:
        """How far points (N, 3) are from the curve, out of its plane or in it, to first order."""
        return self.distances(points) + np.abs((points - self.middle) @ self.normal)

    def inside(self, units: Floats) -> np.ndarray:
        """Which rays (N, 3) from 0 pass through the curve."""
        offset = float(self.middle @ self.normal)
        along = units @ self.normal
        with np.errstate(all="ignore"):
            way = units * (offset / along)[:, None] - self.middle
        near = (along > 0) & ((way * way).sum(axis=1) < (1.01 * self.size) ** 2)
        edge = self.at(self.middle + np.where(near[:, None], way, self.size * _across(self.normal)))
        return np.asarray(near & ((way * way).sum(axis=1) <= ((edge - self.middle) ** 2).sum(axis=1)))


class Rings:
    """Several closed curves, for points each of which belongs to one of them."""

    def __init__(self, curves: Sequence[Ring | OpeningRim]) -> None:
        self._openings = {number: curve for number, curve in enumerate(curves) if isinstance(curve, OpeningRim)}
        rings = [curve for curve in curves if isinstance(curve, Ring)]
        self._place = np.cumsum([isinstance(curve, Ring) for curve in curves]) - 1
        self._middles = np.array([ring.middle for ring in rings]).reshape(-1, 3)
        self._normals = np.array([ring.normal for ring in rings]).reshape(-1, 3)
        self._batch = PolynomialBatch.of([[*ring.columns.T] for ring in rings], 4)

    def jets(self, points: Floats, numbers: Integers) -> Floats:
        """Values and gradients (N, 4) of the functions of curves of given numbers (N,) at points (N, 3)."""
        return self._batch(points, numbers)

    def at(self, points: Floats, numbers: Integers) -> Floats:
        """Where rays from the middles of curves of given numbers (N,) through points (N, 3) meet these."""
        if self._openings:
            result = np.empty_like(points)
            flat = ~np.isin(numbers, list(self._openings))
            result[flat] = self._on_rings(points[flat], self._place[numbers[flat]])
            for number, curve in self._openings.items():
                result[numbers == number] = curve.at(points[numbers == number])
            return result
        return self._on_rings(points, numbers)

    def _on_rings(self, points: Floats, numbers: Integers) -> Floats:
        """Where rays from the middles of rings, of given numbers (N,) among these, through points (N, 3) meet them."""
        result = np.empty((len(points), 3))
        given = (len(self._middles), *self._batch.arrays, self._middles, self._normals, len(points), points, numbers)
        compiled().call("pas_on_rings", *given, STEPS, SETTLED, result)
        return result


def _across(normal: Floats) -> Floats:
    first = np.eye(3)[np.abs(normal).argmin()]
    first = first - (first @ normal) * normal
    return np.asarray(first / np.sqrt(first @ first))


def rings_of(joins: Sequence[Join]) -> list[Ring | OpeningRim]:
    """The curves on which surfaces with contacts in place end; raises `ArithmeticError` where one is no graph over the
    angle."""
    found: list[Ring | OpeningRim] = []
    for join in joins:
        if join.opening:
            found.append(OpeningRim(join.contact.surface, join.contact.clip, join.nappe))
            continue
        if not join.faces:
            continue
        columns = _columns(join.contact.surface)
        curves = [points for points, _ in join.measured_curves()]
        for plane in join.planes:
            curve = np.concatenate([c for c, face in zip(curves, join.faces, strict=True) if face in plane.faces])
            if len(curve):
                found.append(_ring(curve, plane.plane, columns))
    return found


def _columns(function: Polynomial) -> Floats:
    """The coefficients of a function and its derivatives."""
    return np.stack([p.dense(function.degree) for p in (function, *map(function.diff, range(3)))], axis=1)


def _ring(curve: Floats, plane: Polynomial, columns: Floats) -> Ring:
    normal = plane.dense(1)[1:4]
    offset = -plane.dense(1)[0] / np.sqrt(normal @ normal)
    normal = normal / np.sqrt(normal @ normal)
    middle = (curve.min(axis=0) + curve.max(axis=0)) / 2
    middle = middle + (offset - middle @ normal) * normal
    size = float(np.sqrt(((curve - middle) ** 2).sum(axis=1).max()))
    ring = Ring(middle, normal, columns, size)
    with np.errstate(all="ignore"):
        ends = ring.at(np.concatenate([curve, ring.round(64)]))
        off = evaluate(ends, columns)
        lost = np.abs(off[:, 0]) > OFF * size * np.sqrt((off[:, 1:] ** 2).sum(axis=1))
        apart = np.sqrt(((ends[: len(curve)] - curve) ** 2).sum(axis=1)) > OFF * size
    if not np.isfinite(ends).all() or lost.any() or apart.any() or evaluate(middle[None], columns)[0, 0] >= 0:
        raise ArithmeticError("a contact curve is not one graph over the angle about its middle")
    return ring
