"""Partitions of a region into tetrahedra, with their faces and planes, exact.

Cells are tetrahedra.  A piece is one cell, or several that share one polynomial (a cone over a
polygon, a box).

With a centre, every interior face lies in a plane through it and every cell touches it, so a ray
from the centre stays in one cell until it leaves the region.  That is what lets a surface be
proved to be met once by each ray (see `pas.certify.proofs`).  A mesh without a centre serves
for everything but that proof.

A kind of partitions may be `open`: its centre is the apex of a convex cone that the cells fill up to some faces.
Those of its sides, which pass through the centre, are no outer faces: no ray leaves through them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any, ClassVar, Self

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from pas.algebra.affine import Affine
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import (
    Vector,
    VectorLike,
    binary_exponent,
    cross,
    dot,
    minus,
    plain,
    to_float,
    to_floats,
    vector,
)
from pas.described import constructor_keys
from pas.errors import GeometryError
from pas.partition.around import check_around_center
from pas.partition.frame import Frame
from pas.partition.layout import Layout
from pas.partition.location import Location
from pas.partition.outline import outline
from pas.partition.planes import Whole, linear, normal, over_one

Indices = tuple[int, ...]


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
    """A triangle (vertex indices) of the region's boundary, of a cell and its piece; `plane > 0`
    outside."""

    vertices: Indices
    cell: int
    piece: int
    plane: Polynomial


class Partition:
    """A region cut into tetrahedra.

    `vertices` are exact points (three numbers each), `cells` quadruples of vertex indices,
    `center` an exact point in the interior of the region from which every cell is seen
    undivided, or None for a mesh that has none.  `pieces` groups cells (tuples of their numbers)
    that share one polynomial; by default each cell is a piece of its own.  `title` says in summaries what it is.

    Raises `GeometryError` for a flat cell, cells that overlap at a common face, or cells that do not
    surround the centre exactly once (so that none overlap; without a centre that is not looked into);
    `ValueError` for indices that do not exist or pieces that do not hold each cell once.
    """

    name = "tetrahedra"
    open: ClassVar[bool] = False

    def __repr__(self) -> str:
        called = f" {self.title!r}" if self.title != self.name else ""
        return f"<{type(self).__name__}{called}: {len(self.cells)} cells in {len(self.pieces)} pieces>"

    def __init__(
        self,
        vertices: Sequence[VectorLike],
        cells: Sequence[Sequence[int]],
        center: VectorLike | None = None,
        pieces: Sequence[Sequence[int]] | None = None,
        title: str = "",
    ) -> None:
        self.title = title or self.name
        self.vertices = tuple(vector(v, f"vertices[{i}]") for i, v in enumerate(vertices))
        self.cells = tuple(tuple(cell) for cell in cells)
        self.center = None if center is None else vector(center, "center")
        self.pieces = tuple((i,) for i in range(len(self.cells))) if pieces is None else tuple(map(tuple, pieces))
        self._check_indices()
        self._check()

    def _check(self) -> None:
        """That the cells are a region around the centre; raises `GeometryError`."""
        for i, cell in enumerate(self.cells):
            if _volume(*(self.vertices[v] for v in cell)) == 0:
                raise GeometryError(f"cell {i + 1} of the partition is flat")
        self._check_faces()
        if self.center is not None and self.cells:
            check_around_center(self, self.center)
        elif self.open:
            raise GeometryError("a partition that is open must have a centre, the corner of its cells")

    def to_record(self) -> dict[str, Any]:
        """The partition as a table of plain data, exact numbers as texts; its kind is its `name`."""
        return {
            "kind": Partition.name,
            "center": None if self.center is None else written(self.center),
            "vertices": [written(v) for v in self.vertices],
            "cells": [list(cell) for cell in self.cells],
            "pieces": [list(piece) for piece in self.pieces],
        } | ({} if self.title == self.name else {"title": self.title})

    @classmethod
    def keys(cls) -> Mapping[str, bool]:
        """The keys of its tables besides the kind, and whether they must have them."""
        return constructor_keys(cls)

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Self:
        """The partition of a table, without its kind; raises as the constructor does."""
        return cls(**record)

    def moved(self, map_: Affine) -> Partition:
        """The image under an affine map, exact; cells and pieces keep their numbers."""
        center = None if self.center is None else map_.exact(self.center)
        return Partition([map_.exact(v) for v in self.vertices], self.cells, center, self.pieces)

    def _check_indices(self) -> None:
        for i, cell in enumerate(self.cells):
            if len(set(cell)) != 4 or not all(0 <= v < len(self.vertices) for v in cell):
                raise ValueError(f"cells[{i}] must be four different vertex numbers below {len(self.vertices)}")
        if sorted(c for piece in self.pieces for c in piece) != list(range(len(self.cells))):
            raise ValueError(f"pieces must hold each of the {len(self.cells)} cells once")

    def _check_faces(self) -> None:
        """That a face belongs to one cell, or to two on either side of it."""
        for triangle, owners in self._owners.items():
            sides = [self._side(triangle, owner) for owner in owners] if len(owners) == 2 else []
            if len(owners) > 2 or (len(owners) == 2 and sides[0] == sides[1]):
                cells = " and ".join(str(owner + 1) for owner in owners)
                raise GeometryError(f"cells {cells} of the partition overlap at a common face")

    @cached_property
    def frame(self) -> Frame:
        """The local frame of this region."""
        if not self.vertices:
            return Frame((fmpq(0), fmpq(0), fmpq(0)), fmpq(1))
        return Frame.around(self.center or _middle(self.vertices), self.vertices)

    @cached_property
    def local(self) -> Partition:
        """The same partition in local coordinates (centre, if any, 0; size about 1)."""
        return self.in_frame(self.frame)

    def in_frame(self, frame: Frame) -> Partition:
        """The same partition in the local coordinates of a frame, as open as this one."""
        image = self._bare()  # what was looked at in the constructor holds in it as well
        image.vertices = tuple(frame.local_point(v) for v in self.vertices)
        image.center = None if self.center is None else frame.local_point(self.center)
        image.title, image.cells, image.pieces = self.title, self.cells, self.pieces
        image.__dict__["_owners"] = self._owners  # which do not depend on coordinates
        return image

    def _bare(self) -> Partition:
        """One without anything, as open as this one."""
        return object.__new__(Partition)

    @cached_property
    def layout(self) -> Layout | None:
        """The directions in which the pieces lie; None without a centre or where a piece is no disc seen from it."""
        return outline(self)

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
        for triangle, owners in self._owners.items():
            if len(owners) == 2:
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
        return tuple((triangle, *owners) for triangle, owners in self._owners.items() if len(owners) == 2)  # type: ignore[misc]

    @cached_property
    def outer_faces(self) -> tuple[OuterFace, ...]:
        """The faces that bound the region, but for those of the sides of an open one."""
        return tuple(face for face in self._boundary if not self._through_center(face))

    @cached_property
    def wall_of(self) -> NDArray[np.intp]:
        """The number of each outer face's plane, (outer faces,): faces in one plane have one number."""
        numbers: dict[Polynomial, int] = {}
        return np.array([numbers.setdefault(face.plane, len(numbers)) for face in self.outer_faces], dtype=np.intp)

    @cached_property
    def sides(self) -> tuple[OuterFace, ...]:
        """The faces of the boundary that pass through the centre, of an open region; else none."""
        return tuple(face for face in self._boundary if self._through_center(face))

    @cached_property
    def _boundary(self) -> tuple[OuterFace, ...]:
        return tuple(
            OuterFace(triangle, owners[0], int(self.piece_of[owners[0]]), self._plane(triangle, owners[0]))
            for triangle, owners in self._owners.items()
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

    @cached_property
    def location(self) -> Location:
        """What finds the pieces of many points; for a partition in local coordinates."""
        return Location(self)

    def barycentric(self, points: Floats, cells: Sequence[int] | None = None) -> Floats:
        """Barycentric coordinates of `points` (N, 3) in every cell, or in given ones: (cells, 4, N)."""
        maps = self._barycentric_maps if cells is None else self._barycentric_maps[list(cells)]
        product = maps[:, :, :3].reshape(-1, 3) @ np.asarray(points).T
        return product.reshape(len(maps), 4, -1) + maps[:, :, 3:]

    def locate(self, points: Floats, tolerance: float = 1e-12) -> np.ndarray:
        """The index of the cell that holds each of `points` (N, 3), -1 outside the region.

        A point further than `tolerance` (barycentric) outside every cell counts as outside.
        """
        depth = self.barycentric(points).min(axis=1)
        best = depth.argmax(axis=0)
        return np.where(depth.max(axis=0) >= -tolerance, best, -1)

    def place(self, point: Vector, name: str = "the point") -> tuple[int, Vector]:
        """The piece that holds a point, and the point's local coordinates.

        Raises `ValueError`, with the point's `name`, outside the region (all of space where there
        are no cells).
        """
        local = self.frame.local_point(point)
        if not self.cells:
            return 0, local
        cell = int(self.local.locate(np.array([to_floats(local)]))[0])
        if cell < 0:
            raise ValueError(
                f"{name} lies outside the region of the partition; a point at ({', '.join(map(plain, point))}) "
                "has no influence on the surface"
            )
        return int(self.piece_of[cell]), local

    @cached_property
    def _barycentric_maps(self) -> Floats:
        corners = np.concatenate([self.points, np.ones((len(self.points), 1))], axis=1)
        return np.linalg.inv(np.swapaxes(corners[np.array(self.cells)], 1, 2))

    @cached_property
    def _owners(self) -> dict[Indices, list[int]]:
        owners: dict[Indices, list[int]] = {}
        for number, cell in enumerate(self.cells):
            for triangle in combinations(sorted(cell), 3):
                owners.setdefault(triangle, []).append(number)
        return owners

    def _plane(self, triangle: Indices, cell: int) -> Polynomial:
        """The plane of a face, negative in `cell`, with coprime integer coefficients."""
        denominator, points = self._whole
        a, b, c = (points[v] for v in triangle)
        return linear(normal(a, b, c), a, denominator, -self._side(triangle, cell))

    def _side(self, triangle: Indices, cell: int) -> int:
        """On which side of a face's plane a cell lies: 1 or -1."""
        opposite = next(v for v in self.cells[cell] if v not in triangle)
        a, b, c, d = (self._whole[1][v] for v in (*triangle, opposite))
        value = sum(n * (y - x) for n, x, y in zip(normal(a, b, c), a, d, strict=True))
        return 1 if value > 0 else -1

    @cached_property
    def _whole(self) -> tuple[int, list[Whole]]:
        """A common denominator of the vertices' coordinates, and the vertices times it."""
        return over_one(self.vertices)


def _middle(points: Sequence[Vector]) -> Vector:
    """The middle of the bounding box, rounded to few binary digits: any origin nearby will do."""
    ends = [(min(column), max(column)) for column in zip(*points, strict=True)]
    step = fmpq(2) ** (binary_exponent(max(high - low for low, high in ends)) - 4)
    x, y, z = (fmpq(round(to_float((low + high) / (2 * step)))) * step for low, high in ends)
    return x, y, z


def written(point: Vector) -> list[str]:
    """Three exact numbers as texts."""
    return [plain(c) for c in point]


def _volume(a: Vector, b: Vector, c: Vector, d: Vector) -> fmpq:
    return dot(cross(minus(b, a), minus(c, a)), minus(d, a)) / 6
