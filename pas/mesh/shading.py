"""Normals of meshes: of points, of facets, and points doubled where faces meet at an edge."""

from __future__ import annotations

import numpy as np

from pas.mesh.rows import Floats, Integers, cross

GROUPS = 8
"""Of close normals at a vertex that are told apart; the rest share one more."""


def unit_rows(vectors: Floats) -> Floats:
    """The vectors (..., 3) at length one; those of length 0 stay."""
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    return np.asarray(vectors / np.maximum(np.sqrt(x * x + y * y + z * z), 1e-300)[..., None])


def uprightness(points: Floats, triangles: Integers, normals: Floats) -> Floats:
    """The cosines (T,) between triangles (T, 3) and the sums of the normals (N, 3) at their corners."""
    return uprightness_at(points[triangles], normals[triangles])


def uprightness_at(corners: Floats, normals: Floats) -> Floats:
    """The cosines (T,) between triangles of corners (T, 3, 3) and the sums of normals (T, 3, 3)."""
    a, b, c = corners.transpose(1, 0, 2)
    across, about = unit_rows(cross(b - a, c - a)), unit_rows(normals.sum(axis=1))
    return np.asarray((across * about).sum(axis=1))


def mean_normals(count: int, triangles: Integers, normals: Floats) -> Floats:
    """Unit normals (N, 3) of `count` points: the mean of those (T, 3, 3) of the corners there."""
    total = np.zeros((count, 3))
    np.add.at(total, triangles.ravel(), normals.reshape(-1, 3))
    return unit_rows(total)


def flat_normals(points: Floats, triangles: Integers) -> Floats:
    """Unit normals (T, 3, 3) of the facets, at each corner."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return np.repeat(unit_rows(np.cross(b - a, c - a))[:, None], 3, axis=1)


def sharp_points(count: int, triangles: Integers, normals: Floats) -> tuple[Integers, Integers, Floats]:
    """Points doubled along sharp edges only.

    Returns the numbers (M,) of the old points that the new ones are, the triangles (T, 3) of new ones, and
    their normals (M, 3).  Corners at one point share a new one if their normals (T, 3, 3) are close.
    """
    corner = triangles.ravel()
    flat = normals.reshape(-1, 3)
    order = np.argsort(corner, kind="stable")
    first = np.searchsorted(corner[order], np.arange(count))
    first = np.minimum(first, len(order) - 1)
    groups, pending = np.zeros(len(corner), dtype=np.intp), np.ones(len(corner), dtype=bool)
    leader = order[first][corner]
    for group in range(GROUPS):
        # Normals of a vertex's faces closer than this are one, so that smooth joints are shaded smoothly.
        smooth_cosine = 0.9
        close = pending & ((flat * flat[leader]).sum(axis=1) > smooth_cosine)
        groups[close], pending = group, pending & ~close
        if not pending.any():
            break
        rest = np.flatnonzero(pending)
        chosen = np.full(count, -1)
        chosen[corner[rest][::-1]] = rest[::-1]
        leader = np.where(pending, chosen[corner], leader)
    groups[pending] = GROUPS
    keys, inverse = np.unique(corner * (GROUPS + 1) + groups, return_inverse=True)
    renumbered = inverse.reshape(-1, 3).astype(np.intp)
    return keys // (GROUPS + 1), renumbered, mean_normals(len(keys), renumbered, normals)
