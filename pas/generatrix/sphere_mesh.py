"""The mesh of blends through a sphere: the tubes, and the sphere between their circles.

Points on a sphere that lie on the circles or outside them have a convex hull whose faces are a triangulation of the
sphere between the circles and one flat disc for each, which is left out.  The circles' points are the tubes' own, so
that all is welded.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pas.algebra.monomials import Floats
from pas.mesh.field import Integers, TriangleMesh

APART = 0.6
"""Distance of other points from the circles, over the mean spacing of points."""


def sphere_mesh(
    center: tuple[float, float, float], radius: float, tubes: Sequence[TriangleMesh], size: tuple[int, int]
) -> TriangleMesh:
    """Tubes made on grids of `size`, whose last points of each row are a circle on the sphere, and the sphere."""
    n, m = size
    origin = np.array(center)
    turned = [_outward(tube, m, origin) for tube in tubes]
    count = n * m
    rims = [np.arange(n) * m + m - 1 + number * count for number in range(len(tubes))]
    points = np.concatenate([tube.points for tube in turned])
    normals = np.concatenate([tube.normals for tube in turned])
    circles = [(points[rim] - origin) / radius for rim in rims]
    free = _between(circles, n)
    faces = _hull(np.concatenate([*circles, free]), len(circles), n)
    numbers = np.concatenate([*rims, len(points) + np.arange(len(free))])
    triangles = [tube.triangles + number * count for number, tube in enumerate(turned)]
    return TriangleMesh(
        np.concatenate([points, origin + radius * free]),
        np.concatenate([*triangles, numbers[faces]]),
        np.concatenate([normals, free]),
    )


def _outward(tube: TriangleMesh, m: int, origin: Floats) -> TriangleMesh:
    rim = slice(m - 1, None, m)
    if ((tube.points[rim] - origin) * tube.normals[rim]).sum() >= 0:
        return tube
    return TriangleMesh(tube.points, tube.triangles[:, ::-1], -tube.normals)


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
