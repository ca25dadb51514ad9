"""Boxes as partitions: one piece for all of it, and Kuhn's six tetrahedra around a diagonal.

A single cell is the region of the classical algebraic blend: one polynomial over a box, which is cut into twelve
tetrahedra around its centre (two for each of its sides).  Contacts whose clip planes carry sides of the box can be
proved and meshed.  Without a box the cell is all of space: good for the algebra, which needs no region.

The Kuhn partition has one tetrahedron for each order of the axes, along whose edges a way leads from the lowest corner
to the highest (H. W. Kuhn, Some combinatorial lemmas in topology, 1960).  A research bench: spline spaces on it have
known dimensions (see docs/dimensions.md).
"""

from __future__ import annotations

from itertools import permutations, product
from typing import Any

from pas.algebra.rational import Vector, VectorLike, plain, texts, vector
from pas.errors import GeometryError
from pas.partition.cells import Partition

SIDES = tuple((axis, end) for axis in range(3) for end in (0, 1))

KUHN_CELLS = tuple((0, first, first + second, 7) for first, second, _ in permutations((4, 2, 1)))
"""The corners of each tetrahedron, by numbers 4 i + 2 j + k of a box's corners (i, j, k)."""

Box = tuple[Vector, Vector]


class SingleCell(Partition):
    """A single piece: the box from `lower` to `upper` (three exact numbers each), or all of space.

    `center` (by default the middle of the box) is the point from which the one-sheet proof looks.

    Raises `ValueError` for a box without inside, `GeometryError` for a centre that is not in it.
    """

    name = "single cell"

    def __init__(
        self, lower: VectorLike | None = None, upper: VectorLike | None = None, center: VectorLike | None = None
    ) -> None:
        if (lower is None) != (upper is None):
            raise ValueError("a box needs both lower and upper (or neither: all of space)")
        self.box: Box | None = None
        if lower is None or upper is None:
            super().__init__((), (), center, [()])
            return
        self.box = _box(lower, upper)
        inside = _middle(self.box) if center is None else vector(center, "center")
        if not all(a < c < b for a, c, b in zip(self.box[0], inside, self.box[1], strict=True)):
            raise GeometryError("the centre of a single cell must lie inside its box")
        cells = [(8, *triangle) for side in SIDES for triangle in _triangles(*side)]
        super().__init__([*_corners(self.box), inside], cells, inside, [tuple(range(len(cells)))])

    def _check(self) -> None:
        """Nothing: a box is cut in this way around any point in its inside."""

    def to_record(self) -> dict[str, Any]:
        """See `Partition.to_record`."""
        record: dict[str, Any] = {"kind": self.name, "center": None if self.center is None else texts(self.center)}
        if self.box is not None:
            record["lower"], record["upper"] = map(texts, self.box)
        return record


class KuhnCube(Partition):
    """The box from `lower` to `upper` (three exact numbers each), cut into six around the diagonal between these.

    Its centre is the middle of the diagonal.  Raises `ValueError` for a box without inside.
    """

    name = "kuhn cube"

    def __init__(self, lower: VectorLike = (0, 0, 0), upper: VectorLike = (1, 1, 1)) -> None:
        self.box = _box(lower, upper)
        super().__init__(_corners(self.box), KUHN_CELLS, _middle(self.box))

    def to_record(self) -> dict[str, Any]:
        """See `Partition.to_record`."""
        return {"kind": self.name, "lower": texts(self.box[0]), "upper": texts(self.box[1])}


def _box(lower: VectorLike, upper: VectorLike) -> Box:
    low, high = vector(lower, "lower"), vector(upper, "upper")
    if any(a >= b for a, b in zip(low, high, strict=True)):
        bounds = ", ".join(f"{plain(a)} to {plain(b)}" for a, b in zip(low, high, strict=True))
        raise ValueError(f"each lower bound of a box must be below the upper one, and it goes from {bounds}")
    return low, high


def _middle(box: Box) -> Vector:
    return vector([(a + b) / 2 for a, b in zip(*box, strict=True)])


def _corners(box: Box) -> list[Vector]:
    """Corner number 4i + 2j + k has ends i, j, k."""
    return [vector(corner) for corner in product(*zip(*box, strict=True))]


def _triangles(axis: int, end: int) -> list[tuple[int, int, int]]:
    """The two triangles of a side of the box, by numbers of corners."""
    steps = [4 >> other for other in range(3) if other != axis]
    first = (4 >> axis) * end
    a, b, c, d = first, first + steps[0], first + steps[1], first + steps[0] + steps[1]
    return [(a, b, d), (a, c, d)]
