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
    return np.concatenate([points, middles]), *compiled().split(triangles, ends, keys)


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
