"""Pictures in files, moving ones, in a window, and in notebooks; of blends with the surfaces that they continue.

    import pas

    blend = pas.blend([pas.Pipe((1, 0, 0), "1/3", 1), pas.Pipe((0, 1, 0), "1/4", 1)], order=1)
    blend.draw("blend.png", view="iso", size=(160, 120), dimensions=True)
    pas.animate(lambda t: blend.refit(tension=t), (2, 9), "slimmer.gif", size=(160, 120))

A turntable is `blend.draw("turntable.gif")`.
"""

from __future__ import annotations

import base64
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from html import escape
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar, Unpack

import numpy as np
from scipy.spatial.transform import Rotation

from pas.errors import MissingLibraryError, PasError, optional
from pas.exchange.files import make_folder, replacing, source, target
from pas.exchange.picture_options import Picture, PictureOptions
from pas.limits import Report, checkpoint, in_parts, limited
from pas.mesh.mesh import Mesh
from pas.render.picture import in_place, plotted, view_of
from pas.render.plotting import OWN_WINDOWS, offscreen_pyvista
from pas.render.scene import Scene, scene_of
from pas.shape import Shape

V = TypeVar("V")

TURNTABLE = 36
"""Pictures of a turntable, ten degrees apart."""


@limited("drawing", "a coarser mesh of your own")
def draw(
    shape: Shape | Sequence[Shape],
    path: str | Path,
    *,
    mesh: Mesh | Mapping[str, Mesh] | None = None,
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[PictureOptions],
) -> Path:
    """Draw a shape, or a list of them, into a PNG file, or on a turntable into a GIF file; returns the path.

    A blend is drawn with its surfaces beyond their curves, in other colours, as far as they are known.  `options`
    are those of `Picture`.  `mesh`, that of the first shape, or of its parts by name, spares meshing again.

    `style` is a `pas.Style` or its name.  "zebra" shows isophotes, lines of equal angle between normal and a direction:
    across a joint they are broken for C^0, have kinks for GC^1 and are smooth for GC^2.  "highlights" shows highlight
    lines (Beier and Chen 1994), the reflections of parallel lights.  "mean", "gauss", "max" and "min" show the mean,
    Gauss, larger and smaller principal curvature, positive where the surface bends like a ball with its normals
    outwards: of blends by patches over the largest curvature of the neighbours, else in 1/length; "curvature" is
    "mean".  `combs=True` adds curvature combs: along sections in the planes of two contacts' axes and along contact
    curves, of parametric surfaces along lines of constant parameters.

    Raises `ValueError` for another suffix than .png and .gif, an unknown style, view, colour or name of a part or face,
    curvature of a kind of shapes that has none and what meshing raises, `TypeError` for what is no shape and unknown
    options, `MissingLibraryError` without OpenGL.
    """
    target(path, (".png", ".gif"), "a picture")
    turning = Path(path).suffix.lower() == ".gif"
    picture = _small(options) if turning else Picture.of(options)
    scene = scene_of(shape, picture, mesh)
    return _moving([scene] * TURNTABLE, picture, 360.0, path, 0.06) if turning else draw_scene(scene, picture, path)


def draw_scene(scene: Scene, picture: Picture, path: str | Path) -> Path:
    """Draw a scene into a PNG file; returns the path.  Raises `ValueError` for another suffix."""
    target(path, (".png",), "a picture")
    plotter = plotted(offscreen_pyvista(), scene, picture, off_screen=True)
    with closing(plotter), replacing(path) as temporary:
        checkpoint("rendering a picture")
        _picture(plotter, picture).save(temporary, format="png", compress_level=4)  # quicker than 6
    return Path(path)


