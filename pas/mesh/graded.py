"""From few triangles with the surface's topology to triangles within a tolerance, graded by curvature.

Edges are first made as long as the curvature lets them be at m^2 times the tolerance: split, collapsed, flipped,
points smoothed.  Each triangle is then cut into m^2, and all points are put onto the surface.  What is measured to be
too far is halved.  Splits, collapses under the link condition, flips that make no edge twice, and moves keep the
topology.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from pas.limits import checkpoint
from pas.mesh import refine
from pas.mesh.coarsen import collapsed
from pas.mesh.field import Floats, Integers, SheetField
from pas.mesh.fine import fewest_parts, finer, points_on_edges
from pas.mesh.graph import Graph, looked_at
from pas.mesh.kernels import compiled
from pas.mesh.measured import distances, rims_of_edges
from pas.mesh.mesh import Mesh
from pas.mesh.radial import flipped, flipped_edges, settled, slender
from pas.mesh.refine import longest_of, require_room, split, too_many, with_longest
from pas.mesh.rows import dots
from pas.mesh.shading import unit_rows
from pas.mesh.sheets import shaped
from pas.mesh.topology import distinct

COARSE = 8e-3
"""Over the region's reach: the tolerance for the triangles that are then cut."""

LONGEST, GRADE = 0.3, 0.5
"""Of edges, over the region's reach; and by how much their length may grow from one end to the other, over it."""

BENT = 1.2
"""Edges are at most this many times as long as the smaller radius of curvature, of the surface and of its rims."""

LONG = 1.35
"""Edges this many times as long as they should be are split."""

FEWER = 4
"""By how much the number of parts of edges is divided where they fold."""

ROUNDS, MENDINGS, FLIPPED = 24, 12, 3

LAST, ENOUGH, SLENDER = 4, 2, 0.004
"""Smoothings at the end, and how many do where no larger share of triangles has an angle below 30 degrees."""

STALLED = 2
"""Mendings after which edges are no longer flipped, and, twice as many, there must be fewer to mend than there were."""

THINNINGS, SMOOTHED = 40, 6
"""Passes of collapses at most, and how many of them there are between smoothings."""

FEW = 0.02
"""Share of the vertices below which a pass of collapses is the last."""


