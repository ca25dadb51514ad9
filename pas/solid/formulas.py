"""Sets of points of the plane, and their inequalities in space.

Each edge stands in the formula of a polygon once (Dobkin, Guibas, Hershberger and Snoeyink 1993), arcs add caps or take
them away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from operator import and_, or_
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.inputs import points_of
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import dot
from pas.arrays import Bools
from pas.errors import GeometryError
from pas.solid.edges import Loop, PlaneEdge, Point, across, apart, minus, radius_of
from pas.solid.operands import Operands
from pas.solid.solid import Solid
from pas.solid.tree import Atom, Tree, combined, complement, folded

Truth = Tree | bool
"""A set in space, or all of it, or nothing."""

Lift = Callable[[Loop, bool], Tree]
"""A function that makes the set in space of a loop; of the points outside of it where the second argument is true."""


@dataclass(frozen=True, eq=False)
class PlaneSet:
    """A set of points of the plane.

    It is inside a `loop`, or it is made of `parts`: their union, or their intersection; `outside` says that it is the
    complement of that.
    """

    loop: Loop | None = None
    parts: tuple[Self, ...] = ()
    union: bool = False
    outside: bool = False

    def tree(self, lift: Lift, turned: bool = False) -> Tree:
        """The set in space with its loops lifted there; where it is `turned` that of its complement."""
        out = self.outside != turned
        if self.loop is not None:
            found = lift(self.loop, out)
            return complement(found) if out else found
        return combined(self.union != out, *(part.tree(lift, out) for part in self.parts))

    @property
    def all_loops(self) -> Iterator[Loop]:
        """The loops of which it is made, from left to right."""
        if self.loop is not None:
            yield self.loop
        for part in self.parts:
            yield from part.all_loops

    @cached_property
    def boundary(self) -> tuple[Loop, ...] | None:
        """The loops around it, with what is inside to their left; None where those of parts cross or touch."""
        try:
            return tuple(self._boundary(False))
        except GeometryError:
            return None

    def _boundary(self, turned: bool) -> list[Loop]:
        out = self.outside != turned
        if self.loop is not None:
            return [self.loop.reversed if out else self.loop]
        union = self.union != out
        loops = [part._boundary(out) for part in self.parts]
        apart([edge for some in loops for loop in some for edge in loop.separated], _crossing)
        return [
            loop
            for part, some in zip(self.parts, loops, strict=True)
            for loop in some
            if all(other.holds(loop.edges[0].start) != (out != union) for other in self.parts if other is not part)
        ]

    def operands(self, over: Callable[[Self], Solid]) -> Operands:
        """The boundary of the solid `over` it: those over its parts, combined as it is."""
        operation = "Add" if self.union else "Subtract" if self.parts[-1].outside else "Intersect"
        return Operands.of([over(replace(part, outside=False)) for part in self.parts], operation)

    def holds(self, point: Point) -> bool:
        """Whether an exact point is inside or on the boundary."""
        return bool(self._values(lambda polynomial: polynomial.raw(*point, 0)))

    def contains(self, points: ArrayLike) -> Bools:
        """Whether points (..., 2) are inside, shape (...)."""
        flat = np.asarray(points, dtype=float)
        space = points_of(np.concatenate([flat, np.zeros((*flat.shape[:-1], 1))], axis=-1))
        return np.asarray(self._values(lambda polynomial: polynomial(space)))

    def _values(self, sign: Callable[[Polynomial], Any]) -> Any:
        """Whether points are in it, given how to find the sign of a polynomial at them."""

        def value(atom: Atom) -> Any:
            assert isinstance(atom.function, Polynomial)
            return (sign(atom.function) <= 0) != atom.outside

        return folded(self._upright, value, lambda node, parts: reduce(or_ if node.union else and_, parts))

    @cached_property
    def _upright(self) -> Tree:
        """The set in space above and below it."""
        return self.tree(lambda loop, _: formula(loop, lambda edge: Atom(edge.curve, edge.name)))


def _crossing(one: PlaneEdge, other: PlaneEdge) -> GeometryError:
    return GeometryError(f"edges {one.name!r} and {other.name!r} of two loops meet")


def formula(loop: Loop, atom: Callable[[PlaneEdge], Truth], wall: Callable[[PlaneEdge], Truth] | None = None) -> Tree:
    """What is inside a loop that is counterclockwise, by inequalities.

    It is what is inside its chords, and caps that arcs add or take away; their triangles are apart.

    `atom` makes the set to the left of an edge, of an arc that on its concave side; `wall` that to the left of an arc's
    chord, by default the one that `atom` makes of it.
    """
    wall = wall or (lambda edge: atom(PlaneEdge.straight(edge.start, edge.end, "")))
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
    """The complement of a set."""
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
    """The sides of a rectangle around edges with room to spare, which bounds caps of endless curves."""
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
