"""Where the camera of a picture stands, what its legends say, and what draws it without a window."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from pas.algebra.monomials import Floats
from pas.errors import MissingLibraryError
from pas.exchange.picture_options import Picture
from pas.limits import checkpoint
from pas.mesh.mesh import Mesh
from pas.render.combs import CONCAVE, CONVEX
from pas.render.scene import CURVE_COLOR, Layer, Legend


def widest_view(meshes: Sequence[Mesh]) -> tuple[float, float, float]:
    """From where most of the surfaces is seen, among 16 directions all around and a little above."""
    around = np.arange(16) * np.pi / 8 - np.pi / 4
    directions = np.stack([np.cos(around), np.sin(around), np.full(16, 0.55)], axis=1)
    seen = np.zeros(16)
    for mesh in meshes:
        p = mesh.points[mesh.triangles]
        seen += np.abs(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) @ directions.T).sum(axis=0)
    seen[0] *= 1.1  # another must be so much better
    x, y, z = directions[int(seen.argmax())].tolist()
    return x, y, z


def look_at(
    plotter: Any, frame: Floats, view: Any, points: Floats, size: tuple[int, int], room: tuple[float, float] = (0, 0)
) -> None:
    """Point the camera so that the points fill the picture, but for `room` on the right and below, over its size."""
    angle, margin = 24.0, 1.12  # of the camera, in degrees, and the picture's height over that of what is drawn
    ahead = -np.array(view, dtype=float) @ frame
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, frame[2] if np.linalg.norm(np.cross(ahead, frame[2])) > 1e-6 else frame[1])
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(right, ahead), ahead])
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    center = (low + high) / 2 @ axes
    half = np.tan(np.radians(angle / 2))
    width, height = 1 - room[0], 1 - room[1]
    reach = margin * max(float(high[1] - low[1]) / height, float(high[0] - low[0]) / width * size[1] / size[0]) / 2
    plotter.camera.focal_point = tuple(center)
    plotter.camera.position = tuple(center - (reach / half + float(high[2] - low[2]) / 2) * ahead)
    plotter.camera.SetWindowCenter(room[0], -room[1])
    plotter.camera.up = tuple(axes[1])
    plotter.camera.view_angle = angle
    plotter.reset_camera_clipping_range()


SIDE, FOOT = 0.2, 0.075
"""What legends take of a picture: of its width for a bar, of its height for the line below about combs."""


def room(legend: Legend | None, picture: Picture) -> tuple[float, float]:
    """What legends take of a picture's width, on the right, and height, below."""
    return (SIDE if legend else 0.0), (FOOT if picture.combs else 0.0)


def bar(legend: Legend, width: int) -> dict[str, Any]:
    """The keywords of the bar of colours in a picture of some width."""
    return {
        "position_x": 0.825, "position_y": 0.2, "height": 0.5, "width": 0.06, "vertical": True, "fmt": "%.3g",
        "title": "", "color": CURVE_COLOR, "label_font_size": _letters(18, width),
    }  # fmt: skip


def _letters(size: int, width: int) -> int:
    """Letters that have a size in a picture of the usual width, 1200, in one of another."""
    return max(6, round(size * width / 1200))


def add_legend(plotter: Any, legend: Legend, width: int) -> None:
    """The lines of text above and below the bar."""
    _write(plotter, legend.title, (0.825, 0.74), 24, width)
    _write(plotter, "\n".join(legend.lines), (0.825, 0.17 - 0.03 * len(legend.lines)), 19, width)


def add_comb_legend(plotter: Any, layers: Sequence[Layer], width: int) -> None:
    """The line below a picture with combs: what the hairs are, and how long the longest one is."""
    sizes = [c for layer in layers for comb in layer.combs for c in abs(comb.curvatures).tolist()]
    units = {layer.unit for layer in layers if layer.combs}
    unit = units.pop() if len(units) == 1 else None
    longest = f"{max(sizes, default=0.0) / (unit or 1.0):.3g} {'of the thinnest neighbour' if unit else 'in 1/length'}"
    _write(plotter, f"hairs: normal curvature; the longest: {longest}", (0.02, 0.022), 19, width)
    _write(plotter, "convex", (0.62, 0.022), 19, width, CONVEX)
    _write(plotter, "concave", (0.70, 0.022), 19, width, CONCAVE)


def _write(
    plotter: Any, text: str, place: tuple[float, float], size: int, width: int, color: str = CURVE_COLOR
) -> None:
    actor = plotter.add_text(text, position=place, viewport=True, color=color)
    actor.GetTextProperty().SetFontSize(_letters(size, width))


LIBRARIES = {"libGL.so.1": "libgl1", "libEGL.so.1": "libegl1"}
"""The shared libraries that drawing needs, and Debian's packages of them."""


def offscreen_pyvista() -> Any:
    """The pyvista module, ready to draw without a screen.

    Raises `MissingLibraryError` naming the packages to install.
    """
    missing = [package for library, package in LIBRARIES.items() if not _loads(library)]
    if missing:
        raise MissingLibraryError(
            f"pictures need OpenGL, which is not installed; on Debian: apt-get install {' '.join(missing)}"
        )
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    checkpoint("loading the graphics library")  # which takes seconds on slow machines: looked at between its halves
    import pyvista

    checkpoint()
    import pyvista.plotting

    checkpoint()
    pyvista.OFF_SCREEN = True
    return pyvista


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
