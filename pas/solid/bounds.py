"""The bounding box of a set of inequalities: it certainly holds the set.

Linear inequalities are bounded by linear programmes; then boxes in which the set certainly has no
point are cut away, from a very large box down, until the rest is tight.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from pas.algebra.polynomial import Polynomial
from pas.algebra.scaling import scaled
from pas.arrays import Bools, Floats
from pas.bernstein.search import Boxes, Fate, Fates, Limits, search
from pas.errors import GeometryError
from pas.limits import checkpoint
from pas.solid.evaluator import TreeEvaluator
from pas.solid.functions import followed_by
from pas.solid.tree import Node, Tree, atoms, is_contradiction, parts_of

FARTHEST = 2.0**24
"""Coordinates beyond which a set counts as unbounded."""

LIMITS = Limits(depth=159, cells=60_000)
PARTS = 32
"""Boxes are small enough when that many fit into each side of their hull."""

OCTAVES = 30
"""Sizes of the boxes about the origin with which the search begins where planes do not bound the set."""

SLACK = 1e-9
"""The share of their sizes by which the boxes of planes are larger, for rounding."""

EMPTY = "the solid is empty: no point satisfies all of its inequalities"

NOTHING = np.array([[np.inf] * 3, [-np.inf] * 3])
"""The box of no points."""


def bounding_box(tree: Tree) -> Floats:
    """A box (2, 3) that holds the set.

    That of a shell is its solid's.  Raises `GeometryError` where the set is empty or extends too far to be bounded.
    """
    shell = followed_by(tree)
    if shell is not None:
        return bounding_box(shell[0])
    boxes, seen = [], NOTHING
    for part in sorted(parts_of(tree, union=True), key=lambda part: sum(1 for _ in atoms(part))):  # quick ones first
        found = _branch_box(part, seen)
        if found is not None:
            boxes.append(found[0])
            seen = found[1]
    if not boxes:
        raise GeometryError(EMPTY)
    return hull(boxes)


def narrowed(tree: Tree, within: Floats) -> Floats:
    """A box (2, 3) that holds a set in another one, which is kept where points of the set are near its sides."""
    evaluator = TreeEvaluator(tree)
    found = _shrunk(evaluator, within, NOTHING) if (within[0] <= within[1]).all() else None
    if found is None:
        raise GeometryError(EMPTY)
    return found[0]


def _branch_box(tree: Tree, seen: Floats) -> tuple[Floats, Floats] | None:
    """See `_shrunk`."""
    start = None if is_contradiction(tree) else _linear_box(tree)
    if start is None or ((seen[0] <= start[0]) & (start[1] <= seen[1])).all():
        return None if start is None else (start, seen)
    evaluator = TreeEvaluator(tree)
    return None if evaluator.is_empty else _shrunk(evaluator, _within_unions(tree, start), seen)


def hull(boxes: Sequence[Floats]) -> Floats:
    """The smallest box (2, 3) that holds boxes."""
    return np.stack([np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)])


def overlap(boxes: Sequence[Floats]) -> Floats:
    """The largest box (2, 3) in all of some boxes; its corners change places where there is none."""
    return np.stack([np.max([b[0] for b in boxes], axis=0), np.min([b[1] for b in boxes], axis=0)])


def _within_unions(tree: Tree, start: Floats) -> Floats:
    """A box that planes leave open, brought within the boxes of unions among the conditions.

    Of a union with something taken away the parts are bounded one by one, as without that.
    """
    for part in parts_of(tree, union=False):
        if not (isinstance(part, Node) and part.union) or np.abs(start).max() < FARTHEST:
            continue
        try:
            box = bounding_box(part)
        except GeometryError:  # empty or unbounded by itself: the whole says so
            continue
        start = overlap([start, box])
    return start


def _linear_box(tree: Tree) -> Floats | None:
    """The box of the linear inequalities that all hold, by linear programmes; None where empty.

    Unions among the conditions, such as the cells of a region, lie in the hull of their parts' boxes.
    """
    parts = parts_of(tree, union=False)
    box = _box_of_planes(parts)
    for part in parts:
        if box is None or not (isinstance(part, Node) and part.union):
            continue
        found = [inner for p in part.parts if (inner := _linear_box(p)) is not None]
        if not found:
            return None
        box = overlap([box, hull(found)])
        box = box if (box[0] <= box[1]).all() else None
    return box


def _box_of_planes(parts: Sequence[Tree]) -> Floats | None:
    """The box of the linear inequalities among conditions."""
    checkpoint()  # of many, each of which takes a programme
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
    found = box if alone.all() else _tetrahedron_box(matrix) if len(matrix) == 4 else None
    return _programmed(matrix[~alone], box) if found is None else found


def _tetrahedron_box(matrix: Floats) -> Floats | None:
    """The box of the tetrahedron which inequalities (4, 4) bound, as those of cells do; None where they bound none."""
    others = np.nonzero(~np.eye(4, dtype=bool))[1].reshape(4, 3)
    if not np.linalg.det(matrix[others, 1:]).all():
        return None
    corners = np.linalg.solve(matrix[others, 1:], -matrix[others, :1])[..., 0]
    if not (matrix[:, 0] + (matrix[:, 1:] * corners).sum(axis=1) < 0).all():  # a corner is beyond the other plane
        return None
    slack = SLACK * (1 + np.abs(corners))
    return np.stack([(corners - slack).min(axis=0), (corners + slack).max(axis=0)])


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


def _shrunk(evaluator: TreeEvaluator, start: Floats, seen: Floats) -> tuple[Floats, Floats] | None:
    """The hull of the boxes that cannot be ruled out, halved until those at its sides are small beside it.

    Also the box of all points seen: of the set, and of others in the box `seen`.
    """
    hull = _Hull(evaluator, seen)
    if np.abs(start).max() < FARTHEST:  # points close to its sides
        steps = (np.indices([PARTS] * 3).reshape(3, -1).T + 0.5) / PARTS
        hull.see(start[0] + steps[(np.abs(steps - 0.5).max(axis=1) > 0.5 - 1 / PARTS)] * np.ptp(start, axis=0))
    found = search(_first_boxes(start), hull.judge, hull.halved, LIMITS, "bounding a solid")
    if not len(found.open):
        return None
    if ((np.abs(hull.box) > FARTHEST / 2) & (np.abs(hull.box) >= np.abs(start) * 0.9)).any():
        raise GeometryError(
            "the solid is unbounded or too large: it goes on beyond "
            f"{_describe(hull.box)}; intersect it with a box, as in solid & pas.solid.box((-1, -1, -1), (1, 1, 1))"
        )
    return hull.box, hull.seen


class _Hull:
    """The hull of what is left of a set's boxes, and the box of the points `seen`.

    A side is left as it is where such points come that near to it.  Boxes wait that are small, or not at the sides.
    """

    def __init__(self, evaluator: TreeEvaluator, seen: Floats) -> None:
        self.evaluator, self.seen, self.box, self._waiting = evaluator, seen, NOTHING, 0

    def judge(self, boxes: Boxes, level: int) -> Fates:
        """Boxes that the set may meet are halved or wait; of those that waited, which stand last, it is known."""
        possible, new = np.ones(len(boxes), dtype=bool), slice(len(boxes) - self._waiting)
        yes, no = self.evaluator.taylor(boxes.centers[new], boxes.halves[new])
        possible[new] = self.evaluator.holds(~no, ~yes)
        fates, left = np.full(len(boxes), Fate.SETTLED.value), boxes.select(possible)
        self.see(boxes.centers[new][possible[new]])
        if len(left):
            low, high = left.centers - left.halves, left.centers + left.halves
            self.box = np.stack([low.min(axis=0), high.max(axis=0)])
            split = self._large(left).any(axis=1) & self._at_sides(low, high)
            fates[possible] = np.where(split, Fate.SPLIT, Fate.WAIT)
        self._waiting = int(np.count_nonzero(fates == Fate.WAIT))
        return fates

    def see(self, points: Floats) -> None:
        """Add those of some points (N, 3) that are in the set."""
        within = points[self.evaluator.contains(points)]
        self.seen = np.stack(
            [np.vstack([self.seen[:1], within]).min(axis=0), np.vstack([self.seen[1:], within]).max(axis=0)]
        )

    def halved(self, boxes: Boxes) -> Boxes:
        """Boxes halved along their sides that are not small beside the hull."""
        return boxes.halved(self._large(boxes))

    def _large(self, boxes: Boxes) -> Bools:
        return np.asarray(2 * boxes.halves * PARTS >= np.ptp(self.box, axis=0))

    def _at_sides(self, low: Floats, high: Floats) -> Bools:
        """Which boxes are at sides of the hull that are further out than all points seen."""
        near, halves = np.ptp(self.box, axis=0) / PARTS, (high - low) / 2
        lowest = (low < self.seen[0] - near) & (low - halves <= self.box[0])
        highest = (high > self.seen[1] + near) & (high + halves >= self.box[1])
        return np.asarray((lowest | highest).any(axis=1))


def _first_boxes(start: Floats) -> Boxes:
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
    return Boxes((low + high) / 2, np.maximum((high - low) / 2, 1e-300))


def _describe(hull: Floats) -> str:
    side, axis = np.unravel_index(int(np.abs(hull).argmax()), (2, 3))
    return f"{'xyz'[axis]} = {hull[side, axis]:.3g}"
