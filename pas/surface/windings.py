"""How often an oriented mesh is crossed, with sign, on the way from one point to others, rounding counted.

A segment from 0 to p crosses a triangle a, b, d where det(p, a, b), det(p, b, d) and det(p, d, a) have one sign, at the
share det(a, b, d) over their sum.  Each is known to `SURE` times the lengths of its rows; what is not surely crossed
nor surely missed makes the number of p unknown.
"""

from __future__ import annotations

import numpy as np

from pas.algebra.monomials import Floats
from pas.limits import checkpoint
from pas.mesh.field import Integers
from pas.mesh.rows import cross, dots, norms
from pas.surface.kernels import compiled

SURE = 2.0**-46
"""Determinants over the product of their rows' lengths are wrong by less: by some dozen roundings."""

ENTRIES = 1 << 22
"""Pairs of points and triangles looked at together."""

GRAZING = 1e-9
"""By which cosines of angles may be wrong without a triangle being missed."""


def crossed(points: Floats, triangles: Integers, origin: Floats, ends: Floats) -> tuple[Integers, np.ndarray]:
    """How often segments from `origin` (3,) to `ends` (E, 3) leave through triangles more than they enter.

    Also for which ends (E,) that is known.
    """
    ways = ends - origin
    towards = _units(ways)
    kernel = compiled()
    if kernel is not None:
        return kernel.crossed(points, triangles, origin, ways, towards, (GRAZING, SURE))
    corners = points[triangles] - origin
    units = [_units(corners[:, k]) for k in range(3)]
    middle = _units(units[0] + units[1] + units[2])
    cap = np.minimum.reduce([dots(unit, middle) for unit in units])
    cap = np.where(cap > 0, cap, -1.0) - GRAZING
    times, known = np.zeros(len(ends), dtype=np.intp), np.ones(len(ends), dtype=bool)
    step = max(1, ENTRIES // max(len(triangles), 1))
    for start in range(0, len(ends), step):
        checkpoint(f"counting crossings ({start} of {len(ends)} points)")
        here = slice(start, start + step)
        x, y, z = towards[here, :, None].transpose(1, 0, 2)
        row, triangle = np.nonzero(x * middle[:, 0] + y * middle[:, 1] + z * middle[:, 2] >= cap)
        sign, sure = _signs(ways[here][row], corners[triangle])
        np.add.at(times[here], row, sign)
        known[here][row[~sure]] = False
    return times, known


def _units(vectors: Floats) -> Floats:
    return vectors / np.maximum(norms(vectors), 1e-300)[:, None]


def volumes(corners: Floats) -> tuple[Floats, Floats]:
    """The determinants (T,) of triangles (T, 3, 3), positive where they are seen from 0 with their outside away, and by
    how much each may be off."""
    return _det(corners[:, 0], corners[:, 1], corners[:, 2])


def _signs(ways: Floats, corners: Floats) -> tuple[Integers, np.ndarray]:
    """For pairs (N,) of a segment from 0 and a triangle 1, -1 or 0, and whether that is sure."""
    sides, errors = [], []
    for i in range(3):
        value, error = _det(ways, corners[:, i], corners[:, (i + 1) % 3])
        sides.append(value)
        errors.append(error)
    up = [side > error for side, error in zip(sides, errors, strict=True)]
    down = [side < -error for side, error in zip(sides, errors, strict=True)]
    missed = (up[0] | up[1] | up[2]) & (down[0] | down[1] | down[2])
    all_up, all_down = up[0] & up[1] & up[2], down[0] & down[1] & down[2]
    whole, error = _det(corners[:, 0], corners[:, 1], corners[:, 2])
    sign = np.where(all_down, -1, 1)
    total, error_of_total = sign * sum(sides), sum(errors)
    behind, before = sign * whole < -error, sign * whole > error
    beyond, within = sign * whole - total > error + error_of_total, total - sign * whole > error + error_of_total
    hit = (all_up | all_down) & before & within
    sure = hit | missed | ((all_up | all_down) & (behind | beyond))
    return np.where(hit, sign, 0), sure


def _det(a: Floats, b: Floats, c: Floats) -> tuple[Floats, Floats]:
    return dots(a, cross(b, c)), SURE * np.sqrt(dots(a, a) * dots(b, b) * dots(c, c))
