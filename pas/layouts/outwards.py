"""How far out clips leave room: all of them moved away from the centre by one factor, the least that works."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from flint import fmpq

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector
from pas.contacts.contact import Contact
from pas.errors import GeometryError
from pas.layouts.center import center_of
from pas.layouts.nodes import rim_of_contact, seen

FARTHEST = 64
"""How many times as far out clips are looked for."""

FINE = 100
"""Parts of one in which the factor is given; what is said has no more digits."""

COARSE = 50
"""It is found to one part in so many of its own."""

Fits = Callable[[Sequence[Contact]], bool]
"""Whether contacts have room."""


def room_farther_out(contacts: Sequence[Contact], fits: Fits, center: Vector | None = None) -> str:
    """The sentence that says at which distances from the centre clips leave room; empty where none are found.

    All planes are moved by one factor, exactly, and there was room at the one that is said.  It is found by bisection,
    and the least within some per cent: where room begins, that of layouts with short rays comes and goes.
    """
    try:
        rims = [rim_of_contact(number, contact) for number, contact in enumerate(contacts, start=1)]
        place = center_of(rims) if center is None else center
        factor = _least(lambda many: _fits(contacts, place, many, fits))
        if factor is None:
            return ""
        moved = [moved_out(contact, place, fmpq(factor, FINE)) for contact in contacts]
        discs = [seen(number, rim_of_contact(number, c), place) for number, c in enumerate(moved, start=1)]
    except GeometryError:
        return ""
    *most, last = (f"{disc.distance:.4g}" for disc in discs)
    return (
        f"clips at distances of at least {', '.join(most)} and {last} from the centre ({factor / FINE:g} times as far) "
        'leave room, and clip="auto" finds such'
    )


def moved_out(contact: Contact, center: Vector, factor: fmpq) -> Contact:
    """The contact with its clip plane so many times as far from the centre; as it is where the clip is no plane."""
    if contact.clip.degree != 1:
        return contact
    height = contact.clip.raw(*center)
    return Contact(contact.surface, Polynomial.from_raw(contact.clip.raw + (factor - 1) * height), contact.near)


def _fits(contacts: Sequence[Contact], center: Vector, parts: int, fits: Fits) -> bool:
    try:
        return fits([moved_out(contact, center, fmpq(parts, FINE)) for contact in contacts])
    except GeometryError:
        return False


def _least(fits: Callable[[int], bool]) -> int | None:
    """The least number of parts above those of one that fits."""
    low, high = FINE, 2 * FINE
    while not fits(high):
        low, high = high, 2 * high
        if high > FARTHEST * FINE:
            return None
    while high - low > max(1, low // COARSE):
        middle = (low + high) // 2
        low, high = (low, middle) if fits(middle) else (middle, high)
    return high
