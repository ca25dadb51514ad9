"""The surfaces that a blend continues, as meshes beyond their clips, for pictures.

A surface that does not change along its clip's normal (a pipe) is extruded from the mesh's
boundary curve, so that it joins without a gap.  Any other is meshed in the box beyond its clip,
where that is a plane normal to an axis; otherwise it is left out.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.mesh.field import Integers
from pas.mesh.mesh import Mesh
from pas.partition.single_cell import SingleCell
from pas.surface.contact import Contact
from pas.surface.piecewise import PiecewiseSurface

NEIGHBOUR_TOLERANCE = 1e-3
"""Of a neighbour's mesh, over its length."""

NEAR = 1e-7
"""Distance from a contact's curve below which a point of the boundary is on it, over the size of its coordinates."""

RINGS = 24
"""Rings of triangles along an extruded neighbour: enough for stripes to be straight."""


def neighbours(surface: PiecewiseSurface, mesh: Mesh, length: float) -> list[Mesh]:
    """Each cylindrical contact surface, extruded by `length` (model units) from the blend's mesh."""
    result = []
    for contact in surface.contacts:
        rim = contact_rim(contact, mesh)
        if not len(rim):
            continue
        if not _is_cylinder(contact.surface, contact.clip):
            result += _beyond(contact, surface, length)
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


def _beyond(contact: Contact, surface: PiecewiseSurface, length: float) -> list[Mesh]:
    """The contact surface on the far side of its clip, in a box `length` wider than the region."""
    slope = [contact.clip.diff(i).at((0, 0, 0)) for i in range(3)]
    axis = next((i for i in range(3) if slope[i] != 0), None)
    if contact.clip.degree != 1 or axis is None or sum(s != 0 for s in slope) > 1:
        return []
    reach = Fraction(length)
    lower, upper = (
        [Fraction(v) + side * reach for v in bound]
        for bound, side in ((surface.partition.points.min(axis=0), -1), (surface.partition.points.max(axis=0), 1))
    )
    plane = -contact.clip.at((0, 0, 0)) / slope[axis]
    if slope[axis] > 0:
        lower[axis], upper[axis] = plane, plane + 2 * reach
    else:
        lower[axis], upper[axis] = plane - 2 * reach, plane
    alone = PiecewiseSurface.from_polynomials(SingleCell(lower, upper), [], 0, [contact.surface])
    return [alone.mesh(length * NEIGHBOUR_TOLERANCE)]


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
    faces = np.concatenate(triangles)
    p = grid[faces]
    turned = (np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) * normals[faces[:, 0]]).sum(axis=1) < 0
    faces[turned] = faces[turned][:, [0, 2, 1]]
    return Mesh.smooth(grid, faces, normals)
