"""Nodes: any number of contacts seen from one centre, and the layouts that serve them, the likeliest first.

The centre is the point next to the lines that go through the contacts' curves; of a bend it is further inside.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations
from math import degrees, sqrt

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.inputs import short, shown_point
from pas.algebra.lengths import angle_between, unit
from pas.algebra.matrices import solved
from pas.algebra.rational import Vector, cross, dot, listed, minus, moved, three, to_floats
from pas.contacts.contact import Contact
from pas.contacts.rims import Rim, outlook
from pas.errors import GeometryError
from pas.layouts.discs import Disc, power_of_two, rim_of, rounded
from pas.layouts.kinds import NEAR_WALLS, LayoutTrial, trials
from pas.layouts.planes import have_room
from pas.layouts.region import region
from pas.partition.cells import Partition
from pas.partition.layout import Layout

SPREAD, ROOMY = 0.95, 0.8
"""Share of the angle between two contacts that their curves may take up, and around the centre of a bend."""

MANY = 5
"""So many contacts of order 2 without planes are served better by near walls: they get these first, the usual last."""

UNIT = fmpq_mat(3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1])

TOWARDS_BEND, INSIDE, FINE = 0.45, 0.266, 64
"""How far the centre of a bend lies towards the middle of the arc that fits between its curves, as a share of that; at
most so many smaller radii towards either; and parts of that radius to which it is rounded.

