"""Improving a closed mesh whose triangles carry labels, with the curves between labels kept.

A label is a face of a solid; an edge between two labels lies on the curve where the two faces
meet, a vertex of three labels in a corner.  Short edges are collapsed (only where the link
condition holds, so the topology stays; Dey et al. 1999), edges inside a face are flipped to
Delaunay's criterion, vertices are averaged inside their face or along their curve and projected
back by Newton's method.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from pas.mesh.field import FaceField, Floats, Integers
from pas.mesh.improve import cross, flip_once

NEWTON_STEPS = 16
KEPT = 0.35
"""Cosine between a triangle's new normal and its face's, below which a collapse is refused."""

NEARBY = 8
"""How many times the reach of one step a corner may move."""

UNTANGLINGS = 8
FUNCTIONS = 3
"""A vertex is placed by at most that many of its labels: more meet in one point only by chance."""


@dataclass(frozen=True, eq=False)
class Topology:
    """Triangles (T, 3), the label of each (T,), and the number of vertices.

    The triangles form a closed manifold.
    """

    triangles: Integers
    labels: Integers
    size: int

    @cached_property
    def pairs(self) -> Integers:
        """The distinct (vertex, label) pairs (P, 2), sorted."""
        keys = np.unique(self._corner_keys)
        return np.stack([keys // self._span, keys % self._span], axis=1)

    @cached_property
    def corner_pairs(self) -> Integers:
        """For each corner of each triangle, the row in `pairs` (T, 3)."""
        keys = self.pairs[:, 0] * self._span + self.pairs[:, 1]
        return np.searchsorted(keys, self._corner_keys).reshape(-1, 3)

    @property
    def _span(self) -> int:
        return int(self.labels.max(initial=0)) + 1

    @cached_property
    def _corner_keys(self) -> Integers:
        return (self.triangles * self._span + self.labels[:, None]).ravel()

    @cached_property
    def label_count(self) -> Integers:
        """The number of labels around each vertex (N,)."""
        return np.bincount(self.pairs[:, 0], minlength=self.size)

    @cached_property
    def valence(self) -> Integers:
        """The number of triangles around each vertex (N,)."""
        return np.bincount(self.triangles.ravel(), minlength=self.size)

    @cached_property
    def edge_table(self) -> tuple[Integers, Integers]:
        """The edges (E, 2), the lower vertex first, sorted, and the two labels of each (E, 2), ascending."""
        start, end = self.triangles.ravel(), self.triangles[:, [1, 2, 0]].ravel()
        key = np.minimum(start, end) * self.size + np.maximum(start, end)
        order = np.argsort(key, kind="stable")
        labels = np.repeat(self.labels, 3)[order]
        keys = key[order][::2]
        edges = np.stack([keys // self.size, keys % self.size], axis=1)
        return edges, np.sort(np.stack([labels[::2], labels[1::2]], axis=1), axis=1)

    @property
    def edges(self) -> Integers:
        """The edges (E, 2), the lower vertex first, sorted."""
        return self.edge_table[0]

    @cached_property
    def seam_mask(self) -> NDArray[np.bool_]:
        """Which edges (E,) are between different labels."""
        labels = self.edge_table[1]
        return np.asarray(labels[:, 0] != labels[:, 1])

    @cached_property
    def seams(self) -> Integers:
        """The edges (S, 2) between different labels."""
        return self.edges[self.seam_mask]

    @cached_property
    def fixed(self) -> NDArray[np.bool_]:
        """The corners: vertices with three labels or more, or where seams end or cross."""
        degree = np.bincount(self.seams.ravel(), minlength=self.size)
        return np.asarray((self.label_count > 2) | ((degree != 2) & (degree != 0)))

    @cached_property
    def groups(self) -> list[tuple[tuple[int, ...], Integers]]:
        """The vertices by their labels, three at most: (labels, vertex numbers)."""
        vertices, labels = self.pairs.T
        place = np.arange(len(vertices)) - np.searchsorted(vertices, vertices)
        rows = np.full((self.size, FUNCTIONS), -1, dtype=np.intp)
        kept = place < FUNCTIONS
        rows[vertices[kept], place[kept]] = labels[kept]
        used = np.flatnonzero(self.label_count > 0)
        return [(tuple(int(v) for v in row if v >= 0), used[at]) for row, at in grouped(rows[used], self._span + 1)]

    @cached_property
    def edge_groups(self) -> list[tuple[tuple[int, ...], Integers]]:
        """The edges by their labels: (labels, rows of `edges`)."""
        found = grouped(self.edge_table[1], self._span + 1)
        return [(tuple(int(v) for v in np.unique(row)), at) for row, at in found]

    @cached_property
    def label_rows(self) -> list[tuple[int, Integers, Integers]]:
        """For each label its rows in `pairs` and its triangles."""
        return [
            (int(label), np.flatnonzero(self.pairs[:, 1] == label), np.flatnonzero(self.labels == label))
            for label in np.unique(self.labels)
        ]


@dataclass(frozen=True, eq=False)
class Labelled:
    """A closed mesh: points (N, 3) and the topology of its triangles."""

    points: Floats
    topology: Topology

    @classmethod
    def of(cls, points: Floats, triangles: Integers, labels: Integers) -> Labelled:
        """The mesh of points (N, 3), triangles (T, 3) and labels (T,)."""
        return cls(points, Topology(triangles, labels, len(points)))

    @property
    def triangles(self) -> Integers:
        """The triangles as vertex numbers (T, 3)."""
        return self.topology.triangles

    @property
    def labels(self) -> Integers:
        """The label of each triangle (T,)."""
        return self.topology.labels

    def moved(self, points: Floats) -> Labelled:
        """The same triangles on other points."""
        return Labelled(points, self.topology)


def grouped(rows: Integers, span: int) -> list[tuple[Integers, Integers]]:
    """The distinct rows of numbers from -1 to span - 2, and where each stands."""
    key = np.zeros(len(rows), dtype=np.intp)
    for column in rows.T:
        key = key * span + column + 1
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.concatenate([[True], np.diff(key[order]) != 0])) if len(key) else np.empty(0, dtype=int)
    return [(rows[part[0]], part) for part in np.split(order, starts[1:])] if len(key) else []


def pair_normals(mesh: Labelled, field: FaceField) -> Floats:
    """Unit outward normals (P, 3) of each vertex's faces; zero at singular points."""
    pairs = mesh.topology.pairs
    result = np.zeros((len(pairs), 3))
    for label, rows, _ in mesh.topology.label_rows:
        gradient = field.jets(mesh.points[pairs[rows, 0]], label)[:, 1:]
        length = np.sqrt((gradient * gradient).sum(axis=1, keepdims=True))
        result[rows] = gradient / np.maximum(length, 1e-300)
    return result


