"""The Worsey-Farin split: a tetrahedron cut into twelve, around an inner point and one on each of its faces.

A. J. Worsey and G. Farin, An n-dimensional Clough-Tocher interpolant (1987).  A research bench: spline spaces on it
have known dimensions (see docs/dimensions.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from pas.algebra.rational import VectorLike
from pas.partition.alfeld_split import UNIT, four, inside, middle
from pas.partition.cells import Partition, written


class WorseyFarinSplit(Partition):
    """A tetrahedron with `corners`, four exact points, cut at `center`, by default its centroid, and in its faces.

    Raises `ValueError` for other than four corners, `GeometryError` for a flat tetrahedron or a centre not inside.
    """

    name = "worsey-farin split"

    def __init__(self, corners: Sequence[VectorLike] = UNIT, center: VectorLike | None = None) -> None:
        self.tetrahedron = four(corners)
        inner = inside(self.tetrahedron, center)
        faces = list(combinations(range(4), 3))
        on_faces = [middle([self.tetrahedron[v] for v in face]) for face in faces]
        cells = [(*edge, 5 + i, 4) for i, face in enumerate(faces) for edge in combinations(face, 2)]
        super().__init__([*self.tetrahedron, inner, *on_faces], cells, inner)

    def to_record(self) -> dict[str, Any]:
        """See `Partition.to_record`."""
        assert self.center is not None
        return {"kind": self.name, "corners": [written(c) for c in self.tetrahedron], "center": written(self.center)}
