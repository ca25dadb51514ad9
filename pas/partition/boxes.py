"""Boxes and tetrahedra cut in well-known ways: one piece, Kuhn's six tetrahedra, the splits of a tetrahedron.

A single cell is the region of the classical algebraic blend: one polynomial over a box, which is cut into twelve
tetrahedra around its centre (two for each of its sides).  Contacts whose clip planes carry sides of the box can be
proved and meshed.  Without a box the cell is all of space: good for the algebra, which needs no region.

The others are a research bench: spline spaces on them have known dimensions (see docs/dimensions.md).  The Kuhn
partition has one tetrahedron for each order of the axes, along whose edges a way leads from the lowest corner to the
highest (H. W. Kuhn, Some combinatorial lemmas in topology, 1960).  Splits: P. Alfeld, A trivariate Clough-Tocher scheme
for tetrahedral data (1984); A. J. Worsey and G. Farin, An n-dimensional Clough-Tocher interpolant (1987).

Six tetrahedra around a corner are the classical partition for three perpendicular pipes.  With legs l1, l2, l3 from the
centre to the three clip planes, Z1 = l1 + l2 + l3, Z2 = -Z1 and the hexagon V1 = l1 - l3, V2 = l2 - l3, V3 = l2 - l1,
V4 = l3 - l1, V5 = l3 - l2, V6 = l1 - l2, the cells are T_i = Z1 Z2 V_{i-1} V_i.  T1, T3, T5 have a face in the clip
planes of the first, second and third leg; T2, T4, T6 are transitions.  The three planes through the axis Z1 Z2 carry
two interior faces each.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, permutations, product
from typing import Any

from pas.algebra.affine import Affine
from pas.algebra.inputs import check_count
from pas.algebra.rational import Vector, VectorLike, cross, dot, listed, minus, plain, texts, three, vector
from pas.errors import GeometryError
from pas.partition.cells import Partition

SIDES = tuple((axis, end) for axis in range(3) for end in (0, 1))

KUHN_CELLS = tuple((0, first, first + second, 7) for first, second, _ in permutations((4, 2, 1)))
"""The corners of each tetrahedron, by numbers 4 i + 2 j + k of a box's corners (i, j, k)."""

UNIT = tuple(tuple(int(i == axis) for i in range(3)) for axis in (-1, 0, 1, 2))
"""A tetrahedron to begin with: 0 and the ends of the axes."""

FACES = tuple(combinations(range(4), 3))
"""The faces of a tetrahedron by its corners."""

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


class AlfeldSplit(Partition):
    """A tetrahedron with `corners`, four exact points, cut into four at `center`, by default its centroid.

    Raises `ValueError` for other than four corners, `GeometryError` for a flat tetrahedron or a centre not inside.
    """

    name = "alfeld split"

    def __init__(self, corners: Sequence[VectorLike] = UNIT, center: VectorLike | None = None) -> None:
        check_count(corners, 4, "corners must be four points", ValueError)
        self.tetrahedron = tuple(vector(corner, f"corners[{i}]") for i, corner in enumerate(corners))
        inner = _centroid(self.tetrahedron) if center is None else vector(center, "center")
        _check_inside(self.tetrahedron, inner)
        more, cells = self._cut()
        super().__init__([*self.tetrahedron, inner, *more], cells, inner)

    def _cut(self) -> tuple[list[Vector], list[tuple[int, ...]]]:
        """The points besides the four corners and the inner one, number 4, and the cells."""
        return [], [(*face, 4) for face in FACES]

    def to_record(self) -> dict[str, Any]:
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
    """Raise `GeometryError` for a point that is not inside a tetrahedron."""
    for i, corner in enumerate(corners):
        a, b, c = (p for p in corners if p is not corner)
        normal = cross(minus(b, a), minus(c, a))
        height = dot(normal, minus(corner, a))
        if height == 0:
            raise GeometryError("the four corners of the tetrahedron lie in one plane")
        if dot(normal, minus(point, a)) / height <= 0:
            raise GeometryError(
                f"the centre of a split must lie inside its tetrahedron; ({listed(point)}) does not, "
                f"seen from corner {i + 1}"
            )


def _centroid(points: Sequence[Vector]) -> Vector:
    """The centroid of some points, exact."""
    return three(sum(column[1:], column[0]) / len(points) for column in zip(*points, strict=True))


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
        check_count(legs, 3, "legs must be three vectors", ValueError)
        self.legs = tuple(vector(leg, f"legs[{i}]") for i, leg in enumerate(legs))
        if dot(self.legs[0], cross(self.legs[1], self.legs[2])) == 0:
            raise GeometryError("the three legs of the corner lie in one plane")
        super().__init__([self._vertex(origin, signs) for signs in VERTEX_SIGNS], CELLS, origin)

    def to_record(self) -> dict[str, Any]:
        assert self.center is not None
        return {"kind": self.name, "center": texts(self.center), "legs": [texts(leg) for leg in self.legs]}

    @classmethod
    def keys(cls) -> Mapping[str, bool]:
        return {"center": False, "legs": True}

    def moved(self, map_: Affine) -> SixTetrahedra:
        assert self.center is not None
        return SixTetrahedra(map_.exact(self.center), [map_.direction(leg) for leg in self.legs])

    def _vertex(self, origin: Vector, signs: Signs) -> Vector:
        return three(
            o + sum(s * leg[axis] for s, leg in zip(signs, self.legs, strict=True)) for axis, o in enumerate(origin)
        )
