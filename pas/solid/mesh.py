"""Meshes of solids: closed, each triangle on its face; booleans of meshes; exact integrals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from pas.errors import GeometryError, MissingLibraryError
from pas.mesh.closed import FaceMesh
from pas.mesh.field import FaceField, Floats, Integers, TriangleMesh, is_closed_manifold
from pas.mesh.remesh import newton

SMOOTH_COSINE = 0.9
"""Normals of a vertex's faces closer than this are one, so that smooth joints are shaded smoothly."""


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """A triangle mesh whose triangles lie on named faces.

    `points` (N, 3), `triangles` (T, 3) counterclockwise seen from outside, `faces` (T,) the numbers
    of the triangles' faces in `names`, `normals` (T, 3, 3) outward unit normals of the face at each
    corner.
    """

    points: Floats
    triangles: Integers
    faces: Integers
    names: tuple[str, ...]
    normals: Floats

    @classmethod
    def of(cls, found: FaceMesh, names: Mapping[int, str], place: Callable[[Floats], Floats]) -> SolidMesh:
        """The mesh of the mesher's labels, given their names and the map from its coordinates to the user's."""
        mesh = found.mesh
        distinct = tuple(dict.fromkeys(names[int(label)] for label in np.unique(mesh.labels)))
        numbers = np.zeros(int(mesh.labels.max()) + 1, dtype=np.intp)
        for label, name in names.items():
            numbers[label] = distinct.index(name)
        return cls(
            place(mesh.points),
            mesh.triangles,
            numbers[mesh.labels],
            distinct,
            found.normals[mesh.topology.corner_pairs],
        )

    @classmethod
    def from_triangles(cls, points: Any, triangles: Any, name: str = "mesh") -> SolidMesh:
        """A closed mesh of one face from arrays (N, 3) and (T, 3), say of a file.

        Raises `GeometryError` where it is not a closed manifold, or inside out.
        """
        p, t = np.asarray(points, dtype=float), np.asarray(triangles, dtype=np.intp)
        if p.ndim != 2 or p.shape[1] != 3 or t.ndim != 2 or t.shape[1] != 3:
            raise ValueError(f"points and triangles must have shapes (N, 3) and (T, 3), not {p.shape} and {t.shape}")
        if not np.isfinite(p).all():
            raise GeometryError("the mesh has points that are not finite")
        mesh = cls(p, t, np.zeros(len(t), dtype=np.intp), (name,), _flat_normals(p, t))
        mesh.require_closed()
        if mesh.volume <= 0:
            raise GeometryError("the mesh is inside out: its volume is not positive; turn its triangles round")
        return mesh

    @property
    def is_closed(self) -> bool:
        """Whether every edge has two triangles and every vertex one fan of them."""
        return is_closed_manifold(self.triangles)

    def require_closed(self) -> SolidMesh:
        """The mesh itself; raises `GeometryError` where it is open or no manifold."""
        if not self.is_closed:
            raise GeometryError("the mesh is open or no manifold: each edge must have two triangles")
        return self

    @property
    def volume(self) -> float:
        """The volume enclosed by the triangles, worked out about their middle, so that none is lost far away."""
        points = self.points - self.points.mean(axis=0)
        a, b, c = (points[self.triangles[:, i]] for i in range(3))
        return float(np.einsum("ni,ni->", a, np.cross(b, c)) / 6)

    @property
    def area(self) -> float:
        """The total area of the triangles."""
        return float(self._areas.sum())

    @cached_property
    def _areas(self) -> Floats:
        a, b, c = (self.points[self.triangles[:, i]] for i in range(3))
        return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)

    @property
    def face_areas(self) -> dict[str, float]:
        """The area of the triangles on each face."""
        sums = np.bincount(self.faces, self._areas, minlength=len(self.names))
        return dict(zip(self.names, sums.tolist(), strict=True))

    @property
    def euler_characteristic(self) -> int:
        """Vertices - edges + triangles: 2 for a ball, 0 for a ring, summed over components."""
        return len(np.unique(self.triangles)) - 3 * len(self.triangles) // 2 + len(self.triangles)

    @property
    def components(self) -> int:
        """The number of connected pieces of the boundary."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        t = self.triangles
        rows, columns = np.concatenate([t[:, 0], t[:, 1]]), np.concatenate([t[:, 1], t[:, 2]])
        graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(self.points),) * 2)
        label = connected_components(graph, directed=False)[1]
        return len(np.unique(label[t[:, 0]]))

    @cached_property
    def feature_edges(self) -> Integers:
        """The edges (E, 2) between triangles of different faces."""
        start, end = self.triangles.ravel(), self.triangles[:, [1, 2, 0]].ravel()
        key = np.minimum(start, end) * len(self.points) + np.maximum(start, end)
        order = np.argsort(key, kind="stable")
        faces = np.repeat(self.faces, 3)[order]
        differ = order[::2][faces[::2] != faces[1::2]]
        return np.stack([start[differ], end[differ]], axis=1)

    @cached_property
    def shading(self) -> tuple[Floats, Integers, Floats]:
        """Points, triangles and point normals with vertices doubled along sharp edges only."""
        corner = self.triangles.ravel()
        normals = self.normals.reshape(-1, 3)
        order = np.argsort(corner, kind="stable")
        first = np.searchsorted(corner[order], np.arange(len(self.points)))
        first = np.minimum(first, len(order) - 1)
        groups, pending = np.zeros(len(corner), dtype=np.intp), np.ones(len(corner), dtype=bool)
        leader = order[first][corner]
        for group in range(8):
            close = pending & ((normals * normals[leader]).sum(axis=1) > SMOOTH_COSINE)
            groups[close], pending = group, pending & ~close
            if not pending.any():
                break
            rest = np.flatnonzero(pending)
            chosen = np.full(len(self.points), -1)
            chosen[corner[rest][::-1]] = rest[::-1]
            leader = np.where(pending, chosen[corner], leader)
        groups[pending] = 8
        keys, inverse = np.unique(corner * 9 + groups, return_inverse=True)
        total = np.zeros((len(keys), 3))
        np.add.at(total, inverse, normals)
        length = np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
        return self.points[keys // 9], inverse.reshape(-1, 3), total / length

    def to_pyvista(self) -> Any:
        """A `pyvista.PolyData` with point normals, the array `face` and the faces' names."""
        import pyvista

        points, triangles, normals = self.shading
        data = pyvista.PolyData.from_regular_faces(points, triangles.astype(int))
        data.point_data.active_normals = normals
        data.cell_data["face"] = self.faces
        data.field_data["face names"] = np.array(self.names)
        return data

    @property
    def triangle_mesh(self) -> TriangleMesh:
        """The bare triangles; a vertex has the mean of its faces' normals."""
        total = np.zeros_like(self.points)
        np.add.at(total, self.triangles.ravel(), self.normals.reshape(-1, 3))
        return TriangleMesh(
            self.points, self.triangles, total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
        )

    def __or__(self, other: Any) -> SolidMesh:
        return self._boolean(other, "Add")

    def __and__(self, other: Any) -> SolidMesh:
        return self._boolean(other, "Intersect")

    def __sub__(self, other: Any) -> SolidMesh:
        return self._boolean(other, "Subtract")

    def _boolean(self, other: Any, operation: str) -> SolidMesh:
        if not isinstance(other, SolidMesh):
            return NotImplemented
        manifold3d = _manifold3d()
        names = tuple(dict.fromkeys(self.names + other.names))
        first, second = (m._as_manifold(manifold3d, names) for m in (self, other))
        result = manifold3d.Manifold.batch_boolean([first, second], getattr(manifold3d.OpType, operation))
        _check_status(result, "the result")
        if result.is_empty():
            raise GeometryError("the boolean of the two meshes is empty")
        mesh = result.to_mesh64()
        points, triangles = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts).astype(np.intp)
        faces = np.asarray(mesh.face_id).astype(np.intp)
        return SolidMesh(points, triangles, faces, names, _flat_normals(points, triangles))

    def _as_manifold(self, manifold3d: Any, names: tuple[str, ...]) -> Any:
        self.require_closed()
        numbers = np.array([names.index(name) for name in self.names])
        mesh = manifold3d.Mesh64(
            vert_properties=np.ascontiguousarray(self.points),
            tri_verts=self.triangles.astype(np.uint64),
            face_id=numbers[self.faces].astype(np.uint64),
        )
        solid = manifold3d.Manifold(mesh)
        _check_status(solid, "a mesh")
        return solid


