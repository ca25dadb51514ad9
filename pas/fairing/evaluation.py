"""All members of a space along fixed rays: the geometry of their surfaces there, and how it changes with the member.

A member moves the points of its surface along the rays, `dt = -df / (grad f . d)`, so that the domain over
which an energy is summed never changes, and the sum is a true function of the member.  All derivatives
are exact, none are differences.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, exponents, monomial_values
from pas.fairing.basis import WorkingBasis
from pas.fairing.jets import COLUMNS, MovingGeometry
from pas.fairing.surface_points import QUANTITIES, SurfacePoints
from pas.surface.directions import Directions
from pas.surface.geometry import JETS, ORDERS, derivatives, derived

HIT_STEPS, HIT, LONGEST_STEP = 12, 1e-8, 0.2
"""Newton steps along rays, the last of which is to be this short, and the first at most this share of the distance."""

MET = 1e-11
"""A step of Newton's as short as this is the last: the next would be beyond rounding."""

FEW = 256
"""Points whose derivatives are worked out together; of more, those of each piece: large tables leave the caches."""

GRAZING = 1e-3
"""The least cosine between ray and normal at which a surface is sampled."""

BY_ORDER = ((slice(0, 3), slice(1, 4)), (slice(3, 8), slice(4, 10)), (slice(8, COLUMNS), slice(10, len(JETS))))
"""Where derivatives of first, second and third order stand in a framed jet and in a jet."""

AREA = QUANTITIES
"""The logarithm of the area comes after the quantities of `SurfacePoints`."""


@dataclass(frozen=True)
class SampledGeometry:
    """A member as its rays meet it: `distances` (N,), local, `jets` (N, 20) there and their `geometry`, also local, the
    `points`, and the `areas` (N,) that they stand for."""

    member: Floats
    distances: Floats
    jets: Floats
    geometry: MovingGeometry
    points: SurfacePoints
    areas: Floats


class RaySamples:
    """The rays, and all members along them; lengths are local, `SurfacePoints` and areas in the user's units.

    `scale` is the user's length of a local unit, `center` the user's point at local 0, `slope` the mean of
    |grad f|, by the user's coordinates, on the contact curves.
    """

    def __init__(self, basis: WorkingBasis, rays: Directions, center: Floats, slope: float) -> None:
        self.basis, self.rays, self.scale, self.center = basis, rays, basis.scale, center
        self.slope = slope * basis.scale
        self.degrees = np.array([sum(e) for e in exponents(basis.degree)])
        self._powers = np.equal.outer(np.arange(basis.degree + 1), self.degrees).astype(float)
        self._monomials = monomial_values(rays.directions, basis.degree)

    @cached_property
    def jets(self) -> Floats:
        """The jets of the monomials at the rays' directions: (N, 20, C(n+3, 3))."""
        indices, factors = derivatives(self.basis.degree)
        result = np.ascontiguousarray(self._monomials.T).take(indices.ravel(), axis=1)
        result *= factors.ravel()
        return result.reshape(-1, *factors.shape)

    def sample(self, member: Floats, near: Floats) -> SampledGeometry | None:
        """The geometry of a member, found from distances (N,) near by; None where a ray misses or grazes it."""
        t = self._distances(member, near)
        if t is None:
            return None
        found = self._jets_of(member, t)
        geometry = MovingGeometry(found)
        cosines = (geometry.axes[2] * self.rays.directions.T).sum(axis=0)
        if not bool((cosines > GRAZING).all()):
            return None
        areas = self.rays.solid_angles * t * t / cosines * self.scale**2
        return SampledGeometry(member, t, found, geometry, self._points(geometry, t), areas)

    def _distances(self, member: Floats, start: Floats) -> Floats | None:
        profile = np.empty((self.basis.degree + 1, len(start)))
        for piece, here in self.rays.slices:
            column = member @ self.basis.coefficients[piece]
            profile[:, here] = (self._powers * column) @ self._monomials[:, here]
        t = start
        step = slope = np.zeros_like(t)
        for _ in range(HIT_STEPS):
            value, slope = np.zeros_like(t), np.zeros_like(t)
            for coefficients in profile[::-1]:
                slope = slope * t + value
                value = value * t + coefficients
            with np.errstate(all="ignore"):
                step = value / slope
            t = t - np.clip(step, -LONGEST_STEP * t, LONGEST_STEP * t)
            if np.abs(step).max(initial=0.0) < MET:
                break
        met = (np.abs(step) < HIT) & (slope > 0)
        return t if bool(met.all()) else None

    def _jets_of(self, member: Floats, t: Floats) -> Floats:
        """The jets (N, 20) of a member at distances."""
        return self._evaluated(member, t, np.ones_like(self.degrees))

    def _jets_along(self, member: Floats, t: Floats) -> Floats:
        """The derivatives of the jets along the rays (N, 20)."""
        return self._evaluated(member, t, self.degrees) / t[:, None]

    def _evaluated(self, member: Floats, t: Floats, times: NDArray[np.intp]) -> Floats:
        """The jets of a member at distances, with the monomials of each as often as `times` says."""
        result = np.empty((len(JETS), len(t)))
        monomials = self._monomials * self.power_table(t)
        for piece, here in self.rays.slices:
            forms = derived(member @ self.basis.coefficients[piece], self.basis.degree)
            result[:, here] = (forms * times) @ monomials[:, here]
        return result.T

    def power_table(self, t: Floats) -> Floats:
        """The powers of distances by which monomials are multiplied there: (C(n+3, 3), N)."""
        powers = np.ones((self.basis.degree + 1, len(t)))
        for below, power in pairwise(powers):
            np.multiply(below, t, out=power)
        return powers[self.degrees]

    def _points(self, geometry: MovingGeometry, t: Floats) -> SurfacePoints:
        s = self.scale
        shape, variation = geometry.shape, geometry.variation / s**2
        return SurfacePoints(
            self.center + s * t[:, None] * self.rays.directions,
            np.ascontiguousarray(geometry.normals),
            geometry.length / self.slope,
            np.stack([shape[:, 0, 0], shape[:, 0, 1], shape[:, 1, 1]], axis=1) / s,
            np.stack([variation[:, a, b, c] for a, b, c in ((0, 0, 0), (0, 0, 1), (0, 1, 1), (1, 1, 1))], axis=1),
            np.ascontiguousarray(geometry.frame[:, :, :2]),
        )

    def change(self, sampled: SampledGeometry, chosen: NDArray[np.intp] | None = None) -> Jacobian:
        """How the geometry changes with the member; at some points, by rising numbers, or at all."""
        points = np.arange(len(sampled.distances)) if chosen is None else chosen
        geometry = sampled.geometry if chosen is None else MovingGeometry(sampled.jets[chosen])
        t, directions = sampled.distances[points], self.rays.directions[points].T
        normal, shape, variation = geometry.changes()
        inner = (geometry.axes * directions).sum(axis=1)
        steepness = geometry.length * inner[2]
        by_jet = np.zeros((len(t), AREA + 1, COLUMNS + 1))  # the last column is the movement along the ray
        last = by_jet.transpose(1, 2, 0)
        last[:3, COLUMNS] = self.scale * directions
        last[3:6, :COLUMNS] = normal
        last[6, 2] = 1 / self.slope
        last[7:10, :COLUMNS] = shape / self.scale
        last[10:14, :COLUMNS] = variation / self.scale**2
        last[AREA, :2] = -inner[:2] / steepness
        last[AREA, COLUMNS] = 2 / t
        along = self._jets_along(sampled.member, sampled.distances)[points]
        frames = tuple(map(_points_first, geometry.frame_to_jet()))
        return Jacobian(self, points, t, by_jet, frames, along, steepness)


