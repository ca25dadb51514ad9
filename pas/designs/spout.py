"""The spout: a round tube with bends, a fillet at its root and a channel, all of them blends or exact surfaces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import dist

from pas.algebra.polynomial import Polynomial
from pas.contacts.endless import Cone
from pas.designs.body import Body, filleted, height_along
from pas.designs.exact import Design, Point, Points, points
from pas.errors import GeometryError, PasError
from pas.pipeline.blend import blend
from pas.pipeline.bodies import body as body_of
from pas.pipeline.result import Blend
from pas.solid.assembly import union
from pas.solid.solid import Solid

MOST_TILT = Fraction(1, 5)
UPRIGHT = Fraction(1, 2)
"""The height above which a spout leans."""

NONE = Fraction(0)


@dataclass(frozen=True, repr=False)
class Spout(Design):
    """A tube about straight lines in the plane y = 0: cones, between which it bends with GC^2, and a channel in it.

    The bends are proved blends of two cones each, those of the channel are proved inside them.  A fillet, an ellipse in
    the values of the body and of the first cone, meets both with GC^1 (see `pas.designs.body.filleted`).  Numbers are
    exact, in the model's units.  Raises `GeometryError` for the joint that cannot be made.
    """

    axis: Points = points((1, -0.3, 0.28), (2.12, -0.02, 0.2), (2.42, 0.78, 0.13), (2.8, 1.15, 0.11))
    """Points (x, z, radius) in which the lines end: the first in the room of the body, the last in the mouth."""

    tilt: Fraction = NONE
    """How far the spout leans outwards for each unit of height."""

    bend: Fraction = Fraction(9, 20)
    """How far from a point the tube bends, over the length of the shorter line there; below 1/2."""

    wall: Fraction = Fraction(1, 20)
    """The radius of the tube less that of its channel; 0 for a full spout."""

    tube_side: Fraction = Fraction(1, 12)
    body_side: Fraction = Fraction(1, 5)
    """How far the fillet reaches, as values of the cone's polynomial and of the body's."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.axis) < 3 or any(len(p) != 3 for p in self.axis):
            raise ValueError(f"axis must be points (x, z, radius), at least three, not {len(self.axis)} of this form")
        if abs(self.tilt) > MOST_TILT:
            raise GeometryError(
                f"the joints of the spout cannot be made with spout_tilt {self.tilt}: it may be {MOST_TILT} either way"
            )
        if not 0 < self.bend < Fraction(1, 2):
            raise GeometryError(
                f"the bends of the spout cannot be made: bend must be between 0 and 1/2, not {self.bend}"
            )
        thinnest = min(radius for *_, radius in self.axis)
        if not 0 <= self.wall < thinnest:
            raise GeometryError(
                f"the channel of the spout cannot be made: wall must be from 0 to below the least radius {thinnest}, "
                f"not {self.wall}"
            )
        if min(self.tube_side, self.body_side) <= 0:
            raise GeometryError("the fillet of spout and body cannot be made: tube_side and body_side must be positive")

    def walls(self) -> tuple[tuple[Polynomial, ...], tuple[Polynomial, ...]]:
        """Where upper and lower body end at the spout: nowhere, it is added to the whole body."""
        return (), ()

    def attached(self, solid: Solid, body: Body) -> Solid:
        """The solid, of which the body is part, with the spout and its joints."""
        first, second, *_ = self._points
        if body.lower.at(first) >= 0 or body.lower.at(second) <= 0:
            raise GeometryError(
                "the joint of spout and body cannot be made: the first line of the spout's axis must lead out of the "
                f"lower body, not from {_told(first)} to {_told(second)}"
            )
        start = self._cone(0, 1, NONE, NONE)
        solid |= union([*self._tubes(self.bends, "spout", NONE)])
        tube, ahead = start.contact.surface, height_along(start.axis, first)
        sides = self.body_side, self.tube_side
        return filleted(solid, ("body lower", "spout base", "spout fillet"), (body.lower, tube), sides, ahead)

    def channel(self) -> Solid | None:
        """The room inside the spout, which goes on beyond its mouth; None in a full one."""
        if self.wall == 0:
            return None
        inner = []
        for number, outer in enumerate(self.bends, 1):
            with _naming(f"bend {number} of the spout's channel"):
                inner.append(outer.hollow(inner=self.cones(number, self.wall)).inner)
        return union([*self._tubes(inner, "channel", Fraction(1, 10))])

    @cached_property
    def _points(self) -> list[Point]:
        """The ends (x, 0, z) of the lines, leaning."""
        return [(x + self.tilt * max(z - UPRIGHT, NONE), NONE, z) for x, z, _ in self.axis]

    @cached_property
    def _lengths(self) -> list[float]:
        return [dist(a, b) for a, b in pairwise(self._points)]

    @cached_property
    def bends(self) -> list[Blend]:
        """The blends of the cones that meet in each inner point of the axis."""
        result = []
        for number in range(1, len(self.axis) - 1):
            with _naming(f"bend {number} of the spout"):
                result.append(blend(self.cones(number), order=2))
        return result

    def _reach(self, number: int) -> float:
        """How far from a point the tube bends."""
        return float(self.bend) * min(self._lengths[number - 1 : number + 1])

    def cones(self, number: int, less: Fraction = NONE) -> list[Cone]:
        """The cones on both sides of a point of the axis, thinner by a radius, up to where they bend."""
        lines = ((number - 1, self._lengths[number - 1]), (number + 1, self._lengths[number]))
        return [self._cone(number, other, _near(self._reach(number) / length), less) for other, length in lines]

    def _cone(self, number: int, other: int, clip: Fraction, less: Fraction) -> Cone:
        """That from one point of the axis to another, cut off at a share of the way."""
        here, there = self._points[number], self._points[other]
        slope = self.axis[other][2] - self.axis[number][2]
        axis = [b - a for a, b in zip(here, there, strict=True)]
        return Cone(axis, self.axis[number][2] - less + slope * clip, clip, slope, here)

    def _tubes(self, bends: Sequence[Blend], name: str, beyond: Fraction) -> Iterator[Solid]:
        """Bends with their cones: to the ends of the axis, and `beyond` the last; those between two bends overlap."""
        last = len(self._lengths) - 1
        names = [f"{name} base", *(f"{name} {n + 1}" for n in range(1, last)), f"{name} tip"]
        for number, made in enumerate(bends, 1):
            reaches = []
            for line, other in ((number - 1, number - 1), (number, number + 1)):
                room = self._lengths[line] - self._reach(number)
                outer = line in (0, last)
                shared = 0.75  # of the length between two bends, of which each has a part beyond the middle
                reaches.append(_near(room if outer else shared * (room - self._reach(other))))
            if number == last:
                reaches[1] += beyond
            yield body_of(made.surface, reaches, names[number - 1 : number + 1], f"{name} bend {number}")


@contextmanager
def _naming(what: str) -> Iterator[None]:
    """Errors within name what could not be made."""
    try:
        yield
    except PasError as error:
        raise GeometryError(f"{what} cannot be made: {error}") from error


def _near(length: float) -> Fraction:
    """A short fraction close to a length: any keeps the joints."""
    return Fraction(length).limit_denominator(100)


def _told(point: Point) -> str:
    return f"({', '.join(f'{float(c):.4g}' for c in point)})"
