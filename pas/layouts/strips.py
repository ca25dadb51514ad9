"""Strips: a piece around every contact, two triangles between neighbouring ones, and a triangle between three.

It serves where no axis keeps all contacts apart, as around five and six in any directions.  Neighbours are those of
the Laguerre-Delaunay triangulation of the discs on the sphere; empty sites fill wide gaps, so that no piece is wide.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import cos, degrees, radians, tan

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from pas.algebra.lengths import across, angle_between, spiral, unit
from pas.algebra.rational import Vector, determinant
from pas.arrays import Floats
from pas.errors import GeometryError
from pas.layouts.discs import Disc, check_fits, first_made, room, whole_ray
from pas.partition.layout import Layout, Ray

FARTHEST = (62, 40)
"""Degrees up to which any direction may be from the nearest site, less half of its disc; the second where the first
leaves a piece that is too wide, or no room."""

LENGTHS = (6, 24)
"""Entries of the rays: short ones, for short numbers in the algebra, and longer ones where these leave no room."""

ROOM = radians(1.5)
"""Between a disc and the sides of its piece, at least: for the polygon round its clip face."""


@dataclass(frozen=True)
class Site:
    """A disc of directions: a contact's, or an empty one."""

    direction: Floats
    angle: float


def strips(discs: Sequence[Disc], center: Vector) -> Layout:
    """The layout of strips for contacts; raises `GeometryError` where none fits."""
    return first_made(partial(_strips, discs, center, *way) for way in product(FARTHEST, LENGTHS))


def _strips(discs: Sequence[Disc], center: Vector, farthest: float, longest: int) -> Layout:
    layout = SiteTriangulation.of([Site(d.direction, d.angle) for d in discs], farthest).layout(center, longest)
    if min(room(layout, p, d) for p, d in zip(check_fits(layout, discs), discs, strict=True)) < ROOM:
        raise GeometryError("no layout of strips leaves room round all contacts")
    return layout


@dataclass(frozen=True)
class SiteTriangulation:
    """Sites, the first `contacts` of which are contacts', with their triangles, counterclockwise, and the directions
    (T, 3) that are equally far from the three discs of each."""

    sites: tuple[Site, ...]
    contacts: int
    triangles: tuple[tuple[int, int, int], ...]
    nodes: Floats

    @classmethod
    def of(cls, contacts: Sequence[Site], farthest: float) -> SiteTriangulation:
        """The net of contacts, with empty sites until no direction is farther than that (degrees) from one."""
        sites = list(contacts)
        looked_at = 3000  # directions among which the one that is farthest from all sites is looked for
        looked = spiral(looked_at)
        most_empty = 12  # empty sites, at the most
        while len(sites) <= len(contacts) + most_empty:
            away = np.min([np.arccos(np.clip(looked @ s.direction, -1, 1)) - s.angle / 2 for s in sites], axis=0)
            worst = int(away.round(9).argmax())
            found = _triangulated(sites) if degrees(away[worst]) < farthest else None
            if found is not None:
                return cls(tuple(sites), len(contacts), *found)
            gap = min(angle_between(looked[worst], s.direction) - s.angle for s in sites)
            widest_empty = 0.45  # angular radius (radians) of an empty site, at the most
            sites.append(Site(looked[worst], min(gap / 2, widest_empty)))
        raise GeometryError("the sphere of directions is not filled by a few more sites")

    def layout(self, center: Vector, longest: int) -> Layout:
        """The pieces, with rays of entries up to `longest`."""
        corners: dict[tuple[int, int], Ray] = {}
        cycles: list[list[Ray]] = []
        for number in range(len(self.sites)):
            around = self._corners(number)
            rays = [(t, whole_ray(direction, longest)) for t, direction in around]
            corners |= {(number, t): ray for t, ray in rays}
            cycles.append([ray for _, ray in rays])
            if len(set(cycles[-1])) < len(cycles[-1]):
                raise GeometryError("corners of a piece coincide when they are rounded")
        owner = {edge: t for t, (i, j, k) in enumerate(self.triangles) for edge in ((i, j), (j, k), (k, i))}
        for t, triangle in enumerate(self.triangles):
            cycles.append([corners[i, t] for i in triangle])
        for (i, j), t in owner.items():
            if i < j:
                other = owner[j, i]
                a, b, c, d = corners[i, t], corners[j, t], corners[j, other], corners[i, other]
                ways = ([[a, d, c], [a, c, b]], [[a, d, b], [d, c, b]])
                cycles += max(ways, key=lambda way: min(_volume(tri) for tri in way))
        empty = len(self.sites) - self.contacts
        name = f"strips between {self.contacts} contacts and {empty} empty site{'' if empty == 1 else 's'}"
        return _layout(cycles, center, name)

    def _corners(self, number: int) -> list[tuple[int, Floats]]:
        """The corners of a site's piece, counterclockwise, each with the number of its triangle: its Laguerre cell,
        in the plane that touches the sphere at it, shrunk towards it."""
        shrunk = 0.45  # how far, from its disc to its Laguerre cell, the piece of a site reaches
        site = self.sites[number]
        first, second = across(site.direction)
        places = {}
        for t, triangle in enumerate(self.triangles):
            if number in triangle:
                height = float(self.nodes[t] @ site.direction)
                if height < 0.05:
                    raise GeometryError("the piece of a site would be too wide")
                places[t] = self.nodes[t] / height - site.direction
        order = sorted(places, key=lambda t: float(np.arctan2(places[t] @ second, places[t] @ first)))
        ends = [places[t] for t in order]
        depths = [_distance(a, b) for a, b in zip(ends, [*ends[1:], ends[0]], strict=True)]
        least, radius = min(depths), tan(site.angle)
        if least < radius:
            raise GeometryError("a disc reaches beyond its Laguerre cell")
        every = number < self.contacts
        share = max((radius + shrunk * (x - radius)) / x for x in (depths if every else [least]))
        largest = 0.9  # share of its Laguerre cell that a piece may take up
        share = min(share, largest)
        if share * least < radius:
            raise GeometryError("a piece would shrink into its disc")
        return [(t, site.direction + share * places[t]) for t in order]


