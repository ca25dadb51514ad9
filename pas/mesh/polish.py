"""Mending the triangles inside faces that came out slender, away from the curves where faces meet.

Refining halves edges here and there, and what lies between fine and coarse places gets small angles, as does what
the first mesh had too many or too few triangles about a vertex.  Triangles along straight lines are long on purpose,
and those at a curve have the angles that the curve leaves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pas.mesh.field import FaceField, Floats, Integers
from pas.mesh.labelled import Labelled
from pas.mesh.mending import Mending
from pas.mesh.refine import farthest_inside, inner_points
from pas.mesh.remesh import least_norm, newton, pair_normals
from pas.mesh.rows import norms
from pas.mesh.shading import unit_rows

GOOD = 0.515
"""Sine of the angle, 31 degrees, below which a triangle inside a face is mended."""

ROUNDS = 12
"""Of moves and flips."""


def polished(mesh: Labelled, field: FaceField, worst: float, tolerance: float) -> tuple[Labelled, float]:
    """A mesh without slender triangles inside faces, as far as they can be mended within the tolerance.

    Those on faces with straight lines stay.  The mesh is as far off as `worst`; the result no further than what is
    returned with it.
    """
    topology, normals = mesh.topology, pair_normals(mesh, field)
    vertices, labels = topology.pairs.T
    bent = (topology.label_count[vertices] == 1) & ~field.lines(labels) & normals.any(axis=1)
    free, own = np.zeros(topology.size, dtype=bool), np.zeros((topology.size, 3))
    free[vertices[bent]], own[vertices[bent]] = True, normals[bent]
    mending = Mending(mesh.points.copy(), mesh.triangles.copy(), mesh.labels, own, free, _Faces(field), GOOD, tolerance)
    if not mending.mend(ROUNDS):
        return mesh, worst
    known = normals.copy()
    known[bent] = mending.normals[vertices[bent]]
    changed = replace(topology, triangles=mending.triangles)  # each vertex stays on its faces
    return Labelled(mending.points, changed, known), max(worst, mending.worst)


@dataclass(frozen=True)
class _Faces:
    """The faces of a set, on which vertices move."""

    field: FaceField

    def placed(self, points: Floats, labels: Integers) -> tuple[Floats, Floats]:
        """Points (K, 3) moved onto faces of labels (K,), and the unit normals there."""
        moved = newton(points, self.field, labels[:, None], np.full(len(points), np.inf))
        return moved, unit_rows(self.field.jets(moved, labels)[:, 1:])

    def farthest(self, corners: Floats, labels: Integers) -> Floats:
        """The largest distance of triangles (T, 3, 3) and their edges from faces of labels (T,), to first order."""
        middles = ((corners + corners[:, [1, 2, 0]]) / 2).reshape(-1, 3)
        points, times = np.concatenate([middles, inner_points(corners)]), 3 * len(corners)
        each = np.concatenate([np.repeat(labels, 3), np.repeat(labels, len(points) // max(len(corners), 1) - 3)])
        distances = norms(least_norm(self.field, each[:, None], points))
        return np.maximum(distances[:times].reshape(-1, 3).max(axis=1), farthest_inside(distances[times:]))
