"""Spouts of two cubics inside the ideals of their joints: a slim one; the published one, fitted anew and as printed."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import ClassVar

from pas.algebra.brief import brief
from pas.algebra.polynomial import Polynomial
from pas.designs.body import Body, below
from pas.designs.exact import Point, Points, closest, continued, even, nearest, points, settle
from pas.errors import GeometryError, InfeasibleError, NoSolutionError
from pas.pipeline.result import SolutionSpace
from pas.solid.primitives import ball, cone
from pas.solid.solid import Solid, patch

MOST_TILT = Fraction(1, 5)
UPRIGHT = Fraction(1, 2)
"""The height above which a spout leans."""


@dataclass(frozen=True)
class SpoutShape(ABC):
    """What all spouts have: two cubics between a plane `root`, a plane `bend` and the height of the mouth.

    Numbers are exact, in the model's units; the spout is symmetric in y.  Raises `GeometryError` for the joint that
    cannot be made.
    """

    order: ClassVar[int]
    """Of contact with the body."""

    lower_outline: Points
    upper_outline: Points
    """Points (x, z) of the outline in the plane y = 0, below and above the bend."""

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

    channel: Points = ()
    """Points (x, z, radius) on the axis of the channel of a hollow spout, from inside the body to beyond the mouth."""

    def __post_init__(self) -> None:
        settle(self)
        if abs(self.tilt) > MOST_TILT:
            raise GeometryError(
                f"the joint of the two spout patches cannot be made with spout_tilt {self.tilt}: beyond {MOST_TILT} "
                "either way the cubic has no clean outline"
            )
        for name, length, form in (("lower_outline", 2, "(x, z)"), ("upper_outline", 2, "(x, z)"),
                                   ("channel", 3, "(x, z, radius)")):  # fmt: skip
            points = getattr(self, name)
            if any(len(p) != length for p in points) or (not points and name != "channel"):
                raise ValueError(f"{name} must be points {form}, at least one, not {len(points)} of another form")
        if self.bend.at(self.inside) != 0:
            raise GeometryError(
                f"the joint of the two spout patches cannot be made: inside must be a point of the bend {self.bend} = 0"
            )

    @abstractmethod
    def cubics(self, body: Body) -> tuple[Polynomial, Polynomial]:
        """The lower and the upper polynomial, negative inside."""

    def walls(self) -> tuple[tuple[Polynomial, ...], tuple[Polynomial, ...]]:
        """Where upper and lower body end at the spout."""
        return (), (self.root,)

    def attached(self, solid: Solid, body: Body) -> Solid:
        """The solid, of which the body is part, with the spout and its two joints."""
        try:
            lower, upper = self.cubics(body)
        except (GeometryError, NoSolutionError, InfeasibleError) as error:
            raise GeometryError(f"the joints of the spout cannot be made: {error}") from error
        solid |= patch("spout lower", lower, -self.root, self.bend, *self.lower_walls)
        solid |= patch("spout upper", upper, -self.bend, below(self.mouth), *self.upper_walls)
        solid = solid.joined("spout lower", "spout upper", (lower, self.bend), 1)
        return solid.joined("body lower", "spout lower", (body.lower, self.root), self.order)

    def passage(self, solid: Solid) -> Iterator[Solid]:
        """The pieces of the channel; raises `GeometryError` where it leaves the spout of a solid.

        Balls at its bends are wider than it by 3/20, so that they cross clearly.
        """
        points = [(x + self.tilt * max(z - UPRIGHT, Fraction(0)), Fraction(0), z) for x, z, _ in self.channel]
        cubics = solid.polynomials
        for p in points:
            name = "spout lower" if self.bend.at(p) >= 0 else "spout upper"
            if self.root.at(p) < 0 and p[2] <= self.mouth and cubics[name][0].at(p) >= 0:
                raise GeometryError(
                    f"the channel cannot be made: its axis leaves {name} at ({float(p[0]):.4g}, 0, {float(p[2]):.4g})"
                )
        radii = [radius for *_, radius in self.channel]
        for (start, end), (wide, narrow) in zip(pairwise(points), pairwise(radii), strict=True):
            yield cone(start, end, wide, narrow, "channel") | ball(end, narrow * Fraction(23, 20), "channel bend")

    def outline(self, points: Points, tilt: Fraction = Fraction(0)) -> list[Point]:
        """Points (x, 0, z) of an outline, leaning outwards by `tilt` per unit of height above the bend."""
        return [(x + tilt * (z - UPRIGHT), Fraction(0), z) for x, z in points]


@dataclass(frozen=True)
class Spout(SpoutShape):
    """A slim spout, joined to the body with GC^1 and of two cubics with GC^1."""

    order: ClassVar[int] = 1

    lower_outline: Points = points((1.62, 0.29), (1.72, 0.36), (1.82, 0.43), (1.9, 0.49), (1.5, -0.44), (1.7, -0.27),
                                   (1.9, -0.02), (2.05, 0.2), (2.16, 0.39))  # fmt: skip
    upper_outline: Points = points((2.24, 0.55), (2.33, 0.75), (2.43, 0.95), (2.52, 1.1), (1.99, 0.65), (2.11, 0.85),
                                   (2.22, 1.0), (2.3, 1.1))  # fmt: skip

    lower_sides: Points = points((1.5, 0.35, -0.2), (1.7, 0.25, 0.05), (1.85, 0.2, 0.25), (2.0, 0.17, 0.4))
    upper_sides: Points = points((2.15, 0.15, 0.65), (2.28, 0.13, 0.85), (2.4, 0.12, 1.1))
    """Points (x, +-y, z) that tell how wide it is."""

    middle: Point = (Fraction(33, 20), Fraction(0), Fraction(0))
    """A point in the middle of the lower patch."""

    channel: Points = points((1.15, -0.4, 0.08), (1.76, 0.08, 0.06), (2.02, 0.41, 0.05), (2.48, 1.2, 0.025))

    __repr__ = brief

    def cubics(self, body: Body) -> tuple[Polynomial, Polynomial]:
        """Both cubics with GC^1 at the body as well."""
        outline, sides = self.outline(self.lower_outline), self._sides(self.lower_sides)
        beyond = self.outline(self.upper_outline, self.tilt) + self._sides(self.upper_sides, self.tilt)
        # the upper patch's points keep the lower one going in the right direction
        weights = [1] * len(outline) + [4] * len(sides) + [Fraction(1, 5)] * len(beyond)
        space = even([(body.lower, self.root)], self.order, 3)
        lower = closest(space, outline + sides + beyond, self.middle, weights)
        return lower, continued([(lower, self.bend)], 1, beyond, self.inside)

    def _sides(self, points: Points, tilt: Fraction = Fraction(0)) -> list[Point]:
        """Points (x, +-y, z), leaning like those of the outline."""
        moved = self.outline(tuple((x, z) for x, _, z in points), tilt)
        return [(x, side * y, z) for (x, _, z), (_, y, _) in zip(moved, points, strict=True) for side in (1, -1)]


@dataclass(frozen=True)
class PaperSpout(SpoutShape):
    """The published spout (Lou, Feng, Chen and Deng 2002), fitted anew: GC^0 with the body; it has no channel.

    As there, each cubic has the least `sum f(p)^2 / |f|^2` at the points of its outline, |f| the length of its
    coefficients: 1.88231e-6 below the bend, where the printed coefficients of six digits have 1.88263e-6.
    """

    order: ClassVar[int] = 0

    lower_outline: Points = points((1.6, 0.15), (1.8, 0.2), (1.7, 0.17), (1.9, 0.25), (1.5, -0.54), (2.2, 0.05),
                                   (1.7, -0.45), (1.9, -0.33), (2.1, -0.1))  # fmt: skip
    upper_outline: Points = points((2.4, 0.55), (2.6, 0.85), (2.8, 1.01), (3.0, 1.1), (2.1, 0.67), (2.2, 0.85),
                                   (2.4, 1.02), (2.65, 1.1), (2.2, 0.85), (2.4, 1.02))  # fmt: skip
    """As published; two points occur twice."""

    waist: Polynomial = Polynomial("(z - 8/3*(x - 2))^2 + 8*y^2 - 2/9")
    """The elliptic cylinder that cuts the spout's outline in the plane of the bend."""

    __repr__ = brief

    def lower(self, space: SolutionSpace) -> Polynomial:
        """The lower cubic, of those that meet the body and the waist."""
        return closest(space, self.outline(self.lower_outline), self.inside, by_gradient=False)

    def cubics(self, body: Body) -> tuple[Polynomial, Polynomial]:
        """Both cubics as published."""
        lower = self.lower(even([(body.lower, self.root), (self.waist, self.bend)], self.order, 3))
        beyond = self.outline(self.upper_outline, self.tilt)
        return lower, closest(even([(lower, self.bend)], 1, 3), beyond, self.inside, by_gradient=False)


@dataclass(frozen=True)
class PrintedSpout(PaperSpout):
    """The published spout with the lower cubic's printed coefficients.

    These are rounded to six digits, so the cubic meets nothing exactly: it is replaced by the nearest one that does,
    each coefficient of which is that printed to within 4e-7.
    """

    printed: Polynomial = Polynomial(
        "-0.382086 + 0.671121*x - 0.390428*x^2 + 0.0748303*x^3 - 0.124559*y^2 + 0.093717*x*y^2 - 0.27378*z"
        " + 0.346645*x*z - 0.10528*x^2*z - 0.0386148*y^2*z - 0.0905839*z^2 + 0.062592*x*z^2 - 0.038205*z^3"
    )

    __repr__ = brief

    def lower(self, space: SolutionSpace) -> Polynomial:
        """The cubic of the space that is nearest to the printed one."""
        return nearest(space, self.printed)
