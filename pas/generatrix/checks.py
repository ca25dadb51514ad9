"""What is asked of a boundary before it is used, at samples: regular, closed as it says, with a plane at each s."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pas.algebra.lengths import lengths, unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.errors import GeometryError
from pas.generatrix.space import value_at
from pas.parametric.surface import ParametricSurface

if TYPE_CHECKING:
    from pas.generatrix.boundary import Boundary

SAMPLES = 257
"""Parameters at which numeric data are checked."""

STILL = 1e-9
"""A derivative or field below this share of its largest value counts as zero: roundoff of differences is 1e-10."""

SIZES = (1e-280, 1e280)
"""Least size of a curve, and greatest coordinate: near the ends of the range of doubles digits are lost."""

ON_SURFACE = 1e-8
"""Distance from its surface, over the curve's size, up to which a numeric curve counts as lying on it: data typed
with nine digits pass, a wrong formula does not."""


def refuse_both(tolerance: Any, size: Any) -> None:
    """Raise `ValueError` where a mesh is asked for by its size and by its tolerance, or its quality where that is None.

    Raises `TypeError` for a size as tolerance.
    """
    if size is not None and tolerance is None:
        raise ValueError("of a mesh with a given size no quality can be chosen; give a tolerance, or nothing, instead")
    if size is not None:
        raise ValueError("tolerance and size are two ways to say how fine the mesh is; give one of them")
    if isinstance(tolerance, tuple):
        raise TypeError(f"tolerance must be a positive number; a grid is given as size={tolerance}")


def require_boundary(boundary: Boundary) -> None:
    """Raise `GeometryError` where the data are no boundary of a blend, saying at which s."""
    s, name = np.linspace(0.0, 1.0, SAMPLES), boundary.name
    points, velocity, vectors = (np.asarray(f(s)) for f in (boundary.curve, boundary.velocity, boundary.direction))
    for what, array in (("the curve", points), ("its derivative", velocity), ("the surface's direction", vectors)):
        bad = np.flatnonzero(~np.isfinite(array).all(axis=-1))
        if len(bad):
            raise GeometryError(f"{name}: {what} is not finite at s = {s[bad[0]]:.6g}; choose another interval")
    _require_size(points, name)
    speed, length = lengths(velocity), lengths(vectors)
    _require_positive(speed, s, f"{name}: the curve is not regular; its derivative vanishes")
    what = "surface's normal" if boundary.has_normal else "tangent vector given"
    _require_positive(length, s, f"{name}: the {what} vanishes")
    sine = lengths(np.cross(unit(vectors), unit(velocity)))
    if boundary.has_normal:
        slant = np.sqrt(np.maximum(0.0, 1.0 - sine**2))
        worst = int(slant.argmax())
        if slant[worst] > np.sqrt(ON_SURFACE):
            raise GeometryError(
                f"{name}: the normal is not perpendicular to the curve at s = {s[worst]:.4g} "
                f"(cosine {slant[worst]:.2g})"
            )
    else:
        _require_positive(sine, s, f"{name}: the tangent vector given is along the curve")
    if boundary.closed:
        _require_closed(points, velocity, vectors, name)


def _require_size(points: Floats, name: str) -> None:
    """Raise `GeometryError` for curves that doubles hold badly."""
    size, far = float(np.ptp(points, axis=0).max()), float(np.abs(points).max())
    if not (size == 0 or SIZES[0] <= size) or far > SIZES[1]:
        raise GeometryError(
            f"{name} is {size:.2g} long and {far:.2g} away from the origin; blends by a generatrix are made from "
            f"{SIZES[0]:.0e} to {SIZES[1]:.0e}: choose another unit of length"
        )


def require_on(f: Polynomial, path: ParametricSurface, name: str) -> None:
    """Raise `GeometryError` where a numeric curve is off the surface f = 0."""
    s = np.linspace(0, 1, SAMPLES)
    points = value_at(path, s)
    with np.errstate(all="ignore"):
        away = np.abs(f(points)) / np.maximum(lengths(f.gradient(points)), 1e-300)
    worst = int(np.nanargmax(away))
    if not away[worst] <= 2 * ON_SURFACE * np.abs(points).max():
        raise GeometryError(f"{name}: the curve is off the surface by {away[worst]:.2g} at s = {s[worst]:.4g}")


def closes(points: Floats) -> bool:
    """Whether the first and the last of the points (n, 3) along a curve agree, as measured by all of them."""
    with np.errstate(all="ignore"):
        return bool(np.abs(points[0] - points[-1]).max() <= STILL * np.abs(points).max())


def _require_positive(values: Floats, s: Floats, message: str) -> None:
    worst = int(values.argmin())
    if not values[worst] > STILL * values.max():
        raise GeometryError(f"{message} at s = {s[worst]:.6g}")


def _require_closed(points: Floats, velocity: Floats, vectors: Floats, name: str) -> None:
    if not closes(points):
        gap = float(np.linalg.norm(points[0] - points[-1]))
        raise GeometryError(f"{name} is called closed, but its ends are {gap:.3g} apart; say closed=False")
    first, last = unit(velocity[[0, -1]])
    if float(first @ last) < 1.0 - 1e-6:
        raise GeometryError(f"{name} has a corner at s = 0 where it closes; say closed=False, or round it")
    first, last = unit(vectors[[0, -1]])
    if float(first @ last) < 1.0 - 1e-6:
        raise GeometryError(f"{name}: the surface's direction at s = 0 and s = 1 differ, though the curve is closed")
