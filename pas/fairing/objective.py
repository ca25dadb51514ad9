"""What is optimised: an energy of the surface, with what is beyond the limits of fairness, over the members of a space.

Both are sums of squared residuals of the surface's geometry along rays (`pas.fairing.ray_samples`).  The rays are laid
for one member and stay: so the objective of any other member that they meet is a true function of its coefficients.
"""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float, to_floats
from pas.fairing.energy import Energy, terms_of
from pas.fairing.excess import BulgeExcess, CurvatureExcess, Limit, SectionExcess
from pas.fairing.prepared import PreparedSpace
from pas.fairing.ray_samples import AREA, RaySamples, Residuals, SampledGeometry
from pas.fairing.surface_points import NAMES, Sizes, SurfacePoints, differences
from pas.surface.directions import Directions
from pas.surface.fairness_limits import FairnessLimits, Neighbour, neighbour
from pas.surface.geometry import Geometry, derivative_batch
from pas.surface.straight_runs import straight_runs

LEAST_RAYS, RAYS_PER_UNKNOWN = 400, 3
"""Rays, at the least."""

SETTLED, LIVE = (3, 6), (2, 3)
"""How often the outer faces and triangles on the contact curves are quartered for rays, to settle and for sliders."""

CLOSE_RAYS, CLOSE_DEEPEST, MOST_CLOSE = 4000, 7, 300
"""Rays of the finer sampling, how often triangles on the contact curves are quartered for them, and how many of them
are followed from then on, at the most."""

HIDDEN, CLOSE, TIE = 0.3, 1.0, 1e-6
"""Units beyond a soft limit that make a finer sampling worth while, those below one for rays to be followed, and those
by which rays differ that are not each other's mirror images: of such, all are followed or none."""

CHECKED, WRONG, SHARE = 32, 1e-3, 0.25
"""Points at which a class's own slopes are held against differences, how far they may be off, and at how many."""


@dataclass(frozen=True)
class ObjectiveValue:
    """A member as the rays meet it, its energy, and the objective: that with the squares of what is beyond limits.

    `residuals` (N, R) are the energy's at each point; `geometries` are those along the rays of each of the objective's
    terms, first those of the surface, and `excesses` what is beyond limits there.
    """

    residuals: Floats
    geometries: tuple[SampledGeometry, ...]
    excesses: tuple[tuple[Residuals, ...], ...]

    @property
    def sampled(self) -> SampledGeometry:
        """The member along the rays of the surface."""
        return self.geometries[0]

    @cached_property
    def energy(self) -> float:
        """The integral of the squared residuals."""
        return float(self.sampled.areas @ (self.residuals * self.residuals).sum(axis=1))

    @cached_property
    def beyond(self) -> float:
        """The sum of the squares of what is beyond limits."""
        return sum(float((e.values * e.values).sum()) for found in self.excesses for e in found)

    @property
    def objective(self) -> float:
        """Both together."""
        return self.energy + self.beyond


@dataclass(frozen=True)
class Term:
    """Limits, and the rays along which they are looked at."""

    samples: RaySamples
    limits: tuple[Limit, ...]

    def beyond(self, sampled: SampledGeometry) -> tuple[Residuals, ...]:
        """What is beyond them."""
        return tuple(residuals for limit in self.limits for residuals in limit.beyond(sampled))


