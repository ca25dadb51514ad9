"""Blends as solids: the inside of the surface with pieces of its neighbours, capped.

The surface's pieces are one face, bounded by the cells of the partition; each neighbour goes on from its
clip and ends in a flat cap.  The claims of contact become joints, which the solid proves anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from flint import fmpq

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, dot, exact, rational, three, to_float
from pas.algebra.scaling import Scaled, scaled
from pas.contacts.contact import Contact
from pas.contacts.ends import ContactEnd
from pas.errors import GeometryError
from pas.piecewise import PiecewiseSurface
from pas.pipeline.around_opening import AroundOpening, AtOpening
from pas.pipeline.neighbours import NOTHING, separators
from pas.solid.assembly import union
from pas.solid.functions import Pieces, region
from pas.solid.sheets import SheetBody, Side
from pas.solid.solid import Solid, patch
from pas.solid.strips import Chain, chain_between
from pas.solid.tree import Atom, combined

Length: TypeAlias = "Exact | Sequence[Exact] | None"
"""The length of the neighbours: of all of them, or of each; None is half of the region's scale."""


def body(
    surface: PiecewiseSurface, length: Length = None, names: Sequence[str] | None = None, face: str = "blend"
) -> Solid:
    """The solid inside a surface, whose name is `face`, and its neighbours; see `Blend.solid`."""
    titles, reaches = _names(names, len(surface.contacts)), lengths_of(length, surface)
    opening, at_opening = AroundOpening.of(surface), None
    if opening is not None:
        reach = reaches[opening.number]
        works, level = opening.fitting(reach, length is None), opening.level(reach)
        at_opening = opening.ended(titles[opening.number], level, works)
    solid = with_neighbours(surface, reaches, titles, face, at_opening)
    chains = [
        chain_beyond(surface, number, name, clip_plane(surface, number), reach)
        if opening is None or number != opening.number
        else opening.chain(name, level, works)
        for number, (name, reach) in enumerate(zip(titles, reaches, strict=True))
    ]
    side = _side(surface, face, chains)
    return replace(solid, sheets=None if side is None else SheetBody.of([side]))


def with_neighbours(
    surface: PiecewiseSurface,
    reaches: Sequence[fmpq | None],
    names: Sequence[str],
    face: str,
    at_opening: AtOpening | None = None,
    beyond: fmpq = NOTHING,
) -> Solid:
    """The solid inside a surface, and its neighbours up to flat ends, `beyond` more than their `reaches` away.

    At an opening both are those of `at_opening`.  A contact with a reach of 0 is capped; one with None is left open,
    for what the solid is united with.  Raises `GeometryError` for a surface that bounds no solid.
    """
    if not surface.partition.cells:
        raise GeometryError("the blend has no region, so it bounds no solid: give its cell one, as in SingleCell(box)")
    if surface.partition.sides and not any(join.opening for join in surface.joins):
        raise GeometryError("the region of the blend is open and no contact closes it, so that it bounds no solid")
    pieces, (bounds, piece) = Atom(Pieces(surface.partition, surface.polynomials), face), at_opening or ((), None)
    inner = Solid(combined(False, pieces, region(surface.partition)))
    for bound, title in bounds:
        inner = inner.cap(bound, title)
    solids, clips = [inner], list[Polynomial]()
    for number, (name, contact, reach) in enumerate(zip(names, surface.contacts, reaches, strict=True)):
        is_opening = surface.joins[number].opening
        clips.append(contact.clip if is_opening else clip_plane(surface, number))
        if is_opening:
            solids += [] if piece is None else [piece]
        elif reach is not None and reach + beyond > 0:
            cap = _cap(clips[-1], reach + beyond)
            apart = separators(surface, number, name, reach, beyond)
            solids.append(patch(name, contact.surface, clips[-1], -cap, *apart).cap(cap, f"{name} end"))
    solid = union(solids)
    for name, contact, clip, reach in zip(names, surface.contacts, clips, reaches, strict=True):
        if name in solid.faces:
            solid = solid.joined(face, name, (contact.surface, clip), surface.order)
        elif reach == 0:
            solid = solid.cap(clip, f"{name} end")
    return solid


def chain_beyond(surface: PiecewiseSurface, number: int, name: str, plane: Polynomial, length: fmpq) -> Chain | None:
    """The continuation of a contact by a length beyond a plane, up to a flat end; None where `Sections` has none."""
    center = surface.partition.center
    return chain_between(surface.placed.located(number), plane, _cap(plane, length), (name, f"{name} end"), center)


def hollow_body(
    outer: PiecewiseSurface, inner: PiecewiseSurface, length: Length = None, names: Sequence[str] | None = None
) -> Solid:
    """The solid between two surfaces and their neighbours; see `HollowBlend.solid`.

    The cavity extends beyond the caps of the outer solid, so that no two ends are coplanar: around an opening it has no
    end, and its back is lower.  Where the outer solid ends in the opening the inner surface extends beyond it.
    """
    reaches, titles = lengths_of(length, outer), _names(names, len(outer.contacts))
    inside = [f"{INSIDE} {t}" for t in titles]
    ended = {name for name, reach in zip(inside, reaches, strict=True) if reach == 0}
    opened, beyond = WallOpening.of(outer, inner, reaches, length is None), outer.partition.frame.scale / FURTHER
    at_inner = at_outer = None
    if opened is not None:
        number = opened.around.number
        at_inner = opened.cavity(inside[number])
        ended |= set() if opened.goes_on else {inside[number]}
    cavity = with_neighbours(inner, reaches, inside, f"{INSIDE} blend", at_inner, beyond)
    if opened is not None:
        reaches[number] = opened.works
        at_outer = opened.around.ended(titles[number], opened.floor, opened.works)
    joints = tuple(joint for joint in cavity.joints if joint.second not in ended)
    solid = with_neighbours(outer, reaches, titles, "blend", at_outer) - replace(cavity, joints=joints)
    sides = wall_sides(outer, inner, titles, reaches)
    return replace(solid, sheets=None if sides is None else SheetBody.of(sides))


