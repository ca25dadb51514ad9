"""Parametric surfaces and blends for pictures: their meshes, and combs along lines of constant parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.errors import LimitError, PasError
from pas.mesh.mesh import Mesh
from pas.parametric.blends import ParametricBlend
from pas.parametric.maps import Domain
from pas.parametric.nets import extent, finite_domain
from pas.parametric.surface import Forms, ParametricSurface
from pas.render.scene import BLEND_COLOR, BLEND_TINT, COLORS, TINTS, Comb, Layer, Scene

Line = tuple[Floats, Floats]
"""The parameters of a curve's first and last point, (2,) each."""


def surface_curves(domain: Domain) -> list[Line]:
    """The borders of a finite domain and the lines in their middle, each way."""
    (a, b), (c, d) = domain
    first = [(np.array([t, c]), np.array([t, d])) for t in (a, (a + b) / 2, b)]
    return first + [(np.array([a, h]), np.array([b, h])) for h in (c, (c + d) / 2, d)]


def blend_curves(domain: Domain, values: Sequence[float], closed: bool = False) -> list[Line]:
    """The contact curves, which are lines of the second parameter's `values`, and some lines across them.

    `closed`: the first and last line across are one.
    """
    (a, b), (c, d) = domain
    across = np.linspace(a, b, 6, endpoint=not closed)
    contacts = [(np.array([a, h]), np.array([b, h])) for h in values if c <= h <= d]
    return contacts + [(np.array([t, c]), np.array([t, d])) for t in across]


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
        curves = surface_curves(finite_domain(surface, scene.picture.domain))
        layer = replace(layer, combs=combs_on(surface, curves, layer.mesh))
    scene.layers.append(layer)


def blend_layers(blend: ParametricBlend, scene: Scene) -> None:
    """Add a blend and the surfaces that it meets, beside their curves; raises what meshing raises."""
    rectangle = finite_domain(blend.surface, scene.picture.domain)
    layer = _layer(blend.surface, scene, rectangle, BLEND_COLOR, BLEND_TINT)
    if scene.picture.combs:
        curves = blend_curves(rectangle, [to_float(value) for value in blend.data.values])
        layer = replace(layer, combs=combs_on(blend.surface, curves, layer.mesh))
    size = float(np.ptp(layer.mesh.points, axis=0).max())
    scene.layers.append(layer)
    for number in range(len(blend.data.surfaces)):
        found = _neighbour(blend, number, rectangle, size * scene.coloring.tolerance, size)
        if found is not None:
            between = rectangle[1][0] < to_float(blend.data.values[number]) < rectangle[1][1]
            place = number % len(COLORS)
            opacity = 0.35 if between else 1.0  # the blend touches those in between and leaves again
            scene.layers.append(Layer(found, COLORS[place], TINTS[place], opacity=opacity, aside=True))


def _layer(surface: ParametricSurface, scene: Scene, domain: Any, color: str, tint: str) -> Layer:
    def make() -> Mesh:
        bounded = surface.with_domain(finite_domain(surface, domain))
        return bounded.mesh(scene.picture.tolerance or scene.coloring.tolerance * extent(bounded))

    mesh = scene.mesh(make)
    return Layer(mesh, color, tint, lambda: principal_on(mesh, surface), outlined=True)


def principal_on(mesh: Mesh, surface: ParametricSurface) -> Floats:
    """The principal curvatures (N, 2) at a mesh's points; raises `ValueError` where it does not know its parameters."""
    if mesh.parameters is None:
        raise ValueError(UNKNOWN)
    return Forms.at(surface, mesh.parameters).principal_for(mesh.point_normals)


def _neighbour(blend: ParametricBlend, number: int, rectangle: Domain, tolerance: float, size: float) -> Mesh | None:
    """The part of a surface beside its curve, as far as it has no poles and is not larger than the blend.

    None where there is no such part, or the curve is not within the rectangle.
    """
    surface, value = blend.data.surfaces[number], to_float(blend.data.values[number])
    low, high = rectangle[1]
    if not low <= value <= high:
        return None
    reach = 0.4 * (high - low)
    for _ in range(6):
        first = value if value == high else value - reach / (1 if value == low else 2)
        last = value if value == low else value + reach / (1 if value == high else 2)
        inner = max(first, surface.domain[1][0]), min(last, surface.domain[1][1])
        reach /= 2
        if not inner[0] < inner[1]:
            return None
        try:
            mesh = surface.mesh(tolerance, (rectangle[0], inner))
        except LimitError:
            raise
        except PasError:
            continue
        if float(np.ptp(mesh.points, axis=0).max()) <= 1.5 * size:
            return mesh
    return None
