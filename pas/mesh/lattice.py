"""Conforming subdivision of tetrahedral cells, down to small tetrahedra where a surface passes.

Each cell is cut by Freudenthal's triangulation of the lattice of its barycentric coordinates and
then halved again and again (each tetrahedron into eight, which is the triangulation of the
finer lattice), only where the function may vanish.  On faces this leaves the standard triangles,
so neighbours fit.  A tetrahedron is dropped where the values at its corners are further from 0
than twice the steepest corner gradient could bring them: an estimate, not a bound.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations

import numpy as np

from pas.limits import checkpoint
from pas.mesh.field import CellField, Floats, Integers

STEEPER = 2.0
"""How much steeper than at its corners a function may be inside a tetrahedron."""


@dataclass(frozen=True)
class Lattice:
    """Nodes (N, 3) with values (N,), and the small tetrahedra (T, 4) the surface passes through."""

    points: Floats
    values: Floats
    tetrahedra: Integers


def lattice(field: CellField, coarse: int, halvings: int) -> Lattice:
    """The small tetrahedra across which the field changes sign, with shared nodes.

    A cell's edge is subdivided into `coarse` parts before the first test, `coarse * 2**halvings` in
    the end.
    """
    keys, tetrahedra, found = [], [], 0
    for number, cell in enumerate(field.cells):
        corners, small = _active(field, number, coarse, halvings)
        full = np.zeros((len(corners), len(field.vertices)), dtype=np.intp)
        full[:, cell] = corners
        keys.append(full)
        tetrahedra.append(small + found)
        found += len(corners)
    nodes, inverse = np.unique(np.concatenate(keys), axis=0, return_inverse=True)
    points = nodes @ field.vertices / (coarse << halvings)
    values = field.jets(points, field.locate(points))[:, 0]
    values = np.where(values == 0, 1e-300, values)
    joined = inverse.ravel()[np.concatenate(tetrahedra)]
    negative = (values < 0)[joined]
    return Lattice(points, values, joined[negative.any(axis=1) & ~negative.all(axis=1)])


def _active(field: CellField, number: int, coarse: int, halvings: int) -> tuple[Integers, Integers]:
    """Nodes of one cell (barycentric, in parts) and its small tetrahedra that may be crossed."""
    corners = field.vertices[field.cells[number]]
    nodes, tetrahedra = _freudenthal(coarse)
    eighth_nodes, eighths = _freudenthal(2)
    parts = coarse
    for level in range(halvings + 1):
        checkpoint("refining the lattice")
        if level:
            children = np.einsum("ek,tkw->tew", eighth_nodes, nodes[tetrahedra])[:, eighths].reshape(-1, 4)
            parts *= 2
            nodes, tetrahedra = _distinct(children, parts)
        points = nodes @ corners / parts
        jets = field.jets(points, np.full(len(points), number))
        steepest = np.sqrt((jets[:, 1:] ** 2).sum(axis=1))[tetrahedra].max(axis=1)
        p = points[tetrahedra]
        width = np.sqrt(((p - p.mean(axis=1, keepdims=True)) ** 2).sum(axis=2)).max(axis=1)
        near = np.abs(jets[:, 0])[tetrahedra].min(axis=1) <= STEEPER * steepest * width + 1e-12
        negative = (jets[:, 0] < 0)[tetrahedra]
        tetrahedra = tetrahedra[near | (negative.any(axis=1) & ~negative.all(axis=1))]
    used, inverse = np.unique(tetrahedra, return_inverse=True)
    return nodes[used], inverse.reshape(-1, 4)


def _distinct(children: Integers, parts: int) -> tuple[Integers, Integers]:
    """Distinct nodes of tetrahedra given by the barycentric coordinates of their corners."""
    size = parts + 1
    key = (children[:, 1] * size + children[:, 2]) * size + children[:, 3]
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    return children[first], inverse.reshape(-1, 4)


@lru_cache(maxsize=8)
def _freudenthal(n: int) -> tuple[Integers, Integers]:
    """Barycentric indices (m, 4) of the lattice of a tetrahedron, and its n^3 tetrahedra (n^3, 4).

    In the coordinates n >= x1 >= x2 >= x3 >= 0 each unit cube is cut along its six monotone
    paths; those inside make up the tetrahedron.  Corners are listed along the path, so cutting a
    small tetrahedron again gives tetrahedra of the finer lattice.
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
