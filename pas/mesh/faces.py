"""Marching tetrahedra for sets with faces: each triangle knows its face, curves are kept.

Each lattice edge whose ends are on different sides is crossed by the boundary; the function that
changes the side there names the face.  Triangles whose corners lie on different faces are cut
where the faces meet, so that the curves between faces become edges and their corners vertices,
placed exactly by Newton's method (after Kobbelt, Botsch, Schwanecke and Seidel 2001, but with the
functions at hand instead of estimated tangent planes).  The mesh is closed and a manifold because
it is made by labels alone, whatever the geometry.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import permutations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pas.mesh.contour import crossings, oriented, snapped
from pas.mesh.field import FaceField, Floats, Integers, edge_table, is_closed_manifold
from pas.mesh.improve import cross
from pas.mesh.refine import split
from pas.mesh.remesh import Labelled, grouped, least_norm, newton

ROOT_STEPS, ROOT_STILL = 24, 1e-10
"""Of Newton's method along a lattice edge, and the step, over the edge's length, where it ends."""

MOST_CHANGES = 12
"""Functions that may change sign along one lattice edge and still be told apart."""

LOCAL_HALVINGS, GROWTH = 7, 2.0
"""How often triangles near curves are halved, and how many times as many they may become."""

FARTHEST = 4.0
"""How far from the middle of an edge or triangle, over its size, the faces' common point may be."""

NEAR, BISECTIONS = 1e-6, 40
"""How far before and after a crossing, over the edge's length, the side is checked; and how often an
edge is halved where it is not what it should be."""

SHIFT = np.array([0.381966, 0.267949, 0.414214])
"""Where the grid starts, in spacings before the box: irrational, so that the planes and axes that
designers like do not pass through lattice nodes."""

_CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def _kuhn() -> Integers:
    """The six tetrahedra of a cube along its monotone paths, as corner numbers (6, 4)."""
    result = []
    for path in permutations(range(3)):
        corner, tet = np.zeros(3, dtype=int), [0]
        for axis in path:
            corner = corner + np.eye(3, dtype=int)[axis]
            tet.append(int(corner @ [4, 2, 1]))
        result.append(tet)
    return np.array(result)


_TETRAHEDRA = _kuhn()


@dataclass(frozen=True, eq=False)
class Crossings:
    """Where the boundary crosses a lattice: a closed mesh, with a vertex on each crossed edge.

    `points` (E, 3), `triangles` (T, 3); each vertex lies on the lattice edge `edges` (E, 2) at parameter
    `t` (E,), on the face `labels` (E,); `nodes` is the number of lattice nodes.
    """

    points: Floats
    triangles: Integers
    edges: Integers
    t: Floats
    labels: Integers
    nodes: int

    @cached_property
    def shape(self) -> tuple[int, int, tuple[int, ...]]:
        """The number of components, the Euler characteristic, and the labels."""
        rows, columns = self.triangles[:, [0, 1]].ravel(), self.triangles[:, [1, 2]].ravel()
        graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(self.points),) * 2)
        components = connected_components(graph, directed=False)[0]
        return int(components), len(self.points) - len(self.triangles) // 2, tuple(np.unique(self.labels).tolist())

    def mesh(self, field: FaceField, snap: float) -> Labelled | None:
        """The mesh, cut along the curves between faces, with crossings close to nodes merged.

        Where curves come closer than the lattice shows, triangles are made smaller until each
        curve and corner is found.  None where merging pinched the mesh, so that it is no manifold, or
        where so many triangles are too large that a finer lattice does better.
        """
        points, triangles, source = snapped(self.points, self.triangles, self.edges, self.t, snap, self.nodes)
        if not is_closed_manifold(triangles):
            return None
        labels, most = self.labels[source], GROWTH * len(triangles)
        for _ in range(LOCAL_HALVINGS):
            unclear = _unclear(field, points, triangles, labels)
            if not len(unclear):
                break
            if len(triangles) > most:
                return None
            points, triangles, labels = _refined(field, points, triangles, labels, unclear)
        return _cut(points, triangles, labels)


