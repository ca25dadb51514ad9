"""A graph over directions meshed by bisection: edges are halved, the longest as seen from the centre first.

New vertices are where the rays through the middles of edges meet the surface.  So all triangles are seen once from the
centre, and become small in directions where something is too far (longest-edge bisection, Rivara 1984): that ends
however sharply the surface bends, as about ridges that are sharper than the tolerance, where triangles that are
smoothed and moved along gradients fold.  There are more triangles of it, and worse ones, than of the remesher.

Looked at on the result, not proved: that no triangle is folded, and how far their middles and those of their edges are
from the surface: along the ray there, or to first order.  A ridge that none of these and no vertex is on is missed.
"""

from __future__ import annotations

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.grading import Settings
from pas.mesh.halfedges import HalfEdges, VertexKind, following
from pas.mesh.labelled import NONE
from pas.mesh.mesh import Mesh
from pas.mesh.refusals import FaceMesh, too_many
from pas.mesh.rows import cross, norms
from pas.mesh.shading import unit_rows
from pas.surface.graph import AROUND, delaunay, require_once
from pas.surface.radial_field import RadialField
from pas.surface.sheet import BadMeshError, in_world


def bisected(field: RadialField, tolerance: float, settings: Settings) -> Mesh:
    """A mesh in the user's coordinates within a tolerance, measured.

    Raises `ArithmeticError` where the surface is no graph over directions, as far as its rays show, and `MeshError`
    where there would be too many triangles.
    """
    mesh = _begun(field)
    while True:
        checkpoint(f"halving triangles seen from the centre ({len(mesh.labels)})")
        mesh.normals[:] = unit_rows(field.gradients(mesh.points))[mesh.vertex_of]
        inside, along = _measured(field, mesh)
        off = np.maximum(inside, along.reshape(-1, 3).max(axis=1))
        rim = mesh.boundary[0]
        rim = rim[along[rim] > np.minimum(tolerance, _room(mesh, rim))]
        halves = _chosen(mesh, rim, (off > tolerance) | (mesh.cosines < settings.folded))
        if not len(halves):
            require_once(field, mesh.points[mesh.kinds == VertexKind.INSIDE])
            return in_world(field, FaceMesh(mesh.value, float(off.max())), tolerance, settings)
        if len(mesh.labels) + 2 * len(halves) > settings.most:
            raise too_many(field.scale, len(mesh.labels), settings.most, tolerance, float(off.max()))
        size, middles, rims = len(mesh.points), mesh.middles(NONE, halves), mesh.rims_of(halves)
        mesh.split(halves)
        mesh.points[size:] = field.met(middles)
        mesh.points[size:][rims >= 0] = field.on_rims(middles[rims >= 0], rims[rims >= 0])


def _begun(field: RadialField) -> HalfEdges:
    """The first triangles, with rings of so many points that their arcs leave none of these."""
    finest = 4  # doublings of the points
    for doubling in range(finest + 1):
        mesh = HalfEdges(delaunay(field, AROUND << doubling), np.zeros(1, dtype=np.int8))
        rim = mesh.boundary[0]
        arcs = field.rim_distances(mesh.middles(NONE, rim), mesh.rims_of(rim))
        if (arcs <= _room(mesh, rim)).all():
            return mesh
    raise ArithmeticError("the rings are too close to one another for a triangulation of directions")


def _measured(field: RadialField, mesh: HalfEdges) -> tuple[Floats, Floats]:
    """Distances of triangles' middles (T,) and of those of half edges (3 T,)."""
    halves = np.flatnonzero(mesh.twins < np.arange(len(mesh.corners)))
    count = len(mesh.labels)
    points = mesh.middles(np.arange(count), halves)
    found = np.minimum(field.distances(points), norms(points - field.met(points)))
    along, twins, rims = np.empty(len(mesh.corners)), mesh.twins[halves], mesh.rims_of(halves)
    along[halves] = found[count:]
    along[halves[rims >= 0]] = field.rim_distances(points[count:][rims >= 0], rims[rims >= 0])
    along[twins[twins >= 0]] = along[halves[twins >= 0]]
    return found[:count], along


def _room(mesh: HalfEdges, halves: Integers) -> Floats:
    """How far curves may be from the half edges (K,) on them: where they turn by an angle of the triangle there, as
    seen from the centre, new vertices are no more inside it."""
    share = 1 / 8  # of an edge's length times an angle: an arc that leaves it by half of that is so far from it
    units, after = unit_rows(mesh.points), following(halves)
    a, b, c = (units[mesh.corners[side]] for side in (halves, after, following(after)))
    sines = norms(cross(b - a, c - a)) / (norms(b - a) * np.maximum(norms(c - a), norms(c - b)))
    return share * sines * mesh.lengths(halves)


def _chosen(mesh: HalfEdges, rim: Integers, bad: Bools) -> Integers:
    """The half edges to be halved, the longest first: those on the boundary that are too far from its curves; where
    there are none, the longest of bad triangles (T,); and of each triangle that has one of them its longest, without
    which angles become ever smaller (Rivara 1984)."""
    smallest = 1e-4  # radians within which a triangle is seen: what is still bad there is no graph, or singular
    units = unit_rows(mesh.points)
    lengths = norms(units[mesh.ends] - units[mesh.corners])
    own = np.maximum(np.arange(len(mesh.corners)), mesh.twins)  # the half edge that stands for both
    longest = own[3 * np.arange(len(bad)) + lengths.reshape(-1, 3).argmax(axis=1)]
    halves = np.unique(own[rim]) if len(rim) else np.unique(longest[bad])
    if lengths[halves].min(initial=np.inf) < smallest:
        raise BadMeshError("some triangles are folded", mesh.points[mesh.corners[halves[lengths[halves].argmin()]]])
    while True:
        sides = np.concatenate([halves, mesh.twins[halves]])
        more = np.union1d(halves, longest[sides[sides >= 0] // 3])
        if len(more) == len(halves):
            return halves[np.argsort(-lengths[halves], kind="stable")]
        halves = more
