"""Rings of vertices around struts, and the strips of triangles between two of them.

A strip merges the vertices of two rings by their angles around the strut.  A triangle of it has two neighbours of one
ring, and one of the other between them or between which they are, so that its corners are no farther apart, in angle,
than neighbours of one ring; it is r (1 - cos(angle / 2)) from the cylinder or cone at most, with its largest radius r.
A strip may have even rings in between, so that few angles of its triangles are small, and end in one of these.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import ceil, pi, radians, sin, tan, tau
from typing import Any

import numpy as np

from pas.algebra.lengths import across, unit
from pas.arrays import Floats, Integers

FEWEST = 8
"""Vertices of a ring."""

LEAST_ANGLE = 6.0
"""Degrees under which a ring's shortest side is seen from the next ring: those who see it aslant have 5 left."""


Span = tuple[Floats, Floats, Floats]
"""A ring around the beginning of a vector, one around its end, which may have no points, and the vector."""


def rings_of(points: Floats, boundary: Integers, axes: Floats, circles: Floats) -> tuple[Integers, ...]:
    """The boundary vertices on the circle of each arm, along a unit vector so far away, with such a radius.

    Raises `AssertionError` where a vertex is on none: blends end on the circles of their contacts.
    """
    along = points[boundary] @ axes.T
    off = np.linalg.norm(points[boundary, None] - along[..., None] * axes, axis=2)
    on = (np.abs(np.stack([along, off], axis=2) - circles) < 1e-6 * circles[:, :1].max()).all(axis=2)
    assert (on.sum(axis=1) == 1).all()
    return tuple(boundary[some] for some in on.T)


def angles_around(points: Floats, axis: Floats) -> Floats:
    """The angles of points around an axis through the origin, from 0 to a full turn."""
    first, second = across(axis)
    return np.asarray(np.arctan2(points @ second, points @ first) % tau)


def outwards(points: Floats, axis: Floats, slope: float) -> Floats:
    """The normals of a cone about an axis, which widens by so much along it, over points (N, 3) beside the axis."""
    return unit(unit(points - (points @ axis)[:, None] * axis) - slope * axis)


def circle(axis: Floats, count: int, start: float = 0.0) -> Floats:
    """Points (count, 3) evenly on the circle of radius 1 around a unit vector, and the angle of the first."""
    angles = start + tau * np.arange(count)[:, None] / count
    first, second = across(axis)
    return np.asarray(np.cos(angles) * first + np.sin(angles) * second)


def places_of(first: Floats, second: Floats, vector: Floats, count: int) -> Floats:
    """Where even rings of so many vertices stand between rings around the ends of a vector, in parts of the way.

    The last is 1 where the second ring has no points, and is to be even.

    Sides of even rings are seen from the next one under `LEAST_ANGLE` or more, and so is the shortest side of the first
    ring from the next one, and of the second from the last, unless these were nearer than a side of theirs is long.
    """
    axis, end, (_, length) = unit(vector), np.ones(int(not len(second))), _span(first, second, vector)
    radius = min(float(np.linalg.norm(np.cross(ring, axis), axis=1).min(initial=np.inf)) for ring in (first, second))
    gaps = [float(_gaps(angles_around(ring, axis)).min()) if len(ring) else tau / count for ring in (first, second)]
    side, *sides = (2 * radius * sin(min(gap, pi) / 2) for gap in (tau / count, *gaps))
    far, *seen = (one / tan(radians(LEAST_ANGLE)) for one in (side, *sides))
    begin, last = (max(side, min(far, one)) for one in seen)
    if length <= min(seen):
        return end
    if begin + last >= length:
        return np.append(begin / (begin + last), end)
    return np.append(np.linspace(begin, length - last, 1 + ceil((length - begin - last) / far)) / length, end)


def strip(
    first: Floats, second: Floats, vector: Floats, rise: float = 0.0, count: int = FEWEST, places: Any = ()
) -> tuple[Floats, Integers, Floats, float]:
    """Points about the first end (N, 3) of even rings of so many vertices at `places` (see `places_of`), and the
    triangles between rings around the ends of a vector, over the first ring's vertices, then the second's, then these.

    With the normals at their corners of the cone, whose radius grows by `rise` along the vector, and the widest angle
    between neighbours of a ring.
    """
    start, span = _span(first, second, vector)
    length = float(np.linalg.norm(vector))
    axis, slope, known = vector / length, rise / length, len(first) + len(second)
    angles = [angles_around(ring, axis) for ring in (first, second)]
    even = circle(axis, count, float(angles[0][0]))
    radius = float(np.linalg.norm(first[0] - start * axis))
    between = np.array([(start + part * span) * axis + (radius + slope * part * span) * even for part in places])
    rings = [np.arange(len(first)), *known + np.arange(between.size // 3).reshape(-1, count)]
    around = [angles[0], *[angles_around(even, axis)] * len(between)]
    if len(second):
        rings, around = [*rings, np.arange(len(first), known)], [*around, angles[1]]
    pairs = pairwise(zip(rings, around, strict=True))
    triangles = np.concatenate([np.concatenate([a, b])[_zipped(u, v)] for (a, u), (b, v) in pairs])
    points = np.concatenate([first, second, between.reshape(-1, 3)])
    return points[known:], triangles, outwards(points, axis, slope)[triangles], max(_gaps(a).max() for a in around)


def _span(first: Floats, second: Floats, vector: Floats) -> tuple[float, float]:
    """How far along a vector a ring around its beginning is, and from there to that around its end, or the end."""
    axis = unit(vector)
    start = float(np.mean(first @ axis))
    return start, float(np.mean((second + vector if len(second) else vector) @ axis)) - start


def flat_end(points: Floats, rings: Sequence[Integers], axis: Floats) -> Integers:
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
