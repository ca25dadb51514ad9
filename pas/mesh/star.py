"""From a graph over directions to triangles within a tolerance.

Few large triangles first: Delaunay's in directions, split, flipped and smoothed until their edges are as long as the
curvature lets them be at m^2 times the tolerance; each is cut into m^2, and all points are put onto their rays.  What
is measured to be too far is halved.

The first triangles are seen once from the centre, so they have the topology of the graph.  Splits, flips that make no
edge twice, and moves keep it.  That the result is a manifold without folds is looked at, not proved.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pas.limits import checkpoint
from pas.mesh import refine
from pas.mesh.field import Floats, Integers, RayField
from pas.mesh.fine import finer
from pas.mesh.hull import hull
from pas.mesh.mesh import Mesh
from pas.mesh.radial import Edges, centred, flipped, settled, upright
from pas.mesh.refine import require_room, split, too_many, with_longest
from pas.mesh.shading import unit_rows

LEVELS = (1, 2, 3)
"""Halvings of the icosahedron whose directions are tried in turn."""

COARSE = 8e-3
"""Over the region's reach: the tolerance for the triangles that are then cut."""

AIM = 0.72
"""Share of the tolerance at which edges of triangles with equal angles are as long as the curvature lets them be."""

LONGEST, GRADE = 0.3, 0.5
"""Of edges, over the region's reach; and by how much their length may grow from one end to the other, over it."""

BENT = 1.2
"""Edges are at most this many times as long as the smaller radius of curvature."""

FOLDED = 0.3
"""Cosine with the surface's normals below which a triangle counts as folded."""

LONG = 1.35
"""Edges this many times as long as they should be are split."""

ROUNDS, LAST, MENDINGS = 24, 4, 12


@dataclass(frozen=True)
class Graph:
    """Points (N, 3), triangles (T, 3), and at the points unit normals (N, 3) and the larger curvature's size (N,).

    `ring` (N,) is the number of the ring that a point is on, -1 inside.
    """

    points: Floats
    triangles: Integers
    ring: Integers
    normals: Floats
    bends: Floats


def star(field: RayField, tolerance: float, most: int | None = None) -> Mesh:
    """A mesh in the user's coordinates within a tolerance, measured, of at most `most` triangles.

    Raises `ArithmeticError` where the surface is no graph over directions, as far as its rays show, and `MeshError`
    where there would be too many triangles.
    """
    m = max(1, int(np.sqrt(COARSE * field.reach / tolerance)))
    first = _first(field)
    _require_once(field, first)
    graph = _remeshed(field, first, AIM * tolerance * m * m)
    _require_once(field, graph)
    most = refine.LARGEST if most is None else most
    fits = max(1, int(np.sqrt(most / len(graph.triangles))))
    if fits < m or len(graph.triangles) > most:
        measured = _cut(field, graph, fits)
        reached = _farthest(*distances(field, measured, Edges(measured.triangles, len(measured.points))))
        raise too_many(field, len(measured.triangles), most, tolerance, reached)
    return _mended(field, _cut(field, graph, m), tolerance, most)


def _require_once(field: RayField, graph: Graph) -> None:
    if not field.once(graph.points[graph.ring < 0]):
        raise ArithmeticError("a ray from the centre does not meet the surface once")


def _cut(field: RayField, graph: Graph, m: int) -> Graph:
    """Each triangle cut into m^2, the points on the surface."""
    points, triangles = finer(graph.points, graph.triangles, graph.normals, m)
    return _placed(field, points, triangles, np.full(len(points), -1))


def _farthest(inside: Floats, along: Floats) -> float:
    return float(max(inside.max(), along.max()))


def _first(field: RayField) -> Graph:
    for level in LEVELS:
        checkpoint("triangulating directions")
        try:
            points, triangles = hull(field, level)
        except ArithmeticError:
            if level == LEVELS[-1]:
                raise
            continue
        return _looked_at(field, points, triangles, _ring_numbers(field, points, triangles))
    raise AssertionError


def _ring_numbers(field: RayField, points: Floats, triangles: Integers) -> Integers:
    """The rings (N,) on which points are, by the planes and middles, -1 inside."""
    rim = np.unique(Edges(triangles, len(points)).rim)
    number = np.full(len(points), -1)
    if len(rim):
        number[rim] = np.argmin([ring.off(points[rim]) for ring in field.rings], axis=0)
    return number


def _looked_at(field: RayField, points: Floats, triangles: Integers, ring: Integers) -> Graph:
    gradients, bends = field.bending(points)
    return Graph(points, triangles, ring, unit_rows(gradients), bends)


def _placed(field: RayField, points: Floats, triangles: Integers, ring: Integers) -> Graph:
    """The points put onto their rays, those of the rim onto their rings; only normals are known of it."""
    points, rim = points.copy(), np.unique(Edges(triangles, len(points)).rim)
    ring = ring.copy()
    if len(rim):
        ring[rim] = np.argmin([curve.off(points[rim]) for curve in field.rings], axis=0)
    inner = ring < 0
    gradients = np.empty_like(points)
    points[inner], gradients[inner] = field.closed(points[inner])
    _to_rings(field, points, ring)
    gradients[~inner] = field.gradients(points[~inner])
    return Graph(points, triangles, ring, unit_rows(gradients), np.zeros(len(points)))


def _put(field: RayField, points: Floats, ring: Integers) -> None:
    inner = np.flatnonzero(ring < 0)
    points[inner] = field.near(points[inner])
    _to_rings(field, points, ring)


def _to_rings(field: RayField, points: Floats, ring: Integers) -> None:
    for number, curve in enumerate(field.rings):
        here = np.flatnonzero(ring == number)
        if len(here):
            points[here] = curve.at(points[here])


