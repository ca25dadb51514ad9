"""One surface as the ground of an open mesh: its boundary curves are those of the field."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.mesh.grading import Settings
from pas.mesh.halfedges import HalfEdges, VertexKind
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.refusals import BadMeshError, FaceMesh
from pas.mesh.remesher import Remesher
from pas.mesh.rows import largest_of
from pas.mesh.shading import unit_rows
from pas.mesh.topology import Edges


class SheetField(ABC):
    """A surface near which points are, as a ground; see `pas.mesh.grading.Ground`."""

    reach: float
    scale: float
    faces = np.zeros(1, dtype=np.int8)
    knows_bends = True

    @abstractmethod
    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""

    @property
    @abstractmethod
    def fixed(self) -> Bools:
        """Which of the R curves on which it ends are but points where others end, which stay where they are, and, at
        the end, that what is on none is not, (R + 1,)."""

    @abstractmethod
    def between(self, ends: Floats, rims: Integers) -> Integers:
        """The curves (E,) on which edges (E, 2, 3) between points on fixed ones (E, 2) are, directed so that the
        surface, seen from outside, is to their left."""

    @abstractmethod
    def within(self, points: Floats) -> bool:
        """Whether all points (N, 3) are in the region, but for rounding."""

    @abstractmethod
    def on_rims(self, points: Floats, rim: Integers) -> Floats:
        """Points (N, 3) near boundary curves of given numbers (N,) moved onto these."""

    @abstractmethod
    def rim_distances(self, points: Floats, rim: Integers) -> Floats:
        """Distances (N,) of points (N, 3) from boundary curves of given numbers (N,), to first order."""

    @abstractmethod
    def nearer(self, points: Floats, still: Bools) -> tuple[Floats, Floats, Floats]:
        """Points (N, 3) near the surface, drawn towards it until it is much nearer; what `bending` says of them.

        Those that are `still` (N,) stay.
        """

    @abstractmethod
    def closed(self, points: Floats) -> tuple[Floats, Floats]:
        """Points (N, 3) very near the surface moved onto it, and the gradients (N, 3) there."""

    @abstractmethod
    def gradients(self, points: Floats) -> Floats:
        """The gradients (N, 3) of the function whose zeros it is at points (N, 3)."""

    @abstractmethod
    def distances(self, points: Floats) -> Floats:
        """Distances (N,) of points (N, 3) from it, to first order."""

    @abstractmethod
    def bending(self, points: Floats) -> tuple[Floats, Floats]:
        """Its gradients (N, 3) and the size of the larger principal curvature (N,) at points of the surface."""

    def drawn(self, mesh: HalfEdges, to: Floats) -> tuple[Floats, Floats, Floats]:
        to, on = to.copy(), np.flatnonzero(mesh.kinds == VertexKind.CURVE)
        if len(on):
            to[on] = self.on_rims(to[on], mesh.rim_of[on])
        points, gradients, bends = self.nearer(to, mesh.kinds != VertexKind.INSIDE)
        return points, unit_rows(gradients)[mesh.vertex_of], bends[mesh.vertex_of]

    def placed(self, points: Floats, labels: Integers, rims: Integers, reach: Floats) -> Floats:
        points, on = points.copy(), rims >= 0
        if on.any():
            points[on] = self.on_rims(points[on], rims[on])
        near = self.nearer(points[~on], np.zeros((~on).sum(), dtype=bool))[0]
        points[~on] = self.closed(near)[0]
        return points

    def projected(self, mesh: HalfEdges) -> tuple[Floats, Floats]:
        points, gradients = mesh.points.copy(), np.empty_like(mesh.points)
        inside, on = np.flatnonzero(mesh.kinds == VertexKind.INSIDE), np.flatnonzero(mesh.kinds == VertexKind.CURVE)
        points[inside], gradients[inside] = self.closed(points[inside])
        if len(on):
            points[on] = self.on_rims(points[on], mesh.rim_of[on])
        rest = np.flatnonzero(mesh.kinds != VertexKind.INSIDE)
        gradients[rest] = self.gradients(points[rest])
        return points, unit_rows(gradients)[mesh.vertex_of]

    def looked(self, points: Floats, labels: Integers) -> tuple[Floats, Floats]:
        gradients, bends = self.bending(points)
        return unit_rows(gradients), bends

    def measured(self, mesh: HalfEdges, rows: Integers, halves: Integers) -> tuple[Floats, Floats]:
        """Distances of triangles' centres and edges' middles, those of the boundary from its curves."""
        centres, middles = mesh.middles(rows, halves)
        found = self.distances(np.concatenate([centres, middles]))
        inside, along = found[: len(rows)], found[len(rows) :]
        on = np.flatnonzero(mesh.twins[halves] < 0)
        if len(on):
            along[on] = self.rim_distances(middles[on], -1 - mesh.twins[halves[on]])
        return inside, along

    def farthest(self, corners: Floats, labels: Integers) -> Floats:
        """The largest distance of triangles' centres and the middles of their sides."""
        middles = ((corners + corners[:, [1, 2, 0]]) / 2).reshape(-1, 3)
        found = self.distances(np.concatenate([corners.mean(axis=1), middles]))
        return np.maximum(found[: len(corners)], largest_of(found[len(corners) :].reshape(-1, 3)))


