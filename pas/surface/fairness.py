"""The fairness of a surface: its curvature beside that of its neighbours, measured on rays from the centre.

Curvatures are compared with what cannot be avoided: the largest curvature with that of the neighbours on
their contact curves (`sharpness`: 1 for a blend nowhere sharper than its thinnest pipe), the largest concave
one with the largest arcs that fit between two neighbours (`hollowness`: 1 for these arcs, 0 where none fits).
All is measured on a stated number of points, and a feature between them is missed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from pas.algebra.inputs import shown_point
from pas.algebra.lengths import spiral
from pas.algebra.rational import to_float
from pas.arrays import Floats
from pas.errors import GeometryError
from pas.limits import checkpoint
from pas.surface.directions import AROUND, Directions, circle, planes, runs
from pas.surface.fairness_limits import (
    FairnessLimits,
    Neighbour,
    check_limits,
    largest_arc,
    neighbour,
    sharpest_of,
    widest,
)
from pas.surface.function import PiecewisePolynomial
from pas.surface.geometry import FIRST, SECOND, Geometry
from pas.surface.straight_runs import straight_runs, waists

RAYS = 4000
"""Rays that the surface is looked at along; some more where contact curves cross."""


UNITS = SHARP, HOLLOW, BULGE, WRONG, NARROW = 0.02, 0.5, 0.1, 0.05, 0.03
"""Units in which what is beyond the limits counts: of sharpness, hollowness, bulge, wrong-sign curvature and waist."""

Place = tuple[float, float, float]


@dataclass(frozen=True)
class Fairness:
    """Measures of one surface, in the user's units or without any: Python's numbers, all of them finite.

    `sharpness`: the largest |principal curvature| over the neighbours' largest on their contact curves (that of their
    largest radius where all are flat), `sharpest` where.  `hollowness`: the largest concave curvature times `arc`, the
    radius of the largest arc that fits between two neighbours' walls within their clips, `hollowest` where; both are 0
    where none fits, as between two pipes on one axis, so no limit is passed.  `bulge`: how far the surface leaves
    the hull of the contact curves and of a ball of the largest radius around the centre, over that radius.
    `wrong_sign`: the largest curvature of a plane section through two neighbours' axes that bends against the rest
    of it, times the largest radius; `inflections`: how often such sections turn.  `waist`: how far the surface
    leaves the straight tube between two neighbours in line, inwards or outwards, where no other is near, over its
    smaller radius (see `pas.surface.straight_runs`), `waisted` where; 0 where none are in line.
    `variation`: r^2 * integral
    |grad S|^2 dA, r the mean radius, S the shape operator; `bending`: integral of k1^2 + k2^2 dA; `area`; `gradients`:
    least and largest |grad f| over its median.  `points`: how many points were looked at.
    """

    sharpness: float
    sharpest: Place
    hollowness: float
    hollowest: Place
    arc: float
    bulge: float
    wrong_sign: float
    inflections: int
    waist: float
    waisted: Place
    variation: float
    bending: float
    area: float
    gradients: tuple[float, float]
    points: int

    def __repr__(self) -> str:
        return (
            f"<Fairness: sharpness {self.sharpness:.2f}, {f'hollowness {self.hollowness:.2f}, ' if self.arc else ''}"
            f"bulge {self.bulge:.2f}, wrong sign {self.wrong_sign:.2f}, waist {self.waist:.3f}>"
        )

    def to_record(self) -> dict[str, Any]:
        """A JSON-ready form."""
        return dict(vars(self))

    def within(self, limits: FairnessLimits) -> bool:
        """Whether all measures are within limits; raises `TypeError` for what is none."""
        return not self.beyond(limits)

    def beyond(self, limits: FairnessLimits) -> tuple[str, ...]:
        """Which measures are beyond limits: a few words each."""
        words, checks = {"wrong_sign": "wrong-sign curvature"}, self._checks(limits)
        return tuple(f"{words.get(n, n)} {value:.3g} above {most:g}" for n, value, most, _ in checks if value > most)

    def excess(self, limits: FairnessLimits) -> float:
        """How far beyond limits the measures are, in all, each over its unit; 0 within them."""
        return sum(max(0.0, value - most) / unit for _, value, most, unit in self._checks(limits))

    def inside(self, limits: FairnessLimits, times: float) -> FairnessLimits:
        """Limits that are `times` as far inside these as the measures are beyond them."""
        checks = self._checks(limits)
        moved = {name: max(most - times * max(0.0, value - most), most / 2) for name, value, most, _ in checks}
        return replace(limits, **moved)

    def _checks(self, limits: FairnessLimits) -> Iterator[tuple[str, float, float, float]]:
        """The name, value, limit and unit of each measure that is limited."""
        for (name, most), unit in zip(vars(check_limits(limits)).items(), UNITS, strict=True):
            yield name, getattr(self, name), most, unit

    def lines(self) -> list[tuple[str, str]]:
        """The measures in words, each with its name."""
        low, high = self.gradients
        turns = {0: "nowhere", 1: "once"}.get(self.inflections, f"{self.inflections} times")
        hollow, waist = "none: no arc fits between two neighbours", "no run"
        if self.arc:
            hollow = f"{self.hollowness:.3f} of the largest arc that fits, at {shown_point(self.hollowest)}"
        if self.waist:
            waist = f"{self.waist:.3f} of the radius of the run, at {shown_point(self.waisted)}"
        return [
            ("sharpness", f"{self.sharpness:.3f} of the sharpest neighbour, at {shown_point(self.sharpest)}"),
            ("hollowness", hollow),
            ("bulge", f"{self.bulge:.3f} of the largest radius beyond the hull of the contacts"),
            ("wrong sign", f"{self.wrong_sign:.3f} over the largest radius; sections turn {turns}"),
            ("waist", waist),
            ("variation", f"{self.variation:.4g}, bending {self.bending:.4g}, area {self.area:.4g}"),
            ("|grad f|", f"{low:.2f} to {high:.2f} of its median"),
            ("measured", f"at {self.points} points"),
        ]

    def __str__(self) -> str:
        return "\n".join(f"{name:<13} {value}" for name, value in self.lines())

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in self.lines())
        return f"<table>{rows}</table>"


def fairness(surface: PiecewisePolynomial, rays: int = RAYS) -> Fairness:
    """Measure a surface on about `rays` rays from its centre.

    Raises `GeometryError` for a surface without a region, a centre inside it or a contact that meets a face of it.
    """
    return _Measuring(surface, rays).fairness()


class _Measuring:
    def __init__(self, surface: PiecewisePolynomial, rays: int) -> None:
        if surface.partition.center is None or not surface.partition.cells or not surface.contacts:
            raise GeometryError("fairness is measured on rays from the centre of a region with contacts; there is none")
        self.surface, self.degree = surface, surface.degree
        self.scale = to_float(surface.partition.frame.scale)
        self.columns = surface.evaluator.columns
        if any(column[0] >= 0 for column in self.columns):
            raise GeometryError("fairness is measured on rays from the centre, and it is not inside the surface")
        if not self.neighbours:
            raise GeometryError("fairness is measured beside neighbours, and no face of the region has a contact curve")
        self.rays = Directions.of(surface.placed, self.columns, surface.degree, rays)
        if not len(self.rays.directions):
            raise GeometryError("fairness is measured on rays from the centre, and none of them meets the surface")

    @cached_property
    def neighbours(self) -> list[Neighbour]:
        return [neighbour(join, self.scale) for join in self.surface.joins if np.isfinite(join.radius)]

    def fairness(self) -> Fairness:
        local = self.rays.directions * self.rays.distances[:, None]
        geometry = Geometry(self.surface.evaluator.batch(0, 1, 2, 3)(local, self.rays.pieces))
        curvatures = geometry.principal / self.scale
        cosines = np.maximum((geometry.normals * self.rays.directions).sum(axis=1), 1e-6)
        areas = self.rays.solid_angles * self.rays.distances**2 / cosines * self.scale**2
        squares = (geometry.variation**2).sum(axis=(1, 2, 3)) / self.scale**4
        radii = [n.radius for n in self.neighbours]
        sharpest, hollowest = int(np.abs(curvatures).max(axis=1).argmax()), int(curvatures[:, 1].argmin())
        lengths = geometry.length / np.median(geometry.length)
        wrong, turns = self.sections()
        arc = largest_arc(self.neighbours)
        narrowest, waisted = self.waist(local * self.scale)
        return Fairness(
            sharpness=float(np.abs(curvatures[sharpest]).max()) / sharpest_of(self.neighbours),
            sharpest=self.surface.partition.frame.place(local[sharpest]),
            hollowness=max(0.0, -float(curvatures[hollowest, 1])) * arc,
            hollowest=self.surface.partition.frame.place(local[hollowest]),
            arc=arc,
            bulge=self.bulge(local * self.scale, widest(self.neighbours)),
            wrong_sign=wrong,
            inflections=turns,
            waist=narrowest,
            waisted=self.surface.partition.frame.place(local[waisted]),
            variation=float(np.mean(radii)) ** 2 * float(areas @ squares),
            bending=float(areas @ (curvatures**2).sum(axis=1)),
            area=float(areas.sum()),
            gradients=(float(lengths.min()), float(lengths.max())),
            points=len(local),
        )

    def bulge(self, points: Floats, radius: float) -> float:
        """How far points, relative to the centre, are beyond the hull, over the largest radius."""
        ball = 400  # points of the ball around the centre that belongs to the hull
        hull = ConvexHull(np.concatenate([radius * spiral(ball), *(n.curve for n in self.neighbours)]))
        points = np.concatenate([points, np.zeros((1, 3))])  # with the centre, which a flat surface keeps away from
        outermost = points[ConvexHull(points).vertices]
        some = (hull.equations[start : start + 256] for start in range(0, len(hull.equations), 256))
        far = max(float(((outermost @ planes[:, :3].T).max(axis=0) + planes[:, 3]).max()) for planes in some)
        return max(0.0, far) / radius

    def waist(self, points: Floats) -> tuple[float, int]:
        """How far points, relative to the centre, leave the straight runs, and which of them does most; (0, 0) where
        there is no run."""
        runs = straight_runs(self.neighbours)
        if not runs:
            return 0.0, 0
        far = np.abs(waists(runs, points))
        return float(far.max()), int(far.argmax())

    def sections(self) -> tuple[float, int]:
        """The largest wrong-sign curvature over the largest radius, and all inflections, of plane sections."""
        most = widest(self.neighbours)
        straight = 0.03 / most  # curvature below which a section counts as straight: no inflection there
        wrong, turns = 0.0, 0
        for first, second in planes([n.mean for n in self.neighbours]):
            checkpoint("measuring sections")
            for curvature in self.section(first, second):
                sign = np.sign(curvature.sum())
                wrong = max(wrong, float((-sign * curvature).max()) * most)
                bent = np.sign(curvature[np.abs(curvature) > straight])
                turns += int((bent[1:] != bent[:-1]).sum())
        return wrong, turns

    def section(self, first: Floats, second: Floats) -> Iterator[Floats]:
        """Curvatures along the parts of the section in the plane of two unit vectors, between neighbours."""
        shortest_run = 6  # points of a section between two neighbours below which nothing is said of it
        rays, numbers = Directions.along(self.surface.placed, self.columns, self.degree, circle(first, second))
        local = rays.directions * rays.distances[:, None]
        jet = self.surface.evaluator.batch(0, 1, 2)(local, rays.pieces)
        normal = np.cross(first, second)
        slope = jet[:, FIRST] - (jet[:, FIRST] @ normal)[:, None] * normal
        length = np.linalg.norm(slope, axis=1)
        tangent = np.cross(normal, slope / length[:, None])
        curvature = np.einsum("ni,nij,nj->n", tangent, jet[:, SECOND], tangent) / length / self.scale
        place = np.full(AROUND, -1)
        place[numbers] = np.arange(len(numbers))
        for run in runs(place >= 0):
            if len(run) >= shortest_run:
                yield curvature[place[run]]
