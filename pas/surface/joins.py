"""Where contacts sit on a partition: the clip faces and the curves in them.

A `Join` is one contact together with the outer faces that lie in its clip plane and the cells
the pieces behind them, which carry the contact.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector
from pas.errors import GeometryError
from pas.partition.cells import OuterFace, Partition
from pas.surface.contact import Contact

CURVE_LATTICE = 24
"""Subdivisions of a clip face's edge when its curve is sampled: some fifty points a curve."""


@dataclass(frozen=True)
class Join:
    """A contact, the clip faces it passes through and the partition they belong to."""

    contact: Contact
    faces: tuple[OuterFace, ...]
    partition: Partition

    @property
    def pieces(self) -> tuple[int, ...]:
        """The pieces that carry the contact."""
        if len(self.partition.pieces) == 1:
            return (0,)
        return tuple(dict.fromkeys(face.piece for face in self.faces))

    def rim(self) -> list[tuple[Vector, Vector]]:
        """The edges that bound the union of the clip faces."""
        owners = Counter(edge for face in self.faces for edge in combinations(face.vertices, 2))
        a = self.partition.vertices
        return [(a[i], a[j]) for (i, j), times in owners.items() if times == 1]

    def curve(self) -> Floats:
        """Points (m, 3) of the contact curve, spread along it, to about 1e-14."""
        points = [_zeros_on_triangle(self.contact.surface, c) for c in self._triangles()]
        return np.concatenate([np.empty((0, 3)), *points])

    @cached_property
    def radius(self) -> float:
        """The smallest distance of the curve from its mean point (a circle's radius)."""
        curve = self.curve()
        if not len(curve):
            return np.inf
        return float(np.linalg.norm(curve - curve.mean(axis=0), axis=1).min())

    def inside_point(self) -> Vector | None:
        """An exact point of a clip face where the surface is negative, if a lattice has one."""
        for face in self.faces:
            a, b, c = self.partition.corners(face.vertices)
            for i in range(CURVE_LATTICE + 1):
                for j in range(CURVE_LATTICE + 1 - i):
                    u, v = i, j
                    w = CURVE_LATTICE - i - j
                    x, y, z = ((u * p + v * q + w * r) / CURVE_LATTICE for p, q, r in zip(a, b, c, strict=True))
                    if self.contact.surface.at((x, y, z)) < 0:
                        return x, y, z
        return None

    def _triangles(self) -> list[Floats]:
        return [self.partition.points[list(face.vertices)] for face in self.faces]


def joins(partition: Partition, contacts: Sequence[Contact]) -> tuple[Join, ...]:
    """The place of each contact on the partition.

    A single piece carries every contact, wherever its clip lies; in any other partition a contact
    needs a face: raises `GeometryError` for a clip in whose plane no outer face lies.
    """
    result = []
    for number, contact in enumerate(contacts, start=1):
        faces = tuple(
            face
            for face in partition.outer_faces
            if all(contact.clip.at(p) == 0 for p in partition.corners(face.vertices))
        )
        if not faces and len(partition.pieces) > 1:
            raise GeometryError(
                f"contact {number}: no outer face of the partition ({partition.name}) lies in "
                f"its clip plane {contact.clip} = 0"
            )
        result.append(Join(contact, faces, partition))
    return tuple(result)


def lattice(corners: Floats, subdivisions: int) -> tuple[Floats, np.ndarray]:
    """Points of a triangle's uniform lattice (m, 3), and the edges of its small triangles."""
    n = subdivisions
    index = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(n + 1) for j in range(n + 1 - i))}
    weights = np.array([(i, j, n - i - j) for i, j in index]) / n
    steps = ((1, 0), (0, 1), (1, -1))
    pairs = [(k, index[i + di, j + dj]) for (i, j), k in index.items() for di, dj in steps if (i + di, j + dj) in index]
    return weights @ corners, np.array(pairs)


def _zeros_on_triangle(surface: Polynomial, corners: Floats) -> Floats:
    points, pairs = lattice(corners, CURVE_LATTICE)
    values = surface(points)
    crossing = pairs[(values[pairs[:, 0]] < 0) != (values[pairs[:, 1]] < 0)]
    low, high = points[crossing[:, 0]], points[crossing[:, 1]]
    negative_first = (values[crossing[:, 0]] < 0)[:, None]
    low, high = np.where(negative_first, low, high), np.where(negative_first, high, low)
    for _ in range(52):
        middle = (low + high) / 2
        negative = (surface(middle) < 0)[:, None]
        low, high = np.where(negative, middle, low), np.where(negative, high, middle)
    return (low + high) / 2
