"""The excess of a surface over the limits of fairness, as residuals where a limit is passed.

A minimum of curvature variation may bend a fillet more than the limits allow where that costs little, in the
middle of a fillet or just before a contact.  The squares of what is beyond the limits (see
`pas.FairnessLimits`) are added, so that the limits are soft: they give way where nothing else meets the rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from scipy.spatial import ConvexHull

from pas.arrays import Floats, Integers
from pas.fairing.basis import WorkingBasis
from pas.fairing.energy import STEP, SurfacePoints, slopes_by_place
from pas.fairing.ray_samples import AREA, Residuals, SampledGeometry
from pas.surface.directions import AROUND, Directions, circle, planes, runs
from pas.surface.fairness import BULGE, HOLLOW, NARROW, SHARP, WRONG
from pas.surface.fairness_limits import FairnessLimits, Neighbour, largest_arc, sharpest_of, widest
from pas.surface.placed import PlacedContacts
from pas.surface.straight_runs import StraightRun, owners, straight_runs

PRESS = 40.0
"""The weight of squares of what is beyond the limits, each over its own unit."""

MARGIN = 0.1
"""By how much the soft limit of hollowness is inside the limit: between samples curvature is larger than at them.  What
the other limits leave, beyond a pipe itself, is halved."""

ENDS, EVERY = 6, 8
"""Directions that are kept of a part of a plane section: those at its ends, where neighbours are foreshortened, and
every eighth."""

ALIKE = 9
"""Digits to which planes of a hull, and the distances at which a ray meets them, are the same."""

TIGHT = NARROW / 4
"""The unit of the waist here: at the whole unit the energy outweighs what is beyond, by up to a third of the limit."""

TOGETHER = 32
"""Rays that are held against all facets of the hull at once: the table stays in the caches."""

TURNED = 0.2
"""Radians by which a part of a section must turn in all for one sign of its curvature to be wrong."""


@dataclass(frozen=True)
class CurvatureExcess:
    """Curvature beyond the limits at points of the surface.

    As of all of these `beyond` gives residuals at all points, positive where a surface is beyond a limit: only there
    they count.
    """

    limits: FairnessLimits
    curvature: float
    arc: float
    radius: float

    @classmethod
    def of(cls, neighbours: Sequence[Neighbour], limits: FairnessLimits) -> CurvatureExcess:
        """The excess beside given neighbours."""
        radius = float(np.mean([n.radius for n in neighbours]))
        return cls(limits, sharpest_of(neighbours), largest_arc(neighbours), radius)

    def over(self, shape: Floats) -> Iterator[tuple[Floats, int, float]]:
        """By how many units each limit is passed (N,), with the quantity that passes it and the slope by that."""
        sharp = (1 + (self.limits.sharpness - 1) / 2) * self.curvature
        unit = SHARP * self.curvature
        yield (shape[:, 0] - sharp) / unit, 7, 1 / unit
        yield (-shape[:, 2] - sharp) / unit, 9, -1 / unit
        if self.arc:
            hollow = self.limits.hollowness - MARGIN
            yield (-shape[:, 2] * self.arc - hollow) / HOLLOW, 9, -self.arc / HOLLOW

    def beyond(self, sampled: SampledGeometry) -> Iterator[Residuals]:
        for over, quantity, by in self.over(sampled.points.shape):
            slopes = np.zeros((len(over), AREA + 1))
            slopes[:, quantity] = by
            yield by_area(sampled, over, slopes, self.radius)


class BulgeExcess:
    """How far points are beyond the hull of the contacts."""

    def __init__(self, rays: Directions, neighbours: Sequence[Neighbour], limits: FairnessLimits, center: Floats):
        self.limits, self.center = limits, center
        self.radius = float(np.mean([n.radius for n in neighbours]))
        self.widest = widest(neighbours)
        self.normals, self.offsets = _hull(rays.directions, neighbours, self.widest)

    def beyond(self, sampled: SampledGeometry) -> Iterator[Residuals]:
        slopes = np.zeros((len(self.normals), AREA + 1))
        slopes[:, :3] = self.normals / (BULGE * self.widest)
        far = ((sampled.points.points - self.center) * self.normals).sum(axis=1) + self.offsets
        yield by_area(sampled, (far / self.widest - self.limits.bulge / 2) / BULGE, slopes, self.radius)


class WaistExcess:
    """How far a surface leaves the straight runs.  Each ray belongs for good to the run of the point (N, 3) in which it
    met a first member: so what counts changes smoothly with the member."""

    def __init__(self, points: Floats, neighbours: Sequence[Neighbour], limits: FairnessLimits, center: Floats):
        self.limits, self.center = limits, center
        self.runs = straight_runs(neighbours)
        self.radius = float(np.mean([n.radius for n in neighbours]))
        self.owner = owners(self.runs, points - center) if self.runs else None

    def beyond(self, sampled: SampledGeometry) -> Iterator[Residuals]:
        if self.owner is None:
            return
        points, step = sampled.points.points - self.center, STEP * self.radius
        far, slopes = np.zeros(len(points)), np.zeros((len(points), AREA + 1))
        for number, run in enumerate(self.runs):
            own = points[here := self.owner == number]
            far[here] = _off(run, own)
            slopes[here, :3] = slopes_by_place(partial(_off, run), own, step)
        slopes *= np.sign(far)[:, None]
        yield by_area(sampled, np.abs(far) - self.limits.waist / (2 * TIGHT), slopes, self.radius)


def _off(run: StraightRun, points: Floats) -> Floats:
    """How many units of the waist points (N, 3) are outside of the tube of a run (N,); 0 beyond its ends."""
    return np.nan_to_num(run.seen(points)[0]) / (TIGHT * run.radius)


def by_area(sampled: SampledGeometry, over: Floats, slopes: Floats, radius: float) -> Residuals:
    """Residuals where a limit is passed, weighted by the areas that the points stand for, over a squared radius."""
    weights = sampled.areas / radius**2
    slopes[:, AREA] += over / 2
    return _limit_residuals(over, slopes, weights)


def _limit_residuals(over: Floats, slopes: Floats, weights: Floats) -> Residuals:
    """Residuals (N, 1) of a limit that is passed by `over` (N,) units, with slopes (N, 15) and weights (N,)."""
    root = np.sqrt(PRESS * weights)[:, None]
    return Residuals(np.arange(len(over)), root * over[:, None], (root * slopes)[:, None])


class SectionExcess:
    """Curvature of the wrong sign in plane sections through two neighbours' middles."""

    def __init__(
        self,
        basis: WorkingBasis,
        placed: PlacedContacts,
        columns: Sequence[Floats],
        neighbours: Sequence[Neighbour],
        limits: FairnessLimits,
    ) -> None:
        self.limits = limits
        self.widest = widest(neighbours)
        pairs = list(planes([n.mean for n in neighbours]))
        units = np.concatenate([np.empty((0, 3)), *(circle(*pair) for pair in pairs)])
        across = np.array([np.cross(a, b) for a, b in pairs]).reshape(-1, 3)
        met = Directions.along(placed, columns, basis.degree, units)[1]
        there = np.zeros((len(pairs), AROUND), dtype=bool)
        there.ravel()[met] = True
        kept = [_thinned(plane * AROUND + run) for plane, row in enumerate(there) for run in runs(row)]
        chosen = np.concatenate([np.empty(0, dtype=np.intp), *kept])
        self.rays, order = Directions.along(placed, columns, basis.degree, units[chosen])
        self.across = across[chosen[order] // AROUND] if len(order) else np.empty((0, 3))
        place = np.argsort(order)
        starts = np.cumsum([0, *map(len, kept)])
        self.runs = [place[a:b] for a, b in pairwise(starts)]
        self.signs = np.zeros(len(order))

    def settle_signs(self, sampled: SampledGeometry) -> None:
        """See which way each part of a section turns: that depends on its ends alone, not on the member."""
        normals = sampled.points.normals
        for run in self.runs:
            tangents = np.cross(self.across[run], normals[run])
            turns = np.arctan2(
                (np.cross(tangents[:-1], tangents[1:]) * self.across[run][:-1]).sum(axis=1),
                (tangents[:-1] * tangents[1:]).sum(axis=1),
            )
            turned = float(turns.sum())
            self.signs[run] = np.sign(turned) if abs(turned) > TURNED else 0.0

    def beyond(self, sampled: SampledGeometry) -> Iterator[Residuals]:
        if not len(self.signs):
            return
        curvature, changes = section_curvatures(sampled.points, self.across)
        over = (-self.signs * curvature * self.widest - self.limits.wrong_sign / 2) / WRONG
        slopes = np.zeros((len(over), AREA + 1))
        slopes[:, : changes.shape[1]] = (-self.signs * self.widest / WRONG)[:, None] * changes
        # a point stands for its arc times the width of the arc: its weight is taken from the start's distance
        weights = EVERY * 2 * np.pi / AROUND * self.rays.distances / self.rays.distances.mean()
        yield _limit_residuals(np.where(self.signs == 0, 0.0, over), slopes, weights)


Limit = CurvatureExcess | BulgeExcess | WaistExcess | SectionExcess


def section_curvatures(points: SurfacePoints, across: Floats) -> tuple[Floats, Floats]:
    """Curvatures (N,) of plane sections with unit normals `across` (N, 3), and their derivatives (N, 10).

    These are by place, normal, gradient and shape operator (see `SurfacePoints`).  By Meusnier's theorem it is that of
    the surface in the section's direction, over the cosine between normal and plane.
    """
    inner = (points.normals * across).sum(axis=1)
    cosine = np.sqrt(np.maximum(1 - inner * inner, 1e-12))
    tangent = np.cross(across, points.normals) / cosine[:, None]
    side = np.cross(points.normals, tangent)
    u, v = (np.einsum("ni,nia->na", d, points.frame) for d in (tangent, side))
    s11, s12, s22 = points.shape.T
    along = s11 * u[:, 0] ** 2 + 2 * s12 * u[:, 0] * u[:, 1] + s22 * u[:, 1] ** 2
    mixed = s11 * u[:, 0] * v[:, 0] + s12 * (u[:, 0] * v[:, 1] + u[:, 1] * v[:, 0]) + s22 * u[:, 1] * v[:, 1]
    slopes = np.zeros((len(inner), 10))
    turn = np.cross(side, across) / cosine[:, None]  # how the direction turns to its side with the normal
    slopes[:, 3:6] = (2 * mixed / cosine)[:, None] * turn + (along * inner / cosine**3)[:, None] * across
    slopes[:, 7:10] = np.stack([u[:, 0] ** 2, 2 * u[:, 0] * u[:, 1], u[:, 1] ** 2], axis=1) / cosine[:, None]
    return along / cosine, slopes


def _thinned(run: Integers) -> Integers:
    places = np.minimum(np.arange(len(run)), np.arange(len(run))[::-1])  # from the nearer end: symmetric
    return run[(places < ENDS) | (places % EVERY == 0)]


def _hull(units: Floats, neighbours: Sequence[Neighbour], widest: float) -> tuple[Floats, Floats]:
    """The plane (normals (N, 3), offsets (N,)) in which each ray leaves the hull of the curves and a ball.

    Most rays leave it at a corner, their own: there all planes count alike, and not the one that rounding prefers.
    """
    # the rays have the symmetries of the partition, and so has the hull
    hull = ConvexHull(np.concatenate([widest * units, *(n.curve for n in neighbours)]))
    planes = hull.equations[np.unique(np.round(hull.equations, ALIKE), axis=0, return_index=True)[1]]
    steepness = np.ascontiguousarray((planes[:, :3] / -planes[:, 3:]).T)
    normals, offsets = np.empty_like(units), np.empty(len(units))
    for start in range(0, len(units), TOGETHER):
        rays = slice(start, start + TOGETHER)
        far = units[rays] @ steepness
        greatest = far.max(axis=1)
        mean = (far > (1 - 10.0**-ALIKE) * greatest[:, None]) @ planes[:, :3]
        normals[rays] = mean / np.linalg.norm(mean, axis=1)[:, None]
        offsets[rays] = -(normals[rays] * units[rays]).sum(axis=1) / greatest
    return normals, offsets
