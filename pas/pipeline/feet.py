"""Branches on straight runs: a foot that rises out of the run's own cylinder, or a node with the run's two halves.

A foot is the blend of an opening in the run, along a cone from where the axes meet, and the branch.  The run's cylinder
stays exact, and with GC^1 the fillet is wider than a node's where the branch is thin and stands up: measured for 75 and
90 degrees and radii of .3 to .85 of the run's (see `Tee.drawback`).  With R the run's radius and r the branch's:

    half angle of the cone  (b + 85)/2 degrees, b = asin(r/R): half way from the branch to where rays graze the run
    axis of the cone        halfway between the branch and the normal of the run
    end of the branch       where all of it is R + clamp(R slope - r, .4 R, 1.2 R) or more above the axis of the run,
                            with the slope of the cone
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations
from math import asin, atan, atan2, cos, degrees, radians, sin, sqrt, tan
from typing import Unpack

from flint import fmpq

from pas.algebra.inputs import shown
from pas.algebra.rational import Vector, VectorLike, cross, dot, minus, moved, plain, to_float
from pas.contacts.cones import Opening
from pas.contacts.endless import Pipe
from pas.contacts.parallels import root
from pas.errors import GeometryError
from pas.limits import Report, limited
from pas.pipeline.blend import BlendOptions, Strut, blend, node, pipes_of
from pas.pipeline.result import Blend

FINE = 64
"""Parts of a slope, a length or a direction in which they are rounded that nobody gave: short numbers keep the algebra
short."""


@dataclass(frozen=True)
class Tee:
    """A branch on a straight run: the `branch` goes from its point, where the axes meet, along its axis."""

    run: Pipe
    branch: Pipe

    @classmethod
    def of(cls, run: Pipe, branch: Pipe) -> Tee:
        """The T of two pipes; raises `GeometryError` where their axes do not meet, or the branch is not the thinner."""
        for name, pipe in (("run", run), ("branch", branch)):
            if not isinstance(pipe, Pipe):
                raise TypeError(f"{name} must be a pas.Pipe, not {shown(pipe)}")
        across, apart = cross(run.axis, branch.axis), minus(branch.point, run.point)
        if not any(across):
            raise GeometryError("the branch goes along the run, so that their axes do not meet")
        if dot(apart, across) != 0:
            miss = abs(to_float(dot(apart, across))) / sqrt(to_float(dot(across, across)))
            raise GeometryError(f"the axis of the branch must meet that of the run, and misses it by {miss:.4g}")
        if branch.radius >= run.radius:
            raise GeometryError(
                f"the branch must be thinner than the run: its radius is {plain(branch.radius)}, that of the run "
                f"{plain(run.radius)}; pas.node joins them"
            )
        along = -dot(cross(apart, run.axis), cross(branch.axis, run.axis)) / dot(across, across)
        point = moved(branch.point, (along, branch.axis))
        if isinstance(branch.clip, str):
            return cls(run, replace(branch, point=point))
        far = branch.clip - along
        return cls(run, Pipe([c if far > 0 else -c for c in branch.axis], branch.radius, abs(far), point))

    @cached_property
    def angle(self) -> float:
        """Between the axes, in degrees: at most 90, which is exact."""
        across, along = cross(self.run.axis, self.branch.axis), dot(self.run.axis, self.branch.axis)
        return degrees(atan2(sqrt(to_float(dot(across, across))), abs(to_float(along))))

    @property
    def ratio(self) -> float:
        """The branch's radius over the run's."""
        return to_float(self.branch.radius / self.run.radius)

    @cached_property
    def slope(self) -> fmpq:
        """The tangent of half of the cone's angle."""
        return fmpq(round(FINE * tan(radians(degrees(asin(self.ratio)) + 85) / 2)), FINE)

    @property
    def reach(self) -> float:
        """How far the opening goes along the run from where the axes meet, in the model's units."""
        return to_float(self.run.radius) * tan(radians(90 - self.angle) / 2 + atan(to_float(self.slope)))

    @cached_property
    def contacts(self) -> tuple[Opening, Pipe]:
        """The opening in the run and the branch with its end."""
        surface = self.run.clipped(1).contact.surface
        return Opening(surface, self._axis, self.slope, self.branch.point), self._ended

    @property
    def _axis(self) -> Vector:
        """Halfway between the branch and the normal of the run in their plane: exact for an upright branch."""
        run, branch = self.run.axis, self.branch.axis
        share = dot(run, branch) / dot(run, run)
        if share == 0:
            return branch
        longer = fmpq(round(FINE / sin(radians(self.angle))), FINE)
        return moved(branch, (longer, moved(branch, (-share, run))))

    @property
    def _ended(self) -> Pipe:
        if self.branch.ends:
            return self.branch
        slope, ratio = to_float(self.slope), self.ratio
        high, angle = 1 + min(max(slope - ratio, 0.4), 1.2), radians(self.angle)
        parts = round(FINE * (high + ratio * cos(angle)) / sin(angle))
        return self.branch.clipped(self.run.radius * fmpq(parts, FINE) / root(dot(self.branch.axis, self.branch.axis)))

    def drawback(self, order: int) -> str:
        """Why a node is the better one, in words; empty where a foot is."""
        if order > 1:
            return f"with GC^{order} a foot bends sharper than a node from half of the run's radius on"
        most = 0.7 + 0.15 * (self.angle - 75) / 15
        if self.angle < 75 - 1e-9:
            return f"the branch leans by {90 - self.angle:.3g} degrees, a foot by 15 at the most"
        if self.ratio > most + 1e-9:
            return f"the branch has {self.ratio:.3g} of the run's radius, a foot {most:.3g} at the most at this angle"
        return ""


