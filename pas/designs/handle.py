"""The handle: a loop that flows through two straight tubes and two fillets into the body."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import sqrt

from pas.algebra.brief import brief
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.designs.body import Body
from pas.designs.exact import settle
from pas.errors import GeometryError
from pas.solid.solid import Solid, patch


@dataclass(frozen=True)
class Handle:
    """Half a stretched torus between two straight tubes, and fillets from these to the body.

    The loop meets the tubes with GC^1 where these are straight.  A fillet is an ellipse in the plane of
    (value of the body, value of the tube), tangent to both axes, hence of the ideals
    `<body, (tube - b)^2>` and `<tube, (body - a)^2>`.  Numbers are exact, in the model's units.  Raises `GeometryError`
    for the joint that cannot be made.
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

    __repr__ = brief

    def __post_init__(self) -> None:
        settle(self)
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
        x, y, z = map(Polynomial.from_raw, GENERATORS)
        start = x + self.start
        solid |= patch("handle loop", self._loop(), -start)
        for name, surface, height in (("upper", body.upper, upper), ("lower", body.lower, lower)):
            tube = y**2 + (z - height) ** 2 - self.thickness**2
            a, b = surface / self.body_side, tube / self.tube_side
            fillet = -((a - 1) ** 2) - (b - 1) ** 2 + 1
            solid |= patch(f"handle {name} tube", tube, start, -x, surface)
            solid |= patch(f"handle {name} fillet", fillet, surface, tube, -(a + b - 1), -x)
            solid = solid.joined("handle loop", f"handle {name} tube", (tube, start), 1)
            solid = solid.joined(f"handle {name} tube", f"handle {name} fillet", (tube, surface - self.body_side), 1)
            solid = solid.joined(f"body {name}", f"handle {name} fillet", (surface, tube - self.tube_side), 1)
        return solid

    def walls(self) -> tuple[tuple[Polynomial, ...], tuple[Polynomial, ...]]:
        """Where upper and lower body end at the handle: nowhere, it is added to the whole body."""
        return (), ()

    def _loop(self) -> Polynomial:
        x, y, z = map(Polynomial.from_raw, GENERATORS)
        half = self.half * self.size
        flat = ((x + self.start) / self.reach) ** 2 + (z - self.middle) ** 2
        return (flat + y**2 + half**2 - self.thickness**2) ** 2 - flat * (4 * half**2)

    def _check(self, name: str, height: Fraction, low: Fraction, floor: str, high: Fraction, ceiling: str) -> None:
        reach = self.thickness**2 + self.tube_side  # squared
        if not (low < height < high and (height - low) ** 2 > reach < (high - height) ** 2):
            raise GeometryError(
                f"the joint of handle and {name} body cannot be made with handle_size {self.size}: its fillet, "
                f"{sqrt(reach):.4g} to either side of height {float(height):.4g}, must stay between {floor} at {low} "
                f"and {ceiling} at {high}"
            )
