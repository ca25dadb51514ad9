"""Parametric surfaces, their blends and blends by a generatrix for pictures: meshes, surfaces beyond, and combs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from pas.algebra.lengths import unit
from pas.algebra.rational import to_float
from pas.arrays import Floats
from pas.mesh.mesh import Mesh
from pas.parametric.blends import ParametricBlend
from pas.parametric.generatrix.blend import GeneratrixBlend
from pas.parametric.generatrix.sphere import SphereBlend
from pas.parametric.maps import Domain
from pas.parametric.nets import extent, finite_domain
from pas.parametric.surface import Forms, ParametricSurface
from pas.render.neighbours import collar, collar_on
from pas.render.scene import BLEND_COLOR, BLEND_TINT, COLORS, TINTS, Comb, Layer, Scene

ALONG = 320
"""Points of a blend's boundaries, and of the surfaces beyond."""

Line = tuple[Floats, Floats]
"""The parameters of a curve's first and last point, (2,) each."""


def lines(domain: Domain, firsts: Iterable[float], seconds: Iterable[float]) -> list[Line]:
    """The lines of a finite domain on which one of the parameters has some value in it."""
    (a, b), (c, d) = domain
    along = [(np.array([a, h]), np.array([b, h])) for h in seconds if c <= h <= d]
    return along + [(np.array([t, c]), np.array([t, d])) for t in firsts]


def combs_on(surface: ParametricSurface, curves: Sequence[Line], mesh: Mesh) -> tuple[Comb, ...]:
    """Combs along curves that are straight in the parameters, without places where there is no curvature.

    They are on the side of the surface to which the normals of its `mesh` point.
    """
    combs, tree = [], cKDTree(mesh.points)
    for start, end in curves:
        places = start + np.linspace(0, 1, 90)[:, None] * (end - start)
        forms = Forms.at(surface, places)
        curvatures, points = forms.along(end - start), surface(places)
        known = np.isfinite(curvatures) & np.isfinite(points).all(axis=1)
        if known.sum() < 2:
            continue
        points, normals, curvatures = points[known], forms.normals[known], curvatures[known]
        side = 1.0 if (mesh.point_normals[tree.query(points)[1]] * normals).sum() >= 0 else -1.0
        combs.append(Comb(points, side * normals, side * curvatures))
    return tuple(combs)


UNKNOWN = "the mesh does not say the parameters of its points, which curvatures need; leave mesh out"


def surface_layers(surface: ParametricSurface, scene: Scene) -> None:
    """Add a surface, in a colour of its own; raises what meshing raises."""
    place = len(scene.layers) % len(COLORS)  # not a colour of a blend before
    layer = _layer(surface, scene, scene.picture.domain, COLORS[place], TINTS[place])
    if scene.picture.combs:
        domain = finite_domain(surface, scene.picture.domain)
        curves = lines(domain, *(np.linspace(*ends, 3) for ends in domain))  # borders, and those in the middle
        layer = replace(layer, combs=combs_on(surface, curves, layer.mesh))
    scene.layers.append(layer)


def blend_layers(blend: ParametricBlend, scene: Scene) -> None:
    """Add a blend and the surfaces that it meets, beside their curves; raises what meshing raises."""
    rectangle = finite_domain(blend.surface, scene.picture.domain)
    layer = _layer(blend.surface, scene, rectangle, BLEND_COLOR, BLEND_TINT)
    if scene.picture.combs:
        curves = lines(rectangle, np.linspace(*rectangle[0], 6), map(to_float, blend.data.values))
        layer = replace(layer, combs=combs_on(blend.surface, curves, layer.mesh))
    scene.layers.append(layer)
    reach, t = _reach(layer.mesh) / 2, np.linspace(*rectangle[0], ALONG)
    low, high = rectangle[1]
    for number, (surface, exact) in enumerate(zip(blend.data.surfaces, blend.data.values, strict=True)):
        value = to_float(exact)
        opacity = 0.35 if low < value < high else 1.0  # the blend touches those in between and leaves again
        for way in [way for way, end in ((-1, high), (1, low)) if low <= value <= high and value != end]:
            places = np.column_stack([t, np.full(ALONG, value)])
            strip = collar_on(surface, places, way * unit(surface.derivative(places, 0, 1)), reach)
            scene.layers += _beside(strip, number, opacity)


def _reach(mesh: Mesh) -> float:
    """How far surfaces beyond a blend are shown."""
    return 0.3 * float(np.ptp(mesh.points, axis=0).max())


