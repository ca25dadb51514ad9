"""How near the contacts of a node may end, of which some may end anywhere along their axis, so that all are apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import atan, ceil, cos, degrees, pi, radians, sin, tan
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.monomials import Floats
from pas.algebra.rational import Vector, cross, to_floats
from pas.contacts.contact import as_contact
from pas.contacts.endless import Endless
from pas.contacts.rims import Rim
from pas.errors import GeometryError
from pas.layouts.discs import Disc, angle_between, rim_of
from pas.layouts.nodes import center_of
from pas.surface.fairness_limits import WEDGE

SHARE = 0.6
"""Share of the angle between two contacts that their curves may take up: of 0.8 and 0.6 the strongest lever on
shape."""

LEFT = 1 / 3
"""Share of what a curve that was given leaves of such an angle, that another may take up all the same."""

WIDEST = radians(40)
"""Angular radius of a curve that is placed, at the most."""

FILLET = 0.6
"""Radius of the arc that must fit between two contacts, over that of the wider one."""

CLOSEST = radians(10)
"""Directions closer than this are refused: their clips would be very far out."""

STEP, MUCH_NEARER = 1.01, 0.6
"""Clips go outwards by this factor until they fit; then each by itself goes inwards down to that share."""

FARTHEST = 1000.0
"""How many widths out a clip may be."""

FINE, COARSEST = 64, 1 / 2
"""Parts of its axis to which a clip is rounded, up; more where they are longer than this share of the width."""


@dataclass(frozen=True)
class Arm:
    """One contact from the centre: along a unit vector (3,), `width(distance)` its radius at a distance.

    `given` is that of one with an end, None else.
    """

    direction: Floats
    width: Callable[[float], float]
    given: float | None = None

    def angle(self, distance: float) -> float:
        """Half of the angle (radians) under which it is seen at a distance; pi where it has no section."""
        width = self.width(distance)
        return atan(width / distance) if width > 0 else pi


def is_free(item: Any) -> bool:
    """Whether a contact may still end anywhere."""
    return isinstance(item, Endless) and not item.ends


def arms_of(items: Sequence[Any], center: Vector | None) -> tuple[list[Arm], list[Callable[[float], Any]]]:
    """The arms of contacts, and for each what ends it at a distance; around a centre, or the one that they have.

    Raises `GeometryError` where a contact has no closed plane curve, or two directions are too close.
    """
    place = _center(items) if center is None else center
    arms, ends = [], []
    for number, item in enumerate(items, start=1):
        arm, end = _free(number, item, place) if is_free(item) else _given(number, item, place)
        arms.append(arm)
        ends.append(end)
    for (i, a), (j, b) in combinations(enumerate(arms, start=1), 2):
        angle = angle_between(a.direction, b.direction)
        if (a.given is None or b.given is None) and angle < CLOSEST:
            raise GeometryError(
                f"directions {i} and {j} are {degrees(angle):.3g} degrees apart; at least {degrees(CLOSEST):.3g} are "
                "needed"
            )
    return arms, ends


def _center(items: Sequence[Any]) -> Vector:
    """The centre of the node, which is known before ends are, but for contacts that are all on one line."""
    free = [is_free(item) for item in items]
    rims = [
        rim_of(number, item.clipped(0) if f else as_contact(item))
        for number, (item, f) in enumerate(zip(items, free, strict=True), start=1)
    ]
    if _in_line(rims):
        rims = [rim for rim, f in zip(rims, free, strict=True) if f]
    return center_of(rims)


def _in_line(rims: Sequence[Rim]) -> bool:
    return not any(any(cross(rims[0].normal, rim.normal)) for rim in rims)


def _free(number: int, item: Endless, center: Vector) -> tuple[Arm, Callable[[float], Any]]:
    axis = np.array(to_floats(item.axis))
    length = float(np.linalg.norm(axis))
    foot = float((np.array(to_floats(center)) - to_floats(item.point)) @ axis) / length**2
    parts = FINE
    while length / parts > COARSEST * item.width(foot) > 0:
        parts *= 2

    def ended(distance: float) -> Endless:
        try:
            return item.clipped(fmpq(ceil((foot + distance / length) * parts), parts))
        except ValueError:
            raise GeometryError(
                f"contact {number} has no curve {distance:.4g} from the centre, where it would have to end to leave "
                "room for a blend; let it narrow less, or give its clip"
            ) from None

    return Arm(axis / length, lambda distance: item.width(foot + distance / length)), ended


def _given(number: int, item: Any, center: Vector) -> tuple[Arm, Callable[[float], Any]]:
    disc = Disc.of(number, rim_of(number, as_contact(item)), center)
    wide = disc.distance * tan(min(disc.angle, WEDGE / 2))
    return Arm(disc.direction, lambda _: wide, disc.distance), lambda _: item


def nearest(arms: Sequence[Arm]) -> list[float]:
    """The distances: as many widths for all at first, then each by itself as near as it may be.

    Those that are given stay, and leave to others what they can.  Raises `GeometryError` where one is nowhere apart
    from the others, as for cones that meet farther out.
    """
    pairs = [(i, j, angle_between(arms[i].direction, arms[j].direction)) for i, j in combinations(range(len(arms)), 2)]
    free = [i for i, arm in enumerate(arms) if arm.given is None]

    def fits(ends: Sequence[float], among: Sequence[int] = free) -> bool:
        wide = [arm.angle(end) for arm, end in zip(arms, ends, strict=True)]
        if max(wide[i] for i in among) > WIDEST:
            return False
        return all(_apart(arms, ends, wide, pair) for pair in pairs if pair[0] in among or pair[1] in among)

    factor, start = 1.0, [max(arm.width(0.0), 1e-9) if arm.given is None else arm.given for arm in arms]
    while not fits(ends := _farther(start, free, factor)):
        factor *= STEP
        if factor > FARTHEST:
            lost = next((i for i in free if not fits(ends, [i])), free[0])
            raise GeometryError(
                f"contact {lost + 1}: wherever along its axis it ends, it is not apart from the other contacts as seen "
                "from the centre of the node"
            )
    for i in free:
        alike = ends[i]
        while ends[i] > MUCH_NEARER * alike and fits([*ends[:i], ends[i] / STEP, *ends[i + 1 :]]):
            ends[i] /= STEP
    return ends


def _farther(ends: Sequence[float], free: Sequence[int], factor: float) -> list[float]:
    return [factor * end if i in free else end for i, end in enumerate(ends)]


def _apart(arms: Sequence[Arm], ends: Sequence[float], wide: Sequence[float], pair: tuple[int, int, float]) -> bool:
    """Whether two curves leave enough of the angle between them, and an arc that is large enough fits there."""
    i, j, angle = pair
    given = [wide[n] for n in (i, j) if arms[n].given is not None]
    most = SHARE * angle
    if given:
        most = max(most, given[0] + LEFT * (angle - given[0]))
    if wide[i] + wide[j] > most:
        return False
    first, second = arms[i].width(ends[i]), arms[j].width(ends[j])
    ways = [(first, second, ends[i])] * (arms[i].given is None) + [(second, first, ends[j])] * (arms[j].given is None)
    along = min((end - (other + own * cos(angle)) / sin(angle) for own, other, end in ways), default=0.0)
    return angle >= WEDGE or along * tan(angle / 2) >= FILLET * max(first, second)
