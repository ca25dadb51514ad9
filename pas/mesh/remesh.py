"""Improving a closed mesh whose triangles carry labels, with the curves between labels kept.

A label is a face of a solid; an edge between two labels lies on the curve where the two faces
meet, a vertex of three labels in a corner.  Edges inside a face are flipped to Delaunay's criterion,
vertices are averaged inside their face or along their curve and projected back by Newton's method.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.limits import checkpoint
from pas.mesh.field import FaceField, Floats, Integers
from pas.mesh.improve import cross, flip_once, to_centres
from pas.mesh.shading import unit_rows
from pas.mesh.topology import distinct

NEWTON_STEPS = 16
NEARBY = 8
"""How many times the reach of one step a corner may move."""

PARALLEL, WELL_APART = 1e-6, 1e-6
"""Ratio of singular values below which gradients count as parallel; squared sine of the angle between two
above which their inverse is written down."""


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
        keys = distinct(self._corner_keys)
        return np.stack([keys // self._span, keys % self._span], axis=1)

    @cached_property
    def corner_pairs(self) -> Integers:
        """For each corner of each triangle, the row in `pairs` (T, 3)."""
        return self.rows(self.triangles, self.labels[:, None])

    def rows(self, vertices: Integers, labels: Integers) -> Integers:
        """Where given (vertex, label) pairs stand in `pairs`."""
        return np.searchsorted(self.pairs @ np.array([self._span, 1]), vertices * self._span + labels)

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
    def corners(self) -> tuple[Integers, Integers]:
        """The corners of all triangles (3 T,), vertex by vertex, and where each vertex's end (N,)."""
        return np.argsort(self.triangles.ravel()), np.cumsum(self.valence)

    @cached_property
    def edge_table(self) -> tuple[Integers, Integers]:
        """The edges (E, 2), the lower vertex first, sorted, and the two labels of each (E, 2), ascending."""
        start, end = self.triangles.ravel(), self.triangles[:, [1, 2, 0]].ravel()
        key = np.minimum(start, end) * self.size + np.maximum(start, end)
        order = np.argsort(key)
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
    def vertex_labels(self) -> Integers:
        """The labels of each vertex (N, k), ascending, then -1."""
        vertices, labels = self.pairs.T
        place = np.arange(len(vertices)) - np.searchsorted(vertices, vertices)
        rows = np.full((self.size, int(self.label_count.max(initial=0))), -1, dtype=np.intp)
        rows[vertices, place] = labels
        return rows

    @cached_property
    def edge_labels(self) -> Integers:
        """The labels of each edge (E, 2), ascending; -1 instead of the second where both are one."""
        labels = self.edge_table[1]
        return np.stack([labels[:, 0], np.where(self.seam_mask, labels[:, 1], -1)], axis=1)


@dataclass(frozen=True, eq=False)
class Labelled:
    """A closed mesh: points (N, 3) and the topology of its triangles.

    `normals` (P, 3) are those of the rows of `topology.pairs`, where they are known from the mesh that this
    one was made of.
    """

    points: Floats
    topology: Topology
    normals: Floats | None = None

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

    @cached_property
    def lengths(self) -> Floats:
        """The lengths (E,) of the edges."""
        ends = self.points[self.topology.edges]
        difference = ends[:, 0] - ends[:, 1]
        return np.asarray(np.sqrt((difference * difference).sum(axis=1)))

    @cached_property
    def sizes(self) -> Floats:
        """The mean length (N,) of the edges at each vertex; on a curve, of those along it."""
        topology = self.topology
        result = np.ones(topology.size)
        for rows in (slice(None), topology.seam_mask):
            edges, lengths = topology.edges[rows], np.tile(self.lengths[rows], 2)
            total = np.bincount(edges.T.ravel(), lengths, minlength=topology.size)
            count = np.bincount(edges.T.ravel(), minlength=topology.size)
            result = np.where(count > 0, total / np.maximum(count, 1), result)
        return result

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


