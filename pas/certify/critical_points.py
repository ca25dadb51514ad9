"""Parts of simplices that hold all critical points of a polynomial, on each of which it has a sign.

A simplex is settled when the derivative along some direction in it has B-coefficients of one sign, and kept when the
polynomial itself has and the simplex is free of what must not be in it; any other is halved (see
`pas.bernstein.simplices.Simplices.rising`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pas.algebra.monomials import Floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.search import Fate, Fates, Limits, Searched, search
from pas.bernstein.simplices import Simplices

LIMITS = Limits(depth=150, cells=6000)
"""Of what is critical on more simplices than these, such as along a curve, nothing can be counted."""


@dataclass(frozen=True)
class CriticalParts:
    """Simplices (R, d + 1, 3) with the sign (R,) of the polynomial on each, and the middles (U, 3) of those left open:
    all critical points are in one of them.  `examined` counts the simplices that were."""

    simplices: Floats
    signs: Floats
    open: Floats
    examined: int


Free = Callable[[Floats, Floats], np.ndarray]
"""Says which simplices (N, d + 1, 3), on which the polynomial's size is at least (N,), are free of what must not be
in them."""


def isolated(forms: Floats, corners: Floats, error: float = UNIT_ROUNDOFF) -> Searched[Simplices]:
    """Critical points on simplices (N, d + 1, 3) of B-coefficients (N, m), at most 1 in size, each off by `error`: the
    simplices that are kept have coefficients of one sign."""
    cells = Simplices.of([forms], corners, error)
    return search(cells, lambda some, _: some.rising(), Simplices.halved, _limits(cells), "looking for critical points")


def critical_parts(found: Searched[Simplices], free: Free) -> CriticalParts:
    """Those of some simplices that were kept which are free, or parts of these where they are not."""

    def judge(cells: Simplices, _: int) -> Fates:
        fates = cells.rising()
        rows = np.flatnonzero(fates != Fate.SETTLED)
        form = cells.table[rows]
        least = np.maximum(form.min(axis=1), -form.max(axis=1)) - cells.bound
        sure = free(least, cells.corners[rows])
        fates[rows[sure]], fates[rows[~sure & (fates[rows] == Fate.KEEP)]] = Fate.KEEP, Fate.SPLIT
        return fates

    result = search(found.kept, judge, Simplices.halved, _limits(found.kept), "looking for critical points")
    signs, middles = np.sign(result.kept.table[:, 0]), result.open.corners.mean(axis=1)
    return CriticalParts(result.kept.corners, signs, middles, found.examined + result.examined)


def _limits(cells: Simplices) -> Limits:
    """A point is not halved."""
    return replace(LIMITS, depth=LIMITS.depth - cells.halvings if cells.corners.shape[1] > 1 else 0)
