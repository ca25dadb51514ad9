"""Cubic splines (scipy): curves through sampled points, with normals in between, and lengths as parameters."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.lengths import lengths as vector_lengths
from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.errors import GeometryError

FEWEST = 4
LENGTHS = 1024
"""Pieces of a curve whose lengths are summed."""


def splined(points: ArrayLike, normals: ArrayLike, closed: bool, name: str) -> tuple[Callable[[Floats], Floats], ...]:
    """C, C' and N as functions of s in [0, 1]: periodic or natural cubic splines over the chords' lengths.

    The interpolated normals are made perpendicular to C', which changes them between the samples, and at a
    sample only as far as they were not.  Raises `ValueError` for arrays of other shapes, `GeometryError` for
    repeated points.
    """
    from scipy.interpolate import CubicSpline

    p, n = (_array(a, what, name) for a, what in ((points, "points"), (normals, "normals")))
    if len(p) != len(n):
        raise ValueError(f"{name} has {len(p)} points but {len(n)} normals; give one for each")
    number = len(p)
    if closed:
        p, n = np.concatenate([p, p[:1]]), np.concatenate([n, n[:1]])
    chords = vector_lengths(np.diff(p, axis=0))
    if not chords.min() > 1e-12 * chords.max():
        where = int(chords.argmin())
        raise GeometryError(f"{name}: points {where} and {(where + 1) % number} coincide; leave one out")
    sizes = vector_lengths(n)
    if not sizes.min() > 0:
        raise GeometryError(f"{name}: normal {int(sizes.argmin())} is zero")
    s = np.concatenate([[0.0], np.cumsum(chords)])
    s /= s[-1]
    kind = "periodic" if closed else "natural"
    curve, field = CubicSpline(s, p, bc_type=kind), CubicSpline(s, unit(n), bc_type=kind)
    velocity = curve.derivative()

    def direction(at: Floats) -> Floats:
        along, raw = np.nan_to_num(unit(velocity(at))), field(at)
        return np.asarray(raw - (raw * along).sum(axis=1)[:, None] * along)

    return curve, velocity, direction


def by_length(speed: Callable[[Floats], Floats], closed: bool) -> tuple[Callable[[Floats], Floats], ...]:
    """For |C'| as a function of u in [0, 1]: u as a function of the share s of the length, and du/ds.

    Lengths by Simpson's rule, their inverse by a cubic spline of u - s (periodic for closed curves).
    """
    from scipy.interpolate import CubicSpline

    u = np.linspace(0.0, 1.0, LENGTHS + 1)
    middle = (u[1:] + u[:-1]) / 2
    at = speed(u)
    pieces = (at[1:] + at[:-1] + 4 * speed(middle)) / 6
    s = np.concatenate([[0.0], np.cumsum(pieces)]) / pieces.sum()
    s[-1] = 1.0
    away = u - s
    away[-1] = away[0]
    inverse = CubicSpline(s, away, bc_type="periodic" if closed else "not-a-knot")
    slope = inverse.derivative()
    return lambda s: s + inverse(s), lambda s: 1.0 + slope(s)


def _array(values: ArrayLike, what: str, name: str) -> Floats:
    array = np.asarray(values, dtype=float)
    if array.ndim != 2 or array.shape[1] != 3 or len(array) < FEWEST:
        raise ValueError(f"{what} of {name} must have shape (n, 3) with n >= {FEWEST}, not {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{what} of {name} must be finite")
    return array
