"""Where the camera of a picture stands, and what draws it without a window."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from pas.algebra.monomials import Floats
from pas.errors import MissingLibraryError
from pas.limits import checkpoint
from pas.mesh.mesh import Mesh

VIEW_ANGLE, MARGIN = 24.0, 1.12
"""Of the camera, in degrees, and the picture's height over that of what is drawn."""

FOUR_VIEWS = ((0.35, -1.0, 0.45), (0.0, -1.0, 0.0), (1.0, -0.2, 0.3), (0.0, -0.05, 1.0))
"""From where four views look: past the front, from the front, from the right, from above."""

TURNS, RISE, USUAL = 16, 0.55, 1.1
"""Views that are tried, their height over their distance, and by how much another must be better than the first."""


def widest_view(meshes: Sequence[Mesh]) -> tuple[float, float, float]:
    """From where most of the surfaces is seen, among directions all around and a little above."""
    around = np.arange(TURNS) * 2 * np.pi / TURNS - np.pi / 4
    directions = np.stack([np.cos(around), np.sin(around), np.full(TURNS, RISE)], axis=1)
    seen = np.zeros(TURNS)
    for mesh in meshes:
        p = mesh.points[mesh.triangles]
        seen += np.abs(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) @ directions.T).sum(axis=0)
    seen[0] *= USUAL
    x, y, z = directions[int(seen.argmax())].tolist()
    return x, y, z


def look_at(
    plotter: Any, frame: Floats, view: Any, points: Floats, size: tuple[int, int], room: tuple[float, float] = (0, 0)
) -> None:
    """Point the camera so that the points fill the picture, but for `room` on the right and below, over its size."""
    ahead = -np.array(view, dtype=float) @ frame
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, frame[2] if np.linalg.norm(np.cross(ahead, frame[2])) > 1e-6 else frame[1])
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(right, ahead), ahead])
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    center = (low + high) / 2 @ axes
    half = np.tan(np.radians(VIEW_ANGLE / 2))
    width, height = 1 - room[0], 1 - room[1]
    reach = MARGIN * max(float(high[1] - low[1]) / height, float(high[0] - low[0]) / width * size[1] / size[0]) / 2
    plotter.camera.focal_point = tuple(center)
    plotter.camera.position = tuple(center - (reach / half + float(high[2] - low[2]) / 2) * ahead)
    plotter.camera.SetWindowCenter(room[0], -room[1])
    plotter.camera.up = tuple(axes[1])
    plotter.camera.view_angle = VIEW_ANGLE
    plotter.reset_camera_clipping_range()


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
