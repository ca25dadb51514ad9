"""Blends by a generatrix for pictures: the blend, and its surfaces beyond the boundaries where they are known.

Normals of neighbouring layers agree along the boundaries, so that stripes run on across a contact of order one.
"""

from __future__ import annotations

import numpy as np

from pas.algebra.monomials import Floats
from pas.generatrix.blend import GeneratrixBlend
from pas.generatrix.boundary import Boundary
from pas.generatrix.quadrics import SphereBlend
from pas.mesh.mesh import Mesh
from pas.render.collar import collar
from pas.render.layers import BLEND_COLOR, BLEND_TINT, COLORS, TINTS, Layer, mean_curvatures

GRID, CURVED = (320, 120), (160, 60)
"""Of the blend's mesh; the second for curvatures, which are smooth but slow."""

REACH = 0.3
"""How far the surfaces are shown beyond their curves, over the size of the blend."""


def generatrix_layers(blend: GeneratrixBlend, mesh: Mesh | None, style: str) -> list[Layer]:
    """The layers of one blend and its two surfaces."""
    curvature = None
    if mesh is None:
        size = CURVED if style == "curvature" else GRID
        mesh = blend.mesh(size=size)
        if style == "curvature":
            s, t = np.meshgrid(blend.frames.parameters(size[0]), np.linspace(0, 1, size[1]), indexing="ij")
            curvature = mean_curvatures(blend.surface, np.stack([s, t], axis=-1).reshape(-1, 2))
    reach = REACH * float(np.ptp(mesh.points, axis=0).max())
    layers = [Layer(mesh, BLEND_COLOR, BLEND_TINT, curvature, outlined=True)]
    ends = blend.mesh(size=(GRID[0], 2)).point_normals.reshape(GRID[0], 2, 3)
    for number, (boundary, sign) in enumerate(zip(blend.boundaries, blend.frames.signs, strict=True)):
        layers += _neighbour(boundary, sign, reach, ends[:, number], number)
    return layers


def sphere_layers(blend: SphereBlend, mesh: Mesh | None) -> list[Layer]:
    """The layers of blends through a sphere, and of the surfaces that they come from."""
    mesh = blend.mesh(size=GRID) if mesh is None else mesh
    reach = REACH * float(np.ptp(mesh.points, axis=0).max())
    layers = [Layer(mesh, BLEND_COLOR, BLEND_TINT, outlined=True)]
    for number, part in enumerate(blend.blends):
        ends = part.mesh(size=(GRID[0], 2)).point_normals.reshape(GRID[0], 2, 3)
        rim = part.control_points(part.frames.parameters(GRID[0]))[:, -1]
        outward = np.sign(((rim - np.array(blend.center)) * ends[:, 1]).sum())
        layers += _neighbour(part.boundaries[0], part.frames.signs[0], reach, outward * ends[:, 0], number)
    return layers


def _neighbour(boundary: Boundary, sign: int, reach: float, normals: Floats, number: int) -> list[Layer]:
    """The surface beyond a boundary, its normals turned to agree with `normals` (n, 3) along it."""
    strip = collar(boundary, sign, reach, len(normals))
    if strip is None:
        return []
    first = strip.point_normals.reshape(len(normals), -1, 3)[:, 0]
    if (first * normals).sum() < 0:
        strip = strip.flipped
    return [Layer(strip, COLORS[number % len(COLORS)], TINTS[number % len(TINTS)])]
