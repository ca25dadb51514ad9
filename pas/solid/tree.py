"""Sets of points as trees of inequalities `f <= 0`: immutable, exact where f is a polynomial."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from pas.algebra.affine import Affine
from pas.algebra.inputs import check_coefficients
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial

Bools = NDArray[np.bool_]


@runtime_checkable
class Field(Protocol):
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

    def moved(self, map_: Affine) -> Field:
        """The function whose zero set is the image of this one's.

        Raises `ValueError` for maps that it cannot follow.
        """


Function = Polynomial | Field


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
