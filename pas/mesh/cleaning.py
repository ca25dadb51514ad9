"""The mesh that a lattice gives of a boundary made good enough to be remeshed.

Vertices are projected onto their faces, curves and corners; what is far finer than the tolerance needs, and what is
short beside its neighbours, is collapsed; edges are flipped, vertices averaged and projected again.  Islands of one
triangle, curves that turn back, and folded triangles go as far as collapses remove them.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from pas.arrays import Floats
from pas.limits import checkpoint
from pas.mesh.face_ground import FaceGround
from pas.mesh.field import FaceField, column_of, label_of
from pas.mesh.grading import KEPT, Grading, Settings
from pas.mesh.halfedges import HalfEdges, VertexKind
from pas.mesh.labelled import Labelled
from pas.mesh.projection import onto_faces, project
from pas.mesh.rows import norms

SHORT = 0.55
"""Edges below this share of the mean length about both their ends are collapsed."""

SMOOTHINGS, PASSES = 3, 12
"""How often vertices are averaged, and how often edges are collapsed before each time."""

MORE_THAN_ENOUGH, FEW = 0.25, 0.005
"""Share of the length that the tolerance allows below which edges go; share of the vertices that must have gone for
going on."""

FOLD = 0.2
"""Cosine of a triangle's normal and its face's below which it counts as folded."""


def cleaned(mesh: Labelled, field: FaceField, tolerance: float) -> Labelled:
    """The mesh, good enough to be remeshed for a tolerance."""
    mesh = _with_special_points(mesh, field)
    return Cleaning(field, int(mesh.labels.max()) + 1, tolerance).cleaned(project(mesh, field, mesh.sizes / 2))


class Cleaning(Grading):
    """The cleaning of meshes that lattices give of a field, with so many labels."""

    def __init__(self, field: FaceField, labels: int, tolerance: float) -> None:
        super().__init__(FaceGround(field, labels, long=False), tolerance, Settings())
        self.field = field

    def cleaned(self, first: Labelled) -> Labelled:
        """A mesh whose vertices are on their faces, and which is good to be remeshed."""
        mesh = self.begun(first)
        self._coarsen(mesh)
        for _ in range(SMOOTHINGS):
            checkpoint(f"improving the mesh ({len(mesh.labels)} triangles)")
            self._collapse_short(mesh)
            mesh.size_plainly()
            self._smooth(mesh, np.ones(len(mesh.points), dtype=bool))
            rows = np.flatnonzero(mesh.kinds >= VertexKind.CORNER)  # may be found now that edges about them are longer
            mesh.points[rows] = onto_faces(mesh.points[rows], mesh.labels_about(rows), self.field, mesh.sizes[rows] / 4)
            self._evaluate(mesh, np.flatnonzero(mesh.kinds[mesh.vertex_of] >= VertexKind.CORNER))
        self._collapse_short(mesh)
        self.untangle(mesh, FOLD)
        return mesh.value

    def _coarsen(self, mesh: HalfEdges) -> None:
        """Collapse edges that are far shorter than the tolerance needs, such as those in the middle of a plane."""
        mesh.size_plainly()
        aim = np.minimum(self.tolerance, mesh.sizes / 4)  # so that sheets that the lattice keeps apart do not touch
        mesh.sizes[:] = MORE_THAN_ENOUGH * np.sqrt(8 * aim / np.maximum(_bend(mesh), 1e-9))
        gone, size = 1, 0
        while gone > FEW * size:
            checkpoint(f"coarsening the mesh ({len(mesh.labels)} triangles)")
            size = len(mesh.points)
            gone = self._collapse_below(mesh, 1.0)
            mesh.flip()

    def _collapse_below(self, mesh: HalfEdges, limit: float) -> int:
        """Collapse edges that are shorter than a share of the sizes at both ends, or along which a curve turns back,
        the shortest first; returns their number."""
        back = (mesh.kinds == VertexKind.CURVE) & ((_turns(mesh)[0] ** 2).sum(axis=1) > 2)
        chosen = mesh.on_curves & (back[mesh.corners] | back[mesh.ends])
        rows = np.flatnonzero(((mesh.ratios < limit) | chosen) & (mesh.twins < np.arange(len(mesh.twins))))
        rows = rows[np.argsort(mesh.lengths(rows), kind="stable")]
        return mesh.collapse(rows, 0.0, KEPT, self.settings.flat)

    def _collapse_short(self, mesh: HalfEdges) -> None:
        for _ in range(PASSES):
            mesh.size_plainly()
            if not self._collapse_below(mesh, SHORT):
                break
        mesh.flip()


def _turns(mesh: HalfEdges) -> tuple[Floats, Floats]:
    """The sums (V, 3) of the unit vectors along the curves' edges at vertices, and of the lengths of these edges."""
    curves, size = np.flatnonzero(mesh.on_curves), len(mesh.points)
    starts, ends, lengths = mesh.corners[curves], mesh.ends[curves], mesh.lengths(curves)
    units = (mesh.points[ends] - mesh.points[starts]) / np.maximum(lengths, 1e-300)[:, None]
    turns = np.asarray([np.bincount(starts, u, minlength=size) for u in units.T], dtype=float).T
    span = np.asarray(np.bincount(starts, lengths, minlength=size), dtype=float)
    return turns, span


def _bend(mesh: HalfEdges) -> Floats:
    """The largest curvature of faces and curves at each vertex (V,), from its edges."""
    mesh.bend()
    result = np.zeros(len(mesh.points))
    np.maximum.at(result, mesh.vertex_of, mesh.bends)
    turns, span = _turns(mesh)
    bent = norms(turns) / np.maximum(span / 2, 1e-300)
    return np.maximum(result, np.where(mesh.kinds >= VertexKind.CORNER, 0.0, bent))


def _with_special_points(mesh: Labelled, field: FaceField) -> Labelled:
    """The nearest vertex of the faces that end in each special point of the boundary moved there, and pinned.

    It may be far away in the lattice's scale, which does not show the tip of a slender cone.
    """
    points, pinned = mesh.points.copy(), [*mesh.topology.pinned]
    every = label_of(np.arange(len(field.signs(points[:1]))))  # the labels of all functions
    for special in field.special_points:
        here = special[None]
        values = field.jets(np.repeat(here, len(every), axis=0), every)[:, 0]
        zero = np.flatnonzero(np.abs(values) < 2.0**-36)  # which is rounding of what is of size 1
        signs = np.repeat(field.signs(here), 2 ** len(zero), axis=1)
        signs[zero] = np.array(list(product((False, True), repeat=len(zero)))).T
        inside = field.inside(signs)
        chosen = np.isin(column_of(mesh.topology.vertex_labels), zero).any(axis=1)
        if inside.any() and not inside.all() and chosen.any():
            nearest = int(np.where(chosen, norms(points - special), np.inf).argmin())
            points[nearest] = special
            pinned.append(nearest)
    return Labelled(points, replace(mesh.topology, pinned=np.array(pinned, dtype=np.intp)))
