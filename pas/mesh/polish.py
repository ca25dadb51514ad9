"""Mending the few triangles inside faces that came out slender, away from the curves where faces meet.

Refining halves edges here and there, and what lies between fine and coarse places may get a small angle.  Vertices of
such triangles are averaged again and edges about them flipped; only what is as near and better is kept.  Triangles
along straight lines are long on purpose, and those at a curve have the angles that the curve leaves.
"""

from __future__ import annotations

import numpy as np

from pas.mesh.deviation import Deviation
from pas.mesh.field import FaceField, Integers
from pas.mesh.labelled import Labelled
from pas.mesh.quality import smallest_angles
from pas.mesh.remesh import flip, smooth
from pas.mesh.rows import all_of

GOOD = float(np.radians(15.0))
"""Smallest angle below which a triangle inside a face is mended."""

ROUNDS, RINGS = 8, 2
"""Of averaging, each with one more ring of vertices around what is mended, up to so many."""


def polished(known: Deviation, field: FaceField, tolerance: float, limit: float) -> Deviation:
    """A mesh without slender triangles inside faces, as far as they can be mended within the tolerance; how near it is.

    Edges on faces with straight lines may be off by `limit`.
    """
    bad = _slender(known.mesh, field)
    best, least = known, len(bad)
    for number in range(ROUNDS):
        if not least or known.worst > tolerance:
            break
        mesh = known.mesh
        near = mesh.topology.around(mesh.triangles[bad].ravel(), min(number, RINGS)) & (mesh.topology.label_count == 1)
        about = mesh.topology.around(np.flatnonzero(near), 1)
        known = Deviation.of(flip(smooth(mesh, field, near), field, limit=limit, near=about), field, known)
        bad = _slender(known.mesh, field)
        if len(bad) < least and known.worst <= tolerance:
            best, least = known, len(bad)
    return best


def _slender(mesh: Labelled, field: FaceField) -> Integers:
    """The triangles (n,) with a small angle that touch no curve, on faces without straight lines."""
    inside = all_of((mesh.topology.label_count == 1)[mesh.triangles]) & ~field.lines(mesh.labels)
    rows = np.flatnonzero(inside)
    return rows[smallest_angles(mesh.points[mesh.triangles[rows]]) < GOOD]
