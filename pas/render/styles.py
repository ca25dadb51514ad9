"""Pictures in the layers' colours, with isophotes, with highlight lines, and coloured by curvature.

Isophotes are stripes along which the normal keeps its angle with a direction.  A highlight line is where the line of
the surface's normal meets one of a family of parallel light lines.

K.-P. Beier and Y. Chen, Highlight-line algorithm for real-time surface-quality assessment (1994).  A light line is
A + s B; the distance between it and the normal's line at P, d = (B x N) . (A - P) / |B x N|, vanishes along the
highlight line.  The lights lie on a cylinder around the shape, as in a tunnel for inspection, and each is seen where
the outward normal points to it: then the lines are spread evenly, whatever the direction of the normal.  Unlike
isophotes they depend on the place, too; across a joint they behave as isophotes do.

Curvatures are those of the polynomials or formulas at the mesh's points, not of the mesh.  They are positive where
the surface bends like a ball whose normals point outwards.  The range of the colours leaves out the most extreme
values, by area, and is symmetric about 0 where the sign changes; the legend names the extremes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fnmatch import filter

import numpy as np

from pas.algebra.lengths import unit
from pas.arrays import Floats
from pas.errors import meant
from pas.mesh.mesh import Mesh
from pas.render.scene import COLORS, Coloring, Layer, Legend, Paint, Scene

PALETTE = ("#e8a33d", *COLORS, "#c9b458")
"""The colours of faces, in turn."""


def face_colors(scene: Scene) -> list[list[str]]:
    """The colours of the faces of each layer, none where the picture gives none.

    Raises `ValueError` for a name of a table that neither a part nor a face has.
    """
    wanted = scene.picture.colors
    if wanted is None:
        return [[] for _ in scene.layers]
    if wanted == "faces":
        return [[PALETTE[n % len(PALETTE)] for n in range(len(layer.mesh.names))] for layer in scene.layers]
    table = {"*": wanted} if isinstance(wanted, str) else wanted
    known: set[str] = set()
    found = []
    for layer in scene.layers:
        colors = []
        for face in layer.mesh.names:
            names = [layer.name, face, f"{layer.name}: {face}"]
            known.update(names)
            colors.append(next((c for n, c in table.items() if filter(names, n)), layer.color))
        found.append(colors)
    for name in table:
        if not filter(list(known), name):
            raise ValueError(f"there is no part or face {name!r}{meant(name, known)}")
    return found


class Plain(Coloring):
    """Each layer in its colour."""

    name = "plain"
    shows = "the shape alone"

    def paint(self, scene: Scene) -> tuple[list[Paint], Legend | None]:
        """The layers' own colours, or those that the picture gives to parts and faces."""
        return [Paint(faces=faces) for faces in face_colors(scene)], None


class Zebra(Coloring):
    """Dark and bright bands between isophotes: across a joint broken for C^0, with kinks for GC^1, smooth for GC^2."""

    name = "zebra"
    shows = "isophotes, which show the order of continuity"
    fine = True
    backdrop = ("#aebac4", "#c9d3dc")

    def paint(self, scene: Scene) -> tuple[list[Paint], Legend | None]:
        """Bands over the cosine of the angle between the normal and a direction of the scene's frame."""
        paints = []
        for layer in scene.layers:
            _, _, normals = layer.mesh.shading
            options = {"cmap": [layer.tint, "black"] * 14, "clim": (-1, 1), "n_colors": 28}
            shading = {"specular": 0.0, "ambient": 0.6, "diffuse": 0.4}
            paints.append(Paint(normals @ (unit((0.35, 0.85, 0.4)) @ scene.frame), options | shading))
        return paints, None


LIGHTS = 36
"""Lines around the cylinder."""


