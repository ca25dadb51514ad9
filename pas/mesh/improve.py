"""What meshers improve triangles with: flips towards Delaunay's criterion (opposite angles of sum at most pi), the way
to the centres around, and what is folded.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pas.mesh.field import Floats, Integers
from pas.mesh.rows import cross, dots, norms

FOLD = 0.3
"""Cosine below which a triangle counts as folded: good meshes keep above 0.8, folds are negative."""


def folded(points: Floats, triangles: Integers, normals: Floats) -> np.ndarray:
    """Which triangles are turned away from the surface's normals at their vertices."""
    p = points[triangles]
    normal = cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    along = (normal * normals[triangles].sum(axis=1)).sum(axis=1)
    return np.asarray(along < FOLD * 3 * norms(normal))


def to_centres(points: Floats, triangles: Integers) -> Floats:
    """The way (N, 3) from each vertex to the mean of its triangles' centres."""
    corners = triangles.ravel()
    times = np.bincount(corners, minlength=len(points))
    a, b, c = (points[column] for column in triangles.T)
    centres = np.repeat((a + b + c) / 3, 3, axis=0)
    total = np.stack([np.bincount(corners, c, minlength=len(points)) for c in centres.T], axis=1)
    return np.asarray(total / np.maximum(times, 1)[:, None] - points)


def flip_once(
    points: Floats,
    triangles: Integers,
    normal: Callable[[Integers, Integers], Floats],
    labels: Integers | None = None,
    better: Callable[[Integers, Integers, Integers], Floats] | None = None,
    near: NDArray[np.bool_] | None = None,
) -> Integers:
    """Flip an independent set of edges in place; returns the pairs of triangles that changed (F, 2).

    `normal(i, j)` is the surface's normal (of any length) about the triangles i and j; edges
    between triangles of different `labels` stay.  `better(owners, edges, opposite)`, each (E, 2), says by how much
    flips mend something else, which goes before Delaunay's criterion: that decides where it is 0.  Where the
    triangles are part of a mesh, all about vertices `near` (N,) must be among them, and new edges have an end there.
    """
    pairs, owners, opposite, keys = _interior_edges(triangles)
    if labels is not None:
        inside = labels[owners[:, 0]] == labels[owners[:, 1]]
        pairs, owners, opposite = pairs[inside], owners[inside], opposite[inside]
    (a, b), (c, d) = pairs.T, opposite.T
    (cos_c, sin_c), (cos_d, sin_d) = _cosine_and_sine(points, c, a, b), _cosine_and_sine(points, d, a, b)
    # the angles at c and d add up to more than pi iff the sine of their sum is negative
    size = np.sqrt((cos_c**2 + sin_c**2) * (cos_d**2 + sin_d**2))
    gain = -(sin_c * cos_d + cos_c * sin_d) / np.maximum(size, 1e-300)
    wanted = np.flatnonzero(gain > 1e-6)
    if better is not None:
        mended = better(owners, pairs, opposite)
        gain = np.where(mended != 0, 2 * np.sign(mended), gain)
        wanted = np.flatnonzero(gain > 1e-6)
    if near is not None:  # no other edge between these is overlooked
        wanted = wanted[near[c[wanted]] | near[d[wanted]]]
    about = normal(owners[wanted, 0], owners[wanted, 1])
    wanted = wanted[_flippable(points, about, a[wanted], b[wanted], c[wanted], d[wanted])]
    wanted = wanted[~_connected(keys, int(triangles.max()) + 1, c[wanted], d[wanted])]
    wanted = wanted[np.argsort(-gain[wanted], kind="stable")]
    chosen = _independent(owners[wanted], np.stack([c, d], axis=1)[wanted], len(triangles))
    rows = wanted[chosen]
    # the first owner holds the edge as a -> b with c opposite, the second as b -> a with d
    triangles[owners[rows, 0]] = np.stack([c[rows], a[rows], d[rows]], axis=1)
    triangles[owners[rows, 1]] = np.stack([c[rows], d[rows], b[rows]], axis=1)
    return owners[rows]


def _interior_edges(triangles: Integers) -> tuple[Integers, Integers, Integers, Integers]:
    """Edges (E, 2) directed as in their first triangle, its two triangles, the opposite vertices.

    Also the sorted keys of all edges, `lower * size + upper`.
    """
    size = int(triangles.max()) + 1
    start = np.concatenate([triangles[:, 0], triangles[:, 1], triangles[:, 2]])
    end = np.concatenate([triangles[:, 1], triangles[:, 2], triangles[:, 0]])
    apex = np.concatenate([triangles[:, 2], triangles[:, 0], triangles[:, 1]])
    owner = np.tile(np.arange(len(triangles)), 3)
    key = np.minimum(start, end) * size + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    keys = key[order]
    twin = np.flatnonzero(keys[1:] == keys[:-1])
    i, j = order[twin], order[twin + 1]
    return (
        np.stack([start[i], end[i]], axis=1),
        np.stack([owner[i], owner[j]], axis=1),
        np.stack([apex[i], apex[j]], axis=1),
        keys,
    )


def _cosine_and_sine(points: Floats, at: Integers, a: Integers, b: Integers) -> tuple[Floats, Floats]:
    """Cosine and sine, times the same positive factor, of the angle at a vertex."""
    u, v = points[a] - points[at], points[b] - points[at]
    w = cross(u, v)
    return dots(u, v), norms(w)


def _flippable(points: Floats, normal: Floats, a: Integers, b: Integers, c: Integers, d: Integers) -> np.ndarray:
    """Whether both new triangles (c, a, d) and (c, d, b) keep the surface's orientation."""
    good = np.ones(len(a), dtype=bool)
    for p, q, r in ((c, a, d), (c, d, b)):
        area = cross(points[q] - points[p], points[r] - points[p])
        good &= dots(area, normal) > 0.5 * norms(area) * norms(normal)
    return good


def _connected(keys: Integers, size: int, c: Integers, d: Integers) -> np.ndarray:
    wanted = np.minimum(c, d) * size + np.maximum(c, d)
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.asarray(keys[at] == wanted)


def _independent(owners: Integers, ends: Integers, triangles: int) -> Integers:
    """Rows in the given order such that no triangle, and no new edge's ends, are used twice."""
    taken = np.zeros(triangles, dtype=bool)
    made: set[tuple[int, int]] = set()
    chosen = []
    for row, ((i, j), (c, d)) in enumerate(zip(owners.tolist(), np.sort(ends, axis=1).tolist(), strict=True)):
        if not taken[i] and not taken[j] and (c, d) not in made:
            taken[i] = taken[j] = True
            made.add((c, d))
            chosen.append(row)
    return np.array(chosen, dtype=np.intp)
