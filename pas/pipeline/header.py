"""A header: a straight run with several feet on it, as one solid, full or with a bore through run and branches.

Within the cone of its opening each foot takes the place of the run's own cylinder, which it touches all around, and
below which it may dip; these contacts and those with the branches are joints of the solid.  That openings are apart is
told by points along them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Unpack

import numpy as np
from flint import fmpq

from pas.algebra.affine import height
from pas.algebra.inputs import shown
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, dot, plain, rational, to_float, to_floats
from pas.algebra.scaling import scaled
from pas.contacts.contact import Contact
from pas.contacts.endless import Pipe
from pas.contacts.joins import Join
from pas.errors import GeometryError
from pas.limits import WorkLimits, limited
from pas.piecewise import PiecewiseSurface
from pas.pipeline.around_opening import AroundOpening
from pas.pipeline.bodies import FURTHER, INSIDE, body, length_of
from pas.pipeline.hollow import HollowBlend
from pas.pipeline.neighbours import NOTHING
from pas.pipeline.result import Blend
from pas.solid.assembly import union
from pas.solid.solid import Solid, patch
from pas.solid.tree import Atom, combined


@dataclass(frozen=True, eq=False)
class OpenedRun:
    """The opening of a foot: `join` is that with the run, contact number `place` of the `surface`."""

    surface: PiecewiseSurface
    place: int

    @classmethod
    def of(cls, surface: PiecewiseSurface, run: Polynomial, number: int) -> OpenedRun:
        """That in a run with such a polynomial; raises `GeometryError` where foot `number` has none."""
        joins = zip(surface.joins, surface.contacts, strict=True)
        found = [i for i, (join, contact) in enumerate(joins) if join.opening and scaled(contact.surface) == run]
        if len(found) != 1 or len(surface.contacts) != 2:
            raise GeometryError(f"foot {number} is no blend of one opening in this run and one branch: see pas.foot")
        return cls(surface, found[0])

    @property
    def join(self) -> Join:
        """With the run, in local coordinates."""
        return self.surface.joins[self.place]

    @property
    def contact(self) -> Contact:
        """With the run: its polynomial and the cone."""
        return self.surface.contacts[self.place]

    @property
    def points(self) -> Floats:
        """Points (N, 3) spread along the opening."""
        return self.surface.partition.frame.global_points(self.join.curve())

    def room(self, reach: fmpq) -> Solid:
        """What the foot takes the place of in the run, though it may lie deeper: the cone above the foot's back."""
        back = AroundOpening.of(self.surface, self.place).back(reach)
        return Solid(combined(False, Atom(self.contact.clip, ""), Atom(back, "")))

    def holds(self, points: Floats) -> bool:
        """Whether any of the points (N, 3) is in the cone, on the opening's side of its apex."""
        local = self.surface.partition.frame.local_points(points)
        return bool(((self.join.contact.clip(local) <= 0) & (local @ self.join.nappe[0] > 0)).any())


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
    full = _united(run.clipped(1).contact.surface, outer, run, (low, high), lengths)
    if not inner:
        return full
    bore = inner[0][0]
    inside = next(c.surface for c, join in zip(bore.contacts, bore.joins, strict=True) if join.opening)
    further = (high - low) / FURTHER
    return full - _united(inside, inner[0], run, (low - further, high + further), lengths, f"{INSIDE} ")


def _united(
    surface: Polynomial,
    feet: Sequence[PiecewiseSurface],
    run: Pipe,
    ends: tuple[fmpq, fmpq],
    lengths: Sequence[fmpq],
    inside: str = "",
) -> Solid:
    """The run inside a surface with feet on it; of a bore, whose names begin with `inside`, a little longer."""
    openings = [OpenedRun.of(foot, surface, number) for number, foot in enumerate(feet, start=1)]
    _check_apart(openings, run, ends)
    along = height(run.point, run.axis) * (1 / dot(run.axis, run.axis))
    start, end = (Polynomial.from_raw(plane) for plane in (ends[0] - along, along - ends[1]))
    tube = patch(f"{inside}run", surface).cap(start, f"{inside}run start").cap(end, f"{inside}run end")
    solids = []
    for number, (opened, reach) in enumerate(zip(openings, lengths, strict=True), start=1):
        names = [f"{inside}branch {number}"] * 2
        names[opened.place] = f"{inside}run"
        tube -= opened.room(reach)
        beyond = opened.surface.partition.frame.scale / FURTHER if inside else NOTHING
        solids.append(body(opened.surface, reach, names, f"{inside}foot {number}", around="run", beyond=beyond))
    whole = union([tube, *solids])
    for number, opened in enumerate(openings, start=1):
        contact = opened.contact
        along_curve = contact.surface, contact.clip
        whole = whole.joined(f"{inside}foot {number}", f"{inside}run", along_curve, opened.surface.order)
    return whole


def _check_apart(openings: Sequence[OpenedRun], run: Pipe, ends: tuple[fmpq, fmpq]) -> None:
    """That no opening reaches beyond an end of the run or into another one."""
    axis, point = np.array(to_floats(run.axis)), np.array(to_floats(run.point))
    for number, opened in enumerate(openings, start=1):
        places = (opened.points - point) @ axis / (axis @ axis)
        if not to_float(ends[0]) < places.min() <= places.max() < to_float(ends[1]):
            raise GeometryError(
                f"the opening of foot {number} goes from {places.min():.4g} to {places.max():.4g} along the run, which "
                f"ends at {plain(ends[0])} and {plain(ends[1])}"
            )
    for (i, a), (j, b) in combinations(enumerate(openings, start=1), 2):
        if a.holds(b.points) or b.holds(a.points):
            raise GeometryError(
                f"the openings of feet {i} and {j} meet; move the branches apart along the run or around it, or give "
                "them less slope or radius, or join them by pas.node"
            )
