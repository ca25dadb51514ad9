"""Pictures of shapes of every kind, with the surfaces that blends continue."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from PIL import Image

from pas.algebra.monomials import Floats
from pas.exchange.files import replacing, target
from pas.exchange.picture_options import Picture, PictureOptions
from pas.limits import Report, checkpoint, limited
from pas.mesh.mesh import Mesh
from pas.render.combs import add_combs, hair_length, tips
from pas.render.plotting import add_comb_legend, add_legend, bar, look_at, offscreen_pyvista, room, widest_view
from pas.render.scene import CURVE_COLOR, Layer, Legend, Paint, Scene, scene_of
from pas.shape import Shape


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
    are those of `Picture`: `style`, `combs`, `size`, `view`, `domain`, `tolerance`, `four_views`, `exploded`, `cut`.
    `mesh`, that of the first shape, or of its parts by name, spares meshing again.

    `style` is a `pas.Style` or its name.  "zebra" shows isophotes, lines of equal angle between normal and a direction:
    across a joint they are broken for C^0, have kinks for GC^1 and are smooth for GC^2.  "highlights" shows highlight
    lines (Beier and Chen 1994), the reflections of parallel lights.  "mean", "gauss", "max" and "min" show the mean,
    Gauss, larger and smaller principal curvature, positive where the surface bends like a ball with its normals
    outwards: of blends by patches over the largest curvature of the neighbours, else in 1/length; "curvature" is
    "mean".  `combs=True` adds curvature combs: along sections in the planes of two contacts' axes and along contact
    curves, of parametric surfaces along lines of constant parameters.

    Raises `ValueError` for another suffix than .png, an unknown style, curvature of a kind of shapes that has none and
    what meshing raises, `TypeError` for what is no shape and unknown options, `MissingLibraryError` without OpenGL.
    """
    target(path, (".png",), "a picture")
    picture = Picture.of(options)
    return draw_scene(scene_of(shape, picture, mesh), picture, path)


def draw_scene(scene: Scene, picture: Picture, path: str | Path) -> Path:
    """Draw a scene into a PNG file; returns the path.  Raises `ValueError` for another suffix."""
    target(path, (".png",), "a picture")
    plotter = plotted(offscreen_pyvista(), scene, picture, off_screen=True)
    with closing(plotter), replacing(path) as temporary:
        checkpoint("rendering a picture")
        # the usual level, 6, takes thrice the time for a tenth less
        Image.fromarray(plotter.screenshot(return_img=True)).save(temporary, "png", compress_level=4)
    return Path(path)


def plotted(pyvista: Any, scene: Scene, picture: Picture, *, off_screen: bool, around: Floats | None = None) -> Any:
    """A `pyvista.Plotter` with everything in its place; the camera has room for points `around` (n, 3), if given."""
    grid = (2, 2) if picture.four_views else (1, 1)
    plotter = pyvista.Plotter(off_screen=off_screen, window_size=list(picture.size), shape=grid, border=False)
    try:
        _fill(plotter, scene, picture, grid, around)
    except BaseException:  # pyvista keeps what is not closed
        plotter.close()
        raise
    return plotter


