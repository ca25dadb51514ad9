"""The six-tetrahedra corner: the classical partition for three perpendicular pipes.

With legs l1, l2, l3 from the centre to the three clip planes, Z1 = l1 + l2 + l3, Z2 = -Z1 and the hexagon V1 = l1 - l3,
V2 = l2 - l3, V3 = l2 - l1, V4 = l3 - l1, V5 = l3 - l2, V6 = l1 - l2, the cells are T_i = Z1 Z2 V_{i-1} V_i.  T1, T3, T5
have a face in the clip planes of the first, second and third leg; T2, T4, T6 are transitions.  The three planes through
the axis Z1 Z2 carry two interior faces each.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pas.algebra.affine import Affine
from pas.algebra.inputs import shown
from pas.algebra.rational import Vector, VectorLike, cross, dot, texts, vector
from pas.errors import GeometryError
from pas.partition.cells import Partition

Signs = tuple[int, int, int]


def _around(first: Signs) -> Iterator[Signs]:
    """The hexagon from V1 = `first` on: one of its corners (a, b, c) is followed by (-b, -c, -a)."""
    for _ in range(6):
        yield first
        first = (-first[1], -first[2], -first[0])


VERTEX_SIGNS: tuple[Signs, ...] = ((1, 1, 1), (-1, -1, -1), *_around((1, 0, -1)))
"""Z1, Z2, V1, ..., V6 as combinations of the three legs."""

CELLS = tuple((0, 1, 2 + (i - 1) % 6, 2 + i) for i in range(6))
"""T_i = Z1 Z2 V_{i-1} V_i as vertex indices."""


class SixTetrahedra(Partition):
    """Six tetrahedra around `center`; `legs` are the three vectors to the clip planes.

    Each of `center` and the legs is three exact numbers.  The legs must be linearly independent
    and, for the corner of pipes, mutually perpendicular.
    """

    name = "six tetrahedra"

    def __init__(
        self, center: VectorLike = (0, 0, 0), legs: Sequence[VectorLike] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    ) -> None:
        origin = vector(center, "center")
        if isinstance(legs, str) or not hasattr(legs, "__len__") or len(legs) != 3:
            raise ValueError(f"legs must be three vectors, not {shown(legs)}")
        self.legs = tuple(vector(leg, f"legs[{i}]") for i, leg in enumerate(legs))
        if dot(self.legs[0], cross(self.legs[1], self.legs[2])) == 0:
            raise GeometryError("the three legs of the corner lie in one plane")
        super().__init__([self._vertex(origin, signs) for signs in VERTEX_SIGNS], CELLS, origin)

    def to_record(self) -> dict[str, Any]:
        """See `Partition.to_record`."""
        assert self.center is not None
        return {"kind": self.name, "center": texts(self.center), "legs": [texts(leg) for leg in self.legs]}

    @classmethod
    def keys(cls) -> Mapping[str, bool]:
        """See `Partition.keys`."""
        return {"center": False, "legs": True}

    def moved(self, map_: Affine) -> SixTetrahedra:
        """See `Partition.moved`."""
        assert self.center is not None
        return SixTetrahedra(map_.exact(self.center), [map_.direction(leg) for leg in self.legs])

    def _vertex(self, origin: Vector, signs: Signs) -> Vector:
        x, y, z = (
            o + sum(s * leg[axis] for s, leg in zip(signs, self.legs, strict=True)) for axis, o in enumerate(origin)
        )
        return x, y, z
