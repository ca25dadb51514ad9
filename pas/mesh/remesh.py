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

from pas.mesh.field import FaceField, Floats, Integers, edge_table
from pas.mesh.improve import FLIP_PASSES, cross, flip_once

NEWTON_STEPS = 16
KEPT = 0.35
"""Cosine between a triangle's new normal and its face's, below which a collapse is refused."""

FUNCTIONS = 3
"""A vertex is placed by at most that many of its labels: more meet in one point only by chance."""


@dataclass(frozen=True)
class Labelled:
    """A closed mesh: points (N, 3), triangles (T, 3), and the label of each triangle (T,)."""

    points: Floats
    triangles: Integers
    labels: Integers

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

    @property
    def _corner_keys(self) -> Integers:
        return (self.triangles * self._span + self.labels[:, None]).ravel()

    @cached_property
    def vertex_labels(self) -> Integers:
        """Up to three labels of each vertex (N, 3), ascending, -1 where there are fewer."""
        vertices, labels = self.pairs.T
        first = np.searchsorted(vertices, vertices)
        place = np.arange(len(vertices)) - first
        result = np.full((len(self.points), FUNCTIONS), -1, dtype=np.intp)
        kept = place < FUNCTIONS
        result[vertices[kept], place[kept]] = labels[kept]
        return result

    @cached_property
    def label_count(self) -> Integers:
        """The number of labels around each vertex (N,)."""
        return np.bincount(self.pairs[:, 0], minlength=len(self.points))

    @cached_property
    def seams(self) -> Integers:
        """The edges (S, 2) between triangles of different labels."""
        return self.seam_table[0]

    @cached_property
    def seam_table(self) -> tuple[Integers, Integers]:
        """The edges (S, 2) between different labels, and their two labels (S, 2), ascending."""
        start = self.triangles.ravel()
        end = self.triangles[:, [1, 2, 0]].ravel()
        key = np.minimum(start, end) * len(self.points) + np.maximum(start, end)
        order = np.argsort(key, kind="stable")
        i, j = order[::2], order[1::2]
        labels = np.repeat(self.labels, 3)
        differ = labels[i] != labels[j]
        ends = np.stack([start[i], end[i]], axis=1)[differ]
        return ends, np.sort(np.stack([labels[i], labels[j]], axis=1)[differ], axis=1)

    @cached_property
    def fixed(self) -> NDArray[np.bool_]:
        """The corners: vertices with three labels or more, or where seams end or cross."""
        degree = np.bincount(self.seams.ravel(), minlength=len(self.points))
        return (self.label_count > 2) | ((degree != 2) & (degree != 0))

    def groups(self) -> list[tuple[tuple[int, ...], Integers]]:
        """The vertices by their labels: (labels, vertex numbers)."""
        used = np.flatnonzero(self.label_count > 0)
        rows, inverse = np.unique(self.vertex_labels[used], axis=0, return_inverse=True)
        order = np.argsort(inverse.ravel(), kind="stable")
        starts = np.searchsorted(inverse.ravel()[order], np.arange(len(rows) + 1))
        return [
            (tuple(int(v) for v in row if v >= 0), used[order[starts[i] : starts[i + 1]]]) for i, row in enumerate(rows)
        ]


def pair_normals(mesh: Labelled, field: FaceField) -> Floats:
    """Unit outward normals (P, 3) of each vertex's faces; zero at singular points."""
    result = np.zeros((len(mesh.pairs), 3))
    labels = mesh.pairs[:, 1]
    for label in np.unique(labels):
        rows = np.flatnonzero(labels == label)
        gradient = field.jets(mesh.points[mesh.pairs[rows, 0]], int(label))[:, 1:]
        length = np.sqrt((gradient * gradient).sum(axis=1, keepdims=True))
        result[rows] = gradient / np.maximum(length, 1e-300)
    return result


def face_normals(mesh: Labelled, normals: Floats) -> Floats:
    """The sum of the face's normals at the three corners of each triangle (T, 3)."""
    return normals[mesh.corner_pairs].sum(axis=1)


