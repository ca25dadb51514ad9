"""Pictures in the layers' colours, with isophotes, and with highlight lines.

Isophotes are stripes along which the normal keeps its angle with a direction.  A highlight line is where the line of
the surface's normal meets one of a family of parallel light lines.

K.-P. Beier and Y. Chen, Highlight-line algorithm for real-time surface-quality assessment (1994).  A light line is
A + s B; the distance between it and the normal's line at P, d = (B x N) . (A - P) / |B x N|, vanishes along the
highlight line.  The lights lie on a cylinder around the shape, as in a tunnel for inspection, and each is seen where
the outward normal points to it: then the lines are spread evenly, whatever the direction of the normal.  Unlike
isophotes they depend on the place, too; across a joint they behave as isophotes do.
"""

from __future__ import annotations

from fnmatch import filter

import numpy as np

from pas.algebra.monomials import Floats
from pas.errors import meant
from pas.render.scene import COLORS, Coloring, Legend, Paint, Scene

PALETTE = ("#e8a33d", *COLORS, "#c9b458")
"""Of faces, in turn."""


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


def _unit(*parts: float) -> Floats:
    return np.array(parts) / np.linalg.norm(parts)


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
            paints.append(Paint(normals @ (_unit(0.35, 0.85, 0.4) @ scene.frame), options | shading))
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
    along = _unit(0.75, 0.6, 0.25) @ frame
    across = np.cross(along, frame[int(np.abs(frame @ along).argmin())])
    across /= np.linalg.norm(across)
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
