"""Full planes through the centre, for symmetric nodes.

Where a few whole planes keep all contacts apart, the pieces are the regions of their arrangement.  Such planes
rarely exist, but for the six directions of a cube the four planes `+-x +-y + z = 0` do: fourteen pieces that share the
symmetry of the node, which no fan has.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, product
from math import atan2

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.rational import Vector, cross
from pas.errors import GeometryError
from pas.layouts.discs import Disc, across, check_fits
from pas.partition.layout import Layout, Ray, primitive, reduced

SQUARE = 1e-9
"""How far directions may be off from those of a cube."""


def planes(discs: Sequence[Disc], center: Vector) -> Layout:
    """The four planes between six contacts along the axes of a cube, of whole numbers in the node's coordinates.

    Raises `GeometryError` for other nodes.
    """
    if not symmetric(discs):
        raise GeometryError("full planes serve six contacts along the axes of a cube; for others take a fan or strips")
    axes: list[Ray] = []
    for disc in discs:
        if all(abs(float(unit(np.array(a)) @ disc.direction)) < 0.5 for a in axes):
            axes.append(primitive(disc.normal))
    lengths = {a[0] ** 2 + a[1] ** 2 + a[2] ** 2 for a in axes}
    if len(lengths) != 1:
        raise GeometryError("the axes of the node have no whole vectors of one length, as full planes need")
    signs = [(s, t, 1) for s, t in product((1, -1), repeat=2)]
    normals = [tuple(sum(s * a[i] for s, a in zip(sign, axes, strict=True)) for i in range(3)) for sign in signs]
    layout = arrangement([(n[0], n[1], n[2]) for n in normals], center)
    check_fits(layout, discs)
    return layout


def symmetric(discs: Sequence[Disc]) -> bool:
    """Whether they are six along the axes of a cube."""
    units = np.array([disc.direction for disc in discs])
    dots = np.abs(units @ units.T)
    return len(discs) == 6 and bool(np.minimum(dots, np.abs(1 - dots)).max() <= SQUARE)


def arrangement(normals: Sequence[Ray], center: Vector) -> Layout:
    """The layout of the regions into which planes through the centre (their normals) cut all directions.

    Raises `GeometryError` for fewer than three planes, or all through one line: a fan serves these.
    """
    rays = list(
        dict.fromkeys(
            reduced((s * c[0], s * c[1], s * c[2]))
            for a, b in combinations(normals, 2)
            for c in [cross(a, b)]
            if any(c)
            for s in (1, -1)
        )
    )
    if len(rays) < 6:
        raise GeometryError("an arrangement needs three planes at least that have only the centre in common")
    signs = {ray: tuple(_sign(n, ray) for n in normals) for ray in rays}
    pieces: dict[tuple[int, ...], list[int]] = {}
    for number, ray in enumerate(rays):
        free = [i for i, s in enumerate(signs[ray]) if s == 0]
        for choice in product((1, -1), repeat=len(free)):
            key = list(signs[ray])
            for i, s in zip(free, choice, strict=True):
                key[i] = s
            pieces.setdefault(tuple(key), []).append(number)
    cells = [_round(numbers, rays) for key, numbers in sorted(pieces.items()) if len(numbers) > 2]
    return Layout(rays, cells, center, f"{len(normals)} planes")


def _round(numbers: Sequence[int], rays: Sequence[Ray]) -> list[int]:
    """The rays of a convex piece, counterclockwise seen from outside."""
    middle = unit(np.sum([unit(np.array(rays[i])) for i in numbers], axis=0))
    first, second = across(middle)
    place = {i: atan2(float(unit(np.array(rays[i])) @ second), float(unit(np.array(rays[i])) @ first)) for i in numbers}
    return sorted(numbers, key=lambda i: place[i])


def _sign(normal: Ray, ray: Ray) -> int:
    value = sum(a * b for a, b in zip(normal, ray, strict=True))
    return (value > 0) - (value < 0)
