"""How often an oriented mesh is crossed, with sign, on the way from one point to others, rounding counted.

A segment from 0 to p crosses a triangle a, b, d where det(p, a, b), det(p, b, d) and det(p, d, a) have one sign, at the
share det(a, b, d) over their sum.  Each is known to `SURE` times the lengths of its rows; what is not surely crossed
nor surely missed makes the number of p unknown.
"""

from __future__ import annotations

import numpy as np

from pas.algebra.monomials import Floats
from pas.kernels.library import compiled
from pas.mesh.field import Integers
from pas.mesh.rows import cross, dots, norms

SURE = 2.0**-46
"""Determinants over the product of their rows' lengths are wrong by less: by some dozen roundings."""

GRAZING = 1e-9
"""By which cosines of angles may be wrong without a triangle being missed."""


def crossed(points: Floats, triangles: Integers, origin: Floats, ends: Floats) -> tuple[Integers, np.ndarray]:
    """How often segments from `origin` (3,) to `ends` (E, 3) leave through triangles more than they enter.

    Also for which ends (E,) that is known.
    """
    ways = ends - origin
    towards = ways / np.maximum(norms(ways), 1e-300)[:, None]
    times, known = np.empty(len(ways), dtype=np.intp), np.empty(len(ways), dtype=np.bool_)
    given = (len(triangles), triangles, points, origin, len(ways), ways, towards, GRAZING, SURE)
    compiled().call("pas_crossed", *given, times, known)
    return times, known


def volumes(corners: Floats) -> tuple[Floats, Floats]:
    """The determinants (T,) of triangles (T, 3, 3), positive where they are seen from 0 with their outside away, and by
    how much each may be off."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return dots(a, cross(b, c)), SURE * np.sqrt(dots(a, a) * dots(b, b) * dots(c, c))
