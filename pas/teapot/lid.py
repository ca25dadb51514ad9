"""The lid: a flat ellipsoid that flows with GC^2 through a quartic into a cubic knob."""

from __future__ import annotations

from fractions import Fraction

from pas.algebra.polynomial import Polynomial
from pas.errors import GeometryError
from pas.solid.solid import Solid, patch
from pas.surface.contact import Contact, contact_ideal

DOME = Polynomial("(x^2 + y^2)/121 + (z - 1)^2 - 1/100")
CONE = Polynomial("x^2 + y^2 - (z - 11/10)^2")
DOME_END, KNOB_START = Polynomial("z - 109/100"), Polynomial("z - 6/5")
INSIDE, OUTSIDE = ((0, 0, 1.09), (0, 0, 1.15), (0, 0, 1.2)), ((0.6, 0, 1.09), (0.5, 0, 1.15), (0.5, 0, 1.2))
"""Points on the axis of the lid's blend, and points around it."""

RIM = (Polynomial("x^2 + y^2 - 121/100"), Polynomial("z - 1"))
"""The circle in which the lid lies on the body."""


def blend() -> Polynomial:
    """The quartic that meets the dome and the cone with GC^2.

    The ideal of all such surfaces has three generators in its graded Groebner basis, each of degree
    4.  Wanted is one of degree 2 in x and y, which has one radius at each height, so one sheet, that
    keeps inside where the dome and the cone have it.
    """
    ideal = contact_ideal(Contact(DOME, DOME_END), 2) & contact_ideal(Contact(CONE, KNOB_START), 2)
    for generator in ideal.groebner_basis():
        if max(e[0] for e in generator.coefficients()) == 2:
            for member in (generator, -generator):
                if all(member(p) < 0 for p in INSIDE) and all(member(p) > 0 for p in OUTSIDE):
                    return member
    raise GeometryError("the joints of the lid cannot be made: no generator of its ideal has a single sheet")


def knob(height: Fraction) -> Polynomial:
    """The cubic `cone + a (z - 6/5)^3` that ends at the given height: GC^2 with the cone for every a."""
    if not Fraction(13, 10) <= height <= Fraction(8, 5):
        raise GeometryError(
            f"the joint of knob and blend cannot be made with lid_height {height}: the knob starts at 6/5, and is "
            "one sheet above it for heights from 13/10 to 8/5"
        )
    a = -CONE.at((0, 0, height)) / (height - Fraction(6, 5)) ** 3
    return CONE + KNOB_START**3 * a


def lid(height: Fraction) -> Solid:
    """The lid down to the plane z = 1, with its two joints."""
    top = Polynomial({(0, 0, 0): height, (0, 0, 1): -1})
    solid = patch("lid knob", knob(height), KNOB_START, top)
    solid |= patch("lid blend", blend(), DOME_END, -KNOB_START)
    solid |= patch("lid dome", DOME, RIM[1], -DOME_END)
    return solid.joined("lid knob", "lid blend", (CONE, KNOB_START), 2).joined(
        "lid blend", "lid dome", (DOME, DOME_END), 2
    )
