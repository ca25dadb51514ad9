"""Pictures of shapes of every kind, with the surfaces that blends continue."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from pas.algebra.monomials import Floats
from pas.exchange.files import replacing, target
from pas.limits import Report, limited
from pas.mesh.mesh import Mesh
from pas.render.camera import FOUR_VIEWS, look_at, widest_view
from pas.render.layers import CURVE_COLOR, Layer
from pas.render.offscreen import offscreen_pyvista
from pas.render.scene import SIZE, Picture, PictureOptions, Scene, Style, scene_of
from pas.shape import Shape

STRIPES, TOWARDS = 28, np.array([0.35, 0.85, 0.4]) / np.linalg.norm([0.35, 0.85, 0.4])
"""Dark and bright bands over the range of the isophotes, and the direction that they measure angles from."""

GAP = 0.35
"""Between exploded parts, over the size of all."""

SHARP_DEGREES = 35
"""Between triangles of what is cut in half, for an edge to look sharp."""

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

SHADING = {"specular": 0.25, "specular_power": 20, "ambient": 0.18}


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
    """Draw a shape, or a list of them, into a PNG file; returns the path.

    A blend is drawn with its surfaces beyond their curves, in other colours, as far as they are known.  `options`
    are those of `Picture`: `style`, `size`, `view`, `domain`, `tolerance`, `four_views`, `exploded`, `cut`.
    `mesh`, that of the first shape, or of its parts by name, spares meshing again.

    `Style.ZEBRA` shows isophotes, lines of equal angle between normal and a direction: across a
    joint they are broken for C^0, have kinks for GC^1 and are smooth for GC^2.
    `Style.CURVATURE` shows the mean curvature.

    Raises `ValueError` for another suffix than .png and what meshing raises, `TypeError` for what is no shape and
    unknown options, `MissingLibraryError` without OpenGL.
    """
    target(path, (".png",), "a picture")
    picture = Picture.of(options)
    plotter = plotted(offscreen_pyvista(), scene_of(shape, picture, mesh), picture, off_screen=True)
    with replacing(path) as temporary:
        plotter.screenshot(str(temporary))
    plotter.close()
    return Path(path)


def plotted(pyvista: Any, scene: Scene, picture: Picture, *, off_screen: bool) -> Any:
    """A `pyvista.Plotter` with everything in its place."""
    grid = (2, 2) if picture.four_views else (1, 1)
    width, height = picture.size
    plotter = pyvista.Plotter(off_screen=off_screen, window_size=[width, height], shape=grid, border=False)
    meshes = [layer.mesh for layer in scene.layers]
    shifts = [_shift(picture, place, meshes) for place in range(len(meshes))]
    points = np.concatenate([mesh.points + shift for mesh, shift in zip(meshes, shifts, strict=True)])
    view = scene.view if picture.view is None else picture.view
    views = FOUR_VIEWS if picture.four_views else (widest_view(meshes) if view is None else view,)
    low, high = ("#aebac4", "#c9d3dc") if picture.style is Style.ZEBRA else ("white", "#dfe8f0")
    for number, direction in enumerate(views):
        plotter.subplot(number // 2, number % 2)
        plotter.set_background(low, top=high)
        for layer, shift in zip(scene.layers, shifts, strict=True):
            _add(plotter, layer, picture, scene.frame, shift)
        plotter.enable_anti_aliasing("ssaa")
        look_at(plotter, scene.frame, direction, points, (width // grid[1], height // grid[0]))
    return plotter


def _shift(picture: Picture, place: int, meshes: Sequence[Mesh]) -> Floats:
    if not picture.exploded:
        return np.zeros(3)
    points = np.concatenate([mesh.points for mesh in meshes])
    return np.array([0.0, 0.0, GAP * place * float(np.ptp(points, axis=0).max())])


def _add(plotter: Any, layer: Layer, picture: Picture, frame: Floats, shift: Floats) -> None:
    """Add a layer in the colours of the style, and its lines."""
    data, shading = _data(layer, picture, frame), {**SHADING, "smooth_shading": True, "opacity": layer.opacity}
    data.translate(shift, inplace=True)
    if picture.cut:
        data = _half(data, layer.mesh)
        shading |= {"split_sharp_edges": True, "feature_angle": SHARP_DEGREES}
    if "isophotes" in data.point_data:
        plotter.add_mesh(
            data, scalars="isophotes", cmap=[layer.tint, "black"] * (STRIPES // 2), clim=(-1, 1),
            interpolate_before_map=True, show_scalar_bar=False, n_colors=STRIPES,
            **(shading | {"specular": 0.0, "ambient": 0.6, "diffuse": 0.4}),
        )  # fmt: skip
        return
    if "mean curvature" in data.point_data:
        limit = max(float(np.nanpercentile(np.abs(data["mean curvature"]), 98)), 1e-12)
        scale = picture.size[0] / SIZE[0]
        fonts = {f"{part}_font_size": round(font * scale) for part, font in FONTS.items()}
        plotter.add_mesh(
            data, scalars="mean curvature", cmap="coolwarm", clim=(-limit, limit), scalar_bar_args=BAR | fonts,
            nan_color="#dddddd", **shading,
        )  # fmt: skip
    else:
        plotter.add_mesh(data, color=layer.color, **shading)
    if layer.outlined and not picture.cut:
        _add_lines(plotter, layer.mesh, shift)


def _data(layer: Layer, picture: Picture, frame: Floats) -> Any:
    """The mesh for pyvista, with what the colours stand for."""
    data = layer.mesh.to_pyvista()
    if picture.style is Style.ZEBRA:
        data["isophotes"] = np.asarray(data.point_data.active_normals) @ (TOWARDS @ frame)
    if layer.curvature is not None:
        data["mean curvature"] = layer.curvature[layer.mesh.shading_points]
    return data


def _half(data: Any, mesh: Mesh) -> Any:
    """What lies behind the middle plane; what is closed is closed by a flat face there."""
    middle = float(data.points[:, 1].min() + data.points[:, 1].max()) / 2
    plane = {"normal": (0, 1, 0), "origin": (0, middle, 0)}
    if mesh.is_closed and not len(data.point_data.keys()) > 1:
        return mesh.smoothed.to_pyvista().clip_closed_surface(**plane)
    return data.clip(**plane, invert=False)


def _add_lines(plotter: Any, mesh: Mesh, shift: Floats) -> None:
    """The boundary, and finer the edges between faces."""
    import pyvista

    edges, times = mesh.edges
    for lines, width, opacity in ((edges[times == 1], 3, 1.0), (mesh.feature_edges, 1.5, 0.6)):
        if len(lines):
            cells = np.concatenate([np.full((len(lines), 1), 2), lines], axis=1)
            drawn = pyvista.PolyData(mesh.points + shift, lines=cells.ravel())
            plotter.add_mesh(drawn, color=CURVE_COLOR, line_width=width, opacity=opacity)
