"""The body: two quadrics that meet with GC^1 where it is widest, on a flat bottom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import sqrt

import numpy as np

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Exact
from pas.designs.exact import Design, points
from pas.errors import GeometryError, warn
from pas.solid.solid import Solid, patch

X, Y, Z = map(Polynomial.from_raw, GENERATORS)


def below(height: Fraction) -> Polynomial:
    """The polynomial `height - z`, which is positive below."""
    return Polynomial(height) - Z


def filleted(
    solid: Solid,
    names: tuple[str, str, str],
    surfaces: tuple[Polynomial, Polynomial],
    sides: tuple[Fraction, Fraction],
    *walls: Polynomial,
) -> Solid:
    """The solid with a fillet between its body and a tube that stands on it, within walls, and its two joints.

    The fillet is an ellipse in the plane of the `surfaces`' values, tangent to both axes at `sides`: it is of the
    ideals `<body, (tube - b)^2>` and `<tube, (body - a)^2>`, hence meets both with GC^1.  The `names` are those of the
    body, the tube and the fillet.
    """
    (body, tube), (base, tip, name) = surfaces, names
    a, b = body / sides[0], tube / sides[1]
    solid |= patch(name, -((a - 1) ** 2) - (b - 1) ** 2 + 1, body, tube, -(a + b - 1), *walls)
    solid = solid.joined(tip, name, (tube, body - sides[0]), 1)
    return solid.joined(base, name, (body, tube - sides[1]), 1)


@dataclass(frozen=True, repr=False)
class Body(Design):
    """A surface of revolution about the z axis, of `lower` and, above the seam, another quadric.

    All numbers and polynomials are exact, heights and radii in the model's units.  Raises `GeometryError` for the joint
    that cannot be made.
    """

    lower: Polynomial = Polynomial("4/9*(x^2 + y^2) + 25/36*z^2 - 1")
    """The lower quadric, negative inside."""

    seam: Fraction = Fraction(2, 5)
    bottom: Fraction = Fraction(-4, 5)
    top: Fraction = Fraction(1)
    """Heights where the quadrics meet, of the flat bottom, and of the lid's rim."""

    rim: Fraction = Fraction(11, 10)
    """The radius of the lid's rim."""

    wall: Fraction = Fraction(1, 5)
    floor: Fraction = Fraction(1, 10)
    """Thickness of the hollow pot's walls, as a value of the body's polynomials, and of its floor."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.bottom < self.seam < self.top:
            raise GeometryError(
                f"the joint of lower and upper body cannot be made: its seam must be between the bottom at "
                f"{self.bottom} and the top at {self.top}, not at {self.seam}"
            )
        for surface, height, name in (
            (self.lower, self.bottom, "lower"),
            (self.lower, self.seam, "lower"),
            (self.upper, self.top, "upper"),
        ):
            if surface.at((0, 0, height)) >= 0:
                raise GeometryError(
                    f"the joint of lower and upper body cannot be made: the {name} quadric {surface} must be negative "
                    f"on the axis at height {height}"
                )
        if self.rim <= 0:
            raise GeometryError(f"the joint of lid and body cannot be made: rim must be positive, not {self.rim}")

    @cached_property
    def upper(self) -> Polynomial:
        """`lower + a (z - seam)^2`, which meets the lower quadric with GC^1, through the rim of the lid."""
        seam = -below(self.seam)
        rim_point = (self.rim, 0, self.top)
        return self.lower + seam**2 * (-self.lower.at(rim_point) / seam.at(rim_point) ** 2)

    @property
    def opening(self) -> float:
        """The radius of the hollow pot's opening, in the plane of the rim."""
        return self._radius(self.top, self.wall)

    @property
    def rim_curve(self) -> tuple[Polynomial, Polynomial]:
        """The circle in which the lid lies on the body, as the cylinder and the plane that it is on."""
        return X**2 + Y**2 - self.rim**2, -below(self.top)

    def solid(self, upper_walls: tuple[Polynomial, ...], lower_walls: tuple[Polynomial, ...]) -> Solid:
        """The two patches with their joint, each within walls where others continue it."""
        solid = patch("body upper", self.upper, -below(self.seam), below(self.top), *upper_walls)
        solid |= patch("body lower", self.lower, -below(self.bottom), below(self.seam), *lower_walls)
        return solid.joined("body upper", "body lower", (self.lower, -below(self.seam)), 1)

    @classmethod
    def through(cls, profile: Sequence[Sequence[Exact]], **others: Exact) -> Body:
        """The body whose lower quadric `a r^2 + b z^2 + c z = 1` is nearest to points (radius, height) of a profile.

        Least in squares is the equation's error, and the coefficients have six digits.  `others` are the other fields:
        the upper quadric is given by the seam, the top and the rim.  Warns (`UserWarning`) where the body is further
        than a twentieth of its width from a point.  Raises `ValueError` or `TypeError` for what are no
        points, `GeometryError` where they determine no quadric or the body cannot be made.
        """
        given = points(*profile)
        rows = np.array([(float(r) ** 2, float(z) ** 2, float(z)) for r, z in given])
        found, _, rank, _ = np.linalg.lstsq(rows, np.ones(len(rows)), rcond=None)
        if rank < rows.shape[1]:
            raise GeometryError("the profile must have at least three points (radius, height) that determine a quadric")
        a, b, c = (f"{value:.6f}" for value in found)
        made = cls(Polynomial(f"{a}*(x^2 + y^2) + {b}*z^2 + {c}*z - 1"), **others)  # type: ignore[arg-type]
        off, at = max((abs(made._radius(z) - float(r)), (r, z)) for r, z in given)
        if off > max(rows[:, 0]) ** 0.5 / 20:
            warn(
                f"the body is {off:.2g} away from the point ({float(at[0]):g}, {float(at[1]):g}) of its profile: it is "
                f"of two quadrics, which have no waist and are widest once; another seam, top or rim may be nearer"
            )
        return made

    def _radius(self, height: Fraction, depth: Fraction = Fraction(0)) -> float:
        """The radius at a height, within a wall as thick as a value of the polynomials; 0 where nothing is there."""
        surface = self.lower if height <= self.seam else self.upper
        slope = self.lower.at((1, 0, 0)) - self.lower.at((0, 0, 0))
        square = -(surface.at((0, 0, height)) + depth) / slope
        return sqrt(square) if square > 0 else 0.0

    def room(self) -> Solid:
        """The room inside: level sets of the body's own polynomials, which keep their joint."""
        above, floor = below(self.top + self.wall), -below(self.bottom + self.floor)
        seam = -below(self.seam)
        room = patch("inner upper", self.upper + self.wall, seam, above)
        room |= patch("inner lower", self.lower + self.wall, floor, -seam).cap(-floor, "inner floor")
        return room.joined("inner upper", "inner lower", (self.lower + self.wall, seam), 1)
