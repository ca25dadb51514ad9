"""Contacts put in their places: on a given partition, or on the corner they make.

Whatever is wrong with them is said here, before anything is solved: curves that are empty, that
touch one another or do not fit the faces they belong to.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from typing import Any

from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_order
from pas.algebra.real_points import count_real_points, has_real_curve
from pas.blending.corner import check_circle, six_tetrahedra
from pas.errors import GeometryError
from pas.partition.cells import Partition
from pas.surface.circular import Circular
from pas.surface.contact import Contact, as_contact
from pas.surface.contact_proofs import check_join, clip_sided
from pas.surface.joins import Join, joins
from pas.surface.placed import PlacedContacts
from pas.verdicts import Status


def place(items: Sequence[Any], order: int, partition: Partition | None = None) -> PlacedContacts:
    """Pipes or contacts in place on a partition, with their clips turned.

    A clip is turned so that it is negative on the region's side of its faces; one without a face, so
    that it is negative at the centre.

    Without a partition two or three perpendicular pipes or contacts get the six-tetrahedra corner.
    Raises `GeometryError` (with the offending pipe or contact) where they do not fit, `TypeError`
    for anything that is no contact or no partition, `ValueError` for an order that is none.
    """
    check_order(order)
    if not isinstance(items, Iterable) or isinstance(items, str | Mapping):
        raise TypeError(f"contacts must be a list of pipes, contacts or pairs (surface, clip), not {items!r}")
    items = list(items)
    contacts = [as_contact(item, f"contacts[{i}]") for i, item in enumerate(items)]
    pipes = [item if isinstance(item, Circular) else None for item in items]
    if partition is not None and not isinstance(partition, Partition):
        raise TypeError(
            f"partition must be a pas.Partition such as pas.SixTetrahedra(...) or pas.SingleCell(...), "
            f"not {partition!r}"
        )
    if not contacts and partition is not None and len(partition.pieces) == 1:
        raise ValueError("a single cell needs at least one contact; without any, every polynomial is a solution")
    if partition is None:
        partition = six_tetrahedra(contacts, pipes)
    turned = tuple(map(_turned, joins(partition, contacts)))
    for number, (join, pipe) in enumerate(zip(joins(partition, turned), pipes, strict=True), start=1):
        if join.faces:
            if pipe is not None:
                check_circle(number, pipe, join)
            check_join(number, join)
        else:
            _check_curve(number, join.contact)
    if len(partition.pieces) == 1:
        _check_apart(turned)
    return PlacedContacts(partition, turned, order)


def _turned(join: Join) -> Contact:
    """The contact with its clip negative on the region's side of its faces, or else at the centre."""
    contact, center = join.contact, join.partition.center
    if join.faces:
        wrong = clip_sided(join).status is Status.REFUTED
    else:
        wrong = center is not None and contact.clip.at(center) > 0
    return Contact(contact.surface, -contact.clip) if wrong else contact


def _check_curve(number: int, contact: Contact) -> None:
    """That a contact's curve is a real curve, for contacts on no face."""
    if Ideal(contact.surface, contact.clip).is_whole_ring:
        raise GeometryError(
            f"contact {number}: the surface {contact.surface} and the clip {contact.clip} have no common "
            "point, not even a complex one; the clip must cut the surface in a curve"
        )
    real = has_real_curve(contact.surface, contact.clip)
    if real is None:
        raise GeometryError(
            f"contact {number}: the clip {contact.clip} touches the surface {contact.surface} along a curve; "
            "the two must cross at an angle"
        )
    if not real:
        raise GeometryError(
            f"contact {number}: the surface {contact.surface} and the clip {contact.clip} have no real curve in "
            "common; the clip must cut the surface in one"
        )


def _check_apart(contacts: Sequence[Contact]) -> None:
    """That no two contact curves have a common point: one polynomial cannot be regular there."""
    for (i, a), (j, b) in combinations(enumerate(contacts, start=1), 2):
        common = count_real_points(Ideal(a.surface, a.clip, b.surface, b.clip))
        if common == 0:
            continue
        times = "have a whole curve in common" if common is None else f"meet in {common} point{'s' * (common > 1)}"
        raise GeometryError(f"the curves of contacts {i} and {j} {times}; contact curves must be apart")
