"""Regions: from a layout and the contacts' curves to tetrahedra in which a surface is proved and meshed.

The region is star-shaped around the centre of its layout.  Every clip face is a small polygon around its contact's
curve, strictly inside the contact's piece; tetrahedra of the same piece lie between it and the ends of the
layout's rays.  How far out these are is the largest lever: too near, no member is clean; too far, all are wavy.
Clip faces are polygons round contacts' curves in their planes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi

import numpy as np
from flint import fmpq

from pas.algebra.lengths import unit
from pas.algebra.monomials import homogeneous_exponents
from pas.algebra.rational import Vector, determinant, dot, three, to_float, to_floats
from pas.arrays import Floats
from pas.errors import GeometryError
from pas.layouts.discs import Disc, check_fits, power_of_two, sides
from pas.partition.cells import Region
from pas.partition.layout import Layout, Ray

WALLS = 1.3
"""How far out free rays end, as a multiple of what just leaves all pipes: at 1.0 three pipes at GC^2 have no clean
member, at 1.3 they have, and at 1.6 one of three times the energy."""

CLEAR, FARTHEST = 1.2, 1.15
"""Rays end this much beyond the surfaces of pipes at least, and no farther out than this beyond the farthest curve."""

OUTSIDE = 1.1
"""Walls are flat, and between the ends of rays that are far apart they would cut into pipes: around three contacts and
more, ends go out by tenths, seven times at most, until walls are so far beyond the surfaces of pipes.  A run behind
two branches side by side was pinched there by 0.16 of its radius, whatever the degree; nodes of five pipes of GC^2
became fair a degree lower."""

FINE = 16
"""Parts of its length, at least, in which the end of a ray is rounded."""

CORNERS = (4, 5, 6, 8, 12, 16)
"""Corners of the polygon round a curve, tried in turn."""

TURNS = 6
"""Ways to turn a polygon."""

LARGER = (1.35, 1.2, 1.1, 1.06, 1.03, 1.02)
"""How much larger than the smallest polygon round the curve it is, tried in turn."""

ROOM, SHARE = 0.03, 0.2
"""Sine of the angle that a polygon's corners keep from the sides of the piece, or this share of what the curve does."""

Corners = tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class Builder:
    """The data from which tetrahedra are made: points relative to the centre, all exact."""

    layout: Layout
    discs: Sequence[Disc]
    walls: float

    def end(self, ray: Ray, farther: float = 1.0) -> Vector:
        """The end of a free ray, or `farther` times as far."""
        length = float(np.linalg.norm(ray))
        far = farther * self.walls * self.reach(np.array(ray) / length) / length
        step = power_of_two(far / FINE)
        share = fmpq(round(far / to_float(step))) * step
        while True:
            end = three(share * c for c in ray)
            if not any(dot(disc.normal, end) == disc.height for disc in self.discs):
                return end
            share += step  # a wall in a clip plane would be taken for a part of the clip face

    def reach(self, direction: Floats) -> float:
        """The distance along a unit vector (3,) at which all pipes are left, or the nearest clip plane beyond that."""
        low = float(self.left(direction[None])[0])
        toward = [(float(direction @ disc.unit), float(disc.unit @ disc.middle)) for disc in self.discs]
        steepest = 0.1  # cosine to a clip's normal below which a ray is not followed to the clip's plane
        planes = [height / cosine for cosine, height in toward if cosine > steepest]
        high = max(float(np.hypot(disc.distance, disc.radius)) for disc in self.discs)
        return min(max(CLEAR * low, min((p for p in planes if p > CLEAR * low), default=0.0)), FARTHEST * high)

    def left(self, directions: Floats) -> Floats:
        """The distances (N,) along unit vectors (N, 3) at which all pipes are left."""
        found = np.zeros(len(directions))
        for disc in self.discs:
            cosines = directions @ disc.unit
            sines = np.sqrt(np.maximum(1 - cosines * cosines, 1e-9))
            ahead = np.minimum(disc.radius / sines, 1.1 * disc.distance)
            found = np.maximum(found, np.where(cosines > 0, ahead, disc.radius))
        return found

    def too_near(self, walls: Sequence[Corners]) -> list[Corners]:
        """The walls that come too near to pipes, at a lattice of points of each."""
        corners = np.array([[to_floats(corner) for corner in wall] for wall in walls])
        points = np.einsum("sc,wcx->wsx", np.array(homogeneous_exponents(6, 3)) / 6, corners)
        far = np.linalg.norm(points, axis=2)
        directions = points.reshape(-1, 3) / far.reshape(-1, 1)
        near = far.reshape(-1) < OUTSIDE * self.left(directions)
        for disc in self.discs:  # walls begin next to curves: under 5/4 of the angle of one that is no matter
            near &= directions @ disc.direction < cos(min(1.25 * disc.angle, pi))
        return [wall for wall, found in zip(walls, near.reshape(far.shape).any(axis=1), strict=True) if found]


