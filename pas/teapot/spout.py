"""The spout: two cubics, fitted by least squares inside the ideals of their joints."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import rational
from pas.errors import GeometryError
from pas.fairing.energies.thin_plate import ThinPlate
from pas.fairing.quadrature import Box
from pas.fairing.wishes import ValueAt
from pas.partition.single_cell import SingleCell
from pas.pipeline.space import SolutionSpace, solutions
from pas.teapot.body import LOWER

ROOT, BEND = Polynomial("13 - 9*x + 2*z"), Polynomial("48 - 15*x - 40*z")
"""Planes where the spout leaves the body, and where its two patches meet."""

WAIST = Polynomial("(z - 8/3*(x - 2))^2 + 8*y^2 - 2/9")
"""The elliptic cylinder that cuts the spout's outline in the plane of the bend (paper)."""

LOWER_POINTS = ((1.6, 0.15), (1.8, 0.2), (1.7, 0.17), (1.9, 0.25), (1.5, -0.54), (2.2, 0.05), (1.7, -0.45),
                (1.9, -0.33), (2.1, -0.1))  # fmt: skip
UPPER_POINTS = ((2.4, 0.55), (2.6, 0.85), (2.8, 1.01), (3.0, 1.1), (2.1, 0.67), (2.2, 0.85), (2.4, 1.02), (2.65, 1.1),
                (2.2, 0.85), (2.4, 1.02))  # fmt: skip
"""Points (x, z) of the outline in the plane y = 0, as published; two occur twice."""

SLIM_LOWER_POINTS = ((1.62, 0.29), (1.72, 0.36), (1.82, 0.43), (1.9, 0.49), (1.5, -0.44), (1.7, -0.27), (1.9, -0.02),
                     (2.05, 0.2), (2.16, 0.39))  # fmt: skip
SLIM_UPPER_POINTS = ((2.24, 0.55), (2.33, 0.75), (2.43, 0.95), (2.52, 1.1), (1.99, 0.65), (2.11, 0.85), (2.22, 1.0),
                     (2.3, 1.1))  # fmt: skip
"""Points (x, z) of a slimmer outline, for the spout that is joined smoothly."""

LOWER_SIDES = ((1.5, 0.35, -0.2), (1.7, 0.25, 0.05), (1.85, 0.2, 0.25), (2.0, 0.17, 0.4))
UPPER_SIDES = ((2.15, 0.15, 0.65), (2.28, 0.13, 0.85), (2.4, 0.12, 1.1))
"""Points (x, +-y, z) that tell how wide it is."""

ON_OUTLINE, ON_SIDES, BEYOND = 1, 4, Fraction(1, 5)
"""Weights of the lower patch's points: of its outline, its sides, and of the upper patch's points, which
keep it going in the right direction."""

INSIDE = (2, 0, Fraction(9, 20))
"""A point inside the spout in the plane of the bend, where each member is a multiple of the contact: a
value there keeps the multiple from vanishing."""

AT_ROOT, DEPTH = ("7/5", 0, "-1/5"), 20
"""A point of the root's plane inside the body, where a cubic must be inside too."""

MIDDLE = ("33/20", 0, 0)
"""A point in the middle of the lower patch."""

DIGITS = 9
"""Kept of fitted coefficients: any member with rational coefficients keeps its joints."""


FAIRNESS = Fraction(1, 2000)
"""Weight of the thin-plate energy beside the squared values at the points."""

PART_BOX = Box((Fraction(6, 5), Fraction(-3, 10), Fraction(-3, 5)), (3, Fraction(3, 10), Fraction(11, 10)))
"""Where the energy is taken."""


def _even(contacts: list[Any], order: int) -> SolutionSpace:
    """The cubics that meet the contacts and are even in y."""
    space = solutions(contacts, order=order, degree=3, partition=SingleCell())
    return space.restricted([m[0] for m in space.basis if all(e[1] % 2 == 0 for e in m[0].coefficients())])


def continued(contacts: list[Any], order: int, points: Any, inside: Any = ()) -> Polynomial:
    """The cubic that meets the contacts, is -1 at a point inside and least in squares at the given points.

    At points `inside` it is below 0 by `DEPTH`.  The thin-plate energy has a small part in what is minimised.
    """
    space = _even(contacts, order)
    best = space.optimum(
        ThinPlate(PART_BOX, weight=rational(FAIRNESS)), near=points, near_weight=1, inside=inside, margin=DEPTH,
        normalize=ValueAt(INSIDE, -1),
    )  # fmt: skip
    return _rounded(space, best.coefficients)


def closest(contacts: list[Any], order: int, points: Any, weights: Any) -> Polynomial:
    """The cubic that meets the contacts at the least mean squared distance from the given points."""
    space = _even(contacts, order)
    member = _rounded(space, space.least_squares(points, weights, by_gradient=True).coefficients)
    return -member if member.at(MIDDLE) > 0 else member


def _rounded(space: SolutionSpace, coefficients: Any) -> Polynomial:
    return space.member([f"{float(c):.{DIGITS}e}" for c in coefficients]).polynomials[0]


def paper(tilt: Fraction) -> tuple[Polynomial, Polynomial]:
    """Both cubics as published: GC^0 with the body, GC^1 with one another."""
    lower = continued([(LOWER, ROOT), (WAIST, BEND)], 0, _outline(LOWER_POINTS), [AT_ROOT])
    return lower, continued([(lower, BEND)], 1, _outline(UPPER_POINTS, tilt))


def better(tilt: Fraction) -> tuple[Polynomial, Polynomial]:
    """Both cubics with GC^1 at the body as well."""
    return _joined(LOWER, _design(tilt))


def _design(tilt: Fraction) -> tuple[list[Any], list[Any], list[Any]]:
    """The points of the lower outline, of the lower sides, and of the upper patch."""
    upper = _outline(SLIM_UPPER_POINTS, tilt) + _sides(UPPER_SIDES, tilt)
    return _outline(SLIM_LOWER_POINTS), _sides(LOWER_SIDES), upper


def _joined(body: Polynomial, design: Any) -> tuple[Polynomial, Polynomial]:
    outline, sides, beyond = design
    weights = [ON_OUTLINE] * len(outline) + [ON_SIDES] * len(sides) + [BEYOND] * len(beyond)
    lower = closest([(body, ROOT)], 1, outline + sides + beyond, weights)
    return lower, continued([(lower, BEND)], 1, beyond)


def _sides(points: Any, tilt: Fraction = Fraction(0)) -> list[Any]:
    """Points (x, +-y, z), leaning like those of the outline."""
    moved = _outline([(x, z) for x, _, z in points], tilt)
    return [
        (x, side * Fraction(str(y)), z) for (x, _, z), (_, y, _) in zip(moved, points, strict=True) for side in (1, -1)
    ]


def _outline(points: Any, tilt: Fraction = Fraction(0)) -> list[Any]:
    """Points (x, 0, z) of the outline, leaning outwards by `tilt` per unit of height above the bend."""
    if abs(tilt) > Fraction(1, 5):
        raise GeometryError(
            f"the joint of the two spout patches cannot be made with spout_tilt {tilt}: beyond 1/5 either way "
            "the cubic has no clean outline"
        )
    exact = [(Fraction(str(x)), Fraction(str(z))) for x, z in points]
    return [(x + tilt * (z - Fraction(1, 2)), 0, z) for x, z in exact]
