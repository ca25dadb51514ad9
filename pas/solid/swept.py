"""Meshes of solids that are extruded or revolved from profiles, made of the profile's polygon without a lattice."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pas.algebra.polynomial import Polynomial
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.mesh.rows import Floats, Integers
from pas.solid.edges import Loop
from pas.solid.sheets import Faces, PlacedBody

Jets = Callable[[Floats], tuple[Floats, Floats]]
"""From points (..., 3) to the values (...) and gradients (..., 3) of a function whose zero set a face is on."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FacedBody(PlacedBody):
    """What bounds a solid all faces of which are made at once."""

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        """A closed mesh within a tolerance (the model's units), as measured; None where rounding spoils it."""
        faces = self.made(tolerance / self.stretch)
        if faces is None or faces.deviation * self.stretch > tolerance:
            return None
        return faces.mesh if self.place is None else faces.mesh._moved(self.place)

    @abstractmethod
    def made(self, tolerance: float) -> Faces | None:
        """Its faces before it was moved, within a tolerance; None where rounding spoils them."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SweptBody(FacedBody):
    """What bounds such a solid, before it was moved: what its profile's loops sweep out."""

    loops: tuple[Loop, ...]

    @property
    def extent(self) -> float:
        """The size of the widest loop."""
        return max(loop.size for loop in self.loops)

    def polygons(self, tolerance: float) -> tuple[list[Floats], list[list[int]], Integers] | None:
        """Points (N, 2) of each loop, how many are of each edge, and triangles (T, 3) of all points inside.

        Chords are as short as the tolerance needs, and so that they do not cross; None where they do to rounding.
        """
        finest = 2.0**-40  # over the profile's size: where chords cross even then, so do edges, to rounding
        while tolerance > finest * self.extent:
            found = [loop.polygon(tolerance / loop.size) for loop in self.loops]
            triangles = flat([points for points, _ in found])
            if triangles is not None:
                return [points for points, _ in found], [counts for _, counts in found], triangles
            tolerance /= 4
        return None


def flat(polygons: Sequence[Floats]) -> Integers | None:
    """Triangles (T, 3) between the points of polygons (N, 2), which are numbered in order.

    The polygons have what is inside to their left.  None where they cross.
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
    return made if whole and areas.min(initial=1.0) >= -1e-14 * size * size else None


def cross(u: Floats, v: Floats) -> Floats:
    """The determinants (N,) of vectors (N, 2)."""
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def put_side(made: Faces, name: str, rows: Sequence[Integers], jets: Jets) -> None:
    """The face of an edge between rows of vertices (N,): seen from outside, each is to the left of the one before it.

    A row may be one vertex, repeated.  `jets` are those of the surface, of either sign.
    """
    quads = [(a[:-1], a[1:], b[1:], b[:-1]) for a, b in pairwise(rows)]
    put_curved(made, name, [np.stack(t, axis=1) for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], jets)


def put_curved(made: Faces, name: str, parts: Sequence[Integers], jets: Jets) -> None:
    """A face by triangles (T, 3), some of which may have a vertex twice: these are left out; `jets` as in `put_side`.

    How far the middles of their edges are from the surface is noted.
    """
    triangles = np.concatenate(parts)
    distinct = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    triangles = triangles[distinct]
    corners = made.points[triangles]
    _, slopes = jets(corners)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    slopes *= np.sign((slopes * across[:, None, :]).sum(axis=-1, keepdims=True))
    made.add(name, triangles, slopes / np.linalg.norm(slopes, axis=-1, keepdims=True))
    values, slopes = jets((corners + np.roll(corners, 1, axis=1)) / 2)
    made.deviation = max(made.deviation, float((np.abs(values) / np.linalg.norm(slopes, axis=-1)).max()))


def put_flat(made: Faces, name: str, triangles: Integers, normal: Floats) -> None:
    """A flat face of vertices (T, 3) with a unit normal (3,)."""
    made.add(name, triangles, np.broadcast_to(normal, (len(triangles), 3, 3)))


def put_level(made: Faces, name: str, rows: Sequence[Integers], sign: int) -> bool:
    """Add the flat face inside rows of vertices, seen from above or, where `sign` is -1, from below.

    Returns whether there is one; nothing is added where the rows bound none.
    """
    rims = [row[row != np.roll(row, 1)] for row in rows]
    triangles = flat([made.points[rim, :2] for rim in rims])
    if triangles is None or not len(triangles):
        return False
    put_flat(made, name, np.concatenate(rims)[triangles][:, ::sign], np.array([0.0, 0.0, sign]))
    return True


def weights_and_triangles(n: int, many: int) -> tuple[Integers, Integers]:
    """Weights (N, many) of two or three corners, whole numbers that add up to n, and triangles (T, 3) between them."""
    if many == 2:
        return np.stack([n - np.arange(n + 1), np.arange(n + 1)], axis=1), np.empty((0, 3), dtype=np.intp)
    u, v = np.nonzero(np.add.outer(np.arange(n + 1), np.arange(n + 1)) <= n)
    number = np.zeros((n + 2, n + 2), dtype=np.intp)
    number[u, v] = np.arange(len(u))
    up, down = u + v < n, u + v < n - 1
    first = np.stack([number[u, v], number[u + 1, v], number[u, v + 1]], axis=1)[up]
    second = np.stack([number[u + 1, v], number[u + 1, v + 1], number[u, v + 1]], axis=1)[down]
    return np.stack([n - u - v, u, v], axis=1), np.concatenate([first, second])


def jets_of(surface: Polynomial) -> Jets:
    """The jets of a polynomial whose zeros a face is on."""
    return lambda points: (surface(points), surface.gradient(points))
