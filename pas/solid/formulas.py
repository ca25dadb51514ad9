"""Profiles as sets of inequalities: each edge stands in the formula of a polygon once, arcs add caps or take them away.

Source of the formula: Dobkin, Guibas, Hershberger and Snoeyink (1993).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import reduce
from operator import and_, or_
from typing import Any, Protocol

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import dot
from pas.solid.edges import Loop, PlaneEdge, Point, across, minus, radius_of
from pas.solid.tree import Atom, Tree, combined, complement, folded

Truth = Tree | bool
"""A set in space, or all of it, or nothing."""

Lift = Callable[[Loop, bool], Tree]
"""What makes the set in space of a loop; of the points outside of it where the second argument is true."""


class PlaneSet(Protocol):
    """A set of points of the plane between loops."""

    def tree(self, lift: Lift) -> Tree:
        """The set in space with its loops lifted there."""

    @property
    def all_loops(self) -> Iterable[Loop]:
        """The loops of which it is made, from left to right."""

    @property
    def boundary(self) -> tuple[Loop, ...] | None:
        """The loops around it, with what is inside to their left; None where those of parts cross or touch."""

    def operands(self, over: Callable[[Any], Any]) -> tuple[tuple[Any, ...], str]:
        """The solids over its parts, and the operation, named as for `boolean`, that makes the one over it of them."""


def formula(loop: Loop, atom: Callable[[PlaneEdge], Truth], wall: Callable[[PlaneEdge], Truth]) -> Tree:
    """What is inside a loop that is counterclockwise, by inequalities.

    It is what is inside its chords, and caps that arcs add or take away; their triangles are apart.

    `atom` makes the set to the left of an edge, of an arc that on its concave side; `wall` that to the left of an arc's
    chord.
    """
    if loop.whole:
        found = atom(loop.edges[0])
    else:
        edges = loop.separated
        places, n = [edge.start for edge in edges], len(edges)
        first, last = places.index(min(places)), places.index(max(places))
        chains = (first, (last - first) % n), (last, (first - last) % n)
        sides = [wall(edge) if edge.bow else atom(edge) for edge in edges]
        inside = joined(False, *(_chain(edges, sides, *chain) for chain in chains))
        caps = [joined(False, atom(e), negated(side)) for e, side in zip(edges, sides, strict=True) if e.bow > 0]
        bays = [
            joined(True, negated(atom(e)), negated(side)) for e, side in zip(edges, sides, strict=True) if e.bow < 0
        ]
        frame = (
            [wall(edge) for edge in _frame(edges)] if any(e.bow and radius_of(e.curve) is None for e in edges) else []
        )
        found = joined(False, joined(True, inside, *caps), *bays, *frame)
    assert not isinstance(found, bool)
    return found


def joined(union: bool, *parts: Truth) -> Truth:
    """The union or intersection of sets, all of space and nothing among them."""
    if any(part is union for part in parts):
        return union
    sets = [part for part in parts if not isinstance(part, bool)]
    return combined(union, *sets) if sets else not union


def negated(part: Truth) -> Truth:
    """What is not in a set."""
    return not part if isinstance(part, bool) else complement(part)


def _chain(edges: Sequence[PlaneEdge], sides: Sequence[Truth], begin: int, many: int) -> Truth:
    """What is to the left of consecutive chords, of which the first and the last go on endlessly.

    It is divided at a corner of the convex hull: there both parts hold, or one of them does, as it is convex or not.
    """
    n = len(edges)
    if many == 1:
        return sides[begin % n]
    mine = [edges[(begin + k) % n] for k in range(many)]
    chords = [minus(edge.end, edge.start) for edge in mine]
    direction = _outermost(chords[0], chords[-1])
    heights = [dot(direction, edge.start) for edge in mine]
    highest = max(heights[1:])
    corners = [k for k in range(1, many) if heights[k] == highest]
    k = next((k for k in corners if across(chords[k - 1], chords[k]) != 0), corners[0])
    parts = _chain(edges, sides, begin, k), _chain(edges, sides, begin + k, many - k)
    return joined(across(chords[k - 1], chords[k]) < 0, *parts)


def _frame(edges: Sequence[PlaneEdge]) -> list[PlaneEdge]:
    """The sides of a rectangle around edges with room to spare, which bounds caps of curves that go on endlessly."""
    (a, b), (c, d) = (
        (min(values) - (max(values) - min(values)) / 8, max(values) + (max(values) - min(values)) / 8)
        for values in zip(*(p for edge in edges for p in edge.hull), strict=True)
    )
    corners = (a, c), (b, c), (b, d), (a, d)
    return [PlaneEdge.straight(p, q, "") for p, q in zip(corners, corners[1:] + corners[:1], strict=True)]


def _outermost(first: Point, last: Point) -> Point:
    """A direction in which neither the ray against `first` nor the one along `last` rises."""
    side = across(first, last)
    if side == 0:
        return first if dot(first, last) < 0 else (first[1], -first[0])
    sizes = [abs(v[0]) + abs(v[1]) for v in (first, last)]
    x, y = (first[i] / sizes[0] + last[i] / sizes[1] for i in (0, 1))
    return (y, -x) if side > 0 else (-y, x)


def values(tree: Tree, sign: Callable[[Polynomial], Any]) -> Any:
    """Whether points are in a set of polynomials, of which `sign` gives values at them."""

    def value(atom: Atom) -> Any:
        assert isinstance(atom.function, Polynomial)
        return (sign(atom.function) <= 0) != atom.outside

    return folded(tree, value, lambda node, parts: reduce(or_ if node.union else and_, parts))
