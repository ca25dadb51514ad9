"""B-coefficients on parts of a simplex as means of two that are known: by polar forms at middles (Ramshaw 1989).

A polar form one of whose arguments is the middle of an edge is the mean of those with an end of the edge in its place.
Coefficients of several parts have many such values in common, and each is worked out once, with one rounding.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, homogeneous_exponents
from pas.bernstein.subdivision import edges

Node = tuple[int, ...]
"""A corner of a simplex or the middle of an edge, by barycentric coordinates in halves."""

Arguments = tuple[Node, ...]
"""Of a polar form, in order."""


@dataclass(frozen=True)
class Means:
    """How the B-coefficients of one degree on a simplex give those on parts of it.

    Behind the m coefficients come means of two that stand before, at the places `halves` (M, 2), those of the first m
    being 0; `levels` (degree + 1,) begin where all means are of what stands before.  `taken` (P, m) are the places of
    each part's coefficients.
    """

    halves: NDArray[np.intp]
    levels: tuple[int, ...]
    taken: NDArray[np.intp]

    def __call__(self, forms: Floats) -> Floats:
        """Those on the parts (P, T, m) of simplices (T, m)."""
        table = np.empty((len(self.halves), len(forms)))
        table[: forms.shape[1]] = forms.T
        for start, end in pairwise(self.levels):
            first, second = self.halves[start:end].T
            table[start:end] = (table[first] + table[second]) / 2
        return np.asarray(table[self.taken].transpose(0, 2, 1))


def means(degree: int, parts: Sequence[Sequence[Node]]) -> Means:
    """Those of parts whose corners, as many as the simplex has, are given."""
    vertices = len(parts[0])
    indices = homogeneous_exponents(degree, vertices)
    found: dict[Arguments, tuple[Arguments, ...]] = {}

    def find(arguments: Arguments) -> None:
        if arguments not in found:
            found[arguments] = _replaced(arguments)
            for one in found[arguments]:
                find(one)

    own = [_arguments([_end(k, vertices) for k in range(vertices)], index) for index in indices]
    wanted = [[_arguments(part, index) for index in indices] for part in parts]
    for arguments in own + [one for part in wanted for one in part]:
        find(arguments)
    known = set(own)
    order = sorted((sum(map(_is_middle, one)), one) for one in found if one not in known)
    place = {one: number for number, one in enumerate(own + [one for _, one in order])}
    halves = [[0, 0]] * len(own) + [[place[half] for half in found[one]] for _, one in order]
    times = [0] * len(own) + [number for number, _ in order]
    levels = tuple(int(np.searchsorted(times, number)) for number in range(1, degree + 2))
    taken = np.array([[place[one] for one in part] for part in wanted], dtype=np.intp)
    return Means(np.array(halves, dtype=np.intp), levels, taken)


@cache
def bisection(degree: int, vertices: int) -> tuple[Means, ...]:
    """Those of both halves of a simplex, cut at the middle of each of its `edges`.

    The first half has the middle in place of the edge's second corner, the other in place of its first.
    """
    corners, result = [_end(k, vertices) for k in range(vertices)], []
    for first, second in edges(vertices):
        middle = tuple(int(k in (first, second)) for k in range(vertices))
        parts = [[middle if k == moved else corner for k, corner in enumerate(corners)] for moved in (second, first)]
        result.append(means(degree, parts))
    return tuple(result)


def _end(number: int, vertices: int) -> Node:
    return tuple(2 * (i == number) for i in range(vertices))


def _arguments(corners: Sequence[Node], times: Iterable[int]) -> Arguments:
    return tuple(sorted(node for node, number in zip(corners, times, strict=True) for _ in range(number)))


def _is_middle(node: Node) -> bool:
    return max(node) == 1


def _replaced(arguments: Arguments) -> tuple[Arguments, ...]:
    """The arguments with the last that is a middle replaced by each end of its edge; none without one."""
    middles = [node for node in arguments if _is_middle(node)]
    if not middles:
        return ()
    rest, ends = list(arguments), [k for k, share in enumerate(middles[-1]) if share]
    rest.remove(middles[-1])
    return tuple(tuple(sorted([*rest, _end(k, len(middles[-1]))])) for k in ends)
