"""Rings of vertices around struts, and the strips of triangles between two of them.

A strip merges the vertices of two rings by their angles around the strut.  A triangle of it has two neighbours of one
ring, and one of the other between them or between which they are, so that its corners are no farther apart, in angle,
than neighbours of one ring; it is r (1 - cos(angle / 2)) from the cylinder or cone at most, with its largest radius r.
"""

from __future__ import annotations

from math import tau
from typing import Any

import numpy as np

from pas.algebra.lengths import across
from pas.algebra.monomials import Floats
from pas.mesh.rows import Integers


def rings_of(points: Floats, boundary: Integers, arms: Any) -> tuple[Integers, ...]:
    """The boundary vertices on the circle of each arm (vector, end in parts of it, radius).

    Raises `AssertionError` where a vertex is on none: blends end on the circles of their contacts.
    """
    found, seen = [], np.zeros(len(boundary), dtype=bool)
    for vector, end, radius in arms:
        length = float(np.linalg.norm(vector))
        along = points[boundary] @ vector / length
        outside = np.linalg.norm(points[boundary] - along[:, None] * vector / length, axis=1)
        on = (np.abs(along - end * length) < 1e-6 * length) & (np.abs(outside - radius) < 1e-6 * length)
        found.append(boundary[on])
        seen |= on
    assert seen.all() and sum(map(len, found)) == len(boundary)
    return tuple(found)


def angles_around(points: Floats, axis: Floats) -> Floats:
    """The angles of points around an axis through the origin, from 0 to a full turn."""
    first, second = across(axis)
    return np.asarray(np.arctan2(points @ second, points @ first) % tau)


def outwards(points: Floats, axis: Floats, slope: float) -> Floats:
    """The normals of a cone about an axis, which widens by so much along it, over points (N, 3) beside the axis."""
    across_ = points - (points @ axis)[:, None] * axis
    found = across_ / np.linalg.norm(across_, axis=1, keepdims=True) - slope * axis
    return np.asarray(found / np.hypot(1.0, slope))


def strip(first: Floats, second: Floats, vector: Floats, rise: float = 0.0) -> tuple[Integers, Floats, float]:
    """The triangles between rings around the ends of a vector, over the first ring's vertices and then the second's.

    With the normals at their corners of the cone, whose radius grows by `rise` along the vector, and the widest angle
    between neighbours of a ring.
    """
    axis = vector / np.linalg.norm(vector)
    angles = [angles_around(ring, axis) for ring in (first, second)]
    orders = [np.argsort(a) for a in angles]
    sides = np.repeat([0, 1], [len(first), len(second)])
    sorted_ = np.argsort(np.concatenate(angles), kind="stable")
    latest = [int(orders[0][-1]), len(first) + int(orders[1][-1])]
    triangles = []
    for number in sorted_.tolist():
        side = int(sides[number])
        a, b = latest[side], latest[1 - side]
        triangles.append((a, number, b) if side == 0 else (number, a, b))
        latest[side] = number
    found = np.array(triangles)
    normals = outwards(np.concatenate([first, second]), axis, rise / float(np.linalg.norm(vector)))[found]
    gaps = [np.diff(np.sort(a), append=np.sort(a)[0] + tau).max() for a in angles]
    return found, normals, float(max(gaps))
