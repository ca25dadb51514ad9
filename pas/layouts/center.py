"""The centre of a node: the point next to the lines that go through its contacts' curves; of a bend, further inside."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.lengths import unit
from pas.algebra.rational import Vector, cross, dot, minus, to_float, to_floats
from pas.contacts.rims import Rim
from pas.layouts.discs import power_of_two, rounded

ROUNDED = 32
"""Parts of the smallest radius to which a centre is rounded: an axis may miss it, and short numbers keep the algebra
short."""

LONG = 24
"""Binary digits up to which a point on all axes is kept as it is."""

UNIT = fmpq_mat(3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1])

TOWARDS_BEND, INSIDE, FINE = 0.45, 0.266, 64
"""How far the centre of a bend lies towards the middle of the arc that fits between its curves, as a share of that; at
most so many smaller radii towards either; and parts of that radius to which it is rounded.

The tube turns away from where its lines meet.  Around that point a right bend of GC^2 (clips 2 radii away) is 0.072
radii off the tube that is rolled round and its sharpness 1.25, here 0.043 and 1.08; at 60 degrees it is half as far off
as there; walls of hollow bends become even.  Much farther, the surface hollows inside."""


def center_of_bend(rims: Sequence[Rim]) -> Vector | None:
    """A better centre for two rims whose lines are not parallel; None for others."""
    if len(rims) != 2 or not any(cross(rims[0].normal, rims[1].normal)):
        return None
    radius = min(rim.radii[0] for rim in rims)
    middle = center_of(rims)
    first, second = (unit(to_floats(rim.normal)) for rim in rims)
    clip = min(float(np.linalg.norm(to_floats(rim.center) - np.array(to_floats(middle)))) for rim in rims)
    cosine = float(np.linalg.norm(first + second)) / 2  # of half of the angle between them
    arc = clip * (1 - sqrt(max(0.0, 1 - cosine**2))) / cosine
    step = power_of_two(radius / FINE)
    inwards = rounded(min(TOWARDS_BEND * arc / (2 * cosine), INSIDE * radius) * (first + second), step)
    return middle[0] + inwards[0], middle[1] + inwards[1], middle[2] + inwards[2]


def center_of(rims: Sequence[Rim]) -> Vector:
    """The point with the least sum of squared distances to the lines across all rims through their centres.

    Of several, as for rims on one line, the one next to the middle of these.  It is exact where it lies on all lines,
    else rounded.
    """
    middle = tuple(sum((rim.center[i] for rim in rims), fmpq(0)) / len(rims) for i in range(3))
    matrix, right = fmpq_mat(3, 3), fmpq_mat(3, 1)
    for rim in rims:
        normal = fmpq_mat(3, 1, list(rim.normal))
        across = UNIT - normal * normal.transpose() * (1 / dot(rim.normal, rim.normal))  # the projection along the line
        matrix += across
        right += across * fmpq_mat(3, 1, [c - m for c, m in zip(rim.center, middle, strict=True)])
    # the shortest solution of M x = r for a symmetric M is M y with M^2 y = r
    square = matrix * matrix
    augmented = fmpq_mat([[*row, value] for row, value in zip(square.tolist(), right.entries(), strict=True)])
    reduced, rank = augmented.rref()
    y = fmpq_mat(3, 1)
    for row in range(rank):
        lead = next(j for j in range(4) if reduced[row, j] != 0)
        y[lead, 0] = reduced[row, 3]
    found = [m + offset for m, offset in zip(middle, (matrix * y).entries(), strict=True)]
    if max(int(v.q).bit_length() for v in found) <= LONG and all(_on_line(found, rim) for rim in rims):
        return found[0], found[1], found[2]
    step = power_of_two(min(rim.radii[0] for rim in rims) / ROUNDED)
    x, y_, z = (fmpq(round(to_float(v / step))) * step for v in found)
    return x, y_, z


def _on_line(point: Sequence[fmpq], rim: Rim) -> bool:
    return not any(cross(minus(point, rim.center), rim.normal))
