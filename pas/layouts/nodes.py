"""Nodes: any number of contacts seen from one centre, and the layouts that serve them, the likeliest first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations
from math import degrees

import numpy as np

from pas.algebra.inputs import short
from pas.algebra.rational import Vector, cross, plain, to_floats
from pas.contacts.contact import Contact
from pas.contacts.movable import Movable
from pas.contacts.rims import Rim, outlook
from pas.errors import GeometryError
from pas.layouts.center import center_of, center_of_bend
from pas.layouts.fan import fan
from pas.layouts.planes import planes
from pas.layouts.region import WALLS, region
from pas.layouts.seen import Seen, angle_between
from pas.layouts.strips import strips
from pas.partition.cells import Partition
from pas.partition.layout import Layout

CURVE_POINTS = 96
"""Points of a contact's curve by which a layout is fitted to it."""

SPREAD, ROOMY = 0.95, 0.8
"""Share of the angle between two contacts that their curves may take up, and around the centre of a bend."""

Maker = Callable[[Sequence[Seen], Vector], Layout]


@dataclass(frozen=True)
class Rung:
    """One way to lay out a node: the layout's kind, what makes it, and how far out its walls are."""

    kind: str
    make: Maker
    walls: float = WALLS


def _fan(each: int) -> Maker:
    return lambda discs, center: fan(discs, center, each)


NEAR_WALLS, MANY = 1.15, 5
"""How far out walls are that serve so many contacts of order 2 better than the usual ones: they get these first,
and the usual ones last."""

LADDERS: dict[int, tuple[Rung, ...]] = {
    1: (
        Rung("planes", planes),
        Rung("fan", _fan(2)),
        Rung("fan", _fan(3)),
        Rung("strips", strips),
        Rung("strips", strips, 1.6),
    ),
    2: (
        Rung("planes", planes, NEAR_WALLS),
        Rung("fan", _fan(2)),
        Rung("fan", _fan(2), NEAR_WALLS),
        Rung("fan", _fan(3)),
    ),
}
"""By the order of contact, that of 2 for higher ones too: full planes where the node is symmetric, then fans; strips
where no fan has room, as around five and six contacts with near clips.  Strips have too few members of higher order:
they are tried there only where they are asked for."""

KINDS = tuple(dict.fromkeys(rung.kind for rungs in LADDERS.values() for rung in rungs))
"""What layouts may be asked for by name."""


@dataclass(frozen=True)
class Node:
    """Contacts as they are seen from their centre."""

    center: Vector
    discs: tuple[Seen, ...]

    @classmethod
    def of(cls, contacts: Sequence[Contact], center: Vector | None = None) -> Node:
        """The node of contacts with closed plane curves; around `center` where that is given.

        Raises `GeometryError` for a contact without such a curve, curves that are seen across one another, or a
        centre that lies beyond a clip.
        """
        for number, contact in enumerate(contacts, start=1):
            _check_flat(number, contact)
        rims = [rim_of_contact(number, contact) for number, contact in enumerate(contacts, start=1)]
        if center is not None:
            return cls._around(contacts, rims, center)
        _check_planes(rims)
        bend = center_of_bend(rims)
        if bend is not None:
            with suppress(GeometryError):
                return cls._around(contacts, rims, bend, ROOMY)
        return cls._around(contacts, rims, center_of(rims))

    @classmethod
    def _around(cls, contacts: Sequence[Contact], rims: Sequence[Rim], place: Vector, spread: float = SPREAD) -> Node:
        for number, (contact, rim) in enumerate(zip(contacts, rims, strict=True), start=1):
            check_outlook(number, contact, rim, place)
        discs = tuple(seen(number, rim, place) for number, rim in enumerate(rims, start=1))
        _check_apart(discs, spread)
        return cls(place, discs)

    def regions(self, order: int, kind: str | None = None) -> Iterator[Partition]:
        """The regions of all layouts that fit, of one kind only where that is said.

        Raises `GeometryError` where none does, with the reason of the last.
        """
        failure: GeometryError | None = None
        found = False
        hopeless: list[Maker] = []  # rungs that differ in their walls have the same layout
        rungs = _rungs(order, kind)
        if order > 1 and len(self.discs) >= MANY:
            rungs = tuple(sorted(rungs, key=lambda rung: rung.walls > NEAR_WALLS))  # stable
        for rung in rungs:
            if rung.make in hopeless:
                continue
            try:
                layout = rung.make(self.discs, self.center)
            except GeometryError as error:
                failure = error
                hopeless.append(rung.make)
                continue
            try:
                made = region(layout, self.discs, rung.walls)
            except GeometryError as error:
                failure = error
                continue
            found = True
            yield made
        if not found and failure is not None:
            none = f"no layout keeps these {len(self.discs)} contacts apart: "
            raise GeometryError(f"{'' if kind else none}{failure}")


