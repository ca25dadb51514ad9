"""Fans: half-planes through one axis.

The generalisation of the six tetrahedra: two opposite rays carry any number of arcs, and every contact lies between
two neighbouring half-planes.  Each further half-plane adds freedom without a further point where arcs meet.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise, product
from math import cos, degrees, gcd, pi, radians, sin

import numpy as np

from pas.algebra.lengths import across, unit
from pas.algebra.rational import Vector, three
from pas.arrays import Floats
from pas.errors import GeometryError
from pas.layouts.discs import Disc, check_fits, first_made, turn, whole_ray
from pas.partition.layout import Layout, Ray

LONGEST_AXIS = 4
"""Largest entry of an axis: longer ones lengthen the numbers of the algebra, and gained little."""

LENGTHS = (10, 16, 24, 40)
"""Entries of the rays, tried in turn until every disc fits."""


@dataclass(frozen=True)
class Gaps:
    """The discs as they lie around an axis, in order: `middles` and `halves` of the azimuths (radians) they take up."""

    axis: Ray
    frame: Floats
    middles: tuple[float, ...]
    halves: tuple[float, ...]

    @property
    def sizes(self) -> list[float]:
        """The azimuth (radians) from each disc to the next."""
        after = [*self.middles[1:], self.middles[0] + 2 * pi]
        widths = [*self.halves[1:], self.halves[0]]
        return [n - m - h - g for m, n, h, g in zip(self.middles, after, self.halves, widths, strict=True)]


def fan(discs: Sequence[Disc], center: Vector, each: int = 2) -> Layout:
    """The fan around the axis with the largest smallest gap, with so many half-planes in `each` gap.

    Raises `GeometryError` where no axis has room between all discs.
    """
    gaps = best_gaps(discs)
    return first_made(partial(_with_rays, discs, center, gaps, each, longest) for longest in LENGTHS)


def best_gaps(discs: Sequence[Disc]) -> Gaps:
    """The axis with the largest smallest gap between discs; raises `GeometryError` where there is none."""
    axes, poles, frames = _axes()
    directions, angles = np.array([disc.direction for disc in discs]), np.array([disc.angle for disc in discs])
    shares = np.sin(angles) / np.sqrt(np.maximum(1 - (poles @ directions.T) ** 2, 1e-18))
    # Sine of the azimuth that a disc may take up: those that reach an axis' pole lie between no two half-planes.
    near_axis = 0.97
    here = np.flatnonzero(((shares <= near_axis) & (angles <= pi / 2)).all(axis=1))
    first, second = np.moveaxis(frames[here] @ directions.T, 1, 0)
    middles, halves = np.arctan2(second, first), np.arcsin(shares[here])
    order = middles.argsort(axis=1, kind="stable")
    middles, halves = np.take_along_axis(middles, order, axis=1), np.take_along_axis(halves, order, axis=1)
    sizes = np.diff(middles, axis=1, append=middles[:, :1] + 2 * pi) - halves - np.roll(halves, -1, axis=1)
    least = sizes.min(axis=1)
    price = 0.004  # radians of gap that one more in an axis' entries is worth
    worth = least - price * np.abs(np.array(axes)[here]).sum(axis=1)
    same = 1e-9  # radians below which axes count as equally good: the first is taken, the same one on all machines
    best = int((worth > worth.max(initial=-np.inf) - same).argmax()) if len(here) else -1
    # Azimuth between two discs below which no fan is made: there half-planes would nearly coincide.
    least_gap = radians(2.3)
    if best < 0 or least[best] < least_gap:
        found = "" if best < 0 else f" (the best leaves a gap of {degrees(least[best]):.2g} degrees)"
        raise GeometryError(f"no fan of half-planes through one axis keeps the {len(discs)} contacts apart{found}")
    number = int(here[best])
    return Gaps(axes[number], frames[number], tuple(middles[best].tolist()), tuple(halves[best].tolist()))


@lru_cache(maxsize=1)
def _axes() -> tuple[list[Ray], Floats, Floats]:
    """All short axes, one of each two opposite ones; their unit vectors (N, 3), and the frames (N, 2, 3) across."""
    span = range(-LONGEST_AXIS, LONGEST_AXIS + 1)
    axes = [axis for axis in product(span, span, span) if axis > (0, 0, 0) and gcd(*axis) == 1]
    poles = unit(np.array(axes))
    return axes, poles, np.array([across(pole) for pole in poles])


def _with_rays(discs: Sequence[Disc], center: Vector, gaps: Gaps, each: int, longest: int) -> Layout:
    rays = [whole_ray(np.array([cos(a), sin(a)]) @ gaps.frame, longest) for a in _azimuths(gaps, each)]
    first, second = gaps.frame @ np.array(rays, dtype=float).T
    turned = np.arctan2(second, first)
    for a, b in pairwise([*turned, turned[0]]):
        if not 0.01 < turn(a, b) < pi:  # else two nearly coincide, or a piece between them is half a turn
            raise GeometryError(f"two half-planes of a fan are {degrees(turn(a, b)):.2g} degrees apart")
    count = len(rays)
    layout = Layout(
        [gaps.axis, three(-c for c in gaps.axis), *rays],
        [(0, 2 + h, 1, 2 + (h + 1) % count) for h in range(count)],
        center,
        f"fan of {count} half-planes around {gaps.axis}",
    )
    check_fits(layout, discs)
    return layout


def _azimuths(gaps: Gaps, each: int) -> list[float]:
    """The azimuths of the half-planes."""
    wide = 60  # degrees of a gap for each of which, after the first, one more half-plane is put in
    found = []
    for middle, half, size in zip(gaps.middles, gaps.halves, gaps.sizes, strict=True):
        number = each + max(0, int(degrees(size) // wide) - 1)
        low = max(0.15, min(0.36, 0.07 / max(size, 1e-3)))  # shares of a gap, between them 0.07 radians from discs
        shares = [0.5] if number == 1 else [low + (1 - 2 * low) * i / (number - 1) for i in range(number)]
        found += [middle + half + size * share for share in shares]
    return found