def _points_first(table: Floats) -> Floats:
    return np.ascontiguousarray(table.transpose(2, 0, 1))


@dataclass(frozen=True)
class Jacobian:
    """The derivatives of the geometry at some points (K,) by the member, as products multiplied out when needed.

    `by_jet` (K, 15, 13): quantities and log of area by framed jets and by the movement along the ray; `frames`: the
    framed jets by the derivatives of first, second and third order, (K, 3, 3), (K, 5, 6) and (K, 4, 10).
    """

    samples: RaySamples
    points: NDArray[np.intp]
    distances: Floats
    by_jet: Floats
    frames: tuple[Floats, ...]
    jets_along: Floats
    steepness: Floats

    def some(self, chosen: NDArray[np.intp]) -> Jacobian:
        """What is known at some of the points (their numbers rising), in their order."""
        frames = tuple(frame[chosen] for frame in self.frames)
        t, by_jet, along, steepness = (
            array[chosen] for array in (self.distances, self.by_jet, self.jets_along, self.steepness)
        )
        return Jacobian(self.samples, self.points[chosen], t, by_jet, frames, along, steepness)

    def normal_equations(self, values: Floats, slopes: Floats) -> tuple[Floats, Floats]:
        """`J^T J` (m, m) and `J^T r` (m,) for residuals r with `values` (K, R) and `slopes` (K, R, 15) by quantity.

        By the members, and not by the coefficients of each piece: these are large where a piece is narrow, and cancel.
        """
        basis = self.samples.basis
        gram, gradient = np.zeros((basis.size, basis.size)), np.zeros(basis.size)
        ends = [
            (p, *np.searchsorted(self.points, (here.start, here.stop)).tolist()) for p, here in self.samples.rays.slices
        ]
        parts = [part for part in ends if part[2] > part[1]]
        for group in [parts] if len(self.points) < FEW else [[part] for part in parts]:
            here = slice(group[0][1], group[-1][2])
            rows = self._by_coefficient(slopes, here)
            tables = [(basis.coefficients[p], rows[a - here.start : b - here.start]) for p, a, b in group]
            by_member = np.concatenate([c @ of_piece.reshape(-1, c.shape[1]).T for c, of_piece in tables], axis=1)
            gram += by_member @ by_member.T
            gradient += by_member @ values[here].ravel()
        return (gram + gram.T) / 2, gradient

    def _by_coefficient(self, slopes: Floats, here: slice) -> Floats:
        """The derivatives (K, R, C(n+3, 3)) of residuals at points that follow one another by the coefficients of their
        pieces."""
        by_frame = np.matmul(slopes[here], self.by_jet[here])
        by_jet = np.zeros((*by_frame.shape[:2], len(JETS)))
        for (framed, entries), frame in zip(BY_ORDER, self.frames, strict=True):
            np.matmul(by_frame[:, :, framed], frame[here], out=by_jet[:, :, entries])
        moved = np.matmul(by_jet, self.jets_along[here, :, None])[:, :, 0] + by_frame[:, :, COLUMNS]
        by_jet[:, :, 0] -= moved / self.steepness[here, None]
        distances = self.distances[here]
        by_jet *= (distances[:, None] ** -ORDERS.astype(float))[:, None, :]
        all_points = len(self.points) == len(self.samples.jets)
        by_coefficient = np.matmul(by_jet, self.samples.jets[here if all_points else self.points[here]])
        by_coefficient *= self.samples.power_table(distances).T[:, None, :]
        return by_coefficient
