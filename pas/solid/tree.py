"""Sets of points as trees of inequalities `f <= 0`: immutable, exact where f is a polynomial."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial


@runtime_checkable
class Distance(Protocol):
    """A function that is no polynomial: its values change by at most 1 per unit of length."""

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) at points (N, 3)."""


Function = Polynomial | Distance


@dataclass(frozen=True)
class Atom:
    """`{f <= 0}`, or `{f >= 0}` where `outside`.

    `face` names the part of the boundary that lies on f = 0; a wall (name "") only bounds a region
    and is no face of its own.
    """

    function: Function
    face: str
    outside: bool = False


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


def mapped(tree: Tree, change: Callable[[Atom], Atom]) -> Tree:
    """The same tree with its atoms changed."""
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
