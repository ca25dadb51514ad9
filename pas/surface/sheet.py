"""A surface in its local coordinates as the ground of an open mesh, whose boundary curves are the surface's."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np

from pas.algebra.rational import to_fraction
from pas.arrays import Bools, Floats, Integers
from pas.limits import blocks
from pas.mesh.grading import Settings
from pas.mesh.halfedges import HalfEdges, VertexKind
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.refusals import FaceMesh, too_many
from pas.mesh.remesher import Failure, Remesher
from pas.mesh.rows import dots, largest_of, norms, off_zero
from pas.mesh.shading import unit_rows
from pas.mesh.topology import Edges
from pas.surface.evaluator import BLOCK
from pas.surface.function import PiecewisePolynomial
from pas.surface.geometry import SECOND

CLOSE = 1e-11
"""The last step along a gradient, in local units, that is worth another."""

TINY = 1e-300
"""The length of a gradient at least."""

INSIDE = 1e-11
"""How far outside the region a point may be by rounding: in local units, barycentric coordinates, or over the way to
where its ray leaves."""


class BadMeshError(ArithmeticError):
    """Why triangles are no good mesh, and near which point (3,), in the coordinates of the surface."""

    def __init__(self, why: str, place: Floats) -> None:
        super().__init__(why)
        self.place = place


class LocalSurface(ABC):
    """A piecewise surface at points (N, 3) in its local coordinates, scaled, as a ground of the remesher.

    See `pas.mesh.grading.Ground`.
    """

    faces = np.zeros(1, dtype=np.int8)
    knows_bends = True

    def __init__(self, surface: PiecewisePolynomial) -> None:
        local, self.degree, self.evaluator = surface.local, max(surface.degree, 1), surface.evaluator
        self.frame = surface.partition.frame
        self.scale = float(to_fraction(self.frame.scale))
        self.reach = float(np.sqrt((local.points**2).sum(axis=1).max()))
        self._batches = [self.evaluator.batch(*range(order + 1)) for order in range(3)]

    @abstractmethod
    def pieces(self, points: Floats) -> Integers:
        """The numbers of the pieces (N,) whose polynomials count at points."""

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
    def near(self, points: Floats) -> Floats:
        """Points (N, 3) of the surface near points inside or outside it."""

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""
        return self.frame.global_points(points)

    def derivatives(self, points: Floats, order: int) -> Floats:
        """The partial derivatives (N, 1, 4 or 10) up to an order of at most 2, beginning with the values."""
        return self._batches[order](points, self.pieces(points))

    def values(self, points: Floats) -> Floats:
        """The values (N,)."""
        return self.derivatives(points, 0)[:, 0]

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4)."""
        return self.derivatives(points, 1)

    def gradients(self, points: Floats) -> Floats:
        """The gradients (N, 3)."""
        return self.jets(points)[:, 1:]

    def distances(self, points: Floats) -> Floats:
        """The distances |f| / |grad f| (N,), to first order."""
        result = np.empty(len(points))
        for here in blocks(len(points), BLOCK):
            jets = self.jets(points[here])
            result[here] = off_zero(jets[:, 0], jets[:, 1:])
        return result

    def nearer(self, points: Floats, still: Bools, order: int) -> tuple[Floats, Floats]:
        """Points near the surface moved towards it, but for those that are `still` (N,), and the derivatives there.

        By a step along the gradient, or as `near` does where the next one would be more than a tenth of it.
        """
        left = 0.1  # a larger share means that a point was not near the surface
        ways = gradient_steps(self.jets(points))
        moved = np.where(still, points.T, points.T + ways.T).T
        jets = self.derivatives(moved, order)
        allowed = (left**2 * dots(ways, ways) + CLOSE**2) * dots(jets[:, 1:4], jets[:, 1:4])
        lost = np.flatnonzero(~still & ~(jets[:, 0] * jets[:, 0] <= allowed))
        if len(lost):
            moved[lost] = self.near(points[lost])
            jets[lost] = self.derivatives(moved[lost], order)
        return moved, jets

    def bending(self, points: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) and the larger of the principal curvatures' sizes (N,) at points on the surface."""
        return bent(self.derivatives(points, 2))

    def closed(self, points: Floats, jets: Floats, steps: int = 6) -> tuple[Floats, Floats]:
        """Points very near the surface, with values and gradients there (N, 4), moved onto it along gradients, (N, 3);
        and gradients (N, 3) where the last step was made, of two or three mostly."""
        ways, gradients = gradient_steps(jets), jets[:, 1:]
        moved = (points.T + ways.T).T
        far = np.flatnonzero(largest_of(np.abs(ways)) > CLOSE)
        if not len(far) or steps == 1:
            return moved, gradients
        if len(far) == len(moved):
            return self.closed(moved, self.jets(moved), steps - 1)
        here, gradients = moved.T.take(far, axis=1).T, np.array(gradients.T).T
        moved[far], gradients[far] = self.closed(here, self.jets(here), steps - 1)
        return moved, gradients

    def drawn(self, mesh: HalfEdges, to: Floats) -> tuple[Floats, Floats, Floats]:
        to, on = to.copy(), np.flatnonzero(mesh.kinds == VertexKind.CURVE)
        if len(on):
            to[on] = self.on_rims(to[on], mesh.rims_of(mesh.outgoing[on]))
        points, jets = self.nearer(to, mesh.kinds != VertexKind.INSIDE, 2)
        gradients, bends = bent(jets)
        return points, unit_rows(gradients).take(mesh.vertex_of, axis=0), bends[mesh.vertex_of]

    def placed(self, points: Floats, labels: Integers, rims: Integers, reach: Floats) -> Floats:
        points, on = points.copy(), rims >= 0
        if on.any():
            points[on] = self.on_rims(points[on], rims[on])
        inside = np.flatnonzero(~on)
        points[inside] = self.closed(*self.nearer(points[inside], on[inside], 1))[0]
        return points

    def projected(self, mesh: HalfEdges) -> tuple[Floats, Floats]:
        points, gradients = np.empty((2, len(mesh.points), 3))
        for here in blocks(len(points), BLOCK):
            points[here], gradients[here] = self.closed(mesh.points[here], self.jets(mesh.points[here]))
        rest, on = np.flatnonzero(mesh.kinds != VertexKind.INSIDE), np.flatnonzero(mesh.kinds == VertexKind.CURVE)
        points[rest] = mesh.points[rest]
        if len(on):
            points[on] = self.on_rims(points[on], mesh.rims_of(mesh.outgoing[on]))
        gradients[rest] = self.gradients(points[rest])
        return points, unit_rows(gradients).take(mesh.vertex_of, axis=0)

    def local_geometry(self, points: Floats, labels: Integers) -> tuple[Floats, Floats]:
        gradients, bends = self.bending(points)
        return unit_rows(gradients), bends

    def measured(self, mesh: HalfEdges, rows: Integers, halves: Integers) -> tuple[Floats, Floats]:
        """Distances of triangles' centres and edges' middles, those of the boundary from its curves."""
        middles = mesh.middles(rows, halves)
        found = self.distances(middles)
        inside, along = found[: len(rows)], found[len(rows) :]
        on = np.flatnonzero(mesh.twins[halves] < 0)
        if len(on):
            along[on] = self.rim_distances(middles[len(rows) + on], -1 - mesh.twins[halves[on]])
        return inside, along

    def farthest(self, corners: Floats, labels: Integers) -> Floats:
        """The largest distance of triangles' centres and the middles of their sides."""
        middles = ((corners + corners[:, [1, 2, 0]]) / 2).reshape(-1, 3)
        found = self.distances(np.concatenate([corners.mean(axis=1), middles]))
        return np.maximum(found[: len(corners)], largest_of(found[len(corners) :].reshape(-1, 3)))


