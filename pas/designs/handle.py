"""Handles: a loop that flows through two tubes and two fillets into the body; and a quartic (Lou et al. 2002)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import cos, pi, sin, sqrt

from pas.algebra.polynomial import Polynomial
from pas.designs.body import Body, X, Y, Z, filleted
from pas.designs.exact import Design, Point, closest, even
from pas.errors import GeometryError
from pas.solid.solid import Solid, patch


@dataclass(frozen=True, repr=False)
class Handle(Design):
    """Half a stretched torus between two straight tubes, and fillets from these to the body.

    The loop meets the tubes with GC^1 where these are straight, as the fillets do (see `pas.designs.body.filleted`).
    Numbers are exact, in the model's units.  Raises `GeometryError` for the joint that cannot be made.
    """

    size: Fraction = Fraction(1)
    """Scales the handle's height."""

    middle: Fraction = Fraction(1, 10)
    half: Fraction = Fraction(11, 20)
    """The height of its middle, and half the distance of its two tubes."""

    thickness: Fraction = Fraction(11, 100)
    """The tubes' radius."""

    start: Fraction = Fraction(8, 5)
    """How far behind the axis of the body the loop becomes two straight tubes."""

    reach: Fraction = Fraction(6, 5)
    """How far the loop's centre line stands out behind there, over half the distance of the tubes."""

    tube_side: Fraction = Fraction(1, 25)
    body_side: Fraction = Fraction(3, 20)
    """How far the fillets reach, as values of the tube's polynomial and of the body's."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("size", "half", "thickness", "start", "reach", "tube_side", "body_side"):
            if getattr(self, name) <= 0:
                raise GeometryError(
                    f"the joints of the handle cannot be made: its {name} must be positive, not {getattr(self, name)}"
                )
        if self.thickness >= self.half * self.size:
            raise GeometryError(
                f"the joint of handle loop and handle tubes cannot be made: the thickness {self.thickness} must be "
                f"below half the distance of the tubes, {self.half * self.size}"
            )

    def attached(self, solid: Solid, body: Body) -> Solid:
        """The solid, of which the body is part, with the handle and its six joints."""
        upper, lower = (self.middle + sign * self.half * self.size for sign in (1, -1))
        self._check("upper", upper, body.seam, "the seam of the body", body.top, "the lid")
        self._check("lower", lower, body.bottom, "the bottom", body.seam, "the seam of the body")
        start = X + self.start
        solid |= patch("handle loop", self._loop(), -start)
        for name, surface, height in (("upper", body.upper, upper), ("lower", body.lower, lower)):
            tube = Y**2 + (Z - height) ** 2 - self.thickness**2
            solid |= patch(f"handle {name} tube", tube, start, -X, surface)
            solid = solid.joined("handle loop", f"handle {name} tube", (tube, start), 1)
            names = f"body {name}", f"handle {name} tube", f"handle {name} fillet"
            solid = filleted(solid, names, (surface, tube), (self.body_side, self.tube_side), -X)
        return solid

    def walls(self) -> tuple[tuple[Polynomial, ...], tuple[Polynomial, ...]]:
        """Where upper and lower body end at the handle: nowhere, it is added to the whole body."""
        return (), ()

    def _loop(self) -> Polynomial:
        half = self.half * self.size
        flat = ((X + self.start) / self.reach) ** 2 + (Z - self.middle) ** 2
        return (flat + Y**2 + half**2 - self.thickness**2) ** 2 - flat * (4 * half**2)

    def _check(self, name: str, height: Fraction, low: Fraction, floor: str, high: Fraction, ceiling: str) -> None:
        reach = self.thickness**2 + self.tube_side  # squared
        if not (low < height < high and (height - low) ** 2 > reach < (high - height) ** 2):
            raise GeometryError(
                f"the joint of handle and {name} body cannot be made with handle_size {self.size}: its fillet, "
                f"{sqrt(reach):.4g} to either side of height {float(height):.4g}, must stay between {floor} at {low} "
                f"and {ceiling} at {high}"
            )


@dataclass(frozen=True, repr=False)
class PaperHandle(Design):
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

    def __post_init__(self) -> None:
        super().__post_init__()
        least, most = Fraction(9, 10), Fraction(11, 10)
        if not least <= self.size <= most:
            raise GeometryError(
                f"the joints of handle and body cannot be made with handle_size {self.size}: the quartic has a clean "
                f"loop for sizes from {least} to {most}"
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
        """Points on a tube around half an ellipse (0.96 of it) that starts and ends in the body."""
        reach, half, radius = (float(v) for v in (self.reach * self.size, self.half * self.size, self.thickness))
        points, along, around = [], 13, 10
        for i in range(along):
            t = pi * (i / (along - 1) - 0.5) * 0.96
            x, z = float(self.center[0]) - reach * cos(t), float(self.center[1]) + half * sin(t)
            nx, nz = -half * cos(t), reach * sin(t)
            length = (nx * nx + nz * nz) ** 0.5
            for j in range(around):
                u, v = radius * cos(2 * pi * j / around), radius * sin(2 * pi * j / around)
                points.append((round(x + u * nx / length, 6), round(v, 6), round(z + u * nz / length, 6)))
        return points