def graded(
    field: SheetField,
    first: Callable[[float], Graph],
    tolerance: float,
    aim: float,
    most: int | None = None,
    more: float = 0.0,
) -> Mesh:
    """The mesh in the user's coordinates within a tolerance, measured, of at most `most` triangles.

    It is made of what `first` makes for a larger tolerance, with edges cut into parts: so many that these triangles are
    coarse (rounded down after so much `more` is added), fewer where that folds triangles, as next to rims that are
    close to one another.  Raises `ArithmeticError` where triangles are folded all the same or the tolerance is not
    reached, `MeshError` where there would be too many triangles.
    """
    m = max(1, int(np.sqrt(COARSE * field.reach / tolerance) + more))
    most = refine.LARGEST if most is None else most
    while True:
        try:
            return _finished(field, first(aim * tolerance * m**2), tolerance, m, most)
        except ArithmeticError:
            if m == 1:
                raise
            m = max(1, m // FEWER)


def _finished(field: SheetField, graph: Graph, tolerance: float, m: int, most: int) -> Mesh:
    """The mesh with edges cut into `m` parts; see `graded`."""
    fits = max(1, int(np.sqrt(most / len(graph.triangles))))
    if fits < m or len(graph.triangles) > most:
        measured = _cut(field, graph, fits)
        reached = _farthest(*distances(field, measured, measured.edges))
        raise too_many(field, len(measured.triangles), most, tolerance, reached)
    cut = _cut(field, graph, m)
    cut.require_upright()  # mending would find the same, after longer
    far = distances(field, cut, cut.edges)
    more = min(fewest_parts(m, *far, tolerance), fits)
    if more > m:
        again = _cut(field, graph, more)
        if not again.folded.any():
            cut, far = again, distances(field, again, again.edges)
    return _mended(field, cut, far, tolerance, most, shape=True)


def followed(field: SheetField, points: Floats, triangles: Integers, rim: Integers, tolerance: float) -> Mesh:
    """The mesh of points (N, 3) near the surface, or on rims with given numbers (N,), moved onto it; see `graded`."""
    near = _drawn(field, points, triangles, rim)
    graph = _placed(field, near.points, triangles, rim)
    graph.require_upright()
    return _mended(field, graph, distances(field, graph, graph.edges), tolerance, refine.LARGEST, shape=False)


def _cut(field: SheetField, graph: Graph, m: int) -> Graph:
    """Each triangle cut into m^2, the points on the surface."""
    points, triangles = finer(graph.points, graph.triangles, graph.normals, m)
    rim = np.concatenate([graph.rim, np.full(len(points) - len(graph.points), -1)])
    border = graph.edges.rim
    if len(border) and m > 1:
        rows = points_on_edges(graph.triangles, len(graph.points), m, border)
        rim[rows] = rims_of_edges(field, graph.points, graph.rim, border)[:, None]
    return _placed(field, points, triangles, rim)


def _farthest(inside: Floats, along: Floats) -> float:
    return float(max(inside.max(initial=0.0), along.max(initial=0.0)))


def _placed(field: SheetField, points: Floats, triangles: Integers, rim: Integers) -> Graph:
    """The points put onto the surface and its rims; of the surface only normals are known."""
    points, inner = points.copy(), rim < 0
    gradients = np.empty_like(points)
    points[inner], gradients[inner] = field.closed(points[inner])
    _to_rims(field, points, rim)
    gradients[~inner] = field.gradients(points[~inner])
    return Graph(points, triangles, rim, unit_rows(gradients), np.zeros(len(points)))


def _put(field: SheetField, points: Floats, rim: Integers) -> None:
    inner = np.flatnonzero(rim < 0)
    points[inner] = field.near(points[inner])
    _to_rims(field, points, rim)


def _drawn(field: SheetField, points: Floats, triangles: Integers, rim: Integers) -> Graph:
    """With points near the surface drawn towards it, those of rims onto these."""
    points = points.copy()
    _to_rims(field, points, rim)
    points, gradients, bends = field.drawn(points, rim >= 0)
    return Graph(points, triangles, rim, unit_rows(gradients), bends)


def _to_rims(field: SheetField, points: Floats, rim: Integers) -> None:
    here = np.flatnonzero(rim >= 0)
    if len(here):
        points[here] = field.on_rims(points[here], rim[here])


def _sizes(field: SheetField, graph: Graph, tolerance: float) -> Floats:
    """How long edges should be at points (N,): growing by at most `GRADE` over the way along edges, in three rounds."""
    every, fixed = (graph.edges.every, len(graph.edges.inner)), field.fixed[graph.rim]
    return compiled().wanted_sizes(graph.points, every, graph.bends, fixed, _limits(field, tolerance))


def _limits(field: SheetField, tolerance: float) -> tuple[float, float, float, float, float]:
    longest = LONGEST * field.reach
    return 8 * tolerance, 8 * tolerance / longest**2, BENT, BENT / longest, GRADE


def _lengths(points: Floats, edges: Integers) -> Floats:
    way = points[edges[:, 1]] - points[edges[:, 0]]
    return np.asarray(np.sqrt(dots(way, way)))


def coarsened(field: SheetField, graph: Graph, tolerance: float) -> Graph:
    """The mesh without the edges that are shorter than the curvature lets them be."""
    for step in range(THINNINGS):
        checkpoint(f"coarsening the first triangles ({len(graph.triangles)})")
        sizes = _sizes(field, graph, tolerance)
        fixed = field.fixed[graph.rim]
        left, triangles = collapsed(graph.points, graph.edges, graph.normals, graph.rim, fixed, sizes)
        few = len(graph.points) - len(left) <= FEW * len(graph.points)
        graph = Graph(graph.points[left], triangles, graph.rim[left], graph.normals[left], graph.bends[left])
        if few or step % SMOOTHED == SMOOTHED - 1:
            graph = _relaxed(field, graph, tolerance)
        if few:
            break
    return graph


def remeshed(field: SheetField, graph: Graph, tolerance: float) -> Graph:
    """The mesh with edges of the lengths that the curvature lets them have.

    Raises `ArithmeticError` where triangles are folded.
    """
    for _ in range(ROUNDS):
        checkpoint(f"making the first triangles ({len(graph.triangles)})")
        sizes, every = _sizes(field, graph, tolerance), graph.edges.every
        ratio = _lengths(graph.points, every) / sizes[every].mean(axis=1)
        long = longest_of(graph.triangles, every, ratio, len(graph.points), LONG)
        finer = _unfolded(field, graph, long) if len(long) else graph
        if finer is graph:
            break
        graph = _relaxed(field, finer, tolerance)
    for step in range(LAST):
        if step >= ENOUGH and slender(graph.points, graph.triangles) <= SLENDER * len(graph.triangles):
            break
        graph = _relaxed(field, graph, tolerance)
    graph.require_upright()
    return graph


def _unfolded(field: SheetField, graph: Graph, chosen: Integers) -> Graph:
    """The mesh with points in the middle of chosen edges (E, 2), but for those whose points fold triangles: around a
    thin arm the middle of an edge may be nearer to its other side."""
    size = len(graph.points)
    while len(chosen):
        new = _split(field, graph, chosen, drawn=True)[0]
        folded = new.triangles[new.folded]
        refused = distinct(folded[folded >= size]) - size
        if not len(refused):
            return new
        chosen = np.delete(_in_order(chosen, size), refused, axis=0)
    return graph


def _in_order(chosen: Integers, size: int) -> Integers:
    """Edges (E, 2) in the order of the points that `split` puts into their middles."""
    return chosen[np.argsort(chosen.min(axis=1) * size + chosen.max(axis=1))]


def _split(field: SheetField, graph: Graph, chosen: Integers, drawn: bool) -> tuple[Graph, Integers]:
    """The mesh with points in the middle of chosen edges, `drawn` to the surface or quite on it; and the triangle that
    each was part of."""
    size = len(graph.points)
    points, triangles, parents = split(graph.points, graph.triangles, chosen)
    rim = np.concatenate([graph.rim, np.full(len(points) - size, -1)])
    pairs = _in_order(chosen, size)
    on_rim = np.flatnonzero((graph.rim[pairs] >= 0).all(axis=1))
    if len(on_rim):
        border = graph.edges.rim
        keys = border.min(axis=1) * size + border.max(axis=1)
        order = np.argsort(keys)
        ends = pairs[on_rim].min(axis=1) * size + pairs[on_rim].max(axis=1)
        at = order[np.minimum(np.searchsorted(keys[order], ends), len(keys) - 1)]
        there = keys[at] == ends
        rim[size + on_rim[there]] = rims_of_edges(field, points, graph.rim, border[at[there]])
    fresh = points[size:].copy()
    if drawn:
        new = _drawn(field, fresh, triangles, rim[size:])
    else:
        _put(field, fresh, rim[size:])
        new = looked_at(field, fresh, triangles, rim[size:])
    return graph.joined(new), parents


def _relaxed(field: SheetField, graph: Graph, tolerance: float) -> Graph:
    """Flipped and smoothed once."""
    edges = flipped_edges(graph.points, graph.triangles, graph.normals)
    triangles = edges.triangles
    graph = Graph(graph.points, triangles, graph.rim, graph.normals, graph.bends)
    vars(graph)["edges"] = edges
    new = _drawn(field, _moved(field, graph, tolerance), triangles, graph.rim)
    points = settled(graph.points, new.points, triangles, graph.normals)
    back = (points != new.points).any(axis=1)
    normals = np.where(back[:, None], graph.normals, new.normals)
    relaxed = Graph(points, triangles, graph.rim, normals, np.where(back, graph.bends, new.bends))
    vars(relaxed)["edges"] = edges
    return relaxed


def _moved(field: SheetField, graph: Graph, tolerance: float) -> Floats:
    """The points (N, 3) moved to the mean of their triangles' centres in tangent planes, those of the rim along it."""
    every, limits = (graph.edges.every, len(graph.edges.inner)), _limits(field, tolerance)
    given = graph.points, graph.triangles, every, graph.normals, graph.bends, field.fixed[graph.rim]
    return compiled().moved(*given, limits)


def _mended(
    field: SheetField, graph: Graph, far: tuple[Floats, Floats], tolerance: float, most: int, *, shape: bool
) -> Mesh:
    """The mesh with the edges halved that are too `far`, as measured in triangles (T,) and along edges (E,).

    With slender triangles mended, if it may change its `shape`.
    """
    counts: list[int] = []
    edges, (inside, along) = graph.edges, far
    nearest = _farthest(inside[inside <= tolerance], along[along <= tolerance])
    while True:
        checkpoint(f"measuring the mesh ({len(graph.triangles)} triangles)")
        reached = _farthest(inside, along)
        if reached <= tolerance:
            if shape:
                better = shaped(field, graph.points, graph.triangles, graph.normals, graph.rim, tolerance)
                graph = replace(graph, points=better.points, triangles=better.triangles, normals=better.normals)
                nearest = max(nearest, better.worst)
            if not edges.manifold:
                raise ArithmeticError("some edge does not have one or two triangles")
            graph.require_upright()
            if not field.within(graph.points):
                raise ArithmeticError("the mesh leaves the region")
            world, deviation = field.world(graph.points), max(reached, nearest) * field.scale
            return Mesh.smooth(world, graph.triangles, graph.normals, deviation=deviation)
        counts.append(int((inside > tolerance).sum() + (along > tolerance).sum()))
        if len(counts) > MENDINGS or (len(counts) > 2 * STALLED and counts[-1] >= counts[-1 - STALLED]):
            raise ArithmeticError("the tolerance was not reached")
        halved = with_longest(graph.points, graph.triangles[inside > tolerance], edges.every[along > tolerance])
        require_room(field, len(graph.triangles), len(halved) / len(edges.every), tolerance, reached, most)
        graph, changed = _halved(field, graph, halved, FLIPPED if len(counts) <= STALLED else 0)
        edges = graph.edges
        inside, along = distances(field, graph, edges, changed)
        nearest = max(nearest, _farthest(inside[inside <= tolerance], along[along <= tolerance]))


def _halved(field: SheetField, graph: Graph, far: Integers, passes: int) -> tuple[Graph, np.ndarray]:
    """The mesh with edges (E, 2) halved and others around them flipped in so many passes; which triangles (T,) are new.

    A flip may leave an edge that is too far again, so the last mendings do without.
    """
    graph, parents = _split(field, graph, far, drawn=False)
    near = np.zeros(len(graph.points), dtype=bool)
    near[far] = True
    near[-len(far) :] = True
    around = np.flatnonzero(near[graph.triangles].any(axis=1))
    triangles = graph.triangles.copy()
    triangles[around] = flipped(graph.points, triangles[around], graph.normals, passes)
    changed = np.bincount(parents, minlength=int(parents.max()) + 1)[parents] > 1
    changed[around] |= (triangles[around] != graph.triangles[around]).any(axis=1)
    return replace(graph, triangles=triangles), changed
