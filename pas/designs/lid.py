"""The lid: a flat ellipsoid that flows with GC^2 through a quartic into a cubic knob."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import sqrt

from pas.algebra.polynomial import Polynomial
from pas.contacts.contact import Contact, contact_ideal
from pas.designs.body import Body, X, Y, below
from pas.designs.exact import Design
from pas.errors import GeometryError
from pas.solid.primitives import cylinder
from pas.solid.solid import Solid, patch

KNOB_HEIGHTS = Fraction(1, 10), Fraction(2, 5)
"""Heights of a knob over its start at which its cubic is one sheet."""


@dataclass(frozen=True, repr=False)
class Lid(Design):
    """A surface of revolution on the body's rim: a dome, a blend and a knob.

    Numbers are exact, in the model's units; all but `height` count from the top of the body.  Raises `GeometryError`
    for the joint that cannot be made.
    """

    height: Fraction = Fraction(7, 5)
    """The height of the knob's top, from z = 0."""

    dome: Fraction = Fraction(1, 10)
    """How high the ellipsoid over the rim would go."""

    dome_end: Fraction = Fraction(9, 100)
    knob_start: Fraction = Fraction(1, 5)
    """Where the blend of dome and knob begins and ends."""

    apex: Fraction = Fraction(1, 10)
    """The apex of the cone of which the knob has the curvature where it starts."""

    seat: Fraction = Fraction(3, 20)
    gap: Fraction = Fraction(1, 50)
    """How far the ring under the lid goes down into the opening of a hollow pot, and its distance from that; 0 for no
    ring."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 < self.dome_end < self.dome:
            raise GeometryError(
                f"the joint of dome and blend cannot be made: dome_end must be between 0 and the dome's height "
                f"{self.dome}, not {self.dome_end}"
            )
        if not self.dome_end < self.knob_start or self.apex >= self.knob_start:
            raise GeometryError(
                f"the joint of knob and blend cannot be made: knob_start must be above dome_end {self.dome_end} and "
                f"above the apex {self.apex} of the knob's cone, not {self.knob_start}"
            )

    def solid(self, body: Body) -> Solid:
        """The lid down to the plane of the body's rim, with its two joints."""
        dome, cone = self._dome(body), self._cone(body)
        dome_end, knob_start = body.top + self.dome_end, body.top + self.knob_start
        solid = patch("lid knob", self.knob(body), -below(knob_start), below(self.height))
        solid |= patch("lid blend", self.blend(body), -below(dome_end), below(knob_start))
        solid |= patch("lid dome", dome, -below(body.top), below(dome_end))
        solid = solid.joined("lid knob", "lid blend", (cone, -below(knob_start)), 2)
        return solid.joined("lid blend", "lid dome", (dome, -below(dome_end)), 2)

    def closed(self, body: Body) -> Solid:
        """The lid as a part, with a flat bottom."""
        return self.solid(body).cap(below(body.top), "lid bottom")

    def seated(self, body: Body) -> Solid:
        """The lid of a hollow pot: with the ring that keeps it in the opening."""
        lid = self.closed(body)
        if self.seat == 0:
            return lid
        radius = Fraction(f"{body.opening:.3f}") - self.gap
        room = self.dome * Fraction(f"{sqrt(1 - float(radius / body.rim) ** 2):.3f}")  # of the dome above the ring
        low, high = ((0, 0, body.top + z) for z in (-self.seat, room / 2))
        ring = cylinder(low, high, radius, "lid ring") - cylinder(low, high, radius - body.wall / 2, "lid ring inside")
        return lid | ring

    def blend(self, body: Body) -> Polynomial:
        """The quartic that meets the dome and the cone with GC^2.

        The ideal of all such surfaces has three generators in its graded Groebner basis, each of degree
        4.  Wanted is one of degree 2 in x and y, which has one radius at each height, so one sheet, that
        keeps inside where the dome and the cone have it.
        """
        start, end = body.top + self.dome_end, body.top + self.knob_start
        first = contact_ideal(Contact(self._dome(body), -below(start)), 2)
        ideal = first & contact_ideal(Contact(self._cone(body), -below(end)), 2)
        # a quarter beyond the dome where the blend begins
        around = 1.25 * float(body.rim) * sqrt(1 - (self.dome_end / self.dome) ** 2)
        heights = [float(h) for h in (start, (start + end) / 2, end)]
        for generator in ideal.groebner_basis():
            if max(e[0] for e in generator.coefficients()) == 2:
                for member in (generator, -generator):
                    if all(member((0, 0, h)) < 0 < member((around, 0, h)) for h in heights):
                        return member
        raise GeometryError("the joints of the lid cannot be made: no generator of its ideal has a single sheet")

    def knob(self, body: Body) -> Polynomial:
        """The cubic `cone + a (z - knob_start)^3` that ends at the height: GC^2 with the cone for every a."""
        start = body.top + self.knob_start
        least, most = (start + h for h in KNOB_HEIGHTS)
        if not least <= self.height <= most:
            raise GeometryError(
                f"the joint of knob and blend cannot be made with lid_height {self.height}: the knob starts at "
                f"{start}, and is one sheet above it for heights from {least} to {most}"
            )
        cone = self._cone(body)
        return cone - below(start) ** 3 * (-cone.at((0, 0, self.height)) / (self.height - start) ** 3)

    def _dome(self, body: Body) -> Polynomial:
        return (X**2 + Y**2) * (self.dome / body.rim) ** 2 + below(body.top) ** 2 - self.dome**2

    def _cone(self, body: Body) -> Polynomial:
        return X**2 + Y**2 - below(body.top + self.apex) ** 2
