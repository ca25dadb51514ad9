"""The camera of a picture, its combs, the words of its legends, and drawing without a window.

Curvature combs are hairs on a curve, as long as the normal curvature along it, and their envelope.  All hairs stand on
the outside, where the surface does not hide them; colours tell convex from concave.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from pas.algebra.lengths import unit
from pas.arrays import Floats
from pas.errors import MissingLibraryError, optional
from pas.exchange.picture_options import Picture
from pas.limits import checkpoint
from pas.mesh.mesh import Mesh
from pas.mesh.rows import area_vectors
from pas.render.scene import CURVE_COLOR, Comb, Layer, Legend

CONVEX, CONCAVE, NEARBY = "#b2182b", "#2166ac", "#22303c"
"""Colours of hairs by sign, as in the colours by curvature, and that of the curves they stand on."""


def hair_length(layers: Sequence[Layer]) -> float:
    """The length of a hair of curvature 1, the same for all of a scene; 0 where all curvatures are.

    95 per cent of the hairs have up to 0.16 of the surface's extent, and none more than 0.4.  Concave hairs longer than
    the radius of curvature, to whose centre they point, would cross: they have up to 0.8 of it, unless hairs would then
    be shorter than 0.4 of the usual length.
    """
    sizes = np.abs(np.concatenate([np.zeros(1), *(comb.curvatures for layer in layers for comb in layer.combs)]))
    if sizes.max() == 0:
        return 0.0
    extent = max(_extent(layer) for layer in layers if layer.combs)
    nearly = float(np.percentile(sizes, 95))
    usual = min(0.16 / nearly if nearly > 0 else np.inf, 0.4 / float(sizes.max())) * extent
    hollow = max(0.0, *(-float(comb.curvatures.min()) for layer in layers for comb in layer.combs))
    return usual if hollow == 0 else max(0.4 * usual, min(usual, 0.8 / hollow**2))


def tips(layer: Layer, factor: float) -> Floats:
    """The ends (n, 3) of a layer's hairs, which a picture must have room for."""
    return np.concatenate([np.empty((0, 3)), *(c.points + _hairs(c, factor) for c in layer.combs)])


def add_combs(plotter: Any, layer: Layer, factor: float, shift: Floats) -> None:
    """Draw a layer's combs, moved by `shift` (3,)."""
    pyvista = optional("pyvista")
    for comb in layer.combs:
        # lifted, so that the surface's triangles do not hide them
        base = comb.points + 0.002 * _extent(layer) * comb.normals + shift
        _add(plotter, pyvista.lines_from_points(base), NEARBY, 2.5)
        for sign, color in ((1, CONVEX), (-1, CONCAVE)):
            for run in _runs(comb.curvatures * sign > 0):
                ends = base[run] + _hairs(comb, factor)[run]
                hairs = np.stack([base[run], ends], axis=1).reshape(-1, 3)
                _add(plotter, pyvista.line_segments_from_points(hairs), color, 1.2)
                crossed = [_crossing(comb, base, first) for first in (int(run[0]) - 1, int(run[-1]))]
                _add(plotter, pyvista.lines_from_points(np.concatenate([crossed[0], ends, crossed[1]])), color, 2.5)


def _crossing(comb: Comb, base: Floats, first: int) -> Floats:
    """The point between a place of a comb and the next, of another sign, where the curvature vanishes, as if it were
    linear between; none (0, 3) beyond the comb's ends."""
    if first < 0 or first + 1 >= len(base):
        return np.empty((0, 3))
    a, b = comb.curvatures[[first, first + 1]]
    return (base[first] + a / (a - b) * (base[first + 1] - base[first]))[None]


def _hairs(comb: Comb, factor: float) -> Floats:
    return factor * np.abs(comb.curvatures)[:, None] * comb.normals


def _runs(there: Any) -> list[Any]:
    """Runs of True, as index arrays."""
    places = np.flatnonzero(there)
    return [run for run in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if len(run)]


def _extent(layer: Layer) -> float:
    return float(np.ptp(layer.mesh.points, axis=0).max())


def _add(plotter: Any, data: Any, color: str, width: float) -> None:
    if data.n_points:
        plotter.add_mesh(data, color=color, line_width=width, lighting=False)


