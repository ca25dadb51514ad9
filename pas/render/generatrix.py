"""Blends by a generatrix for pictures: the blend, and its surfaces beyond the boundaries where they are known.

Normals of neighbouring layers agree along the boundaries, so that stripes run on across a contact of order one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pas.algebra.monomials import Floats
from pas.mesh.mesh import Mesh
from pas.parametric.generatrix.blend import GeneratrixBlend
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.sphere import SphereBlend
from pas.parametric.surface import Forms
from pas.render.neighbours import collar
from pas.render.parametric import UNKNOWN, blend_curves, combs_on, principal_on
from pas.render.scene import BLEND_COLOR, BLEND_TINT, COLORS, TINTS, Comb, Layer, Scene

ALONG = 320
"""Points of a blend's boundaries, and of the surfaces beyond."""


def _size(scene: Scene) -> tuple[int, int]:
    """Of a blend's mesh: coarser for curvatures, which are smooth but slow."""
    return (160, 60) if scene.coloring.curved else (ALONG, 120)


def layers(blend: GeneratrixBlend, scene: Scene) -> None:
    """Add a blend and its two surfaces."""
    size = _size(scene)
    mesh = scene.mesh(lambda: blend.mesh(scene.picture.tolerance) if scene.picture.tolerance else blend.mesh(size=size))
    if mesh.parameters is None:
        mesh = replace(mesh, parameters=_on_grid(blend, mesh.points, size))
    reach = 0.3 * float(np.ptp(mesh.points, axis=0).max())
    scene.layers.append(
        Layer(
            mesh,
            BLEND_COLOR,
            BLEND_TINT,
            lambda: principal_on(mesh, blend.surface),
            combs=_combs(blend, mesh) if scene.picture.combs else (),
            outlined=True,
        )
    )
    ends = blend.mesh(size=(ALONG, 2)).point_normals.reshape(ALONG, 2, 3)
    for number, (boundary, sign) in enumerate(zip(blend.boundaries, blend.frames.signs, strict=True)):
        scene.layers += _neighbour(boundary, sign, reach, ends[:, number], number)


def sphere_layers(blend: SphereBlend, scene: Scene) -> None:
    """Add blends through a sphere, and the surfaces that they come from."""
    size = _size(scene)
    mesh = scene.mesh(lambda: blend.mesh(size=size))
    reach = 0.3 * float(np.ptp(mesh.points, axis=0).max())
    combs = [comb for part in blend.blends for comb in _combs(part, mesh)] if scene.picture.combs else []
    scene.layers.append(
        Layer(
            mesh, BLEND_COLOR, BLEND_TINT, lambda: _sphere_curvatures(blend, mesh, size),
            combs=tuple(combs), outlined=True,
        )
    )  # fmt: skip
    for number, part in enumerate(blend.blends):
        ends = part.mesh(size=(ALONG, 2)).point_normals.reshape(ALONG, 2, 3)
        rim = part.control_points(part.frames.parameters(ALONG))[:, -1]
        outward = np.sign(((rim - np.array(blend.center)) * ends[:, 1]).sum())
        scene.layers += _neighbour(part.boundaries[0], part.frames.signs[0], reach, outward * ends[:, 0], number)


def _sphere_curvatures(blend: SphereBlend, mesh: Mesh, size: tuple[int, int]) -> Floats:
    """Principal curvatures (N, 2) at the points of a mesh: grids of the blends one after the other, then the sphere."""
    count = size[0] * size[1]
    result = np.full((len(mesh.points), 2), 1 / blend.radius)
    for number, part in enumerate(blend.blends):
        here = slice(number * count, (number + 1) * count)
        places = _on_grid(part, mesh.points[here], size)
        if places is None:
            raise ValueError(UNKNOWN)
        result[here] = Forms.at(part.surface, places).principal_for(mesh.point_normals[here])
    return result


def _combs(blend: GeneratrixBlend, mesh: Mesh) -> tuple[Comb, ...]:
    """Along both boundaries and some generatrices."""
    return combs_on(blend.surface, blend_curves(((0.0, 1.0), (0.0, 1.0)), (0.0, 1.0), blend.closed), mesh)


def _on_grid(blend: GeneratrixBlend, points: Floats, size: tuple[int, int]) -> Floats | None:
    """The parameters (N, 2) of points (N, 3) of a mesh; None where they are not those of the grid."""
    grid = blend.sheet(size)[0].reshape(-1, 3)
    if points.shape != grid.shape or not np.allclose(points, grid):
        return None
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
    return [Layer(strip, COLORS[number % len(COLORS)], TINTS[number % len(TINTS)], aside=True)]
