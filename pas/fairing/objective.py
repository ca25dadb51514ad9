"""The objective: an energy of the surface, with the excess over the limits of fairness, over the members of a space.

Both are sums of squared residuals of the surface's geometry along rays (`pas.fairing.ray_samples`).  The rays are laid
for one member and stay: so the objective of any other member that they meet is a true function of its coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pas.algebra.rational import to_floats
from pas.arrays import Bools, Floats
from pas.fairing.energy import NAMES, Energy, Sizes, SurfacePoints, differences, terms_of
from pas.fairing.excess import BulgeExcess, CurvatureExcess, Limit, SectionExcess, WaistExcess
from pas.fairing.prepared import PreparedSpace
from pas.fairing.ray_samples import AREA, RaySamples, Residuals, SampledGeometry
from pas.surface.directions import Directions
from pas.surface.fairness_limits import FairnessLimits, neighbour
from pas.surface.placed import PlacedContacts
from pas.surface.straight_runs import straight_runs

SETTLED, LIVE = (1200, 3, 5), (400, 2, 3)
"""Rays at the least, and how often the outer faces and triangles on the contact curves are quartered for them, to
settle and for sliders.  Between fewer rays surfaces of long nodes hide creases, of which they are not freed later."""

CLOSE_RAYS, CLOSE_DEEPEST, MOST_CLOSE = 4000, 7, 300
"""Rays of the finer sampling, how often triangles on the contact curves are quartered for them, and how many of them
are followed from then on, at the most."""

HIDDEN, CLOSE, TIE = 0.3, 1.0, 1e-6
"""Units beyond a soft limit that make a finer sampling worth while, those below one for rays to be followed, and those
by which rays differ that are not each other's mirror images: of such, all are followed or none."""

CHECKED, WRONG, SHARE = 32, 1e-3, 0.25
"""Points at which a class's own slopes are held against differences, how far they may be off, and at how many."""


@dataclass(frozen=True)
class Term:
    """Limits, and the rays along which they are evaluated."""

    samples: RaySamples
    limits: tuple[Limit, ...]

    def beyond(self, sampled: SampledGeometry) -> tuple[Residuals, ...]:
        """The residuals of passed limits."""
        return tuple(residuals for limit in self.limits for residuals in limit.beyond(sampled))


@dataclass(frozen=True)
class SurfaceObjective:
    """An energy over the members that rays meet which were laid for one of them, with limits: `terms` are those of the
    surface, whose rays the energy is summed along too, of plane sections, and of rays that were added."""

    placed: PlacedContacts
    energy: Energy
    sizes: Sizes
    curvature: CurvatureExcess
    terms: tuple[Term, ...]

    @classmethod
    def laid(
        cls, space: PreparedSpace, energy: Energy, limits: FairnessLimits, start: Floats, live: bool = False
    ) -> ObjectiveValue | None:
        """The value at the member `start` for which rays are laid; None where they miss or graze its surface.

        Raises `ValueError` for energies whose residuals or slopes are wrong.
        """
        basis, placed = space.basis, space.placed
        scale, center = basis.scale, np.array(to_floats(basis.frame.origin))
        neighbours = [neighbour(join, scale) for join in placed.joins]
        columns = [start @ coefficients for coefficients in basis.coefficients]
        slope = abs(float(space.guard.mean_alpha @ start))
        fewest, even, deepest = LIVE if live else SETTLED
        rays = Directions.of(placed, columns, basis.degree, max(fewest, 3 * basis.size), even, deepest)
        surface = RaySamples(basis, rays, center, slope)
        sections = SectionExcess(basis, placed, columns, neighbours, limits)
        across = RaySamples(basis, sections.rays, center, slope)
        found = [samples.sample(start, samples.rays.distances) for samples in (surface, across)]
        geometries = tuple(geometry for geometry in found if geometry is not None)
        if len(geometries) < len(found):
            return None
        sections.settle_signs(geometries[1])
        radius, distance = (float(np.mean([getattr(n, name) for n in neighbours])) for name in ("radius", "distance"))
        sizes = Sizes(radius, distance, center, straight_runs(neighbours))
        check_energy(energy, geometries[0].points, sizes)
        curvature, bulge = CurvatureExcess.of(neighbours, limits), BulgeExcess(rays, neighbours, limits, center)
        waist = WaistExcess(geometries[0].points.points, neighbours, limits, center)
        terms = (Term(surface, (curvature, bulge, waist)), Term(across, (sections,)))
        return cls(placed, energy, sizes, curvature, terms).value(geometries)

    def value(self, geometries: tuple[SampledGeometry, ...]) -> ObjectiveValue:
        """The value of a member with these geometries along the rays of each term."""
        beyond = tuple(term.beyond(own) for term, own in zip(self.terms, geometries, strict=True))
        residuals = np.asarray(self.energy.residuals(geometries[0].points, self.sizes))
        return ObjectiveValue(self, residuals, geometries, beyond)


