"""Where to end the contacts of a node that may end anywhere: as near as a fair blend leaves room for."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import lru_cache
from itertools import takewhile
from math import ceil, log, radians
from typing import Any

from pas.contacts.contact import Contact, as_contact
from pas.errors import GeometryError
from pas.layouts.arms import arms_of, is_free, nearest
from pas.layouts.fan import best_gaps
from pas.layouts.nodes import KINDS, MANY, Node
from pas.layouts.planes import symmetric
from pas.layouts.region import region
from pas.partition.layout import Layout

GAP, OUTWARDS, FARTHEST = radians(5), 1.08, 6.0
"""Clips go outwards by this factor until a layout fits, mostly a fan with such a gap, up to so many times as far."""

WIDE_GAP = radians(14)
"""`MANY` contacts get such a gap: of the first nodes of five pipes of order 2, at 5 and 9 degrees, most were not fair
or had no surface, and they took twice as long; of those of order 1 a third was not fair at 5 degrees."""


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
    same = tuple(items)
    if serves is None and all(isinstance(item, Hashable) and not isinstance(item, tuple) for item in same):
        return list(_kept(same, order, wanted))
    return _with_clips(same, order, wanted, serves)


@lru_cache(maxsize=256)
def _kept(items: tuple[Any, ...], order: int, wanted: Layout | str | None) -> tuple[Any, ...]:
    """The same, found once: looking for room takes longer than finding the blend of a node that is known."""
    return tuple(_with_clips(items, order, wanted, None))


def _with_clips(items: Sequence[Any], order: int, wanted: Layout | str | None, serves: Serves | None) -> list[Any]:
    arms, ends = arms_of(items, wanted.center if isinstance(wanted, Layout) else None)
    distances = nearest(arms)

    def ended(factor: float) -> list[Any]:
        return [end(factor * far) for end, far in zip(ends, distances, strict=True)]

    def served(factor: float, roomy: bool) -> bool:
        placed = ended(factor)
        return serves(placed) if serves else _served([as_contact(item) for item in placed], order, wanted, roomy)

    factors = [OUTWARDS**n for n in range(1 + ceil(log(FARTHEST, OUTWARDS)))]
    factors = list(takewhile(_possible(ended), factors)) or factors[:1]  # cones that narrow end somewhere
    for roomy in (True, False):
        # what has no room far out has none nearer, and looking for it takes long
        if served(factors[-1], roomy):
            return ended(next(factor for factor in factors if served(factor, roomy)))
    return ended(1.0)


def _possible(ended: Callable[[float], list[Any]]) -> Callable[[float], bool]:
    """Whether contacts can end that far out."""

    def possible(factor: float) -> bool:
        try:
            return bool(ended(factor))
        except GeometryError:
            return False

    return possible


def _served(contacts: Sequence[Contact], order: int, wanted: Layout | str | None, roomy: bool) -> bool:
    """Whether a layout fits; if `roomy` a fan, with gaps where there are four contacts or more or at higher orders."""
    try:
        if isinstance(wanted, Layout):
            return bool(region(wanted, Node.of(contacts, wanted.center).discs).cells)
        node = Node.of(contacts)
        any_kind = not roomy or symmetric(node.discs)  # strips serve few contacts by ugly surfaces alone
        next(node.regions(order, wanted if wanted in KINDS else None if any_kind else "fan"))
        wide = any_kind or (order < 2 and len(contacts) < 4)
        gap = WIDE_GAP if len(contacts) >= MANY else GAP
        return wide or wanted not in (None, "fan") or min(best_gaps(node.discs).sizes) >= gap
    except GeometryError:
        return False
