"""Layouts for pictures: the sphere of directions, its pieces in colours, and the curves of contacts seen in it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Unpack

import numpy as np
from scipy.spatial import geometric_slerp

from pas.algebra.lengths import unit
from pas.algebra.rational import to_floats
from pas.arrays import Floats
from pas.contacts.contact import ContactLike, as_contact
from pas.exchange.picture_options import Picture, PictureOptions
from pas.layouts.discs import Disc, check_fits
from pas.layouts.nodes import ContactNode
from pas.layouts.sphere import piece_mesh
from pas.mesh.mesh import Mesh
from pas.parametric.generatrix.form import connectivity
from pas.partition.layout import Layout
from pas.render.drawing import draw_scene, show_scene
from pas.render.piecewise import VIEW
from pas.render.scene import CURVE_COLOR, TINTS, Layer, Scene


def layers(layout: Layout, scene: Scene) -> None:
    """Add the pieces, each with its arcs; two that share an arc never have the same colour."""
    whole = scene.mesh(lambda: layout.mesh(scene.picture.tolerance))
    scene.look(VIEW)
    center = np.array(to_floats(layout.center))
    for number, color in enumerate(colors(layout)):
        scene.layers.append(Layer(piece_mesh(whole, center, number), TINTS[color % len(TINTS)]))
    scene.layers.append(Layer(arc_mesh(layout, center), CURVE_COLOR))


def colors(layout: Layout) -> list[int]:
    """A number for each piece, other than those of the pieces beyond its arcs; no more are used than are needed one
    piece after the other."""
    beyond: list[set[int]] = [set() for _ in layout.pieces]
    for arc in layout.arcs:
        beyond[arc.first].add(arc.second)
        beyond[arc.second].add(arc.first)
    found: list[int] = []
    for number, others in enumerate(beyond):
        taken = {found[other] for other in others if other < number}
        found.append(next(color for color in range(len(layout.pieces)) if color not in taken))
    return found


def picture(
    layout: Layout,
    path: str | Path | None = None,
    contacts: Sequence[ContactLike] = (),
    **options: Unpack[PictureOptions],
) -> Path | None:
    """See `Layout.picture`."""
    settings = Picture.of(options)
    scene = Scene(settings)
    layers(layout, scene)
    if len(contacts):
        checked = [as_contact(contact, f"contacts[{i}]") for i, contact in enumerate(contacts)]
        discs = ContactNode.of(checked, layout.center).discs
        check_fits(layout, discs)
        center = np.array(to_floats(layout.center))
        scene.layers += [Layer(disc_mesh(disc, center), "#5d6a75", outlined=True) for disc in discs]
    if path is None:
        show_scene(scene, settings)
        return None
    return draw_scene(scene, settings, path)


def arc_mesh(layout: Layout, center: Floats) -> Mesh:
    """The arcs between pieces as bands a little over the sphere around a centre (3,)."""
    steps, width = 64, 0.014
    bands = []
    for arc in layout.arcs:
        start, end = (unit(np.array(layout.rays[i], dtype=float)) for i in (arc.start, arc.end))
        pole, middle = unit(np.cross(start, end)), geometric_slerp(start, end, np.linspace(0, 1, steps + 1))
        bands.append(unit(np.stack([middle - width / 2 * pole, middle + width / 2 * pole], axis=1)).reshape(-1, 3))
    triangles = np.concatenate(
        [connectivity((steps + 1, 2), False, False) + 2 * (steps + 1) * k for k in range(len(bands))]
    )
    directions = np.concatenate(bands)
    return Mesh.smooth(center + 1.002 * directions, triangles, directions, "arcs")


def disc_mesh(disc: Disc, center: Floats) -> Mesh:
    """The directions inside a contact's curve, a little over the sphere around a centre (3,)."""
    curve, middle = unit(disc.points), disc.direction
    if float(np.cross(curve[0], curve[1]) @ middle) < 0:
        curve = curve[::-1]
    count, rings = len(curve), 12
    shares = np.arange(1, rings + 1)[:, None] / rings
    grid = (middle + shares * (curve - middle)[:, None]).reshape(-1, 3)
    directions = unit(np.concatenate([middle[None], grid]))
    here = 1 + rings * np.arange(count)
    fan = np.stack([np.zeros_like(here), here, np.roll(here, -1)], axis=1)
    triangles = np.concatenate([fan, 1 + connectivity((count, rings), True, True)])
    points = center + 1.004 * directions
    return Mesh.smooth(points, triangles.astype(np.intp), directions, f"contact {disc.number}")
