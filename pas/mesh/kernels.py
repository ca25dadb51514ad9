"""The compiled functions that make triangles good ones, called with arrays.

Those of `pas.mesh.radial`, `graded`, `coarsen`, `contour`, `fine`, `lattice`, `octree`, `places`, `refine` and
`topology`; those for meshes with labels are in `pas.mesh.labelled_calls`.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from pas.bernstein.subdivision import Means
from pas.kernels.library import Functions
from pas.mesh.field import Floats, Integers
from pas.mesh.labelled_calls import LabelledCalls, room_for


class CompiledTriangles(LabelledCalls):
    """The functions of the compiled library; arrays are contiguous, numbers as large as pointers."""

    def upright(self, points: Floats, triangles: Integers, normals: Floats) -> Floats:
        """See `pas.mesh.radial.upright`."""
        result = np.empty(len(triangles))
        self._call("pas_uprights", len(triangles), triangles, points, normals, result)
        return result

    def edges(self, triangles: Integers, size: int) -> tuple[Integers, Integers, bool]:
        """All edges (E, 2), the inner ones first, whose owners (I, 2), and whether it is a manifold."""
        return self._edges(triangles, size, room_for(6 * len(triangles) + size + 2), sorted_=False)

    def _edges(
        self, triangles: Integers, size: int, room: Integers, *, sorted_: bool
    ) -> tuple[Integers, Integers, bool]:
        sizes = np.empty(3, dtype=np.intp)
        self._call("pas_edges", len(triangles), triangles, size, room, sorted_, sizes)
        inner, rim, manifold = sizes.tolist()
        every, owners = np.empty((inner + rim, 2), dtype=np.intp), np.empty((inner, 2), dtype=np.intp)
        self._call("pas_listed", len(triangles), triangles, size, room, inner, every, owners)
        return every, owners, bool(manifold)

    def flipped(
        self, points: Floats, triangles: Integers, normals: Floats, passes: int, gain: float, turned: float
    ) -> Integers:
        """See `pas.mesh.radial.flipped`."""
        return self._flipped(points, triangles, normals, (passes, gain, turned))[0]

    def flipped_edges(
        self, points: Floats, triangles: Integers, normals: Floats, passes: int, gain: float, turned: float
    ) -> tuple[Integers, tuple[Integers, Integers, bool]]:
        """The same, and what `edges` says of it."""
        found, room, sorted_ = self._flipped(points, triangles, normals, (passes, gain, turned))
        return found, self._edges(found, len(points), room, sorted_=sorted_)

    def _flipped(
        self, points: Floats, triangles: Integers, normals: Floats, limits: tuple[int, float, float]
    ) -> tuple[Integers, Integers, bool]:
        result, room = triangles.copy(), room_for(6 * len(triangles) + len(points) + 2)
        last = np.empty(1, dtype=np.intp)
        self._call("pas_flipped", len(result), result, len(points), room, points, normals, *limits, last)
        return result, room, bool(last[0])

    def moved(
        self,
        points: Floats,
        triangles: Integers,
        edges: tuple[Integers, int],
        normals: Floats,
        bends: Floats,
        fixed: NDArray[np.bool_],
        limits: tuple[float, float, float, float, float],
    ) -> Floats:
        """See `pas.mesh.graded`: where points (N, 3) are moved to make triangles better, the rim's edges being last."""
        result, (every, inner) = np.empty((len(points), 3)), edges
        given = (len(triangles), triangles, len(every), every, inner, len(points), points, normals, bends, fixed)
        self._call("pas_moved", *given, *limits, result)
        return result

    def wanted_sizes(
        self,
        points: Floats,
        edges: tuple[Integers, int],
        bends: Floats,
        fixed: NDArray[np.bool_],
        limits: tuple[float, float, float, float, float],
    ) -> Floats:
        """See `pas.mesh.graded`: how long edges should be at points (N,), of all (E, 2) and how many are inside."""
        result, (every, inner) = np.empty(len(points)), edges
        given = (len(every), every, inner, len(points), points, bends, fixed)
        self._call("pas_wanted_sizes", *given, *limits, result)
        return result

    def finer(
        self,
        points: Floats,
        triangles: Integers,
        normals: Floats,
        edges: tuple[Integers, Integers],
        m: int,
        shares: Floats,
        weights: Floats,
        places: tuple[Integers, Integers, Integers],
        cut: Integers,
    ) -> tuple[Floats, Integers]:
        """See `pas.mesh.fine.finer`; `edges` are all (E, 2), and which of them each side is (3 T,)."""
        (ends, side), size, count = edges, len(points), len(triangles)
        result = np.empty((size + len(ends) * (m - 1) + count * len(weights), 3))
        result[:size], smaller = points, np.empty((count * len(cut), 3), dtype=np.intp)
        given = (count, triangles, size, points, normals, len(ends), ends, side, m, shares, len(weights), weights)
        self._call("pas_finer", *given, *places, len(cut), cut, room_for((m + 1) * (m + 2)), result[size:], smaller)
        return result, smaller

    def slender(self, points: Floats, triangles: Integers) -> int:
        """See `pas.mesh.radial.slender`."""
        number = np.empty(1, dtype=np.intp)
        self._call("pas_slender", len(triangles), triangles, points, number)
        return int(number[0])

    def middles(self, points: Floats, triangles: tuple[Integers, Integers], edges: tuple[Integers, Integers]) -> Floats:
        """The centres of triangles and the middles of edges, both (N, 3), each given with which are chosen."""
        result, (every, inside), (ends, along) = np.empty((len(triangles[1]) + len(edges[1]), 3)), triangles, edges
        self._call("pas_middles", len(inside), inside, every, len(along), along, ends, points, result)
        return result

    def settled(self, before: Floats, after: Floats, triangles: Integers, normals: Floats, turned: float) -> Floats:
        """See `pas.mesh.radial.settled`."""
        result = after.copy()
        self._call("pas_settled", len(triangles), triangles, len(before), before, result, normals, turned)
        return result

    def collapsed(
        self,
        points: Floats,
        triangles: Integers,
        normals: Floats,
        sizes: Floats,
        edges: tuple[Integers, int],
        rim: Integers,
        fixed: NDArray[np.bool_],
        limits: tuple[float, float, float, int],
    ) -> Integers:
        """Into which vertex each goes (N,); see `pas.mesh.coarsen.collapsed`."""
        result = np.empty(len(points), dtype=np.intp)
        every, inner = edges
        arguments = (len(triangles), triangles, len(points), points, normals, sizes, len(every), inner, every, rim)
        self._call("pas_collapsed", *arguments, fixed, *limits, result)
        return result

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

    def longest(
        self, triangles: Integers, edges: Integers, ratio: Floats, size: int, limit: float
    ) -> NDArray[np.bool_]:
        """Which edges (E,) are the longest of a triangle and longer than `limit`; see `pas.mesh.refine.longest_of`."""
        marks = np.empty(len(edges), dtype=np.bool_)
        self._call("pas_longest", len(triangles), triangles, size, len(edges), edges, ratio, limit, marks)
        return marks

    def split(self, triangles: Integers, ends: NDArray[np.bool_], keys: Integers) -> tuple[Integers, Integers]:
        """The triangles cut at edges with sorted keys, whose `ends` (N,) are marked, and those that they are parts of.

        See `pas.mesh.refine.split`.
        """
        count, marks, numbers = len(triangles), np.empty((len(triangles), 3), dtype=np.intp), np.empty(4, dtype=np.intp)
        self._call("pas_marked", count, triangles, len(ends), ends, len(keys), keys, marks, numbers)
        total = int(numbers @ np.arange(1, 5))
        parts, parents = np.empty((total, 3), dtype=np.intp), np.empty(total, dtype=np.intp)
        self._call("pas_split", count, triangles, len(ends), marks, numbers, parts, parents)
        return parts, parents

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

    def sines(self, points: Floats, triangles: Integers) -> Floats:
        """See `pas.mesh.places.sines`; of triangles (T, 3) alone, (T,)."""
        result = np.empty(len(triangles))
        self._call("pas_sines", len(triangles), triangles, points, result)
        return result

    def better_places(
        self,
        stars: tuple[Integers, Integers, Integers, Integers],
        points: Floats,
        normals: Floats,
        values: tuple[Floats, Floats, Floats],
        limits: tuple[float, float, float, float],
        ways: tuple[Floats, Floats],
    ) -> tuple[Floats, Floats, Floats]:
        """See `pas.mesh.places.better_places`; `ways` are the shares (k,) and turns (m, 2) that are tried."""
        (vertices, starts, first, second), (before, weights, floors) = stars, values
        count, (shares, turns) = len(vertices), ways
        result = np.empty((count, 3)), np.empty(count), np.empty(count)
        given = (count, vertices, np.append(starts, len(first)), first, second, points, normals, before)
        self._call(
            "pas_better_places",
            *given,
            weights,
            floors,
            np.array(limits),
            len(shares),
            shares,
            len(turns),
            turns,
            *result,
        )
        return result

    def pinched(self, triangles: Integers, size: int, among: NDArray[np.bool_] | None) -> Integers:
        """See `pas.mesh.topology.pinched`; there are so many vertices."""
        kinds, marks = np.empty(size, dtype=np.bool_), np.empty(0, dtype=np.bool_) if among is None else among
        self._call("pas_fans", len(triangles), triangles, size, marks, among is not None, kinds)
        found = kinds.view(np.int8)
        return np.flatnonzero(found == (1 if (found == 1).any() else 2))

    def is_manifold(self, triangles: Integers, size: int) -> bool:
        """See `pas.mesh.topology.is_manifold`; there are so many vertices."""
        number = np.empty(1, dtype=np.intp)
        self._call("pas_is_manifold", len(triangles), triangles, size, number)
        return bool(number[0])

    def pieces(self, triangles: Integers, size: int) -> int:
        """See `pas.mesh.topology.piece_count`; there are so many vertices."""
        number = np.empty(1, dtype=np.intp)
        self._call("pas_pieces", len(triangles), triangles, size, room_for(size), number)
        return int(number[0])

    def numbered(self, keys: Integers, placed: bool) -> tuple[Integers, Integers]:
        """The distinct ones of numbers (N,) that are not negative, sorted, and where each stands (N,), if `placed`."""
        distinct, number = np.empty(len(keys), dtype=np.intp), np.empty(1, dtype=np.intp)
        inverse = np.empty(len(keys) if placed else 0, dtype=np.intp)
        self._call("pas_numbered", len(keys), keys, placed, distinct, inverse, number)
        return distinct[: number[0]].copy(), inverse


@cache
def compiled() -> CompiledTriangles:
    """The compiled functions, looked up once."""
    return CompiledTriangles(Functions())
