"""Contacts in place: a partition, contacts on it and an order of continuity, with what follows from them.

Whatever works with surfaces that meet contacts asks here where the contacts are: the choice among
the members of a space, the conditions of that space, and a surface itself.  Everything is in the
local coordinates of the partition (see `pas.algebra.affine`), and worked out once.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Self

import numpy as np

from pas.algebra.inputs import check_order
from pas.arrays import Bools, Floats
from pas.contacts.contact import Contact
from pas.contacts.joins import Join, joins
from pas.partition.cells import Partition
from pas.partition.complex import OuterFace
from pas.surface.boundary_loops import BoundaryLoop, boundary_loops


class PlacedContacts:
    """Contacts that surfaces on a partition meet with GC^`order`, its pieces meeting with C^`order`.

    Raises `ValueError` for an order that is none; `joins` raises `GeometryError` where a contact
    has no face of a partition of several pieces.
    """

    def __init__(self, partition: Partition, contacts: Sequence[Contact], order: int) -> None:
        self.partition, self.contacts, self.order = partition, tuple(contacts), check_order(order)

    def __reduce__(self) -> tuple[type[Self], tuple[Any, ...]]:
        """What follows from them is worked out anew in another process."""
        return type(self), (self.partition, self.contacts, self.order)

    def __repr__(self) -> str:
        return f"<PlacedContacts: {len(self.contacts)} contacts, GC^{self.order}, {self.partition.name}>"

    @property
    def local(self) -> Partition:
        """The partition in local coordinates."""
        return self.partition.local

    @cached_property
    def local_contacts(self) -> tuple[Contact, ...]:
        """The contacts in local coordinates, scaled."""
        frame = self.partition.frame
        return tuple(Contact(frame.localise(c.surface), frame.localise(c.clip)).scaled for c in self.contacts)

    @cached_property
    def joins(self) -> tuple[Join, ...]:
        """The contacts in local coordinates, with their places on the partition."""
        return joins(self.local, self.local_contacts)

    @cached_property
    def loops(self) -> list[BoundaryLoop]:
        """The curves on which surfaces end, in local coordinates; raises `ArithmeticError` where one is no graph over
        the angle about its middle."""
        return boundary_loops(self.joins)

    @cached_property
    def carriers(self) -> tuple[tuple[int, ...], ...]:
        """The pieces that carry each contact."""
        return tuple(join.pieces for join in self.joins)

    @cached_property
    def walls(self) -> tuple[OuterFace, ...]:
        """The faces of the region, in local coordinates, that the inside of a surface may not reach: the outer ones in
        no clip plane and, where the region is open and no contact closes it, its sides."""
        clipped = {face.vertices for join in self.joins for face in join.faces}
        sides = () if any(join.opening for join in self.joins) else self.local.sides
        return (*(face for face in self.local.outer_faces if face.vertices not in clipped), *sides)

    def located(self, number: int) -> Contact:
        """A contact that says near which point its curve is, as it was given, or by its place on the partition."""
        contact, frame = self.contacts[number], self.partition.frame
        near = contact.near or frame.global_points(self.joins[number].curve()[0]).tolist()
        return Contact(contact.surface, contact.clip, near)

    def in_use(self, directions: Floats) -> Bools:
        """Along which directions (N, 3) from the centre surfaces are in use: inside all openings."""
        result = np.ones(len(directions), dtype=bool)
        for join in self.joins:
            if join.opening:
                result &= (join.contact.clip(directions) <= 0) & (directions @ join.nappe[0] > 0)
        return result


class InPlace:
    """Anything that meets contacts in place: a surface, or all of a space."""

    placed: PlacedContacts

    @property
    def partition(self) -> Partition:
        """The region and its pieces."""
        return self.placed.partition

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts that are met, in the user's coordinates."""
        return self.placed.contacts

    @property
    def order(self) -> int:
        """The k of GC^k at the contacts and C^k between pieces."""
        return self.placed.order
