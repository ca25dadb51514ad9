"""Blends by a generatrix for pictures: the blend, and its surfaces beyond the boundaries where they are known.

Normals of neighbouring layers agree along the boundaries, so that stripes run on across a contact of order one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pas.algebra.monomials import Floats
from pas.generatrix.blend import GeneratrixBlend
from pas.generatrix.boundary import Boundary
from pas.generatrix.quadrics import SphereBlend
from pas.mesh.mesh import Mesh
from pas.render.collar import collar
from pas.render.layers import BLEND_COLOR, BLEND_TINT, COLORS, TINTS, Layer, mean_curvatures
from pas.render.scene import Scene, Style

GRID, CURVED = (320, 120), (160, 60)
"""Of the blend's mesh; the second for curvatures, which are smooth but slow."""

REACH = 0.3
"""How far the surfaces are shown beyond their curves, over the size of the blend."""


def layers(blend: GeneratrixBlend, scene: Scene) -> None:
    """Add a blend and its two surfaces."""
    curved = scene.style is Style.CURVATURE
    size = CURVED if curved else GRID
    mesh = scene.mesh(lambda: blend.mesh(scene.picture.tolerance) if scene.picture.tolerance else blend.mesh(size=size))
    curvature = mean_curvatures(blend.surface, _parameters(blend, mesh, size)) if curved else None
    reach = REACH * float(np.ptp(mesh.points, axis=0).max())
    scene.layers.append(Layer(mesh, BLEND_COLOR, BLEND_TINT, curvature, outlined=True))
    ends = blend.mesh(size=(GRID[0], 2)).point_normals.reshape(GRID[0], 2, 3)
    for number, (boundary, sign) in enumerate(zip(blend.boundaries, blend.frames.signs, strict=True)):
        scene.layers += _neighbour(boundary, sign, reach, ends[:, number], number)


def sphere_layers(blend: SphereBlend, scene: Scene) -> None:
    """Add blends through a sphere, and the surfaces that they come from."""
    mesh = scene.mesh(lambda: blend.mesh(size=GRID))
    reach = REACH * float(np.ptp(mesh.points, axis=0).max())
    scene.layers.append(Layer(mesh, BLEND_COLOR, BLEND_TINT, outlined=True))
    for number, part in enumerate(blend.blends):
        ends = part.mesh(size=(GRID[0], 2)).point_normals.reshape(GRID[0], 2, 3)
        rim = part.control_points(part.frames.parameters(GRID[0]))[:, -1]
        outward = np.sign(((rim - np.array(blend.center)) * ends[:, 1]).sum())
        scene.layers += _neighbour(part.boundaries[0], part.frames.signs[0], reach, outward * ends[:, 0], number)


def _parameters(blend: GeneratrixBlend, mesh: Mesh, size: tuple[int, int]) -> Floats:
    """The parameters (N, 2) of a mesh's points, those of the grid where the mesh does not know them."""
    if mesh.parameters is not None:
        return mesh.parameters
    s, t = np.meshgrid(blend.frames.parameters(size[0]), np.linspace(0, 1, size[1]), indexing="ij")
    return np.stack([s, t], axis=-1).reshape(-1, 2)


def _neighbour(boundary: Boundary, sign: int, reach: float, normals: Floats, number: int) -> list[Layer]:
    """The surface beyond a boundary, its normals turned to agree with `normals` (n, 3) along it."""
    strip = collar(boundary, sign, reach, len(normals))
    if strip is None:
        return []
    first = strip.point_normals.reshape(len(normals), -1, 3)[:, 0]
    if (first * normals).sum() < 0:
        strip = replace(strip, normals=-strip.normals)
    return [Layer(strip, COLORS[number % len(COLORS)], TINTS[number % len(TINTS)])]
