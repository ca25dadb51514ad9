"""Problems of a network, and the repair of some of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import combinations
from math import cos, pi, radians
from typing import Any, TypeVar

import numpy as np

from pas.algebra.inputs import check_flag, shown, whole
from pas.algebra.lengths import unit
from pas.arrays import Floats, Integers, Numbers
from pas.mesh.topology import connected
from pas.network.classes import Kinds, kinds_of, ranked
from pas.network.graph import NetworkProblem, StrutGraph
from pas.network.near import nearest_points

LEAST_ANGLE = 10.0
"""Degrees between struts at a node, below which no pipe ends apart from another (see `pas.struts`)."""

NEAREST = 0.45
"""Of the least angle at a node: circles seen under more are met by no blend, as those of two struts must be apart."""


def check(network: StrutGraph, entire: bool) -> tuple[NetworkProblem, ...]:
    """See `Network.check`."""
    found = [*graph_problems(network)]
    if not found:
        kinds = kinds_of(network)
        found += [*_angles(kinds)]
        found += [*([] if found else _short(kinds)), *_crossing(network)]
    if entire:
        ends = np.flatnonzero(network.valence == 1).tolist()
        found += [NetworkProblem("dangling", (n,), f"point {n} has one strut only, which ends there") for n in ends]
        if len(network.edges) and network.pieces > 1:
            points = network.edges[np.unique(network.components[network.edges[:, 0]], return_index=True)[1], 0].tolist()
            sentence = f"there are {len(points)} pieces that do not meet, of the points {shown(points)}"
            found.append(NetworkProblem("disconnected", tuple(points), sentence))
    return tuple(found)


def graph_problems(network: StrutGraph) -> Iterator[NetworkProblem]:
    """Loops, struts that are there twice, points in one place and points without struts."""
    edges = network.edges
    if not len(edges):
        yield NetworkProblem("empty", (), "the network has no struts")
    for number in np.flatnonzero(edges[:, 0] == edges[:, 1]).tolist():
        yield NetworkProblem("loop", (number,), f"strut {number} begins and ends at point {edges[number, 0]}")
    for first, second in _repeated(np.sort(edges, axis=1)):
        yield NetworkProblem("duplicate", (first, second), f"the struts {first} and {second} join the same points")
    for first, second in _repeated(network.places):
        yield NetworkProblem("duplicate", (first, second), f"the points {first} and {second} are in one place")
    for number in np.flatnonzero(network.valence == 0).tolist():
        yield NetworkProblem("isolated", (number,), f"point {number} has no strut")


def _repeated(rows: Integers) -> list[tuple[int, int]]:
    """Numbers of rows with the number of the first row that is equal, that first."""
    before = _firsts(rows)
    again = np.flatnonzero(before != np.arange(len(rows)))
    return list(zip(before[again].tolist(), again.tolist(), strict=True))


def _firsts(rows: Integers) -> Integers:
    """For each row the number of the first one that is equal."""
    codes, firsts = ranked(rows.T)
    return firsts[codes]


def _least_angles(kinds: Kinds) -> tuple[Floats, Numbers]:
    """For the arms of all kinds (K, most arms) the least angle with another, in radians, and that one's number."""
    most = max((len(kind.arms) for kind in kinds.kinds), default=0)
    least, other = np.full((len(kinds.kinds), most), pi), np.zeros((len(kinds.kinds), most), dtype=np.int32)
    for number, kind in enumerate(kinds.kinds):
        units = unit(kind.vectors)
        products = units @ units.T - 3 * np.eye(len(units))
        least[number, : len(units)] = np.arccos(products.max(axis=1).clip(-1, 1))
        other[number, : len(units)] = products.argmax(axis=1)
    return least, other


def _narrow(kinds: Kinds) -> Iterator[tuple[int, int, int, float]]:
    """Struts that meet at too small an angle: two numbers, the point, and the angle in degrees."""
    (least, other), edges = _least_angles(kinds), kinds.network.edges
    struts = np.zeros((len(kinds.of), least.shape[1]), dtype=np.int32)
    struts[edges, kinds.slots] = np.arange(len(edges))[:, None]
    for strut, end in np.argwhere(kinds.at_ends(least < radians(LEAST_ANGLE))).tolist():
        node, slot = int(edges[strut, end]), kinds.slots[strut, end]
        if strut < (second := int(struts[node, other[kinds.of[node], slot]])):
            yield strut, second, node, float(np.degrees(least[kinds.of[node], slot]))


