"""The compiled functions that make triangles good ones, called with arrays.

Those of `pas.mesh.contour`, `lattice` and `octree`; those for half edges are in `pas.mesh.halfedges`.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from pas.bernstein.subdivision import Means
from pas.kernels.library import Functions
from pas.mesh.rows import Floats, Integers


class CompiledTriangles:
    """The functions of the compiled library; arrays are contiguous, numbers as large as pointers."""

    def __init__(self, functions: Functions) -> None:
        self._call = functions.call

    def crossings(self, tetrahedra: Integers, negative: NDArray[np.bool_]) -> Integers:
        """The keys of crossed edges at the corners of triangles (3 T,); see `pas.mesh.contour.crossings`."""
        keys, number = np.empty(6 * len(tetrahedra), dtype=np.intp), np.empty(1, dtype=np.intp)
        self._call("pas_crossings", len(tetrahedra), tetrahedra, len(negative), negative, keys, number)
        return keys[: 3 * number[0]]

    def oriented(
        self, triangles: Integers, points: Floats, edges: Integers, nodes: Floats, negative: NDArray[np.bool_]
    ) -> Integers:
        """See `pas.mesh.contour.oriented`."""
        result = triangles.copy()
        self._call("pas_oriented", len(result), result, points, edges, nodes, negative)
        return result

    def tetrahedra(self, halved: list[Integers], missed: list[Integers], counts: Integers) -> Integers:
        """The corners (T, 4), as numbers, of cubes that are halved on each level and missed on one more; see
        `pas.mesh.octree.Octree.tetrahedra`."""
        found = np.empty(2, dtype=np.intp)
        parts = [(np.concatenate(level), np.cumsum([0, *map(len, level)])) for level in (halved, missed)]
        self._call("pas_tetrahedra", len(halved), *parts[0], *parts[1], counts, found)
        result = np.empty((found[0], 4), dtype=np.intp)
        self._call("pas_tetrahedra_taken", *found.tolist(), result)
        return result

    def eighths(
        self, corners: Integers, parts: Means, rounding: float, keys: Integers, points: Floats, forms: Floats
    ) -> tuple[Integers, Floats, Floats]:
        """The `parts`, of given corners (8, 4, 4), that may hold zeros, of tetrahedra with numbers (T, 4) and places
        (T, 4, 3) of corners, and forms (T, m); see `pas.mesh.lattice.Subdivision`."""
        count, m, number = 8 * len(forms), forms.shape[1], np.empty(1, dtype=np.intp)
        new_keys, new_points = np.empty((count, 4), dtype=np.intp), np.empty((count, 4, 3))
        new_forms = np.empty((count, m))
        tables = (len(parts.halves), parts.halves, parts.taken, corners, rounding, keys, points, forms)
        self._call("pas_eighths", len(forms), m, *tables, new_keys, new_points, new_forms, number)
        found = int(number[0])
        return new_keys[:found], new_points[:found], new_forms[:found]

    def risings(self, up: Integers, forms: Floats, points: Floats) -> tuple[Floats, Floats, Floats]:
        """See `pas.mesh.lattice.risings`; `up` (k, 4) says where coefficients stand that gradients are made of."""
        means, least, sizes = np.empty((len(forms), 3)), np.empty(len(forms)), np.empty(len(forms))
        given = (len(forms), forms.shape[1], len(up), up, forms, points)
        self._call("pas_risings", *given, means, least, sizes)
        return means, least, sizes


@cache
def compiled() -> CompiledTriangles:
    """The compiled functions, looked up once."""
    return CompiledTriangles(Functions())