def project(mesh: Labelled, field: FaceField, reach: float) -> Labelled:
    """Vertices moved onto their faces, curves and corners; none further than `reach` a step."""
    points = mesh.points.copy()
    for labels, vertices in mesh.groups():
        moved = newton(points[vertices], field, labels, reach)
        points[vertices] = moved
    return Labelled(points, mesh.triangles, mesh.labels)


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


def smooth(mesh: Labelled, field: FaceField, normals: Floats, reach: float) -> Labelled:
    """Each vertex moved to the mean of its triangles' centres, or along its curve, then projected."""
    points, size = mesh.points, len(mesh.points)
    corners = mesh.triangles.ravel()
    weight = np.bincount(corners, minlength=size)
    centres = np.repeat(points[mesh.triangles].mean(axis=1), 3, axis=0)
    total = np.stack([np.bincount(corners, c, minlength=size) for c in centres.T], axis=1)
    move = total / np.maximum(weight, 1)[:, None] - points
    inner = mesh.label_count[mesh.pairs[:, 0]] == 1
    vertices = mesh.pairs[inner, 0]
    normal = normals[inner]
    move[vertices] -= (move[vertices] * normal).sum(axis=1, keepdims=True) * normal
    seams = mesh.seams
    both = np.concatenate([seams, seams[:, ::-1]])
    along = np.stack([np.bincount(both[:, 0], points[both[:, 1], i], minlength=size) for i in range(3)], axis=1)
    on_curve = mesh.label_count > 1
    move[on_curve] = along[on_curve] / 4 - points[on_curve] / 2
    move[mesh.fixed] = 0.0
    return project(Labelled(points + move, mesh.triangles, mesh.labels), field, reach)


def flip(mesh: Labelled, field: FaceField) -> Labelled:
    """Edges inside faces flipped, in independent sets, until Delaunay's criterion holds (or passes end)."""
    for _ in range(FLIP_PASSES):
        triangles = mesh.triangles.copy()
        normals = face_normals(mesh, pair_normals(mesh, field))
        if not flip_once(mesh.points, triangles, lambda i, j, n=normals: n[i] + n[j], mesh.labels):
            break
        mesh = Labelled(mesh.points, triangles, mesh.labels)
    return mesh


def collapse(
    mesh: Labelled, field: FaceField, short: Callable[[Labelled, Integers], NDArray[np.bool_]], passes: int = 6
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
    edges, _ = edge_table(mesh.triangles)
    lengths = np.sqrt(((mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]]) ** 2).sum(axis=1))
    chosen = np.flatnonzero(short(mesh, edges))
    chosen = chosen[np.argsort(lengths[chosen], kind="stable")]
    removed, kept = _directed(mesh, edges[chosen])
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
    return Labelled(mesh.points[used], inverse.reshape(-1, 3), mesh.labels[distinct])


def _directed(mesh: Labelled, edges: Integers) -> tuple[Integers, Integers]:
    """Which end goes and which stays (-1 where neither may go).

    A vertex inside a face may go anywhere; one on a curve only along it; a corner stays.
    """
    size = len(mesh.points)
    seam_keys = np.sort(mesh.seams, axis=1) @ np.array([size, 1])
    is_seam = np.isin(edges.min(axis=1) * size + edges.max(axis=1), seam_keys)
    inner, fixed = mesh.label_count == 1, mesh.fixed
    removed, kept = np.full(len(edges), -1), np.full(len(edges), -1)
    for a, b in ((edges[:, 0], edges[:, 1]), (edges[:, 1], edges[:, 0])):
        may = (inner[a] | (is_seam & ~fixed[a])) & (removed < 0)
        removed[may], kept[may] = a[may], b[may]
    return removed, kept


def _keeps_orientation(mesh: Labelled, field: FaceField, removed: Integers, kept: Integers) -> NDArray[np.bool_]:
    """Whether every triangle around `removed` keeps its side when that vertex moves to `kept`."""
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
