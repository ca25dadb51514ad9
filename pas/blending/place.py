"""Contacts put in their places: on a given partition, or on the corner they make.

Whatever is wrong with them is said here, before anything is solved: curves that are empty, that
touch one another or do not fit the faces they belong to.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any, TypeAlias

from pas.algebra.curve import has_real_curve
from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_order
from pas.algebra.rational import listed
from pas.algebra.zeros import real_zeros
from pas.blending.corner import check_circle, six_tetrahedra
from pas.certify.contact_proofs import check_join, clip_sided
from pas.contacts.contact import Contact, as_contact
from pas.contacts.endless import Circular
from pas.contacts.joins import Join, joins
from pas.errors import GeometryError, meant
from pas.layouts.clips import is_free, room_farther_out, with_clips, with_room
from pas.layouts.kinds import LAYOUTS
from pas.layouts.nodes import ContactNode
from pas.layouts.opened import is_opening, open_region, with_cone
from pas.partition.boxes import SixTetrahedra
from pas.partition.cells import Partition
from pas.partition.layout import Layout
from pas.surface.placed import PlacedContacts
from pas.verdicts import Status

PartitionLike: TypeAlias = "Partition | Layout | str"
"""What is taken for a partition: one, a layout that gets a region, or the name of a kind of layouts."""

SIX = SixTetrahedra.name


def place(items: Sequence[Any], order: int, partition: PartitionLike | None = None) -> PlacedContacts:
    """Pipes or contacts in place on a partition: the first of their `placements`, once all of them end somewhere."""
    return next(placements(with_ends(items, order, partition), order, partition))


def with_ends(items: Sequence[Any], order: int, partition: PartitionLike | None = None) -> list[Circular | Contact]:
    """Pipes, cones and other contacts: those that may end anywhere end where there is room among the others, and the
    clip of a plate is a cone.

    Raises `TypeError` for what is no list of contacts, `ValueError` for an order that is none, `GeometryError` where
    there is no room.
    """
    check_order(order)
    if not isinstance(items, Iterable) or isinstance(items, str | Mapping):
        raise TypeError(f"contacts must be a list of pipes, contacts or pairs (surface, clip), not {items!r}")
    ended: Sequence[Any] = list(items) if partition is not None else with_cone(list(items))
    free = [number for number, item in enumerate(ended, start=1) if is_free(item)]
    if free and isinstance(partition, Partition):
        raise GeometryError(
            f'contact {free[0]} has the clip "auto", for which the program makes a region; where the partition is '
            "given, its clip must be a number"
        )
    for i, item in enumerate(ended):
        if i + 1 not in free:
            as_contact(item, f"contacts[{i}]")  # says what is wrong with it before others are placed
    if free and partition == SIX:
        ended, _ = with_room(ended, lambda tried, _: _on_corner(_known(tried), order))
    elif free:
        ended = with_clips(ended, order, partition if isinstance(partition, Layout | str) else None)
    return _known(ended)


def _known(items: Sequence[Any]) -> list[Circular | Contact]:
    """Pipes and cones, whose axes and radii are known, and of all else the contact."""
    return [item if isinstance(item, Circular) else as_contact(item) for item in items]


def placements(
    items: Sequence[Circular | Contact], order: int, partition: PartitionLike | None = None
) -> Iterator[PlacedContacts]:
    """Contacts `with_ends` in place on a partition, or on one after the other, with their clips turned.

    A clip is turned so that it is negative on the region's side of its faces; one without a face, so that it is
    negative at the centre.

    Without a partition three perpendicular pipes or contacts that meet in one point get the six-tetrahedra corner,
    others the layouts of `pas.layouts.nodes`, one after the other.  A layout, or the name of a kind of them, gets a
    region around the contacts.  Raises `GeometryError` (with the offending pipe or contact) where they do not fit,
    `TypeError` for anything that is no partition, `ValueError` for a name that is none.
    """
    contacts = [item.contact for item in items]
    if isinstance(partition, Partition):
        if not contacts and len(partition.pieces) == 1:
            raise ValueError("a single cell needs at least one contact; without any, every polynomial is a solution")
        yield placed_on(partition, items, order)
    elif partition == SIX:
        yield placed_on(six_tetrahedra(items), items, order)
    elif partition is None and any(map(is_opening, contacts)):
        yield placed_on(open_region(contacts), items, order)
    elif isinstance(partition, Layout) or (isinstance(partition, str) and partition in LAYOUTS):
        yield from _on_regions(items, order, partition)
    elif partition is None:
        corner = _on_corner(items, order) if len(contacts) > 2 else None
        yield from [corner] if corner is not None else _on_regions(items, order, None)
    elif isinstance(partition, str):
        names = ", ".join(map(repr, (SIX, *LAYOUTS)))
        guess = meant(partition, (SIX, *LAYOUTS)) or f"; there are {names}"
        raise ValueError(f"there is no partition {partition!r}{guess}")
    else:
        raise TypeError(
            "partition must be a pas.Partition such as pas.SixTetrahedra(...) or pas.SingleCell(...), a pas.Layout "
            f"or the name of a kind of layouts, not {partition!r}"
        )


def _on_corner(items: Sequence[Circular | Contact], order: int) -> PlacedContacts | None:
    """Contacts on six tetrahedra; None where they make no such corner, or do not fit its faces."""
    try:
        return placed_on(six_tetrahedra(items), items, order)
    except GeometryError:
        return None


def _on_regions(
    items: Sequence[Circular | Contact], order: int, wanted: Layout | str | None
) -> Iterator[PlacedContacts]:
    """Contacts on regions of layouts; the error that there are none says how far out clips leave room."""
    contacts, center = [item.contact for item in items], wanted.center if isinstance(wanted, Layout) else None
    if len(contacts) < 2 and center is None:
        raise GeometryError(
            f"a blend joins two contacts or more, and here {'is one' if contacts else 'are none'}; for a surface that "
            "meets one contact give a partition, such as pas.SingleCell(lower, upper)"
        )

    def regions(items: Sequence[Circular | Contact]) -> Iterator[PlacedContacts]:
        """The contacts on regions of all layouts that fit; raises the error of the last where none does."""
        failure: GeometryError | None = None
        found = False
        for made in ContactNode.of([item.contact for item in items], center).regions(order, wanted):
            try:
                placed = placed_on(made, items, order)
            except GeometryError as error:
                failure = error
                continue
            found = True
            yield placed
        if not found and failure is not None:
            raise failure

    try:
        yield from regions(items)
    except GeometryError as error:
        where = room_farther_out(contacts, lambda moved: any(True for _ in regions(moved)), center)
        raise (GeometryError(f"{error}; {where}") if where else error) from None


def placed_on(partition: Partition, items: Sequence[Circular | Contact], order: int) -> PlacedContacts:
    """Contacts on one partition."""
    turned = tuple(map(_turned, joins(partition, [item.contact for item in items])))
    placed = joins(partition, turned)
    _check_closed(partition, placed)
    for number, (join, item) in enumerate(zip(placed, items, strict=True), start=1):
        if join.faces:
            if isinstance(item, Circular):
                check_circle(number, item, join)
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
    """Raise `GeometryError` where a contact on no face has no real curve."""
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


def _check_closed(partition: Partition, placed: Sequence[Join]) -> None:
    """Raise `GeometryError` where no contact closes an open region."""
    openings = [number for number, join in enumerate(placed, start=1) if join.opening]
    if partition.sides and partition.center is not None and len(openings) != 1:
        apex = f"({listed(partition.center)})"
        which = f"contacts {' and '.join(map(str, openings))} do" if openings else "none does"
        raise GeometryError(
            f"the region ({partition.title}) is open: one contact must close it, a plate or an opening whose clip is a "
            f"cone with its apex in the centre {apex}, and {which}"
        )


def _check_apart(contacts: Sequence[Contact]) -> None:
    """Raise `GeometryError` for two contact curves with a common point: no polynomial is regular there."""
    for (i, a), (j, b) in combinations(enumerate(contacts, start=1), 2):
        common = real_zeros(Ideal(a.surface, a.clip, b.surface, b.clip))
        if common == []:
            continue
        number = 0 if common is None else len(common)
        times = f"meet in {number} point{'s' * (number > 1)}" if number else "have a whole curve in common"
        raise GeometryError(f"the curves of contacts {i} and {j} {times}; contact curves must be apart")
