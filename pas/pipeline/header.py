"""A header: a straight run with several feet on it, as one solid, full or with a bore through run and branches.

Within the cone of its opening each foot takes the place of the run's own cylinder, which it touches all around, and
below which it may dip; these contacts and those with the branches are joints of the solid.  That openings are apart is
told by points along them.

It is meshed at once, from the meshes of the feet (see `pas.solid.runs`), where the walls of hollow ones are proved and
their branches do not meet beyond the openings; else from a lattice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Unpack

import numpy as np
from flint import fmpq

from pas.algebra.affine import height
from pas.algebra.inputs import shown
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, dot, exact, plain, rational, to_float, to_floats
from pas.algebra.scaling import scaled
from pas.contacts.contact import Contact
from pas.contacts.endless import Pipe
from pas.errors import GeometryError
from pas.limits import WorkLimits, limited
from pas.piecewise import PiecewiseSurface
from pas.pipeline.around_opening import AroundOpening, AtOpening
from pas.pipeline.bodies import FURTHER, INSIDE, chain_beyond, clip_plane, length_of, with_neighbours
from pas.pipeline.hollow import HollowBlend
from pas.pipeline.neighbours import NOTHING
from pas.pipeline.result import Blend
from pas.solid.assembly import union
from pas.solid.runs import RunSide
from pas.solid.sheets import SheetBody, Side
from pas.solid.solid import Solid, patch
from pas.solid.strips import chain_between
from pas.solid.tree import Atom, combined


def opening_in(surface: PiecewiseSurface, run: Polynomial, number: int) -> AroundOpening:
    """The opening of a foot in a run with such a polynomial; raises `GeometryError` where foot `number` has none."""
    joins = zip(surface.joins, surface.contacts, strict=True)
    found = [i for i, (join, contact) in enumerate(joins) if join.opening and scaled(contact.surface) == run]
    if len(found) != 1 or len(surface.contacts) != 2:
        raise GeometryError(f"foot {number} is no blend of one opening in this run and one branch: see pas.foot")
    return AroundOpening(surface, found[0])


@limited("uniting a run with its feet", "fewer feet")
def header(
    run: Pipe,
    feet: Sequence[Blend | HollowBlend[Blend]],
    ends: tuple[Exact, Exact],
    length: Exact | None = None,
    **limits: Unpack[WorkLimits],
) -> Solid:
    """The solid of a straight run and feet on it: all full, or all hollow, which makes a bore.

        run = pas.Pipe((1, 0, 0), 1, "auto")
        branches = [pas.Pipe((0, 0, 1), "1/2", "auto"), pas.Pipe((0, 1, 0), "1/2", "auto", (4, 0, 0))]
        feet = [pas.foot(run, branch) for branch in branches]
        pas.header(run, feet, ends=(-3, 7))
        pas.header(run, [foot.hollow("1/8") for foot in feet], ends=(-3, 7))

    The run goes from `point + ends[0] * axis` to `point + ends[1] * axis`, its clip plays no part; `length` is how far
    the branches go on beyond their clips, in the model's units (by default half of the size of each foot's region).
    The faces are "run", "run start", "run end", and "foot 1", "branch 1", "branch 1 end" and so on; those of the bore
    are "inside of run" and so on.  All contacts are joints, which the solid proves.

    Raises `GeometryError` for a foot that is not on this run, openings that are not apart and one that reaches beyond
    an end, `ValueError` and `TypeError` for wrong arguments.
    """
    if not isinstance(run, Pipe) or not len(feet) or not all(hasattr(foot, "sides") for foot in feet):
        raise TypeError(f"a header is made of a pas.Pipe and feet on it, not of {shown(run)} and {shown(feet)}")
    if len({len(foot.sides) for foot in feet}) > 1:
        raise ValueError("the feet of a header must be all full or all hollow")
    low, high = (rational(end, f"ends[{i}]") for i, end in enumerate(ends))
    if low >= high:
        raise ValueError(f"ends must be a smaller and a larger number, not {shown(ends)}")
    outer, *inner = zip(*(foot.sides for foot in feet), strict=True)
    lengths = [length_of(length, foot) for foot in outer]
    full = HeaderSide(run.clipped(1).contact.surface, outer, run, (low, high), lengths)
    if not inner:
        return replace(full.solid, sheets=_body(full.sheet))
    bore = inner[0][0]
    inside = next(c.surface for c, join in zip(bore.contacts, bore.joins, strict=True) if join.opening)
    cavity = HeaderSide(inside, inner[0], run, (low, high), lengths, f"{INSIDE} ")
    proved = all(foot.certificate.proved for foot in feet)
    return replace(full.solid - cavity.solid, sheets=_body(full.sheet, cavity.sheet) if proved else None)


def _body(*sides: RunSide | None) -> SheetBody | None:
    """What bounds a header of one side, or of two of which the second is inside the first."""
    known = [side for side in sides if side is not None]
    pairs = zip(known[0].chains, known[1].chains, strict=True) if len(known) == 2 else ()
    return SheetBody(tuple(known)) if len(known) == len(sides) and all(a.holds(b) for a, b in pairs) else None


@dataclass(frozen=True, eq=False)
class HeaderSide:
    """The run inside a `surface` with feet on it between two `ends`: a full header, or a bore, whose faces have names
    that begin with `inside`.

    Raises `GeometryError` where an opening reaches beyond an end of the run or into another.
    """

    surface: Polynomial
    feet: Sequence[PiecewiseSurface]
    run: Pipe
    ends: tuple[fmpq, fmpq]
    lengths: Sequence[fmpq]
    inside: str = ""

    def __post_init__(self) -> None:
        start, end = self.ends
        for number, (low, high) in enumerate(self._extents, start=1):
            if not to_float(start) < low <= high < to_float(end):
                raise GeometryError(
                    f"the opening of foot {number} goes from {low:.4g} to {high:.4g} along the run, which ends at "
                    f"{plain(start)} and {plain(end)}"
                )
        for (i, a), (j, b) in combinations(enumerate(self.openings, start=1), 2):
            if a.faces(b.curve) or b.faces(a.curve):
                raise GeometryError(
                    f"the openings of feet {i} and {j} meet; move the branches apart along the run or around it, or "
                    "give them less slope or radius, or join them by pas.node"
                )

    @cached_property
    def openings(self) -> list[AroundOpening]:
        """That of each foot."""
        return [opening_in(foot, self.surface, number) for number, foot in enumerate(self.feet, start=1)]

    @property
    def _extents(self) -> list[tuple[float, float]]:
        """Where each opening begins and ends along the run."""
        axis, point = np.array(to_floats(self.run.axis)), np.array(to_floats(self.run.point))
        places = [(opening.curve - point) @ axis / (axis @ axis) for opening in self.openings]
        return [(float(some.min()), float(some.max())) for some in places]

    def _planes(self, low: fmpq, high: fmpq) -> tuple[Polynomial, Polynomial]:
        """Those across the run at two places, positive beyond them."""
        along = height(self.run.point, self.run.axis) * (1 / dot(self.run.axis, self.run.axis))
        return Polynomial.from_raw(low - along), Polynomial.from_raw(along - high)

    @property
    def solid(self) -> Solid:
        """All of it; a bore goes on a little beyond the ends."""
        name, further = f"{self.inside}run", (self.ends[1] - self.ends[0]) / FURTHER if self.inside else NOTHING
        start, end = self._planes(self.ends[0] - further, self.ends[1] + further)
        tube = patch(name, self.surface).cap(start, f"{name} start").cap(end, f"{name} end")
        solids = []
        for number, (opening, reach) in enumerate(zip(self.openings, self.lengths, strict=True), start=1):
            # The foot takes the place of the run in the cone above its back, though it may lie deeper.
            clip, back = opening.surface.contacts[opening.number].clip, opening.at(opening.level(reach))
            tube -= Solid(combined(False, Atom(clip, ""), Atom(back, "")))
            names, reaches = [f"{self.inside}branch {number}"] * 2, list[fmpq | None]([reach, reach])
            names[opening.number], reaches[opening.number] = name, None
            beyond = opening.frame.scale / FURTHER if self.inside else NOTHING
            ends: AtOpening = [(back, ""), (clip, "")], None
            face = f"{self.inside}foot {number}"
            solids.append(with_neighbours(opening.surface, reaches, names, face, ends, beyond))
        whole = union([tube, *solids])
        for number, opening in enumerate(self.openings, start=1):
            met = opening.surface.contacts[opening.number]
            along = met.surface, met.clip
            whole = whole.joined(f"{self.inside}foot {number}", name, along, opening.surface.order)
        return whole

    @property
    def sheet(self) -> RunSide | None:
        """What bounds it up to the ends, where that is known; its strips begin half way between these and the feet."""
        lows, highs = zip(*self._extents, strict=True)
        begins = (self.ends[0] + exact(min(lows))) / 2, (self.ends[1] + exact(max(highs))) / 2
        tubes = [
            chain_between(Contact(self.surface, plane), plane, cap, (f"{self.inside}run", f"{self.inside}run {end}"))
            for plane, cap, end in zip(self._planes(*begins), self._planes(*self.ends), ("start", "end"), strict=True)
        ]
        feet, (start, end) = list[Side](), tubes
        for number, (opening, reach) in enumerate(zip(self.openings, self.lengths, strict=True), start=1):
            surface, other, face = opening.surface, 1 - opening.number, f"{self.inside}foot {number}"
            branch = chain_beyond(surface, other, f"{self.inside}branch {number}", clip_plane(surface, other), reach)
            chains = [branch, opening.walled(face)][:: 1 if other == 0 else -1]
            known = tuple(chain for chain in chains if chain is not None and chain.sound)
            feet += [Side(surface, face, known)] if len(known) == 2 else []
        if start is None or end is None or len(feet) < len(self.feet):
            return None
        return RunSide(f"{self.inside}run", (start, end), tuple(feet), tuple(o.number for o in self.openings))