def open_mesh(field: SheetField, points: Floats, triangles: Integers, rim: Integers) -> Labelled:
    """The mesh of points (N, 3), on curves of the field of given numbers (N,) or -1, and triangles (T, 3)."""
    edges, rims = Edges(triangles, len(points)), np.full(triangles.size, -1)
    if len(edges.rim):
        fixed, ends = field.fixed, rim[edges.rim]
        curves = np.where(fixed[ends[:, 0]], ends[:, 1], ends[:, 0])
        both = np.flatnonzero(fixed[curves])
        if len(both):
            curves[both] = field.between(points[edges.rim[both]], ends[both])
        rims[np.flatnonzero(edges.twins < 0)] = curves
    labels = np.zeros(len(triangles), dtype=np.intp)
    return Labelled.of(points, triangles, labels, rims=rims.reshape(-1, 3) if len(edges.rim) else None)


def remeshed(
    field: SheetField,
    first: Labelled,
    tolerance: float,
    settings: Settings,
    accept: Callable[[Floats], None] | None = None,
) -> Mesh:
    """The mesh in the user's coordinates within a tolerance, measured, from a first one.

    With `accept` the first mesh has few triangles, none of which is left out; it may raise an error where the vertices
    (K, 3) inside the coarse mesh that is made of it are not good enough to go on.  Raises `BadMeshError` where
    triangles are folded, or the tolerance is not reached, `MeshError` where there would be too many triangles.
    """
    remesher = Remesher(field, tolerance, settings)
    mesh = remesher.begun(first)
    remesher.graded(mesh, remesher.parts, thin=accept is None)
    remesher.untangle(mesh, settings.folded)
    if not (mesh.cosines >= settings.folded).all():
        raise BadMeshError(
            "some triangles are folded", mesh.points[mesh.triangles[np.argmin(mesh.cosines)]].mean(axis=0)
        )
    if accept is not None:
        accept(mesh.points[mesh.kinds == VertexKind.INSIDE])
    return in_world(field, remesher.refined(mesh))


def followed(field: SheetField, points: Floats, triangles: Integers, rim: Integers, tolerance: float) -> Mesh:
    """The mesh of points (N, 3) near the surface, or on curves of numbers (N,), moved onto it; see `remeshed`."""
    on = np.flatnonzero(rim >= 0)
    points = points.copy()
    points[on] = field.on_rims(points[on], rim[on])
    remesher = Remesher(field, tolerance, Settings())
    mesh = HalfEdges(open_mesh(field, points, triangles, rim), field.faces)
    mesh.points[:] = field.drawn(mesh, mesh.points)[0]
    mesh.points[:], mesh.normals[:] = field.projected(mesh)
    if not (mesh.cosines >= remesher.settings.folded).all():
        raise ArithmeticError("some triangles are folded")
    return in_world(field, remesher.within(mesh, mend=False))


def in_world(field: SheetField, found: FaceMesh) -> Mesh:
    """What was found in the user's coordinates; raises `ArithmeticError` where it leaves the region."""
    mesh = found.mesh
    if not field.within(mesh.points):
        raise ArithmeticError("the mesh leaves the region")
    assert mesh.normals is not None
    world, deviation = field.world(mesh.points), found.deviation * field.scale
    return Mesh.smooth(world, mesh.triangles, mesh.normals, deviation=deviation)
