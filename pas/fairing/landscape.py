"""An energy of the surface over all members of a space, with what is beyond the limits of fairness, and its slopes.

The rays are laid for one member and stay: so the energy of any other member that they see is a true
function of its coefficients.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np

from pas.algebra.inputs import shown
from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float, to_floats
from pas.fairing.basis import WorkingBasis
from pas.fairing.energy import Energy
from pas.fairing.excess import SectionExcess, SurfaceExcess
from pas.fairing.sight import AREA, Sight, View
from pas.fairing.surface_points import NAMES, Sizes, differences
from pas.surface.directions import Directions
from pas.surface.fairness import FairnessLimits, neighbour
from pas.surface.placed import PlacedContacts

LEAST_RAYS, RAYS_PER_UNKNOWN, DEEPEST = 400, 3, 6
"""Rays, at the least; and how often triangles on the contact curves are quartered for them."""

CHECKED, WRONG, SHARE = 32, 1e-3, 0.25
"""Points at which a class's own slopes are held against differences, how far they may be off, and at how many."""


@dataclass(frozen=True)
class Look:
    """A member as rays and those of plane sections meet it, its energy, and the objective: that with the excess."""

    view: View
    sections: View
    energy: float
    objective: float


class Landscape:
    """The energy over the members that rays see which were laid for one of them, `start`."""

    def __init__(
        self,
        basis: WorkingBasis,
        placed: PlacedContacts,
        mean_alpha: Floats,
        energy: Energy,
        limits: FairnessLimits,
        start: Floats,
        rays: int | None = None,
    ) -> None:
        self.energy = energy
        center, scale = np.array(to_floats(basis.frame.origin)), to_float(basis.frame.scale)
        columns = [start @ coefficients for coefficients in basis.coefficients]
        number = rays or max(LEAST_RAYS, RAYS_PER_UNKNOWN * basis.size)
        directions = Directions.of(basis.partition, columns, basis.degree, number, DEEPEST)
        slope = abs(float(mean_alpha @ start))
        neighbours = [neighbour(join, scale) for join in placed.joins]
        radii, distances = zip(*((n.radius, n.distance) for n in neighbours), strict=True)
        self.sizes = Sizes(float(np.mean(radii)), float(np.mean(distances)))
        self.sight = Sight(basis, directions, center, slope)
        self.excess = SurfaceExcess(directions, neighbours, limits, center, self.sizes.radius)
        self.sections = SectionExcess(basis, columns, neighbours, limits)
        self.across = Sight(basis, self.sections.rays, center, slope)
        self.first = self._first(start)

    def _first(self, start: Floats) -> Look | None:
        """The start as it is seen; None where it cannot be seen along all rays."""
        view = self.sight.view(start, self.sight.rays.distances)
        sections = self.across.view(start, self.sections.rays.distances)
        if view is None or sections is None:
            return None
        self.sections.settle_signs(sections)
        self._check(view)
        return self._look(view, sections)

    def of(self, energy: Energy) -> Landscape:
        """The same rays for another energy."""
        if energy == self.energy:
            return self
        other = copy(self)
        other.energy = energy
        return other

    def look(self, member: Floats, near: Look) -> Look | None:
        """Another member, found from one near by; None where it cannot be seen along all rays."""
        view = self.sight.view(member, near.view.distances)
        sections = None if view is None else self.across.view(member, near.sections.distances)
        return None if view is None or sections is None else self._look(view, sections)

    def _look(self, view: View, sections: View) -> Look:
        r = self.energy.residuals(view.points, self.sizes)
        energy = float(view.areas @ (r * r).sum(axis=1))
        beyond = [e.values for e in (*self.excess.values(view), *self.sections.values(sections))]
        return Look(view, sections, energy, energy + sum(float(v @ v) for v in beyond))

    def linearised(self, look: Look) -> tuple[Floats, Floats]:
        """Residuals (R,), whose squares add up to the objective, and their derivatives by the member (R, m)."""
        view = look.view
        r = self.energy.residuals(view.points, self.sizes)
        root = np.sqrt(view.areas)[:, None]
        slopes = np.empty((*r.shape, AREA + 1))
        slopes[:, :, :AREA] = root[:, :, None] * self.energy.slopes(view.points, self.sizes)
        slopes[:, :, AREA] = root * r / 2
        change = self.sight.change(view)
        blocks, values = [change.jacobian(slopes)], [(root * r).ravel()]
        for excess in self.excess.values(view):
            blocks.append(change.jacobian(excess.slopes[:, None], excess.chosen))
            values.append(excess.values)
        wrong = list(self.sections.values(look.sections))
        if wrong:
            change = self.across.change(look.sections)
            blocks += [change.jacobian(excess.slopes[:, None], excess.chosen) for excess in wrong]
            values += [excess.values for excess in wrong]
        return np.concatenate(values), np.concatenate(blocks)

    def _check(self, view: View) -> None:
        """That residuals and slopes have their shapes, are finite and agree, at some points."""
        points = view.points[:: max(1, len(view.points) // CHECKED)]
        kind, r = self.energy.kind, np.asarray(self.energy.residuals(points, self.sizes))
        if r.ndim != 2 or len(r) != len(points) or not np.isfinite(r).all():
            wrong = f"shape {r.shape}" if r.ndim != 2 or len(r) != len(points) else "values that are not finite"
            raise ValueError(
                f"the residuals of the energy {kind!r} must be finite, of shape (N, R) for N points: {wrong} "
                f"for {len(points)}"
            )
        slopes = np.asarray(self.energy.slopes(points, self.sizes))
        if slopes.shape != (*r.shape, AREA) or not np.isfinite(slopes).all():
            wrong = f"shape {slopes.shape}" if slopes.shape != (*r.shape, AREA) else "values that are not finite"
            raise ValueError(f"the slopes of the energy {kind!r} must be finite, of shape {(*r.shape, AREA)}: {wrong}")
        found = differences(lambda moved: self.energy.residuals(moved, self.sizes), points)
        off = np.abs(slopes - found) > WRONG * (np.abs(found).max(axis=(0, 2), initial=0.0)[:, None] + np.abs(found))
        share = off.mean(axis=0)
        if share.max(initial=0.0) > SHARE:
            number, column = np.unravel_index(share.argmax(), share.shape)
            at = int(off[:, number, column].argmax())
            raise ValueError(
                f"the slopes of the energy {kind!r} disagree with its residuals: that of residual {number} by "
                f"quantity {column} ({NAMES[column]}) is {shown(float(slopes[at, number, column]))} at a point where "
                f"differences give {shown(float(found[at, number, column]))}; leave slopes away to have differences"
            )