def placing(field: FaceField, labels: Integers) -> Iterator[tuple[Integers, Integers]]:
    """Rows (n,) of labels (N, k), filled up with -1, and the functions (n, m) that place such vertices, for each m."""
    found: dict[int, list[tuple[Integers, Integers]]] = {}
    for row, at in grouped(labels, int(labels.max(initial=0)) + 2):
        placed = field.functions(tuple(int(v) for v in row if v >= 0))
        found.setdefault(len(placed), []).append((at, np.tile(np.array(placed, dtype=np.intp), (len(at), 1))))
    for number, parts in sorted(found.items()):
        if number:
            rows, functions = zip(*parts, strict=True)
            yield np.concatenate(rows), np.concatenate(functions)


def pair_normals(mesh: Labelled, field: FaceField) -> Floats:
    """Unit outward normals (P, 3) of each vertex's faces; zero at singular points."""
    if mesh.normals is not None:
        return mesh.normals
    vertices, labels = mesh.topology.pairs.T
    return unit_rows(field.jets(mesh.points[vertices], labels)[:, 1:])


def face_normals(mesh: Labelled, normals: Floats) -> Floats:
    """The sum of the face's normals at the three corners of each triangle (T, 3)."""
    return normals[mesh.topology.corner_pairs].sum(axis=1)


def project(mesh: Labelled, field: FaceField, reach: Floats) -> Labelled:
    """Vertices moved onto their faces, curves and corners; none further than `reach` (N,) a step.

    A corner of faces that have no point in common nearby stays: they come closer than the mesh shows.
    """
    points = mesh.points.copy()
    corner = mesh.topology.label_count > 2
    for vertices, functions in placing(field, mesh.topology.vertex_labels):
        start = points[vertices]
        most = reach[vertices]
        end = newton(start, field, functions, most)
        rest = np.sqrt((least_norm(field, functions, end) ** 2).sum(axis=1))
        lost = (rest > 1e-9 * most) | (np.sqrt(((end - start) ** 2).sum(axis=1)) > NEARBY * most)
        points[vertices] = np.where((corner[vertices] & lost)[:, None], start, end)
    return mesh.moved(points)


def newton(points: Floats, field: FaceField, functions: Integers, reach: Floats) -> Floats:
    """Points (N, 3) moved to the common zeros of each one's own functions (N, m), given as labels.

    None moves further than `reach` (N,) a step.
    """
    points = points.copy()
    active = np.arange(len(points))
    for _ in range(NEWTON_STEPS):
        checkpoint()
        step = -least_norm(field, functions[active], points[active])
        length = np.sqrt((step * step).sum(axis=1, keepdims=True))
        points[active] += step * np.minimum(1.0, reach[active, None] / np.maximum(length, 1e-300))
        active = active[length[:, 0] > 1e-14 * (1 + np.abs(points[active]).max(axis=1))]
        if not len(active):
            break
    return points


def least_norm(field: FaceField, functions: Integers | Sequence[int], points: Floats) -> Floats:
    """The shortest steps (N, 3), to first order, from the common zeros of functions to points.

    Functions are given as labels, (m,) for all points or (N, m).
    """
    each = np.broadcast_to(np.asarray(functions, dtype=np.intp), (len(points), np.shape(functions)[-1]))
    jets = [field.jets(points, column) for column in each.T]
    if len(jets) == 1:
        values, gradient = jets[0][:, :1], jets[0][:, 1:]
        return values * gradient / np.maximum((gradient * gradient).sum(axis=1, keepdims=True), 1e-300)
    values = np.stack([j[:, 0] for j in jets], axis=1)
    matrix = np.stack([j[:, 1:] for j in jets], axis=1)
    size = np.maximum(np.sqrt((matrix * matrix).sum(axis=2)), 1e-300)
    matrix, values = matrix / size[..., None], values / size
    if len(jets) > 2:
        return np.einsum("nij,nj->ni", np.linalg.pinv(matrix, rcond=PARALLEL), values)
    cosine = (matrix[:, 0] * matrix[:, 1]).sum(axis=1, keepdims=True)
    square = 1 - cosine * cosine
    u, v = values.T[..., None]
    result = ((u - cosine * v) * matrix[:, 0] + (v - cosine * u) * matrix[:, 1]) / np.maximum(square, 1e-300)
    flat = np.flatnonzero(square[:, 0] < WELL_APART)
    result[flat] = np.einsum("nij,nj->ni", np.linalg.pinv(matrix[flat], rcond=PARALLEL), values[flat])
    return result