def _picture(plotter: Any, picture: Picture) -> Any:
    """What a plotter shows, as an image of PIL; what it is before white, and not before black, is transparent."""
    from PIL import Image

    if not picture.transparent:
        return Image.fromarray(plotter.screenshot(None, return_img=True))
    shots = []
    for color in ("black", "white"):
        plotter.set_background(color, all_renderers=True)
        plotter.render()
        shots.append(plotter.screenshot(None, return_img=True).astype(float))
    alpha = 255 - (shots[1] - shots[0]).max(axis=2, keepdims=True)
    color = np.clip(shots[0] * 255 / np.maximum(alpha, 1), 0, 255)
    return Image.fromarray(np.rint(np.concatenate([color, alpha], axis=2)).astype(np.uint8))


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
    picture = _small(options)
    return _moving(_scenes(function, values, picture), picture, turn, place, pause)


def _small(options: Mapping[str, Any]) -> Picture:
    """The options of moving pictures: a GIF of thirty frames has some 3 MB where no size is given."""
    return Picture.of({"size": (600, 450), **options})


def _moving(scenes: list[Scene], picture: Picture, turn: float, path: str | Path, pause: float) -> Path:
    """The pictures of scenes, from a camera that goes around by `turn` degrees, as a GIF or in a folder."""
    place, frames = Path(path), _frames(scenes, picture, turn)
    if not place.suffix:
        folder = source(path)
        make_folder(folder)
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
    view, frame = view_of(scenes[0], picture)
    around = np.concatenate([points for scene in scenes for points in in_place(scene, picture)])
    if turn:  # the camera sees as much from all sides
        middle = (around.min(axis=0) + around.max(axis=0)) / 2 @ frame.T
        places = around @ frame.T - middle
        angles, far = np.linspace(0, 2 * np.pi, 72), np.linalg.norm(places[:, :2], axis=1).max()
        for_all = [far * np.cos(angles), far * np.sin(angles)]
        heights = (places[:, 2].min(), places[:, 2].max())
        around = np.concatenate([np.stack([*for_all, 0 * angles + z], axis=1) + middle for z in heights]) @ frame
    pyvista, frames = offscreen_pyvista(), []
    for number, scene in enumerate(in_parts(scenes, "drawing")):
        scene.frame = frame
        turned = Rotation.from_euler("z", turn * number / len(scenes), degrees=True).apply(view)
        seen = replace(picture, view=tuple(turned))
        with closing(plotted(pyvista, scene, seen, off_screen=True, around=around)) as plotter:
            frames.append(_picture(plotter, seen))
    return frames


def show(
    shape: Shape | Sequence[Shape],
    *,
    mesh: Mesh | Mapping[str, Mesh] | None = None,
    **options: Unpack[PictureOptions],
) -> None:
    """Show a shape, or a list of them, in a window, to be turned with the mouse; returns when it is closed.

    `mesh` and `options` are those of `pas.draw`.  Raises `MissingLibraryError` where there is no screen.
    """
    picture = Picture.of(options)
    show_scene(scene_of(shape, picture, mesh), picture)


def show_scene(scene: Scene, picture: Picture) -> None:
    """Show a scene in a window; raises `MissingLibraryError` where there is no screen."""
    if sys.platform not in OWN_WINDOWS and not any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")):
        raise MissingLibraryError(
            "a window needs a screen, and there is none here (DISPLAY is not set); draw a picture with pas.draw"
        )
    pyvista = optional("pyvista")
    hidden = os.environ.pop("VTK_DEFAULT_OPENGL_WINDOW", None)  # that of pictures drawn before, without a screen
    try:
        plotted(pyvista, scene, picture, off_screen=False).show()
    finally:
        if hidden is not None:
            os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = hidden


def html(shape: Shape) -> str:
    """A description, the table of the verdicts and a picture; where there can be no picture, why not."""
    return f"<pre>{escape(shape.description)}</pre>{shape.certificate._repr_html_()}{_embedded(shape)}"


def _embedded(shape: Shape) -> str:
    with TemporaryDirectory() as folder:
        try:
            content = draw(shape, Path(folder) / "picture.png", size=(480, 360)).read_bytes()
        except (PasError, ValueError) as error:
            return f"<p>no picture: {escape(str(error))}</p>"
    return f'<img src="data:image/png;base64,{base64.b64encode(content).decode("ascii")}" alt="{escape(repr(shape))}">'
