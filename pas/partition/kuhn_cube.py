"""The Kuhn partition: a box cut into six tetrahedra around a diagonal.

H. W. Kuhn, Some combinatorial lemmas in topology (1960): one tetrahedron for each order of the axes, along whose edges
a way leads from the lowest corner to the highest.  A research bench: spline spaces on it have known dimensions (see
docs/dimensions.md).
"""

from __future__ import annotations

from itertools import permutations, product
from typing import Any

from pas.algebra.rational import Vector, VectorLike, vector
from pas.partition.cells import Partition, written

KUHN_CELLS = tuple((0, first, first + second, 7) for first, second, _ in permutations((4, 2, 1)))
"""The corners of each tetrahedron, by numbers 4 i + 2 j + k of a box's corners (i, j, k)."""


class KuhnCube(Partition):
    """The box from `lower` to `upper` (three exact numbers each), cut into six around the diagonal between these.

    Its centre is the middle of the diagonal.  Raises `ValueError` for a box without inside.
    """

    name = "kuhn cube"

    def __init__(self, lower: VectorLike = (0, 0, 0), upper: VectorLike = (1, 1, 1)) -> None:
        self.box: tuple[Vector, Vector] = (vector(lower, "lower"), vector(upper, "upper"))
        if any(a >= b for a, b in zip(*self.box, strict=True)):
            raise ValueError("each lower bound of a box must be below the upper one")
        corners = [vector(corner) for corner in product(*zip(*self.box, strict=True))]
        center = vector([(a + b) / 2 for a, b in zip(*self.box, strict=True)])
        super().__init__(corners, KUHN_CELLS, center)

    def to_record(self) -> dict[str, Any]:
        """See `Partition.to_record`."""
        return {"kind": self.name, "lower": written(self.box[0]), "upper": written(self.box[1])}
