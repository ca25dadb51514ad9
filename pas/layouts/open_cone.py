"""Open regions: convex cones around a centre, cut off above an opening, with a clip face for each other contact.

One contact has all of the cone for its piece.  Around several the cone is cut into sectors by half-planes through its
axis: one around each contact, and some without.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, cos, degrees, pi

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, plain
from pas.contacts.cones import first_met, nappe
from pas.contacts.contact import Contact
from pas.errors import GeometryError
from pas.layouts.discs import Disc, power_of_two, rounded
from pas.layouts.region import Corners, around_clip
from pas.partition.cells import OpenRegion
from pas.partition.layout import primitive

CORNERS, LARGER = 12, 1.05
"""Of the polygon round the opening, and how much larger than the smallest one it is."""

BEYOND = 0.3
"""How far rays through the polygon go on beyond the opening, over the way to it, or over the other contacts' height."""

LEAST = 0.01
"""How far above the opening other contacts end at least, over its height."""

ROUND = 64
"""Parts of their length, at least, in which corners are rounded."""

WIDEST, APART = 2 * pi / 3, 0.02
"""Radians: the widest sector without a contact, and the least between two contacts, seen along the axis."""

SAMPLES = 256
"""Places on the axis where it is looked at which contacts it is inside of."""


@dataclass(frozen=True)
class Nappe:
    """The cone of an opening in coordinates relative to the centre: its axes (3, 3), see `cones.nappe`."""

    axes: Floats
    surface: Polynomial

    def azimuths(self, points: Floats) -> Floats:
        """The angles (N,) of points (N, 3) round the axis, in units in which the cone is round."""
        _, first, second = np.linalg.solve(self.axes.T, points.T)
        return np.arctan2(second, first)

    def corners(self, angles: Floats, larger: float) -> Floats:
        """Directions (N, 3) at angles, so many times as far from the axis as those of the cone."""
        around = np.cos(angles)[:, None] * self.axes[1] + np.sin(angles)[:, None] * self.axes[2]
        return unit(self.axes[0] + larger * around)


def open_cone(
    opening: Contact, number: int, discs: Sequence[Disc], surfaces: Sequence[Polynomial], center: Vector
) -> OpenRegion:
    """The region for contact `number` as the opening and the others, as they are seen from the centre.

    Raises `GeometryError` where these are not seen through the opening, or are not apart.
    """
    shift = [g + c for g, c in zip(GENERATORS, center, strict=True)]
    clip, surface, *others = (
        Polynomial.from_raw(p.raw.compose(*shift)) for p in (opening.clip, opening.surface, *surfaces)
    )
    axes = nappe(clip, np.mean([disc.middle for disc in discs], axis=0))
    axes[2] *= 1.0 if np.linalg.det(axes) > 0 else -1.0
    cone = Nappe(axes, surface)
    ends = _sectors(cone, discs) if len(discs) > 1 else []
    angles = _angles(ends)
    steps = np.diff(np.append(angles, angles[0] + 2 * pi))
    polygon = cone.corners(angles, LARGER / cos(float(steps.max()) / 2))
    for disc in discs:
        if not _within(disc.points, polygon):
            raise GeometryError(
                f"the curve of contact {disc.number} is not seen through that of contact {number} from "
                f"({', '.join(map(plain, center))}), below; make the opening wider, or the pipe shorter"
            )
    far = max(float(np.linalg.norm(disc.points, axis=1).max()) for disc in discs)
    met = first_met(surface, polygon, far)
    if not np.isfinite(met).all():
        raise GeometryError(f"contact {number}: its surface does not close the cone that clips it")
    axis = unit(axes[0])
    heights = [float((disc.points @ axis).min()) / float((met[:, None] * polygon @ axis).max()) - 1 for disc in discs]
    low = int(np.argmin(heights))
    if heights[low] <= LEAST:
        raise GeometryError(
            f"the curve of contact {discs[low].number} reaches down to contact {number}, and leaves no room"
        )
    outer = [_rounded(corner) for corner in (1 + BEYOND * min(1.0, heights[low])) * met[:, None] * polygon]
    if not ends:
        pieces = [_with_face(discs[0], outer)]
    else:
        top = _rounded(_top(axis, others, far, float(met.max())) * axis)
        places = [int(np.argmin(np.abs(angles - start))) for start, _ in ends]
        pieces = list[list[Corners]]()
        for (_, held), first, last in zip(ends, places, [*places[1:], places[0] + len(outer)], strict=True):
            ring = [outer[i % len(outer)] for i in range(first, last + 1)]
            pieces.append(_with_face(held, [top, *ring]) if held else [(top, a, b) for a, b in pairwise(ring)])
    sides = f" and {len(pieces)} sectors" if len(pieces) > 1 else ""
    return OpenRegion.of_triangles(pieces, center, f"open cone of {len(outer)} sides{sides}")