def face_normals(mesh: Labelled, normals: Floats) -> Floats:
    """The sum of the face's normals at the three corners of each triangle (T, 3)."""
    return normals[mesh.topology.corner_pairs].sum(axis=1)


def project(mesh: Labelled, field: FaceField, reach: float) -> Labelled:
    """Vertices moved onto their faces, curves and corners; none further than `reach` a step.

    A corner of faces that have no point in common nearby stays: they come closer than the mesh shows.
    """
    points = mesh.points.copy()
    for labels, vertices in mesh.topology.groups:
        start = points[vertices]
        end = newton(start, field, labels, reach)
        if len(labels) > 2:
            rest = np.sqrt((least_norm(field, field.functions(labels), end) ** 2).sum(axis=1))
            lost = (rest > 1e-9 * reach) | (np.sqrt(((end - start) ** 2).sum(axis=1)) > NEARBY * reach)
            end = np.where(lost[:, None], start, end)
        points[vertices] = end
    return mesh.moved(points)


def newton(points: Floats, field: FaceField, labels: tuple[int, ...], reach: float) -> Floats:
    """Points (N, 3) moved to the common zeros of the functions that place such a vertex."""
    points = points.copy()
    functions = field.functions(labels)
    active = np.arange(len(points))
    for _ in range(NEWTON_STEPS):
        step = -least_norm(field, functions, points[active])
        length = np.sqrt((step * step).sum(axis=1, keepdims=True))
        points[active] += step * np.minimum(1.0, reach / np.maximum(length, 1e-300))
        active = active[length[:, 0] > 1e-14 * (1 + np.abs(points[active]).max(axis=1))]
        if not len(active):
            break
    return points


