"""Straight runs: tubes that continue one another through a node, as the run of a T does behind its branch.

Two neighbours make a run where each leaves its contact curve like a tube, along its axis and round, and their axes lie
on one line, or meet in the centre and bend by 30 degrees at the most; three of a star of equal angles and radii, as of
a Y, make three.  A run that bends follows the arc tangent to both axes.  A contact in a run continues no other.  Two
neighbours do not run through a wider run, inside of which their tube is hidden: they are branches on its sides, round
each of which goes a fillet.  Away from other contacts the fair surface along a run is the tube between its two ends:

    d = |x - foot| - R(s)          how far a point x is outside of it
    w = prod_k s(1 - 2 c_k)        0 towards another contact k and 1 away from it, less where another run crosses

with s the length along the run, c_k the cosine of the angle, about the run, from contact k, and s(u) = 3 u^2 - 2 u^3
for u in [0, 1].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, permutations

import numpy as np

from pas.algebra.lengths import unit
from pas.arrays import Floats, Integers
from pas.surface.fairness_limits import Neighbour

ROUND = 0.01
"""How far the curve of a tube is from round about its axis, over its radius, at the most."""

IN_LINE = np.cos(np.radians(1))
"""Cosine of the angle between axes on one line, at the least."""

APART = 0.02
"""How far two axes on one line, or three through a point, may miss one another, over the smaller radius."""

BEND = np.cos(np.radians(150))
"""Cosine of the angle between the axes of a run, at the most: beyond a bend of 30 degrees a rolled tube is not the
shape that is wanted, measured on nodes in random directions."""

STAR = np.cos(np.radians(118))
"""Cosine of the angle between any two of three equal branches, at the most."""

AWAY, TOWARDS = 0.1, 0.5
"""Cosines from another contact: below the first a point belongs to the run alone and its waist is measured; above the
second it belongs to the other."""


@dataclass(frozen=True)
class StraightEnd:
    """A neighbour that leaves its curve like a tube, relative to the centre.

    `foot` (3,): the point of its axis next to the centre; `axis` (3,): unit, outwards; `length`: from the foot to the
    curve, in the mean; `radius`.
    """

    foot: Floats
    axis: Floats
    length: float
    radius: float


@dataclass(frozen=True, eq=False)
class StraightRun:
    """The tube between two neighbours, in the user's units and relative to the region's centre.

    `contacts`: their numbers.  `middle` (3,): where the axes meet, or a point of their line; `first`, `second` (3,):
    the unit axes, outwards; `lengths`, `radii`: those of the two; `branches` (K, 3): unit vectors across the run
    towards other contacts.
    """

    contacts: tuple[int, int]
    middle: Floats
    first: Floats
    second: Floats
    lengths: tuple[float, float]
    radii: tuple[float, float]
    branches: Floats

    @property
    def radius(self) -> float:
        """The smaller one."""
        return min(self.radii)

    @cached_property
    def half(self) -> float:
        """Half of the angle between the axes: pi / 2 for those on one line."""
        turn = float(self.first @ self.second)
        return np.pi / 2 if turn < -IN_LINE else float(np.arccos(turn)) / 2

    @cached_property
    def tangent(self) -> float:
        """From where the axes meet to the ends of the arc; 0 on one line."""
        return min(self.lengths) if self.half < np.pi / 2 else 0.0

    @cached_property
    def reach(self) -> tuple[float, float]:
        """The lengths of the middle line from its middle to both ends."""
        arc = self.tangent * np.tan(self.half) * (np.pi / 2 - self.half) if self.tangent else 0.0
        first, second = (length - self.tangent + arc for length in self.lengths)
        return first, second

    def seen(self, points: Floats) -> tuple[Floats, Floats]:
        """How far points (N, 3) are outside of the tube (N,), and the cosines (N, K) from other contacts; both are nan
        for points beyond the ends."""
        across, along = self._across(points - self.middle)
        far = np.linalg.norm(across, axis=1)
        eased = _eased((along + self.reach[1]) / sum(self.reach))
        distance = far - (self.radii[1] + (self.radii[0] - self.radii[1]) * eased)
        inside = (along > -self.reach[1]) & (along < self.reach[0])
        cosines = (across @ self.branches.T) / np.maximum(far, 1e-12)[:, None]
        return np.where(inside, distance, np.nan), np.where(inside[:, None], cosines, np.nan)

    def _across(self, points: Floats) -> tuple[Floats, Floats]:
        """The vectors (N, 3) from the middle line to points relative to `middle`, and the lengths (N,) along it from
        its middle, negative towards the second end."""
        if not self.tangent:
            along = points @ self.first
            return points - along[:, None] * self.first, along
        inward, onward = unit(self.first + self.second), unit(self.first - self.second)
        bend = self.tangent * np.tan(self.half)
        turned = points - inward * self.tangent / np.cos(self.half)  # from the centre of the arc
        flat = (turned @ inward)[:, None] * inward + (turned @ onward)[:, None] * onward
        angle = np.arctan2(flat @ onward, -flat @ inward)
        most = np.pi / 2 - self.half
        axis = np.where(angle[:, None] > 0, self.first, self.second)
        straight = (points * axis).sum(axis=1)
        on_arc = np.abs(angle) <= most
        from_arc = turned - flat * (bend / np.maximum(np.linalg.norm(flat, axis=1), 1e-12))[:, None]
        across = np.where(on_arc[:, None], from_arc, points - straight[:, None] * axis)
        return across, np.where(on_arc, bend * angle, np.sign(angle) * (bend * most + straight - self.tangent))


def guided(runs: Sequence[StraightRun], points: Floats) -> tuple[Floats, Floats]:
    """How far points (N, 3) are outside of the tube of each run and how much they belong to it, both (N, M).

    The second is 1 for those that are in its own part, 0 beyond its ends and towards other contacts.  Where runs cross,
    points belong to the one whose tube is outside of the other's there, by halves where they agree.
    """
    distances, cosines = _seen(runs, points)
    shares = np.stack([_eased((TOWARDS - c) / TOWARDS).prod(axis=1) for c in cosines], axis=1)
    far = np.nan_to_num(distances)  # large beyond the ends, where both may be
    for a, b in permutations(range(len(runs)), 2):
        ahead = np.clip(far[:, b] - far[:, a], -runs[b].radius, runs[b].radius)
        # How far one tube must be outside of another, over the other's radius, so that points there belong to it alone.
        crossing = 0.2
        shares[:, a] *= _eased(0.5 + ahead / (crossing * runs[b].radius))
    return np.nan_to_num(distances, posinf=0.0), shares


def waists(runs: Sequence[StraightRun], points: Floats) -> Floats:
    """How far points (N, 3) leave the tube of the run that they belong to, over its smaller radius, negative inwards
    (N,); 0 for those that belong to none."""
    found, owner = np.zeros(len(points)), owners(runs, points, 2.0)
    for number, run in enumerate(runs):
        here = owner == number
        found[here] = run.seen(points[here])[0] / run.radius
    return found


def owners(runs: Sequence[StraightRun], points: Floats, within: float = np.inf) -> Integers:
    """The number of the run that each point (N, 3) belongs to, within so many of its radii from its tube; -1 for
    none (N,)."""
    distances, cosines = _seen(runs, points)
    near = np.abs(distances) < within * np.array([run.radius for run in runs])
    own = np.stack([(c <= AWAY).all(axis=1) for c in cosines], axis=1) & near & np.isfinite(distances)
    outermost = distances.argmin(axis=1)
    return np.where(np.take_along_axis(own, outermost[:, None], axis=1)[:, 0], outermost, -1)


def _seen(runs: Sequence[StraightRun], points: Floats) -> tuple[Floats, list[Floats]]:
    """The distances (N, M) from the tubes, infinite beyond their ends, and for each the cosines (N, K) from other
    contacts, 1 there."""
    seen = [run.seen(points) for run in runs]
    distances = np.stack([np.nan_to_num(d, nan=np.inf) for d, _ in seen], axis=1)
    return distances, [np.nan_to_num(c, nan=1.0) for _, c in seen]


def _eased(u: Floats) -> Floats:
    """0 below 0, 1 above 1, and smooth."""
    u = np.clip(u, 0, 1)
    return np.asarray(u * u * (3 - 2 * u))


def straight_runs(neighbours: Sequence[Neighbour]) -> tuple[StraightRun, ...]:
    """The runs between neighbours: pairs on one line, where they cross the widest of them, and the three of a star of
    equal angles around the centre."""
    # Mean radius of a run over that of a wider one that it crosses, at the least. The sides of two tubes meet at
    # an angle whose cosine is that ratio, and a fillet of 3/5 of the wider radius leaves them by 0.008 of it
    # there, by 0.016 at 0.9 and 0.033 at 0.8. Measured at right angles, both runs are within 0.03 at 0.95, and no
    # more so at 0.9.
    through = 0.95
    tubes = {number: tube for number, one in enumerate(neighbours) if (tube := _tube(one)) is not None}
    pairs: list[tuple[int, int]] = []
    for i, j in sorted(combinations(tubes, 2), key=lambda pair: float(tubes[pair[0]].axis @ tubes[pair[1]].axis)):
        if _continue(tubes[i], tubes[j], BEND) and not any(k in pair for pair in pairs for k in (i, j)):
            pairs.append((i, j))
    widths = [tubes[i].radius + tubes[j].radius for i, j in pairs]
    pairs = [pair for pair, width in zip(pairs, widths, strict=True) if width >= through * max(widths)]
    if not pairs and len(neighbours) == 3:
        each = list(combinations(tubes.values(), 2))
        alike = all(abs(a.radius - b.radius) <= ROUND * a.radius and _continue(a, b, STAR) for a, b in each)
        pairs = list(combinations(tubes, 2)) if alike else []
    means = {number: one.mean for number, one in enumerate(neighbours)}
    return tuple(_run(i, j, tubes, [m for k, m in means.items() if k not in (i, j)]) for i, j in pairs)


def _tube(one: Neighbour) -> StraightEnd | None:
    """A neighbour as a tube; None for those that are none, as cones, plates and flat ovals."""
    if one.normal is not None:
        return None
    axis = np.linalg.svd(one.normals, full_matrices=False)[2][2]
    axis = axis if float(axis @ one.mean) > 0 else -axis
    sides = np.linalg.svd(axis[None])[2][1:]
    flat = one.curve @ sides.T  # |p|^2 = 2 c p + const on a circle
    center = np.linalg.lstsq(np.c_[2 * flat, np.ones(len(flat))], (flat**2).sum(axis=1), rcond=None)[0][:2]
    far = np.linalg.norm(flat - center, axis=1)
    radius = float(far.mean())
    is_round = float(np.abs(far - radius).max()) <= ROUND * radius
    # Cosine between a tube's axis and its surface's normals, and curvature along it times the radius, at the most:
    # cones, spheres and tori are no tubes.
    along = 0.02
    is_tube = is_round and max(float(np.abs(one.normals @ axis).max()), radius * one.across) <= along
    return StraightEnd(center @ sides, axis, float((one.curve @ axis).mean()), radius) if is_tube else None


def _continue(a: StraightEnd, b: StraightEnd, most: float) -> bool:
    """Whether two tubes continue one another: they turn little, and lie on one line or meet in the centre."""
    central = all(float(np.linalg.norm(one.foot)) <= APART * one.radius for one in (a, b))
    return _on_one_line(a, b) or (central and float(a.axis @ b.axis) < most)


def _on_one_line(a: StraightEnd, b: StraightEnd) -> bool:
    missed = float(np.linalg.norm(a.foot - b.foot))
    return float(a.axis @ b.axis) < -IN_LINE and missed <= APART * min(a.radius, b.radius)


def _run(i: int, j: int, tubes: Mapping[int, StraightEnd], others: Sequence[Floats]) -> StraightRun:
    # Sine of the angle between a run and another contact, at the least, for that to be a branch of it: towards
    # one nearer to its axis there is no side.
    aside = 0.15
    a, b = tubes[i], tubes[j]
    onward = unit(a.axis - b.axis)
    across = [mean - (mean @ onward) * onward for mean in others]
    branches = [
        unit(v) for v, mean in zip(across, others, strict=True) if np.linalg.norm(v) > aside * np.linalg.norm(mean)
    ]
    line = _on_one_line(a, b)
    return StraightRun(
        (i, j),
        a.foot if line else np.zeros(3),
        onward if line else a.axis,
        -onward if line else b.axis,
        (a.length, b.length),
        (a.radius, b.radius),
        np.array(branches).reshape(-1, 3),
    )
