"""Simplices with the B-coefficients of polynomials on them, many at once, halved with rounding counted.

A simplex is halved at the middle of its longest edge, by means of two coefficients each.

Rounding: coefficients are at most 1 in size, and off by at most an error that is given, 2^-53 where exact ones were
rounded to nearest.  One halving takes at most n means of two one after the other, n the degree: each adds 2^-53 of a
number of size 1 (Higham 2002, section 3.1) and does not enlarge the errors before it.  Counted are (n+2) 2^-53,
which does for halving by products with matrices of n+1 weights as well, and all is doubled for products of roundings:
after m halvings a coefficient is within `2 (error + m (n+2) 2^-53)` of the true one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import accumulate, pairwise
from typing import Self

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, homogeneous_exponents
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.search import Cells, Fates
from pas.bernstein.subdivision import bisection, edges, raised
from pas.kernels.library import compiled

Integers = NDArray[np.intp]


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
        degrees = tuple(degree_of(form.shape[1], corners.shape[1]) for form in forms)
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
        up = _raised(self.degrees[0], vertices)
        given, roundings = (count, size, vertices - 1, len(up), up, self.table), 16  # of derivatives, over the largest
        bounds = self.bound, roundings * UNIT_ROUNDOFF
        compiled().call("pas_judged", *given, self.corners, *bounds, fates)
        return fates


def rounding_bound(degree: int, halvings: int, error: float = UNIT_ROUNDOFF) -> float:
    """Twice the most by which a coefficient can be off after some halvings (see above), of so much before them."""
    return 2 * (error + halvings * (degree + 2) * UNIT_ROUNDOFF)


def degree_of(size: int, vertices: int) -> int:
    """The degree of a form with so many coefficients on a simplex with so many vertices."""
    return next(n for n in range(size) if len(homogeneous_exponents(n, vertices)) == size)


def at_vertices(form: Floats, vertices: int) -> Floats:
    """The values (N, d + 1) of forms (N, m) at the vertices of their simplices."""
    degree = degree_of(form.shape[1], vertices)
    indices = homogeneous_exponents(degree, vertices)
    return form[:, [i for i, a in enumerate(indices) if max(a) == degree][:vertices]]


def _sizes(degrees: tuple[int, ...], vertices: int) -> list[int]:
    return [len(homogeneous_exponents(degree, vertices)) for degree in degrees]


@cache
def _raised(degree: int, vertices: int) -> Integers:
    return raised(degree, vertices) if vertices > 1 else np.zeros((1, 1), dtype=np.intp)


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