def _angles(kinds: Kinds) -> Iterator[NetworkProblem]:
    for first, second, node, angle in _narrow(kinds):
        meet = f"the struts {first} and {second} meet at point {node} at {angle:.3g} degrees"
        yield NetworkProblem("angle too small", (first, second), f"{meet}; {LEAST_ANGLE:g} are the least")


def nearest(kinds: Kinds) -> Floats:
    """From the ends of each strut the lengths (E, 2) below which no blends fit there, in the model's units."""
    angles = np.maximum(NEAREST * _least_angles(kinds)[0], 1e-9)
    near = 1 / np.tan(np.minimum(angles, radians(80)))
    near[[len(kind.arms) == 1 for kind in kinds.kinds]] = 0.0
    return np.asarray(kinds.network.widths * kinds.at_ends(near))


def _short(kinds: Kinds) -> Iterator[NetworkProblem]:
    network, least = kinds.network, nearest(kinds).sum(axis=1)
    for number in np.flatnonzero(network.lengths < least).tolist():
        a, b = network.edges[number].tolist()
        radius = network.thickness[number] * network.lengths[number] / least[number]
        sentence = (
            f"strut {number} from point {a} to {b} is {network.lengths[number]:.4g} long, and blends of the radius "
            f"{network.thickness[number]:.4g} need {least[number]:.4g}; a radius of {radius:.3g} may fit, or "
            "it may become a point: repair(collapse=True), --collapse"
        )
        yield NetworkProblem("too short", (number,), sentence, (number,))


def _crossing(network: StrutGraph) -> Iterator[NetworkProblem]:
    for i, j, distance in network.crossings:
        need = network.thickness[i] + network.thickness[j]
        passing = f"the struts {i} and {j} pass at {distance:.4g} from one another and are {need:.4g} thick together"
        yield NetworkProblem(
            "crossing", (i, j), f"{passing}; thinner ones fit, or a point in which both end: repair(join=True), --join"
        )


G = TypeVar("G", bound=StrutGraph)


def repair(network: G, collapse: bool | Sequence[int], join: bool) -> tuple[G, tuple[str, ...]]:
    """See `Network.repair`."""
    check_flag(join, "join")
    if not isinstance(collapse, bool):
        if not isinstance(collapse, Iterable) or isinstance(collapse, str):
            raise TypeError(f"collapse must be true, false or the numbers of struts, not {shown(collapse)}")
        struts = [whole(n, "collapse", 0, len(network.edges) - 1, "the struts") for n in collapse]
        found, changes = _collapsed(network, np.unique(np.array(struts, dtype=np.int64)))
    else:
        found, changes = _mended(network)
    crossings = np.inf
    while True:
        if collapse is not False and len(first := _apart(found, _unserved(found))):
            found, more = _collapsed(found, first)
            changes += [line for line in more if "became a point" in line or "twice" in line]
        elif join and 0 < len(found.crossings) < crossings:
            crossings = len(found.crossings)
            found, more = _joined(found)
            changes += more
        else:
            return found, tuple(changes)


def _collapsed(network: G, struts: Integers) -> tuple[G, list[str]]:
    """With some struts made points, in the middle of all points that they join; what was changed."""
    joined = connected(network.edges[struts], len(network.points))
    sums = [np.bincount(joined, weights=column) for column in network.points.T]
    points = (np.stack(sums) / np.bincount(joined)).T[joined]
    mended, changes = _mended(_changed(network, points, network.edges, slice(None)))
    return mended, [f"strut {n}, {network.lengths[n]:.4g} long, became a point" for n in struts.tolist()] + changes


