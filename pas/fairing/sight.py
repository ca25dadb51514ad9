"""All members of a space along fixed rays: what is to be seen of their surfaces, and how it changes with the member.

A member moves the points of its surface along the rays, `dt = -df / (grad f . d)`, so that the domain over
which an energy is summed never changes, and the sum is a true function of the member.  All derivatives
are exact, none are differences.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, exponents, monomial_values
from pas.fairing.basis import WorkingBasis, derivative_matrix
from pas.fairing.jets import COLUMNS, MovingGeometry
from pas.fairing.surface_points import QUANTITIES, SurfacePoints
from pas.surface.directions import Directions
from pas.surface.geometry import JETS, ORDERS, Geometry, derivatives

HIT_STEPS, HIT, LONGEST_STEP = 12, 1e-8, 0.2
"""Newton steps along rays, the last of which is to be this short, and the first at most this share of the distance."""

GRAZING = 1e-3
"""The least cosine between ray and normal at which a surface is looked at."""

AREA = QUANTITIES
"""The logarithm of the area comes after the quantities of `SurfacePoints`."""


@dataclass(frozen=True)
class View:
    """A member as its rays meet it: `distances` (N,), local, `jets` (N, 20) there, also local, the `points`, and the
    `areas` (N,) that they stand for."""

    member: Floats
    distances: Floats
    jets: Floats
    points: SurfacePoints
    areas: Floats


class Sight:
    """The rays, and all members along them; lengths are local, what is seen is in the user's units.

    `scale` is the user's length of a local unit, `center` the user's point at local 0, `slope` the mean of
    |grad f|, by the user's coordinates, on the contact curves.
    """

    def __init__(self, basis: WorkingBasis, rays: Directions, center: Floats, slope: float) -> None:
        self.basis, self.rays, self.scale, self.center = basis, rays, basis.scale, center
        self.slope = slope * basis.scale
        n = basis.degree
        self._degrees = np.array([sum(e) for e in exponents(n)])
        indices, factors = derivatives(n)
        table = monomial_values(rays.directions, n)
        self._jets = np.ascontiguousarray((table[indices] * factors[:, :, None]).transpose(2, 0, 1))  # (N, 20, C)
        self._profiles = self._along_rays(table)

    def _along_rays(self, table: Floats) -> Floats:
        """The members' coefficients as polynomials in the distance: (N, n + 1, m)."""
        profiles = np.zeros((len(self.rays.directions), self.basis.degree + 1, self.basis.size))
        for power in range(self.basis.degree + 1):
            columns = np.flatnonzero(self._degrees == power)
            for piece, here in self.rays.slices:
                profiles[here, power] = table[columns][:, here].T @ self.basis.coefficients[piece][:, columns].T
        return profiles

    def view(self, member: Floats, near: Floats) -> View | None:
        """What is to be seen of a member, found from distances near by; None where a ray misses or grazes it."""
        t = self._distances(member, near)
        if t is None:
            return None
        found = self._jets_of(member, t)
        geometry = Geometry(found)
        cosines = (geometry.normals * self.rays.directions).sum(axis=1)
        if not bool((cosines > GRAZING).all()):
            return None
        areas = self.rays.solid_angles * t * t / cosines * self.scale**2
        return View(member, t, found, self._seen(geometry, t), areas)

    def _distances(self, member: Floats, start: Floats) -> Floats | None:
        profile = self._profiles @ member
        t = start
        step = slope = np.zeros_like(t)
        for _ in range(HIT_STEPS):
            value, slope = np.zeros_like(t), np.zeros_like(t)
            for power in range(self.basis.degree, -1, -1):
                slope = slope * t + value
                value = value * t + profile[:, power]
            with np.errstate(all="ignore"):
                step = value / slope
            t = t - np.clip(step, -LONGEST_STEP * t, LONGEST_STEP * t)
            if np.abs(step).max(initial=0.0) < HIT * HIT:
                break
        met = (np.abs(step) < HIT) & (slope > 0)
        return t if bool(met.all()) else None

    def _jets_of(self, member: Floats, t: Floats) -> Floats:
        """The jets (N, 20) of a member at distances."""
        powers = t[:, None] ** self._degrees
        result = np.empty((len(t), len(JETS)))
        for piece, here in self.rays.slices:
            column = powers[here] * (member @ self.basis.coefficients[piece])
            result[here] = np.matmul(self._jets[here], column[:, :, None])[:, :, 0]
        return result * t[:, None] ** -ORDERS.astype(float)

    def _jets_along(self, member: Floats, t: Floats) -> Floats:
        """The derivatives of the jets along the rays (N, 20)."""
        powers = t[:, None] ** self._degrees
        result = np.empty((len(t), len(JETS)))
        for piece, here in self.rays.slices:
            column = member @ self.basis.coefficients[piece]
            slopes = np.stack([matrix @ column for matrix in _derivative_matrices(self.basis.degree)])
            along = self.rays.directions[here] @ slopes
            result[here] = np.matmul(self._jets[here], (powers[here] * along)[:, :, None])[:, :, 0]
        return result * t[:, None] ** -ORDERS.astype(float)

    def _seen(self, geometry: Geometry, t: Floats) -> SurfacePoints:
        s = self.scale
        c = geometry.variation / s**2
        return SurfacePoints(
            self.center + s * t[:, None] * self.rays.directions,
            geometry.normals,
            geometry.length / self.slope,
            np.stack([geometry.shape[:, 0, 0], geometry.shape[:, 0, 1], geometry.shape[:, 1, 1]], axis=1) / s,
            np.stack([c[:, 0, 0, 0], c[:, 0, 0, 1], c[:, 0, 1, 1], c[:, 1, 1, 1]], axis=1),
            geometry.frame[:, :, :2],
        )

    def change(self, view: View) -> Change:
        """How what is seen changes with the member."""
        t = view.distances
        geometry = MovingGeometry(view.jets)
        normal, gradient, shape, variation = geometry.changes()
        inner = np.einsum("nia,ni->na", geometry.frame, self.rays.directions)
        by_jet = np.zeros((len(t), AREA + 1, COLUMNS + 1))  # the last column is the movement along the ray
        by_jet[:, :3, COLUMNS] = self.scale * self.rays.directions
        by_jet[:, 3:6, :COLUMNS] = normal
        by_jet[:, 6, :COLUMNS] = gradient / self.slope
        by_jet[:, 7:10, :COLUMNS] = shape / self.scale
        by_jet[:, 10:14, :COLUMNS] = variation / self.scale**2
        by_jet[:, AREA, :2] = -inner[:, :2] / (geometry.length * inner[:, 2])[:, None]
        by_jet[:, AREA, COLUMNS] = 2 / t
        steepness = geometry.length * inner[:, 2]
        return Change(self, t, by_jet, geometry.frame_to_jet(), self._jets_along(view.member, t), steepness)