def bent(jets: Floats) -> tuple[Floats, Floats]:
    """Gradients (N, 3) and the larger of the principal curvatures' sizes (N,), by derivatives (N, 10)."""
    gradients, lengths = jets[:, 1:4], np.maximum(norms(jets[:, 1:4]), TINY)
    normals = gradients.T / lengths
    turned = jets.T[SECOND] * normals
    turned = turned[:, 0] + turned[:, 1] + turned[:, 2]
    along = dots(normals.T, turned.T)
    trace = jets[:, 4] + jets[:, 7] + jets[:, 9] - along
    xx, xy, xz, yy, yz, zz = jets.T[4:] * jets.T[4:]
    squares = xx + yy + zz + 2 * (xy + xz + yz) + (along * along - 2 * dots(turned.T, turned.T))
    bends = np.abs(trace) + np.sqrt(np.maximum(2 * squares - trace * trace, 0.0))
    return gradients, bends / (2 * lengths)


def gradient_steps(jets: Floats) -> Floats:
    """Newton's steps (N, 3) along gradients, by values and gradients (N, 4)."""
    gradients = jets[:, 1:]
    return np.asarray((-jets[:, 0] / np.maximum(dots(gradients, gradients), TINY) * gradients.T).T)


def open_mesh(field: LocalSurface, points: Floats, triangles: Integers, rim: Integers) -> Labelled:
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
    field: LocalSurface,
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
    return in_world(field, remesher.refined(mesh), tolerance, settings)


def followed(field: LocalSurface, points: Floats, triangles: Integers, rim: Integers, tolerance: float) -> Mesh:
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
    return in_world(field, remesher.within(mesh, mend=False, upright=True), tolerance, remesher.settings)


def in_world(field: LocalSurface, found: FaceMesh | Failure, tolerance: float, settings: Settings) -> Mesh:
    """The mesh in the user's coordinates; raises `ArithmeticError` where it leaves the region."""
    if isinstance(found, Failure):
        if found.crowded:
            raise too_many(field.scale, found.triangles, settings.most, tolerance, found.reached)
        raise BadMeshError(found.why, found.place)
    mesh = found.mesh
    if not field.within(mesh.points):
        raise ArithmeticError("the mesh leaves the region")
    assert mesh.normals is not None
    world, deviation = field.world(mesh.points), found.deviation * field.scale
    return Mesh.smooth(world, mesh.triangles, mesh.normals, deviation=deviation)
