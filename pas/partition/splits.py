"""Splits of one tetrahedron: a research bench, since spline spaces on them have known dimensions (docs/dimensions.md).

P. Alfeld, A trivariate Clough-Tocher scheme for tetrahedral data (1984); A. J. Worsey and G. Farin, An n-dimensional
Clough-Tocher interpolant (1987).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from pas.algebra.inputs import shown
from pas.algebra.rational import Vector, VectorLike, cross, dot, minus, plain, texts, vector
from pas.errors import GeometryError
from pas.partition.cells import Partition

UNIT = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
"""A tetrahedron to begin with."""

FACES = tuple(combinations(range(4), 3))
"""The faces of a tetrahedron by its corners."""


class AlfeldSplit(Partition):
    """A tetrahedron with `corners`, four exact points, cut into four at `center`, by default its centroid.

    Raises `ValueError` for other than four corners, `GeometryError` for a flat tetrahedron or a centre not inside.
    """

    name = "alfeld split"

    def __init__(self, corners: Sequence[VectorLike] = UNIT, center: VectorLike | None = None) -> None:
        if isinstance(corners, str) or not hasattr(corners, "__len__") or len(corners) != 4:
            raise ValueError(f"corners must be four points, not {shown(corners)}")
        self.tetrahedron = tuple(vector(corner, f"corners[{i}]") for i, corner in enumerate(corners))
        inner = _centroid(self.tetrahedron) if center is None else vector(center, "center")
        _check_inside(self.tetrahedron, inner)
        more, cells = self._cut()
        super().__init__([*self.tetrahedron, inner, *more], cells, inner)

    def _cut(self) -> tuple[list[Vector], list[tuple[int, ...]]]:
        """The points besides the four corners and the inner one, number 4, and the cells."""
        return [], [(*face, 4) for face in FACES]

    def to_record(self) -> dict[str, Any]:
        """See `Partition.to_record`."""
        assert self.center is not None
        return {"kind": self.name, "corners": [texts(c) for c in self.tetrahedron], "center": texts(self.center)}


class WorseyFarinSplit(AlfeldSplit):
    """A tetrahedron with `corners`, four exact points, cut into twelve: at `center`, by default its centroid, and
    around the centroids of its faces.

    Raises `ValueError` for other than four corners, `GeometryError` for a flat tetrahedron or a centre not inside.
    """

    name = "worsey-farin split"

    def _cut(self) -> tuple[list[Vector], list[tuple[int, ...]]]:
        on_faces = [_centroid([self.tetrahedron[v] for v in face]) for face in FACES]
        return on_faces, [(*edge, 5 + i, 4) for i, face in enumerate(FACES) for edge in combinations(face, 2)]


def _check_inside(corners: Sequence[Vector], point: Vector) -> None:
    """That a point is inside a tetrahedron; raises `GeometryError`."""
    for i, corner in enumerate(corners):
        a, b, c = (p for p in corners if p is not corner)
        normal = cross(minus(b, a), minus(c, a))
        height = dot(normal, minus(corner, a))
        if height == 0:
            raise GeometryError("the four corners of the tetrahedron lie in one plane")
        if dot(normal, minus(point, a)) / height <= 0:
            raise GeometryError(
                f"the centre of a split must lie inside its tetrahedron; ({', '.join(map(plain, point))}) does not, "
                f"seen from corner {i + 1}"
            )


def _centroid(points: Sequence[Vector]) -> Vector:
    """The centroid of some points, exact."""
    x, y, z = (sum(column[1:], column[0]) / len(points) for column in zip(*points, strict=True))
    return x, y, z
