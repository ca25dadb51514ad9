"""Volume and area of solids, of second order in the tolerance of their meshes."""

from __future__ import annotations

import numpy as np

from pas.mesh.closed import FaceMesh
from pas.mesh.field import FaceField
from pas.mesh.remesh import newton, placing

_GAUSS = np.array(
    [
        (0.445948490915965, 0.445948490915965, 0.223381589678011),
        (0.445948490915965, 0.108103018168070, 0.223381589678011),
        (0.108103018168070, 0.445948490915965, 0.223381589678011),
        (0.091576213509771, 0.091576213509771, 0.109951743655322),
        (0.091576213509771, 0.816847572980459, 0.109951743655322),
        (0.816847572980459, 0.091576213509771, 0.109951743655322),
    ]
)
"""Points and weights of the rule of degree 4 on the triangle (Dunavant 1985)."""


def curved_measures(found: FaceMesh, field: FaceField) -> tuple[float, float]:
    """Volume and area of the mesh with its edges' midpoints moved onto the faces and curves.

    Each triangle becomes the quadratic patch through its corners and midpoints, so the errors fall
    with the fourth power of the edges: second order in the tolerance.
    """
    mesh = found.mesh
    edges = mesh.topology.edges
    middles = mesh.points[edges].mean(axis=1)
    for rows, functions in placing(field, mesh.topology.edge_labels):
        middles[rows] = newton(middles[rows], field, functions, mesh.lengths[rows])
    size = mesh.topology.size
    keys = edges @ np.array([size, 1])
    center = mesh.points.mean(axis=0)
    corners = [mesh.points[mesh.triangles[:, i]] - center for i in range(3)]
    sides = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = mesh.triangles[:, i], mesh.triangles[:, j]
        sides.append(middles[np.searchsorted(keys, np.minimum(a, b) * size + np.maximum(a, b))] - center)
    volume = area = 0.0
    for u, v, weight in _GAUSS.tolist():
        w = 1 - u - v
        shape = (w * (2 * w - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * u * w, 4 * u * v, 4 * v * w)
        by_u = (1 - 4 * w, 4 * u - 1, 0.0, 4 * (w - u), 4 * v, -4 * v)
        by_v = (1 - 4 * w, 0.0, 4 * v - 1, -4 * u, 4 * u, 4 * (w - v))
        nodes = (*corners, *sides)
        x, du, dv = (sum(c * n for c, n in zip(f, nodes, strict=True)) for f in (shape, by_u, by_v))
        normal = np.cross(du, dv)
        volume += weight / 2 * float(np.einsum("ni,ni->", x, normal)) / 3
        area += weight / 2 * float(np.linalg.norm(normal, axis=1).sum())
    return volume, area
