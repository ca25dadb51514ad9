"""The faces of a solid as the ground of a closed mesh: vertices are projected by Newton's method."""

from __future__ import annotations

import numpy as np

from pas.arrays import Floats, Integers
from pas.mesh.field import FaceField
from pas.mesh.halfedges import HalfEdges, VertexKind
from pas.mesh.projection import least_norm, newton, placing
from pas.mesh.rows import norms
from pas.mesh.shading import unit_rows

STEP = 0.1
"""The longest step of one Newton's method towards faces, over the reach; curves take two steps."""

NEAR = 0.05
"""The longest step where vertices are near, over the reach."""

INNER = 4
"""Points inside a triangle where its deviation is measured: the middle, and those halfway from it to the corners."""


class FaceGround:
    """The faces of a field by their labels; see `pas.mesh.grading.Ground`.

    Where long triangles are not wanted no face counts as ruled.
    """

    knows_bends = False

    def __init__(self, field: FaceField, labels: int, long: bool = True) -> None:
        self.field, self.reach = field, float(norms(np.ptp(field.box, axis=0)[None] / 2)[0])
        self.faces = (field.ruled(np.arange(labels)) * long).astype(np.int8)

    def drawn(self, mesh: HalfEdges, to: Floats) -> tuple[Floats, Floats, None]:
        """Places for vertices that move, one step towards their faces, or two towards curves; and normals."""
        move = np.flatnonzero((to != mesh.points).any(axis=1))
        points, inside = mesh.points.copy(), move[mesh.kinds[move] == VertexKind.INSIDE]
        steps = least_norm(self.field, mesh.labels_at(inside)[:, None], to[inside])
        points[inside] = to[inside] - self._capped(steps)
        on = move[mesh.kinds[move] != VertexKind.INSIDE]
        points[on] = to[on]
        for rows, functions in placing(self.field, mesh.labels_about(on)):
            for _ in range(2):
                points[on[rows]] -= self._capped(least_norm(self.field, functions, points[on[rows]]))
        return points, self.local_geometry(points[mesh.vertex_of], mesh.face_of)[0], None

    def _capped(self, steps: Floats) -> Floats:
        return steps * np.minimum(1.0, STEP * self.reach / np.maximum(norms(steps), 1e-300))[:, None]

    def placed(self, points: Floats, labels: Integers, rims: Integers, reach: Floats) -> Floats:
        result = points.copy()
        for rows, functions in placing(self.field, labels):
            result[rows] = newton(points[rows], self.field, functions, reach[rows])
        return result

    def projected(self, mesh: HalfEdges) -> tuple[Floats, Floats]:
        """All vertices but corners projected onto faces and curves, and the normals there."""
        rows, points = np.flatnonzero(mesh.kinds < VertexKind.CORNER), mesh.points.copy()
        reach = np.full(len(rows), NEAR * self.reach)
        points[rows] = self.placed(mesh.points[rows], mesh.labels_about(rows), rows, reach)
        return points, self.local_geometry(points[mesh.vertex_of], mesh.face_of)[0]

    def local_geometry(self, points: Floats, labels: Integers) -> tuple[Floats, None]:
        return unit_rows(self.field.jets(points, labels)[:, 1:]), None

    def measured(self, mesh: HalfEdges, rows: Integers, halves: Integers) -> tuple[Floats, Floats]:
        """Distances of points inside triangles from their faces, and of edges' middles from faces or curves."""
        inside = self._inside(mesh.points[mesh.triangles[rows]], mesh.labels[rows])
        middles = mesh.middles(rows[:0], halves)
        label, other = mesh.labels[halves // 3], mesh.labels[mesh.twins[halves] // 3]
        labels = np.stack([np.minimum(label, other), np.where(label == other, -1, np.maximum(label, other))], axis=1)
        along = np.zeros(len(middles))
        for at, functions in placing(self.field, labels):
            along[at] = norms(least_norm(self.field, functions, middles[at]))
        return inside, along

    def _inside(self, corners: Floats, labels: Integers) -> Floats:
        each = np.repeat(labels, INNER)[:, None]
        return np.asarray(norms(least_norm(self.field, each, inner_points(corners))).reshape(-1, INNER).max(axis=1))

    def farthest(self, corners: Floats, labels: Integers) -> Floats:
        middles = ((corners + corners[:, [1, 2, 0]]) / 2).reshape(-1, 3)
        sides = norms(least_norm(self.field, np.repeat(labels, 3)[:, None], middles)).reshape(-1, 3)
        return np.maximum(self._inside(corners, labels), sides.max(axis=1))


def inner_points(corners: Floats) -> Floats:
    """The points (4 T, 3), triangle by triangle, at which triangles of corners (T, 3, 3) are compared."""
    total = corners[:, 0] + corners[:, 1] + corners[:, 2]
    result = np.empty((len(corners), INNER, 3))
    result[:, 0] = total / 3
    result[:, 1:] = (total[:, None] + 3 * corners) / 6
    return result.reshape(-1, 3)
