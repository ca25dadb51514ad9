"""From rectangles of the unit square of different sizes to triangles without gaps, seams and collapsed edges.

A rectangle whose sides carry further vertices, of smaller neighbours, becomes a fan about its middle; any other is
cut along its shorter diagonal.
"""

from __future__ import annotations

import numpy as np

from pas.algebra.lengths import lengths, scaled, unit
from pas.arrays import Floats, Integers
from pas.mesh.topology import connected, edge_table
from pas.parametric.maps import ParametricMap

GRID = 1 << 26
"""Steps of the finest grid each way, twice as fine as rectangles get, so that their middles are on it."""

ROW = 1 << 32

SEAM = 1e-9
"""Over the extent: sides that are nearer than this all along are one."""


def assemble(
    surface: ParametricMap, cells: Integers, known: Floats, size: float
) -> tuple[Floats, Integers, Floats, Floats, float]:
    """Triangles for rectangles (C, 4) that fill the unit square, the domain of `surface`; `size` is its extent.

    `known` (C, 5, 3) are the points at the corners of each, the last parameter first, and at its middle.  Points,
    triangles, normals and parameters in the unit square, and by how much welding moved points.
    """
    places, points, triangles = _triangles(cells, known, [closes(surface, axis, size) for axis in (0, 1)])
    same = _merged(points, triangles, places, size)
    kept, first = np.unique(same, return_index=True)
    number = np.searchsorted(kept, same)
    triangles = number[triangles]
    shares = places / GRID
    normals = _normals(surface, shares, number, len(kept))
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    away = float(lengths(points - points[first][number]).max(initial=0.0))
    return points[first], triangles, normals, shares[first], away


def closes(surface: ParametricMap, axis: int, size: float) -> bool:
    """Whether the sides at both ends of a parameter's finite interval are one curve."""
    ends, free = surface.domain[axis], np.linspace(*surface.domain[1 - axis], 65)
    values = surface.on_grid(ends, free) if axis == 0 else surface.on_grid(free, ends)
    first, last = (values[0], values[-1]) if axis == 0 else (values[:, 0], values[:, -1])
    return bool((np.abs(first - last) <= SEAM * size).all())


def _triangles(cells: Integers, known: Floats, closed: list[bool]) -> tuple[Integers, Floats, Integers]:
    """Vertices (N, 2) on the grid, their points (N, 3), and triangles."""
    corners = np.concatenate([cells[:, [i, j]] for i in (0, 1) for j in (2, 3)])
    points = np.concatenate([known[:, number] for number in range(4)])
    for axis in (0, 1):
        if closed[axis]:
            rows = np.flatnonzero((corners[:, axis] == 0) | (corners[:, axis] == GRID))
            rim = corners[rows]
            rim[:, axis] = GRID - rim[:, axis]
            corners, points = np.concatenate([corners, rim]), np.concatenate([points, points[rows]])
    middles = np.stack([cells[:, :2].sum(axis=1) // 2, cells[:, 2:].sum(axis=1) // 2], axis=1)
    columns, once = np.unique(corners[:, 0] * ROW + corners[:, 1], return_index=True)
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
    points = np.concatenate([points[once], known[fans, 4]])
    return places, points, np.concatenate([triangles, _cut(points, quads)]).astype(np.intp)


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


def _cut(points: Floats, quads: Integers) -> Integers:
    """Two triangles for each quadrangle."""
    p = points[quads]
    shorter = ((p[:, 0] - p[:, 2]) ** 2).sum(axis=-1) <= ((p[:, 1] - p[:, 3]) ** 2).sum(axis=-1)
    a, b = quads[shorter], quads[~shorter]
    return np.concatenate([a[:, [0, 1, 2]], a[:, [0, 2, 3]], b[:, [0, 1, 3]], b[:, [1, 2, 3]]])


def _merged(points: Floats, triangles: Integers, places: Integers, size: float) -> Integers:
    """For each vertex the least number of those that are the same point: across seams and collapsed edges."""
    edges = edge_table(triangles)[0]
    pairs = [edges[lengths(points[edges[:, 0]] - points[edges[:, 1]]) <= 1e-12 * size]]  # shorter edges are points
    order = np.argsort(places[:, 0] * ROW + places[:, 1])
    keys = (places[:, 0] * ROW + places[:, 1])[order]
    for axis in (0, 1):
        start = np.flatnonzero(places[:, axis] == 0)
        other = places[start].copy()
        other[:, axis] = GRID
        wanted = other[:, 0] * ROW + other[:, 1]
        found = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        if (keys[found] == wanted).all() and (np.abs(points[start] - points[order[found]]) <= SEAM * size).all():
            pairs.append(np.stack([start, order[found]], axis=1))
    labels = connected(np.concatenate(pairs), len(points))
    return np.asarray(np.unique(labels, return_index=True)[1][labels])


def _normals(surface: ParametricMap, shares: Floats, number: Integers, count: int) -> Floats:
    """Unit normals of the vertices after merging, as means of those before.

    Where one vanishes it is taken a little aside, towards a place where lines of symmetry do not pass.
    """
    aside, inner = 1e-5, 0.487
    tangents = surface.tangents(shares)
    ways, sizes = scaled(tangents), lengths(tangents)
    cross = np.cross(ways[:, 0], ways[:, 1])
    doubtful = ~(lengths(cross) > aside * lengths(ways).prod(axis=1))
    doubtful |= (sizes < aside * np.nanmedian(sizes, axis=0)).any(axis=1)
    if doubtful.any():
        moved = scaled(surface.tangents(shares[doubtful] + aside * (inner - shares[doubtful])))
        cross[doubtful] = np.cross(moved[:, 0], moved[:, 1])
    total = np.zeros((count, 3))
    np.add.at(total, number, np.nan_to_num(unit(cross)))
    return np.asarray(np.nan_to_num(unit(total)))
