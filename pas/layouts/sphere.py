"""The sphere of directions around a layout's centre as a mesh, of radius 1, with the pieces as its faces."""

from __future__ import annotations

import numpy as np

from pas.algebra.inputs import check_tolerance
from pas.algebra.lengths import unit
from pas.algebra.rational import to_floats
from pas.arrays import Floats, Integers
from pas.mesh.mesh import Mesh
from pas.partition.layout import Layout

USUAL, FEWEST, MOST = 1e-3, 2, 7
"""Tolerance, over the sphere's radius, where none is asked for; how many times its triangles are split in four."""


def sphere_mesh(layout: Layout, tolerance: float | None = None) -> Mesh:
    """The closed mesh of a layout; its triangles are as near to the sphere as that, measured, or split `MOST` times."""
    wanted = USUAL if tolerance is None else check_tolerance(tolerance)
    rays = unit(np.array(layout.rays, dtype=float))
    triangles = np.array([t for piece in layout.triangles for t in piece], dtype=np.intp)
    faces = np.array([number for number, piece in enumerate(layout.triangles) for _ in piece], dtype=np.intp)
    for times in range(1, MOST + 1):
        rays, triangles = _split(rays, triangles)
        faces = np.repeat(faces, 4)
        if times >= FEWEST and _deviation(rays, triangles) <= wanted:
            break
    names = tuple(f"piece {number}" for number in range(1, len(layout.pieces) + 1))
    points = rays + np.array(to_floats(layout.center))
    return Mesh(points, triangles, faces, names, rays[triangles], deviation=_deviation(rays, triangles))


def piece_mesh(whole: Mesh, center: Floats, number: int) -> Mesh:
    """One piece of the sphere around a centre (3,), with the arcs as its boundary."""
    used, triangles = np.unique(whole.triangles[whole.faces == number], return_inverse=True)
    points = whole.points[used]
    return Mesh.smooth(points, triangles.reshape(-1, 3), points - center, whole.names[number])


def _split(points: Floats, triangles: Integers) -> tuple[Floats, Integers]:
    """Each spherical triangle in four, at the middles of its sides."""
    sides = triangles[:, [[1, 2], [2, 0], [0, 1]]]
    edges, place = np.unique(np.sort(sides.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    middles = unit(points[edges].sum(axis=1))
    a, b, c = triangles.T
    p, q, r = (place.reshape(-1, 3) + len(points)).T
    quarters = np.stack([[a, r, q], [r, b, p], [q, p, c], [p, q, r]]).transpose(2, 0, 1).reshape(-1, 3)
    return np.concatenate([points, middles]), quarters


def _deviation(points: Floats, triangles: Integers) -> float:
    """How far the triangles are inside the sphere, at the most."""
    p, q, r = points[triangles].transpose(1, 0, 2)
    normals = np.cross(q - p, r - p)
    heights = (normals * p).sum(axis=1) / np.linalg.norm(normals, axis=1)
    return float(1 - heights.min())
