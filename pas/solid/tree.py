"""Sets of points as trees of inequalities `f <= 0`: immutable, exact where f is a polynomial."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Protocol, TypeVar

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.inputs import check_coefficients
from pas.algebra.polynomial import Polynomial
from pas.arrays import Bools, Floats
from pas.mesh.field import OneFunction


class ScalarField(OneFunction, Protocol):
    """A function that is no polynomial, such as a distance or a piecewise polynomial, scaled: over `2^exponent`."""

    @property
    def exponent(self) -> int:
        """The exponent of the power of two that it is scaled by (see `pas.algebra.scaling`); 0 for distances."""

    def decided(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, in boxes of given centres and half edges (N, 3)."""

    def slopes(self, centers: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) at the centres of boxes, and how much their components change inside (N, 3)."""

    def moved(self, map_: Affine) -> ScalarField:
        """The function whose zero set is the image of this one's.

        Raises `ValueError` for maps that it cannot follow.
        """


Function = Polynomial | ScalarField


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


Value = TypeVar("Value")


@dataclass(frozen=True, eq=False)
class Node:
    """The intersection or union of at least one set.

    Operations in turn nest without end: what makes, compares, changes and lists trees does not call itself for their
    parts (`folded`, `atoms`); boxes and proofs of joints do, to some hundred levels.
    """

    parts: tuple[Tree, ...]
    union: bool
    _hash: int = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_hash", hash((self.parts, self.union)))  # those of its parts are known

    def __eq__(self, other: object) -> bool:
        pairs: list[tuple[object, object]] = [(self, other)]
        while pairs:
            one, its = pairs.pop()
            if isinstance(one, Node) and isinstance(its, Node):
                if (one.union, hash(one), len(one.parts)) != (its.union, hash(its), len(its.parts)):
                    return False
                pairs += zip(one.parts, its.parts, strict=True) if one is not its else ()
            elif isinstance(one, Node) or isinstance(its, Node) or one != its:
                return False
        return True

    def __hash__(self) -> int:
        return self._hash

    def __reduce__(self) -> tuple[type[Node], tuple[tuple[Tree, ...], bool]]:
        return Node, (self.parts, self.union)  # as texts have other hashes in another process


Tree = Atom | Node


def combined(union: bool, *parts: Tree) -> Tree:
    """The union or intersection, with those of the same kind opened up."""
    distinct = tuple(dict.fromkeys(opened for part in parts for opened in parts_of(part, union)))
    return distinct[0] if len(distinct) == 1 else Node(distinct, union)


def parts_of(tree: Tree, union: bool) -> tuple[Tree, ...]:
    """The sets whose union, or intersection, a set is by its form: itself alone where it has no such form."""
    return tree.parts if isinstance(tree, Node) and tree.union == union else (tree,)


def splits_of(tree: Tree) -> Iterator[tuple[Tree, Tree]]:
    """Each of several sets whose intersection a set is, with that of the others."""
    parts = parts_of(tree, union=False)
    for part in parts if len(parts) > 1 else ():
        yield part, combined(False, *(other for other in parts if other is not part))


def folded(tree: Tree, leaf: Callable[[Atom], Value], branch: Callable[[Node, list[Value]], Value]) -> Value:
    """A tree's value by recursion: `leaf` of its leaves, from left to right, `branch` of parts' values."""
    found, waiting = list[Value](), [(tree, False)]
    while waiting:
        part, opened = waiting.pop()
        if not isinstance(part, Node):
            found.append(leaf(part))
        elif opened:
            found[-len(part.parts) :] = [branch(part, found[-len(part.parts) :])]
        else:
            waiting += [(part, True), *((inner, False) for inner in reversed(part.parts))]
    return found[0]


def complement(tree: Tree) -> Tree:
    """The points outside, with the boundary (de Morgan's laws)."""

    def branch(node: Node, parts: list[Tree]) -> Tree:
        return Node(tuple(parts), not node.union)

    return folded(tree, lambda atom: replace(atom, outside=not atom.outside), branch)


def is_contradiction(tree: Tree) -> bool:
    """Whether an intersection has a part of which it excludes all, as `a - a` has, by its form alone."""
    known = {*parts_of(tree, False)}
    return any(known.issuperset(parts_of(complement(part), False)) for part in known)


def mapped(tree: Tree, change: Callable[[Atom], Tree]) -> Tree:
    """The tree with each atom replaced."""
    return folded(tree, change, lambda node, parts: Node(tuple(parts), node.union))


def moved(tree: Tree, map_: Affine) -> Tree:
    """The image of a set; raises `ValueError` where a function cannot follow the map."""
    functions = dict.fromkeys(atom.function for atom in atoms(tree))
    images = {f: map_.polynomial(f) if isinstance(f, Polynomial) else f.moved(map_) for f in functions}
    return mapped(tree, lambda atom: replace(atom, function=images[atom.function]))


def atoms(tree: Tree) -> Iterator[Atom]:
    """All atoms, from left to right."""
    waiting = [tree]
    while waiting:
        part = waiting.pop()
        if isinstance(part, Atom):
            yield part
        else:
            waiting += reversed(part.parts)


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
                row = (function / max(map(abs, function.raw.coeffs()))).dense()
                sign = 1 if row @ (0.34, 0.55, 0.21, 0.73) > 0 else -1  # by a side on which rounding changes nothing
                key = tuple(np.round(sign * row * 2.0**40).tolist())
        number, first = self._known.setdefault(key, (len(self.functions), sign))
        if number == len(self.functions):
            self.functions.append(function)
        return number, sign * first
