"""The surfaces of all members of a space along fixed rays: their geometry there, and how it changes with the member.

A member moves the points of its surface along the rays, `dt = -df / (grad f . d)`, so that the domain over which
residuals are summed never changes, and their sum is a true function of the member.  All derivatives are exact, by the
jets of f; none are differences.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement, pairwise

import numpy as np

from pas.algebra.monomials import exponents, monomial_values
from pas.arrays import Bools, Floats, Integers
from pas.fairing.basis import WorkingBasis
from pas.fairing.energy import QUANTITIES, SurfacePoints
from pas.surface.directions import Directions
from pas.surface.geometry import FIRST, JETS, ORDERS, SECOND, THIRD, Geometry, derivatives, derived

AREA = QUANTITIES
"""The column of the logarithm of the area, which comes after the quantities of `SurfacePoints`."""

PAIRS = (*combinations_with_replacement((0, 1), 2), (0, 2), (1, 2))
TRIPLES = tuple(combinations_with_replacement((0, 1), 3))
"""The second and third derivatives in the frame of a point on which curvature and its variation depend."""

FRAMED = 3 + len(PAIRS) + len(TRIPLES)
"""Entries of a jet in the frame of a point: g1 g2 gn, H11 H12 H22 H1n H2n, F111 F112 F122 F222."""


class MovingGeometry(Geometry):
    """Frames, shape operators and their covariant derivatives of jets (N, 20), with their derivatives by the jets.

    The frame is carried along with the normal, without a turn around it.
    """

    def changes(self) -> tuple[Floats, Floats, Floats]:
        """Derivatives by the framed jet: normal (3, 12, N), shape (3, 12, N), variation (4, 12, N).

        That of the length is 1 by gn, and nothing else.
        """
        h, s, c = self.second, self._shape, self._variation
        inverse = 1 / self.length
        normal = np.zeros((3, FRAMED, len(inverse)))
        normal[:, :2] = (self.axes[:2] * inverse).transpose(1, 0, 2)
        shape = np.zeros((3, FRAMED, len(inverse)))
        for row, (a, b) in enumerate(PAIRS[:3]):
            shape[row, a] -= h[b, 2] * inverse
            shape[row, b] -= h[a, 2] * inverse
            shape[row, 2] = -s[a, b]
            shape[row, 3 + row] = 1
        shape *= inverse
        mixed = np.zeros((2, FRAMED, len(inverse)))
        for row in (0, 1):
            mixed[row, :2] = s[row]
            mixed[row, row] -= h[2, 2] * inverse
            mixed[row, 6 + row] = 1
        variation = np.zeros((4, FRAMED, len(inverse)))
        for row, axes in enumerate(TRIPLES):
            variation[row, 2] = -c[axes]
            variation[row, 8 + row] = 1
            for place, z in enumerate(axes):
                x, y = axes[:place] + axes[place + 1 :]
                variation[row, z] -= self.third[x, y, 2] * inverse
                variation[row] -= shape[x + y] * h[z, 2] + mixed[z] * s[x, y]
        variation *= inverse
        return normal, shape, variation

    def framed(self) -> Floats:
        """The framed jets as linear functions of the jets: (N, 12, 20)."""
        f, unit = self.axes, np.eye(len(JETS))
        result = np.zeros((FRAMED, len(JETS), f.shape[2]))
        result[:3, FIRST] = f
        pairs = {(a, b): f[a, :, None] * f[b] for a, b in PAIRS}
        for row, pair in enumerate(PAIRS, start=3):
            result[row] = unit[:, SECOND.ravel()] @ pairs[pair].reshape(9, -1)
        for row, (a, b, c) in enumerate(TRIPLES, start=3 + len(PAIRS)):
            result[row] = unit[:, THIRD.ravel()] @ (pairs[a, b][:, :, None] * f[c]).reshape(27, -1)
        return np.ascontiguousarray(result.transpose(2, 0, 1))


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

    def along(self, rays: Directions) -> RaySamples:
        """All members along other rays."""
        return RaySamples(self.basis, rays, self.center, self.slope / self.basis.scale)

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
        geometry = MovingGeometry(self.jets_of(member, t, np.ones_like(self.degrees)))
        cosines = (geometry.axes[2] * self.rays.directions.T).sum(axis=0)
        grazing = 1e-3  # the least cosine between ray and normal at which a surface is sampled
        if not bool((cosines > grazing).all()):
            return None
        areas = self.rays.solid_angles * t * t / cosines * self.scale**2
        return SampledGeometry(self, member, t, geometry, self._points(geometry, t), areas)

    def _distances(self, member: Floats, start: Floats) -> Floats | None:
        profile = np.empty((self.basis.degree + 1, len(start)))
        for piece, here in self.rays.slices:
            column = member @ self.basis.coefficients[piece]
            profile[:, here] = (self._powers * column) @ self._monomials[:, here]
        t, hit = start, 1e-8  # a step as short is the last: the next would be beyond rounding
        for _ in range(12):
            value, slope = np.zeros_like(t), np.zeros_like(t)
            for coefficients in profile[::-1]:
                slope = slope * t + value
                value = value * t + coefficients
            with np.errstate(all="ignore"):
                step = value / slope
            t = t - np.clip(step, -0.2 * t, 0.2 * t)  # no farther at once: rays must not jump over a sheet
            if np.abs(step).max(initial=0.0) < hit:
                return t if bool((slope > 0).all()) else None
        return None

    def jets_of(self, member: Floats, t: Floats, times: Integers) -> Floats:
        """The jets (N, 20) of a member at distances, with the monomials of each as often as `times` says."""
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
        shape, variation = geometry.shape, geometry.variation
        return SurfacePoints(
            self.center + s * t[:, None] * self.rays.directions,
            np.ascontiguousarray(geometry.normals),
            geometry.length / self.slope,
            np.stack([shape[:, a, b] for a, b in PAIRS[:3]], axis=1) / s,
            np.stack([variation[:, a, b, c] for a, b, c in TRIPLES], axis=1) / s**2,
            np.ascontiguousarray(geometry.frame[:, :, :2]),
        )


@dataclass(frozen=True)
class SampledGeometry:
    """A member as rays meet it: `distances` (N,) and `geometry` there, both local, the same as `points` in the user's
    units, and the `areas` (N,) that they stand for."""

    samples: RaySamples
    member: Floats
    distances: Floats
    geometry: MovingGeometry
    points: SurfacePoints
    areas: Floats

    def jacobian(self) -> Jacobian:
        """How the geometry changes with the member."""
        samples, geometry, t, directions = self.samples, self.geometry, self.distances, self.samples.rays.directions.T
        normal, shape, variation = geometry.changes()
        inner = (geometry.axes * directions).sum(axis=1)
        steepness = geometry.length * inner[2]
        by_jet = np.zeros((len(t), AREA + 1, FRAMED + 1))  # the last column is the movement along the ray
        last = by_jet.transpose(1, 2, 0)
        last[:3, FRAMED] = samples.scale * directions
        last[3:6, :FRAMED] = normal
        last[6, 2] = 1 / samples.slope
        last[7:10, :FRAMED] = shape / samples.scale
        last[10:14, :FRAMED] = variation / samples.scale**2
        last[AREA, :2] = -inner[:2] / steepness
        last[AREA, FRAMED] = 2 / t
        along = samples.jets_of(self.member, t, samples.degrees) / t[:, None]
        return Jacobian(samples, t, by_jet, geometry.framed(), along, steepness)


@dataclass(frozen=True)
class Residuals:
    """Residuals at some of the points, by rising numbers `chosen` (K,): `values` (K, R), whose squares are summed, and
    their `slopes` (K, R, 15) by the quantities of `SurfacePoints` and the logarithm of the area."""

    chosen: Integers
    values: Floats
    slopes: Floats


@dataclass(frozen=True)
class Jacobian:
    """The derivatives of the geometry at points (N,) by the member, as products that are multiplied out when needed.

    `by_jet` (N, 15, 13): quantities and log of area by framed jets and by the movement along the ray; `framed`
    (N, 12, 20): framed jets by jets; `along` (N, 20): jets by the movement along the ray.
    """

    samples: RaySamples
    distances: Floats
    by_jet: Floats
    framed: Floats
    along: Floats
    steepness: Floats

    def normal_equations(self, residuals: Residuals) -> tuple[Floats, Floats]:
        """`J^T J` (m, m) and `J^T r` (m,) for residuals r."""
        gram, gradient = np.zeros((self.samples.basis.size,) * 2), np.zeros(self.samples.basis.size)
        for here, by_member in self._by_member(residuals):
            gram += by_member @ by_member.T
            gradient += by_member @ residuals.values[here].ravel()
        return (gram + gram.T) / 2, gradient

    def rows(self, residuals: Residuals, which: Bools) -> Floats:
        """J (K R, m) for residuals (K, R) at some of the points."""
        some = Residuals(residuals.chosen[which], residuals.values[which], residuals.slopes[which])
        found = [by_member.T for _, by_member in self._by_member(some)]
        return np.concatenate([np.empty((0, self.samples.basis.size)), *found])

    def _by_member(self, residuals: Residuals) -> Iterator[tuple[slice, Floats]]:
        """The derivatives (m, K R) of residuals, some of the points (K,) after the other.

        By the members, and not by the coefficients of each piece: these are large where a piece is narrow, and cancel.
        """
        # Points whose derivatives are worked out together; of more, those of each piece: large tables leave
        # the caches.
        few = 256
        basis, chosen = self.samples.basis, residuals.chosen
        ends = [(p, *np.searchsorted(chosen, (here.start, here.stop)).tolist()) for p, here in self.samples.rays.slices]
        parts = [part for part in ends if part[2] > part[1]]
        for group in [[part] for part in parts] if len(chosen) >= few else [parts] if parts else []:
            start = group[0][1]
            here = slice(start, group[-1][2])
            rows = self._by_coefficient(chosen[here], residuals.slopes[here])
            tables = [(basis.coefficients[p], rows[a - start : b - start]) for p, a, b in group]
            yield here, np.concatenate([c @ of_piece.reshape(-1, c.shape[1]).T for c, of_piece in tables], axis=1)

    def _by_coefficient(self, chosen: Integers, slopes: Floats) -> Floats:
        """The derivatives (K, R, C(n+3, 3)) of residuals at points by the coefficients of their pieces."""
        first, end = int(chosen[0]), int(chosen[-1]) + 1
        at = slice(first, end) if end - first == len(chosen) else chosen  # a slice copies nothing
        by_frame = np.matmul(slopes, self.by_jet[at])
        by_jet = np.matmul(by_frame[:, :, :FRAMED], self.framed[at])
        moved = np.matmul(by_jet, self.along[at, :, None])[:, :, 0] + by_frame[:, :, FRAMED]
        by_jet[:, :, 0] -= moved / self.steepness[at, None]
        distances = self.distances[at]
        by_jet *= (distances[:, None] ** -ORDERS.astype(float))[:, None, :]
        by_coefficient = np.matmul(by_jet, self.samples.jets[at])
        by_coefficient *= self.samples.power_table(distances).T[:, None, :]
        return by_coefficient
