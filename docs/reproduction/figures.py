"""What the pictures of the report show, counted on meshes."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

SIZE = (360, 270)


def euler_characteristics(mesh: Any) -> tuple[int, ...]:
    """Of the connected pieces of a mesh, that with most triangles first."""
    triangles = np.asarray(mesh.triangles)
    edges = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    count = len(mesh.points)
    joined = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    label = connected_components(joined, directed=False)[1]
    kinds, sizes = np.unique(label[triangles[:, 0]], return_counts=True)
    points, lines = (np.bincount(label[x], minlength=label.max() + 1) for x in (np.unique(triangles), edges[:, 0]))
    return tuple(int(points[k] - lines[k]) + int(n) for n, k in sorted(zip(sizes, kinds, strict=True), reverse=True))


def openings(mesh: Any) -> int:
    """How many holes the largest piece of a mesh has, that is a sphere but for these."""
    return 2 - euler_characteristics(mesh)[0]
