"""How near the contacts of a node may end, of which some may end anywhere along their axis, so that all are apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import atan, ceil, cos, degrees, pi, radians, sin, tan
from typing import Any, TypeAlias

import numpy as np
from flint import fmpq

from pas.algebra.lengths import angle_between
from pas.algebra.monomials import Floats
from pas.algebra.rational import Vector, cross, to_floats
from pas.contacts.contact import as_contact
from pas.contacts.endless import Endless
from pas.contacts.rims import Rim
from pas.errors import GeometryError
from pas.layouts.discs import Disc, rim_of
from pas.layouts.nodes import center_of
from pas.surface.fairness_limits import WEDGE

SHARE = 0.6
"""Share of the angle between two contacts that their curves may take up: of 0.8 and 0.6 the strongest lever on
shape."""

WIDEST = radians(40)
"""Angular radius of a curve that is placed, at the most."""

FILLET = 0.6
"""Radius of the arc that must fit between two contacts, over that of the wider one."""

EVEN = 2 / 3
"""Share of the farthest clip's distance, of those that are placed, that the nearest has: of a node of five pipes of
order 2 the surface was not fair with 0.55, none that is was found in 100 seconds with 0.6, and in 9 with this."""

CLOSEST = radians(10)
"""Directions closer than this are refused: their clips would be very far out."""

STEP, FARTHEST = 1.01, 1000.0
"""Clips go outwards by this factor until they fit, up to so many times the largest width."""

FINE, COARSEST = 64, 1 / 2
"""Parts of its axis to which a clip is rounded, up; more where they are longer than this share of the width."""

Pair: TypeAlias = "tuple[int, int, float]"
"""The numbers of two contacts, and the angle between their directions in radians."""


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
    """The distances: as near as widths and angles allow.

    A contact is seen `WIDEST` at the most, an arc of `FILLET` of the wider radius fits between it and any other, and
    none is nearer than `EVEN` of the farthest.  Then of two that take up more than their share of the
    angle between them the wider seen goes out.  Those that are given stay, and leave to others what they can.

    Raises `GeometryError` where one is nowhere apart from the others, as for cones that meet farther out.
    """
    pairs = [(i, j, angle_between(arms[i].direction, arms[j].direction)) for i, j in combinations(range(len(arms)), 2)]
    ends = [max(arm.width(0.0), 1e-9) if arm.given is None else arm.given for arm in arms]
    farthest = FARTHEST * max(ends)
    while outwards := _too_near(arms, ends, pairs) or _too_wide(arms, ends, pairs):
        for i in outwards:
            ends[i] *= STEP
            if ends[i] > farthest:
                raise GeometryError(
                    f"contact {i + 1}: wherever along its axis it ends, it is not apart from the other contacts as "
                    "seen from the centre of the node"
                )
    return ends


def _too_near(arms: Sequence[Arm], ends: Sequence[float], pairs: Sequence[Pair]) -> set[int]:
    """Which are seen too wide by themselves, leave no room for an arc between them and another, or are too uneven."""
    wide = [arm.width(end) for arm, end in zip(arms, ends, strict=True)]
    least = EVEN * max((end for arm, end in zip(arms, ends, strict=True) if arm.given is None), default=0.0)
    found = {i for i, arm in enumerate(arms) if arm.angle(ends[i]) > WIDEST or ends[i] < least}
    for i, j, angle in pairs:
        arc = FILLET * max(wide[i], wide[j]) / tan(angle / 2)
        for a, b in ((i, j), (j, i)):
            if angle < WEDGE and ends[a] < (wide[b] + wide[a] * cos(angle)) / sin(angle) + arc:
                found.add(a)
    return {i for i in found if arms[i].given is None}


def _too_wide(arms: Sequence[Arm], ends: Sequence[float], pairs: Sequence[Pair]) -> set[int]:
    """Of each two that take up too much of the angle between them the wider seen; both where they are alike."""
    wide = [arm.angle(end) for arm, end in zip(arms, ends, strict=True)]
    found: set[int] = set()
    for i, j, angle in pairs:
        given = [wide[n] for n in (i, j) if arms[n].given is not None]
        # Share of what a curve that was given leaves of such an angle, that another may take up all the same.
        left = 1 / 3
        most = max(SHARE * angle, *(g + left * (angle - g) for g in given), 0.0)
        if len(given) < 2 and wide[i] + wide[j] > most:
            free = [n for n in (i, j) if arms[n].given is None]
            found.update(n for n in free if STEP * wide[n] >= max(wide[m] for m in free))
    return found
