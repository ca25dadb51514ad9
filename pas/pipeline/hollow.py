"""Hollow nodes: an outer and an inner blend, the inner one proved inside the outer one.

Both are blends of the same order with the same clips, mostly around one centre; between their contacts is a thickness.
At an opening the inner clip is a wider cone from the same point, with its curve below the outer one along normals: on
one cone the inner side would begin to rise earlier than the outer one, and the wall be up to twice as thick there.
That the one is inside the other is proved of their polynomials (see `pas.certify.nesting`); how thick the wall is
between the ends is measured, and proved to be more than a bound (see `pas.certify.thickness`).

`Solid.shell` makes walls of any solid, of one thickness everywhere, with inner faces that are no polynomials.  A hollow
blend takes a second or two, both its sides are fair algebraic surfaces with GC^k at all contacts, and its wall is as
thick as wished at its ends and about so between them: among the inner surfaces one is chosen that is fair and a
thickness away (see `pas.pipeline.cavity`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Generic, TypeAlias, Unpack

import numpy as np
from flint import fmpq

from pas.algebra.inputs import shown_point
from pas.algebra.rational import Exact, check_tolerance, plain, positive, three, to_float
from pas.certify.nesting import nesting
from pas.certify.thickness import thicker_than
from pas.contacts.cones import apex
from pas.contacts.contact import Contact, ContactLike, as_contact
from pas.contacts.ends import ContactEnd
from pas.contacts.parallels import inner_contact
from pas.errors import GeometryError, InfeasibleError, MeshError, NoSolutionError, NotProvedError
from pas.limits import WorkLimits, limited
from pas.mesh.quality import Quality
from pas.piecewise import PiecewiseSurface
from pas.pipeline.around_opening import AroundOpening
from pas.pipeline.bodies import INSIDE, Length, contact_ends, hollow_body, lengths_of, wall_sides
from pas.pipeline.cavity import EVEN, Cavity
from pas.pipeline.chosen import B, ChosenBlend, Stages
from pas.pipeline.search import excess, find
from pas.pipeline.wall_mesh import WallMesh
from pas.settings import RELATIVE_TOLERANCE
from pas.shape import Shape
from pas.solid.sheets import SheetBody
from pas.solid.solid import Solid
from pas.surface.depth import Depth
from pas.verdicts import Findings, Status, Verdict

Rank: TypeAlias = "tuple[bool, float, float]"
"""What is proved comes before what is not, then an even wall before an uneven one, then the fairer surface."""


@dataclass(frozen=True, eq=False)
class Wall:
    """The least and the `largest` distance of vertices of the inner side's mesh from the outer side, as measured.

    `within` is how far the mesh is from its surface: between vertices distances may be off by as much.  `point` is the
    vertex that is nearest.  All in the model's units.
    """

    distance: float
    point: tuple[float, float, float]
    within: float
    largest: float

    def __str__(self) -> str:
        where = shown_point(self.point)
        return f"{self.distance:.4g} at {where}, at most {self.largest:.4g} (measured, within {self.within:.2g})"


@dataclass(frozen=True, eq=False, repr=False)
class HollowBlend(Shape, Generic[B]):
    """A blend with a cavity: what is between an `outer` and an `inner` blend of the same contacts' two sides.

    `thickness` is that of the wall at the contacts, in the model's units; None where the inner contacts were given.
    Made by `Blend.hollow`.
    """

    outer: B
    inner: B
    thickness: fmpq | None = None
    kind = "hollow blend"

    @property
    def sides(self) -> tuple[PiecewiseSurface, ...]:
        """The outer and the inner surface."""
        return self.outer.surface, self.inner.surface

    @cached_property
    def certificate(self) -> Findings:
        """All verdicts: those on the outer and the inner blend, that the one is inside the other, and on each end."""
        both = Findings.of_parts({"outer": self.outer.certificate, "inner": self.inner.certificate})
        return Findings((*both.verdicts, *nesting(self.inner.surface, self.outer.surface)))

    @property
    def crossing(self) -> bool:
        """Whether an end is known to be no ring, which depends on the contacts alone."""
        ends = self.certificate.verdicts[-len(self.outer.surface.contacts) :]
        return any(end.status is Status.REFUTED for end in ends)

    @cached_property
    def wall(self) -> Wall:
        """How thick the wall is where it is thinnest, and where it is thickest, measured."""
        mesh = self.inner.mesh(self._tolerance)
        depths = Depth(self.outer.surface)(mesh.points)[0]
        thinnest = three(mesh.points[depths.argmin()].tolist())
        return Wall(float(depths.min()), thinnest, mesh.deviation or 0.0, float(depths.max()))

    @limited("bounding the thickness of a wall", "a smaller bound")
    def thicker_than(self, bound: Exact, **limits: Unpack[WorkLimits]) -> Verdict:
        """The verdict on all points of the inner surface being farther than `bound` from the outer one: proved, refuted
        at a point where it is nearer, or undecided.

        In the model's units, up to the clips of the contacts, where the wall is as thick as `thickness`: smaller bounds
        only can be proved.  Of a T a second for a bound of half the least distance, about three for nine tenths of it,
        and more for nearer ones.  Raises `ValueError` for a bound that is not positive.
        """
        return thicker_than(self.inner.surface, self.outer.surface, positive(bound, "bound"))

    @limited("simplifying a blend", "a larger denominator")
    def simplified(self, denominator: int = 1000, **limits: Unpack[WorkLimits]) -> HollowBlend[B]:
        """This wall with short coefficients on both sides, proved anew; see `Blend.simplified`.

        Raises what that raises, and `NotProvedError` where the wall itself is not proved (with the `HollowBlend`).
        """
        made = replace(self, outer=self.outer.simplified(denominator), inner=self.inner.simplified(denominator))
        if self.certificate.proved and not made.certificate.proved:
            failed = next(v for v in made.certificate.verdicts if not v.proved)
            raise NotProvedError(f"coefficients of the denominator {denominator} are too short: {failed}", made)
        return made

    def solid(self, length: Length = None, names: Sequence[str] | None = None) -> Solid:
        """The wall as a solid, open at its ends: see `Blend.solid` for the arguments.

        The inner sides of the faces "blend" and "neighbour 1" are "inside of blend" and "inside of neighbour 1"; the
        ends "neighbour 1 end" are rings.  Neighbours of length 0 are left out.  Where the wall is not proved it is
        meshed from a lattice.
        """
        wall = hollow_body(self.outer.surface, self.inner.surface, length, names)
        return wall if self.certificate.proved else replace(wall, sheets=None)

    def ends(self, length: Length = 0) -> tuple[ContactEnd, ...]:
        """For each contact where the wall ends, or where `solid(length)` does: see `Blend.ends`.

        `inner_radii` (and `inner_radius`, where it is round) are those of the cavity there.
        """
        reaches = lengths_of(length, self.outer.surface)
        outer, inner = (contact_ends(blend.surface, reaches) for blend in (self.outer, self.inner))
        return tuple(replace(end, inner_radii=bore.radii) for end, bore in zip(outer, inner, strict=True))

    @limited("meshing a surface", "a coarser tolerance")
    def mesh(
        self, tolerance: Exact | None = None, *, quality: Quality | str = Quality.BALANCED, **limits: Unpack[WorkLimits]
    ) -> WallMesh:
        """The closed mesh of the wall up to its ends: both surfaces within `tolerance`, and rings in the outer clips.

        These are planes, or the cones of openings.  Its faces are "blend", "inside of blend", "end 1", ...  Raises
        `MeshError` as `PiecewiseSurface.mesh` does, and where an end is no ring.
        """
        wanted = self._tolerance if tolerance is None else check_tolerance(tolerance)
        ends = [f"end {number}" for number in range(1, 1 + len(self.outer.surface.contacts))]
        sides = wall_sides(self.outer.surface, self.inner.surface, ends, [fmpq(0)] * len(ends))
        whole = None if sides is None else SheetBody(tuple(sides)).mesh(wanted, Quality.of(quality))
        if sides is None or whole is None:
            raise MeshError("the two sides of the wall do not end in one ring for each contact")
        names = "blend", f"{INSIDE} blend", *ends
        known = whole.points, whole.triangles, whole.faces, names, whole.normals, whole.parameters, whole.deviation
        return WallMesh(*known, sheets=tuple(side.surface for side in sides), ends=[c.end for c in sides[0].chains])

    @property
    def _tolerance(self) -> float:
        """The default tolerance of meshes, the same for both sides."""
        return RELATIVE_TOLERANCE * float(np.ptp(self.outer.surface.partition.points, axis=0).max())

    def __str__(self) -> str:
        thickness = "given inner contacts" if self.thickness is None else f"thickness {plain(self.thickness)}"
        parts = [f"hollow blend, {thickness} at the ends"]
        for name, part in (("outer", self.outer), ("inner", self.inner)):
            beyond = part.fairness.beyond(part.limits) if part.fairness is not None else ("not measured",)
            fair = f"not fair: {', '.join(beyond)}" if beyond else "fair"
            surface = part.surface
            parts.append(f"{name}: GC^{surface.order}, degree {surface.degree}, {surface.partition.title}, {fair}")
        parts.append(f"wall at its thinnest: {self.wall}")
        if self.thickness is not None:
            low, high = (size / to_float(self.thickness) for size in (self.wall.distance, self.wall.largest))
            even = "even" if EVEN[0] <= low and high <= EVEN[1] else "uneven"
            parts[-1] += f"; {even}, {low:.2f} to {high:.2f} of the thickness"
        parts.append(f"verdicts: {self.certificate.counts}")
        return "\n".join(parts)

    def __repr__(self) -> str:
        degrees = f"degrees {self.outer.surface.degree} and {self.inner.surface.degree}"
        word = "proved" if self.certificate.proved else "not proved"
        return f"<HollowBlend GC^{self.outer.surface.order}, {degrees}, {word}>"


def hollow(outer: B, thickness: Exact | None, inner: Sequence[ContactLike] | None, prove: bool) -> HollowBlend[B]:
    """The wall whose outer side is given; see `pas.Blend.hollow`."""
    if (thickness is None) == (inner is None):
        raise ValueError("thickness or inner must be given, and not both: how thick the wall is, or what it ends in")
    size = None if thickness is None else positive(thickness, "thickness")
    contacts = given_contacts(outer, inner or ()) if size is None else parallel_contacts(outer, size)
    best = _best(outer, Cavity(outer, contacts, size))
    if prove and not best.certificate.proved:
        failed = next(v for v in best.certificate.verdicts if not v.proved)
        advice = "inner contacts farther inside" if size is None else "a thinner wall"
        raise NotProvedError(f"the wall is not proved: {failed}; {advice} or clips farther out may help", best)
    return best


def check_sides(outer: ChosenBlend, inner: ChosenBlend, thickness: fmpq | None) -> None:
    """Raises `ValueError` or `GeometryError` unless two blends are the sides of a wall with this thickness at its ends.

    Their orders are one, and the inner contacts are those a thickness inside, or without one fit the outer ones.
    """
    if inner.surface.order != outer.surface.order:
        orders = f"GC^{outer.surface.order} and GC^{inner.surface.order}"
        raise ValueError(f"both sides of a wall must have one order of contact, not {orders}")
    found = given_contacts(outer, inner.surface.contacts)
    wanted = found if thickness is None else parallel_contacts(outer, positive(thickness, "thickness"))
    for number, (here, there) in enumerate(zip(found, wanted, strict=True), start=1):
        if thickness is not None and not _same(here, there):
            raise ValueError(
                f"the inner contact {number} is not the outer one {plain(thickness)} inside, which is the thickness; "
                "its surface must be that of `Blend.hollow`"
            )


def _same(one: Contact, other: Contact) -> bool:
    """Whether two contacts have one surface, to the rounding of irrational radii, and one clip or apex."""
    # By how much coefficients of an inner surface may be another machine's, over the largest: radii that are
    # irrational are rounded to 32 binary digits (see `pas.contacts.parallels`).
    rounding = 2.0**-29
    a, b = (c.surface.dense(max(one.surface.degree, other.surface.degree)) for c in (one, other))
    rounded = float(np.abs(a - b).max()) <= rounding * float(np.abs(a).max())
    tip = apex(one.clip)
    same = one.clip.primitive() == other.clip.primitive()
    return rounded and (same or (tip is not None and tip == apex(other.clip)))


def _best(outer: B, cavity: Cavity) -> HollowBlend[B]:
    """The first trial's hollow blend that is proved, even and fair, or the best of all; crossing ends come last.

    Raises `NotProvedError` where no trial has an inner surface.
    """
    best: HollowBlend[B] | None = None
    least: Rank | None = None
    failure: Exception | None = None
    for degree, partition in cavity.trials():
        if degree is None and least is not None and not least[0]:
            break
        try:
            found = find(type(outer), cavity.contacts, outer.surface.order, degree, partition, cavity.wishes, Stages())
        except (NoSolutionError, NotProvedError, InfeasibleError) as error:
            failure = error
            continue
        made = HollowBlend(outer, cavity.plain(found), cavity.thickness)
        rank = not made.certificate.proved, cavity.unevenness(found.surface), excess(made.inner)
        if least is None or rank < least:
            best, least = made, rank
        # Beside outer sides that are not fair, as some of cones and spheres are, no inner one was found that is.
        if (rank[:2] == (False, 1.0) and (not rank[2] or excess(outer) > 0)) or made.crossing:
            break
    if best is None:
        raise NotProvedError(f"no inner surface was found: {failure}; a thinner wall may have one", None) from failure
    return best


def parallel_contacts(outer: ChosenBlend, thickness: fmpq) -> list[Contact]:
    """The contacts a thickness inside; at an opening of a blend that is one piece along the cone of an even wall."""
    surface, opening = outer.surface, AroundOpening.of(outer.surface)
    found = [inner_contact(surface.placed.located(n), thickness, n + 1) for n in range(len(surface.contacts))]
    if opening is not None and len(surface.patches) == 1 and (clip := opening.even(thickness)):
        found[opening.number] = Contact(found[opening.number].surface, clip, found[opening.number].near)
    return found


def given_contacts(outer: ChosenBlend, given: Sequence[ContactLike]) -> list[Contact]:
    """Inner contacts that fit the outer ones, as far as that is seen before they are placed."""
    surface, found = outer.surface, [as_contact(item, f"inner[{i}]") for i, item in enumerate(given)]
    if len(found) != len(surface.contacts):
        wanted = len(surface.contacts)
        raise ValueError(f"inner must be {wanted} contacts, one for each of the outer ones, not {len(found)}")
    for i, (inner, contact, join) in enumerate(zip(found, surface.contacts, surface.joins, strict=True)):
        same = inner.clip.primitive() == contact.clip.primitive()
        wider = len(surface.patches) == 1 and apex(inner.clip.primitive()) == surface.partition.center
        if join.opening and not (same or wider):
            raise GeometryError(
                f"inner[{i}] must have the clip of contact {i + 1}, {contact.clip}, or, of a blend that is one piece, "
                "a cone around it from the same point: both sides of a wall open from there"
            )
    return found
