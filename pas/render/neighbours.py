"""The surfaces that blends continue, as they are drawn beside them: collars along the curves where they meet."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.polynomial import Polynomial
from pas.arrays import Floats, Integers
from pas.contacts.contact import Contact
from pas.contacts.ovals import settled
from pas.mesh.mesh import Mesh
from pas.mesh.rows import area_vectors, off_zero
from pas.mesh.topology import chains
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.form import connectivity
from pas.parametric.surface import ParametricSurface
from pas.piecewise import PiecewiseSurface

ROWS = 40
"""The number of rows of points in a strip beside a curve: enough for stripes to be straight."""


def collar(boundary: Boundary, sign: int, reach: float, normals: Floats) -> Mesh | None:
    """The strip beside a curve, `reach` wide, at as many points as `normals` (n, 3), with which its own agree there.

    `sign` times N x C' (or V) points to the blend.  None where the surface is not known.
    """
    s = np.linspace(0.0, 1.0, len(normals), endpoint=not boundary.closed)
    away, found = -sign * unit(boundary.across(s)), None
    if isinstance(boundary.surface, Polynomial):
        found = _mesh(strip(boundary.surface, boundary(s), away, reach / ROWS), boundary.closed)
    elif boundary.surface is not None and boundary.parameters is not None:
        places = np.broadcast_to(boundary.parameters(boundary.own(s)), (len(s), 2))
        found = collar_on(boundary.surface, places, away, reach, boundary.closed)
    opposed = found is not None and (found.point_normals.reshape(len(s), -1, 3)[:, 0] * normals).sum() < 0
    return found.flipped if found is not None and opposed else found


def collar_on(
    surface: ParametricSurface, places: Floats, away: Floats, reach: float, closed: bool = False
) -> Mesh | None:
    """The strip, `reach` wide, from parameters (n, 2) along unit vectors (n, 3); None where there is none."""
    return _mesh(_parametric(surface, places, away, reach / ROWS), closed)


def _mesh(rows: list[Floats], closed: bool) -> Mesh | None:
    """The mesh of rows of points and normals (2, n, 3), open or closed, its triangles facing the way of the normals.

    None where there are fewer than two.
    """
    if len(rows) < 2:
        return None
    points, normals = (np.stack(parts, axis=1).reshape(-1, 3) for parts in zip(*rows, strict=True))
    triangles = connectivity((rows[0].shape[1], len(rows)), closed, False).copy()
    turned = (area_vectors(points[triangles]) * normals[triangles[:, 0]]).sum(axis=1) < 0
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    return Mesh.smooth(points, triangles, normals)


def strip(f: Polynomial, start: Floats, away: Floats, step: float) -> list[Floats]:
    """Rows of points and normals (2, n, 3) on f = 0, from points `start` (n, 3) along unit vectors `away` (n, 3).

    They end where bringing a point back to the surface by Newton's method moves it by half a step or more.
    """

    def advance(points: Floats, away: Floats) -> Floats | None:
        aimed = points + step * away
        with np.errstate(all="ignore"):
            moved = settled(f, aimed, 4)
        near = np.linalg.norm(moved - aimed, axis=1).max() <= step / 2
        return np.stack([moved, unit(f.gradient(moved))]) if near else None

    return _rows(np.stack([start, unit(f.gradient(start))]), away, advance)


def _parametric(surface: ParametricSurface, places: Floats, away: Floats, step: float) -> list[Floats]:
    """Rows of points and normals (2, n, 3) on a surface, from parameters (n, 2), as far as its domain goes."""
    whole = surface.with_domain(None)
    low, high = np.array(surface.domain).T

    def row() -> Floats:
        return np.stack([whole(places), np.nan_to_num(whole.normals(places))])

    def changed(change: Floats) -> Floats:
        new = np.clip(places + change, low, high)
        return np.where(np.isfinite(new), new, places)

    def advance(before: Floats, away: Floats) -> Floats | None:
        nonlocal places
        middle = changed(_change(whole, places, step / 2 * away))
        new = changed(_change(whole, middle, step * away))
        far = ~(np.linalg.norm(whole(new) - before, axis=1) < 2 * step)  # where the surface is singular they stay
        new[far], old = places[far], places
        places = new
        return None if (places == old).all() else row()

    return _rows(row(), away, advance)


def _rows(first: Floats, away: Floats, advance: Callable[[Floats, Floats], Floats | None]) -> list[Floats]:
    """The first row of points and normals (2, n, 3), and those to which one advances from each along unit vectors."""
    rows = [first]
    while len(rows) <= ROWS and (row := advance(rows[-1][0], away)) is not None and _goes_on(first[0], *row):
        away = _within(row[0] - rows[-1][0], row[1])
        rows.append(row)
    return rows


def _change(surface: ParametricSurface, places: Floats, way: Floats) -> Floats:
    """The change of the parameters (n, 2) that comes nearest to moving the points by `way` (n, 3)."""
    tangents = surface.tangents(places)
    with np.errstate(all="ignore"):
        return np.einsum("nxi,nx->ni", np.linalg.pinv(np.nan_to_num(tangents)), way)


def _goes_on(first: Floats, row: Floats, normals: Floats) -> bool:
    """Whether a row has finite points that are at least a tenth as far apart as those of the first one."""
    if not (np.isfinite(row).all() and np.isfinite(normals).all()):
        return False
    gaps = [np.linalg.norm(np.diff(points, axis=0), axis=1) for points in (first, row)]
    return bool((gaps[1] > 0.1 * gaps[0]).all())


def _within(vectors: Floats, normals: Floats) -> Floats:
    """Unit vectors in the tangent planes."""
    return unit(vectors - (vectors * normals).sum(axis=1, keepdims=True) * normals)


def neighbours(surface: PiecewiseSurface, mesh: Mesh, length: float) -> list[Mesh]:
    """Each contact surface beyond its clip, as far as `length` (model units) from the blend's mesh.

    From each curve of the mesh's boundary the strip goes straight on in the surface.
    """
    result = []
    for contact in (contact.scaled for contact in surface.contacts):
        f = contact.surface
        for chain in chains(contact_rim(contact, mesh)):
            closed = chain[0] == chain[-1]
            start = mesh.points[chain[:-1] if closed else chain]
            away = _within(contact.clip.gradient(start), unit(f.gradient(start)))
            result.append(_mesh(strip(f, start, away, length / ROWS), bool(closed)))
    return [mesh for mesh in result if mesh is not None]


def contact_rim(contact: Contact, mesh: Mesh) -> Integers:
    """The edges (E, 2) of a mesh's boundary that are on a contact's curve, but for rounding."""
    edges, times = mesh.edges
    rim = edges[times == 1]
    near = 1e-7 * (1 + np.abs(mesh.points).max())
    far, ends = np.full(len(mesh.points), np.inf), mesh.points[mesh.boundary]
    far[mesh.boundary] = np.maximum(*(off_zero(p(ends), p.gradient(ends)) for p in (contact.clip, contact.surface)))
    return rim[far[rim].max(axis=1) < near]
