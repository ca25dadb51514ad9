"""A header: a straight run with several feet on it, as one solid, full or with a bore through run and branches.

Within the cone of its opening each foot takes the place of the run's own cylinder, which it touches all around, and
below which it may dip; these contacts and those with the branches are joints of the solid.  That openings are apart is
told by points along them.

It is meshed at once, from the meshes of the feet (see `pas.solid.runs`), where the walls of hollow ones are proved and
their branches do not meet beyond the openings; else from a lattice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
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
    full, sheet = header_side(run.clipped(1).contact.surface, outer, run, (low, high), lengths)
    if not inner:
        return replace(full, sheets=_body(sheet))
    bore = inner[0][0]
    inside = next(c.surface for c, join in zip(bore.contacts, bore.joins, strict=True) if join.opening)
    cavity, within = header_side(inside, inner[0], run, (low, high), lengths, f"{INSIDE} ")
    proved = all(foot.certificate.proved for foot in feet)
    return replace(full - cavity, sheets=_body(sheet, within) if proved else None)


def _body(*sides: RunSide | None) -> SheetBody | None:
    """The boundary of a header with one side, or with two of which the second is inside the first."""
    known = [side for side in sides if side is not None]
    pairs = zip(known[0].chains, known[1].chains, strict=True) if len(known) == 2 else ()
    return SheetBody(tuple(known)) if len(known) == len(sides) and all(a.holds(b) for a, b in pairs) else None


def header_side(
    surface: Polynomial,
    feet: Sequence[PiecewiseSurface],
    run: Pipe,
    ends: tuple[fmpq, fmpq],
    lengths: Sequence[fmpq],
    inside: str = "",
) -> tuple[Solid, RunSide | None]:
    """The run inside a surface with feet on it between two ends, and its boundary in sheets where that is known.

    It is a full header, or a bore, which reaches a little beyond the ends and whose faces have names that begin with
    `inside`.  Raises `GeometryError` where an opening reaches beyond an end of the run or into another.
    """
    openings = [opening_in(foot, surface, number) for number, foot in enumerate(feet, start=1)]
    axis, point = np.array(to_floats(run.axis)), np.array(to_floats(run.point))
    places = [(opening.curve - point) @ axis / (axis @ axis) for opening in openings]
    for number, place in enumerate(places, start=1):
        if not to_float(ends[0]) < place.min() <= place.max() < to_float(ends[1]):
            raise GeometryError(
                f"the opening of foot {number} goes from {place.min():.4g} to {place.max():.4g} along the run, which "
                f"ends at {plain(ends[0])} and {plain(ends[1])}"
            )
    for (i, a), (j, b) in combinations(enumerate(openings, start=1), 2):
        if a.faces(b.curve) or b.faces(a.curve):
            raise GeometryError(
                f"the openings of feet {i} and {j} meet; move the branches apart along the run or around it, or "
                "give them less slope or radius, or join them by pas.node"
            )
    along = height(run.point, run.axis) * (1 / dot(run.axis, run.axis))

    def planes(low: fmpq, high: fmpq) -> tuple[Polynomial, Polynomial]:
        """The planes across the run at two places, positive beyond them."""
        return Polynomial.from_raw(low - along), Polynomial.from_raw(along - high)

    name, further = f"{inside}run", (ends[1] - ends[0]) / FURTHER if inside else NOTHING
    first, last = planes(ends[0] - further, ends[1] + further)
    tube = patch(name, surface).cap(first, f"{name} start").cap(last, f"{name} end")
    solids, sides = list[Solid](), list[Side]()
    for number, (opening, reach) in enumerate(zip(openings, lengths, strict=True), start=1):
        foot, other = opening.surface, 1 - opening.number
        face, branch = f"{inside}foot {number}", f"{inside}branch {number}"
        # The foot takes the place of the run in the cone above its back, though it may lie deeper.
        clip, back = foot.contacts[opening.number].clip, opening.at(opening.level(reach))
        tube -= Solid(combined(False, Atom(clip, ""), Atom(back, "")))
        names, reaches = [branch, branch], list[fmpq | None]([reach, reach])
        names[opening.number], reaches[opening.number] = name, None
        bounds: AtOpening = [(back, ""), (clip, "")], None
        beyond = opening.frame.scale / FURTHER if inside else NOTHING
        solids.append(with_neighbours(foot, reaches, names, face, bounds, beyond))
        chains = [chain_beyond(foot, other, branch, clip_plane(foot, other), reach)]
        chains.insert(opening.number, opening.walled(face))
        known = tuple(chain for chain in chains if chain is not None and chain.sound)
        sides += [Side(foot, face, known)] if len(known) == 2 else []
    whole = union([tube, *solids])
    for number, opening in enumerate(openings, start=1):
        met = opening.surface.contacts[opening.number]
        whole = whole.joined(f"{inside}foot {number}", name, (met.surface, met.clip), opening.surface.order)
    # Strips of the run begin half way between its ends and the feet.
    low, high = min(float(p.min()) for p in places), max(float(p.max()) for p in places)
    begins = planes((ends[0] + exact(low)) / 2, (ends[1] + exact(high)) / 2)
    start, end = (
        chain_between(Contact(surface, plane), plane, cap, (name, f"{name} {title}"))
        for plane, cap, title in zip(begins, planes(*ends), ("start", "end"), strict=True)
    )
    if start is None or end is None or len(sides) < len(feet):
        return whole, None
    return whole, RunSide(name, (start, end), tuple(sides), tuple(opening.number for opening in openings))
