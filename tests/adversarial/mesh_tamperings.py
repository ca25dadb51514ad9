"""Ways in which a mesh is no longer that of its surface: what each does, and the mesh that it makes.

A tampering takes a mesh (points (N, 3), triangles (T, 3)), a random generator and the centre of its surface's region,
and gives points and triangles.  After each one of two is wrong: the mesh is another surface, or not all of its vertices
are on the surface.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random

import numpy as np

Mesh = tuple[np.ndarray, np.ndarray]


def size(points):
    """The mesh's extent."""
    return float(np.ptp(points, axis=0).max())


def loops(triangles):
    """The closed curves of the boundary, each a list of vertices in order, the mesh to its left."""
    directed = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).tolist()
    there = {(a, b) for a, b in directed}
    after = {a: b for a, b in there if (b, a) not in there}
    found = []
    while after:
        first, at = after.popitem()
        loop = [first]
        while at != first:
            loop.append(at)
            at = after.pop(at)
        found.append(loop)
    return found


def octahedron(middle, radius):
    """A closed surface around a point, outside out: eight triangles halved three times, turned against the axes."""
    turn = np.linalg.qr([(1, 0.31, 0.17), (-0.23, 1, 0.41), (0.11, -0.37, 1)])[0]
    points = np.concatenate([turn, -turn]) * np.sign(np.linalg.det(turn))
    triangles = [(x, y, z) for x in (0, 3) for y in (1, 4) for z in (2, 5)]
    triangles = np.array([t if np.linalg.det(points[list(t)]) > 0 else t[::-1] for t in triangles])
    for _ in range(3):
        corners = points[triangles]
        ab, bc, ca = ((corners[:, i] + corners[:, (i + 1) % 3]) / 2 for i in range(3))
        a, b, c = corners.transpose(1, 0, 2)
        parts = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        points, inverse = np.unique(parts.reshape(-1, 3).round(12), axis=0, return_inverse=True)
        triangles = inverse.reshape(-1, 3)
    return middle + radius * points / np.linalg.norm(points, axis=1)[:, None], triangles


def with_part(mesh: Mesh, part: Mesh) -> Mesh:
    """Two meshes side by side."""
    return np.concatenate([mesh[0], part[0]]), np.concatenate([mesh[1], part[1] + len(mesh[0])])


def cone_over(points, loop, tip):
    """Triangles from a loop of the boundary to a point, oriented as what they go on from."""
    return [(b, a, tip) for a, b in zip(loop, [*loop[1:], loop[0]], strict=True)]


def without_a_triangle(points, triangles, draw, center):
    return points, np.delete(triangles, draw.randrange(len(triangles)), axis=0)


def without_a_fan(points, triangles, draw, center):
    vertex = triangles[draw.randrange(len(triangles)), 0]
    return points, triangles[~(triangles == vertex).any(axis=1)]


def moved_off(points, triangles, draw, center):
    moved = points.copy()
    vertex = triangles[draw.randrange(len(triangles)), 0]
    moved[vertex] = center + (moved[vertex] - center) * (1 + draw.choice((-1, 1)) * draw.uniform(0.01, 0.05))
    return moved, triangles


def moved_across(points, triangles, draw, center):
    moved = points.copy()
    a, b, _ = triangles[draw.randrange(len(triangles))]
    moved[a] = 2 * moved[b] - moved[a]
    return moved, triangles


def exchanged(points, triangles, draw, center):
    moved = points.copy()
    a, b = (triangles[draw.randrange(len(triangles)), 0] for _ in range(2))
    while a == b:
        b = triangles[draw.randrange(len(triangles)), 0]
    moved[[a, b]] = moved[[b, a]]
    return moved, triangles


def doubled(points, triangles, draw, center):
    return with_part((points, triangles), (points, triangles))


def turned(points, triangles, draw, center):
    return points, triangles[:, ::-1]


def one_turned(points, triangles, draw, center):
    result = triangles.copy()
    row = draw.randrange(len(result))
    result[row] = result[row, ::-1]
    return points, result


