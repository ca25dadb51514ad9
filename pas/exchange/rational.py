"""Rational Bezier patches of balls, cylinders, cones and tori, exact.

A quarter of the unit circle is the conic with control points (1, 0), (1, 1), (0, 1) and weights 1, 1, 2:
`((1 - t^2) / (1 + t^2), 2 t / (1 + t^2))`.  All its numbers are whole, so that the patches are exactly on
their surfaces, up to one rounding of control points that the given numbers and the axis' frame cause.

Guaranteed: patches of one surface share their boundary curves, with the same control points to the last
bit and the same weights up to a power of 2; normals `x_u x x_v` point outwards.  Not guaranteed: normals at
points where a side of a patch shrinks to a point (poles and apexes).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pas.algebra.monomials import Floats
from pas.algebra.rational import Exact, VectorLike, dot, rational, to_float, to_floats, vector
from pas.parametric.patches import RationalPatch


def ball_patches(center: VectorLike, radius: Exact) -> list[RationalPatch]:
    """The sphere: eight biquadratic octants; the poles are on the z axis.  Lengths are in the model's units.

    Raises `ValueError` for a radius that is not positive.
    """
    r = _positive(radius, "radius")
    frame = _frame(center, (0, 0, 1))
    return _revolved(_arc(0.0, r, -1), frame) + _revolved(_arc(0.0, r, 0), frame)


def cone_patches(
    start: VectorLike, end: VectorLike, radius: Exact, end_radius: Exact = 0, *, ends: bool = True
) -> list[RationalPatch]:
    """The cone (or cylinder) around a segment: four quarters, of degree 2 around and 1 along it.

    With `ends` also the quarters of its flat ends.  Lengths are in the model's units.

    Raises `ValueError` for a negative radius or two that are 0, and where both ends are the same point.
    """
    a, b = vector(start, "start"), vector(end, "end")
    axis = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    if dot(axis, axis) == 0:
        raise ValueError("start and end must be different points")
    first, last = to_float(rational(radius, "radius")), to_float(rational(end_radius, "end_radius"))
    if first < 0 or last < 0 or first == last == 0:
        raise ValueError(f"radius must be positive and end_radius not negative, not {first:g} and {last:g}")
    frame, height = _frame(a, axis), to_float(dot(axis, axis)) ** 0.5
    result = _revolved(_line((first, 0.0), (last, height)), frame)
    if ends and first:
        result += _revolved(_line((0.0, 0.0), (first, 0.0)), frame)
    if ends and last:
        result += _revolved(_line((last, height), (0.0, height)), frame)
    return result


def cylinder_patches(start: VectorLike, end: VectorLike, radius: Exact, *, ends: bool = True) -> list[RationalPatch]:
    """The cylinder around a segment; see `cone_patches`.  Lengths are in the model's units.

    Raises `ValueError` as that does.
    """
    return cone_patches(start, end, radius, radius, ends=ends)


def torus_patches(center: VectorLike, axis: VectorLike, major: Exact, minor: Exact) -> list[RationalPatch]:
    """The ring torus: sixteen biquadratic patches.  Lengths are in the model's units.

    Raises `ValueError` unless 0 < minor < major, and for a zero axis.
    """
    big, small = _positive(major, "major"), _positive(minor, "minor")
    if small >= big:
        raise ValueError(f"minor must be smaller than major, not {small:g} >= {big:g}")
    frame = _frame(center, axis)
    return [patch for k in range(4) for patch in _revolved(_arc(big, small, k), frame)]


def _positive(value: Any, name: str) -> float:
    number = to_float(rational(value, name))
    if not 0 < number < np.inf:
        raise ValueError(f"{name} must be positive, not {number:g}")
    return number


def _quarter(start: int) -> tuple[Floats, Floats, Floats]:
    """Control points (x, y) and weights of a quarter of the unit circle, from `start` right angles on."""
    x, y, weights = np.array([(1.0, 0.0, 1.0), (1.0, 1.0, 1.0), (0.0, 1.0, 2.0)]).T
    for _ in range(start % 4):
        x, y = 0.0 - y, x
    return x, y, weights


def _arc(middle: float, radius: float, start: int) -> Floats:
    """Control points (3, 3) as (distance from the axis, height, weight) of a quarter from `start` right angles on."""
    x, y, weights = _quarter(start)
    return np.stack([middle + x * radius, y * radius, weights], axis=1)


def _line(start: tuple[float, float], end: tuple[float, float]) -> Floats:
    return np.array([(*start, 1.0), (*end, 1.0)])


def _revolved(profile: Floats, frame: tuple[Floats, Floats]) -> list[RationalPatch]:
    """The quarters of the surface that a profile (distance, height, weight) sweeps about the frame's third axis."""
    origin, axes = frame
    result = []
    for k in range(4):
        x, y, weights = _quarter(k)
        flat = np.stack([np.outer(x, profile[:, 0]), np.outer(y, profile[:, 0])], axis=-1)
        heights = np.broadcast_to(profile[:, 1], flat.shape[:2])
        local = np.concatenate([flat, heights[..., None]], axis=-1)
        points = origin + sum(local[..., i, None] * axes[i] for i in range(3))
        result.append(RationalPatch(points, np.outer(weights, profile[:, 2])))
    return result


def _frame(center: VectorLike, axis: VectorLike) -> tuple[Floats, Floats]:
    """A point and three orthonormal rows, the last along the axis; the usual ones for the z axis."""
    a = vector(axis, "axis")
    if dot(a, a) == 0:
        raise ValueError("axis must not be the zero vector")
    third = np.array(to_floats(a))
    third /= np.linalg.norm(third)
    helper = np.eye(3)[int(np.abs(third).argmin())]
    first = helper - third * (helper @ third)
    first /= np.linalg.norm(first)
    return np.array(to_floats(vector(center, "center"))), np.stack([first, np.cross(third, first), third])
