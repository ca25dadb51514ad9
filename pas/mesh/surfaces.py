"""Meshes of boundaries that are several surfaces apart, such as both sides of a thin wall: each is meshed by itself.

Of the pieces of each those count that bound the whole set.  That the surfaces are apart is looked at on the meshes: the
cubes about points of one, three times as large as the tolerance, certainly miss the others, and no triangle of one
crosses a triangle of another.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations, permutations

import numpy as np

from pas.limits import checkpoint
from pas.mesh.crossings import crossings
from pas.mesh.face_ground import inner_points
from pas.mesh.field import FaceField, bounds_set
from pas.mesh.labelled import Labelled
from pas.mesh.projection import newton
from pas.mesh.refusals import FaceMesh, Made, Refusal
from pas.mesh.topology import connected

ROOM = 3.0
"""Half of a cube about a point of one surface that must miss the others, over the tolerance."""


def mesh_apart(
    field: FaceField, shells: Sequence[FaceField], tolerance: float, mesh: Callable[[FaceField, float], Made]
) -> Made | None:
    """The mesh of all of a boundary from those of its surfaces, by `mesh(shell, tolerance)`.

    None where they cross, or there is no room between them.
    """
    halvings = 6  # of the tolerance, until there is that room
    for halving in range(halvings):
        checkpoint("meshing surfaces one by one")
        aim, found = tolerance / 2**halving, list[tuple[FaceField, Labelled, float]]()
        for shell in shells:
            made = mesh(shell, aim)
            if isinstance(made, Refusal):
                return made
            found.append((shell, made.mesh, made.deviation))
        pairs = [(one, other) for (_, one, _), (other, _, _) in permutations(found, 2)]
        within = (other.inside(other.signs(one.points)) for one, other in pairs)
        if any(some.any() and not some.all() for some in within):
            return None
        points = (np.concatenate([one.points, inner_points(one.points[one.triangles])]) for one, _ in pairs)
        if not any(other.crossed(here, ROOM * aim).any() for here, (_, other) in zip(points, pairs, strict=True)):
            if any(_cross(one, other) for (_, one, _), (_, other, _) in combinations(found, 2)):
                return None
            whole = together(field, shells, [mesh for _, mesh, _ in found])
            return FaceMesh(whole, max(reached for *_, reached in found))
    return None


def _cross(first: Labelled, second: Labelled) -> bool:
    """Whether triangles of two meshes cross each other."""
    points = np.concatenate([first.points, second.points])
    pairs, _ = crossings(points, np.concatenate([first.triangles, second.triangles + len(first.points)]))
    return bool(np.diff(pairs < len(first.triangles), axis=1).any())


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
    middles, mostly = mesh.points[mesh.triangles].mean(axis=1), 0.5  # share of a piece's triangles that must do
    at = newton(middles, shell, mesh.labels[:, None], mesh.sizes[mesh.triangles].max(axis=1))
    changes = bounds_set(field, at, field.labels_of(shell, mesh.labels))
    pieces = connected(mesh.topology.edges, len(mesh.points))[mesh.triangles[:, 0]]
    share = np.bincount(pieces, changes) / np.maximum(np.bincount(pieces), 1)
    return np.asarray(share[pieces] > mostly)
