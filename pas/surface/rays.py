"""Rays in local coordinates, and what they are shot at: polynomials on the cells of a partition, or in all of space.

A ray is `origin + t way` with its direction times one power of two, so that the largest coordinate of `way` is from
1/2 to 1, and local coordinates.  That is exact but for the local origin's rounding and what is below 2^-1074, which is
far below all widths here and `TINY`.  Rays that start too far away are left to exact work.

Barycentric coordinates along a ray are `at + t slope`.  Their maps are exact and then rounded, and with the width
`8 u (sum of sizes of a map's four numbers)`, u = 2^-53, the sum `at` errs by at most `width (1 + |origin| + reach)` and
`slope` by at most the width, of which some roundings are left for what is done with them.  So the ray is in a cell
at most where all four of the larger lines are not negative, and certainly where the smaller are.  In all of space,
where there are no cells, the way of a ray is the share s = t / (t + length) of its endless length.

The Bernstein form of a polynomial along a stretch is that which interpolates its values there, and so errs by
`growth` times as much as these (for their error see `error_on` in pas/kernels/rays.c).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cache, cached_property
from math import comb

import numpy as np
from flint import fmpq, fmpq_mat, fmpz_mat
from numpy.typing import NDArray

from pas.algebra.evaluation import order_of_rule
from pas.algebra.monomials import exponents
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import dot, to_float, to_floats
from pas.arrays import Bools, Floats, Integers
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.kernels.library import compiled
from pas.partition.cells import Partition

MARGIN = 1 / 8
"""Local units by which points are moved outwards where errors are bounded (as in pas/kernels/rays.c)."""

FARTHEST = 2.0**46
"""Local units beyond which nothing is tried: points of a ray that starts there may be off by `MARGIN` / 8 and more."""

ROUNDINGS = 8
"""Of which each number of a map is worth one unit roundoff in `widths`: six in sums, two in quotients of these."""

RELATIVE = 1e-9
"""Of sums that are bounds, more than their rounding."""

TINY = 2.0**-1000
"""Numbers of this size may have lost digits by underflow, 2^-1075 each time."""


HIGHEST = 31
"""Degree above which all rays are worked out exactly: interpolation loses ten of the 16 digits of doubles there."""


Found = tuple[Integers, Floats, Integers]
"""Numbers of rays, parameters in units of `LocalRays`, and sides (M,) each."""


@dataclass(frozen=True)
class LocalRays:
    """Rays `origins + t ways` (N, 3) in local coordinates, t in units of the user's parameter of 2^-`exponents` (N,).

    Those that are `doubtful` (N,) start too far away.
    """

    origins: Floats
    ways: Floats
    exponents: NDArray[np.intc]
    doubtful: Bools

    @classmethod
    def of(cls, target: RayTarget, origins: Floats, directions: Floats) -> LocalRays:
        """The local rays of rays (N, 3) in the user's coordinates."""
        sizes = np.frexp(np.abs(directions).max(axis=1))[1]
        ways = np.ldexp(directions, -sizes[:, None])
        with np.errstate(over="ignore"):
            starts = np.ascontiguousarray(target.partition.frame.local_points(origins))
        doubtful = ~(np.abs(starts).max(axis=1) < FARTHEST)
        return cls(starts, ways, sizes - (np.frexp(target.scale)[1] - 1), doubtful)

    def some(self, chosen: Integers) -> LocalRays:
        """The rays of given numbers."""
        return LocalRays(*(getattr(self, column.name)[chosen] for column in fields(self)))

    def parameters(self, rays: Integers, lengths: Floats) -> Floats:
        """The user's parameters (M,) for those here, of rays with these numbers (M,): the nearest doubles."""
        with np.errstate(over="ignore", under="ignore"):
            return np.asarray(np.ldexp(lengths, -self.exponents[rays]))

    def points(self, target: RayTarget, origins: Floats, rays: Integers, lengths: Floats) -> Floats:
        """The user's points (M, 3) at parameters here of rays with these numbers and origins (N, 3)."""
        ways = self.ways[rays]
        with np.errstate(invalid="ignore"):
            return np.asarray(origins[rays] + np.where(ways == 0, 0.0, (target.scale * lengths)[:, None] * ways))


