"""Meshes that begin as graphs over directions: flips, moves and edges, in arrays.

A triangle (a, b, c) with `det(a, b, c) > 0` is seen from 0 with its outside away.  The first triangles are.  Later
ones need not be where rays graze the surface, as in thin pipes: then it is the surface's normals at the corners that
they keep to, and no edge is made twice.
"""

from __future__ import annotations

import numpy as np

from pas.mesh.field import Floats, Integers
from pas.mesh.kernels import compiled
from pas.mesh.rows import cross, dots

FLIPS = 8
"""Passes of flips, each over an independent set of edges."""

GAIN = 1e-6
"""Sine of the angle by which two opposite angles must exceed pi for a flip, so that ties stay."""

TURNED = 0.5
"""Cosine between a triangle and the normals at its corners that a flip must keep, or not make worse."""

SEEN = 1e-9
"""Determinants over the product of the three distances count as positive from here."""


class Edges:
    """The edges of an oriented mesh of T triangles on `size` vertices: `every` (E, 2), those of the rim last.

    Directed as in their first triangle: `inner` (I, 2) vertices, `owners` (I, 2) triangles; `rim` (R, 2).
    """

    def __init__(self, triangles: Integers, size: int, listed: tuple[Integers, Integers, bool] | None = None) -> None:
        self.triangles = triangles
        self.every, self.owners, self.manifold = listed or compiled().edges(triangles, size)

    @property
    def inner(self) -> Integers:
        """The edges between two triangles."""
        return self.every[: len(self.owners)]

    @property
    def rim(self) -> Integers:
        """Those of one triangle."""
        return self.every[len(self.owners) :]

    @property
    def apexes(self) -> Integers:
        """The vertices (I, 2) opposite to the inner edges in their owners."""
        ends = self.inner.sum(axis=1)[:, None]
        return np.asarray(self.triangles[self.owners].sum(axis=2) - ends)


def seen(points: Floats, triangles: Integers) -> np.ndarray:
    """Which triangles (T,) are seen from 0 with their outside away."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    volume = dots(a, cross(b, c))
    lengths = np.sqrt(dots(a, a) * dots(b, b) * dots(c, c))
    return np.asarray(volume > SEEN * SEEN * lengths)


def upright(points: Floats, triangles: Integers, normals: Floats) -> Floats:
    """The cosines (T,) between triangles and the sum of the normals (N, 3) at their corners."""
    return compiled().upright(points, triangles, normals)


def flipped(points: Floats, triangles: Integers, normals: Floats, passes: int = FLIPS) -> Integers:
    """The triangles (T, 3) with edges flipped towards Delaunay's criterion, none away from the surface's normals."""
    return compiled().flipped(points, triangles, normals, passes, GAIN, TURNED)


def flipped_edges(points: Floats, triangles: Integers, normals: Floats) -> Edges:
    """The edges of the mesh that `flipped` makes of triangles (T, 3), which are its `triangles`."""
    found, listed = compiled().flipped_edges(points, triangles, normals, FLIPS, GAIN, TURNED)
    return Edges(found, len(points), listed)


def middles(points: Floats, triangles: tuple[Integers, Integers], edges: tuple[Integers, Integers]) -> Floats:
    """The centres of triangles (T, 3) and the middles of edges (E, 2), each given with which are chosen, (N, 3)."""
    return compiled().middles(points, triangles, edges)


def settled(before: Floats, after: Floats, triangles: Integers, normals: Floats) -> Floats:
    """The points after a move, some where they were before, so that no triangle is turned from the normals."""
    return compiled().settled(before, after, triangles, normals, TURNED)


def slender(points: Floats, triangles: Integers) -> int:
    """How many triangles have an angle below 30 degrees: by the cosine opposite to the shortest side, squared."""
    return compiled().slender(points, triangles)


def smallest_angles(points: Floats, triangles: Integers) -> Floats:
    """The smallest angle (T,) of each triangle in degrees."""
    p = points[triangles]
    most = np.full(len(triangles), -np.inf)
    for i in range(3):
        u, v = p[:, (i + 1) % 3] - p[:, i], p[:, (i + 2) % 3] - p[:, i]
        w = cross(u, v)
        most = np.maximum(most, dots(u, v) / np.sqrt(np.maximum(dots(w, w), 1e-300)))
    return np.asarray(np.degrees(np.arctan2(1.0, most)))
