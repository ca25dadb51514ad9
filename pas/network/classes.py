"""Which nodes are the same: kinds, told apart by the struts' vectors, and classes of kinds up to rotations and
reflections.

A kind is what the nodes have in common whose struts have the same vectors, radii and given clips; there are as many as
a lattice has orientations of nodes.  Classes are those of kinds, by an exact canonical form: arms are numbered by their
inner products with a frame of at most three independent arms. The canonical frame is the one with the least table of
products in lexicographic order, so frames grow arm by arm, and only those with the least row so far are continued.
Inner products with three independent vectors determine a vector, and those within a frame the frame up to an isometry;
so two kinds have one form if and only if an isometry takes one to the other.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from flint import fmpz_mat

from pas.algebra.affine import Affine
from pas.algebra.rational import dot, vector
from pas.arrays import Floats, Integers, Numbers
from pas.mesh.topology import MOST, first_rows, numbered
from pas.network.graph import StrutGraph
from pas.pipeline.session import linear_maps

AUTO = 0
"""Of clips in parts of a strut's length: that the program is to find it."""


@dataclass(frozen=True)
class NodeKind:
    """The arms of nodes: vectors in steps of the grid, numbers of the radii here and at the other end, and clips in
    64ths of the vector (0: auto)."""

    arms: tuple[tuple[tuple[int, int, int], int, int, int], ...]

    @cached_property
    def vectors(self) -> Integers:
        """The arms' vectors (n, 3), in steps."""
        return np.array([arm[0] for arm in self.arms], dtype=np.int64)

    @cached_property
    def form(self) -> CanonicalForm:
        """Its canonical form, see above."""
        arms, products = range(len(self.arms)), (self.vectors @ self.vectors.T).tolist()
        rank = int(fmpz_mat(products).rank())

        def row(i: int, frame: tuple[int, ...]) -> tuple[int, ...]:
            return (*self.arms[i][1:], products[i][i], *(products[i][j] for j in frame))

        least: tuple[tuple[int, ...], ...] = ()
        frames: list[tuple[int, ...]] = [()]
        for size in range(1, rank + 1):
            longer = [(*frame, i) for frame in frames for i in arms]
            longer = [f for f in longer if fmpz_mat(size, size, [products[i][j] for i in f for j in f]).det()]
            rows = [row(frame[-1], frame[:-1]) for frame in longer]
            least = (*least, min(rows))
            frames = [frame for frame, found in zip(longer, rows, strict=True) if found == least[-1]]
        orders = [tuple(sorted(arms, key=lambda i: row(i, frame))) for frame in frames]
        written = [tuple(row(i, frame) for i in order) for order, frame in zip(orders, frames, strict=True)]
        best = min(written)
        symmetries = (0, 0, 2, 1)[rank] * written.count(best)
        return CanonicalForm((least, best), orders[written.index(best)], rank, symmetries)

    @cached_property
    def blended(self) -> bool:
        """Whether it takes a blend: not at ends of struts, nor where one goes straight on with one radius."""
        first, *others = self.arms
        sizes = {size for arm in self.arms for size in arm[1:3]}
        opposite = len(others) == 1 and dot(first[0], others[0][0]) < 0 and self.form.rank == 1
        return bool(others) and not (opposite and len(sizes) == 1)


@dataclass(frozen=True)
class CanonicalForm:
    """A kind's `key`, which it shares with the kinds that are it turned; how it is turned to that, and its symmetries.

    `order` lists its arms in the order of the key, `rank` is the dimension that they span; `symmetries` is the number
    of rotations and reflections that take it to itself, 0 where there are infinitely many.
    """

    key: tuple[Any, ...]
    order: tuple[int, ...]
    rank: int
    symmetries: int


@dataclass(frozen=True, eq=False)
class Kinds:
    """The kinds of a network's nodes: that of each point (N,), and which of its kind's arms each strut is at both ends
    (E, 2).

    Points without struts have the kind -1.  `arm_ends[kind, arm]` says where arms end, in parts of their vectors, once
    they have been placed.
    """

    network: StrutGraph
    kinds: tuple[NodeKind, ...]
    of: Numbers
    slots: Numbers
    arm_ends: Floats = field(default_factory=lambda: np.zeros((0, 0)))

    @cached_property
    def classes(self) -> dict[tuple[Any, ...], NodeClass]:
        """The classes of the kinds, by their keys."""
        found: dict[tuple[Any, ...], list[int]] = {}
        for number, kind in enumerate(self.kinds):
            found.setdefault(kind.form.key, []).append(number)
        return {key: NodeClass(self, tuple(numbers)) for key, numbers in found.items()}

    @property
    def by_frequency(self) -> tuple[NodeClass, ...]:
        """The classes, the most frequent first."""
        return tuple(sorted(self.classes.values(), key=lambda one: -one.count))

    @cached_property
    def nodes(self) -> list[Numbers]:
        """The points of each kind."""
        return grouped(self.of, len(self.kinds))

    @cached_property
    def struts(self) -> tuple[Numbers, Integers]:
        """The kind of each strut (E,), by the kinds of its nodes and its arms there, and the first of each."""
        edges, slots = self.network.edges.T, self.slots.T
        return ranked(column for end in (0, 1) for column in (self.of[edges[end]], slots[end]))  # one at a time

    @property
    def ends(self) -> Floats:
        """Where each strut begins and ends (E, 2), in parts of its length."""
        return np.asarray(self.at_ends(self.arm_ends))

    def at_ends(self, table: Any, struts: Any = slice(None)) -> Any:
        """The entries of a table of all kinds' arms (K, most arms) for the arms of some struts at both ends (E, 2)."""
        return table[self.of[self.network.edges[struts]], self.slots[struts]]


