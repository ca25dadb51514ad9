"""Where a set of inequalities lies: a box that certainly holds it.

Linear inequalities are bounded by linear programmes; then boxes in which the set certainly has no
point are cut away, from a very large box down, until the rest is tight.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from flint import fmpq

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.scaling import scaled
from pas.errors import GeometryError
from pas.limits import checkpoint
from pas.solid.distance import followed_by
from pas.solid.program import Program
from pas.solid.tree import Bools, Node, Tree, is_contradiction

FARTHEST = 2.0**24
"""Coordinates beyond which a set counts as unbounded."""

LEVELS, MOST_BOXES = 160, 60_000
PARTS = 32
"""Boxes are small enough when that many fit into each side of their hull."""

EVERYWHERE = 3
"""Halvings of all boxes, after which only those at the sides of their hull are halved."""

AT_ONCE = 300
"""Boxes that are halved together though not all of them are at the sides of the hull: rounds take time as well."""

OCTAVES = 30
"""Sizes of the boxes about the origin with which the search begins where planes do not bound the set."""

SLACK = 1e-9
"""By which the boxes of planes are larger, over what they measure, for rounding."""

NOTHING = np.array([[np.inf] * 3, [-np.inf] * 3])
"""The box of no points."""

ORIGIN = (fmpq(0), fmpq(0), fmpq(0))


def bounding_box(tree: Tree) -> Floats:
    """A box (2, 3) that holds the set.

    That of a shell is its solid's.  Raises `GeometryError` where the set is empty or extends too far to be bounded.
    """
    shell = followed_by(tree)
    if shell is not None:
        return bounding_box(shell[0])
    boxes, seen = [], NOTHING
    for part in _branches(tree):
        found = _branch_box(part, seen)
        if found is not None:
            boxes.append(found[0])
            seen = found[1]
    if not boxes:
        raise GeometryError("the solid is empty: no point satisfies all of its inequalities")
    return _hull(boxes)


def _branches(tree: Tree) -> list[Tree]:
    """Sets whose union is the set, opened up at the top only."""
    if isinstance(tree, Node) and tree.union:
        return [b for part in tree.parts for b in _branches(part)]
    return [tree]


def _branch_box(tree: Tree, seen: Floats) -> tuple[Floats, Floats] | None:
    """See `_shrunk`."""
    program = Program(tree, ORIGIN, fmpq(1))
    start = None if is_contradiction(tree) or program.is_empty else _linear_box(tree)
    if start is None:
        return None
    try:
        return _shrunk(program, start, seen)
    except GeometryError:
        within = _within_unions(tree, start)
        if (within == start).all():
            raise
        return _shrunk(program, within, seen)


def _hull(boxes: Sequence[Floats]) -> Floats:
    return np.stack([np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)])


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
        hull = _hull(found)
        box = np.stack([np.maximum(box[0], hull[0]), np.minimum(box[1], hull[1])])
        box = box if (box[0] <= box[1]).all() else None
    return box


def _box_of_planes(parts: Sequence[Tree]) -> Floats | None:
    """The box of the linear inequalities among conditions."""
    rows = []
    for part in parts:
        if isinstance(part, Node) or not isinstance(part.function, Polynomial) or part.function.degree != 1:
            continue
        row = scaled(part.function).dense(1) * (-1 if part.outside else 1)
        rows.append(row / np.abs(row[1:]).max())
    box = np.array([[-FARTHEST] * 3, [FARTHEST] * 3])
    if not rows:
        return box
    matrix = np.array(rows)
    alone = (matrix[:, 1:] != 0).sum(axis=1) == 1
    for offset, *slopes in matrix[alone]:  # a plane across an axis needs no programme
        axis = int(np.argmax(np.abs(slopes)))
        limit = -offset / slopes[axis]
        limit += np.sign(slopes[axis]) * SLACK * (1 + abs(limit))
        side, least = (1, min) if slopes[axis] > 0 else (0, max)
        box[side, axis] = least(box[side, axis], limit)
    if (box[0] > box[1]).any():
        return None
    return box if alone.all() else _programmed(matrix[~alone], box)


def _programmed(matrix: Floats, box: Floats) -> Floats | None:
    """The box of linear inequalities (n, 4) within another, for all six sides by one linear programme."""
    from scipy.optimize import linprog
    from scipy.sparse import block_diag

    costs = np.concatenate([np.eye(3), -np.eye(3)])
    every = block_diag([matrix[:, 1:]] * len(costs), format="csr")
    bounds = np.tile(box.T, (len(costs), 1))
    found = linprog(costs.ravel(), every, np.tile(-matrix[:, 0], len(costs)), bounds=bounds)
    if found.status == 2:
        return None
    if found.status != 0:
        return box
    ends = (found.x.reshape(-1, 3) * np.abs(costs)).sum(axis=1).reshape(2, 3)
    return np.asarray(ends + np.array([[-1.0], [1.0]]) * SLACK * (1 + np.abs(ends)))


def _shrunk(program: Program, start: Floats, seen: Floats) -> tuple[Floats, Floats] | None:
    """The hull of the boxes that cannot be ruled out, halved until those at its sides are small beside it.

    Also the box of all points seen: of the set, and of others in the box `seen`.  A side is left as it is where such
    points come that near to it.
    """
    known, new = (np.empty((0, 3)), np.empty((0, 3))), _first_boxes(start)
    for level in range(LEVELS):
        checkpoint(f"bounding a solid ({len(new[0])} boxes)")
        yes, no = program.taylor(*new)
        possible = program.holds(~no, ~yes)
        centers, halves = (np.concatenate([old, fresh[possible]]) for old, fresh in zip(known, new, strict=True))
        if not len(centers):
            return None
        within = new[0][possible]
        within = within[program.inside(program.signs(within))]
        seen = _hull([seen, *np.repeat(within[:, None], 2, axis=1)])
        hull = np.stack([(centers - halves).min(axis=0), (centers + halves).max(axis=0)])
        large = 2 * halves * PARTS >= np.ptp(hull, axis=0)
        further = _beyond(centers, halves, seen) if level < EVERYWHERE else _at_sides(centers, halves, hull, seen)
        open_ = large.any(axis=1) & further
        if not open_.any() or len(centers) > MOST_BOXES:
            break
        known, new = (centers[~open_], halves[~open_]), _halved(centers[open_], halves[open_], large[open_])
    if ((np.abs(hull) > FARTHEST / 2) & (np.abs(hull) >= np.abs(start) * 0.9)).any():
        raise GeometryError(
            "the solid is unbounded or too large: it goes on beyond "
            f"{_describe(hull)}; intersect it with a box, as in solid & pas.solid.box((-1, -1, -1), (1, 1, 1))"
        )
    return hull, seen


def _beyond(centers: Floats, halves: Floats, seen: Floats) -> Bools:
    """Which boxes are not within another one."""
    return np.asarray(((centers - halves < seen[0]) | (centers + halves > seen[1])).any(axis=1))


def _at_sides(centers: Floats, halves: Floats, hull: Floats, seen: Floats) -> Bools:
    """Which boxes are further out than all points seen; where these are many, only those at the hull's sides."""
    near = np.ptp(hull, axis=0) / PARTS
    low, high = centers - halves, centers + halves
    lowest, highest = low < seen[0] - near, high > seen[1] + near
    result = (lowest | highest).any(axis=1)
    if result.sum() > AT_ONCE:
        result = ((lowest & (low - halves <= hull[0])) | (highest & (high + halves >= hull[1]))).any(axis=1)
    return np.asarray(result)


