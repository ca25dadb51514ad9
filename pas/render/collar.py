"""The surface beyond a blend's boundary, for pictures: a strip that starts at the curve and leads away from the blend.

Each row follows from the last by a short step straight on in the surface (a polygon close to geodesics), so the strip
joins the blend without a gap whatever the curve; its points lie on the surface, its normals are the surface's.
"""

from __future__ import annotations

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.mesh.mesh import Mesh
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.frames import connectivity
from pas.parametric.surface import ParametricSurface

ROWS, NEWTON = 40, 4
NARROW = 0.1
"""The strip ends where its points come this much closer together, over the spacing on the curve."""

STRAY = 0.5
"""Or where bringing a point back to the surface moves it by this much of a step."""


def collar(boundary: Boundary, sign: int, reach: float, number: int) -> Mesh | None:
    """The strip beside a curve at `number` points, `reach` wide; None where the surface is not known.

    `sign` times N x C' (or V) points to the blend.
    """
    s = np.linspace(0.0, 1.0, number, endpoint=not boundary.closed)
    away, start = -sign * unit(boundary.across(s)), boundary(s)
    step = reach / ROWS
    rows: list[Floats] | None = None
    if isinstance(boundary.surface, Polynomial):
        rows = strip(boundary.surface, start, away, step)
    elif boundary.surface is not None and boundary.parameters is not None:
        places = boundary.parameters(boundary.own(s))
        rows = _parametric(boundary.surface, np.broadcast_to(places, (number, 2)), away, step)
    if rows is None or len(rows) < 2:
        return None
    points, normals = (np.stack(parts, axis=1).reshape(-1, 3) for parts in zip(*rows, strict=True))
    return Mesh.smooth(points, connectivity((number, len(rows)), boundary.closed, False), normals)


def strip(f: Polynomial, start: Floats, away: Floats, step: float) -> list[Floats]:
    """Rows of points and normals (2, n, 3) on f = 0, from points `start` (n, 3) along unit vectors `away` (n, 3)."""
    rows, points = [np.stack([start, unit(f.gradient(start))])], start
    for _ in range(ROWS):
        aimed = points + step * away
        moved = aimed
        for _ in range(NEWTON):
            slope = f.gradient(moved)
            with np.errstate(all="ignore"):
                moved = moved - (f(moved) / (slope * slope).sum(axis=1))[:, None] * slope
        stray = np.linalg.norm(moved - aimed, axis=1).max()
        normals = unit(f.gradient(moved))
        if not _goes_on(rows[0][0], moved, normals) or not stray <= STRAY * step:
            break
        away = _within(moved - points, normals)
        points = moved
        rows.append(np.stack([points, normals]))
    return rows


def _parametric(surface: ParametricSurface, places: Floats, away: Floats, step: float) -> list[Floats]:
    """The same on a parametric surface, from parameters (n, 2), as far as its domain goes."""
    whole = surface.with_domain(None)
    low, high = np.array(surface.domain).T
    points = whole(places)
    rows = [np.stack([points, whole.normals(places)])]
    for _ in range(ROWS):
        middle = places + _change(whole, places, step / 2 * away)
        moved = np.clip(places + _change(whole, middle, step * away), low, high)
        if (moved == places).all():
            break
        there, normals = whole(moved), whole.normals(moved)
        if not _goes_on(rows[0][0], there, normals):
            break
        away = _within(there - points, normals)
        places, points = moved, there
        rows.append(np.stack([points, normals]))
    return rows


def _change(surface: ParametricSurface, places: Floats, way: Floats) -> Floats:
    """The change of the parameters (n, 2) that comes nearest to moving the points by `way` (n, 3)."""
    tangents = surface.tangents(places)
    with np.errstate(all="ignore"):
        return np.einsum("nxi,nx->ni", np.linalg.pinv(np.nan_to_num(tangents)), way)


def _goes_on(first: Floats, row: Floats, normals: Floats) -> bool:
    """Whether a row has finite points that are not much closer together than those of the first one."""
    if not (np.isfinite(row).all() and np.isfinite(normals).all()):
        return False
    gaps = [np.linalg.norm(np.diff(points, axis=0), axis=1) for points in (first, row)]
    return bool((gaps[1] > NARROW * gaps[0]).all())


def _within(vectors: Floats, normals: Floats) -> Floats:
    """Unit vectors in the tangent planes."""
    return unit(vectors - (vectors * normals).sum(axis=1, keepdims=True) * normals)
