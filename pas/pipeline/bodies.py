"""Blends as solids: the inside of the surface with pieces of its neighbours, capped.

The surface's pieces are one face, bounded by the cells of the partition; each neighbour goes on from its
clip and ends in a flat cap.  The claims of contact become joints, which the solid proves anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, TypeAlias

import numpy as np
from flint import fmpq

from pas.algebra.lengths import unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, dot, exact, rational, three, to_float, to_floats
from pas.algebra.scaling import Scaled, scaled
from pas.contacts.contact import Contact
from pas.contacts.ends import ContactEnd, triple
from pas.errors import GeometryError
from pas.piecewise import PiecewiseSurface
from pas.pipeline.around_opening import AroundOpening
from pas.pipeline.neighbours import NOTHING, separators
from pas.solid.assembly import union
from pas.solid.functions import Pieces, region
from pas.solid.sheets import SheetBody, Side
from pas.solid.solid import Solid, patch
from pas.solid.strips import Chain, chain_between
from pas.solid.tree import Atom, combined

Around: TypeAlias = 'Literal["edged", "endless", "surface", "run"]'

Length: TypeAlias = "Exact | Sequence[Exact] | None"
"""By how much neighbours go on: all of them, or each; None is half of the region's scale."""


def body(
    surface: PiecewiseSurface,
    length: Length = None,
    names: Sequence[str] | None = None,
    face: str = "blend",
    floor: fmpq | None = None,
    around: Around = "edged",
    beyond: fmpq = NOTHING,
) -> Solid:
    """The solid inside a surface, whose name is `face`, and its neighbours; see `Blend.solid`.

    `floor` is the height of the flat back below an opening above the region's centre, in units of the opening's axis.
    The neighbour around it is `edged` or endless, or the surface goes on in its place as far as the region does, or the
    walls of the opening are left to a run with which the solid is united.
    Neighbours go on by `beyond` more than their length.
    """
    if not surface.partition.cells:
        raise GeometryError("the blend has no region, so it bounds no solid: give its cell one, as in SingleCell(box)")
    if surface.partition.sides and not any(join.opening for join in surface.joins):
        raise GeometryError("the region of the blend is open and no contact closes it, so that it bounds no solid")
    titles = _names(names, len(surface.contacts))
    pieces = Pieces(surface.partition, surface.polynomials)
    inner = Solid(combined(False, Atom(pieces, face), region(surface.partition)))
    reaches = lengths_of(length, surface)
    solids, ends, chains = [inner], [], []
    given = zip(titles, surface.contacts, surface.joins, reaches, strict=True)
    for number, (name, contact, join, reach) in enumerate(given):
        end = contact.clip if join.opening else clip_plane(surface, number)
        ends.append(end)
        if join.opening:
            opening, works = AroundOpening.of(surface, number), NOTHING
            back = opening.back(reach) if floor is None else opening.at(floor)
            solids[0] = solids[0].cap(back, f"{name} back" if around != "run" else "")
            solids[0] = solids[0] if around == "surface" else solids[0].cap(end, "")
            if reach > 0 and around in ("edged", "endless"):
                plate = patch(name, contact.surface, end).cap(back, f"{name} back")
                works = opening.fitting(reach, length is None) if around == "edged" else reach
                solids.append(opening.ended(plate, reach, works) if around == "edged" else plate)
            chains.append(opening.chain(name, reach, works) if around == "edged" else None)
            continue
        chains.append(chain_beyond(surface, number, name, end, reach))
        if reach + beyond > 0:
            cap = _cap(end, reach + beyond)
            apart = separators(surface, number, name, reach, beyond)
            solids.append(patch(name, contact.surface, end, -cap, *apart).cap(cap, f"{name} end"))
    solid = union(solids)
    for name, contact, end, reach in zip(titles, surface.contacts, ends, reaches, strict=True):
        if name in solid.faces:
            solid = solid.joined(face, name, (contact.surface, end), surface.order)
        elif reach == 0 and not (around == "run" and end.degree == 2):
            solid = solid.cap(end, f"{name} end")
    known = [chain for chain in chains if chain is not None]
    sheets = SheetBody.of([Side(surface, face, tuple(known))]) if len(known) == len(chains) else None
    return replace(solid, sheets=sheets)


def chain_beyond(surface: PiecewiseSurface, number: int, name: str, plane: Polynomial, length: fmpq) -> Chain | None:
    """What goes on from a contact by a length beyond a plane, up to a flat end; None where that is none of `strips`."""
    center = surface.partition.center
    return chain_between(surface.placed.told(number), plane, _cap(plane, length), (name, f"{name} end"), center)


