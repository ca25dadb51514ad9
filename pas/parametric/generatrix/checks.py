"""What is asked of a boundary before it is used, at samples: regular, closed as it says, with a plane at each s."""

from __future__ import annotations

from typing import Any

import numpy as np

from pas.algebra.lengths import lengths, unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.errors import GeometryError
from pas.parametric.generatrix.paths import Curve, value_at
from pas.parametric.surface import ParametricSurface

CHECKED = np.linspace(0.0, 1.0, 257)
"""Parameters at which numeric data are checked."""

STILL = 1e-9
"""A derivative or field below this share of its largest value counts as zero: roundoff of differences is 1e-10."""

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


def require_boundary(name: str, curve: Curve, velocity: Curve, field: Curve, has_normal: bool, closed: bool) -> None:
    """Raise `GeometryError` where a curve, its C' and the field along it are no boundary of a blend, saying where."""
    points, slopes, vectors = (np.asarray(f(CHECKED)) for f in (curve, velocity, field))
    for what, array in (("the curve", points), ("its derivative", slopes), ("the surface's direction", vectors)):
        bad = np.flatnonzero(~np.isfinite(array).all(axis=-1))
        if len(bad):
            raise GeometryError(f"{name}: {what} is not finite at s = {CHECKED[bad[0]]:.6g}; choose another interval")
    size, far = float(np.ptp(points, axis=0).max()), float(np.abs(points).max())
    if 0 < size < 1e-280 or far > 1e280:  # near the ends of the range of doubles digits are lost
        raise GeometryError(
            f"{name} is {size:.2g} long and {far:.2g} away from the origin; blends by a generatrix are made from "
            "1e-280 to 1e+280: choose another unit of length"
        )
    _require_positive(lengths(slopes), f"{name}: the curve is not regular; its derivative vanishes")
    what = "surface's normal" if has_normal else "tangent vector given"
    _require_positive(lengths(vectors), f"{name}: the {what} vanishes")
    sine = lengths(np.cross(unit(vectors), unit(slopes)))
    if not has_normal:
        _require_positive(sine, f"{name}: the tangent vector given is along the curve")
    slant = np.sqrt(np.maximum(0.0, 1.0 - sine**2))
    worst = int(slant.argmax())
    if has_normal and slant[worst] > np.sqrt(ON_SURFACE):
        raise GeometryError(
            f"{name}: the normal is not perpendicular to the curve at s = {CHECKED[worst]:.4g} "
            f"(cosine {slant[worst]:.2g})"
        )
    if closed:
        _require_closed(points, slopes, vectors, name)


def require_on(f: Polynomial, path: ParametricSurface, name: str) -> None:
    """Raise `GeometryError` where a numeric curve is off the surface f = 0."""
    points = value_at(path, CHECKED)
    with np.errstate(all="ignore"):
        away = np.abs(f(points)) / np.maximum(lengths(f.gradient(points)), 1e-300)
    worst = int(np.nanargmax(away))
    if not away[worst] <= 2 * ON_SURFACE * np.abs(points).max():
        raise GeometryError(f"{name}: the curve is off the surface by {away[worst]:.2g} at s = {CHECKED[worst]:.4g}")


def closes(points: Floats) -> bool:
    """Whether the first and the last of the points (n, 3) along a curve agree, as measured by all of them."""
    with np.errstate(all="ignore"):
        return bool(np.abs(points[0] - points[-1]).max() <= STILL * np.abs(points).max())


def _require_positive(values: Floats, message: str) -> None:
    worst = int(values.argmin())
    if not values[worst] > STILL * values.max():
        raise GeometryError(f"{message} at s = {CHECKED[worst]:.6g}")


def _require_closed(points: Floats, velocity: Floats, vectors: Floats, name: str) -> None:
    if not closes(points):
        gap = float(np.linalg.norm(points[0] - points[-1]))
        raise GeometryError(f"{name} is called closed, but its ends are {gap:.3g} apart; say closed=False")
    for array, message in (
        (velocity, " has a corner at s = 0 where it closes; say closed=False, or round it"),
        (vectors, ": the surface's direction at s = 0 and s = 1 differ, though the curve is closed"),
    ):
        first, last = unit(array[[0, -1]])
        if float(first @ last) < 1.0 - 1e-6:
            raise GeometryError(name + message)