@dataclass(frozen=True)
class ObjectiveValue:
    """A member as the rays of an objective meet it: `residuals` (N, R) of the energy along those of the surface, and
    for each term the `geometries` along its rays and the `excesses` beyond its limits."""

    objective: SurfaceObjective
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
        return sum(float((np.maximum(e.values, 0) ** 2).sum()) for found in self.excesses for e in found)

    @property
    def total(self) -> float:
        """The objective: both together."""
        return self.energy + self.beyond

    def moved(self, member: Floats) -> ObjectiveValue | None:
        """The value at another member near by; None where rays miss or graze its surface."""
        geometries = []
        for before in self.geometries:
            own = before.samples.sample(member, before.distances)
            if own is None:
                return None
            geometries.append(own)
        return self.objective.value(tuple(geometries))

    def of(self, energy: Energy) -> ObjectiveValue:
        """The value of another energy along the same rays."""
        if energy == self.objective.energy:
            return self
        return replace(self.objective, energy=energy).value(self.geometries)

    @property
    def passed(self) -> list[Bools]:
        """At which points each limit is passed."""
        return [one.values[:, 0] > 0 for found in self.excesses for one in found]

    def weighted(self) -> Residuals:
        """The energy's residuals, with the roots of the areas for weights."""
        r, root = self.residuals, np.sqrt(self.sampled.areas)[:, None]
        slopes = np.empty((*r.shape, AREA + 1))
        slopes[:, :, :AREA] = root[:, :, None] * self.objective.energy.slopes(self.sampled.points, self.objective.sizes)
        slopes[:, :, AREA] = root * r / 2
        return Residuals(np.arange(len(r)), root * r, slopes)

    def closer(self) -> ObjectiveValue | None:
        """The value with more rays, between these where curvature is beyond limits; None where it is not."""
        member, samples, curvature = self.sampled.member, self.sampled.samples, self.objective.curvature
        columns = [member @ coefficients for coefficients in samples.basis.coefficients]
        rays = Directions.of(self.objective.placed, columns, samples.basis.degree, CLOSE_RAYS, deepest=CLOSE_DEEPEST)
        finer = samples.along(rays).sample(member, rays.distances)
        if finer is None:
            return None
        over = np.max([values for values, _, _ in curvature.over(finer.points.shape)], axis=0)
        least = max(-CLOSE, float(np.sort(over)[-MOST_CLOSE]) + TIE if len(over) > MOST_CLOSE else -CLOSE)
        hidden = np.flatnonzero(over > least)
        if not len(hidden) or over.max() <= HIDDEN:
            return None
        share = len(rays.directions) / len(samples.rays.directions)  # each counts like a ray of the first ones
        added = samples.along(rays.some(hidden, share))
        own = added.sample(member, added.rays.distances)
        if own is None:
            return None
        term = Term(added, (curvature,))
        objective = replace(self.objective, terms=(*self.objective.terms, term))
        return ObjectiveValue(objective, self.residuals, (*self.geometries, own), (*self.excesses, term.beyond(own)))


class LocalModel:
    """Half of Phi next to a member q to first order in residuals: of x' N x / 2 + s' x + sum max(0, v + A x)^2 / 2.

    `normal` N and `slope` s are those of the energy, the quadratic `form` included; `values` v and `rows` A of limits,
    at points where the member passes them or one that was tried does: at others they count only once they are passed.
    """

    def __init__(self, value: ObjectiveValue | None, form: Floats, member: Floats) -> None:
        self.normal, self.slope = form / 2, form @ member / 2
        self.values, self.rows = np.empty(0), np.empty((0, len(member)))
        if value is not None:
            jacobians = [geometry.jacobian() for geometry in value.geometries]
            normal, slope = jacobians[0].normal_equations(value.weighted())
            self.normal, self.slope = self.normal + normal, self.slope + slope
            self._limits = [(j, one) for j, own in zip(jacobians, value.excesses, strict=True) for one in own]
            self._known = [np.zeros_like(mask) for mask in value.passed]
            self.joined(value)

    def joined(self, tried: ObjectiveValue) -> bool:
        """Look from now on where a member that was tried passes limits too; whether that is anywhere new."""
        new = [passed & ~known for passed, known in zip(tried.passed, self._known, strict=True)]
        self._known = [known | passed for passed, known in zip(new, self._known, strict=True)]
        for (jacobian, limit), mask in zip(self._limits, new, strict=True):
            self.values = np.concatenate([self.values, limit.values[mask].ravel()])
            self.rows = np.concatenate([self.rows, jacobian.rows(limit, mask)])
        return any(mask.any() for mask in new)

    def matrices(self, passed: Bools | None = None) -> tuple[Floats, Floats]:
        """Second derivatives and slope of half of Phi at the member, with those limits; by default what it passes."""
        passed = self.values > 0 if passed is None else passed
        rows = self.rows[passed]
        return self.normal + rows.T @ rows, self.slope + rows.T @ self.values[passed]


def check_energy(energy: Energy, points: SurfacePoints, sizes: Sizes) -> None:
    """Check the residuals of each energy of a sum at some of the points; see `check_residuals`."""
    some = points[:: max(1, len(points) // CHECKED)]
    for _, own in terms_of(energy):
        if own.on_surface:
            check_residuals(own, some, sizes)


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
