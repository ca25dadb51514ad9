"""In which pieces of a partition points lie, for many points at once.

Where there is a centre, the faces between pieces lie in a few planes through it, and the signs at these planes tell
the piece: the planes cut space into cones, each of which lies in one piece.  Which one is worked out exactly, once.
What is left is whether a point is beyond the outer faces of its piece.  Where there is no centre, or there are too
many planes, the cell in which a point is deepest by barycentric coordinates is taken.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.rational import cross, dot, minus, to_floats
from pas.partition.complex import CellComplex, OuterFace
from pas.partition.layout import Ray, primitive, reduced

MOST_PLANES = 12
"""Of 2^planes combinations of signs a table is kept; with more planes the test of all cells is not slower either."""

BLOCK = 1 << 14
"""Points that are located at once."""

Integers = NDArray[np.intp]
Group = tuple[int, Integers, Floats]
"""A piece, the numbers of points (M,) in it, and these points (3, M)."""


class Location:
    """Finds the pieces of points, in the coordinates of a partition in local coordinates (its centre, if any, is 0)."""

    def __init__(self, partition: CellComplex) -> None:
        self.partition = partition

    def groups(self, points: Floats, tolerance: float) -> Iterator[Group]:
        """The points (3, N) by pieces, some thousand at a time; those outside the region are left out.

        A point counts as outside that is further than `tolerance` (barycentric) outside every cell.
        """
        for start in range(0, points.shape[1], BLOCK):
            block = points[:, start : start + BLOCK]
            for piece, rows, inside in self._grouped(block, tolerance):
                yield piece, rows + start, inside

    def pieces(self, points: Floats, tolerance: float) -> Integers:
        """The piece of each of `points` (3, N), -1 outside."""
        result = np.full(points.shape[1], -1, dtype=np.intp)
        for piece, rows, _ in self.groups(points, tolerance):
            result[rows] = piece
        return result

    def _grouped(self, points: Floats, tolerance: float) -> Iterator[Group]:
        if not self.partition.cells:
            yield 0, np.arange(points.shape[1]), points
            return
        if self._planes is None:
            yield from _split(self._deepest(points, tolerance), points)
            return
        for piece, rows, inside in _split(self._seen(points), points):
            within = self._within(piece, inside, tolerance)
            yield (piece, rows, inside) if within.all() else (piece, rows[within], inside.compress(within, axis=1))

    def _seen(self, points: Floats) -> NDArray[np.integer]:
        """The pieces in whose directions points lie."""
        normals, table = self._planes or (np.empty((0, 3)), np.zeros(1, dtype=np.int16))
        codes = np.zeros(points.shape[1], dtype=np.int16)
        for bit, normal in enumerate(normals):
            codes |= (_along(normal, points) >= 0).astype(np.int16) << bit
        found = table[codes]
        strange = np.flatnonzero(found < 0)  # signs that there are only by rounding, where planes meet
        if len(strange):
            found[strange] = self._deepest(points[:, strange], np.inf)
        return found

    def _within(self, piece: int, points: Floats, tolerance: float) -> NDArray[np.bool_]:
        """Whether points in a piece's directions are in the region."""
        walls = self._walls[piece]
        if walls is None:
            depth = self.partition.barycentric(points.T, self.partition.pieces[piece]).min(axis=1).max(axis=0)
            return np.asarray(depth >= -tolerance)
        within = _along(walls[0], points) <= 1 + tolerance
        for wall in walls[1:]:
            within &= _along(wall, points) <= 1 + tolerance
        return np.asarray(within)

    def _deepest(self, points: Floats, tolerance: float) -> NDArray[np.int16]:
        """The pieces of the cells in which points are deepest."""
        cells = self.partition.locate(points.T, tolerance)
        return np.where(cells < 0, -1, self.partition.piece_of[cells]).astype(np.int16)

    @cached_property
    def _planes(self) -> tuple[Floats, NDArray[np.int16]] | None:
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
        if len(normals) > MOST_PLANES:
            return None
        table = np.full(1 << len(normals), -1, dtype=np.int16)
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


def _along(normal: Floats, points: Floats) -> Floats:
    """Scalar products of one vector with points (3, N), with the same rounding on every machine."""
    x, y, z = points
    result: Floats = normal[0] * x
    result += normal[1] * y
    result += normal[2] * z
    return result


def _split(pieces: NDArray[np.integer], points: Floats) -> Iterator[Group]:
    """Points by their pieces; those of piece -1 are left out."""
    order = np.argsort(pieces, kind="stable")  # by radix, for short integers
    ends = np.searchsorted(pieces[order], np.arange(int(pieces.max(initial=-1)) + 2))
    ordered = points.take(order, axis=1)
    for piece, (start, end) in enumerate(pairwise(ends.tolist())):
        if end > start:
            yield piece, order[start:end], ordered[:, start:end]


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