def smooth(mesh: Labelled, field: FaceField) -> Labelled:
    """Each vertex moved to the mean of its triangles' centres, or along its curve, then projected."""
    points, topology = mesh.points, mesh.topology
    size = topology.size
    move = to_centres(points, topology.triangles)
    inner = topology.label_count[topology.pairs[:, 0]] == 1
    vertices = topology.pairs[inner, 0]
    normal = pair_normals(mesh, field)[inner]
    move[vertices] -= (move[vertices] * normal).sum(axis=1, keepdims=True) * normal
    move[vertices[~normal.any(axis=1)]] = 0.0  # an apex stays
    both = np.concatenate([topology.seams, topology.seams[:, ::-1]])
    along = np.stack([np.bincount(both[:, 0], points[both[:, 1], i], minlength=size) for i in range(3)], axis=1)
    on_curve = topology.label_count > 1
    move[on_curve] = along[on_curve] / 4 - points[on_curve] / 2
    move[topology.fixed] = 0.0
    return project(mesh.moved(points + move), field, mesh.sizes / 4)


def flip(mesh: Labelled, field: FaceField, passes: int = 4, limit: float | None = None) -> Labelled:
    """Edges inside faces flipped, in independent sets, until Delaunay's criterion holds (or passes end).

    On faces with straight lines, edges that are further from the face than `limit` give way to those that are nearer.
    """
    known = pair_normals(mesh, field)
    normals = face_normals(mesh, known)
    triangles, changed = mesh.triangles.copy(), False

    def nearer(owners: Integers, edges: Integers, opposite: Integers) -> Floats:
        result = np.zeros(len(edges))
        at = np.flatnonzero(field.lines(mesh.labels[owners[:, 0]]))
        rows = [mesh.topology.rows(ends[at], mesh.labels[owners[at, :1]]) for ends in (edges, opposite)]
        before, after = (sags(mesh.points, known, e[at], r) for e, r in zip((edges, opposite), rows, strict=True))
        result[at] = np.where(np.maximum(before, after) > (limit or 0.0), before - after, 0.0)
        return result

    def about(first: Integers, second: Integers) -> Floats:
        return normals[first] + normals[second]

    for _ in range(passes):
        checkpoint()
        owners = flip_once(mesh.points, triangles, about, mesh.labels, None if limit is None else nearer)
        if not len(owners):
            break
        normals[owners] = about(owners[:, 0], owners[:, 1])[:, None] / 2
        changed = True
    topology = Topology(triangles, mesh.labels, len(mesh.points)) if changed else mesh.topology
    return Labelled(mesh.points, topology, known)  # flips leave each vertex on its faces


def sags(points: Floats, normals: Floats, edges: Integers, rows: Integers) -> Floats:
    """How far the middles of edges (E, 2) are from a face, to second order, by its normals at the ends.

    `rows` (E, 2) are those of the ends in `normals`.  Straight lines of a face have 0, whatever their length.
    """
    along = points[edges[:, 1]] - points[edges[:, 0]]
    turn = normals[rows[:, 1]] - normals[rows[:, 0]]
    return np.asarray(np.abs((along * turn).sum(axis=1)) / 8)


def edge_sags(mesh: Labelled, field: FaceField, chosen: NDArray[np.bool_]) -> Floats:
    """The same of chosen edges (E,) of a mesh, of both their faces; infinite for the others (E,)."""
    result, normals = np.full(len(chosen), np.inf), pair_normals(mesh, field)
    edges, labels = (table[chosen] for table in mesh.topology.edge_table)
    both = [sags(mesh.points, normals, edges, mesh.topology.rows(edges, column[:, None])) for column in labels.T]
    result[chosen] = np.maximum(*both)
    return result


def cosines(mesh: Labelled, field: FaceField) -> Floats:
    """The cosine between each triangle's normal and the sum of its face's at the corners (T,)."""
    p = mesh.points[mesh.triangles]
    area = cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal = face_normals(mesh, pair_normals(mesh, field))
    size = np.sqrt((area * area).sum(axis=1) * (normal * normal).sum(axis=1))
    return np.asarray((area * normal).sum(axis=1) / np.maximum(size, 1e-300))
