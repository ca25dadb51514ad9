"""The mesh that everything with a surface has: triangles on named faces, normals, distance from the surface."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import cached_property, reduce
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.affine import Affine, AffineShape, numbered
from pas.algebra.inputs import set_fields
from pas.algebra.rational import Exact
from pas.arrays import Floats, Integers
from pas.errors import GeometryError, optional
from pas.mesh.booleans import BooleanStep, Triangles, boolean
from pas.mesh.labelled import Topology
from pas.mesh.quality import Quality, smallest_angles, soundness
from pas.mesh.rows import area_vectors, counted_on, norms
from pas.mesh.shading import flat_normals, mean_normals, sharp_points
from pas.mesh.topology import edge_table, euler_characteristic, is_closed_manifold, is_manifold, piece_count
from pas.shape import Shape, refuse_mixed
from pas.verdicts import Findings

if TYPE_CHECKING:
    import pyvista
    import trimesh


def joined_names(names: Iterable[str]) -> str:
    """The name of a mesh's face on which faces of some different names lie: "a", or "a + b"."""
    return " + ".join(names)


@dataclass(frozen=True, eq=False, repr=False)
class Mesh(AffineShape["Mesh"], Shape):
    """A triangle mesh whose triangles lie on named faces.

    `points` (N, 3), `triangles` (T, 3) counterclockwise seen from where the normals point, `faces` (T,) the
    numbers of the triangles' faces in `names`, `normals` (T, 3, 3) unit normals of the face at each corner.

    `parameters` (N, 2) are those of the points of a parametric surface (one pair for those on seams and poles).
    `deviation`, where known, is the largest distance of the triangles from the surface in the model's units:
    a bound where `proved`, else measured.  `smooth_normals` (N, 3), where no edge is sharp, are those of the points.
    `solid_faces` are, for each name, the names of the solid's faces that lie there on one another; without them, as in
    meshes of files, and once the names are others, each name is that of one face.
    """

    points: Floats
    triangles: Integers
    faces: Integers
    names: tuple[str, ...]
    normals: Floats
    parameters: Floats | None = None
    deviation: float | None = None
    proved: bool = False
    smooth_normals: Floats | None = field(default=None, kw_only=True)
    solid_faces: tuple[tuple[str, ...], ...] = field(default=(), kw_only=True)
    kind = "mesh"

    def __post_init__(self) -> None:
        """Make all arrays read-only views, as several meshes may share one."""
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                view = value.view()
                view.setflags(write=False)
                set_fields(self, **{name: view})
        if tuple(map(joined_names, self.solid_faces)) != self.names:
            set_fields(self, solid_faces=tuple((name,) for name in self.names))

    def __deepcopy__(self, memo: object) -> Self:
        """A mesh with arrays of its own, which can be written to."""
        own = object.__new__(type(self))
        set_fields(own, **deepcopy(self.__getstate__()))
        return own

    @cached_property
    def certificate(self) -> Findings:
        """Whether it is a manifold without folds, and how near to the surface, as far as it is known."""
        return soundness(self.points, self.triangles, self.normals, self.deviation, self.proved)

    @classmethod
    def smooth(
        cls,
        points: Floats,
        triangles: Integers,
        normals: Floats,
        name: str = "surface",
        *,
        parameters: Floats | None = None,
        deviation: float | None = None,
        proved: bool = False,
    ) -> Mesh:
        """A mesh of one face with a normal (N, 3) at each point, and some of the other fields by name.

        Raises `ValueError` where triangles are not numbers of points.
        """
        if triangles.min(initial=0) < 0 or triangles.max(initial=-1) >= len(points):
            raise ValueError("triangles must be numbers of points")
        faces, corners = np.zeros(len(triangles), dtype=np.intp), normals.take(triangles, axis=0)
        known = parameters, deviation, proved
        return Mesh(points, triangles, faces, (name,), corners, *known, smooth_normals=normals)

    @classmethod
    def from_triangles(cls, points: ArrayLike, triangles: ArrayLike, name: str = "mesh") -> Mesh:
        """A closed mesh of one face from arrays (N, 3) and (T, 3), say of a file.

        Raises `GeometryError` where triangles have corners that are no points, and where the mesh is not a closed
        manifold, or inside out.
        """
        p, t = np.asarray(points, dtype=float), np.asarray(triangles, dtype=np.intp)
        if p.ndim != 2 or p.shape[1] != 3 or t.ndim != 2 or t.shape[1] != 3:
            raise ValueError(f"points and triangles must have shapes (N, 3) and (T, 3), not {p.shape} and {t.shape}")
        if not np.isfinite(p).all():
            raise GeometryError("the mesh has points that are not finite")
        if t.min(initial=0) < 0 or t.max(initial=-1) >= len(p):
            raise GeometryError(f"the mesh has triangles whose corners are not numbers of its {len(p)} points")
        mesh = Mesh(p, t, np.zeros(len(t), dtype=np.intp), (name,), flat_normals(p, t))
        mesh.require_closed()
        if mesh.volume <= 0:
            raise GeometryError("the mesh is inside out: its volume is not positive; turn its triangles round")
        return mesh

    @classmethod
    def together(cls, meshes: Mapping[str, Mesh]) -> Mesh:
        """Several meshes as one, side by side; the faces are named "part: face"."""
        items = list(meshes.items())
        known = [m.deviation for _, m in items if m.deviation is not None]
        return Mesh(
            np.concatenate([m.points for _, m in items]),
            counted_on([m.triangles for _, m in items], [len(m.points) for _, m in items]),
            counted_on([m.faces for _, m in items], [len(m.names) for _, m in items]),
            tuple(f"{name}: {face}" for name, m in items for face in m.names),
            np.concatenate([m.normals for _, m in items]),
            deviation=max(known) if len(known) == len(items) else None,
            proved=all(m.proved for _, m in items),
        )

    def mesh(self, tolerance: Exact | None = None, *, quality: Quality | str = Quality.BALANCED) -> Mesh:
        """The mesh itself, so that what takes a shape takes its mesh too; it cannot be made finer or better."""
        Quality.of(quality)
        return self

    @property
    def certified(self) -> bool:
        """Whether `deviation` is proved, as `proved` says."""
        return self.proved

    @cached_property
    def edges(self) -> tuple[Integers, Integers]:
        """The distinct edges (E, 2), and how many triangles each belongs to (E,)."""
        return edge_table(self.triangles)

    @cached_property
    def boundary(self) -> Integers:
        """The vertices on the mesh's boundary."""
        edges, times = self.edges
        return np.unique(edges[times == 1])

    @cached_property
    def feature_edges(self) -> Integers:
        """The edges (E, 2) between triangles of different faces."""
        return Topology(self.triangles, self.faces, len(self.points)).seams

    @cached_property
    def is_closed(self) -> bool:
        """Whether every edge has two triangles and every vertex one fan of them."""
        return is_closed_manifold(self.triangles)

    @property
    def is_manifold(self) -> bool:
        """Whether every edge has one or two triangles and every vertex one fan of them."""
        return is_manifold(self.triangles)

    def require_closed(self) -> Mesh:
        """The mesh itself; raises `GeometryError` where it is open or no manifold."""
        if not self.is_closed:
            raise GeometryError("the mesh is open or no manifold: each edge must have two triangles")
        return self

    @property
    def euler_characteristic(self) -> int:
        """Vertices - edges + triangles: 2 for a ball, 0 for a ring, summed over components."""
        return euler_characteristic(self.triangles)

    @property
    def components(self) -> int:
        """The number of connected pieces."""
        return piece_count(self.triangles)

    @property
    def box(self) -> Floats:
        """The two corners (2, 3) of the least box that holds all points."""
        return np.stack([self.points.min(axis=0), self.points.max(axis=0)])

    def _moved(self, map_: Affine) -> Mesh:
        """The image, whose distance from the image of the surface is bounded, rounding included, if this one's was."""
        matrix, shift = map_.floats
        stretch = float(np.linalg.norm(matrix, 2))
        rounding = (
            16 * np.finfo(float).eps * (stretch * np.linalg.norm(self.points, axis=1).max() + np.abs(shift).max())
        )
        deviation = None if self.deviation is None else float(self.deviation * stretch * (1 + 2.0**-40) + rounding)
        order = slice(None, None, -1 if np.linalg.det(matrix) < 0 else 1)
        normals = _moved_normals(map_, self.normals)[:, order]
        known = self.faces, self.names, normals, self.parameters, deviation, self.proved
        smooth = None if self.smooth_normals is None else _moved_normals(map_, self.smooth_normals)
        moved = map_.points(self.points), self.triangles[:, order], *known
        return Mesh(*moved, smooth_normals=smooth, solid_faces=self.solid_faces)

    def _patterned(self, maps: Sequence[Affine]) -> Mesh:
        copies = [self, *(self._moved(map_) for map_ in maps)]
        called = (numbered(self.names, k) for k in range(1, len(copies) + 1))
        named = [replace(m, names=tuple(new[n] for n in m.names)) for m, new in zip(copies, called, strict=True)]
        return reduce(Mesh.__or__, named)

    @property
    def volume(self) -> float:
        """The volume enclosed by the triangles, worked out about their middle, so that none is lost far away.

        Raises `GeometryError` for a mesh that is not closed.
        """
        self.require_closed()
        points = self.points - self.points.mean(axis=0)
        a, b, c = (points[self.triangles[:, i]] for i in range(3))
        return float(np.einsum("ni,ni->", a, np.cross(b, c)) / 6)

    @property
    def area(self) -> float:
        """The total area of the triangles."""
        return float(self.areas.sum())

    @cached_property
    def areas(self) -> Floats:
        """The area of each triangle (T,)."""
        return norms(area_vectors(self.points[self.triangles])) / 2

    @property
    def face_areas(self) -> dict[str, float]:
        """The area of the triangles on each face; of faces of one name together."""
        sums = dict.fromkeys(self.names, 0.0)
        for name, area in zip(self.names, np.bincount(self.faces, self.areas, len(self.names)).tolist(), strict=True):
            sums[name] += area
        return sums

    @property
    def smallest_angles(self) -> Floats:
        """The smallest angle of each triangle, in degrees (T,)."""
        return np.asarray(np.degrees(smallest_angles(self.points[self.triangles])))

    @cached_property
    def point_normals(self) -> Floats:
        """A unit normal (N, 3) for each point: the mean of those of the faces there."""
        if self.smooth_normals is not None:
            return self.smooth_normals
        return mean_normals(len(self.points), self.triangles, self.normals)

    @cached_property
    def _sharp(self) -> tuple[Integers, Integers, Floats]:
        if self.smooth_normals is not None:
            return np.arange(len(self.points)), self.triangles, self.smooth_normals
        return sharp_points(len(self.points), self.triangles, self.normals)

    @property
    def shading(self) -> tuple[Floats, Integers, Floats]:
        """Points, triangles and point normals with vertices doubled along sharp edges only."""
        numbers, triangles, normals = self._sharp
        return self.points[numbers], triangles, normals

    @property
    def shading_points(self) -> Integers:
        """Which of `points` those of `shading` are (M,)."""
        return self._sharp[0]

    @property
    def smoothed(self) -> Mesh:
        """A mesh of these triangles with each point's mean normal at all its corners, so that no vertex is doubled."""
        return self if self.smooth_normals is not None else replace(self, normals=self.point_normals[self.triangles])

    @property
    def flipped(self) -> Mesh:
        """This mesh seen from its other side: triangles and normals are turned round."""
        smooth = None if self.smooth_normals is None else -self.smooth_normals
        turned = self.triangles[:, ::-1], -self.normals[:, ::-1]
        return replace(self, triangles=turned[0], normals=turned[1], smooth_normals=smooth)

    def to_pyvista(self) -> pyvista.PolyData:
        """A `pyvista.PolyData` with point normals, the array `face`, the faces' names, and `parameters` if known.

        Vertices are doubled along sharp edges, as in `shading`.
        """
        pyvista = optional("pyvista")
        points, triangles, normals = self.shading
        data = pyvista.PolyData.from_regular_faces(points, triangles.astype(int))
        data.point_data.active_normals = normals
        if self.parameters is not None:
            data.point_data["parameters"] = self.parameters[self.shading_points]
        data.cell_data["face"] = self.faces
        data.field_data["face names"] = np.array(self.names)
        return data

    def to_trimesh(self) -> trimesh.Trimesh:
        """A `trimesh.Trimesh` with point normals, its vertices doubled along sharp edges."""
        import trimesh

        points, triangles, normals = self.shading
        return trimesh.Trimesh(points, triangles, vertex_normals=normals, process=False)

    def __or__(self, other: Mesh) -> Mesh:
        return self._boolean(other, "Add")

    def __and__(self, other: Mesh) -> Mesh:
        return self._boolean(other, "Intersect")

    def __sub__(self, other: Mesh) -> Mesh:
        return self._boolean(other, "Subtract")

    def _boolean(self, other: object, operation: str) -> Mesh:
        if not isinstance(other, Mesh):
            refuse_mixed(self, other)
        names = tuple(dict.fromkeys(self.names + other.names))
        points, triangles, faces = boolean([self._named(names), other._named(names)], [BooleanStep(2, operation, 2)])
        return Mesh(points, triangles, faces, names, flat_normals(points, triangles))

    def _named(self, names: tuple[str, ...]) -> Triangles:
        """The closed mesh with the faces' numbers among other names."""
        self.require_closed()
        numbers = np.array([names.index(name) for name in self.names])
        return Triangles(self.points, self.triangles, numbers[self.faces])

    def __repr__(self) -> str:
        faces = f"{len(self.names)} face{'s' if len(self.names) != 1 else ''}"
        kind = "closed" if self.is_closed else "open" if self.is_manifold else "no manifold"
        return f"<Mesh: {len(self.points)} points, {len(self.triangles)} triangles, {faces}, {kind}>"

    def __str__(self) -> str:
        text = repr(self)[1:-1]
        if self.deviation is None:
            return text
        return f"{text}; within {self.deviation:.3g} of the surface ({'proved' if self.proved else 'measured'})"


def _moved_normals(map_: Affine, normals: Floats) -> Floats:
    """The unit normals (..., 3) of images of surfaces with these normals."""
    moved = normals @ map_.inverse.floats[0]
    return np.asarray(moved / np.linalg.norm(moved, axis=-1, keepdims=True))
