"""Marching tetrahedra for sets with faces: each triangle knows its face, curves are kept.

Each lattice edge whose ends are on different sides is crossed by the boundary; the function that changes the side there
names the face.  Triangles whose corners lie on different faces are cut where the faces meet, so that the curves between
faces become edges and their corners vertices, placed exactly by Newton's method (after Kobbelt, Botsch, Schwanecke and
Seidel 2001, but with the functions at hand instead of estimated tangent planes).  The mesh is closed and a manifold
because it is made by labels alone, whatever the geometry.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from pas.algebra.bracket import sign_change
from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.contour import crossings, knotted, oriented, snapped
from pas.mesh.field import FaceField, label_of
from pas.mesh.labelled import Labelled
from pas.mesh.nodes import Nodes, contracted, find_nodes
from pas.mesh.octree import NOWHERE
from pas.mesh.projection import least_norm, newton, placing
from pas.mesh.rows import along_lines, cross, norms
from pas.mesh.shading import unit_rows
from pas.mesh.topology import connected, edge_table, pinched

SNAP = 0.4
"""Share of a lattice edge from its node within which crossings merge."""

FLAT, MOST_UNCLEAR = 0.6, 1000
"""Sine of the angle between two faces below which they may touch nearby; triangles about which nodes are looked for:
where there are more, the lattice is too coarse."""

_CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])


class BoundaryCrossings:
    """Where the boundary crosses a lattice: a closed mesh, with a vertex on each crossed edge.

    `edges` (E, 2) are the crossed ones, as rows of `nodes` (N, 3); `triangles` (T, 3) are rows of these.
    """

    def __init__(self, field: FaceField, nodes: Floats, tetrahedra: Integers) -> None:
        self.field, self.nodes = field, nodes
        checkpoint(f"finding the boundary in a lattice of {len(tetrahedra)} tetrahedra")
        self._signs = field.signs(nodes)
        self._inside = field.inside(self._signs)
        checkpoint()
        self.edges, triangles = crossings(self._inside, tetrahedra)
        self.triangles = oriented(nodes, self._inside, self.edges, nodes[self.edges].mean(axis=1), triangles)

    @cached_property
    def shape(self) -> tuple[int, int]:
        """The number of components and the Euler characteristic."""
        return int(self._components.max(initial=-1)) + 1, len(self.edges) - len(self.triangles) // 2

    @cached_property
    def _components(self) -> Integers:
        """The component of each vertex (E,)."""
        return connected(self.triangles[:, [0, 1, 1, 2]].reshape(-1, 2), len(self.edges))

    @cached_property
    def crossed(self) -> tuple[Floats, Integers]:
        """Where along each edge the boundary is (E,), and the label of the face there (E,)."""
        return side_changes(self.field, self.nodes, self.edges, self._signs, self._inside)

    @cached_property
    def faces(self) -> frozenset[int]:
        """The labels of the faces that it crosses."""
        return frozenset(self.crossed[1].tolist())

    def mesh(self) -> Labelled | Floats:
        """The mesh, cut along the curves between faces, with crossings close to nodes merged.

        Where a face, a curve or a corner is not found so that a finer lattice is needed, the result is points
        (K, 3) there.  Raises `RefusalError` where none would do.
        """
        if not len(self.edges):
            return _cut(np.empty((0, 3)), self.triangles, np.empty(0, dtype=np.intp))
        points, triangles, source = self._merged()
        labels = self.crossed[1][source]
        if (labels < 0).any():
            return points[labels < 0]
        unclear, flat = _unclear(self.field, points, triangles, labels)
        nodes = Nodes(NOWHERE, np.empty(0))
        if 0 < len(unclear) + len(flat) <= MOST_UNCLEAR:
            nodes = find_nodes(self.field, points, triangles, labels, unclear, flat)
        centers = points[triangles[unclear]].mean(axis=1)
        mesh, lost = _cut(points, triangles, labels), [centers[~nodes.reaches(centers)]]
        if len(nodes.points):
            drawn = contracted(self.field, mesh.points, mesh.triangles, mesh.labels, nodes)
            if isinstance(drawn, Nodes):
                # where a node drew in what is no disc, what is unclear within its reach may have been far from it
                lost += [drawn.points, centers[drawn.reaches(centers)]]
            else:
                mesh = Labelled.of(*drawn)
        places = np.concatenate(lost)  # all at once, as each finer lattice takes as long
        return places if len(places) else mesh

    def _merged(self) -> tuple[Floats, Integers, Integers]:
        """The mesh with crossings close to nodes merged, but where that would pinch it or close a hole or piece."""
        t = self.crossed[0]
        ends = self.nodes[self.edges]
        crossed = ends[:, 0] + t[:, None] * (ends[:, 1] - ends[:, 0])
        free = knotted(self.triangles, self.edges, t, SNAP, len(self.nodes))
        checkpoint()
        before = self._euler_characteristics(np.arange(len(self.edges)), self.triangles)
        while True:
            checkpoint()
            points, triangles, source = snapped(crossed, self.triangles, self.edges, t, SNAP, free)
            checkpoint()
            bad = np.isin(triangles, pinched(triangles)).any(axis=1)
            free[self.edges[source[triangles[bad]]]] = True
            if not bad.any():
                changed = self._euler_characteristics(source, triangles) != before
                if not changed.any():
                    return points, triangles, source
                free[self.edges[changed[self._components]]] = True

    def _euler_characteristics(self, source: Integers, triangles: Integers) -> Integers:
        """The Euler characteristic of each component, for a mesh (T, 3) whose vertices come from given crossings."""
        number = self._components[source]
        size = self.shape[0]
        return np.bincount(number, minlength=size) - np.bincount(number[triangles[:, 0]], minlength=size) // 2


def side_changes(
    field: FaceField, points: Floats, edges: Integers, signs: Bools, inside: Bools
) -> tuple[Floats, Integers]:
    """Where along each edge the side changes (E,), and the label of the face there (E,)."""
    a, b = edges.T
    start, changes = signs[:, a], signs[:, a] != signs[:, b]
    columns, rows = np.nonzero(changes)
    result, label = np.full(len(edges), 0.5), np.full(len(edges), -1)
    alone = np.bincount(rows, minlength=len(edges))[rows] == 1
    rows, columns = rows[alone], columns[alone]
    result[rows] = _roots(field, label_of(columns), points[a[rows]], points[b[rows]])
    label[rows] = label_of(columns, start[columns, rows] != inside[a[rows]])
    _check_crossings(field, points[a], points[b], inside[a], result, label)
    return np.clip(result, 1e-6, 1 - 1e-6), label


def _check_crossings(field: FaceField, a: Floats, b: Floats, start: Bools, t: Floats, label: Integers) -> None:
    """Correct, in place, crossings where the side does not change, and find those of edges on which several functions
    change their signs: by halving edges."""

    def signs(rows: Integers, at: Floats) -> Bools:
        return field.signs(a[rows] + at[:, None] * (b[rows] - a[rows]))

    every, near = np.arange(len(t)), 1e-6  # over an edge's length, how far beside a crossing the side is looked at
    before = field.inside(signs(every, np.maximum(t - near, 0.0))) == start
    after = field.inside(signs(every, np.minimum(t + near, 1.0))) != start
    rows = np.flatnonzero(~(before & after) | (label < 0))
    if not len(rows):
        return
    low, high = np.zeros(len(rows)), np.ones(len(rows))
    for _ in range(40):  # down to rounding: faces may be nearly tangent
        checkpoint()
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
        found = np.where(decides, label_of(np.array(column), ~inner_sign), found)
    t[rows], label[rows] = (low + high) / 2, found


def _roots(field: FaceField, labels: Integers, a: Floats, b: Floats) -> Floats:
    """Parameters in [0, 1] where functions (N,) that change sign from a to b vanish."""
    first, last = field.jets(a, labels)[:, 0], field.jets(b, labels)[:, 0]
    turned = np.where(first <= 0, 1.0, -1.0)
    start = np.clip(first / np.where(first != last, first - last, 1.0), 0.0, 1.0)
    jets = along_lines(lambda here, rows: turned[rows, None] * field.jets(here, labels[rows]), a, b - a)
    root_still = 1e-10  # the step of Newton's method along a lattice edge, over the edge's length, where it ends
    return sign_change(jets, np.zeros(len(a)), np.ones(len(a)), start, root_still)


def _unclear(field: FaceField, points: Floats, triangles: Integers, labels: Integers) -> tuple[Integers, Integers]:
    """The triangles in which a curve or corner between faces is not found near where it should be, and others in
    which faces meet so flatly that they may touch nearby."""
    corner_labels = labels[triangles]
    doubtful = np.zeros(len(triangles), dtype=bool)
    mixed = np.flatnonzero((corner_labels != corner_labels[:, :1]).any(axis=1))
    for i in range(3):
        ends = triangles[mixed][:, [i, (i + 1) % 3]]
        differ = labels[ends[:, 0]] != labels[ends[:, 1]]
        doubtful[mixed[differ]] |= _lost(field, points, ends[differ], labels)
    triple = mixed[np.diff(np.sort(corner_labels[mixed], axis=1), axis=1).all(axis=1)]
    doubtful[triple] |= _lost(field, points, triangles[triple], labels)
    flat = mixed[~doubtful[mixed] & _flat(field, points, triangles[mixed], corner_labels[mixed])]
    return np.flatnonzero(doubtful), flat


def _flat(field: FaceField, points: Floats, triangles: Integers, labels: Integers) -> Bools:
    """Whether two of the functions that place what is between triangles' faces have gradients almost parallel."""
    result = np.zeros(len(triangles), dtype=bool)
    centers = points[triangles].mean(axis=1)
    for i in range(3):
        pair = np.sort(labels[:, [i, (i + 1) % 3]], axis=1)
        differ = np.flatnonzero(pair[:, 0] != pair[:, 1])
        for at, functions in placing(field, pair[differ]):
            rows = differ[at]
            units = [unit_rows(field.jets(centers[rows], column)[:, 1:]) for column in functions.T[:2]]
            result[rows] |= norms(cross(units[0], units[-1])) < FLAT
    return result


