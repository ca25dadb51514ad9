"""From rectangles of parameters of different sizes to triangles without gaps, seams and collapsed edges.

A rectangle whose sides carry further vertices, of smaller neighbours, becomes a fan about its middle; any other is
cut along its shorter diagonal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pas.algebra.monomials import Floats
from pas.mesh.field import Integers, edge_table

if TYPE_CHECKING:
    from pas.parametric.surface import ParametricSurface

GRID = 1 << 26
"""Steps of the finest grid each way, twice as fine as rectangles get, so that their middles are on it."""

ROW = 1 << 32

SEAM = 1e-9
"""Over the extent: sides that are nearer than this all along are one."""

COLLAPSED = 1e-12
"""Over the extent: edges that are shorter are points."""

ASIDE = 1e-5
"""Where a normal vanishes it is taken this far (over the domain) towards INNER."""

INNER = 0.487
"""A place inside the domain, over its width, where lines of symmetry do not pass."""


def assemble(surface: ParametricSurface, cells: Integers, size: float) -> tuple[Floats, Integers, Floats, Floats]:
    """Points, triangles, normals and parameters for rectangles (C, 4) that fill the domain; `size` is the extent."""
    places, triangles = _triangles(surface, cells, [_closes(surface, axis, size) for axis in (0, 1)])
    parameters = _parameters(surface, places)
    points = surface(parameters)
    same = _merged(points, triangles, places, surface, size)
    kept, first = np.unique(same, return_index=True)
    number = np.searchsorted(kept, same)
    triangles = number[triangles]
    normals = _normals(surface, parameters, number, len(kept))
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    return points[first], triangles, normals, parameters[first]


def _parameters(surface: ParametricSurface, places: Integers) -> Floats:
    low, high = np.array(surface.domain).T
    return np.asarray(np.clip(low + (high - low) * (places / GRID), low, high))


def _closes(surface: ParametricSurface, axis: int, size: float) -> bool:
    """Whether the sides at both ends of a parameter are one curve."""
    share = np.linspace(0.0, 1.0, 65)
    low, high = surface.domain[1 - axis]
    free = low + (high - low) * share
    grid = (surface.domain[0], free) if axis == 0 else (free, surface.domain[1])
    values = surface.on_grid(*grid)
    first, last = (values[0], values[-1]) if axis == 0 else (values[:, 0], values[:, -1])
    return bool((np.abs(first - last) <= SEAM * size).all())


def _triangles(surface: ParametricSurface, cells: Integers, closed: list[bool]) -> tuple[Integers, Integers]:
    """Vertices (N, 2) on the grid, and triangles."""
    corners = np.concatenate([cells[:, [i, j]] for i in (0, 1) for j in (2, 3)])
    for axis in (0, 1):
        if closed[axis]:
            rim = corners[(corners[:, axis] == 0) | (corners[:, axis] == GRID)]
            rim[:, axis] = GRID - rim[:, axis]
            corners = np.concatenate([corners, rim])
    middles = np.stack([cells[:, :2].sum(axis=1) // 2, cells[:, 2:].sum(axis=1) // 2], axis=1)
    columns = np.unique(corners[:, 0] * ROW + corners[:, 1])
    i0, i1, j0, j1 = cells.T
    rows = np.sort((columns % ROW) * ROW + columns // ROW)
    as_column = np.searchsorted(columns, (rows % ROW) * ROW + rows // ROW)
    sides = [
        _side(rows, j0 * ROW + i0, j0 * ROW + i1, as_column, False),
        _side(columns, i1 * ROW + j0, i1 * ROW + j1, np.arange(len(columns)), False),
        _side(rows, j1 * ROW + i0, j1 * ROW + i1, as_column, True),
        _side(columns, i0 * ROW + j0, i0 * ROW + j1, np.arange(len(columns)), True),
    ]
    owner, start, end = (np.concatenate(parts) for parts in zip(*sides, strict=True))
    plain = np.bincount(owner, minlength=len(cells)) == 4
    fans = np.flatnonzero(~plain)
    centre = np.full(len(cells), -1)
    centre[fans] = len(columns) + np.arange(len(fans))
    fan = ~plain[owner]
    places = np.concatenate([np.stack([columns // ROW, columns % ROW], axis=1), middles[fans]])
    triangles = np.stack([centre[owner[fan]], start[fan], end[fan]], axis=1)
    quads = np.stack(
        [np.searchsorted(columns, i * ROW + j)[plain] for i, j in ((i0, j0), (i1, j0), (i1, j1), (i0, j1))], axis=1
    )
    return places, np.concatenate([triangles, _cut(surface, places, quads)]).astype(np.intp)


def _side(
    keys: Integers, first: Integers, last: Integers, names: Integers, backwards: bool
) -> tuple[Integers, Integers, Integers]:
    """The segments of one side of every rectangle: its number, start and end."""
    low, high = np.searchsorted(keys, first), np.searchsorted(keys, last)
    count = high - low
    owner = np.repeat(np.arange(len(first)), count)
    place = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count) + np.repeat(low, count)
    start, end = names[place], names[place + 1]
    return (owner, end, start) if backwards else (owner, start, end)


def _cut(surface: ParametricSurface, places: Integers, quads: Integers) -> Integers:
    if not len(quads):
        return np.empty((0, 3), dtype=np.intp)
    p = surface(_parameters(surface, places[quads]))
    shorter = ((p[:, 0] - p[:, 2]) ** 2).sum(axis=-1) <= ((p[:, 1] - p[:, 3]) ** 2).sum(axis=-1)
    a, b = quads[shorter], quads[~shorter]
    return np.concatenate([a[:, [0, 1, 2]], a[:, [0, 2, 3]], b[:, [0, 1, 3]], b[:, [1, 2, 3]]])


def _merged(points: Floats, triangles: Integers, places: Integers, surface: ParametricSurface, size: float) -> Integers:
    """For each vertex the least number of those that are the same point: across seams and collapsed edges."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges = edge_table(triangles)[0]
    pairs = [edges[np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1) <= COLLAPSED * size]]
    order = np.argsort(places[:, 0] * ROW + places[:, 1])
    keys = (places[:, 0] * ROW + places[:, 1])[order]
    for axis in (0, 1):
        if _closes(surface, axis, size):
            start = np.flatnonzero(places[:, axis] == 0)
            other = places[start].copy()
            other[:, axis] = GRID
            pairs.append(np.stack([start, order[np.searchsorted(keys, other[:, 0] * ROW + other[:, 1])]], axis=1))
    rows, columns = np.concatenate(pairs).T
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(points), len(points)))
    _, labels = connected_components(graph, directed=False)
    least = np.full(labels.max() + 1, len(points))
    np.minimum.at(least, labels, np.arange(len(points)))
    return least[labels]


def _normals(surface: ParametricSurface, parameters: Floats, number: Integers, count: int) -> Floats:
    """Unit normals of the vertices after merging, as means of those before."""
    tangents = surface.tangents(parameters)
    cross = np.cross(tangents[:, 0], tangents[:, 1])
    length = np.linalg.norm(cross, axis=1)
    products = np.linalg.norm(tangents, axis=-1)
    doubtful = ~(length > ASIDE * products.prod(axis=1)) | (products < ASIDE * np.nanmedian(products, axis=0)).any(
        axis=1
    )
    if doubtful.any():
        low, high = np.array(surface.domain).T
        aside = parameters[doubtful] + ASIDE * (low + INNER * (high - low) - parameters[doubtful])
        moved = surface.tangents(aside)
        cross[doubtful] = np.cross(moved[:, 0], moved[:, 1])
    cross /= np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-300)
    total = np.zeros((count, 3))
    np.add.at(total, number, np.nan_to_num(cross))
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
