"""The ends of a node's contacts: as near as a fair blend leaves room for, or farther out than they are.

Some contacts may end anywhere along their axis: as near as all are apart.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from math import atan, ceil, cos, degrees, log, pi, radians, sin, tan
from typing import Any, TypeAlias, TypeVar

import numpy as np
from flint import fmpq

from pas.algebra.lengths import angle_between
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, cross, to_floats
from pas.arrays import Floats
from pas.contacts.contact import Contact, as_contact
from pas.contacts.endless import Endless
from pas.contacts.ends import ContactEnd, unusual
from pas.errors import GeometryError, warn
from pas.layouts.discs import Disc, rim_of
from pas.layouts.fan import best_gaps
from pas.layouts.kinds import LAYOUTS
from pas.layouts.nodes import MANY, ContactNode, center_of
from pas.layouts.planes import have_room
from pas.partition.layout import Layout
from pas.surface.fairness_limits import WEDGE

GAP, OUTWARDS, FARTHEST = radians(5), 1.08, 6.0
"""Clips go outwards by this factor until a layout fits, mostly a fan with such a gap, up to so many times as far."""

FAR, PARTS, COARSE = 64, 100, 50
"""Clips that leave no room are moved up to so many times as far; parts of one in which that factor is given, since what
is said has no more digits; and it is found to one part in so many of its own."""

T = TypeVar("T")
Fits = Callable[[Sequence[Contact]], bool]
"""Whether contacts with ends have room."""


def with_clips(items: Sequence[Any], order: int, wanted: Layout | str | None = None) -> Sequence[Any]:
    """The contacts, those with the clip "auto" ended as near as a fair blend of this order allows.

    Clips that are numbers stay and are kept apart from.  No two curves take up more than 0.6 of the angle between their
    directions, an arc of 0.6 of the wider radius fits between any two, and a layout keeps them apart: the `wanted` one
    or kind, else full planes, or a fan of half-planes, from order 2 or four contacts on with some room.

    Warns of clips that are far out for their radii, and of radii that differ much.  Raises `GeometryError` for
    directions that are too close.
    """
    if not any(map(is_free, items)):
        return items
    ended, node = _found(items, order, wanted)
    if node is not None:
        for sentence in unusual([ContactEnd.of(item, node.center) for item in ended]):
            warn(sentence)
    return ended


def has_layout(items: Sequence[Any], order: int) -> bool:
    """Whether a layout keeps contacts apart, those with the clip "auto" where `with_clips` ends them."""
    if any(map(is_free, items)):
        return _found(items, order, None)[1] is not None
    return _served(list(map(as_contact, items)), order, None, False) is not None


def _found(items: Sequence[Any], order: int, wanted: Layout | str | None) -> tuple[Sequence[Any], ContactNode | None]:
    known = all(isinstance(item, Hashable) and not isinstance(item, tuple) for item in items)
    return (_known_clips if known else _clipped)(tuple(items), order, wanted)


def _clipped(
    items: tuple[Any, ...], order: int, wanted: Layout | str | None
) -> tuple[Sequence[Any], ContactNode | None]:
    center = wanted.center if isinstance(wanted, Layout) else None
    return with_room(items, lambda ended, roomy: _served(list(map(as_contact, ended)), order, wanted, roomy), center)


_known_clips = lru_cache(maxsize=256)(_clipped)
"""Looking for room takes longer than finding the blend of a node that is known, so it is done once."""


def with_room(
    items: Sequence[Any], serves: Callable[[Sequence[Any], bool], T | None], center: Vector | None = None
) -> tuple[Sequence[Any], T | None]:
    """The contacts with the nearest ends for which something `serves` them, and that: with room, else without.

    Where nothing does, the nearest ends that keep them apart, and None.
    """
    arms = arms_of(items, center)
    distances = nearest(arms)
    tried = [[arm.ended(far) for arm, far in zip(arms, distances, strict=True)]]
    with suppress(GeometryError):  # cones that narrow end somewhere
        for n in range(1, 1 + ceil(log(FARTHEST, OUTWARDS))):
            tried.append([arm.ended(OUTWARDS**n * far) for arm, far in zip(arms, distances, strict=True)])
    for roomy in (True, False):
        if (nearest_found := serves(tried[0], roomy)) is not None:
            return tried[0], nearest_found
        # what has no room far out has none nearer, and looking for it takes long
        if serves(tried[-1], roomy) is not None:
            served = ((placed, serves(placed, roomy)) for placed in tried[1:])
            return next((placed, found) for placed, found in served if found is not None)
    return tried[0], None


def _served(contacts: Sequence[Contact], order: int, wanted: Layout | str | None, roomy: bool) -> ContactNode | None:
    """The node, where a layout fits; if `roomy` full planes, or a fan with gaps for most."""
    try:
        if isinstance(wanted, Layout):
            node = ContactNode.of(contacts, wanted.center)
            next(node.regions(order, wanted))
            return node
        node = ContactNode.of(contacts)
        any_kind = not roomy or have_room(node.discs)  # strips serve few contacts by ugly surfaces alone
        next(node.regions(order, wanted if wanted in LAYOUTS else None if any_kind else "fan"))
        wide = any_kind or (order < 2 and len(contacts) < 4)
        # `MANY` contacts get such a gap: of the first nodes of five pipes of order 2, at 5 and 9 degrees, most were not
        # fair or had no surface, and they took twice as long; of those of order 1 a third was not fair at 5 degrees.
        wide_gap = radians(14)
        gap = wide_gap if len(contacts) >= MANY else GAP
        served = wide or wanted not in (None, "fan") or min(best_gaps(node.discs).sizes) >= gap
        return node if served else None
    except GeometryError:
        return None


def room_farther_out(contacts: Sequence[Contact], fits: Fits, center: Vector | None = None) -> str:
    """The sentence that says at which distances from the centre clips leave room; empty where none are found.

    All planes are moved by one factor, exactly, and there was room at the one that is said.  It is found by bisection,
    and the least within some per cent: where room begins, that of layouts with short rays comes and goes.
    """
    try:
        rims = [rim_of(number, contact) for number, contact in enumerate(contacts, start=1)]
        place = center_of(rims) if center is None else center
        factor = _least(lambda many: _fits(contacts, place, many, fits))
        if factor is None:
            return ""
        moved = [moved_out(contact, place, fmpq(factor, PARTS)) for contact in contacts]
        discs = [Disc.of(number, rim_of(number, c), place) for number, c in enumerate(moved, start=1)]
    except GeometryError:
        return ""
    *most, last = (f"{disc.distance:.4g}" for disc in discs)
    return (
        f"clips at distances of at least {', '.join(most)} and {last} from the centre ({factor / PARTS:g} times as "
        'far) leave room, and clip="auto" finds such'
    )


def moved_out(contact: Contact, center: Vector, factor: fmpq) -> Contact:
    """The contact with its clip plane `factor` times as far from the centre; unchanged where the clip is no plane."""
    if contact.clip.degree != 1:
        return contact
    height = contact.clip.raw(*center)
    return Contact(contact.surface, Polynomial.from_raw(contact.clip.raw + (factor - 1) * height), contact.near)


def _fits(contacts: Sequence[Contact], center: Vector, parts: int, fits: Fits) -> bool:
    try:
        return fits([moved_out(contact, center, fmpq(parts, PARTS)) for contact in contacts])
    except GeometryError:
        return False


def _least(fits: Callable[[int], bool]) -> int | None:
    """The least number of parts above those of one that fits."""
    low, high = PARTS, 2 * PARTS
    while not fits(high):
        low, high = high, 2 * high
        if high > FAR * PARTS:
            return None
    while high - low > max(1, low // COARSE):
        middle = (low + high) // 2
        low, high = (low, middle) if fits(middle) else (middle, high)
    return high


WIDEST = radians(40)
"""Angular radius of a curve that is placed, at the most."""

FILLET = 0.6
"""Radius of the arc that must fit between two contacts, over that of the wider one."""

EVEN = 2 / 3
"""Share of the farthest clip's distance, of those that are placed, that the nearest has: of a node of five pipes of
order 2 the surface was not fair with 0.55, none that is was found in 100 seconds with 0.6, and in 9 with this."""

CLOSEST = radians(10)
"""Directions closer than this are refused: their clips would be very far out."""

STEP, GIVEN_UP = 1.01, 1000.0
"""Clips go outwards by this factor until they fit, up to so many times the largest width."""

FINE, COARSEST = 64, 1 / 2
"""Parts of its axis to which a clip is rounded, up; more where they are longer than this share of the width."""

Pair: TypeAlias = "tuple[int, int, float]"
"""The numbers of two contacts, and the angle between their directions in radians."""


@dataclass(frozen=True)
class Arm:
    """One contact from the centre: along a unit vector (3,), `width(distance)` its radius at a distance.

    `ended(distance)` is the contact with an end there; `given` is the distance of one that has its end, None else.
    """

    direction: Floats
    width: Callable[[float], float]
    ended: Callable[[float], Any]
    given: float | None = None

    def angle(self, distance: float) -> float:
        """Half of the angle (radians) under which it is seen at a distance; pi where it has no section."""
        width = self.width(distance)
        return atan(width / distance) if width > 0 else pi


def is_free(item: Any) -> bool:
    """Whether a contact may still end anywhere."""
    return isinstance(item, Endless) and not item.ends


def arms_of(items: Sequence[Any], center: Vector | None) -> list[Arm]:
    """The arms of contacts around a centre, or the one that they have.

    Raises `GeometryError` where a contact has no closed plane curve, or two directions are too close.
    """
    place = _center(items) if center is None else center
    arms = [(_free if is_free(item) else _given)(number, item, place) for number, item in enumerate(items, start=1)]
    for (i, a), (j, b) in combinations(enumerate(arms, start=1), 2):
        angle = angle_between(a.direction, b.direction)
        if (a.given is None or b.given is None) and angle < CLOSEST:
            raise GeometryError(
                f"directions {i} and {j} are {degrees(angle):.3g} degrees apart; at least {degrees(CLOSEST):.3g} are "
                "needed"
            )
    return arms


def _center(items: Sequence[Any]) -> Vector:
    """The centre of the node, which is known before ends are, but for contacts that are all on one line."""
    free = [is_free(item) for item in items]
    rims = [
        rim_of(number, item.clipped(0) if f else as_contact(item))
        for number, (item, f) in enumerate(zip(items, free, strict=True), start=1)
    ]
    if not any(any(cross(rims[0].normal, rim.normal)) for rim in rims):  # they are in line
        rims = [rim for rim, f in zip(rims, free, strict=True) if f]
    return center_of(rims)


def _free(number: int, item: Endless, center: Vector) -> Arm:
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

    return Arm(axis / length, lambda distance: item.width(foot + distance / length), ended)


def _given(number: int, item: Any, center: Vector) -> Arm:
    disc = Disc.of(number, rim_of(number, as_contact(item)), center)
    wide = disc.distance * tan(min(disc.angle, WEDGE / 2))
    return Arm(disc.direction, lambda _: wide, lambda _: item, disc.distance)


def nearest(arms: Sequence[Arm]) -> list[float]:
    """The distances: as near as widths and angles allow.

    A contact is seen `WIDEST` at the most, an arc of `FILLET` of the wider radius fits between it and any other, and
    none is nearer than `EVEN` of the farthest.  Then of two that take up more than their share of the
    angle between them the wider seen goes out.  Those that are given stay, and leave to others what they can.

    Raises `GeometryError` where one is nowhere apart from the others, as for cones that meet farther out.
    """
    pairs = [(i, j, angle_between(arms[i].direction, arms[j].direction)) for i, j in combinations(range(len(arms)), 2)]
    ends = [max(arm.width(0.0), 1e-9) if arm.given is None else arm.given for arm in arms]
    farthest = GIVEN_UP * max(ends)
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
    """The wider of each two arms that take up too much of the angle between them; both where they are equal."""
    # Share of the angle between two contacts that their curves may take up: of 0.8 and 0.6 the strongest lever on
    # shape.
    share = 0.6
    wide = [arm.angle(end) for arm, end in zip(arms, ends, strict=True)]
    found: set[int] = set()
    for i, j, angle in pairs:
        given = [wide[n] for n in (i, j) if arms[n].given is not None]
        # Share of what a curve that was given leaves of such an angle, that another may take up all the same.
        left = 1 / 3
        most = max(share * angle, *(g + left * (angle - g) for g in given), 0.0)
        if len(given) < 2 and wide[i] + wide[j] > most:
            free = [n for n in (i, j) if arms[n].given is None]
            found.update(n for n in free if STEP * wide[n] >= max(wide[m] for m in free))
    return found
