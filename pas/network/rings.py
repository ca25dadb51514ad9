"""Rings of vertices around struts, and the strips of triangles between two of them.

A strip merges the vertices of two rings by their angles around the strut.  A triangle of it has two neighbours of one
ring, and one of the other between them or between which they are, so that its corners are no farther apart, in angle,
than neighbours of one ring; it is r (1 - cos(angle / 2)) from the cylinder or cone at most, with its largest radius r.
A strip may have rings in between, which are the first one moved along: so angles of its triangles are not small.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import ceil, pi, radians, sin, tan, tau
from typing import Any

import numpy as np

from pas.algebra.lengths import across, unit
from pas.arrays import Floats, Integers

LEAST_ANGLE = 6.0
"""Degrees under which a ring's shortest side is seen from the next ring: those who see it aslant have 5 left."""


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
    return unit(unit(points - (points @ axis)[:, None] * axis) - slope * axis)


def parts_of(first: Floats, second: Floats, vector: Floats) -> int:
    """Into how many parts a strip between rings around the ends of a vector is cut so that no angle is small."""
    axis = unit(vector)
    gaps = [_gaps(angles_around(ring, axis)).min() for ring in (first, second)]
    radius = min(np.linalg.norm(np.cross(ring, axis), axis=1).min() for ring in (first, second))
    length = float(((second + vector) @ axis).mean() - (first @ axis).mean())
    return max(1, ceil(length * tan(radians(LEAST_ANGLE)) / (2 * radius * sin(min(*gaps, pi) / 2))))


def strip(
    first: Floats, second: Floats, vector: Floats, rise: float = 0.0, parts: int = 1
) -> tuple[Floats, Integers, Floats, float]:
    """Points about the first end (N, 3) of the rings between so many parts, and the triangles between rings around the
    ends of a vector, over the first ring's vertices, then the second's, then these.

    With the normals at their corners of the cone, whose radius grows by `rise` along the vector, and the widest angle
    between neighbours of a ring.
    """
    length = float(np.linalg.norm(vector))
    axis, slope, count = vector / length, rise / length, len(first) + len(second)
    angles = [angles_around(ring, axis) for ring in (first, second)]
    beside = first - (first @ axis)[:, None] * axis
    far = float(((second + vector) @ axis).mean() - (first @ axis).mean()) * np.arange(1, parts) / parts
    wider = 1 + far[:, None] * slope / np.linalg.norm(beside, axis=1)
    between = (first - beside) + far[:, None, None] * axis + wider[:, :, None] * beside
    rings = [np.arange(len(first)), *count + np.arange(between.size // 3).reshape(parts - 1, len(first))]
    found = [np.concatenate([a, b])[_zipped(angles[0], angles[0])] for a, b in pairwise(rings)]
    found.append(np.concatenate([rings[-1], np.arange(len(first), count)])[_zipped(*angles)])
    triangles, points = np.concatenate(found), np.concatenate([first, second, *between])
    return points[count:], triangles, outwards(points, axis, slope)[triangles], float(max(map(max, map(_gaps, angles))))


def lid(points: Floats, rings: Sequence[Integers], axis: Floats) -> Integers:
    """The triangles (T, 3) in a ring of points, or between two in a plane, seen from where a unit vector points."""
    if len(rings) == 1:
        (ring,) = rings
        return np.stack([np.full(len(ring) - 2, ring[0]), ring[1:-1], ring[2:]], axis=1)
    outer, inner = rings
    return np.concatenate([outer, inner])[strip(points[outer], points[inner], axis)[1]]


def _gaps(angles: Floats) -> Floats:
    """The angles between neighbours."""
    found = np.sort(angles)
    return np.diff(found, append=found[0] + tau)


def _zipped(*angles: Floats) -> Integers:
    """The triangles between two rings by their angles, over the vertices of the first and then of the second."""
    sides = np.repeat([0, 1], [len(a) for a in angles])
    latest = [int(angles[0].argmax()), len(angles[0]) + int(angles[1].argmax())]
    triangles = []
    for number in np.argsort(np.concatenate(angles), kind="stable").tolist():
        side = int(sides[number])
        a, b = latest[side], latest[1 - side]
        triangles.append((a, number, b) if side == 0 else (number, a, b))
        latest[side] = number
    return np.array(triangles)
