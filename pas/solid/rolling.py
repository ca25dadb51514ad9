"""Balls that roll along a seam, of a fillet's radius: where they touch its two faces.

A ball of radius r whose centre is at p + r m and at q + r n, with points p and q of the faces and unit normals m and n
there, is followed from r = 0 on, where both points are one of the edge, by Newton's method.  Its centre stays in the
plane across the edge.

Not guaranteed: that a ball which touches both faces is elsewhere outside of them.
"""

from __future__ import annotations

import numpy as np

from pas.algebra.lengths import lengths, unit
from pas.algebra.polynomial import Polynomial
from pas.arrays import Floats
from pas.solid.face_seams import FaceSeam


def touching(seam: FaceSeam, radius: float) -> Floats | None:
    """Points (2, N, 3) in which balls of a radius that roll along a seam touch its faces; None where one of them
    cannot."""
    steps, iterations = 8, 6  # radii one after the other, and steps of Newton's method for each
    close, singular = 1e-6, 1e-9  # distances over the radius, and the determinant, 1 between orthogonal planes
    along = unit(np.cross(*seam.normals))
    points, edge, start = np.stack([seam.points, seam.points]), seam.points, None
    for reach in seam.sign * radius * np.arange(1, steps + 1) / steps:
        for _ in range(iterations):
            values, matrix = np.zeros((len(edge), 6)), np.zeros((len(edge), 6, 6))
            for number, (face, some) in enumerate(zip(seam.faces, points, strict=True)):
                own = slice(3 * number, 3 * number + 3)
                value, normal, turning = _jets(face, some)
                values[:, number], matrix[:, number, own] = value, normal
                moves = np.eye(3) + reach * turning
                values[:, 2:5] += (1 - 2 * number) * (some + reach * normal)
                matrix[:, 2:5, own] = (1 - 2 * number) * moves
                values[:, 5] += ((some + reach * normal - edge) * along).sum(axis=1)
                matrix[:, 5, own] = (along[:, None] @ moves)[:, 0]
            sizes = np.linalg.det(matrix)
            start = sizes if start is None else start
            if not (sizes * np.sign(start) > singular).all():
                return None
            moved = np.linalg.solve(matrix, values[..., None])[..., 0]
            points = points - np.moveaxis(moved.reshape(-1, 2, 3), 1, 0)
        if np.abs(values).max() > close * radius:
            return None
    return points


def _jets(face: Polynomial, points: Floats) -> tuple[Floats, Floats, Floats]:
    """Distances (N,) of points from a face, to first order, the unit normals (N, 3), and how these turn (N, 3, 3)."""
    slopes = face.gradient(points)
    sizes, normals = lengths(slopes), unit(slopes)
    second = np.stack([face.diff(axis).gradient(points) for axis in range(3)], axis=1) / sizes[:, None, None]
    turning = second - normals[:, :, None] * (normals[:, None] @ second)
    return face(points) / sizes, normals, turning