The tube turns away from where its lines meet.  Around that point a right bend of GC^2 (clips 2 radii away) is 0.072
radii off the tube that is rolled round and its sharpness 1.25, here 0.043 and 1.08; at 60 degrees it is half as far off
as there; walls of hollow bends become even.  Much farther, the surface hollows inside."""


@dataclass(frozen=True)
class ContactNode:
    """Contacts as they are seen from their centre."""

    center: Vector
    discs: tuple[Disc, ...]

    @classmethod
    def of(cls, contacts: Sequence[Contact], center: Vector | None = None) -> ContactNode:
        """The node of contacts with closed plane curves; around `center` where that is given.

        Raises `GeometryError` for a contact without such a curve, curves that are seen across one another, or a
        centre that lies beyond a clip.
        """
        for number, contact in enumerate(contacts, start=1):
            _check_flat(number, contact)
        rims = [rim_of(number, contact) for number, contact in enumerate(contacts, start=1)]
        if center is not None:
            return cls._around(contacts, rims, center)
        _check_planes(rims)
        bend = center_of_bend(rims)
        if bend is not None:
            with suppress(GeometryError):
                return cls._around(contacts, rims, bend, ROOMY)
        return cls._around(contacts, rims, center_of(rims))

    @classmethod
    def _around(
        cls, contacts: Sequence[Contact], rims: Sequence[Rim], place: Vector, spread: float = SPREAD
    ) -> ContactNode:
        for number, (contact, rim) in enumerate(zip(contacts, rims, strict=True), start=1):
            check_outlook(number, contact, rim, place)
        discs = tuple(Disc.of(number, rim, place) for number, rim in enumerate(rims, start=1))
        _check_apart(discs, spread)
        return cls(place, discs)

    def regions(self, order: int, wanted: Layout | str | None = None) -> Iterator[Partition]:
        """The regions of all layouts that fit; of the layout or the kind only that is wanted.

        Raises `GeometryError` where none does, with the reason of the last.
        """
        if wanted is not None and not isinstance(wanted, str):
            yield region(wanted, self.discs)
            return
        todo = trials(order, wanted)
        if order > 1 and len(self.discs) >= MANY and not have_room(self.discs):
            todo = tuple(sorted(todo, key=lambda trial: trial.walls > NEAR_WALLS))  # stable
        failures: list[GeometryError] = []
        for trial in todo:
            found = self._region(trial)
            if isinstance(found, GeometryError):
                failures.append(found)
                continue
            yield found
        if len(failures) == len(todo):
            none = f"no layout keeps these {len(self.discs)} contacts apart: "
            raise GeometryError(f"{'' if wanted else none}{failures[-1]}")

    @cached_property
    def _region(self) -> Callable[[LayoutTrial], Partition | GeometryError]:
        """The region of a trial or why there is none, found once, however often contacts are looked at."""

        def tried(trial: LayoutTrial) -> Partition | GeometryError:
            try:
                return region(trial.make(self.discs, self.center), self.discs, trial.walls)
            except GeometryError as error:
                return error

        return cache(tried)


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
    """Raise `GeometryError` for two contacts that end in one plane: no point between them is inside of both."""
    for (i, a), (j, b) in combinations(enumerate(rims, start=1), 2):
        if not any(cross(a.normal, b.normal)) and a.plane.at(b.center) == 0:
            same = "curve" if a.center == b.center and a.radii == b.radii else "plane"
            raise GeometryError(
                f"contacts {i} and {j} end in the same {same}; the contacts of a node must lie in different directions "
                "from its centre, which a pas.Layout(rays, pieces, center) may give"
            )


def check_outlook(number: int, contact: Contact, rim: Rim, center: Vector) -> None:
    """Raise `GeometryError` unless the surface faces the centre all along its curve, so that rays can cross it once."""
    if contact.surface.at(rim.center) > 0:
        raise GeometryError(
            f"contact {number}: the surface {short(str(contact.surface))} is positive inside its curve; a surface must "
            "be negative inside (is its sign turned round?)"
        )
    cosine, where = outlook(contact.surface, rim, center)
    if cosine <= 0:
        words, place = listed(center), shown_point(where)
        raise GeometryError(
            f"contact {number}: seen from the centre of the node, ({words}), its surface turns its back at {place}, so "
            "no blend around that centre is met once by each ray; move its clip, or give the centre by a pas.Layout"
        )


def _check_apart(discs: Sequence[Disc], spread: float) -> None:
    """Raise `GeometryError` for two curves that are seen across one another from the centre."""
    for a, b in combinations(discs, 2):
        between = angle_between(a.direction, b.direction)
        if a.angle + b.angle >= spread * between:
            raise GeometryError(
                f"contacts {a.number} and {b.number} are seen {degrees(between):.3g} degrees apart from the centre, "
                f"and their curves take up {degrees(a.angle):.3g} and {degrees(b.angle):.3g} degrees of that"
            )


def center_of_bend(rims: Sequence[Rim]) -> Vector | None:
    """A better centre for two rims whose lines are not parallel; None for others."""
    if len(rims) != 2 or not any(cross(rims[0].normal, rims[1].normal)):
        return None
    radius = min(rim.radii[0] for rim in rims)
    middle = center_of(rims)
    first, second = (unit(to_floats(rim.normal)) for rim in rims)
    clip = min(float(np.linalg.norm(to_floats(rim.center) - np.array(to_floats(middle)))) for rim in rims)
    cosine = float(np.linalg.norm(first + second)) / 2  # of half of the angle between them
    arc = clip * (1 - sqrt(max(0.0, 1 - cosine**2))) / cosine
    step = power_of_two(radius / FINE)
    inwards = rounded(min(TOWARDS_BEND * arc / (2 * cosine), INSIDE * radius) * (first + second), step)
    return moved(middle, (1, inwards))


def center_of(rims: Sequence[Rim]) -> Vector:
    """The point with the least sum of squared distances to the lines across all rims through their centres.

    Of several, as for rims on one line, the one next to the middle of these.  It is exact where it lies on all lines,
    else rounded.
    """
    most_digits = 24  # binary digits up to which a point on all axes is kept as it is
    # Parts of the smallest radius to which a centre is rounded: an axis may miss it, and short numbers keep the
    # algebra short.
    parts = 32
    middle = tuple(sum((rim.center[i] for rim in rims), fmpq(0)) / len(rims) for i in range(3))
    matrix, right = fmpq_mat(3, 3), fmpq_mat(3, 1)
    for rim in rims:
        normal = fmpq_mat(3, 1, list(rim.normal))
        across = UNIT - normal * normal.transpose() * (1 / dot(rim.normal, rim.normal))  # the projection along the line
        matrix += across
        right += across * fmpq_mat(3, 1, [c - m for c, m in zip(rim.center, middle, strict=True)])
    # the shortest solution of M x = r for a symmetric M is M y with M^2 y = r
    square = matrix * matrix
    augmented = fmpq_mat([[*row, value] for row, value in zip(square.tolist(), right.entries(), strict=True)])
    solution = solved(augmented)
    assert solution is not None  # M^2 y = r has one wherever M x = r has
    found = [m + o for m, o in zip(middle, (matrix * fmpq_mat(3, 1, solution[0])).entries(), strict=True)]
    off = any(any(cross(minus(found, rim.center), rim.normal)) for rim in rims)
    if not off and max(int(v.q).bit_length() for v in found) <= most_digits:
        return three(found)
    return rounded(to_floats(found), power_of_two(min(rim.radii[0] for rim in rims) / parts))
