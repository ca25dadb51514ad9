"""Moving pictures: a shape for each of some values, from one camera that may turn, as a GIF or a folder of pictures.

    import pas

    blend = pas.blend([pas.Pipe((1, 0, 0), "1/3", 1), pas.Pipe((0, 1, 0), "1/4", 1)], order=1)
    pas.animate(lambda t: blend.refit(tension=t), (2, 9), "slimmer.gif", size=(160, 120))

A turntable is `pas.animate(lambda _: blend, range(36), "turntable.gif", turn=360)`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import closing
from math import cos, inf, radians, sin
from pathlib import Path
from typing import Any, TypeVar, Unpack

import numpy as np

from pas.algebra.monomials import Floats
from pas.exchange.files import check_folder, replacing, source, target
from pas.exchange.picture_options import Picture, PictureOptions
from pas.limits import Report, checkpoint, limited
from pas.render.picture import plotted
from pas.render.plotting import offscreen_pyvista, widest_view
from pas.render.scene import Scene, scene_of
from pas.shape import Shape

V = TypeVar("V")


@limited("animating", "fewer values or a coarser tolerance")
def animate(
    function: Callable[[V], Shape],
    values: Iterable[V],
    path: str | Path,
    *,
    pause: float = 0.06,
    turn: float = 0.0,
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[PictureOptions],
) -> Path:
    """Draw `function(value)`, a shape, for each of `values`; returns the path.

    A `path` that ends in .gif is a moving picture that begins again at its end, with `pause` seconds between pictures;
    any other is a folder for pictures 0000.png, 0001.png, ...  All are seen by one camera, which goes around them by
    `turn` degrees from the first picture to that after the last.  `options` are those of `pas.draw`.

    Raises `ValueError` for no value and for more than 1000, `TypeError` for a function that gives no shape, and what
    `pas.draw` raises.
    """
    if not 0 < pause < inf:
        raise ValueError(f"pause must be a positive number of seconds, not {pause!r}")
    place = Path(path)
    if place.suffix:
        target(place, (".gif",), "a moving picture")
    picture = Picture.of({"size": (600, 450), **options})  # a GIF of thirty frames then has some 3 MB
    scenes = _scenes(function, values, picture)
    frames = _frames(scenes, picture, turn)
    if not place.suffix:
        folder = source(path)
        folder.mkdir(parents=True, exist_ok=True)
        check_folder(folder)
        for number, frame in enumerate(frames):
            with replacing(folder / f"{number:04d}.png") as temporary:
                frame.save(temporary, format="png")
        return folder
    first, *rest = frames
    with replacing(place) as temporary:
        first.save(
            temporary, format="gif", save_all=True, append_images=rest, loop=0, optimize=False,
            duration=round(1000 * pause),
        )  # fmt: skip
    return place


def _scenes(function: Callable[[V], Shape], values: Iterable[V], picture: Picture) -> list[Scene]:
    """The scenes of all shapes; a shape that comes again is meshed once."""
    known: dict[int, tuple[Shape, Scene]] = {}
    found: list[Scene] = []
    for value in values:
        checkpoint(f"picture {len(found) + 1}")
        if len(found) == 1000:  # all are kept until the camera is known
            raise ValueError("values must be at most 1000")
        shape = function(value)
        if id(shape) not in known:
            known[id(shape)] = shape, scene_of(shape, picture)
        found.append(known[id(shape)][1])
    if not found:
        raise ValueError("values must hold at least one")
    return found


def _frames(scenes: list[Scene], picture: Picture, turn: float) -> list[Any]:
    """The pictures of scenes from one camera."""
    from PIL import Image

    first = scenes[0]
    usual = first.view if picture.view is None else picture.view
    view = np.array(widest_view([layer.mesh for layer in first.layers]) if usual is None else usual, dtype=float)
    around = np.concatenate([layer.mesh.points for scene in scenes for layer in scene.layers])
    pyvista, frames = offscreen_pyvista(), []
    for number, scene in enumerate(scenes):
        checkpoint("drawing", number / len(scenes))
        scene.view, scene.frame = tuple(_turned(view, turn * number / len(scenes))), first.frame
        with closing(plotted(pyvista, scene, picture, off_screen=True, around=around)) as plotter:
            frames.append(Image.fromarray(plotter.screenshot(None, return_img=True)))
    return frames


def _turned(view: Floats, degrees: float) -> Floats:
    """A direction (3,) turned about the last axis."""
    c, s = cos(radians(degrees)), sin(radians(degrees))
    return np.array([c * view[0] - s * view[1], s * view[0] + c * view[1], view[2]])
