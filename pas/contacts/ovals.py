"""Ovals of plane algebraic curves of any degree: closed branches, followed from exact points of theirs.

Every oval touches lines of any direction on either side, so the points where the curve does so (exact real zeros of an
ideal) are starts that miss none, and those of two directions bound all ovals.  From there predictor and corrector go
along the curve (Allgower and Georg 1990), by steps along which the tangent turns little, until they come back or leave.

Guaranteed: what is called an oval came back to where it started, and its points are on the curve to rounding.  Not
guaranteed: that steps did not jump between branches that almost touch; what depends on a curve is proved elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pas.algebra.brief import brief
from pas.algebra.inputs import shown_point
from pas.algebra.lengths import resampled
from pas.algebra.polynomial import Polynomial
from pas.arrays import Floats
from pas.errors import GeometryError

TURN = 0.1
"""Radians that the tangent may turn along one step: an oval has 63 points at least."""


@dataclass(frozen=True, eq=False)
class Strip:
    """The strip of a plane between the least and the greatest value of `direction` (3,) at some points (N, 3) of it."""

    direction: Floats
    points: Floats

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the greatest value."""
        values = self.points @ self.direction
        return float(values.min()), float(values.max())

    @property
    def width(self) -> float:
        """How wide it is."""
        low, high = self.ends
        return (high - low) / float(np.linalg.norm(self.direction))

    def holds(self, point: Floats, slack: float) -> bool:
        """Whether a point is in it, but for a share of its width."""
        low, high = self.ends
        beyond = slack * (high - low)
        return bool(low - beyond <= point @ self.direction <= high + beyond)


@dataclass(frozen=True, eq=False)
class Oval:
    """A closed branch of `curve = 0` in a plane along whose normal the polynomial is constant.

    `polygon` holds points (m, 3) of it in order, counterclockwise seen from the tip of the normal.
    """

    curve: Polynomial
    polygon: Floats

    __repr__ = brief

    def points(self, number: int) -> Floats:
        """Points (number, 3) of the oval, about equally far apart."""
        around = np.vstack([self.polygon, self.polygon[:1]])
        return settled(self.curve, resampled(around, number, last=False))

    def centroid(self) -> Floats:
        """The centroid (3,) of the area that the polygon encloses."""
        middle = self.polygon.mean(axis=0)
        a, b = self.polygon - middle, np.roll(self.polygon, -1, axis=0) - middle
        areas = np.cross(a, b) @ _area(self.polygon)
        return np.asarray(middle + areas @ (a + b) / (3 * areas.sum()))


def settled(surface: Polynomial, points: Floats, corrections: int = 3) -> Floats:
    """Points (N, 3) moved onto a surface, as one that cuts out a curve in a plane, by `corrections` steps of Newton's
    method: from half a step's turn on a curve three reach rounding."""
    for _ in range(corrections):
        slopes = surface.gradient(points)
        points = points - (surface(points) / (slopes**2).sum(axis=-1))[..., None] * slopes
    return points


def ovals(curve: Polynomial, normal: Floats, strips: Sequence[Strip]) -> tuple[list[Oval], bool]:
    """The closed branches of a curve, each once, and whether there was an open one, too.

    `curve` is constant along the `normal` (3,) of its plane; the `strips` of two directions hold all regular points at
    which their direction is greatest or least nearby.

    Raises `GeometryError` where a branch runs into a singular point.
    """
    found: list[Floats] = []
    closed, opened = [], False
    if any(strip.width == 0 for strip in strips):
        return [], True
    for start in strips[0].points:
        if any(_passes(path, start) for path in found):
            continue
        path, returned = follow(curve, normal, start, strips)
        found.append(path)
        opened |= not returned
        if returned:
            turned = _area(path) @ normal < 0
            closed.append(Oval(curve, path[::-1] if turned else path))
    return closed, opened


def follow(curve: Polynomial, normal: Floats, start: Floats, strips: Sequence[Strip]) -> tuple[Floats, bool]:
    """The points (m, 3) of the branch through a start in order, and whether it came back there."""
    outside = 1e-6  # over the same: how far outside the bounds of all ovals a point must be to count as outside
    extent = max(strip.width for strip in strips)
    longest_step = 1 / 40  # over the extent of the bounds
    longest = longest_step * extent
    points, at, way, step = [start], start, _tangent(curve, normal, start), longest / 10
    most_steps = 20_000  # along one branch: an oval within the bounds that takes more is as good as open
    while len(points) < most_steps and all(strip.holds(at, outside) for strip in strips):
        ahead = settled(curve, (at + step * way)[None])[0]
        direction = _tangent(curve, normal, ahead)
        moved = float(np.linalg.norm(ahead - at))
        if not (direction @ way > np.cos(TURN) and 0.5 * step < moved < 1.5 * step):
            step /= 2
            shortest_step = 1e-9  # over the extent: below it the curve has a singular point there
            if step < shortest_step * extent:
                raise GeometryError(f"the contact's curve has a singular point at {shown_point(at, 6)}")
            continue
        if len(points) > 2 and 0 < (start - at) @ way <= moved and np.linalg.norm(start - at) <= 1.5 * moved:
            return np.array(points), True
        points.append(ahead)
        at, way = ahead, direction
        step = min(1.5 * step, longest)
    return np.array(points), False


def _tangent(curve: Polynomial, normal: Floats, point: Floats) -> Floats:
    along = np.cross(normal, curve.gradient(point))
    length = np.linalg.norm(along)
    return np.asarray(along / length) if length > 0 else np.zeros(3)


def _passes(path: Floats, point: Floats) -> bool:
    """Whether a path passes through a point of its curve: within a tenth of the step there."""
    a = path[:-1] if len(path) > 1 else path
    along = np.diff(path, axis=0) if len(path) > 1 else np.zeros((1, 3))
    length = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    share = np.clip(((point - a) * along).sum(axis=1) / length, 0, 1)
    distance = np.linalg.norm(a + share[:, None] * along - point, axis=1)
    return bool((distance <= TURN * np.sqrt(length)).any())


def _area(polygon: Floats) -> Floats:
    """The vector area (3,) of a closed polygon."""
    a = polygon - polygon.mean(axis=0)
    return np.asarray(np.cross(a, np.roll(a, -1, axis=0)).sum(axis=0) / 2)