def _beside(strip: Mesh | None, number: int, opacity: float = 1.0) -> list[Layer]:
    """The layer of a strip of surface number so and so, where there is one."""
    colors = COLORS[number % len(COLORS)], TINTS[number % len(TINTS)]
    return [] if strip is None else [Layer(strip, *colors, opacity=opacity, aside=True)]


def _layer(surface: ParametricSurface, scene: Scene, domain: Any, color: str, tint: str) -> Layer:
    def make() -> Mesh:
        bounded = surface.with_domain(finite_domain(surface, domain))
        return bounded.mesh(scene.picture.tolerance or scene.picture.coloring.tolerance * extent(bounded)[1])

    mesh = scene.mesh(make)
    return Layer(mesh, color, tint, lambda: principal_on(mesh, surface), outlined=True)


def principal_on(mesh: Mesh, surface: ParametricSurface) -> Floats:
    """The principal curvatures (N, 2) at a mesh's points; raises `ValueError` where it does not know its parameters."""
    if mesh.parameters is None:
        raise ValueError(UNKNOWN)
    return Forms.at(surface, mesh.parameters).principal_for(mesh.point_normals)


def _size(scene: Scene) -> tuple[int, int]:
    """Of a blend's mesh: coarser for curvatures, which are smooth but slow."""
    return (160, 60) if scene.picture.coloring.curved else (ALONG, 120)


def layers(blend: GeneratrixBlend, scene: Scene) -> None:
    """Add a blend and its surfaces beyond the boundaries, where they are known.

    Normals of neighbouring layers agree along the boundaries, so that stripes run on across a contact of order one.
    """
    size, tolerance = _size(scene), scene.picture.tolerance
    mesh = scene.mesh(lambda: blend.mesh(tolerance) if tolerance else blend.mesh(size=size))
    combs = _combs(blend, mesh) if scene.picture.combs else ()
    principal = lambda: principal_on(mesh, blend.surface)  # noqa: E731
    scene.layers.append(Layer(mesh, BLEND_COLOR, BLEND_TINT, principal, combs=combs, outlined=True))
    ends = blend.mesh(size=(ALONG, 2)).point_normals.reshape(ALONG, 2, 3)
    for number, (boundary, sign) in enumerate(zip(blend.boundaries, blend.frames.signs, strict=True)):
        scene.layers += _beside(collar(boundary, sign, _reach(mesh), ends[:, number]), number)


def sphere_layers(blend: SphereBlend, scene: Scene) -> None:
    """Add blends through a sphere, and the surfaces that they come from."""
    size = _size(scene)
    mesh = scene.mesh(lambda: blend.mesh(size=size))
    combs = tuple(comb for part in blend.blends for comb in _combs(part, mesh)) if scene.picture.combs else ()
    principal = lambda: _sphere_curvatures(blend, mesh, size)  # noqa: E731
    scene.layers.append(Layer(mesh, BLEND_COLOR, BLEND_TINT, principal, combs=combs, outlined=True))
    for number, part in enumerate(blend.blends):
        ends = part.mesh(size=(ALONG, 2)).point_normals.reshape(ALONG, 2, 3)
        rim = part.control_points(part.frames.parameters(ALONG))[:, -1]
        outward = np.sign(((rim - np.array(blend.center)) * ends[:, 1]).sum())
        strip = collar(part.boundaries[0], part.frames.signs[0], _reach(mesh), outward * ends[:, 0])
        scene.layers += _beside(strip, number)


def _sphere_curvatures(blend: SphereBlend, mesh: Mesh, size: tuple[int, int]) -> Floats:
    """Principal curvatures (N, 2) at the points of a mesh: grids of the blends one after the other, then the sphere."""
    result, start = np.full((len(mesh.points), 2), 1 / blend.radius), 0
    for part in blend.blends:
        grid, here = part.mesh(size=size), slice(start, start + size[0] * size[1])
        same = grid.points.shape == mesh.points[here].shape and np.allclose(grid.points, mesh.points[here])
        if grid.parameters is None or not same:
            raise ValueError(UNKNOWN)
        forms, start = Forms.at(part.surface, grid.parameters), here.stop
        result[here] = forms.principal_for(mesh.point_normals[here])
    return result


def _combs(blend: GeneratrixBlend, mesh: Mesh) -> tuple[Comb, ...]:
    """Along both boundaries and some generatrices."""
    across = np.linspace(0, 1, 6, endpoint=not blend.closed)
    return combs_on(blend.surface, lines(((0.0, 1.0), (0.0, 1.0)), across, (0.0, 1.0)), mesh)