class Highlights(Coloring):
    """Bright lines on dark surfaces."""

    name = "highlights"
    shows = "highlight lines, reflections of parallel lights, which show small dents"
    fine = True
    backdrop = ("#8d99a4", "#c9d3dc")

    def paint(self, scene: Scene) -> tuple[list[Paint], Legend | None]:
        """Bands over the angle at which the normal's line meets the cylinder."""
        from matplotlib.colors import ListedColormap, to_rgb

        axes, center, radius = tunnel(np.concatenate([layer.mesh.points for layer in scene.layers]), scene.frame)
        paints = []
        for layer in scene.layers:
            dark = tuple(0.42 * part for part in to_rgb(layer.color))
            band = [dark] * 7 + [(1.0, 1.0, 1.0)] * 5 + [dark] * 8  # from the middle of two lights to the next one
            colors = ListedColormap(band * (LIGHTS * 3 // 2))
            options = {"cmap": colors, "clim": (-np.pi, 2 * np.pi), "n_colors": colors.N}
            shading = {"specular": 0.0, "ambient": 0.55, "diffuse": 0.5}
            points, triangles, normals = layer.mesh.shading
            angles = meeting_angles(points, normals, axes, center, radius)
            paints.append(Paint(unwrapped(angles[triangles]), options | shading))
        return paints, None


def unwrapped(angles: Floats) -> Floats:
    """Angles (T, 3) at triangles' corners, a turn more where otherwise a triangle would span more than half a turn."""
    wide = np.ptp(angles, axis=1) > np.pi
    return np.where(wide[:, None] & (angles < 0), angles + 2 * np.pi, angles)


def tunnel(points: Floats, frame: Floats) -> tuple[Floats, Floats, float]:
    """The cylinder of lights around points (N, 3): axes (3, 3), the lights' direction last; a centre; the radius."""
    # all lines meet where the normal is along the lights: along no axis, and across the usual views, so that these
    # places are not seen in the middle of a surface
    along = unit((0.75, 0.6, 0.25)) @ frame
    across = unit(np.cross(along, frame[int(np.abs(frame @ along).argmin())]))
    axes = np.stack([across, np.cross(along, across), along])
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    return axes, center, 1.5 * float(np.linalg.norm((points - center) @ axes[:2].T, axis=1).max())


def meeting_angles(points: Floats, normals: Floats, axes: Floats, center: Floats, radius: float) -> Floats:
    """The angles (N,), from -pi to pi, around the cylinder where lines from points (N, 3) along the normals meet it."""
    places, ways = (points - center) @ axes[:2].T, normals @ axes[:2].T
    length = np.maximum(np.linalg.norm(ways, axis=1), 1e-300)
    ways = ways / length[:, None]
    inner = (places * ways).sum(axis=1)
    reach = -inner + np.sqrt(np.maximum(inner**2 + radius**2 - (places**2).sum(axis=1), 0.0))
    met = places + reach[:, None] * ways
    return np.arctan2(met[:, 1], met[:, 0])


PLAIN, ZEBRA, HIGHLIGHTS = Plain(), Zebra(), Highlights()


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
        measured = [None if layer.principal is None else layer.principal() / unit for layer in scene.layers]
        values = [None if principal is None else self.measure(principal) for principal in measured]
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

    def _unit(self, layers: Sequence[Layer]) -> tuple[float, tuple[str, ...]]:
        """The curvature that counts as 1, and how to say so."""
        units = {layer.unit for layer in layers if layer.principal is not None}
        if len(units) == 1 and (unit := units.pop()) is not None:
            return unit, (f"1: curvature{'' if self.power == 1 else '^2'} of the", "thinnest neighbour")
        return 1.0, ("in 1/length" if self.power == 1 else "in 1/length^2",)


def point_areas(mesh: Mesh) -> Floats:
    """The area (N,) that each point of a mesh stands for: a third of its triangles'."""
    return np.bincount(mesh.triangles.ravel(), np.repeat(mesh.areas / 3, 3), len(mesh.points)).astype(float)


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


MEAN = Curvature("mean", "colours by mean curvature", "mean curvature", lambda p: p.mean(axis=1))
CURVATURE = replace(MEAN, name="curvature", shows="the older name of mean")
GAUSS = Curvature("gauss", "colours by Gauss curvature", "Gauss curvature", lambda p: p.prod(axis=1), power=2)
MAX = Curvature("max", "colours by the larger principal curvature", "larger principal\ncurvature", lambda p: p[:, 0])
MIN = Curvature("min", "colours by the smaller principal curvature", "smaller principal\ncurvature", lambda p: p[:, 1])
