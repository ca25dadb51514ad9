"""Sets of points as trees of inequalities `f <= 0`: immutable, exact where f is a polynomial.

For many boxes or points at once they are compiled to arrays, without a step for each branch: a region of a node has
some hundred branches, and a mesher asks for a few boxes at a time, many thousand times.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from pas.algebra.affine import Affine
from pas.algebra.inputs import check_coefficients
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial

Bools = NDArray[np.bool_]
Integers = NDArray[np.intp]
Bits = NDArray[np.uint8]

ALL = 0xFF
"""Eight truth values, all of them true."""

TOGETHER = 4096
"""Bytes, or values, of each branch that are kept at once, so that the table stays in the caches."""


@runtime_checkable
class ScalarField(Protocol):
    """A function that is no polynomial, such as a distance or a piecewise polynomial, over `2^exponent`."""

    @property
    def exponent(self) -> int:
        """Of the power of two that it is scaled by (see `pas.algebra.scaling`); 0 for distances."""

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) at points (N, 3), scaled."""

    def decided(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, in boxes of given centres and half edges (N, 3)."""

    def slopes(self, centers: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) at the centres of boxes, and how much their components change inside (N, 3)."""

    def moved(self, map_: Affine) -> ScalarField:
        """The function whose zero set is the image of this one's.

        Raises `ValueError` for maps that it cannot follow.
        """


Function = Polynomial | ScalarField


def image(function: Function, map_: Affine) -> Function:
    """The function whose zero set is the image of that of `function`; raises `ValueError` where `moved` does."""
    return map_.polynomial(function) if isinstance(function, Polynomial) else function.moved(map_)


@dataclass(frozen=True)
class Atom:
    """`{f <= 0}`, or `{f >= 0}` where `outside`.

    `face` names the part of the boundary that lies on f = 0; a wall (name "") only bounds a region
    and is no face of its own.  Raises `ValueError` for a polynomial whose coefficients are further apart than doubles.
    """

    function: Function
    face: str
    outside: bool = False

    def __post_init__(self) -> None:
        if isinstance(self.function, Polynomial):
            check_coefficients(self.function.raw, f"the face {self.face!r}" if self.face else "a wall")


@dataclass(frozen=True)
class Node:
    """The intersection or union of at least one set."""

    parts: tuple[Tree, ...]
    union: bool


Tree = Atom | Node


def combined(union: bool, *parts: Tree) -> Tree:
    """The union or intersection, with those of the same kind opened up."""
    opened: list[Tree] = []
    for part in parts:
        opened += part.parts if isinstance(part, Node) and part.union == union else [part]
    distinct = tuple(dict.fromkeys(opened))
    return distinct[0] if len(distinct) == 1 else Node(distinct, union)


def complement(tree: Tree) -> Tree:
    """The points outside, with the boundary (de Morgan's laws)."""
    if isinstance(tree, Atom):
        return replace(tree, outside=not tree.outside)
    return Node(tuple(map(complement, tree.parts)), not tree.union)


def is_contradiction(tree: Tree) -> bool:
    """Whether an intersection has a part of which it excludes all, as `a - a` has, by its form alone."""
    if isinstance(tree, Atom) or tree.union:
        return False
    known = set(tree.parts)

    def excluded(part: Tree) -> bool:
        opposite = complement(part)
        parts = opposite.parts if isinstance(opposite, Node) and not opposite.union else (opposite,)
        return known.issuperset(parts)

    return any(excluded(part) for part in tree.parts)


def mapped(tree: Tree, change: Callable[[Atom], Atom]) -> Tree:
    """The tree with each of its atoms changed."""
    if isinstance(tree, Atom):
        return change(tree)
    return Node(tuple(mapped(part, change) for part in tree.parts), tree.union)


def atoms(tree: Tree) -> Iterator[Atom]:
    """All atoms, from left to right."""
    if isinstance(tree, Atom):
        yield tree
    else:
        for part in tree.parts:
            yield from atoms(part)


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
    """The unions and intersections of a tree over `columns` columns, by height: many boxes or points at once.

    `column_of` gives for an inequality a column, from 0 on, that must be <= 0, and whether it is the opposite.  Leaves
    are the first numbers, the whole is the last.
    """

    def __init__(self, tree: Tree, column_of: Callable[[Atom], tuple[int, bool]]) -> None:
        leaves: list[tuple[int, bool]] = []
        heights: list[list[tuple[bool, list[Any]]]] = []

        def visit(tree: Tree) -> tuple[int, Any]:
            """The height of a part, and a list that will hold its number."""
            if isinstance(tree, Atom):
                leaves.append(column_of(tree))
                return 0, [len(leaves) - 1]
            found = [visit(part) for part in tree.parts]
            height = 1 + max(h for h, _ in found)
            heights.extend([] for _ in range(height - len(heights)))
            number: list[int] = []
            heights[height - 1].append((tree.union, [number, *(n for _, n in found)]))
            return height, number

        visit(tree)
        self.columns = 1 + max(column for column, _ in leaves)
        self.rows: Integers = np.array([column + self.columns * negated for column, negated in leaves], dtype=np.intp)
        self.size = len(leaves)
        self.levels = [self._level(branches) for branches in heights]

    def _level(self, branches: Sequence[tuple[bool, list[Any]]]) -> Level:
        first = self.size
        for _, (number, *_) in branches:
            number.append(self.size)
            self.size += 1
        lengths = [len(parts) for _, (_, *parts) in branches]
        return Level(
            np.arange(first, self.size),
            np.array([union for union, _ in branches]),
            np.array([n for _, (_, *parts) in branches for (n,) in parts], dtype=np.intp),
            np.cumsum([0, *lengths[:-1]]),
            np.repeat(np.arange(len(branches)), lengths),
        )

    def holds(self, yes: Bools, no: Bools) -> Bools:
        """Where the tree is certainly true (N,), given where each column is certainly <= 0 or > 0 (M, N)."""
        first, second = _packed(yes), _packed(no)
        found = [self._all(first[:, at], second[:, at])[-1] for at in _blocks(first.shape[1])]
        return _unpacked(np.concatenate(found), yes.shape[1])

    def relevant(self, yes: Bools, no: Bools) -> tuple[Bools, Bools]:
        """Which columns (M, N) the tree depends on where it reads them `<= 0`, and where it reads them `> 0`."""
        first, second = _packed(yes), _packed(no)
        found = [self._relevant(first[:, at], second[:, at]) for at in _blocks(first.shape[1])]
        below, above = (np.concatenate(side, axis=1) for side in zip(*found, strict=True))
        return _unpacked(below, yes.shape[1]), _unpacked(above, yes.shape[1])

    def extremes(self, values: Floats) -> Floats:
        """Minima for unions and maxima for intersections (N,) of the columns' values (M, N), those negated turned."""
        return np.concatenate([self._extremes(values[:, at]) for at in _blocks(values.shape[1])])

    def _all(self, yes: Bits, no: Bits) -> Bits:
        """Where each branch is certainly true, (size, N / 8)."""
        found = np.empty((self.size, yes.shape[1]), dtype=np.uint8)
        found[: len(self.rows)] = np.concatenate([yes, no])[self.rows]
        for level in self.levels:
            unions = np.where(level.unions, ALL, 0).astype(np.uint8)
            parts = found[level.parts] ^ unions[level.owners, None]  # a union is what not all parts fail to be
            found[level.numbers] = np.bitwise_and.reduceat(parts, level.starts, axis=0) ^ unions[:, None]
        return found

    def _relevant(self, yes: Bits, no: Bits) -> tuple[Bits, Bits]:
        open_ = ~self._all(yes, no) & self._all(~no, ~yes)
        for level in reversed(self.levels):
            open_[level.parts] &= open_[level.numbers][level.owners]
        order = np.argsort(self.rows, kind="stable")
        rows, starts = np.unique(self.rows[order], return_index=True)
        result = np.zeros((2 * self.columns, yes.shape[1]), dtype=np.uint8)
        result[rows] = np.bitwise_or.reduceat(open_[order], starts, axis=0)
        return result[: self.columns], result[self.columns :]

    def _extremes(self, values: Floats) -> Floats:
        found = np.empty((self.size, values.shape[1]))
        found[: len(self.rows)] = np.concatenate([values, -values])[self.rows]
        for level in self.levels:
            sign = np.where(level.unions, -1.0, 1.0)
            parts = found[level.parts] * sign[level.owners, None]  # a minimum is the maximum of the opposites
            found[level.numbers] = np.maximum.reduceat(parts, level.starts, axis=0) * sign[:, None]
        return found[-1]


def _packed(table: Bools) -> Bits:
    """A table of truth values, eight to a byte."""
    return np.packbits(table, axis=-1)


def _unpacked(bits: Bits, number: int) -> Bools:
    """The first so many truth values of each row."""
    return np.unpackbits(bits, axis=-1, count=number).view(bool)


def _blocks(number: int) -> list[slice]:
    """Slices of so many boxes; one, which is empty, of none."""
    return [slice(start, start + TOGETHER) for start in range(0, max(number, 1), TOGETHER)]
