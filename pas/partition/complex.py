"""Complexes of tetrahedra: their faces, the planes of these, and what lies in which cell, exact.

Cells are tetrahedra.  A piece is one cell, or several that share one polynomial (a cone over a polygon, a box).
Planes are worked out in whole numbers: vertices are taken times a common denominator of their coordinates.

A complex may be `open`: its centre is the apex of a convex cone that the cells fill up to some faces.  Those of its
sides, which pass through the centre, are no outer faces: no ray leaves through them.

`Location` tells in which pieces points lie, for many points at once.  Where there is a centre, the faces between pieces
lie in a few planes through it, and the signs at these planes tell the piece: the planes cut space into cones, each of
which lies in one piece.  Which one is worked out exactly, once.  What is left is whether a point is beyond the outer
faces of its piece.  Where there is no centre, or there are too many planes, the cell in which a point is deepest by
barycentric coordinates is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from math import gcd, lcm

import numpy as np
from flint import fmpq

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, cross, determinant, dot, minus, three, to_floats
from pas.arrays import Floats, Integers
from pas.errors import GeometryError
from pas.kernels.library import compiled
from pas.partition.layout import Ray, primitive, reduced

Indices = tuple[int, ...]
Whole = tuple[int, int, int]


@dataclass(frozen=True)
class InteriorFace:
    """A triangle (vertex indices) between pieces `first` and `second`, in the plane `plane = 0`.

    Of several triangles between two pieces in one plane only the first is listed.
    """

    vertices: Indices
    first: int
    second: int
    plane: Polynomial


@dataclass(frozen=True)
class OuterFace:
    """A triangle (vertex indices) of the region's boundary, of a cell and its piece; `plane > 0` outside."""

    vertices: Indices
    cell: int
    piece: int
    plane: Polynomial


