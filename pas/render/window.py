"""Shapes in a window, and in notebooks."""

from __future__ import annotations

import base64
import os
import sys
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Unpack

from pas.errors import MissingLibraryError, PasError, optional
from pas.exchange.picture_options import Picture, PictureOptions
from pas.mesh.mesh import Mesh
from pas.render.drawing import draw
from pas.render.picture import plotted
from pas.render.scene import Scene, scene_of
from pas.shape import Shape


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
    if sys.platform not in ("win32", "darwin") and not any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    ):
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
    """What it is, the table of the verdicts and a picture; where there can be no picture, why not."""
    return f"<pre>{escape(shape.description)}</pre>{shape.certificate._repr_html_()}{_picture(shape)}"


def _picture(shape: Shape) -> str:
    with TemporaryDirectory() as folder:
        try:
            content = draw(shape, Path(folder) / "picture.png", size=(480, 360)).read_bytes()
        except (PasError, ValueError) as error:
            return f"<p>no picture: {escape(str(error))}</p>"
    return f'<img src="data:image/png;base64,{base64.b64encode(content).decode("ascii")}" alt="{escape(repr(shape))}">'
