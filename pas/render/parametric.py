"""Parametric surfaces and blends for pictures: the blend, and its surfaces beyond the curves where it meets them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pas.algebra.rational import to_float
from pas.errors import LimitError, PasError
from pas.generatrix.blend import GeneratrixBlend
from pas.generatrix.quadrics import SphereBlend
from pas.mesh.mesh import Mesh
from pas.parametric.blends import ParametricBlend
from pas.parametric.domain import Domain
from pas.parametric.framed import extent
from pas.parametric.meshing import finite_domain
from pas.parametric.surface import ParametricSurface
from pas.render.generatrix import generatrix_layers, sphere_layers
from pas.render.layers import BLEND_COLOR, BLEND_TINT, COLORS, TINTS, Layer, mean_curvatures

Parametric = ParametricSurface | ParametricBlend
Drawable = Parametric | GeneratrixBlend | SphereBlend

REACH = 0.4
"""How far a blend's surfaces are shown beyond their curves, over the range of the blend's second parameter."""

COARSE, FINE = 1e-3, 2e-4
"""Tolerances over the extent: stripes show facets that shading hides."""

THROUGH = 0.35
"""The opacity of surfaces in between: the blend touches them and leaves again."""

TURNS, RISE, USUAL = 16, 0.55, 1.1
"""Views that are tried, their height over their distance, and by how much another must be better than the first."""


def parametric_layers(things: Drawable | Sequence[Drawable], mesh: Mesh | None, domain: Any, style: str) -> list[Layer]:
    """The layers of a picture; `mesh` is that of the first thing.

    Raises `TypeError` for other things, `ValueError` for none, and what meshing raises.
    """
    items = list(things) if isinstance(things, Sequence) else [things]
    if not items:
        raise ValueError("there must be at least one surface to draw")
    layers: list[Layer] = []
    for number, item in enumerate(items):
        known = mesh if number == 0 else None
        if isinstance(item, ParametricBlend):
            layers += _blend_layers(item, known, domain, style)
        elif isinstance(item, GeneratrixBlend):
            layers += generatrix_layers(item, known, style)
        elif isinstance(item, SphereBlend):
            layers += sphere_layers(item, known)
        elif isinstance(item, ParametricSurface):
            place = len(layers) % len(COLORS)  # not a colour of a blend before
            layers.append(_layer(item, known, domain, style, COLORS[place], TINTS[place]))
        else:
            raise TypeError(f"what to draw must be a surface or a blend, not {item!r}")
    return layers


def _layer(surface: ParametricSurface, mesh: Mesh | None, domain: Any, style: str, color: str, tint: str) -> Layer:
    if mesh is None:
        bounded = surface.with_domain(finite_domain(surface, domain))
        mesh = bounded.mesh((FINE if style == "zebra" else COARSE) * extent(bounded))
    curvature = None
    if style == "curvature" and mesh.parameters is not None:
        curvature = mean_curvatures(surface, mesh.parameters)
    return Layer(mesh, color, tint, curvature, outlined=True)


def _blend_layers(blend: ParametricBlend, mesh: Mesh | None, domain: Any, style: str) -> list[Layer]:
    rectangle = finite_domain(blend.surface, domain)
    layers = [_layer(blend.surface, mesh, rectangle, style, BLEND_COLOR, BLEND_TINT)]
    size = float(np.ptp(layers[0].mesh.points, axis=0).max())
    for number in range(len(blend.data.surfaces)):
        found = _neighbour(blend, number, rectangle, size * (FINE if style == "zebra" else COARSE), size)
        if found is not None:
            between = rectangle[1][0] < to_float(blend.data.values[number]) < rectangle[1][1]
            place = number % len(COLORS)
            layers.append(Layer(found, COLORS[place], TINTS[place], opacity=THROUGH if between else 1.0))
    return layers


def _neighbour(blend: ParametricBlend, number: int, rectangle: Domain, tolerance: float, size: float) -> Mesh | None:
    """The part of a surface beside its curve, as far as it has no poles and is not larger than the blend.

    None where there is no such part, or the curve is not within the rectangle.
    """
    surface, value = blend.data.surfaces[number], to_float(blend.data.values[number])
    low, high = rectangle[1]
    if not low <= value <= high:
        return None
    reach = REACH * (high - low)
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


def widest_view(meshes: Sequence[Mesh]) -> tuple[float, float, float]:
    """From where most of the surfaces is seen, among directions all around and a little above."""
    around = np.arange(TURNS) * 2 * np.pi / TURNS - np.pi / 4
    directions = np.stack([np.cos(around), np.sin(around), np.full(TURNS, RISE)], axis=1)
    seen = np.zeros(TURNS)
    for mesh in meshes:
        p = mesh.points[mesh.triangles]
        seen += np.abs(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) @ directions.T).sum(axis=0)
    seen[0] *= USUAL
    x, y, z = directions[int(seen.argmax())].tolist()
    return x, y, z