class CellComplex:
    """Tetrahedra with their faces; `vertices`, `cells`, `center` and `pieces` are those of `pas.Partition`."""

    open: bool = False

    vertices: tuple[Vector, ...]
    cells: tuple[Indices, ...]
    center: Vector | None
    pieces: tuple[Indices, ...]

    def check_cells(self) -> None:
        """That no cell is flat, and that a face belongs to one cell, or to two on either side of it."""
        for i, cell in enumerate(self.cells):
            a, b, c, d = (self._whole[1][v] for v in cell)
            if not _height(a, b, c, d):
                raise GeometryError(f"cell {i + 1} of the partition is flat")
        for triangle, owners in self.owners.items():
            sides = [self._side(triangle, owner) for owner in owners] if len(owners) == 2 else []
            if len(owners) > 2 or (len(owners) == 2 and sides[0] == sides[1]):
                cells = " and ".join(str(owner + 1) for owner in owners)
                raise GeometryError(f"cells {cells} of the partition overlap at a common face")

    @cached_property
    def owners(self) -> dict[Indices, list[int]]:
        """The cells at each triangle of vertices."""
        owners: dict[Indices, list[int]] = {}
        for number, cell in enumerate(self.cells):
            for triangle in combinations(sorted(cell), 3):
                owners.setdefault(triangle, []).append(number)
        return owners

    @cached_property
    def piece_of(self) -> Integers:
        """The number of each cell's piece, (cells,)."""
        numbers = np.empty(len(self.cells), dtype=np.intp)
        for number, piece in enumerate(self.pieces):
            numbers[list(piece)] = number
        return numbers

    @cached_property
    def interior_faces(self) -> tuple[InteriorFace, ...]:
        """The faces that two pieces share, one for each plane."""
        faces: dict[tuple[int, int, Polynomial], InteriorFace] = {}
        for triangle, *owners in self.inner_triangles:
            first, second = (int(self.piece_of[owner]) for owner in owners)
            if first == second:
                continue
            plane = self._plane(triangle, owners[0])
            if (second, first, -plane) not in faces:
                faces.setdefault((first, second, plane), InteriorFace(triangle, first, second, plane))
        return tuple(faces.values())

    @cached_property
    def inner_triangles(self) -> tuple[tuple[Indices, int, int], ...]:
        """All triangles (vertex indices) that two cells share, with these cells."""
        return tuple((triangle, *owners) for triangle, owners in self.owners.items() if len(owners) == 2)  # type: ignore[misc]

    @cached_property
    def outer_faces(self) -> tuple[OuterFace, ...]:
        """The faces that bound the region, but for those of the sides of an open one."""
        return tuple(face for face in self._boundary if not self._through_center(face))

    @cached_property
    def sides(self) -> tuple[OuterFace, ...]:
        """The faces of the boundary that pass through the centre, of an open region; else none."""
        return tuple(face for face in self._boundary if self._through_center(face))

    @cached_property
    def wall_of(self) -> Integers:
        """The number of each outer face's plane, (outer faces,): faces in one plane have one number."""
        numbers: dict[Polynomial, int] = {}
        return np.array([numbers.setdefault(face.plane, len(numbers)) for face in self.outer_faces], dtype=np.intp)

    @cached_property
    def _boundary(self) -> tuple[OuterFace, ...]:
        return tuple(
            OuterFace(triangle, owners[0], int(self.piece_of[owners[0]]), self._plane(triangle, owners[0]))
            for triangle, owners in self.owners.items()
            if len(owners) == 1
        )

    def _through_center(self, face: OuterFace) -> bool:
        return self.open and self.center in self.corners(face.vertices)

    @cached_property
    def points(self) -> Floats:
        """The vertices as doubles, (vertices, 3)."""
        return np.array([to_floats(v) for v in self.vertices]).reshape(-1, 3)

    def corners(self, indices: Indices) -> tuple[Vector, ...]:
        """The exact points of a cell or face given by vertex indices."""
        return tuple(self.vertices[i] for i in indices)

    def planes(self, cell: int) -> tuple[Polynomial, ...]:
        """The planes of a cell's four faces, negative in the cell, with coprime integer coefficients."""
        return tuple(self._plane(triangle, cell) for triangle in combinations(sorted(self.cells[cell]), 3))

    def barycentric(self, points: Floats, cells: Sequence[int] | None = None) -> Floats:
        """Barycentric coordinates of `points` (N, 3) in every cell, or in given ones: (cells, 4, N)."""
        maps = self.barycentric_maps if cells is None else self.barycentric_maps[list(cells)]
        product = maps[:, :, :3].reshape(-1, 3) @ np.asarray(points).T
        return product.reshape(len(maps), 4, -1) + maps[:, :, 3:]

    def locate(self, points: Floats, tolerance: float = 1e-12) -> Integers:
        """The index of the cell that holds each of `points` (N, 3), -1 outside the region.

        A point further than `tolerance` (barycentric) outside every cell counts as outside.
        """
        depth = self.barycentric(points).min(axis=1)
        best = depth.argmax(axis=0)
        return np.where(depth.max(axis=0) >= -tolerance, best, -1)

    @cached_property
    def barycentric_maps(self) -> Floats:
        """From points and 1 to their barycentric coordinates in each cell, (cells, 4, 4)."""
        corners = np.concatenate([self.points, np.ones((len(self.points), 1))], axis=1)
        return np.linalg.inv(np.swapaxes(corners[np.array(self.cells)], 1, 2))

    def _plane(self, triangle: Indices, cell: int) -> Polynomial:
        """The plane of a face, negative in `cell`, with coprime integer coefficients."""
        denominator, points = self._whole
        a, b, c = (points[v] for v in triangle)
        return _linear(cross(minus(b, a), minus(c, a)), a, denominator, -self._side(triangle, cell))

    def _side(self, triangle: Indices, cell: int) -> int:
        """On which side of a face's plane a cell lies: 1 or -1."""
        opposite = next(v for v in self.cells[cell] if v not in triangle)
        a, b, c, d = (self._whole[1][v] for v in (*triangle, opposite))
        return 1 if _height(a, b, c, d) > 0 else -1

    @cached_property
    def _whole(self) -> tuple[int, list[Whole]]:
        """A common denominator of the vertices' coordinates, and the vertices times it."""
        denominator = lcm(*(int(x.q) for point in self.vertices for x in point))
        return denominator, [three(int(x.p) * (denominator // int(x.q)) for x in point) for point in self.vertices]


def _height(a: Whole, b: Whole, c: Whole, d: Whole) -> int:
    """Six times the volume of a tetrahedron, positive where d is on the side of the normal of a, b, c."""
    return determinant(minus(b, a), minus(c, a), minus(d, a))


def _linear(way: Whole, point: Whole, denominator: int, sign: int) -> Polynomial:
    """What rises along a way, times a sign, from 0 at a point over a denominator; coprime integer coefficients."""
    x, y, z = way
    values = -dot(way, point), denominator * x, denominator * y, denominator * z
    divisor = sign * gcd(*values)
    if divisor == 0:
        raise GeometryError("three points of a face are on one line")
    return Polynomial.from_row((fmpq(v // divisor) for v in values), 1)


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
