"""A scene put before the camera: its layers in their colours, with edges, sections, labels and dimensions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pas.algebra.lengths import unit
from pas.arrays import Floats
from pas.errors import optional
from pas.exchange.picture_options import VIEWS, Picture
from pas.limits import checkpoint
from pas.mesh.mesh import Mesh
from pas.render import plotting
from pas.render.scene import Layer, Legend, Paint, Scene


def plotted(pyvista: Any, scene: Scene, picture: Picture, *, off_screen: bool, around: Floats | None = None) -> Any:
    """A `pyvista.Plotter` with everything in its place; the camera has room for points `around` (n, 3), if given."""
    grid = (2, 2) if picture.four_views else (1, 1)
    options: dict[str, Any] = {"window_size": list(picture.size), "border": False, "lighting": "none"}
    plotter = pyvista.Plotter(off_screen=off_screen, shape=grid, **options)
    try:
        _fill(plotter, scene, picture, grid, around)
    except BaseException:  # pyvista keeps what is not closed
        plotter.close()
        raise
    return plotter


def view_of(scene: Scene, picture: Picture) -> tuple[Any, Floats]:
    """The direction (3,) from where one looks, and the frame (3, 3) that it is meant in."""
    if isinstance(picture.view, str):
        return VIEWS[picture.view], np.eye(3)
    view = scene.view if picture.view is None else picture.view
    return plotting.widest_view([layer.mesh for layer in scene.layers]) if view is None else view, scene.frame


def _fill(plotter: Any, scene: Scene, picture: Picture, grid: tuple[int, int], around: Floats | None) -> None:
    """Put everything into its place in each view."""
    width, height = picture.size
    meshes = [layer.mesh for layer in scene.layers]
    plane = _middle_plane(picture, meshes)
    shifts = _shifts(scene, picture)
    paints, legend = picture.coloring.paint(scene)
    hair = plotting.hair_length(scene.layers)
    points = np.concatenate(in_place(scene, picture))
    extent = float(np.ptp(points, axis=0).max())
    first, frame = view_of(scene, picture)
    views = [first]
    if picture.four_views:  # past the front, from the front, from the right, from above
        views = [(0.35, -1.0, 0.45), (0.0, -1.0, 0.0), (1.0, -0.2, 0.3), (0.0, -0.05, 1.0)]
    low, high = picture.coloring.backdrop
    size = (width // grid[1], height // grid[0])
    for number, direction in enumerate(views):
        towards = unit(np.array(direction, dtype=float) @ frame)
        plotter.subplot(number // 2, number % 2)
        plotter.set_background(low, top=None if picture.occlusion else high)  # which takes a gradient for a surface
        plotting.add_lights(plotter)
        # what is seen through does not hide what is behind it, which is drawn before
        for place in sorted(range(len(meshes)), key=lambda n: float(meshes[n].points.mean(axis=0) @ towards)):
            checkpoint(f"drawing {len(meshes[place].triangles)} triangles")
            layer, shift = scene.layers[place], shifts[place]
            before = len(plotter.renderer.actors)
            _add(plotter, layer, paints[place], picture, shift, legend, size[0])
            combs = len(plotter.renderer.actors)
            plotting.add_combs(plotter, layer, hair, shift)
            if plane is not None:
                actors = list(plotter.renderer.actors.values())
                _clip(actors[before:combs], plane, shift)
                _clip(actors[combs:], plane, shift, 0.01 * extent)  # so that combs in it are seen
                colors = {*paints[place].faces}
                _add_section(plotter, layer, plane, shift, colors.pop() if len(colors) == 1 else layer.color)
        if legend and number == 0:
            plotting.add_legend(plotter, legend, size[0])
        if picture.combs and number == 0:
            plotting.add_comb_legend(plotter, scene.layers, size[0])
        seen = points if around is None else around
        if picture.dimensions:
            seen = np.concatenate([seen, plotting.add_dimensions(plotter, points, towards, size[0])])
        if picture.labels:
            plotting.add_labels(plotter, scene.layers, shifts, plane, towards, size[0])
            seen = seen + 0.12 * (seen - (seen.min(axis=0) + seen.max(axis=0)) / 2)  # as words are longer than faces
        if picture.occlusion:
            plotter.enable_ssao(radius=0.08 * extent, bias=0.005 * extent, kernel_size=64)
        plotter.enable_anti_aliasing("ssaa")
        plotting.look_at(
            plotter, frame, direction, seen, size, plotting.room(legend, picture), parallel=picture.parallel
        )


def in_place(scene: Scene, picture: Picture) -> list[Floats]:
    """The points (n, 3) of each layer, with its combs, where they are drawn; where it is cut, those of the rest."""
    hair, plane = plotting.hair_length(scene.layers), _middle_plane(picture, [layer.mesh for layer in scene.layers])
    found = []
    for layer, shift in zip(scene.layers, _shifts(scene, picture), strict=True):
        points = np.concatenate([layer.mesh.points, plotting.tips(layer, hair)])
        if plane is not None:
            depths = (points - plane[1]) @ plane[0]
            ends = layer.mesh.edges[0]
            crossing = ends[depths[ends].prod(axis=1) < 0]
            (a, b), (p, q) = depths[crossing].T, points[crossing].transpose(1, 0, 2)
            points = np.concatenate([points[depths <= 0], p + (a / (a - b))[:, None] * (q - p)])
        found.append(points + shift)
    return found


def _shifts(scene: Scene, picture: Picture) -> Floats:
    """How far each layer is lifted (n, 3): in an exploded picture each a third of the whole above the one before."""
    extent = float(np.ptp(np.concatenate([layer.mesh.points for layer in scene.layers]), axis=0).max())
    step = np.array([0.0, 0.0, 0.35 * extent if picture.exploded else 0.0])
    return np.arange(len(scene.layers))[:, None] * step


def _middle_plane(picture: Picture, meshes: Sequence[Mesh]) -> tuple[Floats, Floats] | None:
    """Where a picture is cut, the direction (3,) of what is taken away, and a point (3,) of the plane in the middle."""
    if picture.cut is False:
        return None
    view = "front" if picture.cut is True else picture.cut
    normal = unit(VIEWS[view] if isinstance(view, str) else view)
    depth = np.concatenate([mesh.points for mesh in meshes]) @ normal
    return normal, (float(depth.min()) + float(depth.max())) / 2 * normal


def _clip(actors: Sequence[Any], plane: tuple[Floats, Floats], shift: Floats, margin: float = 0.0) -> None:
    """Hide what actors, moved by `shift` (3,), have further before a plane than a margin."""
    pyvista = optional("pyvista")
    normal, origin = plane
    for actor in actors:
        actor.mapper.AddClippingPlane(pyvista.generate_plane(-normal, origin + shift + margin * normal))


def _add_section(plotter: Any, layer: Layer, plane: tuple[Floats, Floats], shift: Floats, color: str) -> None:
    """Add the section of a closed mesh by a plane, in a colour, with its outline."""
    if not layer.mesh.is_closed:
        return
    normal, origin = plane
    whole = layer.mesh.smoothed.to_pyvista().clip_closed_surface(normal=-normal, origin=origin).triangulate()
    near = np.abs((whole.points - origin) @ normal) < 1e-6 * float(np.ptp(layer.mesh.points))
    triangles = whole.regular_faces.reshape(-1, 3)
    triangles = triangles[near[triangles].all(axis=1)]
    if not len(triangles):  # the plane misses it
        return
    section = type(whole).from_regular_faces(whole.points + shift, triangles).clean()
    plotter.add_mesh(section, color=color, ambient=0.6, diffuse=0.6)
    plotting.add_lines(plotter, section.extract_feature_edges(feature_edges=False, manifold_edges=False), 2.0)


def _add(
    plotter: Any, layer: Layer, paint: Paint, picture: Picture, shift: Floats, legend: Legend | None, width: int
) -> None:
    """Add a layer in its colours, and its lines."""
    opacity = 0.3 if picture.curved and layer.aside else layer.opacity
    shading = {"specular": 0.12, "specular_power": 20, "ambient": 0.38, "smooth_shading": True}
    options: dict[str, Any] = {**shading, "opacity": opacity, "show_scalar_bar": False}
    data = _data(layer.mesh, paint)
    data.translate(shift, inplace=True)
    if paint.values is not None:
        data["shown"] = paint.values.ravel()
        options |= {"scalars": "shown", "interpolate_before_map": True}
        if legend is not None:
            options |= {"show_scalar_bar": True, "scalar_bar_args": plotting.bar(legend, width)}
    elif paint.faces:
        colors = [[int(color[i : i + 2], 16) for i in (1, 3, 5)] for color in paint.faces]
        data.cell_data["shown"] = np.array(colors, dtype=np.uint8)[layer.mesh.faces]
        options |= {"scalars": "shown", "rgb": True}
    else:
        options["color"] = layer.color
    options |= paint.options
    # of what is seen through, the far side comes first
    for culling in (None,) if opacity == 1 else ("front", "back"):
        plotter.add_mesh(data, culling=culling, **options)
    if layer.outlined and (paint.values is None or legend is not None):
        pyvista, (edges, times) = optional("pyvista"), layer.mesh.edges
        for ends, thickness in ((edges[times == 1], 3.0), (layer.mesh.feature_edges, 2.0)):
            if len(ends):
                places = (layer.mesh.points + shift)[ends].reshape(-1, 3)
                plotting.add_lines(plotter, pyvista.line_segments_from_points(places), thickness)


def _data(mesh: Mesh, paint: Paint) -> Any:
    """The mesh for pyvista, each triangle with points of its own where the values are by triangle."""
    if paint.values is None or paint.values.ndim == 1:
        return mesh.to_pyvista()
    pyvista = optional("pyvista")
    points, triangles, normals = mesh.shading
    alone = np.arange(triangles.size).reshape(-1, 3).astype(int)
    data = pyvista.PolyData.from_regular_faces(points[triangles].reshape(-1, 3), alone)
    data.point_data.active_normals = normals[triangles].reshape(-1, 3)
    return data
