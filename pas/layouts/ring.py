"""Clip faces: polygons round contacts' curves in their planes, and the tetrahedra between them and a piece's rim."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.rational import Vector, to_floats
from pas.errors import GeometryError
from pas.layouts.fits import sides
from pas.layouts.seen import Seen
from pas.partition.layout import Ray

CORNERS = (4, 5, 6, 8, 12, 16)
"""Corners of the polygon round a curve, tried in turn."""

TURNS = 6
"""Ways to turn a polygon."""

LARGER = (1.35, 1.2, 1.1, 1.06, 1.03, 1.02)
"""How much larger than the smallest polygon round the curve it is, tried in turn; many corners need no more than
`NARROW`."""

NARROW, MANY = 1.11, 8

ROOM, SHARE = 0.03, 0.2
"""Sine of the angle that a polygon's corners keep from the sides of the piece, or this share of what the curve does."""

FLAT = 1e-4
"""Volume of the unit vectors of a tetrahedron's corners below which it counts as flat."""


def clip_polygon(disc: Seen, rays: Sequence[Ray]) -> list[Vector]:
    """Corners of a polygon round a contact's curve, in its plane and inside the piece with these rays.

    They go round it counterclockwise seen from outside.  Raises `GeometryError` where none fits.
    """
    normals = sides(rays)
    least = min(ROOM, SHARE * float(np.arcsin(np.clip((normals @ unit(disc.points).T).min(), 0, 1))))
    offsets = disc.points - disc.middle
    turned = offsets[np.argsort(disc.azimuths(offsets))]
    for corners in CORNERS:
        for step in range(TURNS):
            chosen = turned[((np.arange(corners) + step / TURNS) * len(turned) / corners).astype(int)]
            for larger in LARGER:
                if corners >= MANY and larger > NARROW:
                    continue
                polygon = disc.middle + larger / cos(pi / corners) * chosen
                if (normals @ unit(polygon).T).min() > least and _surrounds(disc, polygon):
                    return [disc.on_plane(corner) for corner in polygon]
    raise GeometryError(
        f"there is no room for a clip face round the curve of contact {disc.number} in its piece of the layout"
    )


def _surrounds(disc: Seen, polygon: Floats) -> bool:
    """Whether a convex polygon, counterclockwise, goes round all points of the curve with some room."""
    following = np.roll(polygon, -1, axis=0)
    inwards = np.cross(disc.unit, following - polygon)
    inwards /= np.linalg.norm(inwards, axis=1)[:, None]
    depth = inwards @ disc.points.T - (inwards * polygon).sum(axis=1)[:, None]
    return bool(depth.min() > 0.01 * disc.radius)


def between(disc: Seen, inner: Sequence[Vector], outer: Sequence[Vector]) -> list[tuple[Vector, Vector, Vector]]:
    """The triangles between a polygon and the rim of its piece, both counterclockwise: those of the best shapes.

    Raises `GeometryError` where the two cannot be joined by triangles that all face the centre.
    """
    first, second = (np.array([to_floats(p) for p in ring]) for ring in (inner, outer))
    prices = _prices(unit(first), unit(second))
    best: tuple[float, list[tuple[int, int, bool]]] | None = None
    for start in range(len(outer)):
        found = _zipped(np.roll(prices, -start, axis=2).tolist())
        if found is not None and (best is None or found[0] < best[0] - 1e-9):
            best = (found[0], [(i, (j + start) % len(outer), own) for i, j, own in found[1]])
    if best is None:
        raise GeometryError(f"the clip face of contact {disc.number} cannot be joined to the rim of its piece")
    m, q = len(inner), len(outer)
    return [
        (inner[i], outer[j], inner[(i + 1) % m]) if own else (inner[i], outer[j], outer[(j + 1) % q])
        for i, j, own in best[1]
    ]


def _zipped(prices: list[list[list[float]]]) -> tuple[float, list[tuple[int, int, bool]]] | None:
    """The cheapest way round from inner[0] - outer[0]: its price, and triangles (i, j, whether the third corner is
    the next inner one); None where there is none."""
    m, q = len(prices[0]), len(prices[0][0])
    price: dict[tuple[int, int], float] = {(0, 0): 0.0}
    came: dict[tuple[int, int], bool] = {}
    for i in range(m + 1):
        for j in range(q + 1):
            if (i, j) not in price:
                continue
            for own, place in ((True, (i + 1, j)), (False, (i, j + 1))):
                if place[0] > m or place[1] > q:
                    continue
                worth = price[i, j] + prices[not own][i % m][j % q]
                if worth < price.get(place, np.inf):
                    price[place], came[place] = worth, own
    if (m, q) not in price:
        return None
    found, place = [], (m, q)
    while place != (0, 0):
        own = came[place]
        place = (place[0] - 1, place[1]) if own else (place[0], place[1] - 1)
        found.append((place[0] % m, place[1] % q, own))
    return price[m, q], found


def _prices(inner: Floats, outer: Floats) -> Floats:
    """Of the triangles of inner[i], outer[j] and the next inner or outer corner, all unit vectors: the longest side
    squared over the volume, infinite for flat and turned ones; (2, number of inner, number of outer corners)."""
    a, b = np.broadcast_arrays(inner[:, None], outer[None, :])
    third = np.stack(np.broadcast_arrays(np.roll(inner, -1, axis=0)[:, None], np.roll(outer, -1, axis=0)[None, :]))
    volumes = (np.cross(a, b) * third).sum(axis=-1)
    squares = [np.square(p - q).sum(axis=-1) for p, q in ((np.stack([a, a]), b), (b, third), (third, a))]
    priced = np.full(volumes.shape, np.inf)
    return np.divide(np.max(squares, axis=0), volumes, out=priced, where=volumes > FLAT)
