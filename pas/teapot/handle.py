"""The handle: a quartic fitted in the ideal of its joints (paper), or a loop with fillets (better)."""

from __future__ import annotations

from fractions import Fraction
from math import cos, pi, sin
from typing import Any

from pas.algebra.polynomial import Polynomial
from pas.errors import GeometryError
from pas.partition.single_cell import SingleCell
from pas.pipeline.space import solutions
from pas.solid.solid import Solid, patch
from pas.teapot.body import LOWER, upper

UPPER_END, LOWER_END = Polynomial("2*x - z + 323/100"), Polynomial("2*x + z + 321/100")
"""Planes in which the paper's handle meets the upper and the lower body."""

MIDDLE = Fraction(1, 10)
"""The height of the middle of the handle."""

REACH, HALF, THICKNESS = Fraction(17, 20), Fraction(11, 20), Fraction(11, 100)
"""Of the handle's centre line: how far it stands out, half its height; and its radius."""

AROUND, ALONG, DIGITS = 10, 13, 9
START = Polynomial("x + 8/5")
"""The plane in which the loop of the better handle becomes two straight tubes."""

STRETCH = Fraction(5, 6)
TUBE_SIDE, BODY_SIDE = Fraction(1, 25), Fraction(3, 20)
"""How far the fillets reach, as values of the tube's polynomial and of the body's."""


def paper(size: Fraction) -> Polynomial:
    """The quartic that holds the curves of both ends, at the least mean squared distance from a bent tube."""
    contacts = [(upper(), UPPER_END), (LOWER, LOWER_END)]
    space = solutions(contacts, order=0, degree=4, partition=SingleCell())
    even = space.restricted([m[0] for m in space.basis if all(e[1] % 2 == 0 for e in m[0].coefficients())])
    found = even.least_squares(_bent_tube(size), by_gradient=True)
    member = even.member([f"{float(c):.{DIGITS}e}" for c in found.coefficients]).polynomials[0]
    middle = (-Fraction(29, 20) - REACH * size, 0, MIDDLE)
    return -member if member.at(middle) > 0 else member


def _bent_tube(size: Fraction) -> list[Any]:
    """Points on a tube around half an ellipse that starts and ends in the body."""
    reach, half, radius = float(REACH * size), float(HALF * size), float(THICKNESS)
    points = []
    for i in range(ALONG):
        t = pi * (i / (ALONG - 1) - 0.5) * 0.96
        x, z = -1.45 - reach * cos(t), float(MIDDLE) + half * sin(t)
        nx, nz = -half * cos(t), reach * sin(t)
        length = (nx * nx + nz * nz) ** 0.5
        for j in range(AROUND):
            u, v = radius * cos(2 * pi * j / AROUND), radius * sin(2 * pi * j / AROUND)
            points.append((round(x + u * nx / length, 6), round(v, 6), round(z + u * nz / length, 6)))
    return points


def better(size: Fraction) -> Solid:
    """A loop, two tubes and two fillets, with their four joints and those of the fillets with the body.

    The loop is a torus stretched in x, so it meets the tubes with GC^1 where these are straight.  A
    fillet is an ellipse in the plane of (value of the body, value of the tube), tangent to both axes,
    hence of the ideals `<body, (tube - b)^2>` and `<tube, (body - a)^2>`.
    """
    half = HALF * size
    if not Fraction(24, 25) <= size <= Fraction(6, 5):
        raise GeometryError(
            f"the joint of handle and upper body cannot be made with handle_size {size}: for sizes from 24/25 to 6/5 "
            "the upper fillet stays between the seam of the body and the lid"
        )
    x, y, z = (Polynomial(v) for v in "xyz")
    flat = ((x + Fraction(8, 5)) * STRETCH) ** 2 + (z - MIDDLE) ** 2
    loop = (flat + y**2 + half**2 - THICKNESS**2) ** 2 - flat * (4 * half**2)
    result = patch("handle loop", loop, -START)
    for name, body, body_name, height in (
        ("upper", upper(), "body upper", MIDDLE + half),
        ("lower", LOWER, "body lower", MIDDLE - half),
    ):
        tube = y**2 + (z - height) ** 2 - THICKNESS**2
        a, b = body / BODY_SIDE, tube / TUBE_SIDE
        fillet = -((a - 1) ** 2) - (b - 1) ** 2 + 1
        result |= patch(f"handle {name} tube", tube, START, -x, body)
        result |= patch(f"handle {name} fillet", fillet, body, tube, -(a + b - 1), -x)
        result = result.joined("handle loop", f"handle {name} tube", (tube, START), 1)
        result = result.joined(f"handle {name} tube", f"handle {name} fillet", (tube, body - BODY_SIDE), 1)
        result |= patch(body_name, body, -x, "2/5 - z" if name == "lower" else "z - 2/5", "z + 4/5", "1 - z")
        result = result.joined(body_name, f"handle {name} fillet", (body, tube - TUBE_SIDE), 1)
    return result