def _fill(plotter: Any, scene: Scene, picture: Picture, grid: tuple[int, int], around: Floats | None) -> None:
    """Put everything into its place in each view."""
    width, height = picture.size
    meshes = [layer.mesh for layer in scene.layers]
    shifts = [_shift(picture, place, meshes) for place in range(len(meshes))]
    paints, legend = picture.coloring.paint(scene)
    hair = hair_length(scene.layers)
    drawn = [np.concatenate([layer.mesh.points, tips(layer, hair)]) for layer in scene.layers]
    points = np.concatenate([d + s for d, s in zip(drawn, shifts, strict=True)]) if around is None else around
    view = scene.view if picture.view is None or around is not None else picture.view
    views = [widest_view(meshes) if view is None else view]
    if picture.four_views:  # past the front, from the front, from the right, from above
        views = [(0.35, -1.0, 0.45), (0.0, -1.0, 0.0), (1.0, -0.2, 0.3), (0.0, -0.05, 1.0)]
    low, high = picture.coloring.backdrop
    size = (width // grid[1], height // grid[0])
    for number, direction in enumerate(views):
        plotter.subplot(number // 2, number % 2)
        plotter.set_background(low, top=high)
        for place in _far_first(meshes, np.array(direction, dtype=float) @ scene.frame):
            checkpoint(f"drawing {len(meshes[place].triangles)} triangles")
            layer, shift = scene.layers[place], shifts[place]
            _add(plotter, layer, paints[place], picture, shift, legend, size[0])
            add_combs(plotter, layer, hair, shift, _cutter(picture, layer.mesh, shift))
        if legend and number == 0:
            add_legend(plotter, legend, size[0])
        if picture.combs and number == 0:
            add_comb_legend(plotter, scene.layers, size[0])
        plotter.enable_anti_aliasing("ssaa")
        look_at(plotter, scene.frame, direction, points, size, room(legend, picture))


def _far_first(meshes: Sequence[Mesh], towards: Floats) -> list[int]:
    """The order in which meshes are drawn, so that what is seen through does not hide what is behind it."""
    return sorted(range(len(meshes)), key=lambda place: float(meshes[place].points.mean(axis=0) @ towards))


def _shift(picture: Picture, place: int, meshes: Sequence[Mesh]) -> Floats:
    if not picture.exploded:
        return np.zeros(3)
    points = np.concatenate([mesh.points for mesh in meshes])
    return np.array([0.0, 0.0, 0.35 * place * float(np.ptp(points, axis=0).max())])


def _add(
    plotter: Any, layer: Layer, paint: Paint, picture: Picture, shift: Floats, legend: Legend | None, width: int
) -> None:
    """Add a layer in its colours, and its lines."""
    opacity = 0.3 if picture.curved and layer.aside else layer.opacity
    shading = {"specular": 0.25, "specular_power": 20, "ambient": 0.18, "smooth_shading": True}
    options: dict[str, Any] = {**shading, "opacity": opacity, "show_scalar_bar": False}
    data = _data(layer.mesh, paint)
    data.translate(shift, inplace=True)
    if paint.values is None:
        options["color"] = layer.color
    else:
        data["shown"] = paint.values.ravel()
        options |= {"scalars": "shown", "interpolate_before_map": True}
        if legend is not None:
            options |= {"show_scalar_bar": True, "scalar_bar_args": bar(legend, width)}
    if picture.cut:
        data = _half(data, layer.mesh)
        options |= {"split_sharp_edges": True, "feature_angle": 35}
    options |= paint.options
    # of what is seen through, the far side comes first
    for culling in (None,) if opacity == 1 else ("front", "back"):
        plotter.add_mesh(data, culling=culling, **options)
    if layer.outlined and not picture.cut and (paint.values is None or legend is not None):
        _add_lines(plotter, layer.mesh, shift)


def _data(mesh: Mesh, paint: Paint) -> Any:
    """The mesh for pyvista, each triangle with points of its own where the values are by triangle."""
    if paint.values is None or paint.values.ndim == 1:
        return mesh.to_pyvista()
    import pyvista

    points, triangles, normals = mesh.shading
    alone = np.arange(triangles.size).reshape(-1, 3).astype(int)
    data = pyvista.PolyData.from_regular_faces(points[triangles].reshape(-1, 3), alone)
    data.point_data.active_normals = normals[triangles].reshape(-1, 3)
    return data


def _half(data: Any, mesh: Mesh) -> Any:
    """What lies behind the middle plane; what is closed is closed by a flat face there."""
    plane = _middle_plane(data.points)
    if mesh.is_closed and "shown" not in data.point_data:
        return mesh.smoothed.to_pyvista().clip_closed_surface(**plane)
    return data.clip(**plane, invert=False)


def _middle_plane(points: Floats) -> dict[str, Any]:
    return {"normal": (0, 1, 0), "origin": (0, float(points[:, 1].min() + points[:, 1].max()) / 2, 0)}


def _cutter(picture: Picture, mesh: Mesh, shift: Floats) -> Any:
    """What becomes of lines on a layer where a picture is cut: some just before the plane are shown, as combs in it."""
    points = mesh.points + shift
    plane = _middle_plane(points - 0.01 * float(np.ptp(points, axis=0).max()))
    return (lambda lines: lines.clip(**plane, invert=False)) if picture.cut else (lambda lines: lines)


def _add_lines(plotter: Any, mesh: Mesh, shift: Floats) -> None:
    """The boundary, and finer the edges between faces."""
    import pyvista

    edges, times = mesh.edges
    for lines, width, opacity in ((edges[times == 1], 3, 1.0), (mesh.feature_edges, 1.5, 0.6)):
        if len(lines):
            cells = np.concatenate([np.full((len(lines), 1), 2), lines], axis=1)
            drawn = pyvista.PolyData(mesh.points + shift, lines=cells.ravel())
            plotter.add_mesh(drawn, color=CURVE_COLOR, line_width=width, opacity=opacity)
