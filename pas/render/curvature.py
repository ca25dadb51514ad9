"""Colours by curvature: mean, Gauss, and the two principal ones, with a legend.

Curvatures are those of the polynomials or formulas at the mesh's points, not of the mesh.  They are positive where
the surface bends like a ball whose normals point outwards.  The range of the colours leaves out the most extreme
values, by area, and is symmetric about 0 where the sign changes; the legend names the extremes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats
from pas.mesh.mesh import Mesh
from pas.render.scene import Coloring, Layer, Legend, Paint, Scene


@dataclass(frozen=True)
class Curvature(Coloring):
    """Colours by a `measure` of the principal curvatures (N, 2), the larger first, a length to the power -`power`."""

    name: str
    shows: str
    title: str
    measure: Callable[[Floats], Floats]
    power: int = 1
    fine: bool = True
    curved: bool = True

    def paint(self, scene: Scene) -> tuple[list[Paint], Legend | None]:
        """One range of colours for all layers of which curvatures are known."""
        unit, words = self._unit(scene.layers)
        values = [self._values(layer, unit) for layer in scene.layers]
        known = [(v, point_areas(layer.mesh)) for v, layer in zip(values, scene.layers, strict=True) if v is not None]
        limits = color_range(*(np.concatenate(parts) for parts in zip(*known, strict=True)))
        cmap = "coolwarm" if limits[0] < 0 < limits[1] else "YlOrRd" if limits[1] > 0 else "YlOrRd_r"
        # little light and shadow, which would make other colours of those of the legend
        shading = {"specular": 0.05, "ambient": 0.65, "diffuse": 0.4}
        options = {"cmap": cmap, "clim": limits, "nan_color": "#dddddd", **shading}
        paints = [
            Paint() if v is None else Paint(v[layer.mesh.shading_points], options)
            for v, layer in zip(values, scene.layers, strict=True)
        ]
        low, high = (float(reduce([reduce(v) for v, _ in known])) for reduce in (np.nanmin, np.nanmax))
        return paints, Legend(self.title, (*words, f"least {low:.3g}", f"most {high:.3g}"), limits, cmap)

    def _values(self, layer: Layer, unit: float) -> Floats | None:
        """The measure at the mesh's points, over the unit."""
        return None if layer.principal is None else self.measure(layer.principal() / unit)

    def _unit(self, layers: Sequence[Layer]) -> tuple[float, tuple[str, ...]]:
        """The curvature that counts as 1, and how to say so."""
        units = {layer.unit for layer in layers if layer.principal is not None}
        if len(units) == 1 and (unit := units.pop()) is not None:
            return unit, (f"1: curvature{'' if self.power == 1 else '^2'} of the", "thinnest neighbour")
        return 1.0, ("in 1/length" if self.power == 1 else "in 1/length^2",)


def point_areas(mesh: Mesh) -> Floats:
    """The area (N,) that each point of a mesh stands for: a third of its triangles'."""
    p = mesh.points[mesh.triangles]
    areas = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1) / 6
    result = np.zeros(len(mesh.points))
    np.add.at(result, mesh.triangles, areas[:, None])
    return result


def color_range(values: Floats, areas: Floats) -> tuple[float, float]:
    """Between which values the colours change: symmetric about 0 where the sign changes.

    They leave out 1/50 of the area at either end; a sign counts where it reaches 1/100 of the other end, and a range
    narrower than 1/50 of its larger end, which may be rounding alone, is widened to it.
    """
    share, flat, signed = 0.02, 0.02, 0.01
    there = np.isfinite(values) & (areas > 0)
    if not there.any():
        return -1.0, 1.0
    order = np.argsort(values[there])
    ranked, part = values[there][order], np.cumsum(areas[there][order])
    low, high = (float(ranked[np.searchsorted(part, s * part[-1])]) for s in (share, 1 - share))
    most = max(abs(low), abs(high))
    if most == 0:
        return -1.0, 1.0
    if min(-low, high) > signed * most:
        return -most, most
    if high - low < flat * most:
        middle, half = (low + high) / 2, flat * most / 2
        return middle - half, middle + half
    return (max(low, 0.0), high) if high == most else (low, min(high, 0.0))


def _mean(principal: Floats) -> Floats:
    return principal.mean(axis=1)


MEAN = Curvature("mean", "colours by mean curvature", "mean curvature", _mean)
CURVATURE = Curvature("curvature", "the older name of mean", "mean curvature", _mean)
GAUSS = Curvature("gauss", "colours by Gauss curvature", "Gauss curvature", lambda p: p.prod(axis=1), power=2)
MAX = Curvature("max", "colours by the larger principal curvature", "larger principal\ncurvature", lambda p: p[:, 0])
MIN = Curvature("min", "colours by the smaller principal curvature", "smaller principal\ncurvature", lambda p: p[:, 1])
