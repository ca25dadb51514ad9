"""A graph over directions as triangles: Delaunay's in directions first, then graded by curvature.

The convex hull of unit vectors is the Delaunay triangulation of the sphere.  A ring's edge that is missing is halved
until all are there (conforming triangulation, Ruppert 1995); a pole inside each ring, or opposite to an opening, keeps
its disc apart, which is then left out.

The first triangles are seen once from the centre, so they have the topology of the graph.  What the remesher does keeps
it (see `pas.mesh.remesher`).  That the result is a manifold without folds is looked at, not proved.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.halfedges import HalfEdges
from pas.mesh.labelled import Labelled
from pas.mesh.rows import cross, dots, spans
from pas.mesh.shading import unit_rows
from pas.mesh.topology import Edges, connected, edge_table
from pas.surface.boundary_loops import BoundaryLoop
from pas.surface.radial_field import RadialField
from pas.surface.sheet import open_mesh

AROUND = 12
"""Points of a ring to begin with."""

CLEAR = 0.5
"""Directions closer to a ring than this share of their own spacing are left out."""

WIDER = 1.6
"""Each circle of directions around a small ring is this many times as wide as the one before, so that neighbours on
a thin pipe are on the same side of it."""

SMALL = 0.8
"""A ring is that small whose next circle is narrower than this share of the others' spacing."""

SEEN = 1e-9
"""Determinants over the product of the three distances count as positive from here."""

TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
"""A rotation that puts no direction of the icosahedron into a plane of symmetry of common models."""


def require_once(field: RadialField, points: Floats) -> None:
    """Raise `ArithmeticError` where rays from the centre through points (N, 3) do not meet the surface once."""
    if not field.once(points):
        raise ArithmeticError("a ray from the centre does not meet the surface once")


def first(field: RadialField) -> Labelled:
    """Few triangles seen once from the centre; raises `ArithmeticError` where rays do not meet the surface once."""
    mesh = _parted(field, delaunay(field))
    if field.rims:
        inside = np.setdiff1d(np.arange(len(mesh.points)), Edges(mesh.triangles, len(mesh.points)).rim)
        require_once(field, mesh.points[inside])
    return mesh


def delaunay(field: RadialField, around: int = AROUND) -> Labelled:
    """Delaunay's triangles of few directions, at least so many of them on each ring, on the surface; raises
    `ArithmeticError` where they are not seen once from the centre."""
    if not field.rims:  # most of what is in boxes ends at their walls: a few rays say so
        require_once(field, icosphere()[0])
    checkpoint("triangulating directions")
    points, triangles = hull(field, around)
    return open_mesh(field, points, triangles, rim_numbers(field, points, triangles))


def _parted(field: RadialField, mesh: Labelled) -> Labelled:
    """The triangles with edges between opposite sides of a thin arm halved until none is left.

    The arm goes on between them: the ray between those to the ends meets it there, while its points next to the middle
    of the edge may be on any side.
    """
    for _ in range(6):  # each halves the edges that are left
        halves, size = HalfEdges(mesh, np.zeros(1, dtype=np.int8)), len(mesh.points)
        normals, corners, ends = field.gradients(mesh.points), halves.corners, halves.ends
        opposite = np.flatnonzero(dots(normals[corners], normals[ends]) < 0)
        opposite = opposite[halves.twins[opposite] > opposite]
        if not len(opposite):
            break
        units = unit_rows(mesh.points)
        middles = units[corners[opposite]] + units[ends[opposite]]
        halves.split(opposite)
        halves.points[size:] = field.met(unit_rows(middles))
        if not seen(halves.points, halves.triangles).all():
            break
        mesh = halves.value
    return mesh


def rim_numbers(field: RadialField, points: Floats, triangles: Integers) -> Integers:
    """The rims (N,) on which points are, -1 inside; raises `ArithmeticError` where there are none to end on."""
    rim = np.unique(Edges(triangles, len(points)).rim)
    if len(rim) and not field.rims:
        raise ArithmeticError("the mesh ends where the surface has no contact")
    number = np.full(len(points), -1)
    if len(rim):
        number[rim] = np.argmin([curve.off(points[rim]) for curve in field.rims], axis=0)
    return number


@cache
def icosphere() -> tuple[Floats, float]:
    """The vertices (N, 3) of an icosahedron and the middles of its edges, turned, and their spacing in radians."""
    golden = (1 + 5**0.5) / 2
    corners = [(0, s, t * golden) for s in (-1, 1) for t in (-1, 1)]
    units = unit_rows(np.array([np.roll(c, k) for c in corners for k in range(3)], dtype=float))
    pairs = edge_table(ConvexHull(units).simplices.astype(np.intp))[0]
    units = np.concatenate([units, unit_rows(units[pairs].sum(axis=1))])
    return units @ TURN.T, 1.107 / 2


def seen(points: Floats, triangles: Integers) -> Bools:
    """Which triangles (T,) are seen from 0 with their outside away."""
    volumes, lengths = spans(points[triangles])
    return np.asarray(volumes > SEEN * SEEN * lengths)


