""" "intersection": the members of the intersection of the contact ideals, by its graded Groebner basis.

Warren 1989; Lou, Feng, Chen and Deng 2001.
"""

from __future__ import annotations

from functools import lru_cache

from pas.algebra.ideal import Ideal
from pas.blending.method import Patches, SolvingMethod, patches_of
from pas.contacts.contact import Contact, contact_ideal
from pas.surface.placed import PlacedContacts


@lru_cache(maxsize=32)
def intersection(contacts: tuple[Contact, ...], order: int) -> Ideal:
    """The ideal of all polynomials that meet every contact with GC^`order`."""
    first, *others = (contact_ideal(contact, order) for contact in contacts)
    for other in others:
        first = first & other
    return first


def _solve(placed: PlacedContacts, degree: int) -> Patches:
    found = intersection(placed.contacts, placed.order).members(degree)
    return patches_of(placed, degree, [(member.primitive(),) for member in found])


INTERSECTION = SolvingMethod("intersection", _solve, several=False)
