"""Volume and area of solids, of second order in the tolerance of their meshes."""

from __future__ import annotations

import numpy as np

from pas.limits import checkpoint
from pas.mesh.closed import FaceMesh
from pas.mesh.field import FaceField
from pas.mesh.grading import LARGEST
from pas.mesh.halfedges import halved
from pas.mesh.labelled import Labelled
from pas.mesh.projection import newton, pair_normals, placing, project

_GAUSS = [
    (u, v, weight)
    for a, weight in ((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322))
    for u, v in ((a, a), (a, 1 - 2 * a), (1 - 2 * a, a))
]
"""Points and weights of the rule of degree 4 on the triangle (Dunavant 1985)."""

THIRD = 0.5
"""Third-order parts of long edges that stay, over those of edges as long as the tolerance makes them on other faces:
the errors of even triangles cancel, these do not."""


def curved_measures(found: FaceMesh, field: FaceField) -> tuple[float, float]:
    """Volume and area of the mesh with its edges' midpoints moved onto the faces and curves.

    Each triangle becomes the quadratic patch through its corners and midpoints, so the errors fall
    with the fourth power of the edges: second order in the tolerance.  Long triangles of cones are cut until their
    edges are nearly as good as parabolas, which leaves errors of order 3/2.
    """
    mesh = _cut(found, field)
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
    for u, v, weight in _GAUSS:
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


def _cut(found: FaceMesh, field: FaceField) -> Labelled:
    """The mesh with edges along curved faces with straight lines halved whose third-order parts are not small.

    A parabola's chord makes the same angles with the curve at both ends, so by the normals there these parts are known.
    They may be `THIRD` times as large as those of edges as long as the tolerance makes them on other faces; edges are
    halved 12 times at most.
    """
    mesh = found.mesh
    most = THIRD * found.deviation**1.5 / float(np.ptp(field.box, axis=0).max()) ** 0.5
    for _ in range(12):
        edges, labels = mesh.topology.edge_table
        normals, off = pair_normals(mesh, field), np.zeros(len(edges))
        along = mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]
        for column in labels.T:
            rows = mesh.topology.rows(edges, column[:, None])
            third = np.abs((along * (normals[rows[:, 0]] + normals[rows[:, 1]])).sum(axis=1)) / 8
            off = np.maximum(off, np.where(field.lines(column) & ~field.planes(column), third, 0.0))
        off[mesh.topology.seam_mask] = 0.0
        if not (off > most).any() or len(mesh.triangles) > LARGEST / 4:
            break
        checkpoint(f"cutting long triangles ({len(mesh.triangles)} triangles)")
        finer = halved(mesh, np.flatnonzero(off > most))
        mesh = project(finer, field, finer.sizes, np.arange(len(mesh.points), len(finer.points)))
    return mesh
