"""Meshes that begin as graphs over directions: flips, moves and edges, in arrays.

A triangle (a, b, c) with `det(a, b, c) > 0` is seen from 0 with its outside away.  The first triangles are.  Later
ones need not be where rays graze the surface, as in thin pipes: then it is the surface's normals at the corners that
they keep to, and no edge is made twice.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from pas.mesh.field import Floats, Integers
from pas.mesh.kernels import compiled
from pas.mesh.rows import cross, dots

FLIPS = 8
"""Passes of flips, each over an independent set of edges."""

GAIN = 1e-6
"""Sine of the angle by which two opposite angles must exceed pi for a flip, so that ties stay."""

TURNED = 0.5
"""Cosine between a triangle and the normals at its corners that a flip must keep, or not make worse."""

LARGEST_NUMBER = 1 << 62
"""Below the largest whole number of an array."""

SEEN = 1e-9
"""Determinants over the product of the three distances count as positive from here."""


class Edges:
    """The edges of an oriented mesh of T triangles on `size` vertices: `every` (E, 2), those of the rim last.

    Directed as in their first triangle: `inner` (I, 2) vertices, `owners` (I, 2) triangles; `rim` (R, 2).
    """

    def __init__(self, triangles: Integers, size: int, listed: tuple[Integers, Integers, bool] | None = None) -> None:
        self.triangles, self._size = triangles, size
        kernel = compiled()
        if listed is not None:
            self.every, self.owners, self.manifold = listed
        elif kernel is None:
            self._list()
        else:
            self.every, self.owners, self.manifold = kernel.edges(triangles, size)

    def _list(self) -> None:
        """The same with numpy."""
        ordered, order = self._halves
        start, end = self.triangles.T.ravel(), self.triangles[:, [1, 2, 0]].T.ravel()
        same = ordered[1:] == ordered[:-1]
        i, j = order[:-1][same], order[1:][same]
        self.manifold = not (same[1:] & same[:-1]).any() and bool((start[i] == end[j]).all())
        self.owners = np.stack([i, j], axis=1) % max(len(self.triangles), 1)
        alone = order[~(np.append(same, False) | np.append(False, same))]
        half = np.concatenate([i, alone])
        self.every = np.stack([start[half], end[half]], axis=1)

    @cached_property
    def _halves(self) -> tuple[Integers, Integers]:
        """The keys of half edges in order, and their numbers."""
        start, end = self.triangles.T.ravel(), self.triangles[:, [1, 2, 0]].T.ravel()
        return _sorted(np.minimum(start, end) * self._size + np.maximum(start, end))

    @property
    def inner(self) -> Integers:
        """The edges between two triangles."""
        return self.every[: len(self.owners)]

    @property
    def rim(self) -> Integers:
        """Those of one triangle."""
        return self.every[len(self.owners) :]

    @property
    def apexes(self) -> Integers:
        """The vertices (I, 2) opposite to the inner edges in their owners."""
        ends = self.inner.sum(axis=1)[:, None]
        return np.asarray(self.triangles[self.owners].sum(axis=2) - ends)

    def has(self, a: Integers, b: Integers) -> np.ndarray:
        """Which pairs of vertices (N,) are edges."""
        keys = self._halves[0]
        wanted = np.minimum(a, b) * self._size + np.maximum(a, b)
        place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        return np.asarray(keys[place] == wanted)

    @property
    def neighbours(self) -> tuple[Integers, Integers, Integers]:
        """The vertices of the rim (R,), and those before and after each along it."""
        order = np.argsort(self.rim[:, 0])
        back = np.argsort(self.rim[:, 1])
        return self.rim[order, 0], self.rim[back, 0], self.rim[order, 1]


def _sorted(keys: Integers) -> tuple[Integers, Integers]:
    """Keys in order, equal ones as they stand, and where each stood: by sorting numbers that hold both, if they can."""
    count = len(keys)
    if int(keys.max(initial=0)) >= LARGEST_NUMBER // max(count, 1):
        order = np.argsort(keys, kind="stable")
        return keys[order], order
    both = np.sort(keys * count + np.arange(count))
    ordered = both // count
    return ordered, both - ordered * count


def facets(points: Floats, triangles: Integers) -> Floats:
    """The vectors (T, 3) across triangles, twice as long as their area."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return cross(b - a, c - a)


