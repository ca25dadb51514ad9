"""Contacts of nodes that are open towards a plate, or along a cone out of another surface.

The blend is seen from below, through the opening that the plate's edge is, up to the other contacts' curves.  See
`pas.layouts.open_cone` for the region and `pas.certify.openings` for what is proved in it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, dot, minus, to_float, to_floats
from pas.algebra.scaling import scaled
from pas.contacts.cones import apex
from pas.contacts.contact import Contact, as_contact
from pas.contacts.endless import Endless
from pas.contacts.rims import Rim
from pas.errors import GeometryError
from pas.layouts.discs import Disc, power_of_two, rim_of
from pas.layouts.nodes import check_outlook
from pas.layouts.open_cone import open_cone
from pas.layouts.spacing import is_free
from pas.partition.cells import OpenRegion

FINE = 16
"""Parts of its length, at least, in which the way to the centre is rounded."""


def is_plate(contact: Contact) -> bool:
    """Whether a contact is the edge of a plate: a plane with a curve that no plane cuts out of it."""
    return contact.surface.degree == 1 and contact.clip.degree == 2


def is_opening(contact: Contact) -> bool:
    """Whether a region is open through a contact: a plate, or one whose clip is a cone from inside its surface."""
    if is_plate(contact):
        return True
    center = apex(contact.clip)
    return center is not None and contact.surface.raw(*center) < 0


def with_cone(items: Sequence[Any]) -> list[Any]:
    """Contacts, the clip of the plate among them the cone through its curve around the centre of the region.

    A clip that is such a cone already stays, and its apex is the centre.  The other contact, where it may end anywhere,
    ends as far above the plate as the plate's curve leaves room around it.  Where no contact is a plate, all stay.

    Raises `GeometryError` for anything but a plate and other contacts with closed plane curves above it.
    """
    bound = {number: as_contact(item, f"contacts[{number}]") for number, item in enumerate(items) if not is_free(item)}
    plates = [number for number, contact in bound.items() if is_plate(contact)]
    if not plates:
        free = next((n for n, item in enumerate(items, start=1) if is_free(item)), None)
        if free and any(map(is_opening, bound.values())):
            raise GeometryError(f"contact {free} needs a clip that is a number: its room above an opening is not known")
        return list(items)
    if len(plates) != 1 or len(items) < 2:
        raise GeometryError(
            f"a blend out of a plate joins one plate and other contacts, and here are {len(plates)} and "
            f"{len(items) - len(plates)}"
        )
    number, result = plates[0], list(items)
    plate, edge = bound[number], rim_of(number + 1, bound[number])
    others = [i for i in range(len(items)) if i != number]
    for other in others:
        if is_free(items[other]):
            result[other] = _ended(items[other], scaled(plate.surface), edge, other + 1)
    if apex(plate.clip) is None:
        rims = {other + 1: rim_of(other + 1, as_contact(result[other])) for other in others}
        result[number] = Contact(plate.surface, _cone(plate, _center(scaled(plate.surface), edge, rims, number + 1)))
    return result


def _ended(item: Endless, plate: Polynomial, edge: Rim, number: int) -> Endless:
    """A contact without an end, ended so that an arc has as much room along it as on the plate."""
    slope = plate.raw(*item.axis) - plate.raw(0, 0, 0)
    if slope == 0:
        raise GeometryError(f"contact {number} runs along the plate, and never meets it")
    foot = -plate.raw(*item.point) / slope
    met = np.array(to_floats(_sum(item.point, item.axis, foot)))
    axis, normal = np.array(to_floats(item.axis)), plate.dense(1)[1:4]
    length = float(np.linalg.norm(axis))
    lean = min(1.0, float(abs(axis @ normal) / (length * np.linalg.norm(normal))))  # above by rounding
    radius = item.width(to_float(foot))
    room = edge.radii[0] - float(np.linalg.norm(met - to_floats(edge.center))) - radius / lean
    if room <= 0:
        raise GeometryError(
            f"contact {number} meets the plate where its curve leaves no room: the curve must be wider by "
            f"{-room:.4g} at least"
        )
    above = (room + radius * (1 / lean**2 - 1) ** 0.5) / length
    step = power_of_two(above / FINE)
    return item.clipped(foot + (1 if slope > 0 else -1) * fmpq(ceil(above / to_float(step))) * step)


def open_region(contacts: Sequence[Contact]) -> OpenRegion:
    """The region around the apex of an opening's clip, for contacts `with_cone`.

    Raises `GeometryError` where there is no room, and for anything but an opening and other contacts.
    """
    number, *more = (i for i, contact in enumerate(contacts) if is_opening(contact))
    if more or len(contacts) < 2:
        raise GeometryError(
            f"a blend out of an opening joins it with other contacts, and here are {1 + len(more)} and "
            f"{len(contacts) - 1 - len(more)}"
        )
    opening = contacts[number].scaled
    center = apex(opening.clip)
    if center is None or opening.surface.raw(*center) >= 0:
        raise GeometryError(
            f"contact {number + 1}: its clip {contacts[number].clip} is no cone with its apex inside its surface; give "
            "the cylinder across a plate, as pas.Plate does, or a cone from inside the surface"
        )
    discs = []
    for other, contact in enumerate(contacts, start=1):
        if other != number + 1:
            rim = rim_of(other, contact)
            check_outlook(other, contact, rim, center)
            discs.append(Disc.of(other, rim, center))
    surfaces = [contact.scaled.surface for i, contact in enumerate(contacts) if i != number]
    return open_cone(opening, number + 1, discs, surfaces, center)


def _center(surface: Polynomial, edge: Rim, rims: Mapping[int, Rim], number: int) -> Vector:
    """A point below the plate, from which the other curve is seen straight through the plate's where that can be.

    Of several curves it is below the middle of the plate's.
    """
    normal = (surface.diff(0).raw(0, 0, 0), surface.diff(1).raw(0, 0, 0), surface.diff(2).raw(0, 0, 0))
    for other, rim in rims.items():
        if surface.at(rim.center) <= 0:
            raise GeometryError(
                f"contact {other} ends inside the plate of contact {number}; a blend rises out of a plate, whose "
                "normal points out of the solid"
            )
    foot, up = edge.center, normal
    if len(rims) == 1:
        (rim,) = rims.values()
        slope = dot(normal, rim.normal)
        met = _sum(rim.center, rim.normal, -surface.raw(*rim.center) / slope) if slope else foot
        # How far from the middle of the plate's curve, over its smallest radius, the axis of the one other contact may
        # meet the plate for the centre to be on it.
        within = 0.5
        if np.linalg.norm(np.array(to_floats(minus(met, foot)))) < within * edge.radii[0]:
            foot = met
        up = minus(rim.center, foot)
    # How far below the plate the centre is, over the smallest radius of its curve: rays through the curve rise by 27
    # degrees there, and pipes are not seen much foreshortened yet.
    depth = 0.5
    wanted = depth * edge.radii[0] * float(np.linalg.norm(to_floats(normal))) / to_float(dot(normal, up))
    step = power_of_two(wanted / FINE)
    return _sum(foot, up, -fmpq(round(wanted / to_float(step))) * step)


def _sum(point: Vector, way: Vector, share: fmpq) -> Vector:
    return point[0] + share * way[0], point[1] + share * way[1], point[2] + share * way[2]


def _cone(plate: Contact, center: Vector) -> Polynomial:
    """The cone with its apex in the centre through the plate's curve, negative where its clip is."""
    surface, clip = plate.surface.raw, plate.clip
    y = [g - c for g, c in zip(GENERATORS, center, strict=True)]
    height = surface(*center)
    level = (surface - height) / -height
    value, slopes = clip.raw(*center), [clip.diff(i).raw(*center) for i in range(3)]
    linear = sum((s * c for s, c in zip(slopes, y, strict=True)), 0 * y[0])
    return Polynomial.from_raw(value * level**2 + linear * level + (clip.raw - value - linear))