@dataclass(frozen=True, eq=False)
class WallOpening:
    """A wall at an opening: `around` its outer side and `within` its inner one, up to an `edge` around a ring of width
    `works` in the outer neighbour; for a width of 0 the edge is the opening's cone."""

    around: AroundOpening
    within: AroundOpening
    works: fmpq
    edge: Polynomial

    @classmethod
    def of(
        cls, outer: PiecewiseSurface, inner: PiecewiseSurface, reaches: Sequence[fmpq], shorter: bool
    ) -> WallOpening | None:
        """The opening of a wall, None for a closed one; raises what `AroundOpening.fitting` raises.

        If it may be `shorter`, a ring in a curved surface is halved until its edge is clear of the inner side's curve.
        """
        around, within = AroundOpening.of(outer), AroundOpening.of(inner)
        if around is None or within is None:
            return None
        works = around.fitting(reaches[around.number], shorter)
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
        """Whether the inner side's curve is inside the edge, so that the inner contact continues from there."""
        return self.works > 0 and self.within.inside(self.edge)

    @cached_property
    def ends(self) -> bool:
        """Whether the inner surface itself reaches the edge."""
        return self.works == 0 or (not self.around.flat and self.within.holds(self.edge))

    def cavity(self, name: str) -> AtOpening:
        """The cavity at the opening: the inner surface's end, or all of its neighbour, with a back below the wall's."""
        level = self.within.low / 4
        if self.ends:
            return [(self.within.at(level), f"{name} back")], None
        return self.within.ended(name, level, self.works, endless=True)

    @cached_property
    def inner(self) -> PiecewiseSurface:
        """The inner surface up to where it ends: where that is the edge, with itself as the contact clipped there."""
        surface, number = self.within.surface, self.within.number
        if not self.ends or surface.contacts[number].clip.primitive() == self.edge.primitive():
            return surface
        contacts = [*surface.contacts]
        contacts[number] = Contact(surface.polynomials[0], self.edge)
        return PiecewiseSurface(surface.partition, contacts, surface.order, surface.patches, surface.degree)

    def chains(self, names: tuple[str, str]) -> list[Chain | None]:
        """The continuations of both sides; None where the inner contact has none, or is not seen to reach the edge."""
        around, within = self.around, AroundOpening(self.inner, self.within.number)
        seen = self.ends or (self.goes_on and (within.flat or within.leave(around.wide(self.works))))
        if around.center != within.center or not seen:
            return [None, None]
        edge, floor = (self.edge if self.works > 0 else None), scaled(around.at(self.floor))
        return [around.walled(names[0], edge), within.walled(names[1], None if self.ends else edge, floor)]


def wall_sides(
    outer: PiecewiseSurface, inner: PiecewiseSurface, names: Sequence[str], reaches: Sequence[fmpq]
) -> list[Side] | None:
    """The sides of a wall with their continuations, the inner ones up to the planes, edges and cones in which the outer
    ones end; None where a continuation is not known."""
    opened = WallOpening.of(outer, inner, reaches, False)
    surfaces, pairs = (outer, inner if opened is None else opened.inner), list[list[Chain | None]]()
    for number, (name, reach) in enumerate(zip(names, reaches, strict=True)):
        titles = name, f"{INSIDE} {name}"
        if opened is not None and number == opened.around.number:
            pairs.append(opened.chains(titles))
            continue
        plane, sides = clip_plane(outer, number), zip(surfaces, titles, strict=True)
        pairs.append([chain_beyond(surface, number, title, plane, reach) for surface, title in sides])
    faces = "blend", f"{INSIDE} blend"
    made = [_side(*side) for side in zip(surfaces, faces, zip(*pairs, strict=True), strict=True)]
    known = [side for side in made if side is not None]
    return known if len(known) == len(made) else None


def _side(surface: PiecewiseSurface, face: str, chains: Sequence[Chain | None]) -> Side | None:
    """A surface with its continuations; None where one of them is not known."""
    known = tuple(chain for chain in chains if chain is not None)
    return Side(surface, face, known) if len(known) == len(chains) else None


def contact_ends(surface: PiecewiseSurface, length: Length = 0) -> tuple[ContactEnd, ...]:
    """Where a surface and its neighbours of a `length` end, at each contact; see `Blend.ends`."""
    reaches = lengths_of(length, surface)
    return tuple(
        AroundOpening(surface, number).end if join.opening else _end(surface, number, reach)
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


FURTHER = 64
"""Parts of the region's scale, by one of which a cavity goes on beyond the caps: there it takes nothing away, and must
be proved to be one piece as well."""

INSIDE = "inside of"
"""How faces of a cavity are named after those of the outside, as a shell's are."""


def clip_plane(surface: PiecewiseSurface, number: int) -> Polynomial:
    """The face of the region, as a plane, in which a neighbour begins; positive on the neighbour's side."""
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