def hull(field: RadialField, around: int) -> tuple[Floats, Integers]:
    """Points on the surface (N, 3) and triangles seen once from 0, whose rim is on the rings.

    Raises `ArithmeticError` where these directions do not do.
    """
    units, spacing = icosphere()
    rings = [ring.round(around) for ring in field.rims]
    for ring in field.rims:
        units = units[ring.inside(units) == ring.opening]
    halvings = 12  # rounds in which edges of rings that are missing are halved
    for _ in range(halvings):
        poles = np.array([-ring.middle if ring.opening else ring.middle for ring in field.rims]).reshape(-1, 3)
        free = np.concatenate([*_collars(field, rings, spacing), units])
        free = free[_clear(free, rings, spacing)]
        points = np.concatenate([*rings, free, poles])
        triangles, rim = _delaunay(points), _rim_keys(rings, len(points))
        missing = ~np.isin(rim, np.unique(_keys(triangles, triangles[:, [1, 2, 0]], len(points))))
        if not missing.any():
            return _trimmed(field, points, triangles, rim, len(poles))
        chosen = np.split(missing, np.cumsum([len(ring) for ring in rings])[:-1])
        rings = [_halved(c, r, m) for c, r, m in zip(field.rims, rings, chosen, strict=True)]
    raise ArithmeticError("the rings are too close to one another for a triangulation of directions")


def _collars(field: RadialField, rings: list[Floats], spacing: float) -> list[Floats]:
    """Directions (N, 3) in circles around each ring, out to where the others are as close."""
    result = []
    for number, curve in enumerate(field.rims):
        if curve.opening:
            continue
        ring = curve.round(AROUND)
        way, width = ring - curve.middle, WIDER
        while np.arccos(np.clip(unit_rows(ring) @ unit_rows(curve.middle), -1, 1)).max() * width < SMALL * spacing:
            way = (way + np.roll(way, 1, axis=0)) / (2 * np.cos(np.pi / AROUND))
            units = unit_rows(curve.middle + width * way)
            nearest = np.stack([(units @ unit_rows(r).T).max(axis=1) for r in rings]).argmax(axis=0)
            result.append(units[nearest == number])
            width *= WIDER
    return result


def _clear(units: Floats, rings: list[Floats], spacing: float) -> Bools:
    """Which directions are far enough from rings, and from earlier ones, for their distance from the rings."""
    edge = unit_rows(np.concatenate([np.empty((0, 3)), *rings]))
    angle = np.arccos(np.clip((units @ edge.T).max(axis=1, initial=-1.0), -1, 1))
    near = np.minimum(CLEAR * spacing, 0.5 * angle)
    clear = angle > 1e-6
    apart = np.arccos(np.clip(units @ units.T, -1, 1))
    for i in range(len(units)):
        if clear[i] and (apart[i, :i][clear[:i]] < near[i]).any():
            clear[i] = False
    return clear


def _delaunay(points: Floats) -> Integers:
    units = unit_rows(points)
    try:
        triangles = ConvexHull(units).simplices.astype(np.intp)
    except QhullError:
        raise ArithmeticError("directions that are flat have no triangles") from None
    a, b, c = (units[triangles[:, i]] for i in range(3))
    turned = (a * cross(b, c)).sum(axis=1) < 0
    triangles[turned] = triangles[turned][:, ::-1]
    return triangles[np.lexsort(triangles.T)]


def _rim_keys(rings: list[Floats], size: int) -> Integers:
    """The keys of the edges of all rings, from each point to the next."""
    starts = np.cumsum([0, *map(len, rings)])
    after = np.arange(1, starts[-1] + 1)
    after[starts[1:] - 1] = starts[:-1]
    return _keys(np.arange(len(after)), after, size)


def _keys(a: Integers, b: Integers, size: int) -> Integers:
    return np.minimum(a, b) * size + np.maximum(a, b)


def _halved(curve: BoundaryLoop, ring: Floats, chosen: Bools) -> Floats:
    middles = curve.at((ring + np.roll(ring, -1, axis=0)) / 2)
    both = np.stack([ring, middles], axis=1).reshape(-1, 3)
    return both[np.stack([np.ones(len(ring), dtype=bool), chosen], axis=1).ravel()]


def _trimmed(
    field: RadialField, points: Floats, triangles: Integers, rim: Integers, poles: int
) -> tuple[Floats, Integers]:
    """Without the discs in the rings, which have a pole each, the points on the surface."""
    size = len(points)
    edges = Edges(triangles, size)
    open_ = ~np.isin(_keys(edges.inner[:, 0], edges.inner[:, 1], size), rim)
    parts = connected(edges.owners[open_], len(triangles))
    inside = np.unique(parts[(triangles >= size - poles).any(axis=1)])
    kept = triangles[~np.isin(parts, inside)]
    points = points[: size - poles].copy()
    points[len(rim) :] = field.met(points[len(rim) :])
    used = np.unique(kept)
    if len(used) != len(points) or len(np.unique(parts)) != poles + 1 or not seen(points, kept).all():
        raise ArithmeticError("the rings do not bound one part of the directions")
    return points, kept
