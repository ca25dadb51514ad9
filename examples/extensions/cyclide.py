"""A contact of one's own: a pipe along a Dupin cyclide, which bends and changes its radius as it goes.

Cyclides are the surfaces all of whose lines of curvature are circles (Dupin 1822); CAD programs use them as elbows
between pipes of two radii (Pratt 1990).  With the axes x along the arm and z along the axis of the bend,

    (|w|^2 + b^2 - d^2)^2 = 4 (a x - c d)^2 + 4 b^2 y^2,    b^2 = a^2 - c^2,

cuts the plane y = 0 in circles of radius d - c at x = a and d + c at x = -a.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import pas
from pas.contacts.contact import CONTACTS, Movable


@CONTACTS.register
@dataclass(frozen=True)
class Cyclide(Movable):
    """The bend whose pipe is of `radius` around `point + arm`, and of `far_radius` half a turn on.

    `axis` and `arm` are perpendicular; the blend ends in the plane that holds both, and `axis x arm` points away from
    it.  `Movable` gives the contact `translate`, `rotate` and its `rim`: fields called `point` are moved as points,
    other triples of numbers as vectors, and numbers stay.
    """

    table = "cyclides"

    axis: Any
    arm: Any
    radius: Any
    far_radius: Any
    point: Any = (0, 0, 0)

    def __post_init__(self) -> None:
        """Lists, as files have them, become tuples, so that contacts can be told apart in sets."""
        for name in ("axis", "arm", "point"):
            object.__setattr__(self, name, tuple(getattr(self, name)))

    @property
    def contact(self) -> pas.Contact:
        """The surface and its clip as polynomials."""
        w = [pas.Polynomial(v) - _exact(p) for v, p in zip("xyz", self.point, strict=True)]
        axis, arm = ([_exact(v) for v in vector] for vector in (self.axis, self.arm))
        side = [arm[i - 1] * axis[i - 2] - arm[i - 2] * axis[i - 1] for i in range(3)]
        d, c = ((_exact(self.far_radius) + sign * _exact(self.radius)) / 2 for sign in (1, -1))
        b2 = _dot(arm, arm) - c**2
        surface = (_dot(w, w) + b2 - d**2) ** 2 - 4 * (_dot(w, arm) - c * d) ** 2
        surface = surface - 4 * b2 * _dot(w, side) ** 2 / _dot(side, side)
        return pas.Contact(surface, _dot(w, side), near=[_exact(p) + a for p, a in zip(self.point, arm, strict=True)])


def _exact(number: Any) -> Fraction:
    return Fraction(str(number))  # of texts, numbers of Python and those of the program


def _dot(left: Any, right: Any) -> Any:
    return sum(a * b for a, b in zip(left, right, strict=True))
