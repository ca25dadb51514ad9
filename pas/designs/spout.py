"""Spouts: a round tube with bends, a fillet and a channel, all blends or exact; and two cubics (Lou et al. 2002)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import dist

from pas.algebra.affine import height
from pas.algebra.inputs import shown_point
from pas.algebra.polynomial import Polynomial
from pas.contacts.endless import Cone
from pas.designs.body import Body, below, filleted
from pas.designs.exact import Design, Point, Points, closest, even, nearest, points
from pas.errors import GeometryError, InfeasibleError, NoSolutionError, PasError
from pas.pipeline.blend import blend
from pas.pipeline.bodies import body as body_of
from pas.pipeline.result import Blend, SolutionSpace
from pas.solid.assembly import union
from pas.solid.solid import Solid, patch

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
                f"lower body, not from {shown_point(first)} to {shown_point(second)}"
            )
        start = self._cone(0, 1, NONE, NONE)
        solid |= union([*self._tubes(self.bends, "spout", NONE)])
        tube, ahead = start.contact.surface, Polynomial.from_raw(height(start.point, start.axis))
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
        """The cone from one point of the axis to another, cut off at a share of the way."""
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


@dataclass(frozen=True, repr=False)
class PaperSpout(Design):
    """The published spout (Lou, Feng, Chen and Deng 2002), fitted anew: GC^0 with the body; it has no channel.

    It has two cubics between a plane `root`, a plane `bend` and the height of the mouth.  As there, each cubic has the
    least `sum f(p)^2 / |f|^2` at the points of its outline, |f| the length of its coefficients: 1.88231e-6 below the
    bend, where the printed coefficients of six digits have 1.88263e-6.  Numbers are exact, in the model's units; the
    spout is symmetric in y.  Raises `GeometryError` for the joint that cannot be made.
    """

    lower_outline: Points = points((1.6, 0.15), (1.8, 0.2), (1.7, 0.17), (1.9, 0.25), (1.5, -0.54), (2.2, 0.05),
                                   (1.7, -0.45), (1.9, -0.33), (2.1, -0.1))  # fmt: skip
    upper_outline: Points = points((2.4, 0.55), (2.6, 0.85), (2.8, 1.01), (3.0, 1.1), (2.1, 0.67), (2.2, 0.85),
                                   (2.4, 1.02), (2.65, 1.1), (2.2, 0.85), (2.4, 1.02))  # fmt: skip
    """Points (x, z) of the outline in the plane y = 0, below and above the bend, as published; two occur twice."""

    waist: Polynomial = Polynomial("(z - 8/3*(x - 2))^2 + 8*y^2 - 2/9")
    """The elliptic cylinder that cuts the spout's outline in the plane of the bend."""

    tilt: Fraction = Fraction(0)
    """How far the spout leans outwards for each unit of height."""

    root: Polynomial = Polynomial("13 - 9*x + 2*z")
    bend: Polynomial = Polynomial("48 - 15*x - 40*z")
    """Planes where the spout leaves the body, negative beyond, and where its patches meet, positive below."""

    mouth: Fraction = Fraction(11, 10)
    """The height of the mouth."""

    inside: Point = (Fraction(2), Fraction(0), Fraction(9, 20))
    """A point inside the spout in the plane of the bend, where each member is a multiple of the contact: a
    value there keeps the multiple from vanishing."""

    lower_walls: tuple[Polynomial, ...] = (Polynomial("z + 3/5"), Polynomial("1/2 - z"), Polynomial("1/4 - y^2"))
    upper_walls: tuple[Polynomial, ...] = (
        Polynomial("x - z - 11/10"), Polynomial("1/4 - y^2"), Polynomial("16/5 - x"),
    )  # fmt: skip
    """Walls, positive inside, that keep other sheets of the cubics away; the spout does not touch them."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if abs(self.tilt) > MOST_TILT:
            raise GeometryError(
                f"the joint of the two spout patches cannot be made with spout_tilt {self.tilt}: beyond {MOST_TILT} "
                "either way the cubic has no clean outline"
            )
        for name in ("lower_outline", "upper_outline"):
            points = getattr(self, name)
            if not points or any(len(p) != 2 for p in points):
                raise ValueError(f"{name} must be points (x, z), at least one, not {len(points)} of another form")
        if self.bend.at(self.inside) != 0:
            raise GeometryError(
                f"the joint of the two spout patches cannot be made: inside must be a point of the bend {self.bend} = 0"
            )

    def walls(self) -> tuple[tuple[Polynomial, ...], tuple[Polynomial, ...]]:
        """Where upper and lower body end at the spout."""
        return (), (self.root,)

    def attached(self, solid: Solid, body: Body) -> Solid:
        """The solid, of which the body is part, with the spout, its two joints and its flat mouth."""
        try:
            lower, upper = self.cubics(body)
        except (GeometryError, NoSolutionError, InfeasibleError) as error:
            raise GeometryError(f"the joints of the spout cannot be made: {error}") from error
        solid |= patch("spout lower", lower, -self.root, self.bend, *self.lower_walls)
        solid |= patch("spout upper", upper, -self.bend, below(self.mouth), *self.upper_walls)
        solid = solid.joined("spout lower", "spout upper", (lower, self.bend), 1)
        solid = solid.joined("body lower", "spout lower", (body.lower, self.root), 0)
        return solid.cap(-below(self.mouth), "mouth")

    def channel(self) -> Solid | None:
        """None: the pot does not pour."""
        return None

    def lower(self, space: SolutionSpace) -> Polynomial:
        """The lower cubic, of those that meet the body and the waist."""
        return closest(space, _outline(self.lower_outline), self.inside, by_gradient=False)

    def cubics(self, body: Body) -> tuple[Polynomial, Polynomial]:
        """Both cubics as published."""
        lower = self.lower(even([(body.lower, self.root), (self.waist, self.bend)], 0, 3))
        beyond = _outline(self.upper_outline, self.tilt)
        return lower, closest(even([(lower, self.bend)], 1, 3), beyond, self.inside, by_gradient=False)


@dataclass(frozen=True, repr=False)
class PrintedSpout(PaperSpout):
    """The published spout with the lower cubic's printed coefficients.

    These are rounded to six digits, so the cubic meets nothing exactly: it is replaced by the nearest one that does,
    each coefficient of which is that printed to within 4e-7.
    """

    printed: Polynomial = Polynomial(
        "-0.382086 + 0.671121*x - 0.390428*x^2 + 0.0748303*x^3 - 0.124559*y^2 + 0.093717*x*y^2 - 0.27378*z"
        " + 0.346645*x*z - 0.10528*x^2*z - 0.0386148*y^2*z - 0.0905839*z^2 + 0.062592*x*z^2 - 0.038205*z^3"
    )

    def lower(self, space: SolutionSpace) -> Polynomial:
        """The cubic of the space that is nearest to the printed one."""
        return nearest(space, self.printed)


def _outline(points: Points, tilt: Fraction = Fraction(0)) -> list[Point]:
    """Points (x, 0, z) of an outline, leaning outwards by `tilt` per unit of height above the bend."""
    return [(x + tilt * (z - UPRIGHT), Fraction(0), z) for x, z in points]


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