def _manifold3d() -> Any:
    try:
        import manifold3d
    except ImportError:
        raise MissingLibraryError("booleans of meshes need manifold3d: pip install manifold3d") from None
    return manifold3d


def _check_status(solid: Any, name: str) -> None:
    status = solid.status()
    if status.name != "NoError":
        raise GeometryError(f"{name} was refused as no closed manifold ({status.name}); mend it before a boolean")


def _flat_normals(points: Floats, triangles: Integers) -> Floats:
    a, b, c = (points[triangles[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return np.repeat(normal[:, None], 3, axis=1)


_GAUSS = np.array(
    [
        (0.445948490915965, 0.445948490915965, 0.223381589678011),
        (0.445948490915965, 0.108103018168070, 0.223381589678011),
        (0.108103018168070, 0.445948490915965, 0.223381589678011),
        (0.091576213509771, 0.091576213509771, 0.109951743655322),
        (0.091576213509771, 0.816847572980459, 0.109951743655322),
        (0.816847572980459, 0.091576213509771, 0.109951743655322),
    ]
)
"""Points and weights of the rule of degree 4 on the triangle (Dunavant 1985)."""


def curved_measures(found: FaceMesh, field: FaceField) -> tuple[float, float]:
    """Volume and area of the mesh with its edges' midpoints moved onto the faces and curves.

    Each triangle becomes the quadratic patch through its corners and midpoints, so the errors fall
    with the fourth power of the edges: second order in the tolerance.
    """
    mesh = found.mesh
    edges = mesh.topology.edges
    middles = mesh.points[edges].mean(axis=1)
    for labels, rows in mesh.topology.edge_groups:
        middles[rows] = newton(middles[rows], field, labels, mesh.lengths[rows])
    size = mesh.topology.size
    keys = edges @ np.array([size, 1])
    center = mesh.points.mean(axis=0)
    corners = [mesh.points[mesh.triangles[:, i]] - center for i in range(3)]
    sides = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = mesh.triangles[:, i], mesh.triangles[:, j]
        sides.append(middles[np.searchsorted(keys, np.minimum(a, b) * size + np.maximum(a, b))] - center)
    volume = area = 0.0
    for u, v, weight in _GAUSS.tolist():
        w = 1 - u - v
        shape = (w * (2 * w - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * u * w, 4 * u * v, 4 * v * w)
        by_u = (1 - 4 * w, 4 * u - 1, 0.0, 4 * (w - u), 4 * v, -4 * v)
        by_v = (1 - 4 * w, 0.0, 4 * v - 1, -4 * u, 4 * u, 4 * (w - v))
        nodes = (*corners, *sides)
        x, du, dv = (sum(c * n for c, n in zip(f, nodes, strict=True)) for f in (shape, by_u, by_v))
        normal = np.cross(du, dv)
        volume += weight / 2 * float(np.einsum("ni,ni->", x, normal)) / 3
        area += weight / 2 * float(np.linalg.norm(normal, axis=1).sum())
    return volume, area
