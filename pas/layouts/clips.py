"""Where to end the contacts of a node: as near as a fair blend leaves room for, or farther out than they are."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from contextlib import suppress
from functools import lru_cache
from math import ceil, log, radians
from typing import Any, TypeVar

from flint import fmpq

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector
from pas.contacts.contact import Contact, as_contact
from pas.contacts.ends import ContactEnd, unusual
from pas.errors import GeometryError, warn
from pas.layouts.discs import Disc, rim_of
from pas.layouts.fan import best_gaps
from pas.layouts.kinds import LAYOUTS
from pas.layouts.nodes import MANY, ContactNode, center_of
from pas.layouts.planes import have_room
from pas.layouts.spacing import arms_of, is_free, nearest
from pas.partition.layout import Layout

GAP, OUTWARDS, FARTHEST = radians(5), 1.08, 6.0
"""Clips go outwards by this factor until a layout fits, mostly a fan with such a gap, up to so many times as far."""

FAR, PARTS, COARSE = 64, 100, 50
"""Clips that leave no room are moved up to so many times as far; parts of one in which that factor is given, since what
is said has no more digits; and it is found to one part in so many of its own."""

T = TypeVar("T")
Fits = Callable[[Sequence[Contact]], bool]
"""Whether contacts with ends have room."""


def with_clips(
    items: Sequence[Any], order: int, wanted: Layout | str | None = None
) -> tuple[Sequence[Any], ContactNode | None]:
    """The contacts, those with the clip "auto" ended as near as a fair blend of this order allows, and their node.

    Clips that are numbers stay and are kept apart from.  No two curves take up more than 0.6 of the angle between their
    directions, an arc of 0.6 of the wider radius fits between any two, and a layout keeps them apart: the `wanted` one
    or kind, else full planes, or a fan of half-planes, from order 2 or four contacts on with some room.  The node,
    which has its layouts already, is None where all clips are numbers and where no layout has room.

    Warns of clips that are far out for their radii, and of radii that differ much.  Raises `GeometryError` for
    directions that are too close.
    """
    if not any(map(is_free, items)):
        return items, None
    known = all(isinstance(item, Hashable) and not isinstance(item, tuple) for item in items)
    ended, node = (_known_clips if known else _clipped)(tuple(items), order, wanted)
    if node is not None:
        for sentence in unusual([ContactEnd.of(item, node.center) for item in ended]):
            warn(sentence)
    return ended, node


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
    arms, ends = arms_of(items, center)
    distances = nearest(arms)
    tried = []
    with suppress(GeometryError):  # cones that narrow end somewhere
        for n in range(1 + ceil(log(FARTHEST, OUTWARDS))):
            tried.append([end(OUTWARDS**n * far) for end, far in zip(ends, distances, strict=True)])
    tried = tried or [[end(far) for end, far in zip(ends, distances, strict=True)]]
    for roomy in (True, False):
        # what has no room far out has none nearer, and looking for it takes long
        if serves(tried[-1], roomy) is not None:
            served = ((placed, serves(placed, roomy)) for placed in tried)
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
    """The contact with its clip plane so many times as far from the centre; as it is where the clip is no plane."""
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
