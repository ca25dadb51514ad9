"""Bodies made face by face, without a lattice, each face on its surface; and rings that close walls."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Self

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.lengths import across
from pas.algebra.polynomial import Polynomial
from pas.arrays import Floats, Integers
from pas.errors import MeshError
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.mesh.shading import unit_rows
from pas.solid.edges import Loop

JetsAt = Callable[[Floats], Floats]
"""From points (N, 3) to the values and gradients (N, 4) of a function whose zero set a face is on."""


COARSE = 2.0**-6
"""Tolerance of meshes that show where a body is, over the size of it."""


def off_surface(surface: Polynomial, points: Floats) -> Floats:
    """How far points (..., 3) are from a surface, (...), to first order."""
    return np.asarray(np.abs(surface(points)) / np.linalg.norm(surface.gradient(points), axis=-1))


@dataclass(frozen=True)
class End:
    """A surface in which both sheets of a wall end; seen along `axis` (3,) against it, the ring between them is seen
    from outside."""

    surface: Polynomial
    axis: Floats

    def off(self, points: Floats) -> float:
        """How far points (..., 3) are from it at most, to first order."""
        return float(off_surface(self.surface, points).max())

    def facing(self, corners: Floats) -> Floats:
        """The areas (T,) of triangles (T, 3, 3) across the axis, positive where they are seen from outside."""
        return np.asarray(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ self.axis)


class Faces:
    """A mesh while it is made: blocks of points, and triangles by the names of their faces."""

    def __init__(self, *points: Floats) -> None:
        self.blocks, self.deviation = [*points], 0.0
        self._faces: list[tuple[str, Integers, Floats]] = []

    @property
    def points(self) -> Floats:
        return np.concatenate(self.blocks)

    def add(self, name: str, triangles: Integers, normals: Floats) -> None:
        if len(triangles):
            self._faces.append((name, triangles, normals))

    def added(self, points: Floats) -> Integers:
        """The numbers of points (N, 3), now among those of the mesh."""
        first = sum(map(len, self.blocks))
        self.blocks.append(points)
        return np.arange(first, first + len(points))

    def ended(self, end: End, name: str, outer: Integers, inner: Integers | None) -> bool:
        """Whether an end closes the mesh at a loop, or in a wall between two loops."""
        points = self.points
        if inner is None:
            (middle,) = self.added(points[outer].mean(axis=0)[None])
            points, triangles = self.points, np.stack([np.roll(outer, -1), outer, np.full(len(outer), middle)], axis=1)
            if end.facing(points[triangles]).min() <= 0:
                return False
        else:
            triangles = ring(points, outer, inner, end.axis, name)
        self.deviation = max(self.deviation, end.off(points[triangles]))
        self.put_curved(name, triangles, end.surface.jets)
        return True

    def put(self, mesh: Mesh, flipped: bool = False) -> int:
        """All of a mesh, perhaps seen from its other side; the number that its first vertex has now."""
        first = int(self.added(mesh.points)[0])
        turned = mesh.flipped if flipped else mesh
        for face, name in enumerate(turned.names):
            self.add(name, turned.triangles[turned.faces == face] + first, turned.normals[turned.faces == face])
        self.deviation = max(self.deviation, mesh.deviation or 0.0)
        return first

    def put_side(self, name: str, rows: Sequence[Integers], jets: JetsAt) -> None:
        """The face between rows of vertices (N,): seen from outside, each is to the left of the one before it.

        A row may be one vertex, repeated.  `jets` are those of the surface, of either sign.
        """
        quads = [(a[:-1], a[1:], b[1:], b[:-1]) for a, b in pairwise(rows)]
        corners = [np.stack(t, axis=1) for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
        self.put_curved(name, np.concatenate(corners), jets)

    def put_curved(self, name: str, triangles: Integers, jets: JetsAt) -> None:
        """A face by triangles (T, 3), without those that have a vertex twice; `jets` as in `put_side`.

        How far the middles of their edges are from the surface is noted.
        """
        triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
        corners = self.points[triangles]
        slopes = jets(corners.reshape(-1, 3))[:, 1:].reshape(-1, 3, 3)
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        slopes *= np.sign((slopes * facing[:, None, :]).sum(axis=-1, keepdims=True))
        self.add(name, triangles, unit_rows(slopes))
        found = jets(((corners + np.roll(corners, 1, axis=1)) / 2).reshape(-1, 3))
        off = np.abs(found[:, 0]) / np.linalg.norm(found[:, 1:], axis=1)
        self.deviation = max(self.deviation, float(off.max()))

    def put_flat(self, name: str, triangles: Integers, normal: Floats) -> None:
        """A flat face of vertices (T, 3) with a unit normal (3,)."""
        self.add(name, triangles, np.broadcast_to(normal, (len(triangles), 3, 3)))

    def put_level(self, name: str, rows: Sequence[Integers], sign: int) -> None:
        """Add the flat face inside rows of vertices, seen from above or, where `sign` is -1, from below.

        Raises `FloatingPointError` where the rows bound none.
        """
        rims = [row[row != np.roll(row, 1)] for row in rows]
        triangles = flat([self.points[rim, :2] for rim in rims])
        if not len(triangles):
            raise FloatingPointError(f"nothing is inside the face {name!r}")
        self.put_flat(name, np.concatenate(rims)[triangles][:, ::sign], np.array([0.0, 0.0, sign]))

    @property
    def mesh(self) -> Mesh:
        """All of them, in order; a name may stand there several times."""
        faces = np.repeat(np.arange(len(self._faces)), [len(triangles) for _, triangles, _ in self._faces])
        triangles, normals = (np.concatenate([face[i] for face in self._faces]) for i in (1, 2))
        names = tuple(name for name, _, _ in self._faces)
        return Mesh(self.points, triangles, faces, names, normals, deviation=self.deviation)


class SolidBoundary(ABC):
    """A boundary of a solid that is meshed without a lattice."""

    @property
    @abstractmethod
    def coarse(self) -> Mesh | None:
        """A coarse mesh, which shows where the boundary is; None where it has none."""

    @abstractmethod
    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        """A closed mesh within a tolerance (the model's units), as measured; None where there is none."""

    @abstractmethod
    def moved(self, map_: Affine) -> Self:
        """The image under an affine map."""


@dataclass(frozen=True, eq=False)
class PlacedBody(SolidBoundary):
    """A boundary all faces of which are meshed without a lattice; `place` is the map that moved it."""

    place: Affine | None = field(default=None, kw_only=True)

    def moved(self, map_: Affine) -> Self:
        return replace(self, place=map_ if self.place is None else map_.after(self.place))

    @cached_property
    def coarse(self) -> Mesh | None:
        return self.mesh(COARSE * self.stretch * self.extent, Quality.BALANCED)

    @property
    def stretch(self) -> float:
        """The largest factor by which the map lengthens."""
        return 1.0 if self.place is None else float(np.linalg.norm(self.place.floats[0], 2))

    @property
    @abstractmethod
    def extent(self) -> float:
        """The approximate size before it was moved."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FacedBody(PlacedBody):
    """A boundary all faces of which are meshed at once."""

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        with suppress(FloatingPointError):
            faces = self.made(tolerance / self.stretch)
            if faces.deviation * self.stretch <= tolerance:
                return faces.mesh if self.place is None else faces.mesh._moved(self.place)
        return None

    @abstractmethod
    def made(self, tolerance: float) -> Faces:
        """Its faces before it was moved, within a tolerance; raises `FloatingPointError` where rounding spoils them."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SweptBody(FacedBody):
    """The boundary of a solid that the loops of a profile sweep out."""

    loops: tuple[Loop, ...]

    @property
    def extent(self) -> float:
        return max(loop.size for loop in self.loops)

    def polygons(self, tolerance: float) -> tuple[list[Floats], list[list[int]], Integers]:
        """Points (N, 2) of each loop, how many are of each edge, and triangles (T, 3) of all points inside.

        Chords are as short as the tolerance needs, and so that they do not cross; raises `FloatingPointError` where
        they do to rounding.
        """
        finest = 2.0**-40  # over the profile's size: where chords cross even then, so do edges, to rounding
        while tolerance > finest * self.extent:
            found = [loop.polygon(tolerance / loop.size) for loop in self.loops]
            points, counts = [points for points, _ in found], [counts for _, counts in found]
            with suppress(FloatingPointError):
                return points, counts, flat(points)
            tolerance /= 4
        raise FloatingPointError("the chords of a profile cross")


def flat(polygons: Sequence[Floats]) -> Integers:
    """Triangles (T, 3) between the points of polygons (N, 2), which are numbered in order.

    The polygons have what is inside to their left.  Raises `FloatingPointError` where they cross.
    """
    from manifold3d import triangulate

    points = np.concatenate(polygons)
    size = float(np.ptp(points, axis=0).max())
    moved = [np.asarray(p - points.min(axis=0), dtype=np.float64) for p in polygons]
    made = np.asarray(triangulate(moved, 0.0), dtype=np.intp)
    corners = np.concatenate(moved)[made]
    areas = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inside = sum(float(cross(p, np.roll(p, -1, axis=0)).sum()) for p in moved)
    whole = abs(areas.sum() - inside) <= 1e-12 * size * size
    if not whole or areas.min(initial=1.0) < -1e-14 * size * size:
        raise FloatingPointError("polygons cross")
    return made


def cross(u: Floats, v: Floats) -> Floats:
    """The determinants (N,) of vectors (N, 2)."""
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def ring(points: Floats, outer: Integers, inner: Integers, normal: Floats, name: str) -> Integers:
    """Triangles between two loops around a normal, counterclockwise seen from its tip."""
    middle = points[inner].mean(axis=0)
    rings = []
    for given in (outer, inner):
        x, y = across(normal) @ (points[given] - middle).T
        angles = np.arctan2(y, x)
        turned = np.unwrap(angles)
        step = 1 if turned[-1] > turned[0] else -1
        begin = int(angles.argmin())
        angles, loop = (np.roll(some, -begin)[::step] for some in (angles, given))
        angles, loop = (some if step == 1 else np.roll(some, 1) for some in (angles, loop))
        if (np.diff(angles) <= 0).any():
            raise MeshError(f"{name} is no ring that can be seen around from the middle of its inner curve")
        rings.append((loop, np.append(angles[1:], angles[0] + 2 * np.pi)))
    (wide, out), (narrow, within) = rings
    is_out = np.argsort(np.concatenate([out, within]), kind="stable") < len(wide)  # by where the next vertices are
    steps = np.stack([is_out, ~is_out])
    met: Integers = np.cumsum(steps, axis=1) - steps  # before each
    here, there = (loop[(met + steps) % len(loop)] for loop in (wide, narrow))
    return np.stack(
        [wide[met[0] % len(wide)], np.where(is_out, here[0], there[1]), narrow[met[1] % len(narrow)]], axis=1
    )
