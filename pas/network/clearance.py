"""That nothing of a network meets but what should: the surfaces of nodes, of the straight parts of struts between them,
and of their flat ends.

What shares a node meets only where it should by the proofs of the node: its surface is crossed once by each ray from
the centre, and not at all in the directions of its clips' circles, in which the struts go away from it.  Struts that
share no point are farther apart than they are thick.  Nodes are apart from others, neighbours or not, and from struts
that do not end there, where balls around them are, or where it is proved of their surfaces (`pas.network.covers`).

So each connected piece has one closed surface that does not meet itself, and every point off it is as often inside of
its nodes and struts as the surface winds around it: in one at most.  Of several pieces none is inside of another, as
of each the middle of a strut is in no node of another one, which is decided exactly.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pas.algebra.inputs import shown_point
from pas.algebra.rational import Vector, to_floats
from pas.arrays import Floats
from pas.network.classes import grouped
from pas.network.covers import NodeCovers
from pas.network.graph import NetworkProblem, StrutGraph, problems_text
from pas.network.near import Capsules, near, nearest_points
from pas.network.overlaps import common_point
from pas.verdicts import Status, Verdict

MAY_MEET = "may meet; thinner struts, or wider angles between those of a node, end nearer to it"

WORDS = {
    "near struts": ("the struts {} and {}, {} from one another,", MAY_MEET),
    "node and strut": ("the node {} and the strut {}, {} from its point,", MAY_MEET),
    "nodes": ("the nodes {} and {}, {} from one another,", MAY_MEET),
    "enclosed": ("the piece of point {} and another one", "may be one inside of the other"),
}
"""The words for each kind of doubt: its subject, and what of it is not decided."""

Doubt = tuple[tuple[int, ...], float, int, Vector | None]
"""Numbers of nodes, struts or both, how far apart they are, that of a point, and if any one inside of both about it."""


def clearance(network: StrutGraph, covers: NodeCovers) -> tuple[Verdict, tuple[NetworkProblem, ...]]:
    """The verdict that nothing meets that shares no point, nor neighbours, and all that may, with numbers of points and
    struts.

    It is refuted where a point is inside of two nodes, or struts where they are straight.
    """
    found = sorted(_doubts(network, covers), key=lambda doubt: doubt[0] is not Status.REFUTED)
    problems = tuple(problem for *_, problem in found)
    for status, place, _ in found:
        return Verdict(status, "nothing else meets", problems_text(problems), tuple(place.tolist())), problems
    reason = "nodes, also neighbours, and struts that share no point are apart"
    return Verdict(Status.PROVED, "nothing else meets", reason, measure=len(network.edges)), ()


def _doubts(network: StrutGraph, covers: NodeCovers) -> Iterator[tuple[Status, Floats, NetworkProblem]]:
    """The pairs that meet, or may meet: the status, the place and the problem of each."""
    finders = {
        "near struts": _crossing_struts(network, covers),
        "node and strut": _beside_nodes(network, covers, covers.struts),
        "nodes": _beside_nodes(network, covers, covers.nodes),
        "enclosed": _enclosed(network, covers),
    }
    for kind, doubts in finders.items():
        names, doubtful = WORDS[kind]
        for ids, distance, about, common in doubts:
            status, place, said = Status.UNDECIDED, network.points[about], doubtful
            if common is not None:
                status, place = Status.REFUTED, place + float(network.grid) * np.array(to_floats(common))
                said = f"overlap at {shown_point(place)}; make struts there thinner, or move their points apart"
            yield status, place, NetworkProblem(kind, ids, f"{names.format(*ids[:2], f'{distance:.4g}')} {said}")


def _crossing_struts(network: StrutGraph, covers: NodeCovers) -> Iterator[Doubt]:
    """Struts without a common point that come nearer than their radii, looked into where these are straight."""
    step = float(network.grid)
    for i, j, distance in network.crossings:
        pair, about = [i, j], int(network.edges[i, 0])
        ways, widths, straight = network.vectors[pair] * step, network.widths[pair], covers.struts.segments(pair)
        one, other = near_ = np.concatenate(nearest_points(straight[:1], straight[1:]))
        along = ((near_ - network.points[network.edges[pair, 0]]) * ways).sum(axis=1) / (ways**2).sum(axis=1)
        radii = widths[:, 0] + along * (widths[:, 1] - widths[:, 0])
        inwards = straight.mean(axis=1) - near_
        inwards /= np.maximum(np.linalg.norm(inwards, axis=1, keepdims=True), 1e-300)
        pulled = near_ + inwards * (radii[::-1, None] - np.linalg.norm(one - other)) / 2
        points = np.stack([one + (other - one) * radii[0] / radii.sum(), *pulled]) - network.points[about]
        solids = covers.strut(i, about), covers.strut(j, about)
        yield (i, j), distance, about, common_point(points / step, *solids)


def _beside_nodes(network: StrutGraph, covers: NodeCovers, others: Capsules) -> Iterator[Doubt]:
    """Nodes that may meet others, or struts that do not end there where these are straight."""
    for rows, other, distance in near(covers.nodes, others, network.slack):
        nodes = covers.nodes.of[rows, 0]
        numbers = other if others is covers.struts else others.of[other, 0]
        pairs = zip(
            nodes.tolist(), numbers.tolist(), distance.tolist(), covers.apart(nodes, others, other), strict=True
        )
        yield from (((i, j), far, i, found.common) for i, j, far, found in pairs if not found.proved)


def _enclosed(network: StrutGraph, covers: NodeCovers) -> Iterator[Doubt]:
    """The points of each piece of which a strut's middle is in a node of another one, or all are on such surfaces."""
    from scipy.spatial import cKDTree

    if network.pieces < 2:
        return
    of, nodes, tree = network.components, covers.nodes, cKDTree(covers.nodes.middles)
    for number, struts in enumerate(grouped(of[network.edges[:, 0]], int(of.max()) + 1)):
        side = 1
        for i in struts.tolist():
            about = int(network.edges[i, 0])
            middle = covers.strut(i, about).middle
            near_ = nodes.of[tree.query_ball_point(covers.struts.middles[i], nodes.far + network.slack), 0]
            side = min((covers.node(j, about).side(middle) for j in near_[of[near_] != number].tolist()), default=1)
            if side:
                break
        if side <= 0:
            yield tuple(np.flatnonzero(of == number).tolist()), 0.0, about, middle if side else None
