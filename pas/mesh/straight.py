"""Long triangles on faces with straight lines: planes, cylinders, cones and all that can be rolled out flat.

There a triangle may be as long as it likes along a line.  The curves around such faces are refined first; then
vertices inside go along the lines until few are left, and edges are flipped to those that are nearest to the face.
How near an edge is is known to second order from the normals at its ends, which are equal along a line.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pas.mesh.collapse import coarsen
from pas.mesh.field import FaceField, Floats, Integers
from pas.mesh.labelled import Labelled
from pas.mesh.quality import Quality
from pas.mesh.remesh import edge_sags, pair_normals
from pas.mesh.rows import any_of

STRAIGHT, ALLOWED = 0.3, 0.25
"""An edge counts as straight whose middle is nearer to its face than that share of what the edges may be that take
its place; and share of the tolerance that these may be off, where those that are there are not further."""


def coarser(mesh: Labelled, field: FaceField, aim: Floats, limit: float, quality: Quality) -> Labelled:
    """The mesh with few vertices on lines.

    Edges at each vertex may be off by a share of `aim` (N,), or as far as some are.
    """
    allowed, edges = ALLOWED * aim, mesh.topology.edges
    chosen = np.asarray(field.lines(mesh.topology.edge_table[1]).any(axis=1))
    off = edge_sags(mesh, field, chosen)[chosen]
    for ends in edges[chosen].T:
        np.maximum.at(allowed, ends, off)
    return straightened(mesh, field, allowed, limit, quality)


def straightened(mesh: Labelled, field: FaceField, allowed: Floats, limit: float, quality: Quality) -> Labelled:
    """The mesh without vertices on lines, as far as edges at vertices may be off (N,); none elsewhere goes.

    Edges on these faces that are off further than `limit` are flipped where that helps.  Triangles do not become more
    slender than the `quality` allows.
    """
    vertices, labels = mesh.topology.pairs.T
    lines_meet = labels[~pair_normals(mesh, field).any(axis=1)]  # in an apex, about which triangles must stay short
    bent = ~field.lines(labels) | np.isin(labels, lines_meet)
    if bent.all():
        return mesh
    allowed = allowed.copy()
    allowed[vertices[bent]] = -1.0

    def straight(m: Labelled, numbers: Integers, fresh: NDArray[np.bool_]) -> Integers:
        edges, most = m.topology.edges, allowed[numbers]
        close = np.where(any_of(fresh[edges]), STRAIGHT * most[edges].max(axis=1), 0.0)
        return np.flatnonzero(edge_sags(m, field, close > 0) < close)

    slenderest = quality.slenderest(field.planes(np.arange(int(labels.max()) + 1)))
    return coarsen(mesh, field, straight, allowed, limit, slenderest)
