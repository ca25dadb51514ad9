"""The surfaces that blends continue, as they are drawn beside them: collars along the curves where they meet."""

from __future__ import annotations

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.contacts.contact import Contact
from pas.mesh.mesh import Mesh
from pas.mesh.rows import Integers
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.form import connectivity
from pas.parametric.surface import ParametricSurface
from pas.piecewise import PiecewiseSurface

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
    """A collar on a parametric surface, from parameters (n, 2), as far as its domain goes."""
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


NEAR = 1e-7
"""Distance from a contact's curve below which a point of the boundary is on it, over the size of its coordinates."""

RINGS = 24
"""Rings of triangles along an extruded neighbour: enough for stripes to be straight."""


def neighbours(surface: PiecewiseSurface, mesh: Mesh, length: float) -> list[Mesh]:
    """Each cylindrical contact surface, extruded by `length` (model units) from the blend's mesh."""
    result = []
    for contact in (contact.scaled for contact in surface.contacts):
        rim = contact_rim(contact, mesh)
        if not len(rim):
            continue
        if not _is_cylinder(contact.surface, contact.clip):
            result += _strips(contact, mesh.points, rim, length)
        else:
            direction = contact.clip.gradient(mesh.points[rim[0, 0]])
            direction = direction / np.linalg.norm(direction)
            result.append(_extruded(contact.surface, mesh.points, rim, direction * length))
    return result


def contact_rim(contact: Contact, mesh: Mesh) -> Integers:
    """The edges (E, 2) of a mesh's boundary that are on a contact's curve."""
    edges, times = mesh.edges
    rim = edges[times == 1]
    near = NEAR * (1 + np.abs(mesh.points).max())
    far, ends = np.full(len(mesh.points), np.inf), mesh.points[mesh.boundary]
    far[mesh.boundary] = np.maximum(_distance(contact.clip, ends), _distance(contact.surface, ends))
    return rim[far[rim].max(axis=1) < near]


def _distance(polynomial: Polynomial, points: Floats) -> Floats:
    """First-order distances of points (N, 3) from the zero set of a polynomial."""
    slope = np.linalg.norm(polynomial.gradient(points), axis=1)
    return np.abs(polynomial(points)) / np.maximum(slope, 1e-300)


def _is_cylinder(surface: Polynomial, clip: Polynomial) -> bool:
    """Whether the surface is constant along the normal of a plane clip, exactly."""
    if clip.degree != 1:
        return False
    slope = [clip.diff(i).raw for i in range(3)]
    change = sum((surface.diff(i).raw * s for i, s in enumerate(slope)), GENERATORS[0] * 0)
    return bool(change.is_zero())


def _strips(contact: Contact, points: Floats, rim: Integers, length: float) -> list[Mesh]:
    """The contact surface beyond its clip, from each closed curve of the mesh's boundary straight on in the surface."""
    f, found = contact.surface, []
    for ring in _rings(rim):
        start = points[ring]
        normals = unit(f.gradient(start))
        slope = contact.clip.gradient(start)
        away = unit(slope - (slope * normals).sum(axis=1, keepdims=True) * normals)
        rows = strip(f, start, away, length / ROWS)
        if len(rows) > 1:
            places, turned = (np.stack(parts, axis=1).reshape(-1, 3) for parts in zip(*rows, strict=True))
            found.append(_outwards(places, connectivity((len(ring), len(rows)), True, False), turned))
    return found


def _outwards(points: Floats, triangles: Integers, normals: Floats) -> Mesh:
    """A mesh whose triangles all face the way their vertices' normals (N, 3) point."""
    p = points[triangles]
    turned = (np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) * normals[triangles[:, 0]]).sum(axis=1) < 0
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    return Mesh.smooth(points, triangles, normals)


def _rings(rim: Integers) -> list[Integers]:
    """The closed curves that edges (E, 2) make, as vertices in order; curves with ends or branches are left out."""
    beside: dict[int, list[int]] = {}
    for a, b in rim.tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    found, left = [], set(beside)
    while left:
        ring = [left.pop()]
        while ahead := [v for v in beside[ring[-1]] if v in left]:
            ring.append(ahead[0])
            left.remove(ahead[0])
        if all(len(beside[v]) == 2 for v in ring) and ring[0] in beside[ring[-1]]:
            found.append(np.array(ring))
    return found


def _extruded(surface: Polynomial, points: Floats, rim: Integers, shift: Floats) -> Mesh:
    vertices, inverse = np.unique(rim, return_inverse=True)
    ring, count = inverse.reshape(-1, 2), len(vertices)
    steps = np.linspace(0.0, 1.0, RINGS + 1)
    grid = (points[vertices] + steps[:, None, None] * shift).reshape(-1, 3)
    triangles = []
    for row in range(RINGS):
        a, b = ring[:, 0] + row * count, ring[:, 1] + row * count
        triangles += [np.stack([a, b, b + count], axis=1), np.stack([a, b + count, a + count], axis=1)]
    normals = surface.gradient(grid)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return _outwards(grid, np.concatenate(triangles), normals)
