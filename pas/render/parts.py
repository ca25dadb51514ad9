"""Pictures of solids and assemblies: four views, isophotes, exploded, cut in half."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from pas.exchange.files import replacing, target
from pas.limits import Report, limited
from pas.mesh.field import Floats
from pas.mesh.mesh import Mesh
from pas.render.offscreen import offscreen_pyvista
from pas.render.picture import look_at
from pas.solid.assembly import Assembly, assembly
from pas.solid.solid import Solid

VIEWS = ((0.35, -1.0, 0.45), (0.0, -1.0, 0.0), (1.0, -0.2, 0.3), (0.0, -0.05, 1.0))
"""From where the four views look: past the front, from the front, from the right, from above."""

STRIPES, TOWARDS = 28, np.array([0.35, 0.85, 0.4]) / np.linalg.norm([0.35, 0.85, 0.4])
"""Bands of isophotes, and the direction that they measure angles from."""

GAP = 0.35
"""Between exploded parts, over the assembly's size."""

SHARP_DEGREES = 35
"""Between triangles of what is cut in half, for an edge to look sharp."""

EDGE_COLOR = "#22303c"


class Look(Enum):
    """What a picture of parts shows."""

    PLAIN = "plain"
    FOUR_VIEWS = "four views"
    ZEBRA = "zebra"
    EXPLODED = "exploded"
    CUT = "cut"


@limited("drawing", "a coarser tolerance")
def draw_parts(
    shape: Solid | Mesh | Assembly,
    path: str | Path,
    *,
    look: Look = Look.PLAIN,
    tolerance: float | None = None,
    size: tuple[int, int] = (1200, 900),
    meshes: dict[str, Mesh] | None = None,
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """Draw a solid or an assembly into a PNG file; returns the path.

    `Look.ZEBRA` shows isophotes, which are smooth across GC^2 joints, have kinks at GC^1 and break at
    GC^0; `Look.EXPLODED` lifts the parts apart; `Look.CUT` leaves out what is in front of the middle
    plane y = const.  `meshes`, by part, spare meshing again.

    Raises `ValueError` for another suffix than .png, `MissingLibraryError` without OpenGL.
    """
    target(path, (".png",), "a picture")
    pyvista = offscreen_pyvista()
    parts = shape if isinstance(shape, Assembly) else assembly(solid=shape)
    found = meshes or parts.meshes(tolerance)
    pictures = [(name, mesh, parts[name].color) for name, mesh in found.items()]
    points = np.concatenate([m.points + _shift(look, place, found) for place, m in enumerate(found.values())])
    grid = (2, 2) if look is Look.FOUR_VIEWS else (1, 1)
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size), shape=grid, border=False)
    for number in range(grid[0] * grid[1]):
        plotter.subplot(number // 2, number % 2)
        plotter.set_background("#dfe5ea", top="white")
        for place, (_, mesh, color) in enumerate(pictures):
            _add(plotter, mesh, color, look, _shift(look, place, found))
        plotter.enable_anti_aliasing("ssaa")
        look_at(plotter, np.eye(3), VIEWS[number], points, (size[0] // grid[1], size[1] // grid[0]))
    with replacing(path) as temporary:
        plotter.screenshot(str(temporary))
    plotter.close()
    return Path(path)


def _shift(look: Look, place: int, meshes: dict[str, Mesh]) -> Floats:
    if look is not Look.EXPLODED:
        return np.zeros(3)
    points = np.concatenate([m.points for m in meshes.values()])
    return np.array([0.0, 0.0, GAP * place * float(np.ptp(points, axis=0).max())])


def _add(plotter: Any, mesh: Mesh, color: str, look: Look, shift: Sequence[float] | Floats) -> None:
    data = mesh.to_pyvista().translate(shift, inplace=False)
    shading = {"smooth_shading": False, "specular": 0.3, "specular_power": 25, "ambient": 0.2}
    if look is Look.CUT:
        whole = mesh.smoothed.to_pyvista()
        middle = float(mesh.points[:, 1].min() + mesh.points[:, 1].max()) / 2
        half = whole.clip_closed_surface(normal=(0, 1, 0), origin=(0, middle, 0))
        smooth = {"smooth_shading": True, "split_sharp_edges": True, "feature_angle": SHARP_DEGREES}
        plotter.add_mesh(half, color=color, **(shading | smooth))
        return
    if look is Look.ZEBRA:
        data["isophotes"] = mesh.shading[2] @ TOWARDS
        plotter.add_mesh(
            data, scalars="isophotes", cmap=["white", "black"] * (STRIPES // 2), clim=(-1, 1), n_colors=STRIPES,
            interpolate_before_map=True, show_scalar_bar=False, ambient=0.6, diffuse=0.4,
        )  # fmt: skip
        return
    plotter.add_mesh(data, color=color, **(shading | {"smooth_shading": True}))
    edges = mesh.feature_edges
    if len(edges):
        import pyvista

        cells = np.concatenate([np.full((len(edges), 1), 2), edges], axis=1)
        lines = pyvista.PolyData(mesh.points + np.asarray(shift), lines=cells.ravel())
        plotter.add_mesh(lines, color=EDGE_COLOR, line_width=1.5, opacity=0.6)