def _joined(network: G) -> tuple[G, list[str]]:
    """With a point for two struts that cross, in which both end now; of several that cross one strut the nearest first,
    the others in a later round.  What was changed.

    It is in the middle between them, or where one ends that near to the other; two that end there meet in the middle.
    Struts that would meet at too small an angle stay as they are.
    """
    points, edges, changes = [*network.points], network.edges.tolist(), list[str]()
    radii = [(network.radii[a], network.radii[b]) for a, b in network.sizes.tolist()]
    taken, parts = set[int](), 64  # of a cone, in which its radius there is found
    for i, j, _ in sorted(network.crossings, key=lambda crossing: crossing[2]):
        pair, segments = [i, j], network.points[network.edges[[i, j]]]
        places = np.concatenate(nearest_points(segments[:1], segments[1:]))
        away = np.linalg.norm(segments - places[:, None], axis=2)  # of both places from the ends of their struts
        ends = away < network.thickness[pair].sum()
        units = unit(segments[:, 1] - segments[:, 0]) * np.where(ends[:, 1:], -1, 1)
        along = float(units[0] @ units[1])
        if taken & {i, j} or (along if ends.any(axis=1).all() else abs(along)) > cos(radians(LEAST_ANGLE)):
            continue
        taken |= {i, j}
        known = [int(network.edges[strut, away[k].argmin()]) for k, strut in enumerate(pair) if ends[k].any()]
        place = (network.points[known] if known else places).mean(axis=0)
        points += [] if known else [place]
        middle, *others = known or [len(points) - 1]
        for point in (middle, *others):
            points[point] = place
        for strut, far in zip(pair, away[:, 0], strict=True):
            (start, end), (here, there) = edges[strut], radii[strut]
            if not {start, end} & {*known}:
                between = here + (there - here) * Fraction(round(parts * far / network.lengths[strut]), parts)
                edges[strut], radii[strut] = [start, middle], (here, between)
                edges.append([middle, end])
                radii.append((between, there))
        changes.append(f"the struts {i} and {j}, which crossed, end in a point between them")
    mended, _ = _mended(type(network)(points, edges, radii, network.grid))
    return mended, changes


def _unserved(network: StrutGraph) -> Integers:
    """Struts for whose ends there are no blends: too short ones; where there are none, of those that are between the
    ends of two the shortest, if these meet at too small an angle, or cross and are thicker together than it is long."""
    kinds = kinds_of(network)
    short = np.flatnonzero(network.lengths < nearest(kinds).sum(axis=1))
    if len(short):
        return short
    numbers = {(min(edge), max(edge)): n for n, edge in enumerate(network.edges.tolist())}
    pairs = [(i, j, np.inf) for i, j, *_ in _narrow(kinds)]
    pairs += [(i, j, network.thickness[i] + network.thickness[j]) for i, j, _ in network.crossings]
    found = set()
    for i, j, most in pairs:
        ends = sorted({*network.edges[[i, j]].ravel().tolist()})
        between = [numbers[pair] for pair in combinations(ends, 2) if pair in numbers]
        least = min(between, key=network.lengths.__getitem__)
        found.update([least] if network.lengths[least] <= most else [])
    return np.array(sorted(found), dtype=np.int64)


def _apart(network: StrutGraph, short: Integers) -> Integers:
    """Those of some struts, the shortest first, that share no point with one before."""
    taken, chosen = np.zeros(len(network.places), dtype=bool), []
    for number in short[np.argsort(network.lengths[short], kind="stable")].tolist():
        a, b = network.edges[number]
        if not taken[a] and not taken[b]:
            taken[[a, b]] = True
            chosen.append(number)
    return np.array(chosen, dtype=np.int64)


def _changed(network: G, points: Floats, edges: Any, kept: Any) -> G:
    """With other points and ends of some of the struts, their radii as they were."""
    radii = [(network.radii[a], network.radii[b]) for a, b in network.sizes[kept].tolist()]
    return type(network)(points, edges, radii, network.grid)


def _mended(network: G) -> tuple[G, list[str]]:
    """Without loops, double struts, double points and points without struts; what was changed."""
    changes = [f"point {b} became point {a}, where it is" for a, b in _repeated(network.places)]
    edges = _firsts(network.places)[network.edges]
    loops = edges[:, 0] == edges[:, 1]
    changes += [f"strut {n} was a loop and went" for n in np.flatnonzero(loops).tolist()]
    order = np.argsort(-network.sizes.max(axis=1), kind="stable")
    order = order[~loops[order]]
    kept = np.sort(order[np.unique(_firsts(np.sort(edges[order], axis=1)))])
    changes += [f"strut {n} was there twice and went" for n in np.setdiff1d(order, kept).tolist()]
    used, numbers = np.unique(edges[kept], return_inverse=True)
    gone = np.setdiff1d(np.arange(len(network.places)), np.union1d(used, network.edges))
    changes += [f"point {n} had no strut and went" for n in gone.tolist()]
    return _changed(network, network.points[used], numbers.reshape(-1, 2), kept), changes
