"""Planes that are the end of two parts of a solid and no boundary, as where two cones stand base on base.

Near the curve of the base three functions vanish, the two faces' and the plane's, and the plane matters from both
sides.  But where the faces have one curve on it and the set has the same side of both, it does not end on the plane.
"""

from __future__ import annotations

import numpy as np

from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.solid.program import Program
from pas.solid.tree import Bools

MOST = 2000
"""Cubes that are looked at one by one."""


class PlanesInside:
    """Which planes of a program are no boundary in cubes; what is known of functions on planes is kept."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self._same: dict[tuple[int, int, int], bool] = {}

    def hidden(self, yes: Bools, no: Bools, below: Bools, above: Bools) -> Bools:
        """The planes (M, N) that matter from both sides in cubes and are no boundary there.

        `yes` and `no` say where columns are certainly <= 0 and > 0, `below` and `above` from which sides they matter.
        """
        both, matter = below & above, below | above
        result = np.zeros_like(both)
        cubes = np.flatnonzero((both.sum(axis=0) == 1) & (matter.sum(axis=0) == 3))
        for cube in cubes[:MOST].tolist():
            plane = int(both[:, cube].argmax())
            a, b = (int(i) for i in np.flatnonzero(matter[:, cube]) if i != plane)
            result[plane, cube] = self._same_on(plane, a, b) and self._passes(yes[:, cube], no[:, cube], plane, (a, b))
        return result

    def _passes(self, yes: Bools, no: Bools, plane: int, pair: tuple[int, int]) -> bool:
        """Whether the tree is the same on both sides of a plane, where two columns have the same sign."""
        signs = np.repeat(yes[:, None], 4, axis=1), np.repeat(no[:, None], 4, axis=1)
        for table, side in zip(signs, (True, False), strict=True):
            table[plane] = np.array([side, not side, side, not side])
            table[list(pair)] = np.array([side, side, not side, not side])
        holds = self.program.holds(*signs)
        return bool(holds[0] == holds[1] and holds[2] == holds[3])

    def _same_on(self, plane: int, a: int, b: int) -> bool:
        """Whether two columns are positive multiples of one another on a plane."""
        key = plane, a, b
        if key not in self._same:
            found = [self.program.columns[i].function for i in key]
            known = [p for p in found if isinstance(p, Polynomial)]
            self._same[key] = len(known) == 3 and known[0].degree == 1 and multiples(*known)
        return self._same[key]


def multiples(plane: Polynomial, first: Polynomial, second: Polynomial) -> bool:
    """Whether two polynomials are positive multiples of one another on a plane, and not 0; exact."""
    slopes = [plane.diff(i).raw for i in range(3)]
    axis = next(i for i, slope in enumerate(slopes) if not slope.is_zero())
    coordinates = [Polynomial.from_raw(g) for g in GENERATORS]
    coordinates[axis] = Polynomial.from_raw(GENERATORS[axis] - plane.raw / slopes[axis].leading_coefficient())
    f, g = (p.compose(*coordinates).raw for p in (first, second))
    if f.is_zero() or g.is_zero():
        return False
    a, b = f.leading_coefficient(), g.leading_coefficient()
    return bool((f * b - g * a).is_zero() and a * b > 0)
