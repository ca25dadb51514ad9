"""Pictures of a blend and the surfaces it continues; those of parametric ones are made in `parametric`."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from pas.algebra.monomials import Floats
from pas.exchange.files import replacing, target
from pas.limits import Report, limited
from pas.mesh.mesh import Mesh
from pas.render.layers import BLEND_COLOR, CURVE_COLOR, PIPE_COLOR, Layer
from pas.render.neighbours import neighbours
from pas.render.offscreen import offscreen_pyvista
from pas.render.parametric import Drawable, parametric_layers, widest_view
from pas.surface.piecewise import PiecewiseSurface

SIZE = (1200, 900)
STRIPES = 28
"""Dark and bright bands over the range of the isophotes."""

VIEW = (0.62, -0.62, 0.48)
"""From where one looks, in the frame of the contact directions: past the pipes, from above."""


COARSE, FINE = 1e-3, 2e-4
"""Tolerances of the mesh over the extent of the region; stripes show facets that shading hides."""

VIEW_ANGLE, MARGIN = 24.0, 1.12
"""Of the camera, in degrees, and the picture's height over that of what is drawn."""

BAR = {
    "title": "mean curvature",
    "color": "black",
    "vertical": True,
    "position_x": 0.88,
    "position_y": 0.08,
    "height": 0.45,
    "width": 0.07,
}
"""Of the colours of curvature."""

FONTS = {"title": 18, "label": 16}
"""Sizes of its letters in a picture of width SIZE[0]."""


class Style(Enum):
    """What the colours show."""

    PLAIN = "plain"
    ZEBRA = "zebra"
    CURVATURE = "curvature"


@limited("drawing", "a coarser mesh of your own")
def draw(
    surface: PiecewiseSurface | Drawable | Sequence[Drawable],
    path: str | Path,
    *,
    style: Style = Style.PLAIN,
    mesh: Mesh | None = None,
    size: tuple[int, int] = SIZE,
    domain: Any = None,
    view: Any = None,
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """Draw a surface with its neighbours into a PNG file; returns the path.

    The surface is a piecewise algebraic one, a parametric surface or blend, a blend by a generatrix or through a
    sphere, or several of these.  A blend is drawn with its surfaces beyond their curves, in other colours, as far as
    they are known; `domain` is that of `ParametricSurface.mesh`
    (for all that are given).

    `Style.ZEBRA` shows isophotes, lines of equal angle between normal and a direction: across a
    joint they are broken for C^0, have kinks for GC^1 and are smooth for GC^2.
    `Style.CURVATURE` shows the mean curvature.  `mesh` spares meshing again; `view` is the direction from where one
    looks, of parametric surfaces in the coordinates, else in the frame of the contact directions.

    Raises `ValueError` for another suffix than .png and what meshing raises, `MissingLibraryError` without OpenGL.
    """
    target(path, (".png",), "a picture")
    if not isinstance(style, Style):
        raise TypeError(f"style must be a pas.render.picture.Style, not {style!r}")
    pyvista = offscreen_pyvista()
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
    low, high = ("#aebac4", "#c9d3dc") if style is Style.ZEBRA else ("white", "#dfe8f0")
    plotter.set_background(low, top=high)
    if isinstance(surface, PiecewiseSurface):
        extent = float(np.ptp(surface.partition.points, axis=0).max())
        mesh = mesh or surface.mesh(extent * (FINE if style is Style.ZEBRA else COARSE))
        others = neighbours(surface, mesh, extent * 0.25)
        layers, frame = _layers(surface, mesh, others, style), _frame(surface)
        meshes: list[Mesh] = [mesh, *others]
    else:
        layers, frame = parametric_layers(surface, mesh, domain, style.value), np.eye(3)
        meshes = [layer.mesh for layer in layers]
        view = widest_view([layer.mesh for layer in layers]) if view is None else view
    for layer in layers:
        _add(plotter, layer, style, frame, size[0] / SIZE[0])
    plotter.enable_anti_aliasing("ssaa")
    look_at(plotter, frame, VIEW if view is None else view, np.concatenate([part.points for part in meshes]), size)
    with replacing(path) as temporary:
        plotter.screenshot(str(temporary))
    plotter.close()
    return Path(path)


def _layers(surface: PiecewiseSurface, mesh: Mesh, others: list[Mesh], style: Style) -> list[Layer]:
    curvature = surface.curvatures(mesh.points)[:, 0] if style is Style.CURVATURE else None
    blend = Layer(mesh, BLEND_COLOR, curvature=curvature, outlined=True)
    return [blend, *(Layer(other, PIPE_COLOR) for other in others)]


def _add(plotter: Any, layer: Layer, style: Style, frame: Floats, scale: float) -> None:
    shading = {
        "smooth_shading": True, "specular": 0.25, "specular_power": 20, "ambient": 0.18, "opacity": layer.opacity,
    }  # fmt: skip
    data = layer.mesh.to_pyvista()
    if style is Style.ZEBRA:
        data["isophotes"] = _isophotes(layer.mesh.shading[2], frame)
        plotter.add_mesh(
            data, scalars="isophotes", cmap=[layer.tint, "black"] * (STRIPES // 2), clim=(-1, 1),
            interpolate_before_map=True, show_scalar_bar=False, n_colors=STRIPES,
            **(shading | {"specular": 0.0, "ambient": 0.6, "diffuse": 0.4}),
        )  # fmt: skip
        return
    if layer.curvature is not None:
        data["mean curvature"] = layer.curvature[layer.mesh.shading_points]
        limit = max(float(np.nanpercentile(np.abs(layer.curvature), 98)), 1e-12)
        fonts = {f"{part}_font_size": round(font * scale) for part, font in FONTS.items()}
        plotter.add_mesh(
            data, scalars="mean curvature", cmap="coolwarm", clim=(-limit, limit), scalar_bar_args=BAR | fonts,
            nan_color="#dddddd", **shading,
        )  # fmt: skip
    else:
        plotter.add_mesh(data, color=layer.color, **shading)
    if layer.outlined:
        rim = data.extract_feature_edges(
            boundary_edges=True, feature_edges=False, non_manifold_edges=False, manifold_edges=False
        )
        if rim.n_points:
            plotter.add_mesh(rim, color=CURVE_COLOR, line_width=3)


def look_at(plotter: Any, frame: Floats, view: Any, points: Floats, size: tuple[int, int]) -> None:
    """Point the camera so that the points fill the picture."""
    ahead = -np.array(view, dtype=float) @ frame
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, frame[2] if np.linalg.norm(np.cross(ahead, frame[2])) > 1e-6 else frame[1])
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