def march_faces(field: FaceField, spacing: float, halvings: int) -> Crossings | None:
    """The crossings of one lattice; None where nothing is crossed."""
    box = field.box
    coarse = spacing * 2**halvings
    origin = box[0] - (1 + SHIFT) * spacing
    counts = np.ceil((box[1] + 1.5 * spacing - origin) / coarse).astype(int)
    cubes = field.cubes(origin, spacing, halvings, (int(counts[0]), int(counts[1]), int(counts[2])))
    if not len(cubes):
        return None
    nodes, corners = _nodes(cubes)
    points = origin + nodes * spacing
    signs = field.signs(points)
    inside = field.inside(signs)
    mixed = inside[corners].any(axis=1) & ~inside[corners].all(axis=1)
    if not mixed.any():
        return None
    tets = corners[mixed][:, _TETRAHEDRA].reshape(-1, 4)
    edges, triangles = crossings(inside, tets)
    triangles = oriented(points, inside, edges, points[edges].mean(axis=1), triangles)
    t, labels = _crossing(field, points, edges, signs, inside)
    on_edge = points[edges[:, 0]] + t[:, None] * (points[edges[:, 1]] - points[edges[:, 0]])
    return Crossings(on_edge, triangles, edges, t, labels, len(points))


def _unclear(field: FaceField, points: Floats, triangles: Integers, labels: Integers) -> Integers:
    """The triangles in which a curve or corner between faces is not found near where it should be."""
    corner_labels = labels[triangles]
    doubtful = np.zeros(len(triangles), dtype=bool)
    mixed = np.flatnonzero((corner_labels != corner_labels[:, :1]).any(axis=1))
    for i in range(3):
        ends = triangles[mixed][:, [i, (i + 1) % 3]]
        differ = labels[ends[:, 0]] != labels[ends[:, 1]]
        doubtful[mixed[differ]] |= _lost(field, points, ends[differ], labels)
    triple = mixed[
        (corner_labels[mixed, 0] != corner_labels[mixed, 2])
        & (corner_labels[mixed, 1] != corner_labels[mixed, 2])
        & (corner_labels[mixed, 0] != corner_labels[mixed, 1])
    ]
    doubtful[triple] |= _lost(field, points, triangles[triple], labels)
    return np.flatnonzero(doubtful)


def _lost(field: FaceField, points: Floats, groups: Integers, labels: Integers) -> NDArray[np.bool_]:
    """For groups (K, m) of vertices on different faces, whether the faces' common point is not close."""
    result = np.zeros(len(groups), dtype=bool)
    p = points[groups]
    size = np.sqrt(((p - p.mean(axis=1, keepdims=True)) ** 2).sum(axis=2)).max(axis=1) * 2
    for row, at in grouped(np.sort(labels[groups], axis=1), int(labels.max()) + 2):
        names = tuple(int(v) for v in row)
        start = p[at].mean(axis=1)
        end = newton(start, field, names, float(size[at].max()))
        rest = np.sqrt((least_norm(field, field.functions(names), end) ** 2).sum(axis=1))
        moved = np.sqrt(((end - start) ** 2).sum(axis=1))
        result[at] = (rest > 1e-9 * size[at]) | (moved > FARTHEST * size[at])
        found = np.flatnonzero(~result[at])
        result[at[found]] = ~_on_boundary(field, end[found], names, 1e-3 * size[at[found]])
    return result


def _on_boundary(field: FaceField, points: Floats, names: tuple[int, ...], reach: Floats) -> NDArray[np.bool_]:
    """Whether points (N, 3) have the inside on one side and the outside on the other.

    Of an edge the mean of its faces' normals points outwards, convex or not; about a corner the
    corners of a small cube are looked at as well.
    """
    outwards = np.zeros_like(points)
    for label in names:
        gradient = field.jets(points, label)[:, 1:]
        outwards += gradient / np.maximum(np.sqrt((gradient * gradient).sum(axis=1, keepdims=True)), 1e-300)
    outwards /= np.maximum(np.sqrt((outwards * outwards).sum(axis=1, keepdims=True)), 1e-300)
    step = reach[:, None] * outwards
    inside, outside = (field.inside(field.signs(points + side * step)) for side in (-1, 1))
    result = np.asarray(inside & ~outside)
    if len(names) > 2:
        corners = (points[:, None] + reach[:, None, None] * (2 * _CORNERS - 1)).reshape(-1, 3)
        around = field.inside(field.signs(corners)).reshape(-1, 8)
        result |= around.any(axis=1) & ~around.all(axis=1)
    return result


