"""Meshes of boundaries that are several surfaces apart, such as both sides of a thin wall: one by one.

Each surface is meshed as if it were alone; of its pieces those count that bound the whole set.  The meshes keep their
distance: the cubes about points of one, three times as large as the tolerance, certainly miss the other surface.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import permutations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pas.limits import checkpoint
from pas.mesh.face_ground import inner_points
from pas.mesh.field import FaceField
from pas.mesh.labelled import Labelled
from pas.mesh.projection import newton
from pas.mesh.refusals import Made, Refusal
from pas.mesh.rows import Floats
from pas.mesh.shading import unit_rows

ROOM = 3.0
"""Half of a cube about a point of one surface that must miss the others, over the tolerance."""

HALVINGS = 6
"""Of the tolerance, until there is that room."""

BESIDE, MOSTLY = 1e-6, 0.5
"""How far on both sides of a piece the set is looked at, over the extent of the box; share of a piece's triangles
across which it must change."""


def mesh_apart(
    field: FaceField,
    shells: Sequence[FaceField],
    tolerance: float,
    mesh: Callable[[FaceField, float], Made],
) -> Made | None:
    """The mesh of all of a boundary, and how near it is, from those of its surfaces, by `mesh(shell, tolerance)`.

    None where there is no room between them.
    """
    for halving in range(HALVINGS):
        checkpoint("meshing surfaces one by one")
        aim = tolerance / 2**halving
        meshes: list[Labelled] = []
        reached = []
        for shell in shells:
            made = mesh(shell, aim)
            if isinstance(made, Refusal):
                return made
            meshes.append(made[0])
            reached.append(made[1])
        pairs = permutations(zip(shells, meshes, strict=True), 2)
        if not any(other.crossed(_points(one), ROOM * aim).any() for (_, one), (other, _) in pairs):
            return together(field, shells, meshes), max(reached)
    return None


def _points(mesh: Labelled) -> Floats:
    """The vertices and points inside the triangles (K, 3)."""
    return np.concatenate([mesh.points, inner_points(mesh.points[mesh.triangles])])


def together(field: FaceField, shells: Sequence[FaceField], meshes: Sequence[Labelled]) -> Labelled:
    """The mesh of a boundary from those of its surfaces, without the pieces of these that bound nothing."""
    points, triangles, labels, pinned, start = [], [], [], [], 0
    for shell, mesh in zip(shells, meshes, strict=True):
        kept = _bounding(field, shell, mesh)
        used, numbers = np.unique(mesh.triangles[kept], return_inverse=True)
        points.append(mesh.points[used])
        triangles.append(numbers.reshape(-1, 3) + start)
        labels.append(field.labels_of(shell, mesh.labels[kept]))
        pinned.append(np.flatnonzero(np.isin(used, mesh.topology.pinned)) + start)
        start += len(used)
    return Labelled.of(*map(np.concatenate, (points, triangles, labels, pinned)))


def _bounding(field: FaceField, shell: FaceField, mesh: Labelled) -> np.ndarray:
    """Which triangles (T,) are on pieces that bound the set: it changes across most triangles of each."""
    edges = mesh.topology.edges
    graph = coo_array((np.ones(len(edges)), edges.T), shape=(len(mesh.points),) * 2)
    piece = connected_components(graph, directed=False)[1]
    middles = mesh.points[mesh.triangles].mean(axis=1)
    at = newton(middles, shell, mesh.labels[:, None], mesh.sizes[mesh.triangles].max(axis=1))
    extent = float(np.ptp(field.box, axis=0).max())
    step = BESIDE * extent * unit_rows(shell.jets(at, mesh.labels)[:, 1:])
    changes = field.inside(field.signs(at - step)) & ~field.inside(field.signs(at + step))
    pieces = piece[mesh.triangles[:, 0]]
    share = np.bincount(pieces, changes) / np.maximum(np.bincount(pieces), 1)
    return np.asarray(share[pieces] > MOSTLY)