def least_norm(field: FaceField, functions: tuple[int, ...], points: Floats) -> Floats:
    """The shortest steps (N, 3), to first order, from the functions' common zeros to points."""
    jets = [field.jets(points, f) for f in functions]
    if len(functions) == 1:
        values, gradient = jets[0][:, :1], jets[0][:, 1:]
        return values * gradient / np.maximum((gradient * gradient).sum(axis=1, keepdims=True), 1e-300)
    values = np.stack([j[:, 0] for j in jets], axis=1)
    matrix = np.stack([j[:, 1:] for j in jets], axis=1)
    size = np.maximum(np.sqrt((matrix * matrix).sum(axis=2)), 1e-300)
    return np.einsum("nij,nj->ni", np.linalg.pinv(matrix / size[..., None], rcond=1e-6), values / size)


def smooth(mesh: Labelled, field: FaceField, reach: float) -> Labelled:
    """Each vertex moved to the mean of its triangles' centres, or along its curve, then projected."""
    points, topology = mesh.points, mesh.topology
    size = topology.size
    corners = topology.triangles.ravel()
    centres = np.repeat(points[topology.triangles].mean(axis=1), 3, axis=0)
    total = np.stack([np.bincount(corners, c, minlength=size) for c in centres.T], axis=1)
    move = total / np.maximum(topology.valence, 1)[:, None] - points
    inner = topology.label_count[topology.pairs[:, 0]] == 1
    vertices = topology.pairs[inner, 0]
    normal = pair_normals(mesh, field)[inner]
    move[vertices] -= (move[vertices] * normal).sum(axis=1, keepdims=True) * normal
    both = np.concatenate([topology.seams, topology.seams[:, ::-1]])
    along = np.stack([np.bincount(both[:, 0], points[both[:, 1], i], minlength=size) for i in range(3)], axis=1)
    on_curve = topology.label_count > 1
    move[on_curve] = along[on_curve] / 4 - points[on_curve] / 2
    move[topology.fixed] = 0.0
    return project(mesh.moved(points + move), field, reach)


def flip(mesh: Labelled, field: FaceField, passes: int = 4) -> Labelled:
    """Edges inside faces flipped, in independent sets, until Delaunay's criterion holds (or passes end)."""
    normals = face_normals(mesh, pair_normals(mesh, field))
    triangles, changed = mesh.triangles.copy(), False

    def about(first: Integers, second: Integers) -> Floats:
        return normals[first] + normals[second]

    for _ in range(passes):
        owners = flip_once(mesh.points, triangles, about, mesh.labels)
        if not len(owners):
            break
        normals[owners] = about(owners[:, 0], owners[:, 1])[:, None] / 2
        changed = True
    return Labelled.of(mesh.points, triangles, mesh.labels) if changed else mesh


def collapse(
    mesh: Labelled, field: FaceField, short: Callable[[Labelled, Integers], NDArray[np.bool_]], passes: int = 4
) -> Labelled:
    """Edges for which `short(mesh, edges)` holds are collapsed, the shortest first."""
    for _ in range(passes):
        smaller = _collapse_once(mesh, field, short)
        if smaller is None:
            break
        mesh = smaller
    return mesh


def _collapse_once(
    mesh: Labelled, field: FaceField, short: Callable[[Labelled, Integers], NDArray[np.bool_]]
) -> Labelled | None:
    edges = mesh.topology.edges
    lengths = np.sqrt(((mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]]) ** 2).sum(axis=1))
    chosen = np.flatnonzero(short(mesh, edges))
    chosen = chosen[np.argsort(lengths[chosen], kind="stable")]
    removed, kept = _directed(mesh.topology, chosen)
    valid = removed >= 0
    removed, kept = removed[valid], kept[valid]
    if not len(removed):
        return None
    size = len(mesh.points)
    ones = np.ones(len(edges), dtype=np.int8)
    adjacency = csr_array((ones, (edges[:, 0], edges[:, 1])), shape=(size, size))
    adjacency = (adjacency + adjacency.T).tocsr()
    common = np.asarray(adjacency[removed].multiply(adjacency[kept]).sum(axis=1)).ravel()
    good = (common == 2) & _keeps_orientation(mesh, field, removed, kept)
    removed, kept = removed[good], kept[good]
    if not len(removed):
        return None
    free = _independent(edges, removed, kept, size)
    removed, kept = removed[free], kept[free]
    target = np.arange(size)
    target[removed] = kept
    triangles = target[mesh.triangles]
    distinct = (
        (triangles[:, 0] != triangles[:, 1])
        & (triangles[:, 1] != triangles[:, 2])
        & (triangles[:, 2] != triangles[:, 0])
    )
    used, inverse = np.unique(triangles[distinct], return_inverse=True)
    return Labelled.of(mesh.points[used], inverse.reshape(-1, 3), mesh.labels[distinct])


