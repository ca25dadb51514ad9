"""In which pieces of a partition points lie, for many points at once.

Where there is a centre, the faces between pieces lie in a few planes through it, and the signs at these planes tell
the piece: the planes cut space into cones, each of which lies in one piece.  Which one is worked out exactly, once.
What is left is whether a point is beyond the outer faces of its piece.  Where there is no centre, or there are too
many planes, the cell in which a point is deepest by barycentric coordinates is taken.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.rational import cross, dot, minus, to_floats
from pas.kernels.library import compiled
from pas.partition.complex import CellComplex, OuterFace
from pas.partition.layout import Ray, primitive, reduced

Integers = NDArray[np.intp]


class Location:
    """Finds the pieces of points, in the coordinates of a partition in local coordinates (its centre, if any, is 0)."""

    def __init__(self, partition: CellComplex) -> None:
        self.partition = partition

    def pieces(self, points: Floats, tolerance: float) -> Integers:
        """The piece of each of `points` (3, N), -1 outside.

        A point counts as outside that is further than `tolerance` (barycentric) outside every cell.
        """
        number = points.shape[1]
        if not self.partition.cells:
            return np.zeros(number, dtype=np.intp)
        result = np.empty(number, dtype=np.intp)
        compiled().call("pas_located", *self._tables, number, points, float(tolerance), result)
        return result

    @cached_property
    def _tables(self) -> tuple[Floats | Integers, ...]:
        """What compiled code takes: how many cells and planes there are (-1 where planes do not tell), the cells' maps
        and pieces, the planes with the table of pieces, and for each piece where its walls begin, and these."""
        maps, piece_of = np.ascontiguousarray(self.partition.barycentric_maps), np.array(self.partition.piece_of)
        normals, table = self._planes or (np.empty((0, 3)), np.empty(0, dtype=np.intp))
        walls = [np.empty((0, 3)) if own is None else own for own in (self._walls if self._planes else ())]
        starts = np.cumsum([0, *map(len, walls)])
        sizes = np.array([len(maps), len(normals) if self._planes else -1])
        return sizes, maps, piece_of, normals, table, starts, np.concatenate([np.empty((0, 3)), *walls])

    @cached_property
    def _planes(self) -> tuple[Floats, Integers] | None:
        """Normals (p, 3) of the planes between pieces, and the piece for each combination of signs (2^p,).

        None without a centre, and for too many planes.
        """
        if self.partition.center is None:
            return None
        found: dict[Ray, None] = {}
        for face in self.partition.interior_faces:
            a, b, c = (self.partition.vertices[v] for v in face.vertices)
            normal = primitive(cross(minus(b, a), minus(c, a)))
            found[max(normal, (-normal[0], -normal[1], -normal[2]))] = None
        normals = list(found)
        # Of 2^planes combinations of signs a table is kept; with more planes the test of all cells is not slower
        # either.
        most_planes = 12
        if len(normals) > most_planes:
            return None
        table = np.full(1 << len(normals), -1, dtype=np.intp)
        for outer in self.partition.outer_faces:
            rays = tuple(primitive(self.partition.vertices[v]) for v in outer.vertices)
            for cone in _cut(rays, normals):
                middle = tuple(map(sum, zip(*cone, strict=True)))
                table[sum((dot(n, middle) > 0) << bit for bit, n in enumerate(normals))] = outer.piece
        units = [[n / max(map(abs, normal)) for n in normal] for normal in normals]
        return np.array(units).reshape(-1, 3), table

    @cached_property
    def _walls(self) -> list[Floats | None]:
        """For each piece the planes of its outer faces (f, 3), 1 on them; None where it is not below each of them."""
        faces: list[list[OuterFace]] = [[] for _ in self.partition.pieces]
        for face in self.partition.outer_faces:
            faces[face.piece].append(face)
        return [self._planes_of(own) for own in faces]

    def _planes_of(self, faces: list[OuterFace]) -> Floats | None:
        corners = {v for face in faces for v in face.vertices}
        planes = {face.plane for face in faces}
        if any(plane.at(self.partition.vertices[v]) > 0 for plane in planes for v in corners):
            return None
        rows = (plane.row(1) for plane in sorted(planes, key=str))
        return np.array([to_floats((-x / constant, -y / constant, -z / constant)) for constant, x, y, z in rows])


def _cut(cone: tuple[Ray, ...], normals: list[Ray]) -> list[tuple[Ray, ...]]:
    """The parts into which planes through 0 cut the cone over a triangle, exact."""
    parts = [cone]
    for normal in normals:
        parts = [part for cone in parts for part in _halves(cone, normal)]
    return parts


def _halves(cone: tuple[Ray, ...], normal: Ray) -> list[tuple[Ray, ...]]:
    """The parts of a convex cone on both sides of a plane through 0."""
    sides = [dot(normal, ray) for ray in cone]
    if min(sides) >= 0 or max(sides) <= 0:
        return [cone]
    halves: list[list[Ray]] = [[], []]
    for here, after in zip(range(len(cone)), (*range(1, len(cone)), 0), strict=True):
        a, b = sides[here], sides[after]
        for half, sign in zip(halves, (1, -1), strict=True):
            if sign * a >= 0:
                half.append(cone[here])
            if a * b < 0:
                mixed = (abs(b) * p + abs(a) * q for p, q in zip(cone[here], cone[after], strict=True))
                half.append(reduced(tuple(mixed)))
    return [tuple(half) for half in halves]