def _with_face(disc: Disc, rim: Sequence[Vector]) -> list[Corners]:
    """The far triangles of a piece around a contact's clip face."""
    return around_clip(disc, [primitive(corner) for corner in rim], rim)


def _sectors(cone: Nappe, discs: Sequence[Disc]) -> list[tuple[float, Disc | None]]:
    """Where sectors begin, by rising angles, and whose they are: one around each contact, others without."""
    found = []
    for disc in discs:
        middle = float(cone.azimuths(disc.middle[None])[0])
        away = (cone.azimuths(disc.points) - middle + pi) % (2 * pi) - pi
        if np.ptp(away) >= pi:
            raise GeometryError(
                f"contact {disc.number} is seen around the axis of the opening; several contacts must lie around it"
            )
        found.append((middle + float(away.min()), middle + float(away.max()), disc))
    found.sort(key=lambda one: one[0] % (2 * pi))
    ends: list[tuple[float, Disc | None]] = []
    for (start, end, disc), (after, _, other) in zip(found, [*found[1:], found[0]], strict=True):
        gap = (after - end) % (2 * pi)
        if not APART < gap < 2 * pi - (end - start):
            raise GeometryError(
                f"contacts {disc.number} and {other.number} are seen across one another from below the opening, "
                f"{degrees(min(gap, 2 * pi - gap)):.3g} degrees"
            )
        empty = max(0, ceil((gap + end - start - pi) / WIDEST)) if gap > pi / 2 else 0
        shares = [(1 + i) / (2 + empty) for i in range(empty + 1)]
        ends += [((end + share * gap) % (2 * pi), None) for share in shares[:-1]]
        ends.append(((end + shares[-1] * gap) % (2 * pi), other))
    return sorted(ends, key=lambda one: one[0])


def _angles(ends: Sequence[tuple[float, Disc | None]]) -> Floats:
    """The angles of the polygon's corners: where sectors begin, and between."""
    starts = [start for start, _ in ends] or [0.0]
    found: list[float] = []
    for start, end in pairwise([*starts, starts[0] + 2 * pi]):
        count = max(1, ceil(CORNERS * (end - start) / (2 * pi) - 1e-9))
        found += [start + (end - start) * i / count for i in range(count)]
    return np.array(found)


def _top(axis: Floats, others: Sequence[Polynomial], far: float, least: float) -> float:
    """How far out the region ends on the axis: beyond the opening and all other contacts' surfaces."""
    shares = np.linspace(0, far, SAMPLES)[1:]
    inside = np.min([other(shares[:, None] * axis) for other in others], axis=0) < 0
    if inside[-1]:
        raise GeometryError("the axis of the opening does not leave all other contacts, which must lie around it")
    leave = float(shares[np.flatnonzero(inside)[-1]]) if inside.any() else 0.0
    above = 1.3  # over the height at which the axis of the cone leaves all other contacts: where the region ends on it
    return above * max(leave, least)


def _rounded(corner: Floats) -> Vector:
    return rounded(corner, power_of_two(float(np.linalg.norm(corner)) / ROUND))


def _within(points: Floats, polygon: Floats) -> bool:
    """Whether directions (N, 3) are inside the cone around a polygon, counterclockwise."""
    across = unit(np.cross(polygon, np.roll(polygon, -1, axis=0)))
    return bool((unit(points) @ across.T).min() > 0)