def _sizes(field: RayField, graph: Graph, tolerance: float, edges: Edges) -> Floats:
    """How long edges should be at points (N,)."""
    longest = LONGEST * field.reach
    size = np.sqrt(8 * tolerance / np.maximum(graph.bends, 8 * tolerance / longest**2))
    size = np.minimum(size, BENT / np.maximum(graph.bends, BENT / longest))
    a, b = edges.every.T
    lengths = _lengths(graph.points, edges.every)
    for _ in range(3):
        grown = np.full(len(size), np.inf)
        np.minimum.at(grown, a, size[b] + GRADE * lengths)
        np.minimum.at(grown, b, size[a] + GRADE * lengths)
        size = np.minimum(size, grown)
    return size


def _lengths(points: Floats, edges: Integers) -> Floats:
    way = points[edges[:, 1]] - points[edges[:, 0]]
    return np.asarray(np.sqrt((way * way).sum(axis=1)))


def _remeshed(field: RayField, graph: Graph, tolerance: float) -> Graph:
    """The mesh with edges of the lengths that the curvature lets them have."""
    for _ in range(ROUNDS):
        checkpoint(f"making the first triangles ({len(graph.triangles)})")
        edges = Edges(graph.triangles, len(graph.points))
        sizes = _sizes(field, graph, tolerance, edges)
        every = edges.every
        ratio = _lengths(graph.points, every) / sizes[every].mean(axis=1)
        long = _longest(graph.triangles, every, ratio, len(graph.points))
        if not len(long):
            break
        graph = _relaxed(field, _split(field, graph, long), tolerance)
    for _ in range(LAST):
        graph = _relaxed(field, graph, tolerance)
    return graph


def _longest(triangles: Integers, edges: Integers, ratio: Floats, size: int) -> Integers:
    """The edges that are too long, and the longest of one of their triangles, each over what it should be."""
    keys = edges.min(axis=1) * size + edges.max(axis=1)
    order = np.argsort(keys)
    start, end = triangles, triangles[:, [1, 2, 0]]
    place = order[np.searchsorted(keys[order], np.minimum(start, end) * size + np.maximum(start, end))]
    worst = place[np.arange(len(place)), ratio[place].argmax(axis=1)]
    return edges[np.unique(worst[ratio[worst] > LONG])]


def _split(field: RayField, graph: Graph, chosen: Integers) -> Graph:
    size = len(graph.points)
    points, triangles, _ = split(graph.points, graph.triangles, chosen)
    ring = np.concatenate([graph.ring, np.full(len(points) - size, -1)])
    rim = np.unique(Edges(triangles, len(points)).rim)
    new = rim[rim >= size]
    if len(new):
        ring[new] = np.argmin([curve.off(points[new]) for curve in field.rings], axis=0)
    fresh = points[size:].copy()
    _put(field, fresh, ring[size:])
    points[size:] = fresh
    return _looked_at(field, points, triangles, ring)


def _relaxed(field: RayField, graph: Graph, tolerance: float) -> Graph:
    """Flipped and smoothed once."""
    triangles = flipped(graph.points, graph.triangles, graph.normals)
    graph = replace(graph, triangles=triangles)
    edges = Edges(triangles, len(graph.points))
    sizes = _sizes(field, graph, tolerance, edges)
    move = centred(graph.points, triangles, sizes)
    move -= (move * graph.normals).sum(axis=1, keepdims=True) * graph.normals
    v, before, after = edges.neighbours
    move[v] = (graph.points[before] + graph.points[after]) / 4 - graph.points[v] / 2
    points = graph.points + move
    _put(field, points, graph.ring)
    points = settled(graph.points, points, triangles, graph.normals)
    return _looked_at(field, points, triangles, graph.ring)


def _mended(field: RayField, graph: Graph, tolerance: float, most: int) -> Mesh:
    for step in range(MENDINGS + 1):
        checkpoint(f"measuring the mesh ({len(graph.triangles)} triangles)")
        edges = Edges(graph.triangles, len(graph.points))
        inside, along = distances(field, graph, edges)
        reached = _farthest(inside, along)
        if reached <= tolerance:
            if not edges.manifold or upright(graph.points, graph.triangles, graph.normals).min() < FOLDED:
                raise ArithmeticError("some triangles are folded")
            world, deviation = field.world(graph.points), reached * field.scale
            return Mesh.smooth(world, graph.triangles, graph.normals, deviation=deviation)
        if step == MENDINGS:
            break
        far = with_longest(graph.points, graph.triangles[inside > tolerance], edges.every[along > tolerance])
        require_room(field, len(graph.triangles), len(far) / len(edges.every), tolerance, reached, most)
        graph = _split(field, graph, far)
        graph = replace(graph, triangles=flipped(graph.points, graph.triangles, graph.normals, 3))
    raise ArithmeticError("the tolerance was not reached")


def distances(field: RayField, graph: Graph, edges: Edges) -> tuple[Floats, Floats]:
    """Distances |f| / |grad f| of the triangles' centres (T,) and the edges' middles (E,), on the rim in its plane."""
    centres = graph.points[graph.triangles].mean(axis=1)
    middles = graph.points[edges.every].mean(axis=1)
    inner = len(edges.inner)
    found = field.distances(np.concatenate([centres, middles[:inner]]))
    along = np.empty(len(middles))
    along[:inner] = found[len(centres) :]
    rings = graph.ring[edges.rim[:, 0]]
    for number, curve in enumerate(field.rings):
        here = inner + np.flatnonzero(rings == number)
        along[here] = curve.distances(middles[here])
    return found[: len(centres)], along
