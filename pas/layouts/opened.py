"""Contacts of nodes that are open towards a plate, or along a cone out of another surface.

The blend is seen from below, through the opening that the plate's edge is, up to the other contacts' curves.  Its
region is a convex cone around the centre, cut off above the opening, with a clip face for each other contact; for what
is proved in it see `pas.certify.contact_proofs`.  One contact has all of the cone for its piece.  Around several the
cone is cut into sectors by half-planes through its axis: one around each contact, and some without.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import ceil, cos, degrees, pi
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.affine import slope_at
from pas.algebra.lengths import unit
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, dot, listed, minus, moved, to_float, to_floats
from pas.algebra.scaling import scaled
from pas.arrays import Floats
from pas.contacts.cones import apex, first_met, nappe
from pas.contacts.contact import Contact, as_contact
from pas.contacts.endless import Endless
from pas.contacts.rims import Rim
from pas.errors import GeometryError
from pas.layouts.clips import is_free
from pas.layouts.discs import Disc, power_of_two, rim_of, rounded, sides
from pas.layouts.nodes import check_outlook
from pas.layouts.region import Corners, around_clip
from pas.partition.cells import OpenRegion
from pas.partition.layout import primitive

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
    met = np.array(to_floats(moved(item.point, (foot, item.axis))))
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
    normal = slope_at(surface)
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
        met = moved(rim.center, (-surface.raw(*rim.center) / slope, rim.normal)) if slope else foot
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
    return moved(foot, (-fmpq(round(wanted / to_float(step))) * step, up))


def _cone(plate: Contact, center: Vector) -> Polynomial:
    """The cone with its apex in the centre through the plate's curve, negative where its clip is."""
    surface, clip = plate.surface.raw, plate.clip
    y = [g - c for g, c in zip(GENERATORS, center, strict=True)]
    height = surface(*center)
    level = (surface - height) / -height
    value, slopes = clip.raw(*center), slope_at(clip, center)
    linear = sum((s * c for s, c in zip(slopes, y, strict=True)), 0 * y[0])
    return Polynomial.from_raw(value * level**2 + linear * level + (clip.raw - value - linear))


CORNERS, LARGER = 12, 1.05
"""Of the polygon round the opening, and how much larger than the smallest one it is."""

ROUND = 64
"""Parts of their length, at least, in which corners are rounded."""

WIDEST, APART = 2 * pi / 3, 0.02
"""Radians: the widest sector without a contact, and the least between two contacts, seen along the axis."""

SAMPLES = 256
"""Places on the axis where it is looked at which contacts it is inside of."""


def _azimuths(axes: Floats, points: Floats) -> Floats:
    """The angles (N,) of points (N, 3) round the first of the axes (3, 3) of a nappe, in units in which it is round."""
    _, first, second = np.linalg.solve(axes.T, points.T)
    return np.arctan2(second, first)


def open_cone(
    opening: Contact, number: int, discs: Sequence[Disc], surfaces: Sequence[Polynomial], center: Vector
) -> OpenRegion:
    """The region for contact `number` as the opening and the others, as they are seen from the centre.

    Raises `GeometryError` where these are not seen through the opening, or are not apart.
    """
    least = 0.01  # how far above the opening other contacts end at least, over its height
    # How far rays through the polygon go on beyond the opening, over the way to it, or over the other contacts'
    # height.
    beyond = 0.3
    shift = [g + c for g, c in zip(GENERATORS, center, strict=True)]
    clip, surface, *others = (
        Polynomial.from_raw(p.raw.compose(*shift)) for p in (opening.clip, opening.surface, *surfaces)
    )
    axes = nappe(clip, np.mean([disc.middle for disc in discs], axis=0))
    axes[2] *= 1.0 if np.linalg.det(axes) > 0 else -1.0
    ends = _sectors(axes, discs) if len(discs) > 1 else []
    angles = _angles(ends)
    steps = np.diff(np.append(angles, angles[0] + 2 * pi))
    around = np.cos(angles)[:, None] * axes[1] + np.sin(angles)[:, None] * axes[2]
    polygon = unit(axes[0] + LARGER / cos(float(steps.max()) / 2) * around)
    inwards = sides(polygon)
    for disc in discs:
        if not (unit(disc.points) @ inwards.T).min() > 0:
            raise GeometryError(
                f"the curve of contact {disc.number} is not seen through that of contact {number} from "
                f"({listed(center)}), below; make the opening wider, or the pipe shorter"
            )
    far = max(float(np.linalg.norm(disc.points, axis=1).max()) for disc in discs)
    met = first_met(surface, polygon, far)
    if not np.isfinite(met).all():
        raise GeometryError(f"contact {number}: its surface does not close the cone that clips it")
    axis = unit(axes[0])
    heights = [float((disc.points @ axis).min()) / float((met[:, None] * polygon @ axis).max()) - 1 for disc in discs]
    low = int(np.argmin(heights))
    if heights[low] <= least:
        raise GeometryError(
            f"the curve of contact {discs[low].number} reaches down to contact {number}, and leaves no room"
        )
    outer = [_rounded(corner) for corner in (1 + beyond * min(1.0, heights[low])) * met[:, None] * polygon]
    if not ends:
        pieces = [_with_face(discs[0], outer)]
    else:
        top = _rounded(_top(axis, others, far, float(met.max())) * axis)
        places = [int(np.argmin(np.abs(angles - start))) for start, _ in ends]
        pieces = list[list[Corners]]()
        for (_, held), first, last in zip(ends, places, [*places[1:], places[0] + len(outer)], strict=True):
            ring = [outer[i % len(outer)] for i in range(first, last + 1)]
            pieces.append(_with_face(held, [top, *ring]) if held else [(top, a, b) for a, b in pairwise(ring)])
    sectors = f" and {len(pieces)} sectors" if len(pieces) > 1 else ""
    return OpenRegion.of_triangles(pieces, center, f"open cone of {len(outer)} sides{sectors}")