@dataclass(frozen=True)
class Change:
    """The derivatives of what is seen at N points by the member, as products that are multiplied out when needed.

    `by_jet` (N, 15, 13): quantities and log of area by framed jets and by the movement along the ray.
    """

    sight: Sight
    distances: Floats
    by_jet: Floats
    frame_to_jet: Floats
    jets_along: Floats
    steepness: Floats

    def jacobian(self, slopes: Floats, chosen: NDArray[np.intp] | None = None) -> Floats:
        """The derivatives (N * R, m) by the member of residuals with `slopes` (N, R, 15) by what is seen.

        `chosen`, rising, are the points (K,) to which slopes (K, R, 15) belong where these are not all.
        """
        points = slice(None) if chosen is None else chosen
        sight, t = self.sight, self.distances[points]
        by_frame = np.matmul(slopes, self.by_jet[points])
        by_jet = np.matmul(by_frame[:, :, :COLUMNS], self.frame_to_jet[points])
        moved = np.matmul(by_jet, self.jets_along[points][:, :, None])[:, :, 0] + by_frame[:, :, COLUMNS]
        by_jet[:, :, 0] -= moved / self.steepness[points, None]
        by_jet *= (t[:, None] ** -ORDERS.astype(float))[:, None, :]
        by_coefficient = np.matmul(by_jet, sight._jets[points]) * (t[:, None] ** sight._degrees)[:, None, :]
        result = np.empty((*slopes.shape[:2], sight.basis.size))
        for piece, here in self._slices(chosen):
            block = by_coefficient[here]
            rows = block.reshape(-1, block.shape[2]) @ sight.basis.coefficients[piece].T
            result[here] = rows.reshape(*block.shape[:2], -1)
        return result.reshape(-1, sight.basis.size)

    def _slices(self, chosen: NDArray[np.intp] | None) -> list[tuple[int, slice]]:
        slices = self.sight.rays.slices
        if chosen is None:
            return list(slices)
        ends = [(p, *np.searchsorted(chosen, (here.start, here.stop)).tolist()) for p, here in slices]
        return [(p, slice(a, b)) for p, a, b in ends if b > a]


@cache
def _derivative_matrices(degree: int) -> tuple[Floats, ...]:
    return tuple(derivative_matrix(degree, axis) for axis in range(3))
