"""Meshes of walls: two open sheets, one inside the other, closed by rings between their boundaries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pas.algebra.polynomial import Polynomial
from pas.errors import MeshError
from pas.mesh.mesh import Mesh
from pas.mesh.rows import Floats, Integers
from pas.mesh.topology import Edges


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


def wall_mesh(outer: Mesh, inner: Mesh, ends: Sequence[End], names: Sequence[str]) -> Mesh:
    """The closed mesh between two sheets that end in the same surfaces, planes or cones.

    `names` are the faces': the outer sheet's, the inner one's, and each end's.  Raises `MeshError` where an end is no
    ring, as where curves are not seen around from the middle of the inner one.
    """
    sheets = [(outer.points, outer.triangles), (inner.points, inner.triangles[:, ::-1])]
    points, start = np.concatenate([p for p, _ in sheets]), len(outer.points)
    triangles = [outer.triangles, sheets[1][1] + start]
    own, others = (Edges(mesh.triangles, len(mesh.points)).loops for mesh in (outer, inner))
    loops = own, [loop + start for loop in others]
    normals = [outer.normals, -inner.normals[:, ::-1]]
    for end, name in zip(ends, names[2:], strict=True):
        pair = [min(some, key=lambda loop: end.off(points[loop]), default=None) for some in loops]
        if pair[0] is None or pair[1] is None:
            raise MeshError(f"one of the two sheets does not end in {name}")
        triangles.append(ring(points, pair[0], pair[1], end.axis, name))
        normals.append(end.normals(points[triangles[-1]]))
    faces = np.repeat(np.arange(len(triangles)), [len(t) for t in triangles])
    known = [m.deviation for m in (outer, inner) if m.deviation is not None]
    return Mesh(
        points,
        np.concatenate(triangles),
        faces,
        tuple(names),
        np.concatenate(normals),
        deviation=max(known) if len(known) == 2 else None,
    )


def least_distance(first: Mesh, second: Mesh) -> tuple[float, Floats]:
    """The least distance of the vertices of each of two meshes from the other, and the vertex (3,) where it is.

    Measured between the meshes, so that it is off by as much as these are.
    """
    best, where = np.inf, np.zeros(3)
    for one, other in ((first, second), (second, first)):
        found = one.to_pyvista().compute_implicit_distance(other.to_pyvista())
        distances = np.abs(np.asarray(found["implicit_distance"]))
        if distances.min() < best:
            best, where = float(distances.min()), np.asarray(found.points[distances.argmin()], dtype=float)
    return best, where


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
