"""The sphere of directions around a layout's centre as a mesh, of radius 1, with the pieces as its faces."""

from __future__ import annotations

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.rational import Exact, check_tolerance, to_floats
from pas.arrays import Floats
from pas.mesh.mesh import Mesh
from pas.mesh.rows import inside_sphere, quarters
from pas.mesh.topology import same_places
from pas.partition.layout import Layout

USUAL, FEWEST, MOST = 1e-3, 2, 7
"""Tolerance, over the sphere's radius, where none is asked for; how many times its triangles are split in four."""


def sphere_mesh(layout: Layout, tolerance: Exact | None = None) -> Mesh:
    """The closed mesh of a layout; its triangles are as near to the sphere as that, measured, or split `MOST` times."""
    wanted = USUAL if tolerance is None else check_tolerance(tolerance)
    corners = unit(np.array(layout.rays, dtype=float))[[t for piece in layout.triangles for t in piece]]
    faces = np.array([number for number, piece in enumerate(layout.triangles) for _ in piece], dtype=np.intp)
    for times in range(1, MOST + 1):
        corners, faces = unit(quarters(corners).reshape(-1, 3, 3)), np.repeat(faces, 4)
        if times >= FEWEST and inside_sphere(corners, 1.0) <= wanted:
            break
    names = tuple(f"piece {number}" for number in range(1, len(layout.pieces) + 1))
    rays = corners.reshape(-1, 3)
    first, numbers = same_places(rays)
    points, triangles = rays[first] + np.array(to_floats(layout.center)), numbers.reshape(-1, 3)
    return Mesh(points, triangles, faces, names, corners, deviation=inside_sphere(corners, 1.0))


def piece_mesh(whole: Mesh, center: Floats, number: int) -> Mesh:
    """One piece of the sphere around a centre (3,), with the arcs as its boundary."""
    used, triangles = np.unique(whole.triangles[whole.faces == number], return_inverse=True)
    points = whole.points[used]
    return Mesh.smooth(points, triangles.reshape(-1, 3), points - center, whole.names[number])