def hollow_body(
    outer: PiecewiseSurface, inner: PiecewiseSurface, length: Length = None, names: Sequence[str] | None = None
) -> Solid:
    """The solid between two surfaces and their neighbours; see `HollowBlend.solid`.

    The inner solid goes on beyond the caps of the outer one, so that their ends are not in one plane: around an opening
    it has no end, and its back is lower.  Where the outer one ends in the opening the inner surface goes on.
    """
    reaches = lengths_of(length, outer)
    titles = _names(names, len(outer.contacts))
    given = ((n, reach) for n, (join, reach) in enumerate(zip(outer.joins, reaches, strict=True)) if join.opening)
    mouth = next((Mouth.of(outer, inner, number, reach, length is None) for number, reach in given), None)
    floors = (None, None) if mouth is None else (mouth.floor, mouth.within.low / 4)
    around: Around = "endless" if mouth is not None and not mouth.ends else "surface"
    inside, beyond = [f"{INSIDE} {t}" for t in titles], outer.partition.frame.scale / FURTHER
    face = f"{INSIDE} blend"
    cavity = body(inner, reaches, inside, face, floors[1], around, beyond)
    ended = [name for name, reach in zip(inside, reaches, strict=True) if reach == 0]
    if mouth is not None:
        reaches[mouth.around.number - 1] = mouth.works
        ended += [] if mouth.goes_on else [inside[mouth.around.number - 1]]
    joints = tuple(joint for joint in cavity.joints if joint.second not in ended)
    solid = body(outer, reaches, names, floor=floors[0]) - replace(cavity, joints=joints)
    return replace(solid, sheets=_wall_sheets(outer, inner, titles, reaches, mouth))


@dataclass(frozen=True, eq=False)
class Mouth:
    """A wall at an opening: `around` its outer side and `within` its inner one, up to an `edge`, which is as far around
    the outer one as `works`."""

    around: AroundOpening
    within: AroundOpening
    works: fmpq
    edge: Polynomial

    @classmethod
    def of(cls, outer: PiecewiseSurface, inner: PiecewiseSurface, number: int, reach: fmpq, shorter: bool) -> Mouth:
        """That of contact `number`; raises what `AroundOpening.fitting` raises.

        If it may be `shorter`, the edge of a curved surface is all around the inner side's curve or all inside of it.
        """
        around, within = (AroundOpening.of(surface, number) for surface in (outer, inner))
        works = around.fitting(reach, shorter) if reach > 0 else reach
        found = cls(around, within, works, around.edge(works) if works > 0 else around.contact.clip)
        while shorter and not (around.flat or found.goes_on or found.ends):
            found = replace(found, works=found.works / 2, edge=around.edge(found.works / 2))
        return found

    @property
    def floor(self) -> fmpq:
        """Half the height of the inner opening over the centre, in units of the outer one's axis."""
        axis = self.around.axis
        return self.within.low / 2 * dot(axis, axis) / dot(axis, self.within.axis)

    @cached_property
    def goes_on(self) -> bool:
        """Whether the inner side's curve is inside the edge, so that its contact goes on from there."""
        return self.works > 0 and self.within.inside(self.edge)

    @cached_property
    def ends(self) -> bool:
        """Whether the inner surface goes on to the edge itself."""
        return self.works == 0 or (not self.around.flat and self.within.holds(self.edge))

    def chains(self, name: str, inner: PiecewiseSurface) -> tuple[Chain | None, ...]:
        """What goes on from both sides; None where the inner contact does not, or is not seen to go on so far."""
        around, within, works = self.around, self.within, self.works
        if self.ends:
            within, works = AroundOpening.of(inner, within.number - 1), NOTHING
        seen = self.ends or (self.goes_on and (within.flat or within.leave(around.wide(works))))
        if around.center != within.center or not seen:
            return None, None
        walled = within.walled(f"{INSIDE} {name}", works, self.edge, scaled(around.at(self.floor)))
        return around.walled(name, self.works, self.edge), walled


def up_to(inner: PiecewiseSurface, number: int, cone: Polynomial) -> PiecewiseSurface:
    """An inner surface up to a cone inside that of its opening `number`, on which it is a contact of itself."""
    contacts = [*inner.contacts]
    if contacts[number].clip.primitive() == cone.primitive():
        return inner
    contacts[number] = Contact(inner.polynomials[0], cone)
    return PiecewiseSurface(inner.partition, contacts, inner.order, inner.patches, inner.degree)


def _wall_sheets(
    outer: PiecewiseSurface, inner: PiecewiseSurface, names: Sequence[str], reaches: Sequence[fmpq], mouth: Mouth | None
) -> SheetBody | None:
    """The sheets of a wall: what goes on inside ends in the planes, edges and cones in which the outer side does."""
    if mouth is not None and mouth.ends:
        inner = up_to(inner, mouth.within.number - 1, mouth.edge)
    pairs: list[tuple[Chain | None, ...]] = []
    for number, (name, reach) in enumerate(zip(names, reaches, strict=True)):
        if mouth is not None and outer.joins[number].opening:
            pairs.append(mouth.chains(name, inner))
            continue
        plane, both = clip_plane(outer, number), ((outer, name), (inner, f"{INSIDE} {name}"))
        pairs.append(tuple(chain_beyond(surface, number, title, plane, reach) for surface, title in both))
    sides = [
        Side(surface, face, tuple(chain for chain in chains if chain is not None))
        for surface, face, *chains in zip((outer, inner), ("blend", f"{INSIDE} blend"), *pairs, strict=True)
    ]
    return SheetBody.of(sides) if all(len(side.chains) == len(names) for side in sides) else None


