"""Spout and handle as published: cubics and a quartic, continuous with the body."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import cos, pi, sin
from typing import ClassVar

from pas.algebra.brief import brief
from pas.algebra.polynomial import Polynomial
from pas.designs.body import Body
from pas.designs.exact import Point, Points, points, settle
from pas.designs.fitting import closest, continued, even
from pas.designs.spout import SpoutShape
from pas.errors import GeometryError
from pas.solid.solid import Solid, patch

AROUND, ALONG = 10, 13
"""Points on the bent tube that a handle is fitted to."""

TURN = 0.96
"""Of half an ellipse, which the tube's centre line follows."""

SIZES = Fraction(9, 10), Fraction(11, 10)
"""For which the quartic has a clean loop."""


@dataclass(frozen=True)
class PaperSpout(SpoutShape):
    """The published spout: GC^0 with the body, its cubics GC^1 with one another; it has no channel."""

    order: ClassVar[int] = 0

    lower_outline: Points = points((1.6, 0.15), (1.8, 0.2), (1.7, 0.17), (1.9, 0.25), (1.5, -0.54), (2.2, 0.05),
                                   (1.7, -0.45), (1.9, -0.33), (2.1, -0.1))  # fmt: skip
    upper_outline: Points = points((2.4, 0.55), (2.6, 0.85), (2.8, 1.01), (3.0, 1.1), (2.1, 0.67), (2.2, 0.85),
                                   (2.4, 1.02), (2.65, 1.1), (2.2, 0.85), (2.4, 1.02))  # fmt: skip
    """As published; two points occur twice."""

    waist: Polynomial = Polynomial("(z - 8/3*(x - 2))^2 + 8*y^2 - 2/9")
    """The elliptic cylinder that cuts the spout's outline in the plane of the bend."""

    at_root: Point = (Fraction(7, 5), Fraction(0), Fraction(-1, 5))
    """A point of the root's plane inside the body, where a cubic must be inside too."""

    __repr__ = brief

    def cubics(self, body: Body) -> tuple[Polynomial, Polynomial]:
        """Both cubics as published."""
        contacts = [(body.lower, self.root), (self.waist, self.bend)]
        lower = continued(contacts, self.order, self.outline(self.lower_outline), self.inside, [self.at_root])
        beyond = self.outline(self.upper_outline, self.tilt)
        return lower, continued([(lower, self.bend)], 1, beyond, self.inside)


@dataclass(frozen=True)
class PaperHandle:
    """The quartic that holds the curves of both ends, at the least mean squared distance from a bent tube.

    Numbers are exact, in the model's units.  Raises `GeometryError` for the joint that cannot be made.
    """

    size: Fraction = Fraction(1)
    """Scales the handle about the middle of its ends."""

    upper_end: Polynomial = Polynomial("2*x - z + 323/100")
    lower_end: Polynomial = Polynomial("2*x + z + 321/100")
    """Planes in which it meets the upper and the lower body, negative on the handle's side."""

    center: Point = (Fraction(-29, 20), Fraction(1, 10))
    """The middle (x, z) of its ends."""

    reach: Fraction = Fraction(17, 20)
    half: Fraction = Fraction(11, 20)
    thickness: Fraction = Fraction(11, 100)
    """Of its centre line: how far it stands out, half its height; and its radius."""

    __repr__ = brief

    def __post_init__(self) -> None:
        settle(self)
        if not SIZES[0] <= self.size <= SIZES[1]:
            raise GeometryError(
                f"the joints of handle and body cannot be made with handle_size {self.size}: the quartic has a clean "
                f"loop for sizes from {SIZES[0]} to {SIZES[1]}"
            )

    def walls(self) -> tuple[tuple[Polynomial, ...], tuple[Polynomial, ...]]:
        """Where upper and lower body end at the handle."""
        return (self.upper_end,), (self.lower_end,)

    def attached(self, solid: Solid, body: Body) -> Solid:
        """The solid, of which the body is part, with the handle and its two joints."""
        loop, middle = self.quartic(body), Polynomial("z")
        solid |= patch("handle", loop, middle, -self.upper_end) | patch("handle", loop, -middle, -self.lower_end)
        solid = solid.joined("body upper", "handle", (body.upper, self.upper_end), 0)
        return solid.joined("body lower", "handle", (body.lower, self.lower_end), 0)

    def quartic(self, body: Body) -> Polynomial:
        """The quartic itself, negative inside."""
        space = even([(body.upper, self.upper_end), (body.lower, self.lower_end)], 0, 4)
        x, z = self.center
        return closest(space, self._bent_tube(), (x - self.reach * self.size, Fraction(0), z))

    def _bent_tube(self) -> list[tuple[float, float, float]]:
        """Points on a tube around half an ellipse that starts and ends in the body."""
        reach, half, radius = (float(v) for v in (self.reach * self.size, self.half * self.size, self.thickness))
        points = []
        for i in range(ALONG):
            t = pi * (i / (ALONG - 1) - 0.5) * TURN
            x, z = float(self.center[0]) - reach * cos(t), float(self.center[1]) + half * sin(t)
            nx, nz = -half * cos(t), reach * sin(t)
            length = (nx * nx + nz * nz) ** 0.5
            for j in range(AROUND):
                u, v = radius * cos(2 * pi * j / AROUND), radius * sin(2 * pi * j / AROUND)
                points.append((round(x + u * nx / length, 6), round(v, 6), round(z + u * nz / length, 6)))
        return points
