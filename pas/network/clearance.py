"""That nothing of a network meets but what should: nodes lie in balls, struts in cylinders from the one's end to the
other's, and those that share no point are farther apart than these are thick.

What shares a node meets only where it should by the proofs of the node: its surface is crossed once by each ray from
the centre, and not at all in the directions of its clips' circles, in which the struts go away from it.  Neighbours are
kept apart by a plane across their strut.  That nodes are in their balls and before these planes is proved on their
polynomials; as they are seen from the centre, they are where their surfaces are.  Distances are compared with room for
rounding.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from pas.limits import checkpoint
from pas.mesh.rows import Floats, Integers, dots
from pas.network.graph import StrutGraph
from pas.verdicts import Status, Verdict

ROUNDING = 1e-9
"""Of the longest strut: distances are taken to be so much smaller than they come out."""

AT_ONCE = 4096
"""Struts whose neighbours are looked at together, so that memory is bounded."""


def crossing(network: StrutGraph) -> Iterator[tuple[int, int, float]]:
    """Struts without a common point that come nearer than their radii: two numbers and the distance of their axes."""
    for first, second, distance in _near_struts(network):
        close = distance < network.thickness[first] + network.thickness[second] + _slack(network)
        yield from _listed(first, second, distance, close)


def clearance(network: StrutGraph, reach: Floats, ends: Floats) -> Verdict:
    """The verdict that no two struts, nodes of so much `reach` (N,), or node and strut meet that share no point.

    Of each pair the least distance is that of segments and points in doubles.  It is refuted where a point is inside of
    two struts, which are straight from and to `ends` (E, 2), in parts of their lengths.
    """
    for status, reason, place in _doubts(network, reach, ends):
        x, y, z = place.tolist()
        return Verdict(status, "nothing else meets", reason, (x, y, z))
    reason = "struts and nodes that share no point are farther apart than they are thick"
    return Verdict(Status.PROVED, "nothing else meets", reason, measure=len(network.edges))


def _doubts(network: StrutGraph, reach: Floats, ends: Floats) -> Iterator[tuple[Status, str, Floats]]:
    """What meets, first, and what may meet: why, and where."""
    close, points = list(crossing(network)), network.points
    for i, j, distance in close:
        if (point := _common(network, ends, i, j)) is not None:
            yield Status.REFUTED, f"the struts {i} and {j}, {distance:.4g} from one another, overlap", point
    for i, j, distance in close:
        reason = f"the struts {i} and {j} come within {distance:.4g} of one another"
        yield Status.UNDECIDED, reason, points[network.edges[i]].mean(axis=0)
    if not np.isfinite(reach).all():
        yield Status.UNDECIDED, f"how far the node {reach.argmax()} reaches is not proved", points[reach.argmax()]
    for i, other, free in _near_nodes(network, reach, ends):
        said = f"the node {i}, which reaches {reach[i]:.4g} far, may meet {other}, {free:.4g} away"
        reason = f"{said}; thinner struts, or wider angles between those of the node, end nearer to it"
        yield Status.UNDECIDED, reason, points[i]


def _slack(network: StrutGraph) -> float:
    return ROUNDING * float(network.lengths.max(initial=0) + np.abs(network.points).max(initial=0))


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
    half, slack = np.float64(network.grid / 2), _slack(network)
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


def _near_nodes(network: StrutGraph, reach: Floats, ends: Floats) -> Iterator[tuple[int, str, float]]:
    """Nodes that may meet the straight part of a strut that does not end there, or a node that is no neighbour: number,
    what, distance."""
    edges, points = network.edges, network.points
    used, slack = np.flatnonzero(network.valence), _slack(network)
    far = float(network.lengths.max() / 2 + reach.max() + network.thickness.max())
    for here, strut in _near(points[used], _middles(network), far):
        apart = (edges[strut] != used[here][:, None]).all(axis=1)
        node, other = used[here[apart]], strut[apart]
        straight = _straight(network, ends, other)
        distance = segment_distances(np.stack([points[node]] * 2, axis=1), straight)
        close = distance < reach[node] + network.thickness[other] + slack
        yield from ((n, f"strut {m}", d) for n, m, d in _listed(node, other, distance, close))
    joined = np.sort(np.sort(edges, axis=1) @ (len(points), 1))
    for first, second in _near(points[used], points[used], 2 * float(reach.max()) + slack):
        node, other = used[first[first < second]], used[second[first < second]]
        distance = np.linalg.norm(points[node] - points[other], axis=1)
        close = distance < reach[node] + reach[other] + slack
        pairs = node[close] * len(points) + other[close]
        close[close] = joined[np.searchsorted(joined, pairs).clip(max=len(joined) - 1)] != pairs
        yield from ((n, f"node {m}", d) for n, m, d in _listed(node, other, distance, close))


def _straight(network: StrutGraph, ends: Floats, struts: Any) -> Floats:
    """The axes of some struts (M, 2, 3) where these are straight, from and to `ends` (E, 2)."""
    first, second = (network.points[network.edges[struts, end]] for end in (0, 1))
    here, there = (ends[struts, end, None] for end in (0, 1))
    return np.stack([first + here * (second - first), second - there * (second - first)], axis=1)


def _listed(first: Integers, second: Integers, distance: Floats, close: Any) -> Iterator[tuple[int, int, float]]:
    return zip(first[close].tolist(), second[close].tolist(), distance[close].tolist(), strict=True)


def _common(network: StrutGraph, ends: Floats, first: int, second: int) -> Floats | None:
    """A point inside of the straight parts of two struts, with room for rounding; None where none was found."""
    pair = [first, second]
    start, way = network.points[network.edges[pair, 0]], network.vectors[pair] * float(network.grid)
    widths, tops = network.widths[pair], np.stack([ends[pair, 0], 1 - ends[pair, 1]], axis=1)
    straight = _straight(network, ends, pair)
    one, other = near = np.concatenate(nearest_points(straight[:1], straight[1:]))

    def along_and_radii(points: Floats) -> tuple[Floats, Floats]:
        along = np.einsum("ni,ni->n", points - start, way) / np.einsum("ni,ni->n", way, way)
        return along, widths[:, 0] + along * (widths[:, 1] - widths[:, 0])

    radii = along_and_radii(near)[1]
    inwards = straight.mean(axis=1) - near
    inwards /= np.maximum(np.linalg.norm(inwards, axis=1, keepdims=True), 1e-300)
    pulled = near + inwards * (radii[::-1, None] - np.linalg.norm(one - other)) / 2
    for point in (one + (other - one) * radii[0] / radii.sum(), *pulled):
        along, thick = along_and_radii(point)
        off = np.linalg.norm(point - start - along[:, None] * way, axis=1)
        room = np.min([along - tops[:, 0], tops[:, 1] - along], axis=0) * network.lengths[pair]
        if (np.minimum(room, thick - off) > _slack(network)).all():
            return np.asarray(point)
    return None


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
