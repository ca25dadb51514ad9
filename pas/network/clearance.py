"""That nothing of a network meets but what should: the surfaces of nodes, of the straight parts of struts between them,
and of their flat ends.

What shares a node meets only where it should by the proofs of the node: its surface is crossed once by each ray from
the centre, and not at all in the directions of its clips' circles, in which the struts go away from it.  Struts that
share no point are farther apart than they are thick.  Nodes are apart from others, neighbours or not, and from struts
that do not end there, where balls around them are, or where it is proved of their surfaces (`pas.network.covers`).
Distances are compared with room for rounding.

So each connected piece has one closed surface that does not meet itself, and every point off it is as often inside of
its nodes and struts as the surface winds around it: in one at most.  Of several pieces none is inside of another, as
of each the middle of a strut is in no node of another one, which is decided exactly.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from pas.algebra.inputs import shown_point
from pas.algebra.rational import to_floats
from pas.arrays import Floats, Integers
from pas.limits import checkpoint
from pas.mesh.rows import dots
from pas.network.covers import Found, NodeCovers
from pas.network.graph import NetworkProblem, StrutGraph, told
from pas.network.overlaps import common_point
from pas.verdicts import Status, Verdict

AT_ONCE = 4096
"""Struts whose neighbours are looked at together, so that memory is bounded."""


MAY_MEET = "may meet; thinner struts, or wider angles between those of a node, end nearer to it"

WORDS = {
    "near struts": ("the struts {} and {}, {} from one another,", MAY_MEET),
    "node and strut": ("the node {} and the strut {}, {} from its point,", MAY_MEET),
    "nodes": ("the nodes {} and {}, {} from one another,", MAY_MEET),
    "enclosed": ("the piece of point {} and another one", "may be one inside of the other"),
}
"""What is told of each kind of doubt: of what, and what of it is not decided."""

Doubt = tuple[tuple[int, ...], float, int, Found]
"""Numbers of nodes, struts or both, how far apart they are, that of a point, and what is found about it."""


def crossing(network: StrutGraph) -> Iterator[tuple[int, int, float]]:
    """Struts without a common point that come nearer than their radii: two numbers and the distance of their axes."""
    for first, second, distance in _near_struts(network):
        close = distance < network.thickness[first] + network.thickness[second] + network.slack
        yield from zip(first[close].tolist(), second[close].tolist(), distance[close].tolist(), strict=True)


def clearance(network: StrutGraph, covers: NodeCovers) -> tuple[Verdict, tuple[NetworkProblem, ...]]:
    """The verdict that nothing meets that shares no point, nor neighbours, and all that may, with numbers of points and
    struts.

    It is refuted where a point is inside of two nodes, or struts where they are straight.
    """
    found = sorted(_doubts(network, covers), key=lambda doubt: doubt[0] is not Status.REFUTED)
    problems = tuple(problem for *_, problem in found)
    for status, place, _ in found:
        return Verdict(status, "nothing else meets", told(problems), tuple(place.tolist())), problems
    reason = "nodes, also neighbours, and struts that share no point are apart"
    return Verdict(Status.PROVED, "nothing else meets", reason, measure=len(network.edges)), ()


def _doubts(network: StrutGraph, covers: NodeCovers) -> Iterator[tuple[Status, Floats, NetworkProblem]]:
    """What meets, or may meet: which of both, where, and what."""
    finders = {
        "near struts": _crossing_struts,
        "node and strut": _struts_of_nodes,
        "nodes": _near_nodes,
        "enclosed": _enclosed,
    }
    for kind, find in finders.items():
        names, doubtful = WORDS[kind]
        for ids, distance, about, common in find(network, covers):
            status, place, said = Status.UNDECIDED, network.points[about], doubtful
            if not isinstance(common, bool):
                status, place = Status.REFUTED, place + float(network.grid) * np.array(to_floats(common))
                said = f"overlap at {shown_point(place)}; make struts there thinner, or move their points apart"
            yield status, place, NetworkProblem(kind, ids, f"{names.format(*ids[:2], f'{distance:.4g}')} {said}")


def _near(points: Floats, others: Floats, distance: float) -> Iterator[tuple[Integers, Integers]]:
    """Pairs of points and others within a distance, as many points at once as memory is for."""
    from scipy.spatial import cKDTree

    tree = cKDTree(others)
    order = np.lexsort(points.T)
    for start in range(0, len(points), AT_ONCE):
        checkpoint("looking for what meets", start / len(points))
        own = order[start : start + AT_ONCE]
        found = cKDTree(points[own]).sparse_distance_matrix(tree, distance, output_type="ndarray")
        yield own[found["i"]], found["j"]


def _middles(network: StrutGraph) -> Floats:
    """The middles of all struts (E, 3), axis by axis, as the ends of all together take twice as much."""
    found = np.empty((len(network.edges), 3))
    for axis, places in enumerate(network.points.T):
        found[:, axis] = places[network.edges].mean(axis=1)
    return found


def _near_struts(network: StrutGraph) -> Iterator[tuple[Integers, Integers, Floats]]:
    edges, points = network.edges, network.points
    if not len(edges):
        return
    middles = _middles(network)
    far = float(network.lengths.max() + 2 * network.thickness.max())
    half, slack = np.float64(network.grid / 2), network.slack
    for first, second in _near(middles, middles, far):
        once = first < second
        i, j = first[once], second[once]
        way = middles[j] - middles[i]  # along which struts that come near overlap: seen before their distance is
        square, along = dots(way, way), sum(np.abs(dots(way, network.vectors[k] * half)) for k in (i, j))
        need = network.thickness[i] + network.thickness[j] + slack
        close = square - along <= need * np.sqrt(square)
        for a, b in product(edges.T, edges.T):
            close &= a[i] != b[j]
        yield i[close], j[close], segment_distances(points[edges[i[close]]], points[edges[j[close]]])


def _crossing_struts(network: StrutGraph, covers: NodeCovers) -> Iterator[Doubt]:
    """Struts without a common point that come nearer than their radii, looked into where these are straight."""
    step = float(network.grid)
    for i, j, distance in crossing(network):
        pair, about = [i, j], int(network.edges[i, 0])
        ways, widths, straight = network.vectors[pair] * step, network.widths[pair], covers.axes(pair)
        one, other = near = np.concatenate(nearest_points(straight[:1], straight[1:]))
        along = ((near - network.points[network.edges[pair, 0]]) * ways).sum(axis=1) / (ways**2).sum(axis=1)
        radii = widths[:, 0] + along * (widths[:, 1] - widths[:, 0])
        inwards = straight.mean(axis=1) - near
        inwards /= np.maximum(np.linalg.norm(inwards, axis=1, keepdims=True), 1e-300)
        pulled = near + inwards * (radii[::-1, None] - np.linalg.norm(one - other)) / 2
        points = np.stack([one + (other - one) * radii[0] / radii.sum(), *pulled]) - network.points[about]
        solids = covers.strut(i, about), covers.strut(j, about)
        yield (i, j), distance, about, common_point(points / step, *solids) or False


def _struts_of_nodes(network: StrutGraph, covers: NodeCovers) -> Iterator[Doubt]:
    """Nodes that may meet the straight part of a strut that does not end there."""
    edges, points, reach = network.edges, network.points, covers.reach
    used, slack = np.flatnonzero(reach), network.slack
    far = float(network.lengths.max() / 2 + reach.max() + network.thickness.max())
    for here, strut in _near(points[used], _middles(network), far):
        apart = (edges[strut] != used[here][:, None]).all(axis=1)
        node, other = used[here[apart]], strut[apart]
        distance = segment_distances(np.stack([points[node]] * 2, axis=1), covers.axes(other))
        close = distance < reach[node] + network.thickness[other] + slack
        yield from _left(node[close], other[close], distance[close], covers.struts_apart)


def _near_nodes(network: StrutGraph, covers: NodeCovers) -> Iterator[Doubt]:
    """Nodes that may meet."""
    points, reach, slack = network.points, covers.reach, network.slack
    used = np.flatnonzero(reach)
    for first, second in _near(points[used], points[used], 2 * float(reach.max()) + slack):
        node, other = used[first[first < second]], used[second[first < second]]
        distance = np.linalg.norm(points[node] - points[other], axis=1)
        close = distance < reach[node] + reach[other] + slack
        yield from _left(node[close], other[close], distance[close], covers.nodes_apart)


def _left(first: Integers, second: Integers, distance: Floats, prove: Any) -> Iterator[Doubt]:
    """The pairs that are not proved to be apart."""
    rows = zip(first.tolist(), second.tolist(), distance.tolist(), prove(first, second), strict=True)
    yield from (((i, j), far, i, found) for i, j, far, found in rows if found is not True)


def _enclosed(network: StrutGraph, covers: NodeCovers) -> Iterator[Doubt]:
    """The points of each piece none of whose struts has a middle that is outside of all nodes of others."""
    if network.pieces < 2:
        return
    points, reach, of, slack = network.points, covers.reach, network.components, network.slack
    used, piece, middles = np.flatnonzero(reach), of[network.edges[:, 0]], covers.axes(slice(None)).mean(axis=1)
    around: dict[int, list[int]] = {}
    for strut, near in _near(middles, points[used], float(reach.max()) + slack):
        node = used[near]
        close = np.linalg.norm(middles[strut] - points[node], axis=1) < reach[node] + slack
        close &= piece[strut] != of[node]
        for i, j in zip(strut[close].tolist(), node[close].tolist(), strict=True):
            around.setdefault(i, []).append(j)
    for number in np.setdiff1d(piece, np.delete(piece, list(around))).tolist():
        ids = tuple(np.flatnonzero(of == number).tolist())
        for i in np.flatnonzero(piece == number).tolist():
            about = int(network.edges[i, 0])
            middle = covers.strut(i, about).middle
            side = min(covers.node(j, about).side(middle) for j in around[i])
            if side:
                break
        if side <= 0:
            yield ids, 0.0, about, middle if side else False


def segment_distances(first: Floats, second: Floats) -> Floats:
    """The least distances of segments (M, 2, 3) from others, of which the first may be points."""
    one, other = nearest_points(first, second)
    return np.asarray(np.linalg.norm(one - other, axis=1))


def nearest_points(first: Floats, second: Floats) -> tuple[Floats, Floats]:
    """The nearest points (M, 3) of segments (M, 2, 3), which may be points, and of others (Ericson 2005, 5.1.9)."""
    u, v, w = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0], first[:, 0] - second[:, 0]
    a, b, c, d, e = (np.einsum("ni,ni->n", *pair) for pair in ((u, u), (u, v), (v, v), (u, w), (v, w)))
    det = a * c - b * b
    parallel = det <= 1e-12 * a * c
    s = np.clip(np.where(parallel, 0.0, b * e - c * d) / np.where(parallel, 1.0, det), 0.0, 1.0)
    t = np.clip((b * s + e) / c, 0.0, 1.0)
    s = np.where(a > 0, np.clip((b * t - d) / np.where(a > 0, a, 1.0), 0.0, 1.0), 0.0)
    return first[:, 0] + s[:, None] * u, second[:, 0] + t[:, None] * v