def _halved(centers: Floats, halves: Floats, along: Bools) -> tuple[Floats, Floats]:
    """Boxes halved along those of their sides (N, 3) that are marked."""
    for axis in range(3):
        step = np.where(along[:, axis], halves[:, axis] / 2, 0.0)[:, None] * np.eye(3)[axis]
        halved = along[:, axis]
        halves = halves - step
        centers = np.concatenate([centers - step, (centers + step)[halved]])
        halves, along = np.concatenate([halves, halves[halved]]), np.concatenate([along, along[halved]])
    return centers, halves


def _first_boxes(start: Floats) -> tuple[Floats, Floats]:
    """Boxes that cover one: itself where it is bounded, else boxes that are the smaller the nearer the origin."""
    if np.abs(start).max() < FARTHEST:
        low, high = start[:1], start[1:]
    else:
        steps = np.array(list(product(np.linspace(-1.0, 0.5, 4), repeat=3)))
        ring = steps[(np.abs(steps + 0.25) > 0.5).any(axis=1)]
        sizes = FARTHEST / 2.0 ** np.arange(OCTAVES)
        low = np.concatenate([(size * ring).reshape(-1, 3) for size in sizes] + [[[-sizes[-1] / 2] * 3]])
        widths = np.repeat([*sizes / 2, sizes[-1]], [*[len(ring)] * OCTAVES, 1])[:, None]
        low, high = np.maximum(low, start[0]), np.minimum(low + widths, start[1])
        kept = (low <= high).all(axis=1)
        low, high = low[kept], high[kept]
    return (low + high) / 2, np.maximum((high - low) / 2, 1e-300)


def _describe(hull: Floats) -> str:
    side, axis = np.unravel_index(int(np.abs(hull).argmax()), (2, 3))
    return f"{'xyz'[axis]} = {hull[side, axis]:.3g}"
