"""Solids, meshes and parts of assemblies for pictures, and `draw_parts`, the older name of drawing them."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from pathlib import Path
from typing import Any, Unpack

from pas.limits import WorkLimits, limited
from pas.mesh.mesh import Mesh
from pas.render.picture import draw
from pas.render.scene import BLEND_COLOR, Layer, Scene
from pas.shape import Shape


class PartLook(Enum):
    """What a picture of parts shows: the options of `pas.draw`, one at a time."""

    PLAIN = "plain"
    FOUR_VIEWS = "four views"
    ZEBRA = "zebra"
    EXPLODED = "exploded"
    CUT = "cut"


@limited("drawing", "a coarser tolerance")
def draw_parts(
    shape: Shape,
    path: str | Path,
    *,
    look: PartLook = PartLook.PLAIN,
    tolerance: float | None = None,
    size: tuple[int, int] = (1200, 900),
    meshes: Mapping[str, Mesh] | None = None,
    **limits: Unpack[WorkLimits],
) -> Path:
    """`pas.draw` with a look; `meshes`, by part, spare meshing again."""
    styled = look in (PartLook.PLAIN, PartLook.ZEBRA)  # the others are options of their own
    options: Any = {"style": look.value} if styled else {look.name.lower(): True}
    return draw(shape, path, mesh=meshes, tolerance=tolerance, size=size, **options)


def solid_layers(shape: Shape, scene: Scene, name: str = "", color: str = BLEND_COLOR) -> None:
    """Add a solid or a mesh in a colour."""
    mesh = scene.mesh(lambda: shape.mesh(scene.picture.tolerance), name)
    scene.look((0.35, -1.0, 0.45))  # past the front, from above
    scene.layers.append(Layer(mesh, color, outlined=True))


def part_layers(part: Any, scene: Scene, name: str = "") -> None:
    """Add a part in its colour."""
    solid_layers(part.shape, scene, name, part.color)
