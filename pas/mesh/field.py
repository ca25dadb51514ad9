"""What the mesher needs to know of a surface, and what it returns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.intp]


VISIBLE = 1e-7
"""Coordinates below this share of the largest ones of a box are shown as 0."""


class CellField(Protocol):
    """A function with gradients on a region made of tetrahedra.

    `vertices` (V, 3), `cells` (C, 4) vertex numbers, `walls` (W, 4) the oriented unit planes
    (normal, offset) of the region's flat boundary pieces.
    """

    @property
    def vertices(self) -> Floats:
        """The points of the tetrahedra (V, 3)."""

    @property
    def cells(self) -> Integers:
        """The tetrahedra as vertex numbers (C, 4)."""

    @property
    def walls(self) -> Floats:
        """Planes (W, 4) that bound the region: `n . x = d` with unit n, as (n, d)."""

    @property
    def feature_size(self) -> float:
        """The radius of the smallest feature that a mesh must show."""

    @property
    def curves(self) -> list[Floats]:
        """Points (m, 3) of each curve on which the surface must end."""

    def locate(self, points: Floats) -> Integers:
        """The cell that holds, or is nearest to, each of points (N, 3)."""

    def jets(self, points: Floats, cells: Integers) -> Floats:
        """Values and gradients (N, 4) of given cells' functions at points (N, 3)."""


class FaceField(Protocol):
    """A set in space whose boundary consists of faces, each on the zero set of a function.

    A label names a function and the side of it that is inside; the label's function is negative
    inside and positive outside.
    """

    @property
    def box(self) -> Floats:
        """Two corners (2, 3) of a box that holds the set."""

    @property
    def scale(self) -> float:
        """The user's length of one unit of the coordinates used here."""

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""

    @property
    def special_points(self) -> Floats:
        """Points (S, 3) where faces may be singular, such as a cone's apex."""

    def crossed(self, centers: Floats, half: float) -> NDArray[np.bool_]:
        """Which cubes (N,), of centres (N, 3) and half an edge, the boundary may pass; all others it does not."""

    def turning(self, centers: Floats, half: float) -> Floats:
        """How much faces turn in such cubes (N,), at most, in radians.

        Infinite where the boundary may be more than one sheet, or a sheet that is not seen all at once from any side.
        """

    def face(self, label: int) -> str:
        """The name of a label's face."""

    def signs(self, points: Floats) -> NDArray[np.bool_]:
        """For each function (M, N), whether it is <= 0 at points (N, 3)."""

    def inside(self, signs: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether points with given signs (M, N) are in the set (N,)."""

    def jets(self, points: Floats, label: int) -> Floats:
        """Values and gradients (N, 4) of a label's function at points (N, 3)."""

    def functions(self, labels: tuple[int, ...]) -> tuple[int, ...]:
        """The labels whose functions' common zeros are where faces of given labels meet."""


def place_of(field: FaceField, point: Floats) -> str:
    """A point as the user reads it, without the digits of zeros."""
    least = VISIBLE * float(np.abs(field.world(field.box)).max())
    return "(" + ", ".join(f"{x if abs(x) > least else 0.0:.4g}" for x in field.world(point)) + ")"


@dataclass(frozen=True)
class TriangleMesh:
    """Points (N, 3), triangles (T, 3) and unit normals (N, 3), pointing to where f > 0."""

    points: Floats
    triangles: Integers
    normals: Floats

    @cached_property
    def edges(self) -> tuple[Integers, Integers]:
        """The distinct edges (E, 2), and how many triangles each belongs to (E,)."""
        return edge_table(self.triangles)

    @cached_property
    def boundary(self) -> Integers:
        """The vertices on the mesh's boundary."""
        edges, times = self.edges
        return np.unique(edges[times == 1])

    @property
    def euler_characteristic(self) -> int:
        """Vertices - edges + triangles."""
        return len(np.unique(self.triangles)) - len(self.edges[0]) + len(self.triangles)

    @property
    def is_manifold(self) -> bool:
        """Whether every edge has one or two triangles and every vertex one fan of them."""
        if len(self.triangles) == 0 or self.edges[1].max() > 2:
            return False
        return bool((_fans(self.triangles) == 1).all())

    def to_pyvista(self) -> Any:
        """The same mesh as a `pyvista.PolyData` with point normals."""
        import pyvista

        data = pyvista.PolyData.from_regular_faces(self.points, self.triangles.astype(int))
        data.point_data.active_normals = self.normals
        return data

    @property
    def smallest_angles(self) -> Floats:
        """The smallest angle of each triangle, in degrees (T,)."""
        p = self.points[self.triangles]
        angles = []
        for i in range(3):
            a, b = p[:, (i + 1) % 3] - p[:, i], p[:, (i + 2) % 3] - p[:, i]
            cosine = (a * b).sum(1) / np.maximum(np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1), 1e-300)
            angles.append(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
        return np.min(angles, axis=0)


def distinct(keys: Integers) -> Integers:
    """The distinct keys, sorted (several times faster than `np.unique`)."""
    ordered = np.sort(keys, axis=None)
    return ordered[np.concatenate([np.ones(min(len(ordered), 1), dtype=bool), ordered[1:] != ordered[:-1]])]


def is_closed_manifold(triangles: Integers) -> bool:
    """Whether every edge has two triangles and every vertex one fan of them."""
    return len(triangles) > 0 and not len(pinched(triangles))


def pinched(triangles: Integers) -> Integers:
    """The vertices whose triangles are not one closed fan, at which a mesh is open or no manifold."""
    if not len(triangles):
        return np.empty(0, dtype=np.intp)
    edges, times = edge_table(triangles)
    if (times != 2).any():
        return np.unique(edges[times != 2])
    return np.unique(triangles)[_fans(triangles) != 1]


def edge_table(triangles: Integers) -> tuple[Integers, Integers]:
    """The distinct edges (E, 2) of triangles (T, 3) and their numbers of triangles."""
    size = int(triangles.max(initial=0)) + 1
    pairs = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    keys, times = np.unique(pairs[:, 0] * size + pairs[:, 1], return_counts=True)
    return np.stack([keys // size, keys % size], axis=1), times


def _fans(triangles: Integers) -> Integers:
    """How many edge-connected fans of triangles meet at each used vertex."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    corners = len(triangles) * 3
    owner = triangles.ravel()
    ids = np.arange(corners).reshape(-1, 3)
    size = int(triangles.max()) + 1
    sides, ends = [], []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        low = np.minimum(triangles[:, i], triangles[:, j])
        high = np.maximum(triangles[:, i], triangles[:, j])
        sides.append(low * size + high)
        ends.append(np.where((triangles[:, i] < triangles[:, j])[:, None], ids[:, [i, j]], ids[:, [j, i]]))
    keys, pairs = np.concatenate(sides), np.concatenate(ends)
    order = np.argsort(keys)
    same = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    first, second = pairs[order[same]], pairs[order[same + 1]]
    rows, columns = first.ravel(), second.ravel()
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(corners, corners))
    components, label = connected_components(graph, directed=False)
    vertex_of = np.empty(components, dtype=np.intp)
    vertex_of[label] = owner
    return np.unique(vertex_of, return_counts=True)[1]
