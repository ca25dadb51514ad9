"""How far the edges and triangles of a mesh are from their faces and curves; what is known is not measured again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pas.mesh.field import FaceField, Floats, Integers
from pas.mesh.labelled import BITS, Labelled, triangle_keys
from pas.mesh.refine import farthest_inside, inner_points
from pas.mesh.remesh import least_norm, placing
from pas.mesh.rows import all_of, norms


@dataclass(frozen=True)
class Deviation:
    """Distances of the edges (E,) and of points inside the triangles (T,) of a mesh, to first order."""

    mesh: Labelled
    edges: Floats
    inside: Floats

    @classmethod
    def of(cls, mesh: Labelled, field: FaceField, before: Deviation | None = None) -> Deviation:
        """Those of a mesh; of what `before` has with the same ends and labels they are taken from there."""
        edges, inside = np.full(len(mesh.topology.edges), np.nan), np.full(len(mesh.triangles), np.nan)
        if before is not None:
            same = _same(mesh.points, before.mesh.points)
            edges = _known(_Table.of_edges(mesh), _Table.of_edges(before.mesh), before.edges, same)
            inside = _known(_Table.of_triangles(mesh), _Table.of_triangles(before.mesh), before.inside, same)
        rows = np.flatnonzero(np.isnan(edges))
        edges[rows] = edge_distances(field, mesh, rows)
        rows = np.flatnonzero(np.isnan(inside))
        inside[rows] = inner_distances(field, mesh, rows)
        return cls(mesh, edges, inside)

    @property
    def worst(self) -> float:
        """The largest of all."""
        return float(max(self.edges.max(), self.inside.max()))


def edge_distances(field: FaceField, mesh: Labelled, chosen: Integers | slice = slice(None)) -> Floats:
    """First-order distances of chosen edges' midpoints from their face or curve (E,)."""
    ends = mesh.points[mesh.topology.edges[chosen]]
    middles = (ends[:, 0] + ends[:, 1]) / 2
    result = np.zeros(len(middles))
    for rows, functions in placing(field, mesh.topology.edge_labels[chosen]):
        step = least_norm(field, functions, middles[rows])
        result[rows] = norms(step)
    return result


def inner_distances(field: FaceField, mesh: Labelled, chosen: Integers | slice = slice(None)) -> Floats:
    """The largest first-order distance of some inner points of chosen triangles from their faces (T,)."""
    points = inner_points(mesh.points[mesh.triangles[chosen]])
    labels = mesh.labels[chosen]
    steps = least_norm(field, np.repeat(labels, len(points) // max(len(labels), 1))[:, None], points)
    return farthest_inside(norms(steps))


@dataclass(frozen=True)
class _Table:
    """Edges or triangles: their vertices (K, m), keys that are the same for the same vertices (K,), labels (K, n)."""

    vertices: Integers
    keys: Integers
    labels: Integers

    @classmethod
    def of_edges(cls, mesh: Labelled) -> _Table:
        edges, labels = mesh.topology.edge_table
        return cls(edges, edges[:, 0] << BITS | edges[:, 1], labels)

    @classmethod
    def of_triangles(cls, mesh: Labelled) -> _Table:
        return cls(mesh.triangles, triangle_keys(mesh.triangles), mesh.labels[:, None])


def _same(points: Floats, before: Floats) -> NDArray[np.bool_]:
    """Which points (N,) are where those of the same number were."""
    result = np.zeros(len(points), dtype=bool)
    number = min(len(points), len(before))
    result[:number] = all_of(points[:number] == before[:number])
    return result


def _known(new: _Table, old: _Table, values: Floats, same: NDArray[np.bool_]) -> Floats:
    """The values (K,) of what is there in both tables; NaN where it is not."""
    result = np.full(len(new.keys), np.nan)
    rows = np.flatnonzero(all_of(same[new.vertices]))
    if not len(rows):
        return result
    order = np.argsort(old.keys, kind="stable")
    at = order[np.minimum(np.searchsorted(old.keys, new.keys[rows], sorter=order), len(order) - 1)]
    agree = (old.keys[at] == new.keys[rows]) & all_of(old.labels[at] == new.labels[rows])
    result[rows[agree]] = values[at[agree]]
    return result
