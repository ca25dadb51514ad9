"""Where a set of inequalities lies: a box that certainly holds it.

Linear inequalities are bounded by linear programmes; then boxes in which the set certainly has no
point are cut away, from a very large box down, until the rest is tight.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import fmpq

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.errors import GeometryError
from pas.limits import checkpoint
from pas.solid.program import Program
from pas.solid.tree import Node, Tree, is_contradiction

FARTHEST = 2.0**24
"""Coordinates beyond which a set counts as unbounded."""

LEVELS, MOST_BOXES = 160, 60_000
PARTS = 40
"""Boxes are small enough when that many halves fit into each side of their hull."""

ORIGIN = (fmpq(0), fmpq(0), fmpq(0))


def bounding_box(tree: Tree) -> Floats:
    """A box (2, 3) that holds the set.

    Raises `GeometryError` where the set is empty or extends too far to be bounded.
    """
    boxes = [box for part in _branches(tree) if (box := _branch_box(part)) is not None]
    if not boxes:
        raise GeometryError("the solid is empty: no point satisfies all of its inequalities")
    return np.stack([np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)])


def _branches(tree: Tree) -> list[Tree]:
    """Sets whose union is the set, opened up at the top only."""
    if isinstance(tree, Node) and tree.union:
        return [b for part in tree.parts for b in _branches(part)]
    return [tree]


def _branch_box(tree: Tree) -> Floats | None:
    program = Program(tree, ORIGIN, fmpq(1))
    start = None if is_contradiction(tree) or program.is_empty else _linear_box(tree)
    if start is None:
        return None
    try:
        return _shrunk(program, start)
    except GeometryError:
        within = _within_unions(tree, start)
        if (within == start).all():
            raise
        return _shrunk(program, within)


def _within_unions(tree: Tree, start: Floats) -> Floats:
    """A box that planes leave open, brought within the boxes of unions among the conditions.

    Of a union with something taken away the parts are bounded one by one, as without that.
    """
    for part in tree.parts if isinstance(tree, Node) else ():
        if not (isinstance(part, Node) and part.union):
            continue
        try:
            box = bounding_box(part)
        except GeometryError:  # empty or unbounded by itself: the whole says so
            continue
        start = np.stack([np.maximum(start[0], box[0]), np.minimum(start[1], box[1])])
    return start


def _linear_box(tree: Tree) -> Floats | None:
    """The box of the linear inequalities that all hold, by linear programmes; None where empty.

    Unions among the conditions, such as the cells of a region, lie in the hull of their parts' boxes.
    """
    parts = tree.parts if isinstance(tree, Node) and not tree.union else (tree,)
    box = _box_of_planes(parts)
    for part in parts:
        if box is None or not (isinstance(part, Node) and part.union):
            continue
        found = [inner for p in part.parts if (inner := _linear_box(p)) is not None]
        if not found:
            return None
        box = np.stack(
            [
                np.maximum(box[0], np.min([b[0] for b in found], axis=0)),
                np.minimum(box[1], np.max([b[1] for b in found], axis=0)),
            ]
        )
        box = box if (box[0] <= box[1]).all() else None
    return box


def _box_of_planes(parts: Sequence[Tree]) -> Floats | None:
    """The box of the linear inequalities among conditions."""
    rows = []
    for part in parts:
        if isinstance(part, Node) or not isinstance(part.function, Polynomial) or part.function.degree != 1:
            continue
        row = part.function.dense(1) * (-1 if part.outside else 1)
        rows.append(row / np.abs(row[1:]).max())
    box = np.array([[-FARTHEST] * 3, [FARTHEST] * 3])
    if not rows:
        return box
    from scipy.optimize import linprog

    matrix = np.array(rows)
    for axis in range(3):
        for side in (0, 1):
            cost = np.zeros(3)
            cost[axis] = 1 - 2 * side
            found = linprog(cost, matrix[:, 1:], -matrix[:, 0], bounds=[(-FARTHEST, FARTHEST)] * 3)
            if found.status == 2:
                return None
            if found.status == 0:
                slack = 1e-9 * (1 + abs(found.fun))
                box[side, axis] = (1 - 2 * side) * found.fun - (1 - 2 * side) * slack
    return box


def _shrunk(program: Program, start: Floats) -> Floats | None:
    """The hull of the boxes that cannot be ruled out, halved until they are small beside it."""
    hull = start
    centers, half = start.mean(axis=0)[None], np.maximum((start[1] - start[0]) / 2, 1e-300)
    for _ in range(LEVELS):
        checkpoint(f"bounding a solid ({len(centers)} boxes)")
        yes, no = program.taylor(centers, half[None])
        possible = program.holds(~no, ~yes)
        centers = centers[possible]
        if not len(centers):
            return None
        hull = np.stack([centers.min(axis=0) - half, centers.max(axis=0) + half])
        axis = int(program.widest(centers, half, ~(yes | no)[:, possible], hull).argmax())
        if (half * PARTS < np.ptp(hull, axis=0)).all() or len(centers) > MOST_BOXES:
            break
        half = np.where(np.arange(3) == axis, half / 2, half)
        shift = np.where(np.arange(3) == axis, half, 0.0)
        centers = np.concatenate([centers - shift, centers + shift])
    if ((np.abs(hull) > FARTHEST / 2) & (np.abs(hull) >= np.abs(start) * 0.9)).any():
        raise GeometryError(
            "the solid is unbounded or too large: it goes on beyond "
            f"{_describe(hull)}; intersect it with a box, as in solid & pas.solid.box((-1, -1, -1), (1, 1, 1))"
        )
    return hull


def _describe(hull: Floats) -> str:
    side, axis = np.unravel_index(int(np.abs(hull).argmax()), (2, 3))
    return f"{'xyz'[axis]} = {hull[side, axis]:.3g}"
