"""The mesh of blends through a sphere: the tubes, and the sphere between their circles.

Points on a sphere that lie on the circles or outside them have a convex hull whose faces are a triangulation of the
sphere between the circles and one flat disc for each, which is left out.  The circles' points are the tubes' own, so
that all is welded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from pas.algebra.monomials import Floats
from pas.mesh.field import Integers
from pas.mesh.mesh import Mesh

SPHERE = "sphere"
"""The name of the face on the sphere."""

APART = 0.6
"""Distance of other points from the circles, over the mean spacing of points."""


def sphere_mesh(
    center: tuple[float, float, float], radius: float, tubes: Sequence[Mesh], size: tuple[int, int]
) -> Mesh:
    """Tubes made on grids of `size`, whose last points of each row are a circle on the sphere, and the sphere."""
    n, m = size
    origin = np.array(center)
    turned = [_outward(tube, m, origin) for tube in tubes]
    count = n * m
    rims = [np.arange(n) * m + m - 1 + number * count for number in range(len(tubes))]
    points = np.concatenate([tube.points for tube in turned])
    normals = np.concatenate([tube.point_normals for tube in turned])
    circles = [(points[rim] - origin) / radius for rim in rims]
    free = _between(circles, n)
    faces = _hull(np.concatenate([*circles, free]), len(circles), n)
    numbers = np.concatenate([*rims, len(points) + np.arange(len(free))])
    triangles = [tube.triangles + number * count for number, tube in enumerate(turned)]
    mesh = Mesh.smooth(
        np.concatenate([points, origin + radius * free]),
        np.concatenate([*triangles, numbers[faces]]),
        np.concatenate([normals, free]),
    )
    owner = np.repeat(np.arange(len(tubes) + 1), [*map(len, triangles), len(faces)])
    return replace(mesh, faces=owner, names=(*(f"blend {i + 1}" for i in range(len(tubes))), SPHERE))


def sphere_deviation(mesh: Mesh, center: tuple[float, float, float], radius: float) -> float:
    """How far the triangles on the sphere are inside it at most: where their planes come nearest to the centre."""
    a, b, c = (mesh.points[mesh.triangles[mesh.faces == mesh.names.index(SPHERE), i]] - center for i in range(3))
    normal = np.cross(b - a, c - a)
    heights = np.abs((normal * a).sum(axis=1)) / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    return float((radius - heights).max(initial=0.0))


def grid_deviation(sheet: Callable[[tuple[int, int]], Floats], size: tuple[int, int], closed: bool) -> float:
    """How far a blend is from its mesh on a grid, at equal parameters half way between the grid's points."""
    n, m = size
    points = sheet((2 * n if closed else 2 * n - 1, 2 * m - 1))
    if closed:
        points = np.concatenate([points, points[:1]])
    corners = points[::2, ::2]
    middles = (
        (points[1::2, ::2], corners[:-1], corners[1:]),
        (points[::2, 1::2], corners[:, :-1], corners[:, 1:]),
        (points[1::2, 1::2], corners[:-1, :-1], corners[1:, 1:]),  # of the diagonals that `connectivity` draws
    )
    return max(float(np.linalg.norm(p - (a + b) / 2, axis=-1).max()) for p, a, b in middles)


def _outward(tube: Mesh, m: int, origin: Floats) -> Mesh:
    rim = slice(m - 1, None, m)
    if ((tube.points[rim] - origin) * tube.point_normals[rim]).sum() >= 0:
        return tube
    return tube.flipped


def _between(circles: Sequence[Floats], n: int) -> Floats:
    """Points spread evenly over the unit sphere (a spiral of golden angles), those in the circles left out."""
    spacing = min(float(np.linalg.norm(circle[1] - circle[0])) for circle in circles)
    number = int(np.clip(4 * np.pi / spacing**2, 4 * n, 60 * n))
    k = np.arange(number) + 0.5
    z, angle = 1 - 2 * k / number, np.pi * (1 + np.sqrt(5)) * k
    ring = np.sqrt(1 - z * z)
    points = np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1)
    margin = APART * np.sqrt(4 * np.pi / number)
    outside = np.ones(number, dtype=bool)
    for circle in circles:
        axis = circle.mean(axis=0)
        height = float(np.linalg.norm(axis))
        outside &= np.arccos(np.clip(points @ (axis / height), -1, 1)) > np.arccos(min(1.0, height)) + margin
    return points[outside]


def _hull(points: Floats, circles: int, n: int) -> Integers:
    """The faces of the hull, outwards, but those with all corners on one of the circles, n points each."""
    from scipy.spatial import ConvexHull

    faces = ConvexHull(points).simplices
    owner = np.minimum(faces // n, circles)
    faces = faces[~((owner[:, 0] == owner[:, 1]) & (owner[:, 1] == owner[:, 2]) & (owner[:, 0] < circles))]
    p = points[faces]
    inward = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p.sum(axis=1)) < 0
    faces[inward] = faces[inward][:, ::-1]
    return np.asarray(faces, dtype=np.intp)
