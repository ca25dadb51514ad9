"""The centre of a node: the point next to the lines that go through its contacts' curves; of a bend, further inside."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.lengths import unit
from pas.algebra.rational import Vector, cross, dot, to_float, to_floats
from pas.contacts.rims import Rim
from pas.layouts.seen import power_of_two

ROUNDED = 32
"""Parts of the smallest radius to which a centre is rounded: an axis may miss it, and short numbers keep the algebra
short."""

LONG = 24
"""Binary digits up to which a point on all axes is kept as it is."""

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
    towards = min(TOWARDS_BEND * arc / (2 * cosine), INSIDE * radius) * (first + second) / to_float(step)
    x, y, z = (c + fmpq(round(float(v))) * step for c, v in zip(middle, towards, strict=True))
    return x, y, z


def center_of(rims: Sequence[Rim]) -> Vector:
    """The point with the least sum of squared distances to the lines across all rims through their centres.

    Of several, as for rims on one line, the one next to the middle of these.  It is exact where it lies on all lines,
    else rounded.
    """
    count = len(rims)
    middle = tuple(sum((rim.center[i] for rim in rims), fmpq(0)) / count for i in range(3))
    matrix, right = fmpq_mat(3, 3), [fmpq(0)] * 3
    for rim in rims:
        n, length2 = rim.normal, dot(rim.normal, rim.normal)
        off = [c - m for c, m in zip(rim.center, middle, strict=True)]
        along = dot(n, off) / length2
        for i in range(3):
            right[i] += off[i] - along * n[i]
            for j in range(3):
                matrix[i, j] += (fmpq(i == j)) - n[i] * n[j] / length2
    # the shortest solution of M x = r for a symmetric M is M y with M^2 y = r
    augmented = fmpq_mat(3, 4, [v for i in range(3) for v in (*((matrix * matrix)[i, j] for j in range(3)), right[i])])
    reduced, rank = augmented.rref()
    y = [fmpq(0)] * 3
    for row in range(rank):
        lead = next(j for j in range(4) if reduced[row, j] != 0)
        y[lead] = reduced[row, 3]
    found = [m + sum((matrix[i, j] * y[j] for j in range(3)), fmpq(0)) for i, m in enumerate(middle)]
    if max(int(v.q).bit_length() for v in found) <= LONG and all(_on_line(found, rim) for rim in rims):
        return found[0], found[1], found[2]
    step = power_of_two(min(rim.radii[0] for rim in rims) / ROUNDED)
    x, y_, z = (fmpq(round(to_float(v / step))) * step for v in found)
    return x, y_, z


def _on_line(point: Sequence[fmpq], rim: Rim) -> bool:
    off = [p - c for p, c in zip(point, rim.center, strict=True)]
    n = rim.normal
    return off[0] * n[1] == off[1] * n[0] and off[1] * n[2] == off[2] * n[1] and off[0] * n[2] == off[2] * n[0]
