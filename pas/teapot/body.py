"""The body: two quadrics that meet with GC^1 where it is widest, on a flat bottom."""

from __future__ import annotations

from fractions import Fraction

from pas.algebra.polynomial import Polynomial

LOWER = Polynomial("4/9*(x^2 + y^2) + 25/36*z^2 - 1")
SEAM, BOTTOM, TOP = Polynomial("z - 2/5"), Polynomial("z + 4/5"), Polynomial("1 - z")
RIM_POINT = (Fraction(11, 10), 0, 1)
"""A point of the lid's rim, through which the upper quadric passes."""


def upper() -> Polynomial:
    """`lower + a (z - 2/5)^2`, which meets the lower quadric with GC^1, through the rim of the lid."""
    a = -LOWER.at(RIM_POINT) / SEAM.at(RIM_POINT) ** 2
    return LOWER + SEAM**2 * a
