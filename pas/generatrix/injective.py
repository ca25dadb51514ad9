"""A proof that an exact surface over the unit square does not cross itself.

If for two vectors a, b the symmetric part of the matrix

    ( a . P_s   a . P_t )
    ( b . P_s   b . P_t )

is positive definite on the whole (convex) square, then for two places that differ by (u, v) the number
(u a + v b) . (P - P') is the mean of this form at (u, v) along the way between them, hence positive: P != P'
(the monotone case of Gale and Nikaido 1965).  With a, b dual to the mean tangents the matrix is near the unit
matrix for surfaces that do not bend too far.  The two inequalities are proved by Bernstein branch and bound.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import fmpq

from pas.algebra.monomials import Floats
from pas.algebra.rational import exact, rational, to_float, to_fraction
from pas.algebra.rational_function import RationalFunction, total
from pas.parametric.regularity import positive_on_unit_square
from pas.parametric.surface import ParametricSurface

GRID = 5
"""Places a side at which the mean tangents are taken."""

SHORT = 64
"""Greatest denominator in a and b: any vectors near will do, and short ones keep the numbers short."""


def is_injective(surface: ParametricSurface, effort: int = 4_000) -> bool:
    """Whether it is proved that an exact surface over [0, 1]^2 takes no point twice; False says nothing.

    Each coordinate is scaled exactly by the size of its mean slopes first: that changes nothing.
    """
    along, across = ([c.diff(*order) for c in surface.components] for order in ((1, 0), (0, 1)))
    places = [fmpq(i, GRID - 1) for i in range(GRID)]
    try:
        means = [
            [sum((rational(f.at(u, v)) for u in places for v in places), fmpq(0)) / GRID**2 for f in (s, t)]
            for s, t in zip(along, across, strict=True)
        ]
    except ValueError:  # a pole
        return False
    sizes = [max(map(abs, row)) or fmpq(1) for row in means]
    tangents = np.array([[to_float(x / size) for x in row] for row, size in zip(means, sizes, strict=True)])
    duals = np.linalg.pinv(tangents)
    if not np.abs(duals).max(axis=1).min() > 0:
        return False
    first, second = ([x / size for x, size in zip(_short(row), sizes, strict=True)] for row in duals)
    a, d = _product(first, along), _product(second, across)
    mixed = _product(first, across) + _product(second, along)
    return positive_on_unit_square(a, effort) and positive_on_unit_square(4 * a * d - mixed * mixed, effort)


def _short(vector: Floats) -> list[fmpq]:
    """A rational vector near, with short numbers."""
    scale = exact(2.0 ** np.round(np.log2(np.abs(vector).max())))
    return [rational(to_fraction(exact(float(x)) / scale).limit_denominator(SHORT)) * scale for x in vector]


def _product(vector: Sequence[fmpq], functions: Sequence[RationalFunction]) -> RationalFunction:
    return total([f * x for f, x in zip(functions, vector, strict=True)])
