"""Edges, fans, pieces and holes of triangles given as vertex numbers (T, 3)."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pas.arrays import Bools, Floats, Integers, Numbers
from pas.kernels.library import compiled


def twins_of(triangles: Integers, size: int) -> Integers:
    """The twins (3 T,) of half edges 3 t + k, from corner k of triangle t to the next, of triangles (T, 3) on so many
    vertices: -1 on the boundary, -2 where an edge has more than two triangles, or two that are not turned alike.

    Raises `ValueError` where corners are not numbers of vertices."""
    if triangles.min(initial=0) < 0 or triangles.max(initial=-1) >= size:
        raise ValueError("triangles must be numbers of points")
    result = np.empty(triangles.size, dtype=np.intp)
    compiled().call("pas_twins", len(triangles), triangles, size, result)
    return result


def fans_of(triangles: Integers, size: int) -> tuple[Integers, Integers]:
    """The twins (3 T,) of half edges, and the number of fans (N,) that the triangles at each vertex are."""
    twins, fans = twins_of(triangles, size), np.empty(size, dtype=np.intp)
    compiled().call("pas_fans", len(triangles), triangles, size, twins, fans)
    return twins, fans


MOST = (1 << 62) - 1
"""The largest key of a place."""


def numbered(keys: Integers) -> tuple[Integers, Integers]:
    """The distinct ones of numbers (N,), none of them negative, sorted, and where each of them stands (N,)."""
    return _numbered(keys, True)


def distinct(keys: Integers) -> Integers:
    """The distinct ones of numbers, none of them negative, sorted (several times faster than `np.unique`)."""
    return _numbered(keys.ravel(), False)[0]


def _numbered(keys: Integers, placed: bool) -> tuple[Integers, Integers]:
    found, number = np.empty(len(keys), dtype=np.intp), np.empty(1, dtype=np.intp)
    inverse = np.empty(len(keys) if placed else 0, dtype=np.intp)
    compiled().call("pas_numbered", len(keys), keys, placed, found, inverse, number)
    return found[: number[0]].copy(), inverse


def first_rows(numbers: Integers, size: int) -> Integers:
    """The position (size,) at which each of the numbers below `size` stands first among given ones (N,)."""
    first = np.empty(size, dtype=np.intp)
    first[numbers[::-1]] = np.arange(len(numbers))[::-1]  # the last to be written is the first there is
    return first


def same_places(points: Floats) -> tuple[Integers, Integers]:
    """Where distinct ones of points (N, 3) stand first, and which of these each is (N,), in no particular order."""
    weights = np.array([0x1B873593CC9E2D51, 0x2545F4914F6CDD1D, 0x369DEA0F31A53F85])
    bits = (points + 0.0).view(np.int64)  # zeros have one sign
    keys = (bits ^ bits >> 32) @ weights  # wraps around; the high bits of simple fractions, which say all, are kept
    return first_with(keys & MOST, points)


def first_with(keys: Integers, points: Floats) -> tuple[Integers, Integers]:
    """Where distinct ones of points (N, 3) stand first, and which of these each is (N,).

    Equal points have equal keys (N,), none of them negative, and others mostly have not.
    """
    found, inverse = numbered(keys)
    first = first_rows(inverse, len(found))
    if not np.array_equal(points[first][inverse], points):  # two with one key
        _, first, inverse = np.unique(points, axis=0, return_index=True, return_inverse=True)
    return first, inverse.ravel()


def is_closed_manifold(triangles: Integers) -> bool:
    """Whether every edge has two triangles and every vertex one fan of them."""
    return len(triangles) > 0 and not len(pinched(triangles))


def is_manifold(triangles: Integers) -> bool:
    """Whether every edge has one triangle, or two that are turned alike, and every vertex one fan of them."""
    if not len(triangles):
        return False
    twins, fans = fans_of(triangles, int(triangles.max()) + 1)
    return bool(twins.min() >= -1 and fans.max() == 1)


def pinched(triangles: Integers, among: Bools | None = None) -> Integers:
    """The vertices whose triangles are not one closed fan, at which a mesh is open or no manifold.

    With `among` (N,) only those of these vertices, all of whose triangles are there.
    """
    if not len(triangles):
        return np.empty(0, dtype=np.intp)
    size = int(triangles.max()) + 1 if among is None else len(among)
    twins, fans = fans_of(triangles, size)
    alone, kept = np.flatnonzero(twins < 0), np.ones(size, dtype=bool) if among is None else among
    open_ = np.zeros(size, dtype=bool)
    open_[triangles.ravel()[alone]] = open_[triangles[:, [1, 2, 0]].ravel()[alone]] = True
    found = np.flatnonzero(open_ & kept)
    return found if len(found) else np.flatnonzero((fans > 1) & kept)


def edge_table(triangles: Integers) -> tuple[Integers, Integers]:
    """The distinct edges (E, 2) of triangles (T, 3) and their numbers of triangles."""
    size = int(triangles.max(initial=0)) + 1
    ends = triangles[:, [1, 2, 0]]
    keys, rows = numbered((np.minimum(triangles, ends) * size + np.maximum(triangles, ends)).ravel())
    times = np.bincount(rows, minlength=len(keys))
    return np.stack([keys // size, keys % size], axis=1), times


def euler_characteristic(triangles: Integers) -> int:
    """Vertices - edges + triangles."""
    return len(distinct(triangles)) - len(edge_table(triangles)[0]) + len(triangles)


def connected(ends: Integers | Numbers, size: int) -> Integers:
    """The number of the connected component of each of `size` vertices, joined by edges (E, 2)."""
    graph = coo_array((np.ones(len(ends)), ends.T), shape=(size, size))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)


def piece_count(triangles: Integers) -> int:
    """The number of connected pieces."""
    size = int(triangles.max(initial=-1)) + 1
    ends = triangles[:, [0, 1, 1, 2]].reshape(-1, 2)
    return len(distinct(connected(ends, size)[triangles])) if size else 0


def chains(edges: Integers, corners: Collection[int] = ()) -> list[Integers]:
    """The vertices of each curve that edges (E, 2) make, in order; closed ones have their first vertex at the end, too.

    Curves begin and end in given vertices, and where not just two edges meet.
    """
    ends: dict[int, list[tuple[int, int]]] = {}
    for number, (a, b) in enumerate(edges.tolist()):
        ends.setdefault(a, []).append((number, b))
        ends.setdefault(b, []).append((number, a))
    used, curves, inner = set(), [], {v for v, found in ends.items() if len(found) == 2} - set(corners)
    for vertex in sorted(ends, key=lambda v: v in inner):
        for first, _ in ends[vertex]:
            edge, curve = first, [vertex]
            while edge not in used:
                used.add(edge)
                curve.append(next(other for number, other in ends[curve[-1]] if number == edge))
                if curve[-1] in inner:
                    edge = next(number for number, _ in ends[curve[-1]] if number != edge)
            if len(curve) > 1:
                curves.append(np.array(curve))
    return curves


class Edges:
    """The edges of an oriented mesh of T triangles on `size` vertices: `every` (E, 2), those of the boundary last."""

    def __init__(self, triangles: Integers, size: int) -> None:
        self.triangles = triangles
        self.twins = twins_of(triangles, size)
        halves = np.arange(len(self.twins))
        self._inner, self._rim = np.flatnonzero(self.twins > halves), np.flatnonzero(self.twins < 0)
        rows = np.concatenate([self._inner, self._rim])
        corners, column = triangles.ravel(), rows % 3
        self.every = np.stack([corners[rows], corners[rows - column + (column + 1) % 3]], axis=1)

    @property
    def manifold(self) -> bool:
        """Whether each edge has one or two triangles, turned alike."""
        return bool(self.twins.min(initial=-1) >= -1)

    @cached_property
    def owners(self) -> Integers:
        """The two triangles (I, 2) of each inner edge; the edge is directed as in the first."""
        return np.stack([self._inner, self.twins[self._inner]], axis=1) // 3

    @property
    def inner(self) -> Integers:
        """The edges (I, 2) between two triangles."""
        return self.every[: len(self._inner)]

    @property
    def rim(self) -> Integers:
        """The boundary edges (R, 2), directed as in their one triangle."""
        return self.every[len(self._inner) :]

    @property
    def loops(self) -> list[Integers]:
        """The vertices of each loop of the boundary in order, the mesh to their left."""
        after, found = dict(self.rim.tolist()), []
        while after:
            at, loop = next(iter(after)), []
            while at in after:
                loop.append(at)
                at = after.pop(at)
            found.append(np.array(loop, dtype=np.intp))
        return found
