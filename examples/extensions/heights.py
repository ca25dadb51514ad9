"""A style of pictures of your own: colours by height, with a legend.

    import heights, pas
    pas.draw(shape, "heights.png", style="heights")

and `pas render FILE.pas.json -o OUT.png --style heights`, where the file has been imported.
"""

from __future__ import annotations

from pas.exchange.picture_options import STYLES
from pas.render.scene import Coloring, Legend, Paint, Scene


class Heights(Coloring):
    """Colours by the third coordinate."""

    name = "heights"
    shows = "how high a point is"

    def paint(self, scene: Scene) -> tuple[list[Paint], Legend | None]:
        """One range of colours for all layers."""
        heights = [layer.mesh.shading[0][:, 2] for layer in scene.layers]
        limits = float(min(h.min() for h in heights)), float(max(h.max() for h in heights))
        paints = [Paint(h, {"cmap": "viridis", "clim": limits}) for h in heights]
        return paints, Legend("height", ("in the model's", "unit"), limits, "viridis")


STYLES.register(Heights())