def _rungs(order: int, kind: str | None) -> tuple[Rung, ...]:
    """The rungs of an order; of one kind only where that is said, those of the lower orders where this one has none."""
    ladders = [LADDERS[n] for n in sorted(LADDERS, reverse=True) if n <= max(order, 1)]
    if kind is None:
        return ladders[0]
    return next(found for rungs in ladders if (found := tuple(rung for rung in rungs if rung.kind == kind)))


def seen(number: int, rim: Rim, center: Vector) -> Seen:
    """A contact's curve as seen from the centre; raises `GeometryError` where that is in its plane."""
    return Seen.of(number, rim.normal, rim.center, rim.points(CURVE_POINTS), np.array(to_floats(rim.center)), center)


def rim_of_contact(number: int, contact: Movable) -> Rim:
    """The curve of contact `number` (from 1); raises `GeometryError` with that number where there is none."""
    try:
        return contact.rim
    except GeometryError as error:
        raise GeometryError(f"contact {number}: {error}") from None


def _check_flat(number: int, contact: Contact) -> None:
    """That the curve is not the edge of a plate: no flat face of a region can end a surface there.

    The one plane through that curve is the plate's own, which the surface touches all along it.  With GC^1 the
    polynomial goes on beyond the clip on the same side of that plane, so in any region with plane walls there is
    surface that is not in use.
    """
    if contact.surface.degree == 1:
        raise GeometryError(
            f"contact {number}: the surface {contact.surface} is a plane, which a blend touches all along its curve, "
            "so no plane face of a region ends the blend there; give no partition for what rises out of a plate"
        )


def _check_planes(rims: Sequence[Rim]) -> None:
    """That no two contacts end in one plane: no point between them is inside of both."""
    for (i, a), (j, b) in combinations(enumerate(rims, start=1), 2):
        if not any(cross(a.normal, b.normal)) and a.plane.at(b.center) == 0:
            same = "curve" if a.center == b.center and a.radii == b.radii else "plane"
            raise GeometryError(
                f"contacts {i} and {j} end in the same {same}; the contacts of a node must lie in different directions "
                "from its centre, which a pas.Layout(rays, pieces, center) may give"
            )


def check_outlook(number: int, contact: Contact, rim: Rim, center: Vector) -> None:
    """That the surface faces the centre all along its curve, else no surface through it is met once by each ray."""
    if contact.surface.at(rim.center) > 0:
        raise GeometryError(
            f"contact {number}: the surface {short(str(contact.surface))} is positive inside its curve; a surface must "
            "be negative inside (is its sign turned round?)"
        )
    cosine, where = outlook(contact.surface, rim, center)
    if cosine <= 0:
        words, place = ", ".join(map(plain, center)), "({:.4g}, {:.4g}, {:.4g})".format(*where)
        raise GeometryError(
            f"contact {number}: seen from the centre of the node, ({words}), its surface turns its back at {place}, so "
            "no blend around that centre is met once by each ray; move its clip, or give the centre by a pas.Layout"
        )


def _check_apart(discs: Sequence[Seen], spread: float) -> None:
    """That no two curves are seen across one another from the centre."""
    for a, b in combinations(discs, 2):
        between = angle_between(a.direction, b.direction)
        if a.angle + b.angle >= spread * between:
            raise GeometryError(
                f"contacts {a.number} and {b.number} are seen {degrees(between):.3g} degrees apart from the centre, "
                f"and their curves take up {degrees(a.angle):.3g} and {degrees(b.angle):.3g} degrees of that"
            )
