"""Simplices with the B-coefficients of polynomials on them, many at once, halved with rounding counted.

A simplex is halved at the middle of its longest edge, by means of two coefficients each.

Rounding: coefficients are at most 1 in size, and off by at most an error that is given, 2^-53 where exact ones were
rounded to nearest.  One halving takes at most n means of two one after the other, n the degree: each adds 2^-53 of a
number of size 1 (Higham 2002, section 3.1) and does not enlarge the errors before it.  Counted are (n+2) 2^-53,
which does for halving by products with matrices of n+1 weights as well, and all is doubled for products of roundings:
after m halvings a coefficient is within `2 (error + m (n+2) 2^-53)` of the true one.

Halving is de Casteljau's subdivision at a middle, of forms on simplices here, and on boxes.
A polar form one of whose arguments is the middle of an edge is the mean of those with an end of the edge in its place
(Ramshaw 1989).  Coefficients on several parts of a simplex have many such values in common, and each is worked out
once, with one rounding; means of exact numbers are exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import accumulate, combinations, pairwise
from math import comb
from typing import Self

import numpy as np

from pas.algebra.evaluation import degree_of
from pas.algebra.monomials import homogeneous_exponents
from pas.arrays import AnyArray, Floats, Integers
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.search import Cells, Fates
from pas.kernels.library import compiled


@dataclass(frozen=True)
class Simplices(Cells):
    """Simplices with corners (N, d + 1, 3), the numbers (N,) of those that they are parts of, and the B-coefficients of
    polynomials of some degrees on them, one after the other (N, M), off by `error` before so many halvings."""

    table: Floats
    corners: Floats
    source: Integers
    degrees: tuple[int, ...]
    error: float = UNIT_ROUNDOFF
    halvings: int = 0

    @classmethod
    def of(cls, forms: Sequence[Floats], corners: Floats, error: float = UNIT_ROUNDOFF) -> Self:
        """Simplices (N, d + 1, 3) with forms (N, m), each scaled to at most 1 and off by at most `error`."""
        degrees = tuple(degree_of(form.shape[1], corners.shape[1] - 1) for form in forms)
        return cls(np.concatenate(forms, axis=1), corners, np.arange(len(corners)), degrees, error)

    @property
    def forms(self) -> list[Floats]:
        """The B-coefficients (N, m) of each polynomial."""
        ends = accumulate(_sizes(self.degrees, self.corners.shape[1]), initial=0)
        return [self.table[:, start:end] for start, end in pairwise(ends)]

    @property
    def bound(self) -> float:
        """Twice the most by which a coefficient can be off."""
        return rounding_bound(max(self.degrees), self.halvings, self.error)

    def halved(self) -> Self:
        """Both halves of each simplex, one behind the other."""
        vertices, cuts = self.corners.shape[1], _cuts(self.degrees, self.corners.shape[1])
        (count, size), twice = self.table.shape, 2 * len(self)
        table, corners = np.empty((twice, size)), np.empty((twice, vertices, 3))
        pairs, halves, taken = cuts
        tables = (len(pairs), pairs, halves.shape[1], halves, taken)
        compiled().call("pas_halved", count, size, vertices - 1, *tables, self.table, self.corners, table, corners)
        source = np.repeat(self.source, 2)
        return replace(self, table=table, corners=corners, source=source, halvings=self.halvings + 1)

    def rising(self) -> Fates:
        """Settled where the one polynomial surely rises along some direction all over the simplex, kept where it surely
        has one sign, waiting where its coefficients are nothing but rounding, and else to be split, (N,).

        Directions are given by numbers u_1 .. u_d, as `sum u_i (d_i - d_0)` of the barycentric coordinates, so they
        need not be known exactly.
        """
        (count, size), vertices, fates = self.table.shape, self.corners.shape[1], np.empty(len(self), dtype=np.intp)
        up = raised(self.degrees[0], vertices)
        given, roundings = (count, size, vertices - 1, len(up), up, self.table), 16  # of derivatives, over the largest
        bounds = self.bound, roundings * UNIT_ROUNDOFF
        compiled().call("pas_judged", *given, self.corners, *bounds, fates)
        return fates


def rounding_bound(degree: int, halvings: int, error: float = UNIT_ROUNDOFF) -> float:
    """Twice the most by which a coefficient can be off after some halvings (see above), of so much before them."""
    return 2 * (error + halvings * (degree + 2) * UNIT_ROUNDOFF)


def at_vertices(form: Floats, vertices: int) -> Floats:
    """The values (N, d + 1) of forms (N, m) at the vertices of their simplices."""
    degree = degree_of(form.shape[1], vertices - 1)
    indices = homogeneous_exponents(degree, vertices)
    return form[:, [i for i, a in enumerate(indices) if max(a) == degree][:vertices]]


def _sizes(degrees: tuple[int, ...], vertices: int) -> list[int]:
    return [len(homogeneous_exponents(degree, vertices)) for degree in degrees]


@cache
def _cuts(degrees: tuple[int, ...], vertices: int) -> tuple[Integers, Integers, Integers]:
    """The edges (E, 2), and for each the means (E, M, 2) of which its halves' coefficients (E, 2, m) are some.

    Of several polynomials all coefficients stand first, then the means of each.
    """
    sizes = _sizes(degrees, vertices)
    starts, places, halves, taken = sum(sizes), 0, [], []
    for degree, size in zip(degrees, sizes, strict=True):
        cuts = bisection(degree, vertices)
        means, own = np.array([c.halves for c in cuts])[:, size:], np.array([c.taken for c in cuts])
        halves.append(np.where(means < size, means + places, means - size + starts))
        taken.append(np.where(own < size, own + places, own - size + starts))
        starts, places = starts + means.shape[1], places + size
    known = np.zeros((len(edges(vertices)), sum(sizes), 2), dtype=np.intp)
    return np.array(edges(vertices)), np.concatenate([known, *halves], axis=1), np.concatenate(taken, axis=2)


Node = tuple[int, ...]
"""A corner of a simplex or the middle of an edge, by barycentric coordinates in halves."""

Times = tuple[int, ...]
"""How often each of some nodes is an argument of a polar form; the corners come first."""


@cache
def edges(vertices: int) -> tuple[tuple[int, int], ...]:
    """The edges of a simplex with that many vertices, as pairs of vertex numbers."""
    return tuple(combinations(range(vertices), 2))


@cache
def raised(degree: int, vertices: int) -> Integers:
    """For each multi-index of degree - 1 where those of `degree` with one more in each place stand, (m, vertices).

    B-coefficients of the derivative along barycentric u, sum 0, are `degree` times the sums of u_k b at these places.
    """
    where = {a: i for i, a in enumerate(homogeneous_exponents(degree, vertices))}
    lower = homogeneous_exponents(degree - 1, vertices)
    return np.array([[where[tuple(v + (i == k) for i, v in enumerate(a))] for k in range(vertices)] for a in lower])


@dataclass(frozen=True)
class Means:
    """How the B-coefficients of one degree on a simplex give those on parts of it.

    Behind the m coefficients come means of two that stand before, at the places `halves` (M, 2), those of the first m
    being 0; `levels` (degree + 1,) begin where all means are of what stands before.  `taken` (P, m) are the places of
    each part's coefficients.
    """

    halves: Integers
    levels: tuple[int, ...]
    taken: Integers

    def __call__(self, forms: Floats) -> Floats:
        """The B-coefficients on the parts (P, T, m) of simplices (T, m)."""
        table = np.empty((len(self.halves), len(forms)))
        table[: forms.shape[1]] = forms.T
        for start, end in pairwise(self.levels):
            first, second = self.halves[start:end].T
            table[start:end] = (table[first] + table[second]) / 2
        return np.asarray(table[self.taken].transpose(0, 2, 1))


def means(degree: int, parts: Sequence[Sequence[Node]]) -> Means:
    """The means for parts of a simplex with given corners, as many as the simplex has."""
    vertices = len(parts[0])
    ends = [_end(k, vertices) for k in range(vertices)]
    nodes = [*ends, *sorted({node for part in parts for node in part if node not in ends})]
    edge_of = [[k for k, share in enumerate(node) if share] for node in nodes]
    indices = homogeneous_exponents(degree, vertices)
    found: dict[Times, tuple[Times, ...]] = {}

    def find(times: Times) -> Times:
        """Look for the values with the last middle replaced by each end of its edge, if there is a middle."""
        if times not in found:
            last = max((k for k, number in enumerate(times) if number), default=0)
            halves = [_replaced(times, last, end) for end in edge_of[last]] if last >= vertices else []
            found[times] = tuple(find(half) for half in halves)
        return times

    own = [(*index, *[0] * (len(nodes) - vertices)) for index in indices]
    wanted = [
        [find(_times([nodes.index(node) for node in part], index, len(nodes))) for index in indices] for part in parts
    ]
    for times in own:
        find(times)
    order = sorted((degree - sum(times[:vertices]), times) for times in found if found[times])
    place = {times: number for number, times in enumerate(own + [times for _, times in order])}
    halves = [[0, 0]] * len(own) + [[place[half] for half in found[times]] for _, times in order]
    number = [0] * len(own) + [middles for middles, _ in order]
    levels = tuple(int(np.searchsorted(number, middles)) for middles in range(1, degree + 2))
    taken = np.array([[place[times] for times in part] for part in wanted], dtype=np.intp)
    return Means(np.array(halves, dtype=np.intp), levels, taken)


@cache
def bisection(degree: int, vertices: int) -> tuple[Means, ...]:
    """The means for both halves of a simplex, cut at the middle of each of its `edges`.

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


