"""Long triangles on faces with straight lines: planes, cylinders, cones and all that can be rolled out flat.

There a triangle may be as long as it likes along a line.  The curves around such faces are refined first; then
vertices inside go along the lines until few are left, and edges are flipped to those that are nearest to the face.
How near an edge is is known to second order from the normals at its ends, which are equal along a line.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from pas.limits import checkpoint
from pas.mesh.collapse import collapse
from pas.mesh.field import FaceField, Floats, Integers
from pas.mesh.labelled import Labelled
from pas.mesh.remesh import edge_sags, flip, pair_normals

STRAIGHT, ALLOWED = 0.3, 0.25
"""An edge counts as straight whose middle is nearer to its face than that share of what the edges may be that take
its place; and share of the tolerance that these may be off, where those that are there are not further."""

FEW = 0.01
"""Share of the vertices that must have gone for going on."""


def coarser(mesh: Labelled, field: FaceField, aim: Floats, limit: float) -> Labelled:
    """The mesh with few vertices on lines.

    Edges at each vertex may be off by a share of `aim` (N,), or as far as some are.
    """
    allowed, edges = ALLOWED * aim, mesh.topology.edges
    chosen = np.asarray(field.lines(mesh.topology.edge_table[1]).any(axis=1))
    off = edge_sags(mesh, field, chosen)[chosen]
    for ends in edges[chosen].T:
        np.maximum.at(allowed, ends, off)
    return straightened(mesh, field, allowed, limit)


def straightened(mesh: Labelled, field: FaceField, allowed: Floats, limit: float) -> Labelled:
    """The mesh without vertices on lines, as far as edges at vertices may be off (N,); none elsewhere goes.

    Edges on these faces that are off further than `limit` are flipped where that helps.
    """
    vertices, labels = mesh.topology.pairs.T
    lines_meet = labels[~pair_normals(mesh, field).any(axis=1)]  # in an apex, about which triangles must stay short
    bent = ~field.lines(labels) | np.isin(labels, lines_meet)
    if bent.all():
        return mesh
    allowed = allowed.copy()
    allowed[vertices[bent]] = -1.0
    tree = cKDTree(mesh.points)

    @lru_cache(maxsize=1)
    def most(m: Labelled) -> Floats:
        return np.asarray(allowed[tree.query(m.points)[1]])

    def straight(m: Labelled, edges: Integers) -> NDArray[np.bool_]:
        close = STRAIGHT * most(m)[edges].max(axis=1)
        return np.asarray(edge_sags(m, field, close > 0) < close)

    while True:
        checkpoint(f"straightening the mesh ({len(mesh.triangles)} triangles)")
        smaller = flip(collapse(mesh, field, straight, 2, most), field, 2, limit)
        if len(smaller.points) > (1 - FEW) * len(mesh.points):
            return smaller
        mesh = smaller
