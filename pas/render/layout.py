"""Layouts for pictures: the sphere of directions, its pieces in colours, and the curves of contacts seen in it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Unpack

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.rational import to_floats
from pas.contacts.contact import ContactLike, as_contact
from pas.exchange.picture_options import Picture, PictureOptions
from pas.layouts.discs import Disc, angle_between, check_fits
from pas.layouts.nodes import ContactNode
from pas.layouts.sphere import piece_mesh
from pas.mesh.mesh import Mesh
from pas.partition.layout import Layout
from pas.render.picture import draw_scene
from pas.render.scene import CURVE_COLOR, TINTS, Layer, Scene
from pas.render.window import show_scene

VIEW = (0.62, -0.62, 0.48)
"""From where one looks: as at blends."""

STEPS, WIDTH, OVER = 64, 0.014, 1.002
"""Of an arc: the rectangles of its band, its width (radians) and the radius at which it lies."""

DISC, RAISED, RINGS = "#5d6a75", 1.004, 12
"""The colour of the directions inside a contact's curve, the radius at which they lie over the sphere, and the rings
of triangles of which they are made."""


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
        scene.layers += [Layer(disc_mesh(disc, center), DISC, outlined=True) for disc in discs]
    if path is None:
        show_scene(scene, settings)
        return None
    return draw_scene(scene, settings, path)


def arc_mesh(layout: Layout, center: Floats) -> Mesh:
    """The arcs between pieces as bands a little over the sphere around a centre (3,)."""
    bands = []
    for arc in layout.arcs:
        start, end = (unit(np.array(layout.rays[i], dtype=float)) for i in (arc.start, arc.end))
        pole = unit(np.cross(start, end))
        angles = np.linspace(0, angle_between(start, end), STEPS + 1)[:, None]
        middle = np.cos(angles) * start + np.sin(angles) * np.cross(pole, start)
        bands.append(unit(np.stack([middle - WIDTH / 2 * pole, middle + WIDTH / 2 * pole], axis=1)).reshape(-1, 3))
    low = 2 * np.arange(STEPS)[:, None]
    one = np.concatenate([low + (0, 2, 3), low + (0, 3, 1)])
    triangles = np.concatenate([one + 2 * (STEPS + 1) * number for number in range(len(bands))])
    directions = np.concatenate(bands)
    return Mesh.smooth(center + OVER * directions, triangles.astype(np.intp), directions, "arcs")


def disc_mesh(disc: Disc, center: Floats) -> Mesh:
    """The directions inside a contact's curve, a little over the sphere around a centre (3,)."""
    curve, middle = unit(disc.points), disc.direction
    if float(np.cross(curve[0], curve[1]) @ middle) < 0:
        curve = curve[::-1]
    count = len(curve)
    shares = np.arange(1, RINGS + 1)[:, None, None] / RINGS
    directions = unit(np.concatenate([middle[None], (middle + shares * (curve - middle)).reshape(-1, 3)]))
    here = np.arange(count)
    after = (here + 1) % count
    triangles = [np.stack([np.zeros_like(here), 1 + here, 1 + after], axis=1)]
    for ring in range(RINGS - 1):
        low, high = 1 + ring * count, 1 + (ring + 1) * count
        triangles.append(np.stack([low + here, high + here, high + after], axis=1))
        triangles.append(np.stack([low + here, high + after, low + after], axis=1))
    points = center + RAISED * directions
    return Mesh.smooth(points, np.concatenate(triangles).astype(np.intp), directions, f"contact {disc.number}")