def seen(points: Floats, triangles: Integers) -> np.ndarray:
    """Which triangles (T,) are seen from 0 with their outside away."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    volume = dots(a, cross(b, c))
    lengths = np.sqrt(dots(a, a) * dots(b, b) * dots(c, c))
    return np.asarray(volume > SEEN * SEEN * lengths)


def upright(points: Floats, triangles: Integers, normals: Floats) -> Floats:
    """The cosines (T,) between triangles and the sum of the normals (N, 3) at their corners."""
    kernel = compiled()
    if kernel is not None:
        return kernel.upright(points, triangles, normals)
    across = facets(points, triangles)
    total = normals[triangles[:, 0]] + normals[triangles[:, 1]] + normals[triangles[:, 2]]
    size = dots(across, across) * dots(total, total)
    return np.asarray(dots(across, total) / np.sqrt(np.maximum(size, 1e-300)))


def flipped(points: Floats, triangles: Integers, normals: Floats, passes: int = FLIPS) -> Integers:
    """The triangles (T, 3) with edges flipped towards Delaunay's criterion, none away from the surface's normals."""
    kernel = compiled()
    if kernel is not None:
        return kernel.flipped(points, triangles, normals, passes, GAIN, TURNED)
    triangles = triangles.copy()
    for _ in range(passes):
        edges = Edges(triangles, len(points))
        (a, b), (c, d) = edges.inner.T, edges.apexes.T
        gain = _beyond(points, a, b, c, d)
        wanted = np.flatnonzero(gain > GAIN)
        wanted = wanted[_allowed(points, normals, *(v[wanted] for v in (a, b, c, d)))]
        wanted = wanted[~edges.has(c[wanted], d[wanted])]
        rows = wanted[_apart(edges.owners[wanted], gain[wanted], len(triangles))]
        if not len(rows):
            break
        triangles[edges.owners[rows, 0]] = np.stack([c[rows], a[rows], d[rows]], axis=1)
        triangles[edges.owners[rows, 1]] = np.stack([c[rows], d[rows], b[rows]], axis=1)
    return triangles


def flipped_edges(points: Floats, triangles: Integers, normals: Floats) -> Edges:
    """The edges of the same, whose `triangles` it are."""
    kernel = compiled()
    if kernel is None:
        return Edges(flipped(points, triangles, normals), len(points))
    found, listed = kernel.flipped_edges(points, triangles, normals, FLIPS, GAIN, TURNED)
    return Edges(found, len(points), listed)


def _beyond(points: Floats, a: Integers, b: Integers, c: Integers, d: Integers) -> Floats:
    """Minus the sine of the sum of the angles at c and d opposite to edges a, b: positive beyond pi."""
    p, q = points[a] - points[c], points[b] - points[c]
    r, s = points[a] - points[d], points[b] - points[d]
    u, v = cross(p, q), cross(r, s)
    sin_c, sin_d = np.sqrt(dots(u, u)), np.sqrt(dots(v, v))
    cos_c, cos_d = dots(p, q), dots(r, s)
    size = np.sqrt((cos_c**2 + sin_c**2) * (cos_d**2 + sin_d**2))
    return np.asarray(-(sin_c * cos_d + cos_c * sin_d) / np.maximum(size, 1e-300))


def _allowed(points: Floats, normals: Floats, a: Integers, b: Integers, c: Integers, d: Integers) -> np.ndarray:
    """Whether the triangles after a flip are turned no further from the surface's normals than before."""
    first, second = np.stack([c, a, d], axis=1), np.stack([c, d, b], axis=1)
    before = np.minimum(
        upright(points, np.stack([a, b, c], axis=1), normals), upright(points, np.stack([b, a, d], axis=1), normals)
    )
    after = np.minimum(upright(points, first, normals), upright(points, second, normals))
    old, new = dots(normals[a], normals[b]), dots(normals[c], normals[d])
    return np.asarray((after >= np.minimum(before, TURNED)) & (new >= np.minimum(old, 0.0)))


