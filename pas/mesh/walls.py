"""What closes meshes of walls between two open sheets, one inside the other: rings between their boundaries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.algebra.polynomial import Polynomial
from pas.errors import MeshError
from pas.mesh.rows import Floats, Integers


@dataclass(frozen=True)
class End:
    """A surface in which both sheets of a wall end, positive outside; seen along `axis` (3,) against it, the ring
    between them is seen from outside."""

    surface: Polynomial
    axis: Floats

    def distances(self, points: Floats) -> Floats:
        """How far points (N, 3) are from it, (N,), to first order."""
        slopes = self.surface.gradient(points)
        return np.asarray(np.abs(self.surface(points)) / np.linalg.norm(slopes, axis=-1))

    def off(self, points: Floats) -> float:
        """How far points (N, 3) are from it at most, to first order."""
        return float(self.distances(points).max())

    def facing(self, corners: Floats) -> Floats:
        """Of triangles (T, 3, 3) the area (T,) across the axis, positive where they are seen from outside."""
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return np.asarray(across @ self.axis)

    def normals(self, points: Floats) -> Floats:
        """The unit normals (..., 3) outwards at points of it."""
        slopes = self.surface.gradient(points)
        return np.asarray(slopes / np.linalg.norm(slopes, axis=-1, keepdims=True))


def ring(points: Floats, outer: Integers, inner: Integers, normal: Floats, name: str) -> Integers:
    """Triangles between two loops around a normal, counterclockwise seen from its tip."""
    middle = points[inner].mean(axis=0)
    first = points[inner[0]] - middle
    first = first - (first @ normal) * normal
    axes = np.stack([first, np.cross(normal, first)])
    rings = []
    for given in (outer, inner):
        x, y = axes @ (points[given] - middle).T
        angles = np.arctan2(y, x)
        turned = np.unwrap(angles)
        step = 1 if turned[-1] > turned[0] else -1
        begin = int(angles.argmin())
        angles, loop = (np.roll(some, -begin)[::step] for some in (angles, given))
        angles, loop = (some if step == 1 else np.roll(some, 1) for some in (angles, loop))
        if (np.diff(angles) <= 0).any():
            raise MeshError(f"{name} is no ring that can be seen around from the middle of its inner curve")
        rings.append((loop.tolist(), [*angles.tolist(), angles[0] + 2 * np.pi]))
    (wide, out), (narrow, within) = rings
    found, i, j = [], 0, 0
    while i < len(wide) or j < len(narrow):
        a, b = wide[i % len(wide)], narrow[j % len(narrow)]
        if j == len(narrow) or (i < len(wide) and out[i + 1] <= within[j + 1]):
            i += 1
            found.append((a, wide[i % len(wide)], b))
        else:
            j += 1
            found.append((a, narrow[j % len(narrow)], b))
    return np.array(found)
