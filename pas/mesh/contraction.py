"""Vertices of a closed mesh drawn into one at each node, each time with a look at the triangles around them alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pas.mesh.field import FaceField, extent_of
from pas.mesh.nodes import SAME, Nodes
from pas.mesh.projection import least_norm
from pas.mesh.rows import Floats, Integers, norms
from pas.mesh.topology import edge_table, numbered, pinched

SHARES = (1.0, 1.4, 0.7)
"""Of a node's reach: what is within one of these is a disc, or finer triangles are needed."""


def contracted(
    field: FaceField, points: Floats, triangles: Integers, labels: Integers, nodes: Nodes
) -> tuple[Floats, Integers, Integers, Integers] | Nodes:
    """The mesh (points, triangles, labels, the nodes' vertices) with all within reach of a node drawn into one vertex.

    Only what is a disc is; where it is none the result is the nodes in question.
    """
    failed, drawn, close = np.zeros(len(nodes.points), dtype=bool), [], SAME * extent_of(field)
    rings, points = OneRings(triangles, labels, len(points)), points.copy()
    for number, (node, reach) in enumerate(zip(nodes.points, nodes.reach, strict=True)):
        distance = np.where(rings.used, norms(points - node), np.inf)
        center = int(distance.argmin())
        for share in SHARES:
            found = rings.contraction(np.flatnonzero(distance < share * reach), center)
            if found is not None and _meet(field, node, found.labels, close):
                break
        else:
            failed[number] = True
            continue
        rings.contract(found)
        points[center] = node
        drawn.append(center)
    if failed.any():
        return Nodes(nodes.points[failed], nodes.reach[failed])
    triangles, labels = rings.triangles[rings.left], rings.labels[rings.left]
    used, numbers = numbered(triangles.ravel())
    return points[used], numbers.reshape(-1, 3), labels, np.flatnonzero(np.isin(used, drawn))


def _meet(field: FaceField, node: Floats, labels: Integers, close: float) -> bool:
    """Whether the faces of given labels pass through a node."""
    labels = np.unique(labels)
    steps = least_norm(field, labels[:, None], np.tile(node, (len(labels), 1)))
    return bool(np.abs(steps).max(initial=0.0) < close)


@dataclass(frozen=True)
class Contraction:
    """What triangles of given `rows` become (K, 3) when vertices `near` are drawn into the `center`, which of them are
    `kept` (K,), and the labels of those about it."""

    near: Integers
    center: int
    rows: Integers
    triangles: Integers
    kept: NDArray[np.bool_]
    labels: Integers


class OneRings:
    """The triangles (T, 3) of a mesh, their labels (T,), which of them are `left` (T,), and those around each vertex.

    Vertices (N,) are `used` until they are drawn into others.
    """

    def __init__(self, triangles: Integers, labels: Integers, size: int) -> None:
        self.triangles, self.labels = triangles.copy(), labels
        self.left, self.used = np.ones(len(triangles), dtype=bool), np.zeros(size, dtype=bool)
        self.used[triangles] = True
        self._order = np.argsort(triangles, axis=None, kind="stable") // 3
        self._ends = np.cumsum(np.bincount(triangles.ravel(), minlength=size))
        self._begins = np.concatenate([[0], self._ends[:-1]])
        self._times = np.bincount(labels)
        self._more: dict[int, Integers] = {}  # of vertices into which others were drawn: all of their triangles

    def around(self, vertices: Integers) -> Integers:
        """The rows of the triangles that are left at given vertices, ascending."""
        begins, ends = self._begins[vertices], self._ends[vertices]
        parts = [self._order[begin:end] for begin, end in zip(begins.tolist(), ends.tolist(), strict=True)]
        parts += [self._more[v] for v in vertices.tolist() if v in self._more]
        rows = np.unique(np.concatenate(parts)) if parts else np.empty(0, dtype=np.intp)
        return rows[self.left[rows]]

    def contraction(self, near: Integers, center: int) -> Contraction | None:
        """What vertices drawn into one would leave; None where these are no disc, or a label would be lost.

        Where none is near the centre stays what it is.
        """
        near = near if len(near) else np.array([center])
        rows, chosen = self.around(near), np.zeros(len(self.used), dtype=bool)
        chosen[near] = True
        before = self.triangles[rows]
        is_near = chosen[before]
        inner = chosen[edge_table(before[is_near.sum(axis=1) > 1])[0]].all(axis=1).sum()
        if len(near) - inner + is_near.all(axis=1).sum() != 1:
            return None
        after = np.where(is_near, center, before)
        kept = (after[:, 0] != after[:, 1]) & (after[:, 1] != after[:, 2]) & (after[:, 2] != after[:, 0])
        lost = np.bincount(self.labels[rows[~kept]], minlength=len(self._times))
        if not (lost < self._times)[lost > 0].all() or self._pinched(rows, after, kept):
            return None
        about = kept & (after == center).any(axis=1)
        return Contraction(near, center, rows, after, kept, self.labels[rows[about]])

    def contract(self, found: Contraction) -> None:
        """Draw vertices into one."""
        gone = found.rows[~found.kept]
        self.triangles[found.rows], self.left[gone] = found.triangles, False
        self._times -= np.bincount(self.labels[gone], minlength=len(self._times))
        self.used[found.near] = False
        self.used[found.triangles[found.kept]] = True
        self._more[found.center] = found.rows[found.kept]

    def _pinched(self, rows: Integers, after: Integers, kept: NDArray[np.bool_]) -> bool:
        """Whether some vertex is no more surrounded by one fan when triangles become others."""
        about, among = np.unique(after), np.zeros(len(self.used), dtype=bool)
        among[about] = True
        others = np.setdiff1d(self.around(about), rows, assume_unique=True)
        return len(pinched(np.concatenate([self.triangles[others], after[kept]]), among)) > 0
