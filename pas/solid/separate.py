"""Solids whose boundary is made of surfaces that do not meet, such as a hollow's inside and outside: one by one.

Where a wall is thin, a lattice that shows both its sides at once is as fine as the wall; each side by itself is as
coarse as it bends.  That two surfaces are apart is proved: of every cube that both may pass, either f - m g, with m
such that the gradients cancel, has one sign in it, so that f and g do not vanish together, or its eighths are apart.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.errors import GeometryError
from pas.limits import checkpoint
from pas.solid.bank import Bank
from pas.solid.bounds import bounding_box
from pas.solid.program import Program
from pas.solid.tree import Node, Tree, combined, complement

LEVELS, MOST = 14, 20_000
"""How often cubes are halved, and how many may be left on the way."""

MOST_PARTS = 8
"""Parts of an intersection that are tried one by one."""


def cavities(tree: Tree, box: Floats) -> list[tuple[Tree, Tree]]:
    """The parts of an intersection whose complements lie within a box (2, 3), each with the others' intersection."""
    if not isinstance(tree, Node) or tree.union or not 1 < len(tree.parts) <= MOST_PARTS:
        return []
    result = []
    for part in tree.parts:
        try:
            inner = bounding_box(complement(part))
        except GeometryError:
            continue
        if (inner[0] >= box[0]).all() and (inner[1] <= box[1]).all():
            result.append((part, combined(False, *(other for other in tree.parts if other is not part))))
    return result


def apart(first: Program, second: Program, box: Floats) -> bool:
    """Whether the boundaries of two sets, compiled in the same coordinates, do not meet in a box (2, 3).

    False where that is not shown.
    """
    centers, half = box.mean(axis=0)[None], np.ptp(box, axis=0) / 2 * (1 + 1e-9)
    for _ in range(LEVELS):
        checkpoint(f"telling surfaces apart ({len(centers)} cubes)")
        centers = centers[_may_meet(first, second, centers, half[None])]
        if not len(centers):
            return True
        if len(centers) > MOST:
            break
        half = half / 2
        centers = np.concatenate([centers + half * np.array(side) for side in product((-1, 1), repeat=3)])
    return False


def _may_meet(first: Program, second: Program, centers: Floats, half: Floats) -> NDArray[np.bool_]:
    """Whether both boundaries may pass cubes, at points in common (N,)."""
    matters = []
    for program in (first, second):
        yes, no = program.taylor(centers, half)
        true, false = program.decided(yes, no)
        matters.append(np.logical_or(*program.relevant(yes, no)) & ~(true | false))
    result = np.zeros(len(centers), dtype=bool)
    for i, j in product(*(np.flatnonzero(m.any(axis=1)) for m in matters)):
        rows = np.flatnonzero(matters[0][i] & matters[1][j] & ~result)
        pair = [program.polynomial(int(k)) for program, k in ((first, i), (second, j))]
        if any(p is None for p in pair):
            result[rows] = True
        elif len(rows):
            result[rows] = ~Bank([p for p in pair if p is not None]).never_both(centers[rows], half)
    return result
