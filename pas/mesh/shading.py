"""Normals of meshes: of points, of facets, and points doubled where faces meet at an edge."""

from __future__ import annotations

import numpy as np

from pas.arrays import Floats, Integers
from pas.mesh.rows import area_vectors
from pas.mesh.topology import connected, twins_of


def unit_rows(vectors: Floats) -> Floats:
    """The vectors (..., 3) at length one; those of length 0 stay."""
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    return np.asarray(vectors / np.maximum(np.sqrt(x * x + y * y + z * z), 1e-300)[..., None])


def normal_cosines(corners: Floats, normals: Floats) -> Floats:
    """The cosines (T,) between triangles of corners (T, 3, 3) and the sums of normals (T, 3, 3)."""
    across, about = unit_rows(area_vectors(corners)), unit_rows(normals.sum(axis=1))
    return np.asarray((across * about).sum(axis=1))


def mean_normals(count: int, triangles: Integers, normals: Floats) -> Floats:
    """Unit normals (N, 3) of `count` points: the mean of those (T, 3, 3) of the corners there."""
    total = np.zeros((count, 3))
    np.add.at(total, triangles.ravel(), normals.reshape(-1, 3))
    return unit_rows(total)


def flat_normals(points: Floats, triangles: Integers) -> Floats:
    """Unit normals (T, 3, 3) of the facets, at each corner."""
    return np.repeat(unit_rows(area_vectors(points[triangles]))[:, None], 3, axis=1)


def sharp_points(count: int, triangles: Integers, normals: Floats) -> tuple[Integers, Integers, Floats]:
    """Points doubled along sharp edges only.

    Returns the numbers (M,) of the old points that the new ones are, the triangles (T, 3) of new ones, and
    their normals (M, 3).  Corners at one point share a new one where neighbours' normals (T, 3, 3) are close.
    """
    smooth = 0.9  # cosine between normals of neighbours at a vertex above which their joint is shaded smoothly
    twins, flat = twins_of(triangles, count), normals.reshape(-1, 3)
    here = np.flatnonzero(twins >= 0)
    after, other = here - here % 3 + (here + 1) % 3, twins[here]  # the corners at the ends, and across the edge
    ends = np.concatenate([np.stack([here, other - other % 3 + (other + 1) % 3], axis=1), np.stack([after, other], 1)])
    ends = ends[(flat[ends[:, 0]] * flat[ends[:, 1]]).sum(axis=1) > smooth]
    renumbered = connected(ends, len(flat)).reshape(-1, 3)
    points = np.empty(int(renumbered.max(initial=-1)) + 1, dtype=np.intp)
    points[renumbered] = triangles
    return points, renumbered, mean_normals(len(points), renumbered, normals)
