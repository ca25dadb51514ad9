"""How far the triangles of a mesh of one surface, and its edges on the boundary, are from it, as measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pas.mesh.field import Floats, Integers, SheetField
from pas.mesh.radial import Edges, middles

if TYPE_CHECKING:
    from pas.mesh.graph import Graph


def rims_of_edges(field: SheetField, points: Floats, rim: Integers, edges: Integers) -> Integers:
    """The rims (E,) of edges (E, 2) on the boundary, directed as in their triangles: that of an end, or what the field
    says of two fixed ends."""
    fixed, ends = field.fixed, rim[edges]
    result = np.where(fixed[ends[:, 0]], ends[:, 1], ends[:, 0])
    both = np.flatnonzero(fixed[result])
    if len(both):
        result[both] = field.between(points[edges[both]], ends[both])
    return result


def distances(
    field: SheetField, graph: Graph, edges: Edges, changed: np.ndarray | None = None
) -> tuple[Floats, Floats]:
    """Distances |f| / |grad f| of the triangles' centres (T,) and the edges' middles (E,), on the rim in its plane.

    Where it is given which triangles (T,) are `changed`, they are 0 for others.
    """
    triangles = np.arange(len(graph.triangles)) if changed is None else np.flatnonzero(changed)
    inner = np.arange(len(edges.inner)) if changed is None else np.flatnonzero(changed[edges.owners].any(axis=1))
    found = field.distances(middles(graph.points, (graph.triangles, triangles), (edges.inner, inner)))
    inside, along = np.zeros(len(graph.triangles)), np.zeros(len(edges.every))
    inside[triangles], along[inner] = found[: len(triangles)], found[len(triangles) :]
    rims = rims_of_edges(field, graph.points, graph.rim, edges.rim)
    if len(rims):
        ends = graph.points[edges.rim]
        along[len(edges.inner) :] = field.rim_distances((ends[:, 0] + ends[:, 1]) / 2, rims)
    return inside, along