def _with_face(disc: Disc, rim: Sequence[Vector]) -> list[Corners]:
    """The far triangles of a piece around a contact's clip face."""
    return around_clip(disc, [primitive(corner) for corner in rim], rim)


def _sectors(axes: Floats, discs: Sequence[Disc]) -> list[tuple[float, Disc | None]]:
    """Where sectors begin, by rising angles, and whose they are: one around each contact, others without."""
    found = []
    for disc in discs:
        middle = float(_azimuths(axes, disc.middle[None])[0])
        away = (_azimuths(axes, disc.points) - middle + pi) % (2 * pi) - pi
        if np.ptp(away) >= pi:
            raise GeometryError(
                f"contact {disc.number} is seen around the axis of the opening; several contacts must lie around it"
            )
        found.append((middle + float(away.min()), middle + float(away.max()), disc))
    found.sort(key=lambda one: one[0] % (2 * pi))
    ends: list[tuple[float, Disc | None]] = []
    for (start, end, disc), (after, _, other) in zip(found, [*found[1:], found[0]], strict=True):
        gap = (after - end) % (2 * pi)
        if not APART < gap < 2 * pi - (end - start):
            raise GeometryError(
                f"contacts {disc.number} and {other.number} are seen across one another from below the opening, "
                f"{degrees(min(gap, 2 * pi - gap)):.3g} degrees"
            )
        empty = max(0, ceil((gap + end - start - pi) / WIDEST)) if gap > pi / 2 else 0
        shares = [(1 + i) / (2 + empty) for i in range(empty + 1)]
        ends += [((end + share * gap) % (2 * pi), None) for share in shares[:-1]]
        ends.append(((end + shares[-1] * gap) % (2 * pi), other))
    return sorted(ends, key=lambda one: one[0])


def _angles(ends: Sequence[tuple[float, Disc | None]]) -> Floats:
    """The angles of the polygon's corners: where sectors begin, and between."""
    starts = [start for start, _ in ends] or [0.0]
    found: list[float] = []
    for start, end in pairwise([*starts, starts[0] + 2 * pi]):
        count = max(1, ceil(CORNERS * (end - start) / (2 * pi) - 1e-9))
        found += [start + (end - start) * i / count for i in range(count)]
    return np.array(found)


def _top(axis: Floats, others: Sequence[Polynomial], far: float, least: float) -> float:
    """How far out the region ends on the axis: beyond the opening and all other contacts' surfaces."""
    shares = np.linspace(0, far, SAMPLES)[1:]
    inside = np.min([other(shares[:, None] * axis) for other in others], axis=0) < 0
    if inside[-1]:
        raise GeometryError("the axis of the opening does not leave all other contacts, which must lie around it")
    leave = float(shares[np.flatnonzero(inside)[-1]]) if inside.any() else 0.0
    above = 1.3  # over the height at which the axis of the cone leaves all other contacts: where the region ends on it
    return above * max(leave, least)


def _rounded(corner: Floats) -> Vector:
    return rounded(corner, power_of_two(float(np.linalg.norm(corner)) / ROUND))
