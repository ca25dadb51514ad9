"""Meshes of solids that are extruded or revolved from profiles, made of the profile's polygon without a lattice."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import TypeVar

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.monomials import Floats
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.mesh.rows import Integers
from pas.solid.edges import Loop
from pas.solid.sheets import Faces

FINEST = 2.0**-40
"""Of polygons, over the size of the profile: where chords cross at that, so do edges, to rounding."""

Jets = Callable[[Floats], tuple[Floats, Floats]]
"""From points (..., 3) to the values (...) and gradients (..., 3) of a function whose zero set a face is on."""

B = TypeVar("B", bound="SweptBody")


@dataclass(frozen=True, eq=False, kw_only=True)
class SweptBody(ABC):
    """What bounds such a solid; `place` is how it was moved."""

    loops: tuple[Loop, ...]
    place: Affine | None = field(default=None)

    def moved(self: B, map_: Affine) -> B:
        """Its image."""
        return replace(self, place=map_ if self.place is None else map_.after(self.place))

    @property
    def size(self) -> float | None:
        """The longest side of a box around it, as a coarse mesh shows it."""
        return float(np.ptp(self._coarse.points, axis=0).max())

    @cached_property
    def _coarse(self) -> Mesh:
        made = self.swept(max(loop.size for loop in self.loops) / 64).mesh
        return made if self.place is None else made._moved(self.place)

    def mesh(self, tolerance: float, quality: Quality) -> Mesh | None:
        """A closed mesh within a tolerance (the model's units), as measured; None where rounding spoils it."""
        stretch = 1.0 if self.place is None else float(np.linalg.norm(self.place.floats[0], 2))
        made = self.swept(tolerance / stretch).mesh
        if made.deviation is None or made.deviation * stretch > tolerance:
            return None
        return made if self.place is None else made._moved(self.place)

    @abstractmethod
    def swept(self, tolerance: float) -> Faces:
        """Its faces before it was moved, within a tolerance."""

    def polygons(self, tolerance: float) -> tuple[list[Floats], list[list[int]], Integers]:
        """Points (N, 2) of each loop, how many are of each edge, and triangles (T, 3) of all points inside.

        Chords are as short as the tolerance needs, and so that they do not cross.
        """
        size = max(loop.size for loop in self.loops)
        relative = tolerance / size
        while True:
            found = [loop.polygon(relative * size / loop.size) for loop in self.loops]
            triangles = flat([points for points, _ in found])
            if triangles is not None or relative < FINEST:
                return [p for p, _ in found], [c for _, c in found], np.zeros((0, 3)) if triangles is None else triangles
            relative /= 4


def flat(polygons: Sequence[Floats]) -> Integers | None:
    """Triangles (T, 3) between the points of polygons (N, 2), counterclockwise around what is inside, numbered in order.

    None where the polygons cross.
    """
    from manifold3d import triangulate

    points = np.concatenate(polygons)
    made = np.asarray(triangulate([np.asarray(p, dtype=np.float64) for p in polygons], 0.0), dtype=np.intp)
    corners = points[made]
    areas = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inside = sum(float(cross(p, np.roll(p, -1, axis=0)).sum()) for p in polygons)
    size = float(np.ptp(points, axis=0).max())
    whole = abs(areas.sum() - inside) <= 1e-12 * size * size
    return made if whole and areas.min(initial=1.0) >= -1e-14 * size * size else None


def cross(u: Floats, v: Floats) -> Floats:
    """The determinants (N,) of vectors (N, 2)."""
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def put_side(made: Faces, name: str, rows: Sequence[Integers], jets: Jets) -> None:
    """The face of an edge: rows of vertices (N,), one after the other along the edge, which is seen with the rows' order
    to the right.  A row may be one vertex, repeated."""
    quads = [(a[:-1], a[1:], b[1:], b[:-1]) for a, b in pairwise(rows)]
    triangles = np.concatenate([np.stack(t, axis=1) for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
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
