"""Truth values of trees of inequalities, given those of some inequalities.

For many boxes or points at once a tree is compiled to arrays (`CompiledTree`), without a step for each branch: a region
of a node has some hundred branches, and a mesher asks for a few boxes at a time, many thousand times.  At one exact
point a truth costs more than all branches: there a tree is read part by part, and what is not asked for is not found
out (`LeafTree`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pas.algebra.polynomial import Polynomial
from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.solid.tree import Atom, Columns, Node, Tree, atoms, folded

Bits = NDArray[np.uint8]

ALL = 0xFF
"""Eight truth values, all of them true."""

TOGETHER = 4096
"""Bytes, or values, of each branch that are kept at once, so that the table stays in the caches."""


@dataclass(frozen=True)
class Level:
    """Branches of one height: their numbers (G,), whether each is a union (G,), and their parts' numbers, those of
    one after those of another, which begin at `starts` (G,); `owners` says to which branch each part belongs."""

    numbers: Integers
    unions: Bools
    parts: Integers
    starts: Integers
    owners: Integers


class CompiledTree:
    """The unions and intersections of a tree over `width` columns, by height: many boxes or points at once.

    `column_of` gives for an inequality a column, from 0 on, that must be <= 0, and whether it is the opposite.  Leaves
    are the first numbers, the whole is the last.
    """

    def __init__(self, tree: Tree, column_of: Callable[[Atom], tuple[int, bool]]) -> None:
        leaves: list[tuple[int, bool]] = []
        heights: list[list[tuple[bool, list[tuple[int, int]]]]] = []

        def leaf(atom: Atom) -> tuple[int, int]:
            leaves.append(column_of(atom))
            return 0, len(leaves) - 1

        def branch(node: Node, parts: list[tuple[int, int]]) -> tuple[int, int]:
            """The height of a branch, and its place among those of that height."""
            height = max(h for h, _ in parts)
            heights.extend([] for _ in range(height + 1 - len(heights)))
            heights[height].append((node.union, parts))
            return height + 1, len(heights[height]) - 1

        folded(tree, leaf, branch)
        self.width = 1 + max(column for column, _ in leaves)
        self.rows: Integers = np.array([column + self.width * negated for column, negated in leaves], dtype=np.intp)
        firsts = np.cumsum([0, len(leaves), *map(len, heights)])
        self.size = int(firsts[-1])
        self.levels = []
        for first, branches in zip(firsts[1:], heights, strict=False):
            lengths = [len(parts) for _, parts in branches]
            self.levels.append(
                Level(
                    first + np.arange(len(branches)),
                    np.array([union for union, _ in branches]),
                    np.array([firsts[height] + place for _, parts in branches for height, place in parts]),
                    np.cumsum([0, *lengths[:-1]]),
                    np.repeat(np.arange(len(branches)), lengths),
                )
            )

    def holds(self, yes: Bools, no: Bools) -> Bools:
        """Where the tree is certainly true (N,), given where each column is certainly <= 0 or > 0 (M, N)."""
        found = [self._all(*block)[-1] for block in _blocks(yes, no)]
        return _unpacked(np.concatenate(found), yes.shape[1])

    def relevant(self, yes: Bools, no: Bools) -> tuple[Bools, Bools]:
        """Which columns (M, N) the tree depends on where it reads them `<= 0`, and where it reads them `> 0`.

        `yes` and `no` (M, N) say where columns are certainly <= 0 and > 0.
        """
        found = np.concatenate([self._relevant(*block) for block in _blocks(yes, no)], axis=1)
        below, above = np.split(_unpacked(found, yes.shape[1]), 2)
        return below, above

    def extremes(self, values: Floats) -> Floats:
        """Minima for unions and maxima for intersections (N,) of the columns' values (M, N), those negated turned."""
        parts = np.array_split(values, 1 + values.shape[1] // TOGETHER, axis=1)
        return np.concatenate([self._extremes(part) for part in parts])

    def _all(self, yes: Bits, no: Bits) -> Bits:
        """Where each branch is certainly true, (size, N / 8)."""
        found = np.empty((self.size, yes.shape[1]), dtype=np.uint8)
        found[: len(self.rows)] = np.concatenate([yes, no])[self.rows]
        for level in self.levels:
            checkpoint()
            unions = np.where(level.unions, ALL, 0).astype(np.uint8)
            parts = found[level.parts] ^ unions[level.owners, None]  # a union is what not all parts fail to be
            found[level.numbers] = np.bitwise_and.reduceat(parts, level.starts, axis=0) ^ unions[:, None]
        return found

    def _relevant(self, yes: Bits, no: Bits) -> Bits:
        """The columns on which the tree depends, read `<= 0` and then read `> 0`, as bits (2 M, N / 8)."""
        open_ = ~self._all(yes, no) & self._all(~no, ~yes)
        for level in reversed(self.levels):
            open_[level.parts] &= open_[level.numbers][level.owners]
        order = np.argsort(self.rows, kind="stable")
        rows, starts = np.unique(self.rows[order], return_index=True)
        result = np.zeros((2 * self.width, yes.shape[1]), dtype=np.uint8)
        result[rows] = np.bitwise_or.reduceat(open_[order], starts, axis=0)
        return result

    def _extremes(self, values: Floats) -> Floats:
        found = np.empty((self.size, values.shape[1]))
        found[: len(self.rows)] = np.concatenate([values, -values])[self.rows]
        for level in self.levels:
            sign = np.where(level.unions, -1.0, 1.0)
            parts = found[level.parts] * sign[level.owners, None]  # a minimum is the maximum of the opposites
            found[level.numbers] = np.maximum.reduceat(parts, level.starts, axis=0) * sign[:, None]
        return found[-1]


def _blocks(yes: Bools, no: Bools) -> list[tuple[Bits, Bits]]:
    """Two tables of truth values, eight to a byte, so many columns at a time; one block, which is empty, of none."""
    first, second = np.packbits(yes, axis=-1), np.packbits(no, axis=-1)
    blocks = [slice(start, start + TOGETHER) for start in range(0, max(first.shape[1], 1), TOGETHER)]
    return [(first[:, block], second[:, block]) for block in blocks]


def _unpacked(bits: Bits, number: int) -> Bools:
    """The first `number` truth values of each row."""
    return np.unpackbits(bits, axis=-1, count=number).view(bool)


Truth = Callable[[int], bool | None]
"""Whether the inequality of a leaf, by number, holds; None where that is not known."""


class LeafTree:
    """The different inequalities of a tree, its `leaves`, and the `code` by which truths of these at one point are put
    together.

    `polynomials` are those of the leaves, one of all multiples, and `signed` says of each leaf which it is and with
    which sign; it is -1 for other functions.
    """

    def __init__(self, tree: Tree) -> None:
        self.leaves = tuple(dict.fromkeys(atoms(tree)))
        columns = Columns()
        self.signed = [columns.of(f) if isinstance(f := a.function, Polynomial) else (-1, 1) for a in self.leaves]
        self.polynomials = [f for f in columns.functions if isinstance(f, Polynomial)]
        costs = [f.degree if isinstance(f := a.function, Polynomial) else math.inf for a in self.leaves]
        asks = {leaf: Code(cost, leaf=n) for n, (leaf, cost) in enumerate(zip(self.leaves, costs, strict=True))}

        def branch(node: Node, parts: list[Code]) -> Code:
            parts.sort(key=lambda part: part.cost)
            return Code(parts[0].cost, tuple(parts), node.union)

        self.code = folded(tree, asks.__getitem__, branch)

    def holds(self, leaf: int, sign: int) -> bool:
        """Whether a leaf holds where the polynomial of its number has a sign (not 0)."""
        return (sign * self.signed[leaf][1] < 0) != self.leaves[leaf].outside


@dataclass(frozen=True)
class Code:
    """A leaf by number, or an intersection or union of parts in the order of their `cost`.

    The cost is a lower bound of the work to evaluate it: the degree of a polynomial of one of its leaves, infinite
    where none has one.
    """

    cost: float
    parts: tuple[Code, ...] = ()
    union: bool = False
    leaf: int | None = None


def value_of(code: Code, truth: Truth) -> bool | None:
    """Whether points with these truths are in the solid; None where that is not known."""
    if code.leaf is not None:
        return truth(code.leaf)
    result: bool | None = not code.union
    for part in code.parts:
        found = value_of(part, truth)
        if found is code.union:
            return code.union
        result = None if found is None else result
    return result


def support_of(code: Code, said: bool, truth: Truth, fixed: Callable[[int], bool]) -> set[int]:
    """The leaves that are not `fixed` and on which an answer rests; none if it is certain.

    Of several ways in which it could be certain, the one with the fewest such leaves.
    """
    if code.leaf is not None:
        return set() if fixed(code.leaf) else {code.leaf}
    if said is not code.union:
        return {leaf for part in code.parts for leaf in support_of(part, said, truth, fixed)}
    best: set[int] = set()
    cost = None
    for part in code.parts:
        if cost is not None and part.cost > cost:
            break  # to cut at some more planes costs less than to ask a polynomial of higher degree
        if value_of(part, truth) is said:
            way = support_of(part, said, truth, fixed)
            best, cost = way if cost is None else min(best, way, key=len), part.cost
            if not best:
                break
    return best


def depends_on(code: Code, leaf: int, truth: Truth) -> bool:
    """Whether the answer may depend on a leaf: no branch above it is settled by others."""
    if code.leaf is not None:
        return code.leaf == leaf
    return any(
        depends_on(part, leaf, truth)
        and all(value_of(other, truth) is not code.union for other in code.parts if other is not part)
        for part in code.parts
    )
