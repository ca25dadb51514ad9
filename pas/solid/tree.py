"""Sets of points as trees of inequalities `f <= 0`: immutable, exact where f is a polynomial."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from pas.algebra.affine import Affine
from pas.algebra.inputs import check_coefficients
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial

Bools = NDArray[np.bool_]
Integers = NDArray[np.intp]


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


Leaf = TypeVar("Leaf")


@dataclass(frozen=True)
class Node(Generic[Leaf]):
    """The intersection or union of at least one set; leaves are inequalities, or what stands for them."""

    parts: tuple[Leaf | Node[Leaf], ...]
    union: bool


Tree = Atom | Node[Atom]


def combined(union: bool, *parts: Tree) -> Tree:
    """The union or intersection, with those of the same kind opened up."""
    distinct = tuple(dict.fromkeys(opened for part in parts for opened in parts_of(part, union)))
    return distinct[0] if len(distinct) == 1 else Node(distinct, union)


def parts_of(tree: Tree, union: bool) -> tuple[Tree, ...]:
    """The sets whose union, or intersection, a set is by its form: itself alone where it has no such form."""
    return tree.parts if isinstance(tree, Node) and tree.union == union else (tree,)


def splits_of(tree: Tree, union: bool) -> Iterator[tuple[Tree, Tree]]:
    """Each of several sets whose union, or intersection, a set is, with that of the others."""
    parts = parts_of(tree, union)
    for part in parts if len(parts) > 1 else ():
        yield part, combined(union, *(other for other in parts if other is not part))


def complement(tree: Tree) -> Tree:
    """The points outside, with the boundary (de Morgan's laws)."""
    if isinstance(tree, Atom):
        return replace(tree, outside=not tree.outside)
    return Node(tuple(map(complement, tree.parts)), not tree.union)


def is_contradiction(tree: Tree) -> bool:
    """Whether an intersection has a part of which it excludes all, as `a - a` has, by its form alone."""
    known = {*parts_of(tree, False)}
    return any(known.issuperset(parts_of(complement(part), False)) for part in known)


def mapped(tree: Tree, change: Callable[[Atom], Leaf | Node[Leaf]]) -> Leaf | Node[Leaf]:
    """The tree with something in the place of each of its atoms."""
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


class Columns:
    """Functions by number, from 0 on: a polynomial and its multiples have one, that of the first of them.

    So have planes, where `rounded` says so, that are equal to 40 bits.
    """

    def __init__(self, rounded: bool = False) -> None:
        self.functions: list[Function] = []
        self._known: dict[Function | tuple[float, ...], tuple[int, int]] = {}
        self._rounded = rounded

    def of(self, function: Function) -> tuple[int, int]:
        """The number of a function, and the sign (1 or -1) of its values over those of the first one of that number."""
        key: Function | tuple[float, ...] = function
        sign = 1
        if isinstance(function, Polynomial):
            key, sign = function.primitive(), 1 if function.raw.coeffs()[0] > 0 else -1
            if self._rounded and function.degree == 1:
                row = function.dense() / np.abs(function.dense()).max()
                sign = 1 if row @ (0.34, 0.55, 0.21, 0.73) > 0 else -1  # by a side on which rounding changes nothing
                key = tuple(np.round(sign * row * 2.0**40).tolist())
        number, first = self._known.setdefault(key, (len(self.functions), sign))
        if number == len(self.functions):
            self.functions.append(function)
        return number, sign * first