class RayTarget:
    """Scaled polynomials (one for each piece of a partition, in its local coordinates) at which rays are shot."""

    def __init__(self, partition: Partition, patches: Sequence[Polynomial]) -> None:
        self.partition, self.patches = partition, tuple(patches)
        self.local, self.scale = partition.local, to_float(partition.frame.scale)
        self.degree = max(0, *(patch.degree for patch in self.patches))

    @cached_property
    def reach(self) -> float:
        """The largest coordinate of the region in the user's coordinates, in local units."""
        return float(np.abs(self.partition.points).max(initial=0.0)) / self.scale

    @cached_property
    def farthest(self) -> float:
        """A bound of all coordinates of the region in local units, even moved outwards by `MARGIN`."""
        return float(np.abs(self.local.points).max(initial=0.0)) + MARGIN

    @cached_property
    def barycentric(self) -> fmpq_mat:
        """The barycentric coordinates on the C cells (4C, 4), exact: a row the constant and the factors of x, y, z."""
        values = list[fmpq]()  # of each cell's planes: each coordinate is 1 at the corner that is not on its plane
        for number, cell in enumerate(self.local.cells):
            for plane, corner in zip(self.local.planes(number), sorted(cell, reverse=True), strict=True):
                constant, *slope = plane.row(1)
                height = constant + dot(slope, self.local.vertices[corner])
                values += [value / height for value in (constant, *slope)]
        return fmpq_mat(len(values) // 4, 4, values)

    @cached_property
    def maps(self) -> Floats:
        """The barycentric coordinates as doubles (4, 4, C): of each the factors of x, y, z and then the constant."""
        rounded = np.array(to_floats(self.barycentric.entries())).reshape(-1, 4, 4)
        return np.ascontiguousarray(rounded[:, :, [1, 2, 3, 0]].transpose(1, 2, 0))

    @cached_property
    def widths(self) -> Floats:
        """By how much the maps may be off, (4, C)."""
        return np.asarray(ROUNDINGS * UNIT_ROUNDOFF * np.abs(self.maps).sum(axis=1))

    @cached_property
    def clear(self) -> Floats:
        """How close to 0, in the maximum norm, at most 1, the polynomial of each cell has no zero, (C,): where its
        constant outweighs its other terms."""
        sizes = np.abs([patch.dense(self.degree) for patch in self.patches])
        constant, rest = sizes[:, 0], np.maximum(sizes[:, 1:].sum(axis=1), TINY)
        found = np.where(constant > TINY, (1 - RELATIVE) * constant / np.maximum(constant, rest), 0.0)
        return np.asarray(found[self.local.piece_of])

    def in_doubles(self, rays: LocalRays, room: int = 0) -> tuple[Found, Bools]:
        """The crossings of rays that are not doubtful, ray by ray, and on which of these (N,) doubles decide nothing.

        There is `room` for so many crossings, or for some a ray; where there are more, the search is repeated with
        room for all.
        """
        usual = 4  # crossings of a ray on average, for which there is room at first
        number = len(rays.origins)
        if self.degree > HIGHEST or not number:
            none = np.empty(0, dtype=np.intp)
            return (none, np.empty(0), none), np.ones(number, dtype=bool)
        room = room or usual * (number + 1)
        found, sides, exact = (np.empty(size, dtype=np.intp) for size in (room, room, number))
        parameters, counted = np.empty(room), np.zeros(1, dtype=np.intp)
        sizes = np.array([len(self.local.cells), self.degree], dtype=np.intp)
        shot = (number, rays.origins, rays.ways, room, found, parameters, sides, exact, counted)
        compiled().call("pas_rays", sizes, *self._tables, *shot)
        total = int(counted[0])
        if total > room:
            return self.in_doubles(rays, total)
        return (found[:total], parameters[:total], sides[:total]), exact > 0

    @cached_property
    def _tables(self) -> tuple[Floats | Integers, ...]:
        """What compiled code has to know: bounds, cells, and the polynomials' coefficients in the order of the rule.

        These are coefficients, their sizes, and those of functions and gradients side by side, the values' shares in
        Bernstein forms, and each polynomial's size at coordinates as large as `farthest`.
        """
        degree, order = self.degree, order_of_rule(self.degree)
        nodes, to_bernstein, growth = interpolation(degree, endless=not self.local.cells)
        jets = np.array([[p.dense(degree) for p in (patch, *map(patch.diff, range(3)))] for patch in self.patches])
        jets = jets[:, :, order]
        coefficients = np.ascontiguousarray(jets[:, 0])
        sizes = np.abs(coefficients) + TINY
        powers = np.array([sum(e) for e in exponents(degree)])[order]
        largest = (sizes * self.farthest**powers).sum(axis=1) * (1 + RELATIVE)
        piece_of = np.array(self.local.piece_of if self.local.cells else [0], dtype=np.intp)
        cells = (self.maps, self.widths, self.clear, piece_of)
        polynomials = (coefficients, sizes, np.ascontiguousarray(jets.transpose(0, 2, 1)))
        return np.array([growth, self.reach, self.farthest]), *cells, *polynomials, nodes, to_bernstein, largest


@cache
def interpolation(degree: int, endless: bool) -> tuple[Floats, Floats, float]:
    """Places (n+1,) on a stretch, the map from values there to Bernstein coefficients (n+1, n+1), how errors grow.

    The shares of the places are inside [0, 1], near Chebyshev's; where the stretch is endless, they are told as
    s / (1 - s), and the form is that of (1 - s)^n f, which has the same zeros.  The map is exact and then rounded, and
    so are the products with it: (n + 2) roundings in all, less than the samples' own, so that errors count twice the
    norm of the map from values of the polynomial of the form.
    """
    node_bits = 16  # of the nodes of interpolation, so that the matrix is one of integers, whose inverse is exact
    one = 1 << node_bits
    angles = np.pi * (2 * np.arange(degree + 1) + 1) / (2 * degree + 2)
    nodes = np.rint(one * (1 - np.cos(angles)) / 2).astype(int).tolist()
    basis = [comb(degree, j) * (one - s) ** (degree - j) * s**j for s in nodes for j in range(degree + 1)]
    inverse = fmpz_mat(degree + 1, degree + 1, basis).inv() * one**degree
    rounded = np.array(to_floats(inverse.entries())).reshape(degree + 1, -1)
    growth = 2 * float(np.abs(rounded).sum(axis=1).max())
    if not endless:
        return np.array(nodes) / one, rounded, growth
    weights = [fmpq(one - s, one) ** degree for s in nodes]
    table = [[inverse[i, k] * w for k, w in enumerate(weights)] for i in range(degree + 1)]
    places = [float(Fraction(s, one - s)) for s in nodes]
    return np.array(places), np.array([to_floats(row) for row in table]), growth
