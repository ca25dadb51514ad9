"""Trees of unions and intersections as arrays: many boxes or points at once, without a step for each branch.

A region of a node has some hundred branches, and a mesher asks for a few boxes at a time, many thousand times.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.solid.tree import Bools

Integers = NDArray[np.intp]

Bits = NDArray[np.uint8]

ALL = 0xFF
"""Eight truth values, all of them true."""

TOGETHER = 4096
"""Bytes, or values, of each gate that are kept at once, so that the table stays in the caches."""


@dataclass(frozen=True)
class Leaf:
    """A column that must be <= 0, or the opposite where negated."""

    column: int
    negated: bool


@dataclass(frozen=True)
class Branch:
    """A union or an intersection."""

    parts: tuple[Code, ...]
    union: bool


Code = Leaf | Branch


@dataclass(frozen=True)
class Level:
    """Branches of one height: their numbers (G,), whether each is a union (G,), and their parts' numbers, those of
    one after those of another, which begin at `starts` (G,); `owners` says to which branch each part belongs."""

    numbers: Integers
    unions: Bools
    parts: Integers
    starts: Integers
    owners: Integers


class Gates:
    """The branches of a tree over `columns` columns, by height; leaves are the first numbers, the root is the last."""

    def __init__(self, code: Code, columns: int) -> None:
        leaves: list[Leaf] = []
        heights: list[list[tuple[Branch, list[Any]]]] = []

        def visit(code: Code) -> tuple[int, Any]:
            """The height of a part, and a list that will hold its number."""
            if isinstance(code, Leaf):
                leaves.append(code)
                return 0, [len(leaves) - 1]
            found = [visit(part) for part in code.parts]
            height = 1 + max(h for h, _ in found)
            heights.extend([] for _ in range(height - len(heights)))
            number: list[int] = []
            heights[height - 1].append((code, [number, *(n for _, n in found)]))
            return height, number

        visit(code)
        self.columns = columns
        self.rows: Integers = np.array([leaf.column + columns * leaf.negated for leaf in leaves], dtype=np.intp)
        self.levels: list[Level] = []
        self.size = len(leaves)
        for branches in heights:
            self.levels.append(self._level(branches))

    def _level(self, branches: Sequence[tuple[Branch, list[Any]]]) -> Level:
        first = self.size
        for branch, (number, *_) in branches:
            number.append(self.size)
            self.size += 1
            assert branch.parts
        lengths = [len(branch.parts) for branch, _ in branches]
        return Level(
            np.arange(first, self.size),
            np.array([branch.union for branch, _ in branches]),
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
