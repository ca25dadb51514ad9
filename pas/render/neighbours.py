"""The surfaces that a blend continues, as meshes beyond their clips, for pictures.

A surface that does not change along its clip's normal (a pipe) is extruded from the mesh's
boundary curve, any other followed from there straight on, as far as it does not narrow: so both join without a gap.
"""

from __future__ import annotations

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.mesh.field import Integers
from pas.mesh.mesh import Mesh
from pas.parametric.generatrix.frames import connectivity
from pas.render.collar import ROWS, strip
from pas.surface.contact import Contact
from pas.surface.piecewise import PiecewiseSurface

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