def contact_ends(surface: PiecewiseSurface, length: Length = 0) -> tuple[ContactEnd, ...]:
    """Where a surface and its neighbours of a `length` end, at each contact; see `Blend.ends`."""
    reaches = lengths_of(length, surface)
    return tuple(
        _opening_end(surface, number) if join.opening else _end(surface, number, reach)
        for number, (join, reach) in enumerate(zip(surface.joins, reaches, strict=True))
    )


def _end(surface: PiecewiseSurface, number: int, reach: fmpq) -> ContactEnd:
    contact, center = surface.contacts[number], surface.partition.center
    try:
        here = ContactEnd.of(contact, center)
        if reach == 0:
            return here
        there = three(exact(c + to_float(reach) * d) for c, d in zip(here.center, here.direction, strict=True))
        return ContactEnd.of(Contact(contact.surface, _cap(clip_plane(surface, number), reach), there), center)
    except GeometryError as error:
        raise GeometryError(f"contact {number + 1}, {to_float(reach):.4g} beyond its clip: {error}") from None


def _opening_end(surface: PiecewiseSurface, number: int) -> ContactEnd:
    """That of an opening, whose curve need not be plane: seen along its axis, in the middle of its heights."""
    seen = AroundOpening.of(surface, number)
    axis, size = unit(to_floats(seen.axis)), to_float(seen.scale)
    points, origin = size * surface.joins[number].curve(), np.array(to_floats(seen.center))
    middle = np.array(to_floats(seen.middle)) - origin
    heights = points @ axis
    middle += ((heights.min() + heights.max()) / 2 - middle @ axis) * axis
    radii = np.linalg.norm(points - middle - ((points - middle) @ axis)[:, None] * axis, axis=1)
    place, out = origin + middle, -axis
    return ContactEnd(
        triple(place), triple(out), (float(radii.min()), float(radii.max())), float(np.linalg.norm(middle))
    )


FURTHER = 64
"""Parts of the region's scale, by one of which a cavity goes on beyond the caps: there it takes nothing away, and must
be proved to be one piece as well."""

INSIDE = "inside of"
"""How faces of a cavity are named after those of the outside, as a shell's are."""


def clip_plane(surface: PiecewiseSurface, number: int) -> Polynomial:
    """The plane of the region's side in which a neighbour begins, positive on the neighbour's side."""
    join, clip = surface.joins[number], surface.contacts[number].clip
    if len(join.planes) == 1 and join.confined:
        plane = join.planes[0]
        if clip.degree == 1:
            return clip if plane.cofactor.raw.leading_coefficient() > 0 else -clip
        return surface.partition.frame.globalise(plane.plane)
    what = "is no plane" if clip.degree != 1 else "is no side of the region"
    raise GeometryError(
        f"neighbour {number + 1} ends in {clip} = 0, which {what}, so it has no flat cap there; "
        "compose the solid with pas.solid.patch instead"
    )


def _cap(plane: Polynomial, length: fmpq) -> Polynomial:
    """The plane at a distance of `length` beyond another, rounded to a double where that is irrational."""
    steps = Scaled.of([plane])
    size = exact(float(np.linalg.norm(steps.polynomials[0].dense(1)[1:]))) * fmpq(2) ** steps.exponent
    return plane - Polynomial(length * size)


def lengths_of(length: Length, surface: PiecewiseSurface) -> list[fmpq]:
    """The length of each neighbour."""
    size = len(surface.contacts)
    several = isinstance(length, Sequence | np.ndarray) and not isinstance(length, str)
    given: Sequence[Exact | None] = length if several else [length] * size  # type: ignore[assignment,list-item]
    if len(given) != size:
        raise ValueError(f"length must be one number, or {size}, one for each neighbour, not {len(given)}")
    return [length_of(one, surface) for one in given]


def length_of(length: Exact | None, surface: PiecewiseSurface) -> fmpq:
    """A neighbour's length: by default half of the region's scale."""
    if length is None:
        return surface.partition.frame.scale / 2
    number = rational(length, "length")
    if number < 0:
        raise ValueError(f"length must not be negative, not {length!r}")
    return number


def _names(names: Sequence[str] | None, size: int) -> tuple[str, ...]:
    if names is None:
        return tuple(f"neighbour {i + 1}" for i in range(size))
    if isinstance(names, str) or len(names) != size or len({*names, "blend"}) != size + 1:
        raise ValueError(
            f"names must be {size} different names for the neighbours, none of them 'blend'; they are {names!r}"
        )
    return tuple(map(str, names))
