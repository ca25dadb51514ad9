"""Closed meshes whose triangles carry labels, and what follows from their triangles alone.

A label is a face of a solid; an edge between two labels lies on the curve where the two faces meet, a vertex of
three labels in a corner.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.mesh.rows import norms
from pas.mesh.topology import connected, numbered, twins_of

NONE = np.empty(0, dtype=np.intp)


@dataclass(frozen=True, eq=False)
class Topology:
    """Triangles (T, 3), the label of each (T,), and the number of vertices.

    The triangles form a closed manifold.  `pinned` vertices (K,) stay as corners do, whatever the labels around them
    say: a curve between two faces may turn sharply where these touch, and a cone has an apex.  Of an open mesh, which
    has one label, `rims` (T, 3) are the numbers of the boundary curves that the edges from each corner to the next are
    on, -1 inside.
    """

    triangles: Integers
    labels: Integers
    size: int
    pinned: Integers = field(default_factory=lambda: NONE)
    rims: Integers | None = None

    @cached_property
    def _paired(self) -> tuple[Integers, Integers]:
        """The distinct keys of (vertex, label) pairs (P,), sorted, and which one each corner has (3 T,)."""
        return numbered((self.triangles * self._span + self.labels[:, None]).ravel())

    @cached_property
    def pairs(self) -> Integers:
        """The distinct (vertex, label) pairs (P, 2), sorted."""
        keys = self._paired[0]
        return np.stack([keys // self._span, keys % self._span], axis=1)

    @property
    def corner_pairs(self) -> Integers:
        """For each corner of each triangle, the row in `pairs` (T, 3)."""
        return self._paired[1].reshape(-1, 3)

    def rows(self, vertices: Integers, labels: Integers) -> Integers:
        """Where given (vertex, label) pairs stand in `pairs`."""
        return np.searchsorted(self._paired[0], vertices * self._span + labels)

    @property
    def _span(self) -> int:
        return int(self.labels.max(initial=0)) + 1

    @cached_property
    def label_count(self) -> Integers:
        """The number of labels around each vertex (N,)."""
        return np.bincount(self.pairs[:, 0], minlength=self.size)

    @cached_property
    def twins(self) -> Integers:
        """The twins (3 T,) of half edges: 3 t + k leads from corner k of triangle t to the next; see `twins_of`."""
        return twins_of(self.triangles, self.size)

    @cached_property
    def halves(self) -> Integers:
        """A half edge (E,) of each edge."""
        halves = np.flatnonzero(self.twins < np.arange(len(self.twins)))
        corners, ends = self.triangles.ravel()[halves], self.triangles[:, [1, 2, 0]].ravel()[halves]
        return halves[np.argsort(np.minimum(corners, ends) * self.size + np.maximum(corners, ends), kind="stable")]

    @cached_property
    def edge_table(self) -> tuple[Integers, Integers]:
        """The edges (E, 2), the lower vertex first, sorted, and the two labels of each (E, 2), ascending."""
        halves, twins = self.halves, self.twins[self.halves]
        corners, ends = self.triangles.ravel()[halves], self.triangles[:, [1, 2, 0]].ravel()[halves]
        own, other = self.labels[halves // 3], self.labels[np.where(twins < 0, halves, twins) // 3]
        both = np.stack([corners, ends], axis=1), np.stack([own, other], axis=1)
        return np.sort(both[0], axis=1), np.sort(both[1], axis=1)

    @property
    def edges(self) -> Integers:
        """The edges (E, 2), the lower vertex first, sorted."""
        return self.edge_table[0]

    @cached_property
    def seam_mask(self) -> Bools:
        """Which edges (E,) are between different labels."""
        labels = self.edge_table[1]
        return np.asarray(labels[:, 0] != labels[:, 1])

    @property
    def seams(self) -> Integers:
        """The edges (S, 2) between different labels."""
        return self.edges[self.seam_mask]

    @cached_property
    def pieces(self) -> list[Integers]:
        """The connected pieces of labels: the rows of the triangles of each, by ascending labels."""
        ends = self.corner_pairs[:, [0, 1, 1, 2]].reshape(-1, 2)
        piece = connected(ends, len(self.pairs))[self.corner_pairs[:, 0]]
        order = np.lexsort((piece, self.labels))
        return np.split(order, np.flatnonzero(np.diff(piece[order])) + 1)

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
    def of(
        cls,
        points: Floats,
        triangles: Integers,
        labels: Integers,
        pinned: Integers = NONE,
        rims: Integers | None = None,
    ) -> Labelled:
        """The mesh of points (N, 3), triangles (T, 3) and labels (T,), with `pinned` vertices (K,)."""
        return cls(points, Topology(triangles, labels, len(points), pinned, rims))

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
        start, end = self.topology.edges.T
        return norms(self.points[start] - self.points[end])

    @cached_property
    def sizes(self) -> Floats:
        """The mean length (N,) of the edges at each vertex; on a curve, of those along it."""
        edges, seams, count = self.topology.edges, self.topology.seam_mask, len(self.points)
        on_curve, total, times = self.topology.label_count > 1, np.zeros(count), np.zeros(count)
        for ends in edges.T:
            counted = seams | ~on_curve[ends]
            total += np.bincount(ends[counted], self.lengths[counted], minlength=count)
            times += np.bincount(ends[counted], minlength=count)
        return np.asarray(total / np.maximum(times, 1))