def widest_view(meshes: Sequence[Mesh]) -> tuple[float, float, float]:
    """From where most of the surfaces is seen, among 16 directions all around and a little above."""
    around = np.arange(16) * np.pi / 8 - np.pi / 4
    directions = np.stack([np.cos(around), np.sin(around), np.full(16, 0.55)], axis=1)
    seen = np.zeros(16)
    for mesh in meshes:
        seen += np.abs(area_vectors(mesh.points[mesh.triangles]) @ directions.T).sum(axis=0)
    seen[0] *= 1.1  # another must be so much better
    x, y, z = directions[int(seen.argmax())].tolist()
    return x, y, z


def look_at(
    plotter: Any,
    frame: Floats,
    view: Any,
    points: Floats,
    size: tuple[int, int],
    room: tuple[float, float] = (0, 0),
    *,
    parallel: bool = False,
) -> None:
    """Point the camera so that the points fill the picture, but for `room` on the right and below, over its size."""
    angle, margin = 24.0, 1.12  # of the camera, in degrees, and the picture's height over that of what is drawn
    ahead = -unit(np.array(view, dtype=float) @ frame)
    right = unit(np.cross(ahead, frame[2] if np.linalg.norm(np.cross(ahead, frame[2])) > 1e-6 else frame[1]))
    axes = np.array([right, np.cross(right, ahead), ahead])
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    center = (low + high) / 2 @ axes
    half = np.tan(np.radians(angle / 2))
    width, height = 1 - room[0], 1 - room[1]
    reach = margin * max(float(high[1] - low[1]) / height, float(high[0] - low[0]) / width * size[1] / size[0]) / 2
    far = reach / half + float(high[2] - low[2]) / 2
    plotter.camera.focal_point = tuple(center)
    plotter.camera.position = tuple(center - far * ahead)
    plotter.camera.SetWindowCenter(room[0], -room[1])
    plotter.camera.up = tuple(axes[1])
    plotter.camera.view_angle = angle
    plotter.camera.parallel_scale = reach
    plotter.camera.parallel_projection = parallel
    # not what the plotter would take, which counts what a cut hides, and then tells no depths apart any more
    plotter.camera.clipping_range = (0.8 * reach / half, far + float(high[2] - low[2]))


LIGHTS = {
    "from the camera": ((0.0, 0.0, 1.0), 0.36),
    "from above": ((-0.3, 0.85, 0.45), 0.5),
    "from below on the right": ((0.9, -0.45, 0.35), 0.3),
    "from below on the left": ((-0.7, -0.7, 0.35), 0.25),
}
"""Where from, in the camera's frame (right, up, towards it), and how strongly, so that no side of a shape is dark."""


def add_lights(plotter: Any) -> None:
    """The lights of a view, which go with the camera."""
    pyvista = optional("pyvista")
    for place, intensity in LIGHTS.values():
        light = pyvista.Light(position=place, light_type="camera light", intensity=intensity)
        light.positional = False
        plotter.renderer.add_light(light)


def add_lines(plotter: Any, data: Any, width: float) -> None:
    """Lines on surfaces, drawn whole: nearer to the camera than the triangles that they bound."""
    if data.n_points:
        mapper = plotter.add_mesh(data, color=CURVE_COLOR, line_width=width, lighting=False).mapper
        mapper.SetResolveCoincidentTopologyToPolygonOffset()
        mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0, -40)  # in steps of the depth that is kept


