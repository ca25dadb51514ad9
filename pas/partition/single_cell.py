"""One polynomial over one region: the classical algebraic blend.

The region is a box, cut into twelve tetrahedra around its centre (two for each of its sides) that
share one polynomial.  Contacts whose clip planes carry sides of the box can be proved and
meshed.  Without a box the cell is all of space: good for the algebra, which needs no region.
"""

from __future__ import annotations

from itertools import product
from typing import Any

from pas.algebra.rational import Vector, VectorLike, plain, vector
from pas.errors import GeometryError
from pas.partition.cells import Partition, written

SIDES = tuple((axis, end) for axis in range(3) for end in (0, 1))


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
        self.box: tuple[Vector, Vector] | None = None
        if lower is None:
            super().__init__((), (), center, [()])
            return
        low, high = vector(lower, "lower"), vector(upper, "upper")
        if any(a >= b for a, b in zip(low, high, strict=True)):
            bounds = ", ".join(f"{plain(a)} to {plain(b)}" for a, b in zip(low, high, strict=True))
            raise ValueError(f"each lower bound of a box must be below the upper one, and it goes from {bounds}")
        middle = vector([(a + b) / 2 for a, b in zip(low, high, strict=True)])
        inside = middle if center is None else vector(center, "center")
        if not all(a < c < b for a, c, b in zip(low, inside, high, strict=True)):
            raise GeometryError("the centre of a single cell must lie inside its box")
        self.box = (low, high)
        corners = [vector(corner) for corner in product(*zip(low, high, strict=True))]
        cells = [(8, *triangle) for side in SIDES for triangle in _triangles(*side)]
        super().__init__([*corners, inside], cells, inside, [tuple(range(len(cells)))])

    def _check(self) -> None:
        """Nothing: a box is cut in this way around any point in its inside."""

    def to_record(self) -> dict[str, Any]:
        """See `Partition.to_record`."""
        record: dict[str, Any] = {"kind": self.name, "center": None if self.center is None else written(self.center)}
        if self.box is not None:
            record["lower"], record["upper"] = map(written, self.box)
        return record


def _triangles(axis: int, end: int) -> list[tuple[int, int, int]]:
    """The two triangles of a side of the box; corner number 4i + 2j + k has ends i, j, k."""
    steps = [4 >> other for other in range(3) if other != axis]
    first = (4 >> axis) * end
    a, b, c, d = first, first + steps[0], first + steps[1], first + steps[0] + steps[1]
    return [(a, b, d), (a, c, d)]
