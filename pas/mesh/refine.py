"""Refining triangle meshes: where they are too far from their surface, and splitting edges without hanging vertices."""

from __future__ import annotations

import numpy as np

from pas.errors import MeshError
from pas.mesh.field import Field, Floats, Integers
from pas.mesh.kernels import compiled
from pas.mesh.rows import dots
from pas.mesh.topology import distinct

AIM = 0.8
"""Edges are split down to this share of the tolerance, since smoothing gives some of it back."""

LARGEST = 4_000_000
"""Triangles; more would not fit into the memory of a small machine."""

INNER = 4
"""Points inside a triangle where its deviation is measured: the middle, and those halfway from it to the corners."""


def inner_points(corners: Floats) -> Floats:
    """The points (4 T, 3), triangle by triangle, at which triangles of corners (T, 3, 3) are compared."""
    total = corners[:, 0] + corners[:, 1] + corners[:, 2]
    result = np.empty((len(corners), INNER, 3))
    result[:, 0] = total / 3
    result[:, 1:] = (total[:, None] + 3 * corners) / 6
    return result.reshape(-1, 3)


def farthest_inside(distances: Floats) -> Floats:
    """The largest distance (T,) of each triangle, from those of its inner points (4 T,)."""
    return np.asarray(distances.reshape(-1, INNER).max(axis=1))


def require_room(
    field: Field, triangles: int, far: float, tolerance: float, reached: float, most: int | None = None
) -> None:
    """Raise `MeshError` where splitting the share `far` of the edges would give more than `most` triangles."""
    most = LARGEST if most is None else most
    if triangles * (1 + 3 * far) > most:
        raise too_many(field, triangles, most, tolerance, reached)


def too_many(field: Field, triangles: int, most: int, tolerance: float, reached: float) -> MeshError:
    """That a tolerance needs more than `most` triangles, and what is reached with some."""
    return MeshError(
        f"the tolerance {tolerance * field.scale:.3g} needs more than {most} triangles; "
        f"{reached * field.scale:.2g} is reached with {triangles}"
    )


def not_reached(field: Field, triangles: int, tolerance: float, reached: float, why: str) -> MeshError:
    """That a tolerance was not reached, and why."""
    return MeshError(
        f"the tolerance {tolerance * field.scale:g} was not reached with {triangles} triangles "
        f"({reached * field.scale:.2g} was){why}"
    )


def split(points: Floats, triangles: Integers, edges: Integers) -> tuple[Floats, Integers, Integers]:
    """The mesh with a vertex in the middle of each of `edges` (E, 2), distinct vertex pairs.

    Triangles with one, two or three split edges become two, three or four, with the same
    orientation.  Returns the points, the triangles, and the old triangle that each is part of.
    """
    size = len(points)
    low, high = edges.min(axis=1), edges.max(axis=1)
    order = np.argsort(low * size + high)
    keys = (low * size + high)[order]
    middles = (points[edges[order, 0]] + points[edges[order, 1]]) / 2
    ends = np.zeros(size, dtype=bool)
    ends[edges] = True
    points, kernel = np.concatenate([points, middles]), compiled()
    if kernel is not None:
        return points, *kernel.split(triangles, ends, keys)
    a, b, c = (ends[triangles[:, i]] for i in range(3))
    some = np.flatnonzero((a & b) | (b & c) | (c & a))  # all others stay
    turned = triangles[some]
    marks = np.stack([_lookup(keys, turned[:, i], turned[:, (i + 1) % 3], size) for i in range(3)], axis=1)
    count = (marks >= 0).sum(axis=1)
    whole = np.ones(len(triangles), dtype=bool)
    whole[some[count > 0]] = False
    pieces, parents = [triangles[whole]], [np.flatnonzero(whole)]
    # turned so that the one split edge is the first, or the one unsplit edge the last
    for number in (1, 2, 3):
        rows = count == number
        first = {1: marks[rows] >= 0, 2: marks[rows] < 0, 3: np.ones((rows.sum(), 3), dtype=bool)}[number].argmax(
            axis=1
        )
        turn = (first[:, None] + np.arange(3) + (1 if number == 2 else 0)) % 3
        a, b, c = np.take_along_axis(turned[rows], turn, axis=1).T
        p, q, r = (np.take_along_axis(marks[rows], turn, axis=1) + size).T
        if number == 1:
            corners = [(a, p, c), (p, b, c)]
        elif number == 2:
            corners = [(p, b, q), (a, p, q), (a, q, c)]
        else:
            corners = [(a, p, r), (p, b, q), (r, q, c), (p, q, r)]
        pieces += [np.stack(corner, axis=1) for corner in corners]
        parents += [some[rows]] * len(corners)
    return points, np.concatenate(pieces), np.concatenate(parents)


def _lookup(keys: Integers, a: Integers, b: Integers, size: int) -> Integers:
    """Where the edges (a, b) stand among the sorted keys, -1 for those that are not there."""
    if not len(keys):
        return np.full(len(a), -1)
    wanted = np.minimum(a, b) * size + np.maximum(a, b)
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where(keys[at] == wanted, at, -1)


def far_edges(
    points: Floats, triangles: Integers, edges: Integers, distances: tuple[Floats, Floats], tolerance: float
) -> Integers:
    """The edges to split: those too far, and the longest of each triangle that is.

    `distances` are those of the edges (E,) and of the triangles' insides (T,).
    """
    on_edges, inside = distances
    aim = AIM * tolerance
    return with_longest(points, triangles[inside > aim], edges[on_edges > aim])


def with_longest(points: Floats, triangles: Integers, edges: Integers) -> Integers:
    """The edges (E, 2) and the longest one of each triangle (T, 3), each once, the lower vertex first."""
    p = [points[column] for column in triangles.T]
    sides = [p[(i + 1) % 3] - p[i] for i in range(3)]
    lengths = np.stack([dots(side, side) for side in sides], axis=1)
    longest = lengths.argmax(axis=1)[:, None]
    ends = [np.take_along_axis(triangles, (longest + i) % 3, axis=1) for i in range(2)]
    both = np.concatenate([edges, np.concatenate(ends, axis=1)])
    size = int(both.max(initial=0)) + 1
    keys = distinct(both.min(axis=1) * size + both.max(axis=1))
    return np.stack([keys // size, keys % size], axis=1)


def longest_of(triangles: Integers, edges: Integers, ratio: Floats, size: int, limit: float) -> Integers:
    """Those of all edges (E, 2) that are the longest of a triangle, each over what it should be, and beyond a limit.

    `ratio` (E,) are lengths over what they should be, `size` is the number of vertices.
    """
    kernel = compiled()
    if kernel is not None:
        return edges[kernel.longest(triangles, edges, ratio, size, limit)]
    keys = edges.min(axis=1) * size + edges.max(axis=1)
    order = np.argsort(keys)
    start, end = triangles, triangles[:, [1, 2, 0]]
    place = order[np.searchsorted(keys[order], np.minimum(start, end) * size + np.maximum(start, end))]
    worst = place[np.arange(len(place)), ratio[place].argmax(axis=1)]
    return edges[np.unique(worst[ratio[worst] > limit])]