def add_labels(plotter: Any, layers: Sequence[Layer], shifts: Floats, plane: Any, towards: Floats, width: int) -> None:
    """The names of parts, or of the faces of what has none, each where it is seen best from a direction (3,).

    Nothing is written on what is before a `plane` of a cut (its normal and a point), or hidden.
    """
    inner = np.array([(i, j, 6 - i - j) for i in range(1, 5) for j in range(1, 6 - i)]) / 6  # barycentric coordinates
    places, names = [], []
    for layer, shift in zip(layers, shifts, strict=True):
        corners = layer.mesh.points[layer.mesh.triangles]
        across = area_vectors(corners)
        areas = across @ towards
        areas[areas < 0.05 * np.linalg.norm(across, axis=1)] = 0.0
        for number, name in [(None, layer.name)] if layer.name else enumerate(layer.mesh.names):
            here = np.flatnonzero((areas > 0) & ((layer.mesh.faces == number) | (number is None)))
            if len(here) and not layer.aside:
                spots = (inner @ corners[here]).reshape(-1, 3)
                left = _behind(plane, spots)
                mean = np.average(spots, axis=0, weights=np.repeat(areas[here], len(inner)) * left) if left.any() else 0
                order = np.linalg.norm(spots - mean, axis=1).argsort()
                order = order[left[order]]
                for place in spots[order[:: len(order) // 16 + 1]] + shift:  # the best one that nothing hides
                    pairs = zip(layers, shifts, strict=True)
                    if not any(_hides(o.mesh, place - moved, plane, towards) for o, moved in pairs):
                        places.append(place)
                        names.append(name)
                        break
    if names:
        _add_words(plotter, np.array(places), names, width)


def _hides(mesh: Mesh, place: Floats, plane: Any, towards: Floats) -> bool:
    """Whether a mesh, or what a cut leaves of it, is seen before a place (3,) from a direction (3,)."""
    corners = mesh.points[mesh.triangles] - place
    a, b, c = (corner - (corner @ towards)[:, None] * towards for corner in corners.transpose(1, 0, 2))
    sides = np.stack([np.cross(p, q) @ towards for p, q in ((b, c), (c, a), (a, b))])
    around = (sides > 0).all(axis=0) | (sides < 0).all(axis=0)
    depths = (sides * (corners @ towards).T).sum(axis=0)[around] / sides.sum(axis=0)[around]
    near = _behind(plane, place + depths[:, None] * towards)
    return bool((depths[near] > 1e-4 * float(np.ptp(mesh.points))).any())


def _behind(plane: Any, points: Floats) -> Any:
    """Which points (n, 3) a cut by a plane leaves."""
    return np.ones(len(points), dtype=bool) if plane is None else (points - plane[1]) @ plane[0] < 0


def add_dimensions(plotter: Any, points: Floats, towards: Floats, width: int) -> Floats:
    """The sides of the box around points as lines with their lengths; returns points (n, 3) to have room for.

    From a direction (3,) one sees length and width below what is drawn, and the height on its right.
    """
    pyvista = optional("pyvista")
    low, high = points.min(axis=0), points.max(axis=0)
    away = 0.07 * float((high - low).max())
    right = np.cross((0.0, 0.0, 1.0) if abs(towards[2]) < 1 - 1e-9 else (0.0, 1.0, 0.0), towards)
    down, ends, texts = np.cross(right, towards), [], []
    for axis in np.flatnonzero((high > low) & (np.abs(towards) < 1 - 1e-9)):
        out = np.where(np.arange(3) == axis, 0.0, down if axis < 2 else right)
        out = unit(out if np.linalg.norm(out) > 1e-6 else right)
        start = np.where(out < 0, low, high) + away * out
        for end in (low, high):
            ends.append(np.where(np.arange(3) == axis, end, start))
        texts.append(f"{high[axis] - low[axis]:.4g}")
    lines = np.array(ends)
    add_lines(plotter, pyvista.line_segments_from_points(lines), 2)
    plotter.add_points(lines, color=CURVE_COLOR, point_size=_letters(9, width), render_points_as_spheres=True)
    _add_words(plotter, (lines[::2] + lines[1::2]) / 2, texts, width)
    return np.concatenate([lines, points + away * (right + down) / 2])


def _add_words(plotter: Any, places: Floats, words: Sequence[str], width: int) -> None:
    """Words at places (n, 3), before everything."""
    style = {"font_size": _letters(22, width), "text_color": CURVE_COLOR, "shape_color": "white", "shape_opacity": 0.75}
    plotter.add_point_labels(places, words, **style, always_visible=True, show_points=False, margin=4)


SIDE, FOOT = 0.2, 0.075
"""The shares of a picture that legends take: of its width for a bar, of its height for the line below about combs."""


def room(legend: Legend | None, picture: Picture) -> tuple[float, float]:
    """The shares of a picture's width, on the right, and height, below, that legends take."""
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

OWN_WINDOWS = ("win32", "darwin")
"""Systems that bring libraries for graphics, and a screen."""


def offscreen_pyvista() -> Any:
    """The pyvista module, ready to draw without a screen.

    Raises `MissingLibraryError` naming the packages to install.
    """
    if sys.platform not in OWN_WINDOWS:
        missing = [package for library, package in LIBRARIES.items() if not _loads(library)]
        if missing:
            raise MissingLibraryError(
                f"pictures need OpenGL, which is not installed; on Debian: apt-get install {' '.join(missing)}"
            )
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    checkpoint("loading the graphics library")  # which takes seconds on slow machines: looked at between its halves
    pyvista = optional("pyvista")
    checkpoint()
    import_module("pyvista.plotting")
    checkpoint()
    pyvista.OFF_SCREEN = True
    return pyvista


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
