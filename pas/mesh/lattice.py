"""Conforming uniform subdivision of tetrahedral cells, where a surface passes.

Each cell is cut into N^3 tetrahedra by Freudenthal's triangulation of the lattice of its
barycentric coordinates; on a face this leaves the standard N^2 triangles, so neighbours fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations

import numpy as np

from pas.mesh.field import CellField, Floats, Integers


@dataclass(frozen=True)
class Lattice:
    """Nodes (N, 3) with values (N,) and home cells, and the small tetrahedra (T, 4) that matter."""

    points: Floats
    values: Floats
    tetrahedra: Integers


def lattice(field: CellField, subdivisions: int) -> Lattice:
    """The small tetrahedra across which the field changes sign, with shared nodes."""
    indices, small = _freudenthal(subdivisions)
    keys: list[Integers] = []
    kept: list[Integers] = []
    found = 0
    weights = indices / subdivisions
    for number, cell in enumerate(field.cells):
        values = field.jets(weights @ field.vertices[cell], np.full(len(weights), number))[:, 0]
        negative = (values < 0)[small]
        # keep a margin of doubt: a value near 0 may be rounded to the other side in a neighbour
        doubtful = (np.abs(values) < 1e-12)[small].any(axis=1)
        crossed = small[(negative.any(axis=1) & ~negative.all(axis=1)) | doubtful]
        used, inverse = np.unique(crossed, return_inverse=True)
        full = np.zeros((len(used), len(field.vertices)), dtype=np.intp)
        full[:, cell] = indices[used]
        kept.append(inverse.reshape(crossed.shape) + found)
        found += len(used)
        keys.append(full)
    nodes, inverse = np.unique(np.concatenate(keys), axis=0, return_inverse=True)
    tetrahedra = inverse.ravel()[np.concatenate(kept)]
    points = nodes @ field.vertices / subdivisions
    values = field.jets(points, field.locate(points))[:, 0]
    values = np.where(values == 0, 1e-300, values)
    negative = (values < 0)[tetrahedra]
    return Lattice(points, values, tetrahedra[negative.any(axis=1) & ~negative.all(axis=1)])


@lru_cache(maxsize=8)
def _freudenthal(n: int) -> tuple[Integers, Integers]:
    """Barycentric indices (m, 4) of the lattice of a tetrahedron, and its n^3 tetrahedra (n^3, 4).

    In the coordinates n >= x1 >= x2 >= x3 >= 0 each unit cube is cut along its six monotone
    paths; those inside make up the tetrahedron.
    """
    x = np.stack(np.meshgrid(*[np.arange(n + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = (x[:, 0] >= x[:, 1]) & (x[:, 1] >= x[:, 2])
    number = np.full(len(x), -1)
    number[inside] = np.arange(inside.sum())
    x = x[inside]
    bary = np.stack([n - x[:, 0], x[:, 0] - x[:, 1], x[:, 1] - x[:, 2], x[:, 2]], axis=1)
    stride = np.array([(n + 1) ** 2, n + 1, 1])
    corners = x[(x[:, 0] < n)]
    blocks = []
    for path in permutations(range(3)):
        steps = np.zeros((4, 3), dtype=int)
        for i, axis in enumerate(path):
            steps[i + 1] = steps[i]
            steps[i + 1, axis] += 1
        nodes = corners[:, None] + steps
        valid = (nodes[..., 0] >= nodes[..., 1]).all(1) & (nodes[..., 1] >= nodes[..., 2]).all(1)
        blocks.append(number[nodes[valid] @ stride])
    return bary, np.concatenate(blocks)