class SurfaceObjective:
    """The energy over the members that rays see which were laid for one of them, `start`."""

    def __init__(
        self,
        space: PreparedSpace,
        energy: Energy,
        limits: FairnessLimits,
        start: Floats,
        live: bool = False,
    ) -> None:
        basis, placed = space.basis, space.placed
        self.energy, self.basis, self.placed, self.limits = energy, basis, placed, limits
        self.center, scale = np.array(to_floats(basis.frame.origin)), to_float(basis.frame.scale)
        columns = [start @ coefficients for coefficients in basis.coefficients]
        number = max(LEAST_RAYS, RAYS_PER_UNKNOWN * basis.size)
        directions = Directions.of(placed, columns, basis.degree, number, *(LIVE if live else SETTLED))
        self.slope = abs(float(space.guard.mean_alpha @ start))
        neighbours = [neighbour(join, scale) for join in placed.joins]
        radii, distances = zip(*((n.radius, n.distance) for n in neighbours), strict=True)
        self.sizes = Sizes(float(np.mean(radii)), float(np.mean(distances)), self.center, straight_runs(neighbours))
        self.samples = RaySamples(basis, directions, self.center, self.slope)
        self.curvature = CurvatureExcess.of(neighbours, limits)
        self.terms: tuple[Term, ...] = (
            Term(self.samples, (self.curvature, BulgeExcess(directions, neighbours, limits, self.center))),
        )
        self.first = self._first(start, columns, neighbours)

    def _first(self, start: Floats, columns: list[Floats], neighbours: list[Neighbour]) -> ObjectiveValue | None:
        """The value at the start; None where rays miss or graze its surface."""
        sampled = self.samples.sample(start, self.samples.rays.distances)
        if sampled is None:
            return None
        sections = SectionExcess(self.basis, self.placed, columns, neighbours, self.limits)
        across = RaySamples(self.basis, sections.rays, self.center, self.slope)
        own = across.sample(start, sections.rays.distances)
        if own is None:
            return None
        sections.settle_signs(own)
        self.terms = (*self.terms, Term(across, (sections,)))
        self._check(sampled)
        return self._value([sampled, own])

    def of(self, energy: Energy, value: ObjectiveValue) -> tuple[SurfaceObjective, ObjectiveValue]:
        """An objective of another energy on these rays, and its value at a member."""
        if energy == self.energy:
            return self, value
        other = copy(self)
        other.energy = energy
        return other, replace(value, residuals=other._residuals(value.sampled))

    def value(self, member: Floats, near: ObjectiveValue) -> ObjectiveValue | None:
        """The value at another member, found from one near by; None where rays miss or graze its surface."""
        geometries = []
        for term, before in zip(self.terms, near.geometries, strict=True):
            own = term.samples.sample(member, before.distances)
            if own is None:
                return None
            geometries.append(own)
        return self._value(geometries)

    def _value(self, geometries: Iterable[SampledGeometry]) -> ObjectiveValue:
        found = tuple(geometries)
        beyond = tuple(term.beyond(own) for term, own in zip(self.terms, found, strict=True))
        return ObjectiveValue(self._residuals(found[0]), found, beyond)

    def _residuals(self, sampled: SampledGeometry) -> Floats:
        return np.asarray(self.energy.residuals(sampled.points, self.sizes))

    def linearised(self, value: ObjectiveValue) -> tuple[Floats, Floats]:
        """`J^T J` (m, m) and `J^T r` (m,) for the residuals r, whose squares add up to the objective, and their
        derivatives J by the member."""
        own = self._energy_residuals(value)
        normal, gradient = np.zeros((self.basis.size, self.basis.size)), np.zeros(self.basis.size)
        for sampled, found in zip(value.geometries, value.excesses, strict=True):
            residuals = (own, *found) if sampled is value.sampled else found
            if residuals:
                jacobian = sampled.jacobian()
                parts = [jacobian.normal_equations(one) for one in residuals]
                normal, gradient = normal + sum(p[0] for p in parts), gradient + sum(p[1] for p in parts)
        return normal, gradient

    def _energy_residuals(self, value: ObjectiveValue) -> Residuals:
        """The energy's residuals, with the roots of the areas for weights."""
        sampled, r = value.sampled, value.residuals
        root = np.sqrt(sampled.areas)[:, None]
        slopes = np.empty((*r.shape, AREA + 1))
        slopes[:, :, :AREA] = root[:, :, None] * self.energy.slopes(sampled.points, self.sizes)
        slopes[:, :, AREA] = root * r / 2
        return Residuals(np.arange(len(r)), root * r, slopes)

    def closer(self, value: ObjectiveValue) -> tuple[SurfaceObjective, ObjectiveValue] | None:
        """An objective with more rays, between these where curvature is beyond limits; None where it is not."""
        member = value.sampled.member
        columns = [member @ coefficients for coefficients in self.basis.coefficients]
        rays = Directions.of(self.placed, columns, self.basis.degree, CLOSE_RAYS, deepest=CLOSE_DEEPEST)
        local = rays.directions * rays.distances[:, None]
        principal = Geometry(derivative_batch(columns, range(4))(local, rays.pieces)).principal / self.basis.scale
        shape = np.stack([principal[:, 0], np.zeros(len(principal)), principal[:, 1]], axis=1)
        over = np.max([values for values, _, _ in self.curvature.over(shape)], axis=0)
        least = max(-CLOSE, float(np.sort(over)[-MOST_CLOSE]) + TIE if len(over) > MOST_CLOSE else -CLOSE)
        hidden = np.flatnonzero(over > least)
        if not len(hidden) or over.max() <= HIDDEN:
            return None
        share = len(rays.directions) / len(self.samples.rays.directions)  # each counts like a ray of the first ones
        samples = RaySamples(self.basis, rays.some(hidden, share), self.center, self.slope)
        own = samples.sample(member, samples.rays.distances)
        if own is None:
            return None
        other = copy(self)
        term = Term(samples, (self.curvature,))
        other.terms = (*self.terms, term)
        return other, ObjectiveValue(value.residuals, (*value.geometries, own), (*value.excesses, term.beyond(own)))

    def _check(self, sampled: SampledGeometry) -> None:
        """That residuals and slopes have their shapes, are finite and agree, at some points."""
        points = sampled.points[:: max(1, len(sampled.points) // CHECKED)]
        for _, energy in terms_of(self.energy):
            if energy.on_surface:
                check_residuals(energy, points, self.sizes)


def check_residuals(energy: Energy, points: SurfacePoints, sizes: Sizes) -> None:
    """Raise `ValueError` for residuals or slopes that have not their shapes, are not finite or do not agree."""
    kind, r = energy.kind, np.asarray(energy.residuals(points, sizes))
    if r.ndim != 2 or len(r) != len(points) or not np.isfinite(r).all():
        wrong = f"shape {r.shape}" if r.ndim != 2 or len(r) != len(points) else "values that are not finite"
        raise ValueError(
            f"the residuals of the energy {kind!r} must be finite, of shape (N, R) for N points: {wrong} "
            f"for {len(points)}"
        )
    slopes = np.asarray(energy.slopes(points, sizes))
    if slopes.shape != (*r.shape, AREA) or not np.isfinite(slopes).all():
        wrong = f"shape {slopes.shape}" if slopes.shape != (*r.shape, AREA) else "values that are not finite"
        raise ValueError(f"the slopes of the energy {kind!r} must be finite, of shape {(*r.shape, AREA)}: {wrong}")
    found = differences(lambda moved: energy.residuals(moved, sizes), points)
    off = np.abs(slopes - found) > WRONG * (np.abs(found).max(axis=(0, 2), initial=0.0)[:, None] + np.abs(found))
    share = off.mean(axis=0)
    if share.max(initial=0.0) > SHARE:
        number, column = np.unravel_index(share.argmax(), share.shape)
        at = int(off[:, number, column].argmax())
        raise ValueError(
            f"the slopes of the energy {kind!r} disagree with its residuals: that of residual {number} by "
            f"quantity {column} ({NAMES[column]}) is {float(slopes[at, number, column]):.6g} at a point where "
            f"differences give {float(found[at, number, column]):.6g}; leave slopes away to have differences"
        )
