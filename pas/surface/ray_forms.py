"""The segments of rays in the cells of a partition, and the Bernstein forms of a surface on them, with error bounds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from math import comb
from typing import TYPE_CHECKING

import numpy as np
from flint import fmpz_mat
from numpy.typing import NDArray

from pas.algebra.kernels import horner, order_of_rule
from pas.algebra.monomials import Floats, exponents
from pas.algebra.rational import to_floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.surface.kernels import HIGHEST, Scene
from pas.surface.ray_cells import MARGIN, RELATIVE, TINY, LocalRays, Rows, Stretches

if TYPE_CHECKING:
    from pas.surface.evaluator import Evaluator

SPAN_ENTRIES = 1 << 16
"""Barycentric coordinates that are worked on at once (512 KB)."""

ROUNDINGS = 8
"""Of |origin| + t |way| + reach, by which a point on a ray may be off."""

NODE_BITS = 16
"""Of the nodes of interpolation, so that the matrix is one of integers, whose inverse is exact."""


@dataclass(frozen=True)
class Segments:
    """Parts of rays in pieces, at most one of each ray: `rays`, `pieces`, `start`, `first`, `last` and `end` (M,).

    The ray is in the piece at most from `start` to `end`, certainly from `first` to `last` (see
    `pas.surface.ray_cells`).  `origins` and `ways` (M, 3) are those of the rays, in local coordinates.  Where `end` is
    infinite, `lengths` (M,) is the parameter t for which the share of the way is a half; all are finite or none.
    """

    rays: Rows
    pieces: Rows
    start: Floats
    first: Floats
    last: Floats
    end: Floats
    origins: Floats
    ways: Floats
    lengths: Floats

    def some(self, chosen: Rows | NDArray[np.bool_]) -> Segments:
        """Some of them, by numbers or by which are wanted."""
        return Segments(*(column[chosen] for column in vars(self).values()))

    def at(self, shares: Floats) -> Floats:
        """The parameters at shares (M,) of the way: t = start + share (end - start), or length share / (1 - share)."""
        if np.isinf(self.end).any():
            return self.lengths * shares / (1 - shares)
        return self.start + shares * (self.end - self.start)

    def points(self, parameters: Floats) -> Floats:
        """The points (M, 3) at parameters (M,)."""
        return self.origins + parameters[:, None] * self.ways

    def slack(self) -> Floats:
        """Up to which shares from `start`, and from `end`, it is not certain that rays are in the piece, (2, M)."""
        if np.isinf(self.end).any():
            return np.zeros((2, len(self.rays)))
        shares = np.stack([self.first - self.start, self.end - self.last]) / (self.end - self.start)
        return np.where(self.first < self.last, np.minimum(2 * shares, 1.0), np.inf)


def joined(parts: list[Segments]) -> Segments:
    """Those of several lists, which may be several of a ray."""
    return Segments(*(np.concatenate(column) for column in zip(*(vars(part).values() for part in parts), strict=True)))


def segments_of(evaluator: Evaluator, rays: LocalRays) -> Iterator[Segments]:
    """The segments of rays that are not doubtful: first the first of each, then the second, and so on."""
    partition, number = evaluator.partition.local, len(rays.origins)
    if not partition.cells:
        lengths = (1 + np.abs(rays.origins).max(axis=1)) / np.abs(rays.ways).max(axis=1)
        zero, whole = np.zeros(number), np.full(number, np.inf)
        pieces = np.zeros(number, dtype=np.intp)
        yield Segments(np.arange(number), pieces, zero, zero, whole, whole, rays.origins, rays.ways, lengths)
        return
    step = max(1, SPAN_ENTRIES // (4 * len(partition.cells)))
    parts = (rays.some(np.arange(first, min(first + step, number))) for first in range(0, number, step))
    found = [Stretches.of(evaluator.walls, part.origins, part.ways, evaluator.reach) for part in parts]
    stretches = zip(*(np.concatenate(column, axis=1) for column in zip(*found, strict=True)), strict=True)
    for cells, start, first, last, end in stretches:
        rows = np.flatnonzero(np.isfinite(start))
        if not len(rows):
            return
        own = rays.some(rows)
        bounds = start[rows], first[rows], last[rows], end[rows]
        yield Segments(rows, partition.piece_of[cells[rows]], *bounds, own.origins, own.ways, np.ones(len(rows)))


def forms_on(evaluator: Evaluator, segments: Segments) -> tuple[Floats, Floats]:
    """The Bernstein forms (n+1, M) of the surface on segments, and by how much their coefficients may be off (M,).

    On infinite segments it is that of (1 - s)^n f, which has the same zeros, where s is the share of the way.
    """
    degree = evaluator.degree
    nodes, to_bernstein, growth = _interpolation(degree)
    samples, errors = np.empty((degree + 1, len(segments.rays))), np.empty(len(segments.rays))
    endless = not evaluator.partition.cells
    for piece in np.unique(segments.pieces).tolist():
        rows = np.flatnonzero(segments.pieces == piece)
        own = segments.some(rows)
        parameters = np.stack([own.at(np.full(len(rows), node)) for node in nodes])
        points = own.origins.T[:, None] + parameters * own.ways.T[:, None]
        table = evaluator.tables[0][piece]
        values = np.empty((1, parameters.size))
        horner(table, degree, points.reshape(3, -1), values)
        samples[:, rows] = values.reshape(parameters.shape)
        errors[rows] = _errors(table, degree, own, evaluator.reach)
    if endless:
        samples *= ((1 - nodes) ** degree)[:, None]
    return to_bernstein @ samples, growth * errors


def _errors(table: Floats, degree: int, segments: Segments, reach: float) -> Floats:
    """How much samples of a polynomial on segments may be off (M,).

    With P the polynomial with coefficients |c|, Horner's rule errs by at most g P(|x|), where g = (2n + 8) 2^-53: the
    last 2 are for the coefficients' own rounding and the factor (1 - s)^n; what underflows is made up for by adding
    `TINY` to coefficients.  A point that is off by d <= h changes the value by at most d P(|x| + h) / h, since P is
    convex and grows; here h is half of `MARGIN`, and the other half is for |x| itself.  For larger d the bound is above
    P and so above all forms, which decides nothing.  A point is off by at most `ROUNDINGS` of |origin| + t |way| + |the
    region's place|: two of the local origin, and of t |way| four in t and two in product and sum.  On infinite segments
    the points' roundings are relative to what Horner's rule multiplies, and with those of (1 - s)^n add 7n to g;
    (1 - s)^n P(|x|) is at most P(|o| + L |d|).
    """
    sizes, ways = np.abs(segments.origins), np.abs(segments.ways)
    factor: Floats | float
    if np.isinf(segments.end).any():
        furthest, factor = sizes + segments.lengths[:, None] * ways, (9 * degree + 8) * UNIT_ROUNDOFF
    else:
        ends = (np.abs(segments.points(t)) for t in (segments.start, segments.end))
        furthest = np.maximum(*ends) + MARGIN
        off = ROUNDINGS * UNIT_ROUNDOFF * (reach + sizes + segments.end[:, None] * ways).max(axis=1)
        factor = (2 * degree + 8) * UNIT_ROUNDOFF + 2 * off / MARGIN
    bound = np.empty((1, len(furthest)))
    horner(np.abs(table) + TINY, degree, np.ascontiguousarray(furthest.T), bound)
    return np.asarray(factor * bound[0])


@cache
def _interpolation(degree: int) -> tuple[Floats, Floats, float]:
    """Nodes inside [0, 1] near Chebyshev's, the map from values there to Bernstein coefficients, and how errors grow.

    The map is exact and then rounded, and so are the products with it: (n + 2) roundings in all, less than the samples'
    own, so that errors count twice the map's norm.
    """
    one = 1 << NODE_BITS
    angles = np.pi * (2 * np.arange(degree + 1) + 1) / (2 * degree + 2)
    nodes = np.rint(one * (1 - np.cos(angles)) / 2).astype(int).tolist()
    basis = [comb(degree, j) * (one - s) ** (degree - j) * s**j for s in nodes for j in range(degree + 1)]
    inverse = fmpz_mat(degree + 1, degree + 1, basis).inv() * one**degree
    rounded = np.array(to_floats(inverse.entries())).reshape(degree + 1, -1)
    return np.array(nodes) / one, rounded, 2 * float(np.abs(rounded).sum(axis=1).max())


def scene_of(evaluator: Evaluator) -> Scene | None:
    """What compiled code shoots rays at, None without cells or for a degree above `HIGHEST`."""
    local, degree = evaluator.partition.local, evaluator.degree
    if not local.cells or degree > HIGHEST:
        return None
    nodes, to_bernstein, growth = _interpolation(degree)
    order = order_of_rule(degree)
    jets = np.zeros((len(evaluator.patches), 4, len(order)))
    for row, (value, gradient) in enumerate(zip(evaluator.tables[0], evaluator.tables[1], strict=True)):
        jets[row, 0], jets[row, 1:, : gradient.shape[1]] = value[0], gradient
    jets = jets[:, :, order]
    tables, piece_of = np.ascontiguousarray(jets[:, 0]), np.asarray(local.piece_of, dtype=np.intp)
    polynomials = (tables, np.abs(tables) + TINY, np.ascontiguousarray(jets.transpose(0, 2, 1)))
    walls = evaluator.walls
    powers = np.array([sum(e) for e in exponents(degree)])[order]
    largest = (polynomials[1] * walls.farthest**powers).sum(axis=1) * (1 + RELATIVE)
    cells, limits = (walls.maps, walls.widths, walls.clear), (walls.farthest, growth, evaluator.reach)
    return Scene(degree, *cells, piece_of, *polynomials, nodes, to_bernstein, largest, *limits)


def bernstein_values(forms: Floats, shares: Floats) -> Floats:
    """Values (M,) of polynomials in Bernstein form (n+1, M) at points (M,) of [0, 1]."""
    degree, rest = len(forms) - 1, 1 - shares
    power, result = np.ones_like(shares), forms[0].copy()
    for i in range(1, degree + 1):
        power *= shares
        result *= rest
        result += (comb(degree, i) * power) * forms[i]
    return result
