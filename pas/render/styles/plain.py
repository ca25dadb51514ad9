"""Plain pictures: each layer in its colour."""

from __future__ import annotations

from pas.render.scene import Coloring, Legend, Paint, Scene


class Plain(Coloring):
    """Each layer in its colour."""

    name = "plain"
    shows = "the shape alone"

    def paint(self, scene: Scene) -> tuple[list[Paint], Legend | None]:
        """Nothing but the layers' own colours."""
        return [Paint() for _ in scene.layers], None


PLAIN = Plain()