def tee_of(pipes: Sequence[Pipe], order: int) -> Tee | str:
    """The T for which a foot is the better one, of pipes that leave a point; else why a node is, in words."""
    shape = "a foot needs a run of two pipes on one line with one radius, and one branch that is thinner"
    if len(pipes) != 3:
        return shape
    for run, back, branch in permutations(pipes):
        in_line = not any(cross(run.axis, back.axis)) and dot(run.axis, back.axis) < 0
        if in_line and run.radius == back.radius > branch.radius and any(cross(run.axis, branch.axis)):
            tee = Tee.of(run, branch)
            sizes = ((pipe, sqrt(to_float(dot(pipe.axis, pipe.axis)))) for pipe in (run, back) if pipe.ends)
            clips = [abs(to_float(pipe.end)) * size for pipe, size in sizes]
            if drawback := tee.drawback(order):
                return drawback
            if min(clips, default=tee.reach) < tee.reach:
                return f"the foot would reach {tee.reach:.4g} along the run, beyond its clip at {min(clips):.4g}"
            return tee
    return shape


@limited("making a foot", "a lower order")
def foot(
    run: Pipe,
    branch: Pipe,
    order: int = 1,
    *,
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[BlendOptions],
) -> Blend:
    """The blend of a branch and the run that it rises out of, whose cylinder stays exact up to an opening.

        run = pas.Pipe((1, 0, 0), 1, "auto")
        pas.foot(run, pas.Pipe((0, 0, 1), "1/2", "auto"))

    Both are pipes whose axes meet; the clip of the run plays no part.  The branch is the thinner one and goes along its
    axis, with the clip "auto" as far as the fillet needs, else to its clip.  The opening is along a cone from where the
    axes meet (see `pas.pipeline.feet`, also for when a foot is better than a node, which `pas.junction` decides).
    `pas.header` makes one solid of a run with several feet.  All else is as for `pas.blend`.

    Raises `GeometryError` for axes that do not meet and a branch that is not thinner, and what `pas.blend` raises.
    """
    tee = Tee.of(run, branch)
    found = blend(tee.contacts, order, **options)
    return replace(found, reason=f"foot, {tee.angle:.3g} degrees, {tee.ratio:.3g} of the run's radius: as asked")


@limited("making a junction", "a lower order")
def junction(
    items: Sequence[Strut],
    order: int = 1,
    *,
    center: VectorLike = (0, 0, 0),
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[BlendOptions],
) -> Blend:
    """The blend of pipes that meet in `center`, with the same arguments as `pas.node`: a foot where that is better.

        print(pas.junction([((1, 0, 0), 1), ((-1, 0, 0), 1), ((0, 0, 1), "1/2")]))

    That is for a T with GC^1: a run of two pipes on one line with one radius, whose clips leave room for the opening,
    and a branch at 75 to 90 degrees to it with a radius of up to 0.7 of the run's (0.85 at 90 degrees).  Else, and
    where a `partition` is given, it is the node.  The summary says which was taken, and why.

    Raises what `pas.node` raises.
    """
    given = options.get("partition") is not None
    tee = "a partition is given" if given else tee_of(pipes_of(items, order, center), order)
    if isinstance(tee, str):
        return replace(node(items, order, center=center, **options), reason=f"node: {tee}")
    found = blend(tee.contacts, order, **options)
    what = f"foot, {tee.angle:.3g} degrees, {tee.ratio:.3g} of the run's radius"
    return replace(found, reason=f"{what}: the run stays exact, the fillet is wider than a node's")
