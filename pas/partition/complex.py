"""Complexes of tetrahedra: their faces, the planes of these, and what lies in which cell, exact.

Cells are tetrahedra.  A piece is one cell, or several that share one polynomial (a cone over a polygon, a box).
Planes are worked out in whole numbers: vertices are taken times a common denominator of their coordinates.

A complex may be `open`: its centre is the apex of a convex cone that the cells fill up to some faces.  Those of its
sides, which pass through the centre, are no outer faces: no ray leaves through them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from math import gcd, lcm

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, cross, dot, minus, to_floats
from pas.errors import GeometryError

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
    def piece_of(self) -> NDArray[np.intp]:
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
    def wall_of(self) -> NDArray[np.intp]:
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

    def locate(self, points: Floats, tolerance: float = 1e-12) -> np.ndarray:
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
        return _linear(_normal(a, b, c), a, denominator, -self._side(triangle, cell))

    def _side(self, triangle: Indices, cell: int) -> int:
        """On which side of a face's plane a cell lies: 1 or -1."""
        opposite = next(v for v in self.cells[cell] if v not in triangle)
        a, b, c, d = (self._whole[1][v] for v in (*triangle, opposite))
        return 1 if _height(a, b, c, d) > 0 else -1

    @cached_property
    def _whole(self) -> tuple[int, list[Whole]]:
        """A common denominator of the vertices' coordinates, and the vertices times it."""
        return _over_one(self.vertices)


def _over_one(points: Sequence[Vector]) -> tuple[int, list[Whole]]:
    """A common denominator, and points times it."""
    denominator = lcm(*(int(x.q) for point in points for x in point))
    whole = [[int(x.p) * (denominator // int(x.q)) for x in point] for point in points]
    return denominator, [(x, y, z) for x, y, z in whole]


def _normal(a: Whole, b: Whole, c: Whole) -> Whole:
    """The vector product of b - a and c - a."""
    return cross(minus(b, a), minus(c, a))


def _height(a: Whole, b: Whole, c: Whole, d: Whole) -> int:
    """Six times the volume of a tetrahedron, positive where d is on the side of the normal of a, b, c."""
    return dot(_normal(a, b, c), minus(d, a))


def _linear(way: Whole, point: Whole, denominator: int, sign: int) -> Polynomial:
    """What rises along a way, times a sign, from 0 at a point over a denominator; coprime integer coefficients."""
    x, y, z = way
    values = -dot(way, point), denominator * x, denominator * y, denominator * z
    divisor = sign * gcd(*values)
    if divisor == 0:
        raise GeometryError("three points of a face are on one line")
    return Polynomial.from_row((fmpq(v // divisor) for v in values), 1)