@dataclass(frozen=True, eq=False)
class NodeClass:
    """Nodes that are congruent, with the numbers of their kinds, of which the first represents them."""

    kinds: Kinds
    numbers: tuple[int, ...]

    @property
    def kind(self) -> NodeKind:
        """The kind that represents it."""
        return self.kinds.kinds[self.numbers[0]]

    @cached_property
    def nodes(self) -> Numbers:
        """The numbers (M,) of the points of its nodes."""
        return np.sort(np.concatenate([self.kinds.nodes[number] for number in self.numbers]))

    @property
    def count(self) -> int:
        """The number of nodes."""
        return len(self.nodes)

    @property
    def ends(self) -> tuple[float, ...] | None:
        """Where its arms end, in parts of their vectors; None until they have been placed."""
        known = self.kinds.arm_ends
        return tuple(known[self.numbers[0], : len(self.kind.arms)].tolist()) if len(known) else None

    @property
    def circles(self) -> Floats:
        """How far away the end of each arm is, and the radius there (n, 2), in the model's units."""
        ends, vectors = np.array(self.ends), self.kind.vectors * float(self.kinds.network.grid)
        here, there = np.array([[float(r) for r in radii] for _, *radii in self.struts]).T
        return np.stack([ends * np.linalg.norm(vectors, axis=1), here + (there - here) * ends], axis=1)

    @property
    def struts(self) -> tuple[tuple[tuple[int, int, int], Fraction, Fraction], ...]:
        """Vector in steps of the grid, and radii (the model's units) here and at the other end, of each arm."""
        radii = self.kinds.network.radii
        return tuple((vector, radii[size], radii[far]) for vector, size, far, _ in self.kind.arms)

    @property
    def symmetries(self) -> int:
        """The number of rotations and reflections that take it to itself; 0 where there are infinitely many."""
        return self.kind.form.symmetries

    @property
    def blended(self) -> bool:
        """Whether it takes a blend: not at ends of struts, nor where one goes straight on."""
        return self.kind.blended

    def __str__(self) -> str:
        sides = {0: "symmetric about an axis", 1: "no symmetry"}.get(self.symmetries, f"{self.symmetries} symmetries")
        arms = len(self.kind.arms)
        return f"{self.count} node{'s' * (self.count > 1)} of {arms} strut{'s' * (arms > 1)}, {sides}"


def kinds_of(network: StrutGraph, clips: Any = AUTO) -> Kinds:
    """The kinds of the points of a network with given clips (E, 2), in 64ths of the struts or 0."""
    edges, count = network.edges, len(network.places)
    clips = np.broadcast_to(clips, edges.shape)
    labels = network.sizes, network.sizes[:, ::-1], clips
    ways = (np.concatenate([way, -way]) for way in network.vectors.T)
    codes, firsts = ranked(chain(ways, (some.T.ravel() for some in labels)))
    owners = edges.T.ravel()
    order = np.lexsort((codes, owners))
    valence = network.valence
    starts = (np.cumsum(valence) - valence).astype(np.int32)
    slots = np.empty(len(owners), dtype=np.int32)
    slots[order] = np.arange(len(owners), dtype=np.int32)
    slots -= starts[owners]
    table = np.full((count, int(valence.max(initial=1))), -1, dtype=np.int32)
    table[owners, slots] = codes
    used = np.flatnonzero(valence)
    of, first = ranked(table[used].T)
    end, strut = np.divmod(firsts, len(edges))
    vectors = network.vectors[strut] * (1 - 2 * end[:, None])
    rows = np.column_stack([vectors, *(some[strut, end] for some in labels)]).tolist()
    arms = [[rows[code] for code in table[node] if code >= 0] for node in used[first]]
    kinds = tuple(NodeKind(tuple(((x, y, z), *labels) for x, y, z, *labels in kind)) for kind in arms)
    kind_of = np.full(count, -1, dtype=np.int32)
    kind_of[used] = of
    return Kinds(network, kinds, kind_of, slots.reshape(2, -1).T)


def ranked(columns: Iterable[Any]) -> tuple[Numbers, Integers]:
    """A number for each row of a table, equal for equal rows and in their order, and the first row of each number."""
    codes, size = np.zeros(1, dtype=np.int64), 1
    for column in columns:
        values = np.subtract(column, column.min(initial=0), dtype=np.int64)
        if size * (span := int(values.max(initial=0)) + 1) > MOST:
            codes, values = numbered(codes)[1], numbered(values)[1]
            size, span = (int(some.max(initial=0)) + 1 for some in (codes, values))
        codes *= span  # in place: of a million struts each copy is 8 MB
        values += codes
        codes, size = values, size * span
    codes = numbered(codes)[1]
    return codes.astype(np.int32), first_rows(codes, int(codes.max(initial=-1)) + 1)


def grouped(of: Any, count: int) -> list[Numbers]:
    """Where each of the numbers below a count stands in an array, which has others only where it is -1."""
    order = np.argsort(of, kind="stable").astype(np.int32)
    return np.split(order, np.searchsorted(of[order], np.arange(count)))[1:]


def turn(before: NodeKind, after: NodeKind) -> Affine:
    """The exact rotation or reflection that takes one kind to another of its class, arms in the order of the key."""
    old, new = ([vector(kind.arms[i][0]) for i in kind.form.order] for kind in (before, after))
    return linear_maps(old, new)[0][0]
