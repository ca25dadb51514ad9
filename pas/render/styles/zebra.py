"""Isophotes: stripes along which the normal keeps its angle with a direction.

Across a joint they are broken for C^0, have kinks for GC^1 and are smooth for GC^2.
"""

from __future__ import annotations

import numpy as np

from pas.render.scene import Coloring, Legend, Paint, Scene

STRIPES, TOWARDS = 28, np.array([0.35, 0.85, 0.4]) / np.linalg.norm([0.35, 0.85, 0.4])
"""Dark and bright bands over the range of the isophotes, and the direction that they measure angles from."""


class Zebra(Coloring):
    """Dark and bright bands between isophotes."""

    name = "zebra"
    shows = "isophotes, which show the order of continuity"
    fine = True
    backdrop = ("#aebac4", "#c9d3dc")

    def paint(self, scene: Scene) -> tuple[list[Paint], Legend | None]:
        """Bands over the cosine of the angle between the normal and a direction of the scene's frame."""
        paints = []
        for layer in scene.layers:
            _, _, normals = layer.mesh.shading
            bands = [layer.tint, "black"] * (STRIPES // 2)
            options = {"cmap": bands, "clim": (-1, 1), "n_colors": STRIPES}
            shading = {"specular": 0.0, "ambient": 0.6, "diffuse": 0.4}
            paints.append(Paint(normals @ (TOWARDS @ scene.frame), options | shading))
        return paints, None


ZEBRA = Zebra()
