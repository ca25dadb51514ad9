"""Pictures of a blend and the surfaces it continues."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from pas.algebra.monomials import Floats
from pas.exchange.files import replacing
from pas.mesh.field import TriangleMesh
from pas.render.neighbours import neighbours
from pas.render.offscreen import offscreen_pyvista
from pas.surface.piecewise import PiecewiseSurface

SIZE = (1200, 900)
BLEND_COLOR, PIPE_COLOR, CURVE_COLOR = "#e8a33d", "#b9c4cf", "#22303c"
STRIPES = 28
"""Dark and bright bands over the range of the isophotes."""

VIEW = (0.62, -0.62, 0.48)
"""From where one looks, in the frame of the contact directions: past the pipes, from above."""


COARSE, FINE = 1e-3, 2e-4
"""Tolerances of the mesh over the extent of the region; stripes show facets that shading hides."""

VIEW_ANGLE, MARGIN = 24.0, 1.12
"""Of the camera, in degrees, and the picture's height over that of what is drawn."""


class Style(Enum):
    """What the colours show."""

    PLAIN = "plain"
    ZEBRA = "zebra"
    CURVATURE = "curvature"


def draw(
    surface: PiecewiseSurface,
    path: str | Path,
    *,
    style: Style = Style.PLAIN,
    mesh: TriangleMesh | None = None,
    size: tuple[int, int] = SIZE,
) -> Path:
    """Draw a surface with its neighbours into a PNG file; returns the path.

    `Style.ZEBRA` shows isophotes, lines of equal angle between normal and a direction: across a
    joint they are broken for C^0, have kinks for GC^1 and are smooth for GC^2.
    `Style.CURVATURE` shows the mean curvature.  `mesh` spares meshing again.

    Raises `ValueError` for another suffix than .png, `MissingLibraryError` without OpenGL.
    """
    if Path(path).suffix.lower() != ".png":
        raise ValueError(f"a picture's name must end in .png, not {Path(path).name!r}")
    if not isinstance(style, Style):
        raise TypeError(f"style must be a pas.render.picture.Style, not {style!r}")
    pyvista = offscreen_pyvista()
    extent = float(np.ptp(surface.partition.points, axis=0).max())
    mesh = mesh or surface.triangulate(extent * (FINE if style is Style.ZEBRA else COARSE))
    others = neighbours(surface, mesh, extent * 0.25)
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
    low, high = ("#aebac4", "#c9d3dc") if style is Style.ZEBRA else ("white", "#dfe8f0")
    plotter.set_background(low, top=high)
    _add(plotter, surface, mesh, others, style)
    _look(plotter, surface, np.concatenate([part.points for part in (mesh, *others)]), size)
    with replacing(path) as temporary:
        plotter.screenshot(str(temporary))
    plotter.close()
    return Path(path)


def _add(plotter: Any, surface: PiecewiseSurface, mesh: TriangleMesh, others: list[TriangleMesh], style: Style) -> None:
    shading = {"smooth_shading": True, "specular": 0.25, "specular_power": 20, "ambient": 0.18}
    if style is Style.ZEBRA:
        for part in (mesh, *others):
            data = part.to_pyvista()
            data["isophotes"] = _isophotes(part.normals, _frame(surface))
            plotter.add_mesh(
                data, scalars="isophotes", cmap=["white", "black"] * (STRIPES // 2), clim=(-1, 1),
                interpolate_before_map=True, show_scalar_bar=False, n_colors=STRIPES, ambient=0.6, diffuse=0.4,
                smooth_shading=True,
            )  # fmt: skip
    elif style is Style.CURVATURE:
        data = mesh.to_pyvista()
        data["mean curvature"] = surface.curvatures(mesh.points)[:, 0]
        limit = max(float(np.nanpercentile(np.abs(data["mean curvature"]), 98)), 1e-12)
        bar = {
            "title": "mean curvature",
            "color": "black",
            "vertical": True,
            "position_x": 0.88,
            "position_y": 0.08,
            "height": 0.45,
            "width": 0.07,
            "title_font_size": 18,
            "label_font_size": 16,
        }
        plotter.add_mesh(
            data, scalars="mean curvature", cmap="coolwarm", clim=(-limit, limit), scalar_bar_args=bar, **shading
        )
        for part in others:
            plotter.add_mesh(part.to_pyvista(), color=PIPE_COLOR, **shading)
    else:
        plotter.add_mesh(mesh.to_pyvista(), color=BLEND_COLOR, **shading)
        for part in others:
            plotter.add_mesh(part.to_pyvista(), color=PIPE_COLOR, **shading)
    rim = mesh.to_pyvista().extract_feature_edges(
        boundary_edges=True, feature_edges=False, non_manifold_edges=False, manifold_edges=False
    )
    if rim.n_points and style is not Style.ZEBRA:
        plotter.add_mesh(rim, color=CURVE_COLOR, line_width=3)
    plotter.enable_anti_aliasing("ssaa")


def _look(plotter: Any, surface: PiecewiseSurface, points: Floats, size: tuple[int, int]) -> None:
    """Point the camera so that the points fill the picture."""
    frame = _frame(surface)
    ahead = -np.array(VIEW) @ frame
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, frame[2])
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(right, ahead), ahead])
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    center = (low + high) / 2 @ axes
    half = np.tan(np.radians(VIEW_ANGLE / 2))
    reach = MARGIN * max(float(high[1] - low[1]), float(high[0] - low[0]) * size[1] / size[0]) / 2
    plotter.camera.focal_point = tuple(center)
    plotter.camera.position = tuple(center - (reach / half + float(high[2] - low[2]) / 2) * ahead)
    plotter.camera.up = tuple(axes[1])
    plotter.camera.view_angle = VIEW_ANGLE
    plotter.reset_camera_clipping_range()


def _isophotes(normals: Floats, frame: Floats) -> Floats:
    direction = np.array([0.35, 0.85, 0.4]) @ frame
    return normals @ (direction / np.linalg.norm(direction))


def _frame(surface: PiecewiseSurface) -> Floats:
    """Unit directions towards the first contacts, completed to a frame by the axes."""
    rows = [c.clip.gradient(np.zeros(3)) for c in surface.contacts] + list(np.eye(3))
    frame: list[Floats] = []
    for row in rows:
        rest = np.array(row, dtype=float)
        for known in frame:
            rest = rest - (rest @ known) * known
        if np.linalg.norm(rest) > 1e-6 * max(float(np.linalg.norm(row)), 1e-300) and len(frame) < 3:
            frame.append(rest / np.linalg.norm(rest))
    return np.array(frame)
