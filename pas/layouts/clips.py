"""Where to end the contacts of a node: as near as a fair blend leaves room for, or farther out than they are."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from contextlib import suppress
from functools import lru_cache
from math import ceil, log, radians
from typing import Any

from flint import fmpq

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector
from pas.contacts.contact import Contact, as_contact
from pas.errors import GeometryError
from pas.layouts.discs import Disc, rim_of
from pas.layouts.fan import best_gaps
from pas.layouts.kinds import LAYOUTS
from pas.layouts.nodes import MANY, ContactNode, center_of
from pas.layouts.planes import symmetric
from pas.layouts.region import region
from pas.layouts.spacing import arms_of, is_free, nearest
from pas.partition.layout import Layout

GAP, OUTWARDS, FARTHEST = radians(5), 1.08, 6.0
"""Clips go outwards by this factor until a layout fits, mostly a fan with such a gap, up to so many times as far."""

WIDE_GAP = radians(14)
"""`MANY` contacts get such a gap: of the first nodes of five pipes of order 2, at 5 and 9 degrees, most were not fair
or had no surface, and they took twice as long; of those of order 1 a third was not fair at 5 degrees."""

FAR, PARTS, COARSE = 64, 100, 50
"""Clips that leave no room are moved up to so many times as far; parts of one in which that factor is given, since what
is said has no more digits; and it is found to one part in so many of its own."""

Serves = Callable[[Sequence[Any]], bool]
"""Whether contacts with ends have room."""


def with_clips(
    items: Sequence[Any], order: int, wanted: Layout | str | None = None, serves: Serves | None = None
) -> list[Any]:
    """The contacts, those with the clip "auto" ended as near as a fair blend of this order allows.

    Clips that are numbers stay and are kept apart from.  No two curves take up more than 0.6 of the angle between their
    directions, an arc of 0.6 of the wider radius fits between any two, and a layout keeps them apart: the `wanted` one
    or kind, else a fan of half-planes, from order 2 or four contacts on with some room; or something else that `serves`
    the contacts.

    Raises `GeometryError` for directions that are too close.
    """
    if not any(map(is_free, items)):
        return list(items)
    key = tuple(items)
    if serves is None and all(isinstance(item, Hashable) and not isinstance(item, tuple) for item in key):
        return list(_known_clips(key, order, wanted))
    return _clipped(items, order, wanted, serves)


@lru_cache(maxsize=256)
def _known_clips(items: tuple[Any, ...], order: int, wanted: Layout | str | None) -> tuple[Any, ...]:
    """Looking for room takes longer than finding the blend of a node that is known, so it is done once."""
    return tuple(_clipped(items, order, wanted, None))


def _clipped(items: Sequence[Any], order: int, wanted: Layout | str | None, serves: Serves | None) -> list[Any]:
    arms, ends = arms_of(items, wanted.center if isinstance(wanted, Layout) else None)
    distances = nearest(arms)

    def ended(factor: float) -> list[Any]:
        return [end(factor * far) for end, far in zip(ends, distances, strict=True)]

    def served(placed: Sequence[Any], roomy: bool) -> bool:
        return serves(placed) if serves else _served([as_contact(item) for item in placed], order, wanted, roomy)

    tried = []
    with suppress(GeometryError):  # cones that narrow end somewhere
        for n in range(1 + ceil(log(FARTHEST, OUTWARDS))):
            tried.append(ended(OUTWARDS**n))
    tried = tried or [ended(1.0)]
    for roomy in (True, False):
        # what has no room far out has none nearer, and looking for it takes long
        if served(tried[-1], roomy):
            return next(placed for placed in tried if served(placed, roomy))
    return tried[0]


def _served(contacts: Sequence[Contact], order: int, wanted: Layout | str | None, roomy: bool) -> bool:
    """Whether a layout fits; if `roomy` a fan, with gaps where there are four contacts or more or at higher orders."""
    try:
        if isinstance(wanted, Layout):
            return bool(region(wanted, ContactNode.of(contacts, wanted.center).discs).cells)
        node = ContactNode.of(contacts)
        any_kind = not roomy or symmetric(node.discs)  # strips serve few contacts by ugly surfaces alone
        next(node.regions(order, wanted if wanted in LAYOUTS else None if any_kind else "fan"))
        wide = any_kind or (order < 2 and len(contacts) < 4)
        gap = WIDE_GAP if len(contacts) >= MANY else GAP
        return wide or wanted not in (None, "fan") or min(best_gaps(node.discs).sizes) >= gap
    except GeometryError:
        return False


def room_farther_out(contacts: Sequence[Contact], fits: Serves, center: Vector | None = None) -> str:
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


def _fits(contacts: Sequence[Contact], center: Vector, parts: int, fits: Serves) -> bool:
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