def region(layout: Layout, discs: Sequence[Disc], walls: float = WALLS) -> Region:
    """The region of a layout whose clip faces lie around the curves of all contacts.

    Raises `GeometryError` where a curve fits in no piece, or no polygon of tetrahedra fits around it.
    """
    carried = dict(zip(check_fits(layout, discs), discs, strict=True))
    builder = Builder(layout, discs, walls)
    farther = [1.0] * len(layout.rays)
    step, steps = 1.1, 8  # by which ends of rays go out where walls between them come too near, and how often
    for _ in range(steps):
        ends = [builder.end(ray, times) for ray, times in zip(layout.rays, farther, strict=True)]
        pieces = _pieces(layout, carried, ends)
        if len(discs) < 3:  # behind a bend nothing runs through
            break
        free = set(ends)
        near = builder.too_near([corners for piece in pieces for corners in piece if free.intersection(corners)])
        if not near:
            break
        moved = free.intersection(corner for corners in near for corner in corners)
        farther = [times * step if end in moved else times for times, end in zip(farther, ends, strict=True)]
    return Region.of_triangles(pieces, layout.center, layout.name)


def _pieces(layout: Layout, carried: Mapping[int, Disc], ends: Sequence[Vector]) -> list[list[Corners]]:
    """The far triangles of each piece."""
    pieces: list[list[Corners]] = []
    for number, piece in enumerate(layout.pieces):
        if number in carried:
            triangles = around_clip(carried[number], [layout.rays[i] for i in piece], [ends[i] for i in piece])
        else:
            triangles = [(ends[a], ends[b], ends[c]) for a, b, c in layout.triangles[number]]
        if any(determinant(*corners) <= 0 for corners in triangles):
            raise GeometryError(f"a tetrahedron of the region is flat or turned in piece {number + 1} of {layout.name}")
        pieces.append(triangles)
    return pieces


def around_clip(disc: Disc, rays: Sequence[Ray], outer: Sequence[Vector]) -> list[Corners]:
    """The far triangles of a contact's piece with these rays: its clip face, and those between that and the rim.

    Raises `GeometryError` where there is no room for a clip face, or it cannot be joined to the rim.
    """
    inner = clip_polygon(disc, rays)
    return [(inner[0], a, b) for a, b in pairwise(inner[1:])] + between(disc, inner, outer)


def clip_polygon(disc: Disc, rays: Sequence[Ray]) -> list[Vector]:
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
                polygon = disc.middle + larger / cos(pi / corners) * chosen
                if (normals @ unit(polygon).T).min() > least and _surrounds(disc, polygon):
                    return [disc.on_plane(corner) for corner in polygon]
    raise GeometryError(
        f"there is no room for a clip face round the curve of contact {disc.number} in its piece of the layout"
    )


def _surrounds(disc: Disc, polygon: Floats) -> bool:
    """Whether a convex polygon, counterclockwise, goes round all points of the curve with some room."""
    following = np.roll(polygon, -1, axis=0)
    inwards = np.cross(disc.unit, following - polygon)
    inwards /= np.linalg.norm(inwards, axis=1)[:, None]
    depth = inwards @ disc.points.T - (inwards * polygon).sum(axis=1)[:, None]
    return bool(depth.min() > 0.01 * disc.radius)


def between(disc: Disc, inner: Sequence[Vector], outer: Sequence[Vector]) -> list[Corners]:
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
    return np.divide(np.max(squares, axis=0), volumes, out=priced, where=volumes > 0)
