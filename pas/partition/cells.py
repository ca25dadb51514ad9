"""Partitions of a star-shaped region into tetrahedra, with their faces and planes, exact.

Every interior face of these partitions lies in a plane through the centre and every cell is
star-shaped around it, so a ray from the centre stays in one cell until it leaves the region.
That is what lets a surface be proved to be met once by each ray (see `pas.surface.proofs`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from flint import fmpq

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, cross, dot, to_floats
from pas.errors import GeometryError
from pas.partition.frame import Frame

Indices = tuple[int, ...]


@dataclass(frozen=True)
class InteriorFace:
    """A triangle (vertex indices) between cells `first` and `second`, in the plane `plane = 0`."""

    vertices: Indices
    first: int
    second: int
    plane: Polynomial


@dataclass(frozen=True)
class OuterFace:
    """A triangle (vertex indices) of the region's boundary; `plane > 0` outside."""

    vertices: Indices
    cell: int
    plane: Polynomial


class Partition:
    """Tetrahedra around a centre.

    `vertices` are exact points, `cells` quadruples of vertex indices, `center` an exact point
    in the interior of the region from which every cell is seen undivided.

    Raises `GeometryError` for a flat cell, cells that overlap, or cells that are not all around
    the centre.
    """

    name = "tetrahedra"

    def __init__(self, vertices: Sequence[Vector], cells: Sequence[Indices], center: Vector) -> None:
        self.vertices = tuple(vertices)
        self.cells = tuple(tuple(cell) for cell in cells)
        self.center = center
        for i, cell in enumerate(self.cells):
            if _volume(*(self.vertices[v] for v in cell)) == 0:
                raise GeometryError(f"cell {i + 1} of the partition is flat")
        self._check_faces()
        self._check_around_center()

    def _check_faces(self) -> None:
        """That a face belongs to one cell, or to two on either side of it."""
        for triangle, owners in self._owners.items():
            sides = [self._side(triangle, owner) for owner in owners]
            if len(owners) > 2 or (len(owners) == 2 and sides[0] == sides[1]):
                cells = " and ".join(str(owner + 1) for owner in owners)
                raise GeometryError(f"cells {cells} of the partition overlap at a common face")

    def _check_around_center(self) -> None:
        """That every cell touches the centre and that they surround it once."""
        if any(face.plane.at(self.center) != 0 for face in self.interior_faces):
            raise GeometryError("an interior face of the partition does not pass through its centre")
        if any(face.plane.at(self.center) >= 0 for face in self.outer_faces):
            raise GeometryError("the centre of the partition is not inside the region")
        rays = self.points - np.array(to_floats(self.center))
        total = sum(_solid_angle(*rays[list(face.vertices)]) for face in self.outer_faces)
        if abs(total / (4 * np.pi) - 1) > 1e-6:
            raise GeometryError("the cells of the partition do not surround its centre exactly once")

    @cached_property
    def frame(self) -> Frame:
        """The local frame of this region."""
        return Frame.around(self.center, self.vertices)

    @cached_property
    def local(self) -> Partition:
        """The same partition in local coordinates (centre 0, size about 1)."""
        points = [self.frame.local_point(v) for v in self.vertices]
        return Partition(points, self.cells, self.frame.local_point(self.center))

    @cached_property
    def interior_faces(self) -> tuple[InteriorFace, ...]:
        """The faces that two cells share."""
        return tuple(
            InteriorFace(triangle, owners[0], owners[1], self._plane(triangle, owners[0]))
            for triangle, owners in self._owners.items()
            if len(owners) == 2
        )

    @cached_property
    def outer_faces(self) -> tuple[OuterFace, ...]:
        """The faces that bound the region."""
        return tuple(
            OuterFace(triangle, owners[0], self._plane(triangle, owners[0]))
            for triangle, owners in self._owners.items()
            if len(owners) == 1
        )

    @cached_property
    def points(self) -> Floats:
        """The vertices as doubles, (vertices, 3)."""
        return np.array([to_floats(v) for v in self.vertices])

    def corners(self, indices: Indices) -> tuple[Vector, ...]:
        """The exact points of a cell or face given by vertex indices."""
        return tuple(self.vertices[i] for i in indices)

    def barycentric(self, points: Floats) -> Floats:
        """Barycentric coordinates of `points` (N, 3) in every cell: (cells, 4, N)."""
        maps = self._barycentric_maps
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
        plane = plane_through(*self.corners(triangle))
        return -plane if self._side(triangle, cell) > 0 else plane

    def _side(self, triangle: Indices, cell: int) -> int:
        """On which side of a face's plane a cell lies: 1 or -1."""
        opposite = next(v for v in self.cells[cell] if v not in triangle)
        value = plane_through(*self.corners(triangle)).at(self.vertices[opposite])
        return 1 if value > 0 else -1


def plane_through(a: Vector, b: Vector, c: Vector) -> Polynomial:
    """The plane through three points, as a linear polynomial with coprime integer coefficients."""
    normal = cross(_minus(b, a), _minus(c, a))
    raw = sum((n * (g - o) for n, g, o in zip(normal, GENERATORS, a, strict=True)), GENERATORS[0] * 0)
    if raw.is_zero():
        raise GeometryError("three points of a face are on one line")
    content = raw.coeffs()[0]
    scaled = raw * (1 / abs(content))
    denominator = 1
    for coefficient in scaled.coeffs():
        denominator = int(coefficient.q.lcm(denominator))
    return Polynomial.from_raw(scaled * denominator)


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _volume(a: Vector, b: Vector, c: Vector, d: Vector) -> fmpq:
    return dot(_minus(b, a), cross(_minus(c, a), _minus(d, a))) / 6


def _solid_angle(a: Floats, b: Floats, c: Floats) -> float:
    """The solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983)."""
    la, lb, lc = (float(np.linalg.norm(v)) for v in (a, b, c))
    triple = abs(float(a @ np.cross(b, c)))
    below = la * lb * lc + float(a @ b) * lc + float(b @ c) * la + float(c @ a) * lb
    return 2 * float(np.arctan2(triple, below))
