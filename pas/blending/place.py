"""Contacts put in their places: on a given partition, or on the corner they make.

Whatever is wrong with them is said here, before anything is solved: curves that are empty, that
touch one another or do not fit the faces they belong to.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, TypeAlias

from pas.algebra.curve import count_real_points, has_real_curve
from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_order
from pas.algebra.rational import Vector, listed
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
    """Pipes or contacts in place on a partition: the first of `EndedContacts.places`, whose errors it raises."""
    return next(ended(items, order, partition).places())


def ended(items: Sequence[Any], order: int, partition: PartitionLike | None = None) -> EndedContacts:
    """Pipes or contacts, those that may end anywhere ended where there is room among the others, and plates on cones.

    Raises `TypeError` for what is no list of contacts, `ValueError` for an order that is none, `GeometryError` where
    there is no room.
    """
    check_order(order)
    if not isinstance(items, Iterable) or isinstance(items, str | Mapping):
        raise TypeError(f"contacts must be a list of pipes, contacts or pairs (surface, clip), not {items!r}")
    items = list(items) if partition is not None else with_cone(list(items))
    free = [number for number, item in enumerate(items, start=1) if is_free(item)]
    if free and isinstance(partition, Partition):
        raise GeometryError(
            f'contact {free[0]} has the clip "auto", for which the program makes a region; where the partition is '
            "given, its clip must be a number"
        )
    for i, item in enumerate(items):
        if i + 1 not in free:
            as_contact(item, f"contacts[{i}]")  # says what is wrong with it before others are placed

    def all_ended(items: Sequence[Any], laid: ContactNode | PlacedContacts | None = None) -> EndedContacts:
        circles = tuple(item if isinstance(item, Circular) else None for item in items)
        return EndedContacts(tuple(map(as_contact, items)), circles, order, partition, laid)

    if not free:
        return all_ended(items)
    if partition == SIX:
        return all_ended(*with_room(items, lambda ended, _: all_ended(ended).corner()))
    known = isinstance(partition, Layout) or (isinstance(partition, str) and partition in LAYOUTS)
    wanted = partition if known and not isinstance(partition, Partition) else None
    return all_ended(*with_clips(items, order, wanted))


@dataclass(frozen=True)
class EndedContacts:
    """Contacts that all have ends, and what they are to be placed on: made once, by `ended`, and passed on.

    `circles` says of which pipe or cone each is, where it is one.  `laid` is what was found of them when their ends
    were looked for.
    """

    contacts: tuple[Contact, ...]
    circles: tuple[Circular | None, ...]
    order: int
    partition: PartitionLike | None
    laid: ContactNode | PlacedContacts | None = None

    def places(self) -> Iterator[PlacedContacts]:
        """The contacts in place on a partition, with their clips turned.

        A clip is turned so that it is negative on the region's side of its faces; one without a face, so
        that it is negative at the centre.

        Without a partition three perpendicular pipes or contacts that meet in one point get the six-tetrahedra corner,
        others the layouts of `pas.layouts.nodes`, one after the other.  A layout, or the name of a kind of them, gets a
        region around the contacts.  Raises `GeometryError` (with the offending pipe or contact) where they do not fit,
        `TypeError` for anything that is no partition, `ValueError` for a name that is none.
        """
        contacts, partition = self.contacts, self.partition
        if isinstance(partition, Partition):
            if not contacts and len(partition.pieces) == 1:
                raise ValueError(
                    "a single cell needs at least one contact; without any, every polynomial is a solution"
                )
            yield self.placed_on(partition)
        elif partition == SIX:
            known = self.laid if isinstance(self.laid, PlacedContacts) else None
            yield known or self.placed_on(six_tetrahedra(contacts, self.circles))
        elif partition is None and any(map(is_opening, contacts)):
            yield self.placed_on(open_region(contacts))
        elif isinstance(partition, Layout) or (isinstance(partition, str) and partition in LAYOUTS):
            yield from self._with_room()
        elif partition is None:
            corner = self.corner() if len(contacts) > 2 else None
            yield from [corner] if corner is not None else self._with_room()
        elif isinstance(partition, str):
            names = ", ".join(map(repr, (SIX, *LAYOUTS)))
            guess = meant(partition, (SIX, *LAYOUTS)) or f"; there are {names}"
            raise ValueError(f"there is no partition {partition!r}{guess}")
        else:
            raise TypeError(
                "partition must be a pas.Partition such as pas.SixTetrahedra(...) or pas.SingleCell(...), a pas.Layout "
                f"or the name of a kind of layouts, not {partition!r}"
            )

    def corner(self) -> PlacedContacts | None:
        """The contacts on six tetrahedra; None where they make no such corner, or do not fit its faces."""
        try:
            return self.placed_on(six_tetrahedra(self.contacts, self.circles))
        except GeometryError:
            return None

    def placed_on(self, partition: Partition) -> PlacedContacts:
        """The contacts on one partition."""
        turned = tuple(map(_turned, joins(partition, self.contacts)))
        placed = joins(partition, turned)
        _check_closed(partition, placed)
        for number, (join, circle) in enumerate(zip(placed, self.circles, strict=True), start=1):
            if join.faces:
                if circle is not None:
                    check_circle(number, circle, join)
                check_join(number, join)
            else:
                _check_curve(number, join.contact)
        if len(partition.pieces) == 1:
            _check_apart(turned)
        return PlacedContacts(partition, turned, self.order)

    def _with_room(self) -> Iterator[PlacedContacts]:
        """The contacts on regions; the error that there are none says how far out clips leave room."""
        layout = self.partition if isinstance(self.partition, Layout) else None
        if len(self.contacts) < 2 and layout is None:
            raise GeometryError(
                f"a blend joins two contacts or more, and here {'is one' if self.contacts else 'are none'}; for a "
                "surface that meets one contact give a partition, such as pas.SingleCell(lower, upper)"
            )
        center = None if layout is None else layout.center
        try:
            yield from self._on_regions(center)
        except GeometryError as error:

            def fits(moved: Sequence[Contact]) -> bool:
                there = replace(self, contacts=tuple(moved), circles=(None,) * len(moved), laid=None)
                return any(True for _ in there._on_regions(center))

            where = room_farther_out(self.contacts, fits, center)
            raise (GeometryError(f"{error}; {where}") if where else error) from None

    def _on_regions(self, center: Vector | None) -> Iterator[PlacedContacts]:
        """The contacts on the regions of all layouts that fit; raises the error of the last where none does."""
        node = self.laid if isinstance(self.laid, ContactNode) else ContactNode.of(self.contacts, center)
        failure: GeometryError | None = None
        found = False
        for made in node.regions(self.order, None if isinstance(self.partition, Partition) else self.partition):
            try:
                placed = self.placed_on(made)
            except GeometryError as error:
                failure = error
                continue
            found = True
            yield placed
        if not found and failure is not None:
            raise failure


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


def _check_closed(partition: Partition, placed: Sequence[Join]) -> None:
    """That one contact closes an open region."""
    openings = [number for number, join in enumerate(placed, start=1) if join.opening]
    if partition.sides and partition.center is not None and len(openings) != 1:
        apex = f"({listed(partition.center)})"
        which = f"contacts {' and '.join(map(str, openings))} do" if openings else "none does"
        raise GeometryError(
            f"the region ({partition.title}) is open: one contact must close it, a plate or an opening whose clip is a "
            f"cone with its apex in the centre {apex}, and {which}"
        )


def _check_apart(contacts: Sequence[Contact]) -> None:
    """That no two contact curves have a common point: one polynomial cannot be regular there."""
    for (i, a), (j, b) in combinations(enumerate(contacts, start=1), 2):
        common = count_real_points(Ideal(a.surface, a.clip, b.surface, b.clip))
        if common == 0:
            continue
        times = "have a whole curve in common" if common is None else f"meet in {common} point{'s' * (common > 1)}"
        raise GeometryError(f"the curves of contacts {i} and {j} {times}; contact curves must be apart")