def sphere_around(points, triangles, draw, center):
    """A closed sphere around the centre, from inside of the mesh to far outside."""
    far = float(np.linalg.norm(points - center, axis=1).max())
    return with_part((points, triangles), octahedron(center, far * draw.choice((0.05, 0.3, 0.7, 1.01, 1.3, 2.2, 9.0))))


def bubble(points, triangles, draw, center):
    """A small closed sphere inside or outside."""
    vertex = points[triangles[draw.randrange(len(triangles)), 0]]
    middle = center + draw.choice((0.4, 0.8, 1.2)) * (vertex - center)
    return with_part((points, triangles), octahedron(middle, draw.uniform(0.01, 0.05) * size(points)))


def hollow_bubble(points, triangles, draw, center):
    """The same inside out."""
    grown, all_triangles = bubble(points, triangles, draw, center)
    all_triangles = all_triangles.copy()
    all_triangles[len(triangles) :] = all_triangles[len(triangles) :, ::-1]
    return grown, all_triangles


def lid(points, triangles, draw, center):
    """An end that is closed, or, where there is none, a hole that is cut and filled by a dent."""
    ends = loops(triangles)
    if not ends:
        points, triangles = without_a_fan(points, triangles, draw, center)
        ends = loops(triangles)
    loop = draw.choice(ends)
    tip = center + draw.choice((0.7, 1.1)) * (points[loop].mean(axis=0) - center)
    return np.concatenate([points, [tip]]), np.concatenate([triangles, cone_over(points, loop, len(points))])


def lid_and_disc(points, triangles, draw, center):
    """An end that is closed, and a disc of its own that ends there."""
    ends = loops(triangles)
    if not ends:
        return doubled(points, triangles, draw, center)
    loop = draw.choice(ends)
    middle = points[loop].mean(axis=0)
    tips = np.array([center + far * (middle - center) for far in (1.05, 1.2)])
    first = cone_over(points, loop, len(points))
    rim = list(range(len(points) + 2, len(points) + 2 + len(loop)))
    second = cone_over(points, rim, len(points) + 1)
    return np.concatenate([points, tips, points[loop]]), np.concatenate([triangles, first, second])


def larger(points, triangles, draw, center):
    return center + (points - center) * (1 + draw.choice((-1, 1)) * draw.uniform(1e-3, 0.2)), triangles


def pinched(points, triangles, draw, center):
    """Two vertices far from one another made one."""
    a = triangles[draw.randrange(len(triangles)), 0]
    used = np.unique(triangles)
    far = np.linalg.norm(points[used] - points[a], axis=1)
    b = draw.choice(used[far > far.max() / 2].tolist())
    return points, np.where(triangles == b, a, triangles)


def bridged(points, triangles, draw, center):
    """Two triangles far from one another taken away, and a tube between them."""
    one = draw.randrange(len(triangles))
    middles = points[triangles].mean(axis=1)
    far = np.linalg.norm(middles - middles[one], axis=1)
    two = draw.choice(np.flatnonzero(far > far.max() / 2).tolist())
    (a, b, c), (d, e, f) = triangles[one].tolist(), triangles[two].tolist()
    tube = [(a, b, f), (b, e, f), (b, c, e), (c, d, e), (c, a, d), (a, f, d)]
    return points, np.concatenate([np.delete(triangles, [one, two], axis=0), tube])


TAMPERINGS: dict[str, Callable[..., Mesh]] = {
    f.__name__: f
    for f in (
        without_a_triangle, without_a_fan, moved_off, moved_across, exchanged, doubled, turned, one_turned,
        sphere_around, bubble, hollow_bubble, lid, lid_and_disc, larger, pinched, bridged,
    )
}  # fmt: skip


def tampered(name: str, points: np.ndarray, triangles: np.ndarray, center: np.ndarray, seed: int) -> Mesh:
    """Case `seed` of a tampering."""
    return TAMPERINGS[name](np.array(points), np.array(triangles), Random(f"{name} {seed}"), np.array(center))