def _layout(cycles: Sequence[Sequence[Ray]], center: Vector, name: str) -> Layout:
    """The layout of pieces by their rays; corners that coincide are one, and pieces without inside are left away."""
    numbers: dict[Ray, int] = {}
    pieces = []
    for cycle in cycles:
        rays = [a for a, b in zip(cycle, [*cycle[1:], cycle[0]], strict=True) if a != b]
        if len(set(rays)) < 3:
            continue
        if len(rays) == 3 and determinant(*rays) <= 0:
            raise GeometryError("a triangle between pieces is turned when its corners are rounded")
        pieces.append([numbers.setdefault(ray, len(numbers)) for ray in rays])
    try:
        return Layout(list(numbers), pieces, center, name)
    except ValueError as error:
        raise GeometryError(f"no layout of strips: {error}") from None


def _triangulated(sites: Sequence[Site]) -> tuple[tuple[tuple[int, int, int], ...], Floats] | None:
    """The Laguerre-Delaunay triangles of discs on the sphere, as the hull of the tips of their polar cones; None where
    a disc is hidden or the centre is not inside."""
    tips = np.array([s.direction / cos(s.angle) for s in sites])
    try:
        hull = ConvexHull(tips)
    except QhullError:  # of fewer than four sites, too
        return None
    if len(hull.vertices) < len(sites) or not bool((hull.equations[:, 3] < -1e-6).all()):
        return None
    found = []
    for simplex, equation in zip(hull.simplices, hull.equations, strict=True):
        i, j, k = (int(v) for v in simplex)
        if float(np.dot(np.cross(tips[i], tips[j]), tips[k])) < 0:
            j, k = k, j
        start = min(range(3), key=lambda n: (i, j, k)[n])
        found.append(((i, j, k)[start:] + (i, j, k)[:start], unit(equation[:3])))
    found.sort(key=lambda pair: pair[0])
    return tuple((a, b, c) for (a, b, c), _ in found), np.array([node for _, node in found])


def _distance(a: Floats, b: Floats) -> float:
    """The distance of the line through two points from the origin, or of the point where they are one."""
    length = float(np.linalg.norm(b - a))
    return float(np.linalg.norm(np.cross(a, b - a))) / length if length else float(np.linalg.norm(a))


def _volume(rays: Sequence[Ray]) -> float:
    """The volume of the unit vectors of three rays; 0 where two are one."""
    lengths = [float(np.linalg.norm(ray)) for ray in rays]
    return float(determinant(*rays)) / (lengths[0] * lengths[1] * lengths[2])
