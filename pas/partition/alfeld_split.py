"""The Alfeld split: a tetrahedron cut into four around an inner point.

P. Alfeld, A trivariate Clough-Tocher scheme for tetrahedral data (1984).  A research bench: spline spaces on it have
known dimensions (see docs/dimensions.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from pas.algebra.inputs import shown
from pas.algebra.rational import Vector, VectorLike, plain, vector
from pas.errors import GeometryError
from pas.partition.cells import Partition, written
from pas.partition.planes import plane_through

UNIT = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
"""A tetrahedron to begin with."""


class AlfeldSplit(Partition):
    """A tetrahedron with `corners`, four exact points, cut into four at `center`, by default its centroid.

    Raises `ValueError` for other than four corners, `GeometryError` for a flat tetrahedron or a centre not inside.
    """

    name = "alfeld split"

    def __init__(self, corners: Sequence[VectorLike] = UNIT, center: VectorLike | None = None) -> None:
        self.tetrahedron = four(corners)
        inner = inside(self.tetrahedron, center)
        super().__init__([*self.tetrahedron, inner], [(*face, 4) for face in combinations(range(4), 3)], inner)

    def to_record(self) -> dict[str, Any]:
        """See `Partition.to_record`."""
        assert self.center is not None
        return {"kind": self.name, "corners": [written(c) for c in self.tetrahedron], "center": written(self.center)}


def four(corners: Sequence[VectorLike]) -> tuple[Vector, ...]:
    """Four exact points; raises `ValueError` or `TypeError`."""
    if isinstance(corners, str) or not hasattr(corners, "__len__") or len(corners) != 4:
        raise ValueError(f"corners must be four points, not {shown(corners)}")
    return tuple(vector(corner, f"corners[{i}]") for i, corner in enumerate(corners))


def inside(corners: Sequence[Vector], center: VectorLike | None) -> Vector:
    """The point at which a tetrahedron is split, by default its centroid; `GeometryError` for one outside."""
    point = middle(corners) if center is None else vector(center, "center")
    for i, corner in enumerate(corners):
        plane = plane_through(*(c for c in corners if c is not corner))
        height = plane.at(corner)
        if height == 0:
            raise GeometryError("the four corners of the tetrahedron lie in one plane")
        if plane.at(point) / height <= 0:
            raise GeometryError(
                f"the centre of a split must lie inside its tetrahedron; ({', '.join(map(plain, point))}) does not, "
                f"seen from corner {i + 1}"
            )
    return point


def middle(points: Sequence[Vector]) -> Vector:
    """The centroid of some points, exact."""
    x, y, z = (sum(column[1:], column[0]) / len(points) for column in zip(*points, strict=True))
    return x, y, z