def _apart(owners: Integers, gain: Floats, count: int) -> Integers:
    """Rows of which no two share an owner: those with the largest gain of both their owners'."""
    order = np.argsort(-gain, kind="stable")
    rank = np.empty(len(gain), dtype=np.intp)
    rank[order] = np.arange(len(gain))
    first = np.full(count, len(gain))
    np.minimum.at(first, owners.ravel(), np.repeat(rank, 2))
    return np.flatnonzero((first[owners] == rank[:, None]).all(axis=1))


def middles(points: Floats, triangles: tuple[Integers, Integers], edges: tuple[Integers, Integers]) -> Floats:
    """The centres of triangles (T, 3) and the middles of edges (E, 2), each given with which are chosen, (N, 3)."""
    kernel = compiled()
    if kernel is not None:
        return kernel.middles(points, triangles, edges)
    a, b, c = (points[triangles[0][triangles[1], i]] for i in range(3))
    p, q = (points[edges[0][edges[1], i]] for i in range(2))
    return np.concatenate([(a + b + c) / 3, (p + q) / 2])


def centred(points: Floats, triangles: Integers, sizes: Floats) -> Floats:
    """The way (N, 3) from each vertex to the mean of its triangles' centres, by their area over their size squared."""
    kernel = compiled()
    if kernel is not None:
        return kernel.centred(points, triangles, sizes)
    a, b, c = triangles.T
    across = facets(points, triangles)
    weight = np.sqrt(dots(across, across)) / ((sizes[a] + sizes[b] + sizes[c]) / 3) ** 2
    shares = (points[a] + points[b] + points[c]) / 3 * weight[:, None]
    corner = triangles.ravel()
    x, y, z, total = (np.bincount(corner, np.repeat(w, 3), len(points)) for w in (*shares.T, weight))
    return np.asarray(np.stack([x, y, z], axis=1) / np.maximum(total, 1e-300)[:, None] - points)


def settled(before: Floats, after: Floats, triangles: Integers, normals: Floats) -> Floats:
    """The points after a move, some where they were before, so that no triangle is turned from the normals."""
    kernel = compiled()
    if kernel is not None:
        return kernel.settled(before, after, triangles, normals, TURNED)
    after = after.copy()
    least = np.minimum(upright(before, triangles, normals), TURNED)
    while True:
        bad = upright(after, triangles, normals) < least
        corners = np.unique(triangles[bad])
        if not len(corners) or (after[corners] == before[corners]).all():
            return after
        after[corners] = before[corners]


def slender(points: Floats, triangles: Integers) -> int:
    """How many triangles have an angle below 30 degrees: by the cosine opposite to the shortest side, squared."""
    kernel = compiled()
    if kernel is not None:
        return kernel.slender(points, triangles)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    squares = np.sort([dots(b - a, b - a), dots(c - b, c - b), dots(a - c, a - c)], axis=0)
    across = squares[1] + squares[2] - squares[0]
    return int((across * across > 3 * squares[1] * squares[2]).sum())


def smallest_angles(points: Floats, triangles: Integers) -> Floats:
    """The smallest angle (T,) of each triangle in degrees."""
    p = points[triangles]
    most = np.full(len(triangles), -np.inf)
    for i in range(3):
        u, v = p[:, (i + 1) % 3] - p[:, i], p[:, (i + 2) % 3] - p[:, i]
        w = cross(u, v)
        most = np.maximum(most, dots(u, v) / np.sqrt(np.maximum(dots(w, w), 1e-300)))
    return np.asarray(np.degrees(np.arctan2(1.0, most)))