def _refined(
    field: FaceField, points: Floats, triangles: Integers, labels: Integers, chosen: Integers
) -> tuple[Floats, Integers, Integers]:
    """The triangles around the chosen ones split in four, new vertices on the boundary with their labels."""
    vertices = np.unique(triangles[chosen])
    near = np.isin(triangles, vertices).any(axis=1)
    edges = np.unique(np.sort(triangles[near][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    p = points[triangles]
    normals = np.zeros_like(points)
    area = cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    for i in range(3):
        np.add.at(normals, triangles[:, i], area)
    middle = points[edges].mean(axis=1)
    length = np.sqrt(((points[edges[:, 0]] - points[edges[:, 1]]) ** 2).sum(axis=1))
    normal = normals[edges].sum(axis=1)
    normal /= np.maximum(np.sqrt((normal * normal).sum(axis=1, keepdims=True)), 1e-300)
    inner, outer = middle.copy(), middle.copy()
    valid = np.zeros(len(edges), dtype=bool)
    for share in (0.05, 0.15, 0.4):
        rows = np.flatnonzero(~valid)
        step = share * length[rows, None] * normal[rows]
        inner[rows], outer[rows] = middle[rows] - step, middle[rows] + step
        ends = [field.inside(field.signs(side[rows])) for side in (inner, outer)]
        valid[rows] = ends[0] & ~ends[1]
    edges, inner, outer = edges[valid], inner[valid], outer[valid]
    both = np.concatenate([inner, outer])
    signs = field.signs(both)
    pairs = np.stack([np.arange(len(edges)), np.arange(len(edges)) + len(edges)], axis=1)
    t, found = _crossing(field, both, pairs, signs, field.inside(signs))
    size = len(points)
    everything, smaller, _ = split(points, triangles, edges)
    order = np.argsort(edges[:, 0] * size + edges[:, 1])
    everything[size:] = (inner + t[:, None] * (outer - inner))[order]
    return everything, smaller, np.concatenate([labels, found[order]])


def _nodes(cubes: Integers) -> tuple[Integers, Integers]:
    """The distinct corners of cubes (K, 3), and each cube's eight as rows of these."""
    all_corners = (cubes[:, None] + _CORNERS).reshape(-1, 3)
    span = all_corners.max(axis=0) + 1
    keys = (all_corners[:, 0] * span[1] + all_corners[:, 1]) * span[2] + all_corners[:, 2]
    unique, inverse = np.unique(keys, return_inverse=True)
    nodes = np.stack([unique // (span[1] * span[2]), unique // span[2] % span[1], unique % span[2]], axis=1)
    return nodes, inverse.reshape(-1, 8)


def _crossing(
    field: FaceField, points: Floats, edges: Integers, signs: NDArray[np.bool_], inside: NDArray[np.bool_]
) -> tuple[Floats, Integers]:
    """Where along each edge the side changes (E,), and the label of the face there (E,)."""
    a, b = edges.T
    start, end = signs[:, a], signs[:, b]
    changes = start != end
    roots = np.full(changes.shape, 2.0)
    for column in np.flatnonzero(changes.any(axis=1)):
        rows = np.flatnonzero(changes[column])
        roots[column, rows] = _roots(field, 2 * int(column), points[a[rows]], points[b[rows]])
    order = np.argsort(roots, axis=0)
    result, label = np.full(len(edges), 0.5), np.full(len(edges), -1)
    open_edges = np.arange(len(edges))
    state, before = start.copy(), inside[a]
    for place in range(min(len(signs), MOST_CHANGES)):
        column = order[place, open_edges]
        state[column, open_edges] ^= changes[column, open_edges]
        turned = field.inside(state[:, open_edges]) != before[open_edges]
        found = open_edges[turned]
        column = column[turned]
        result[found] = roots[column, found]
        inner_sign = np.where(before[found], start[column, found], end[column, found])
        label[found] = 2 * column + ~inner_sign
        open_edges = open_edges[~turned]
        if not len(open_edges):
            break
    _check_crossings(field, points[a], points[b], inside[a], result, label)
    return np.clip(result, 1e-6, 1 - 1e-6), label


def _check_crossings(
    field: FaceField, a: Floats, b: Floats, start: NDArray[np.bool_], t: Floats, label: Integers
) -> None:
    """Correct, in place, the crossings where the side does not change: a function vanished twice."""

    def signs(rows: Integers, at: Floats) -> NDArray[np.bool_]:
        return field.signs(a[rows] + at[:, None] * (b[rows] - a[rows]))

    everything = np.arange(len(t))
    before = field.inside(signs(everything, np.maximum(t - NEAR, 0.0))) == start
    after = field.inside(signs(everything, np.minimum(t + NEAR, 1.0))) != start
    rows = np.flatnonzero(~(before & after) | (label < 0))
    if not len(rows):
        return
    low, high = np.zeros(len(rows)), np.ones(len(rows))
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        same = field.inside(signs(rows, middle)) == start[rows]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    first, last = signs(rows, low), signs(rows, high)
    changes = first != last
    found = np.full(len(rows), -1)
    for column in range(len(changes)):
        alone = last.copy()
        alone[column] = first[column]
        decides = changes[column] & (found < 0) & (field.inside(alone) == start[rows])
        inner_sign = np.where(start[rows], first[column], last[column])
        found = np.where(decides, 2 * column + ~inner_sign, found)
    t[rows], label[rows] = (low + high) / 2, found


def _roots(field: FaceField, label: int, a: Floats, b: Floats) -> Floats:
    """Parameters in [0, 1] where a function that changes sign from a to b vanishes (bracketed Newton)."""
    low, high = np.zeros(len(a)), np.ones(len(a))
    first, last = field.jets(a, label)[:, 0], field.jets(b, label)[:, 0]
    rising = first <= 0
    t = np.clip(first / np.where(first != last, first - last, 1.0), 0.0, 1.0)
    active = np.arange(len(a))
    for _ in range(ROOT_STEPS):
        here, along = t[active], b[active] - a[active]
        jets = field.jets(a[active] + here[:, None] * along, label)
        before = (jets[:, 0] <= 0) == rising[active]
        low[active], high[active] = np.where(before, here, low[active]), np.where(before, high[active], here)
        slope = (jets[:, 1:] * along).sum(axis=1)
        step = jets[:, 0] / np.where(slope != 0, slope, np.inf)
        new = here - step
        outside = (slope == 0) | (new < low[active]) | (new > high[active])
        new = np.where(outside, (low[active] + high[active]) / 2, new)
        t[active] = new
        active = active[np.abs(new - here) > ROOT_STILL]
        if not len(active):
            break
    return t


def _cut(points: Floats, triangles: Integers, labels: Integers) -> Labelled:
    """Triangles with corners on different faces cut in between, with new vertices halfway."""
    corner_labels = labels[triangles]
    edges, _ = edge_table(triangles)
    split = edges[labels[edges[:, 0]] != labels[edges[:, 1]]]
    keys = split[:, 0] * len(points) + split[:, 1]
    middle = points[split].mean(axis=1)

    def between(i: Integers, j: Integers) -> Integers:
        return np.searchsorted(keys, np.minimum(i, j) * len(points) + np.maximum(i, j)) + len(points)

    equal = [corner_labels[:, i] == corner_labels[:, (i + 1) % 3] for i in range(3)]
    whole = equal[0] & equal[1]
    pieces, names = [triangles[whole]], [corner_labels[whole, 0]]
    for i in range(3):  # the corner i alone has another label
        rows = equal[(i + 1) % 3] & ~whole
        a, b, c = (triangles[rows, (i + k) % 3] for k in range(3))
        alone, others = corner_labels[rows, i], corner_labels[rows, (i + 1) % 3]
        p, q = between(a, b), between(a, c)
        pieces += [np.stack(t, axis=1) for t in ((a, p, q), (p, b, c), (p, c, q))]
        names += [alone, others, others]
    rows = ~(equal[0] | equal[1] | equal[2])
    center = np.arange(rows.sum()) + len(points) + len(split)
    for i in range(3):
        a, b, c = (triangles[rows, (i + k) % 3] for k in range(3))
        pieces += [np.stack([a, between(a, b), center], axis=1), np.stack([a, center, between(a, c)], axis=1)]
        names += [corner_labels[rows, i]] * 2
    everything = np.concatenate([points, middle, points[triangles[rows]].mean(axis=1)])
    return Labelled.of(everything, np.concatenate(pieces), np.concatenate(names))
