"""Lengths and directions of vectors of any size that doubles hold.

The squares of numbers below 1e-162 or above 1e154 leave the range of doubles; a scale by a power of two before
squaring, which rounds nothing, keeps them in (Higham 2002, section 27.8).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pas.arrays import Floats


def lengths(vectors: Floats) -> Floats:
    """Euclidean lengths along the last axis, (..., n) to (...); infinite or nan where a coordinate is."""
    small, exponents = _scaled(vectors)
    with np.errstate(all="ignore"):
        return np.asarray(np.ldexp(np.sqrt((small * small).sum(axis=-1)), exponents))


def unit(vectors: ArrayLike) -> Floats:
    """Vectors (..., n) made of length one; nan for zero vectors and ones that are not finite."""
    small = scaled(vectors)
    with np.errstate(all="ignore"):
        return np.asarray(small / np.sqrt((small * small).sum(axis=-1, keepdims=True)))


def across(direction: Floats) -> Floats:
    """Two unit vectors (2, 3) across a unit vector, right-handed with it."""
    first = np.cross(direction, np.eye(3)[int(np.abs(direction).round(9).argmin())])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(direction, first)])


def spiral(number: int) -> Floats:
    """Unit vectors (number, 3) spread evenly over the sphere along a spiral (Vogel 1979), from the last axis on."""
    place = np.arange(number) + 0.5
    height, turn = 1 - 2 * place / number, place * np.pi * (3 - np.sqrt(5))
    ring = np.sqrt(1 - height**2)
    return np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)


def arc_lengths(points: Floats) -> Floats:
    """How long a polyline (N, 3) is from its first point to each of its points, (N,)."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def resampled(points: Floats, number: int, last: bool = True) -> Floats:
    """Points (number, 3) evenly along a polyline (N, 3), from its first point to its `last` or before that."""
    along = arc_lengths(points)
    even = np.linspace(0.0, along[-1], number, endpoint=last)
    return np.stack([np.interp(even, along, column) for column in points.T], axis=1)


def angle_between(a: Floats, b: Floats) -> float:
    """The angle (radians) between two vectors (3,)."""
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))


def scaled(vectors: ArrayLike) -> Floats:
    """Vectors (..., n), each times a power of two so that its greatest coordinate is in [1/2, 1)."""
    return _scaled(vectors)[0]


def exponent(numbers: Floats) -> int:
    """The least e with all finite numbers below 2^e in absolute value; 0 where they are all zero."""
    array = np.asarray(numbers, dtype=float)
    return int(np.frexp(np.abs(array[np.isfinite(array)]).max(initial=0.0))[1])


def _scaled(vectors: ArrayLike) -> tuple[Floats, NDArray[np.intc]]:
    """The scaled vectors, and the exponents of the powers of two taken out."""
    array = np.asarray(vectors, dtype=float)
    _, exponents = np.frexp(np.abs(array).max(axis=-1, initial=0.0))
    with np.errstate(under="ignore"):
        return np.ldexp(array, -exponents[..., None]), exponents