def _times(places: Sequence[int], index: Sequence[int], size: int) -> Times:
    """How often each of so many nodes is an argument, where those at some places are as often as an index says."""
    times = [0] * size
    for place, number in zip(places, index, strict=True):
        times[place] += number
    return tuple(times)


def _replaced(times: Times, node: int, end: int) -> Times:
    """How often each is an argument after one node has given way to an end."""
    result = list(times)
    result[node] -= 1
    result[end] += 1
    return tuple(result)


def halves(coefficients: AnyArray, axis: int) -> tuple[AnyArray, AnyArray]:
    """Both halves of forms on boxes, at the middle of the parameter along `axis`, by repeated means.

    The numbers may be doubles, or exact ones in an array of objects.
    """
    row = np.moveaxis(coefficients, axis, 0)
    size = len(row)
    left, right = np.empty_like(row), np.empty_like(row)
    for i in range(size):
        left[i], right[size - 1 - i] = row[0], row[-1]
        row = (row[:-1] + row[1:]) / 2
    return np.moveaxis(left, 0, axis), np.moveaxis(right, 0, axis)


def halved(nets: Floats, axis: int) -> tuple[Floats, Floats]:
    """Both halves of nets (C, m+1, n+1, d) along parameter `axis`, by matrices: ten times as fast as means of many.

    Each coefficient errs by at most (n+2) 2^-53 of the greatest (Higham 2002, section 3.1).
    """
    matrices = _halving(nets.shape[1 + axis] - 1)
    if axis == 0:
        flat = nets.reshape(*nets.shape[:2], -1)
        left, right = (np.matmul(matrix, flat).reshape(nets.shape) for matrix in matrices)
    else:
        left, right = (np.matmul(matrix, nets) for matrix in matrices)
    return left, right


@cache
def _halving(degree: int) -> tuple[Floats, Floats]:
    """Matrices from B-coefficients on a segment to those on its halves; their weights are exact in doubles."""
    left = np.array([[comb(i, j) / 2**i for j in range(degree + 1)] for i in range(degree + 1)])
    return left, left[::-1, ::-1].copy()