def _directed(topology: Topology, rows: Integers) -> tuple[Integers, Integers]:
    """Which end of the edges in given rows goes and which stays (-1 where neither may go).

    A vertex inside a face may go anywhere; one on a curve only along it; a corner stays.
    """
    edges, is_seam = topology.edges[rows], topology.seam_mask[rows]
    inner, fixed = topology.label_count == 1, topology.fixed
    removed, kept = np.full(len(edges), -1), np.full(len(edges), -1)
    for a, b in ((edges[:, 0], edges[:, 1]), (edges[:, 1], edges[:, 0])):
        may = (inner[a] | (is_seam & ~fixed[a])) & (removed < 0)
        removed[may], kept[may] = a[may], b[may]
    return removed, kept


def cosines(mesh: Labelled, field: FaceField) -> Floats:
    """The cosine between each triangle's normal and the sum of its face's at the corners (T,)."""
    p = mesh.points[mesh.triangles]
    area = cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal = face_normals(mesh, pair_normals(mesh, field))
    size = np.sqrt((area * area).sum(axis=1) * (normal * normal).sum(axis=1))
    return np.asarray((area * normal).sum(axis=1) / np.maximum(size, 1e-300))


def untangle(mesh: Labelled, field: FaceField, fold: float, reach: float) -> Labelled:
    """The mesh without folded triangles, as far as collapsing their edges and smoothing removes them."""
    for _ in range(UNTANGLINGS):
        folded = cosines(mesh, field) < fold
        if not folded.any():
            break
        keys = np.sort(mesh.triangles[folded][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        marked = np.unique(keys @ np.array([mesh.topology.size, 1]))

        def short(m: Labelled, edges: Integers, marked: Integers = marked) -> NDArray[np.bool_]:
            return np.isin(edges @ np.array([m.topology.size, 1]), marked)

        mesh = collapse(mesh, field, short, 1)
        mesh = smooth(flip(mesh, field), field, reach)
    return mesh


def _keeps_orientation(mesh: Labelled, field: FaceField, removed: Integers, kept: Integers) -> NDArray[np.bool_]:
    """Whether every triangle around `removed` is on its side of the face when that vertex moves to `kept`."""
    corners = mesh.triangles.ravel()
    order = np.argsort(corners, kind="stable")
    starts = np.searchsorted(corners[order], removed)
    counts = np.searchsorted(corners[order], removed, side="right") - starts
    row = np.repeat(np.arange(len(removed)), counts)
    slot = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts) + np.repeat(starts, counts)
    triangle = order[slot] // 3
    old = mesh.triangles[triangle]
    stays = ~(old == kept[row][:, None]).any(axis=1)
    row, triangle, old = row[stays], triangle[stays], old[stays]
    new = np.where(old == removed[row][:, None], kept[row][:, None], old)
    p = mesh.points[new]
    area = cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal = face_normals(mesh, pair_normals(mesh, field))[triangle]
    side = (area * normal).sum(axis=1)
    bad = side <= KEPT * np.sqrt((area * area).sum(axis=1) * (normal * normal).sum(axis=1))
    good = np.ones(len(removed), dtype=bool)
    good[row[bad]] = False
    return good


def _independent(edges: Integers, removed: Integers, kept: Integers, size: int) -> NDArray[np.bool_]:
    """The collapses, in the given order, whose neighbourhoods share no vertex with earlier ones."""
    rank = np.arange(len(removed))
    lowest = np.full(size, len(removed))
    np.minimum.at(lowest, removed, rank)
    np.minimum.at(lowest, kept, rank)
    for _ in range(2):
        spread = lowest.copy()
        np.minimum.at(spread, edges[:, 0], lowest[edges[:, 1]])
        np.minimum.at(spread, edges[:, 1], lowest[edges[:, 0]])
        lowest = spread
    return np.asarray((lowest[removed] == rank) & (lowest[kept] == rank))