def _lost(field: FaceField, points: Floats, groups: Integers, labels: Integers) -> Bools:
    """For groups (K, m) of vertices on different faces, whether the faces' common point is not close, or no corner."""
    result = np.zeros(len(groups), dtype=bool)
    p = points[groups]
    size = np.sqrt(((p - p.mean(axis=1, keepdims=True)) ** 2).sum(axis=2)).max(axis=1) * 2
    names = np.sort(labels[groups], axis=1)
    end = p.mean(axis=1)
    for at, functions in placing(field, names):
        start = end[at]
        end[at] = newton(start, field, functions, size[at])
        rest = norms(least_norm(field, functions, end[at]))
        moved = norms(end[at] - start)
        farthest = 4.0  # how far from the middle of an edge or triangle, over its size, the faces' common point may be
        result[at] = (rest > 1e-9 * size[at]) | (moved > farthest * size[at])
    found = np.flatnonzero(~result)
    result[found] = ~_on_boundary(field, end[found], names[found], 1e-3 * size[found])
    if names.shape[1] == 3:
        found = np.flatnonzero(~result)
        result[found] = _crossed(field, end[found], names[found], 1e-3 * size[found])
    return result


def _crossed(field: FaceField, points: Floats, names: Integers, reach: Floats) -> Bools:
    """Whether one of three faces (N, 3) that meet in points (N, 3) has two opposite parts there, so no corner is one.

    Of the eight parts of space between three bars that cross, say, four are inside, each beside two or three others.
    """
    inverse = np.linalg.pinv(_normals(field, points, names))
    towards = np.einsum("nij,kj->nki", inverse, 2.0 * _CORNERS - 1)  # on which sides of the faces
    inside = field.inside(field.signs((points[:, None] + reach[:, None, None] * towards).reshape(-1, 3)))
    sides = inside.reshape(-1, 2, 2, 2)
    result = np.zeros(len(points), dtype=bool)
    for axis in (1, 2, 3):
        first, second = np.moveaxis(sides, axis, 0)
        bounds = first != second
        even, odd = bounds[:, 0, 0] & bounds[:, 1, 1], bounds[:, 0, 1] & bounds[:, 1, 0]
        result |= (even | odd) & (bounds.sum(axis=(1, 2)) == 2)
    return result


def _normals(field: FaceField, points: Floats, names: Integers) -> Floats:
    """Unit normals (N, m, 3), outwards, of faces (N, m) at points (N, 3)."""
    return np.stack([unit_rows(field.jets(points, label)[:, 1:]) for label in names.T], axis=1)


def _on_boundary(field: FaceField, points: Floats, names: Integers, reach: Floats) -> Bools:
    """Whether points (N, 3) on faces (N, m) have the inside on one side and the outside on the other.

    That is where all faces are on one side, and on the other: the sum of three normals may be neither.  About a corner
    the corners of a small cube are looked at as well.
    """
    outwards = np.linalg.pinv(_normals(field, points, names)).sum(axis=2)
    outwards /= np.maximum(norms(outwards)[:, None], 1e-300)
    step = reach[:, None] * outwards
    inside, outside = (field.inside(field.signs(points + side * step)) for side in (-1, 1))
    result = np.asarray(inside & ~outside)
    if names.shape[1] > 2:
        corners = (points[:, None] + reach[:, None, None] * (2 * _CORNERS - 1)).reshape(-1, 3)
        around = field.inside(field.signs(corners)).reshape(-1, 8)
        result |= around.any(axis=1) & ~around.all(axis=1)
    return result


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
