"""The segments of rays in the cells of a partition, and the Bernstein forms of a surface on them, with error bounds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from math import comb
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pas.algebra.compiled import order_of_rule
from pas.algebra.kernels import horner
from pas.algebra.monomials import Floats, exponents
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.partition.cells import Partition
from pas.surface.kernels import HIGHEST, Scene

if TYPE_CHECKING:
    from pas.surface.evaluator import Evaluator

MARGIN = 1 / 8
"""Local units by which points are moved outwards where errors are bounded (see `_errors`)."""

SPAN_ENTRIES = 1 << 16
"""Barycentric coordinates that are worked on at once (512 KB)."""

RELATIVE = 1e-9
"""Of sums that are bounds, more than their rounding."""

Rows = NDArray[np.intp]


@dataclass(frozen=True)
class Segments:
    """Parts of rays in pieces, at most one of each ray: `rays`, `pieces`, `start` and `end` (M,).

    `origins` and `directions` (M, 3) are those of the rays, in local coordinates.  Where `end` is infinite, `lengths`
    (M,) is the parameter t for which the share of the way is a half; either all are finite or none.
    """

    rays: Rows
    pieces: Rows
    start: Floats
    end: Floats
    origins: Floats
    directions: Floats
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
        return self.origins + parameters[:, None] * self.directions


def joined(parts: list[Segments]) -> Segments:
    """Those of several lists, which may be several of a ray."""
    return Segments(*(np.concatenate(column) for column in zip(*(vars(part).values() for part in parts), strict=True)))


def segments_of(evaluator: Evaluator, origins: Floats, directions: Floats) -> Iterator[Segments]:
    """The segments of rays (N, 3) in the user's coordinates: first the first of each, then the second, and so on."""
    partition = evaluator.partition.local
    starts, ways = evaluator.partition.frame.local_points(origins), directions / evaluator.scale
    if not partition.cells:
        lengths = (1 + np.abs(starts).max(axis=1)) / np.abs(ways).max(axis=1)
        zero = np.zeros(len(starts), dtype=np.intp)
        yield Segments(
            np.arange(len(starts)), zero, np.zeros(len(starts)), np.full(len(starts), np.inf), starts, ways, lengths
        )
        return
    step = max(1, SPAN_ENTRIES // (4 * len(partition.cells)))
    parts = (slice(first, first + step) for first in range(0, len(starts), step))
    spans = [_spans(partition, starts[part], ways[part], evaluator.tolerance) for part in parts]
    start, end, cells = (np.concatenate(column, axis=1) for column in zip(*spans, strict=True))
    for begin, stop, cell in zip(start, end, cells, strict=True):
        rays = np.flatnonzero(np.isfinite(begin))
        if not len(rays):
            return
        pieces = partition.piece_of[cell[rays]]
        yield Segments(rays, pieces, begin[rays], stop[rays], starts[rays], ways[rays], np.ones(len(rays)))


def _spans(partition: Partition, origins: Floats, directions: Floats, tolerance: float) -> tuple[Floats, Floats, Rows]:
    """Where rays enter and leave cells, and these cells, (cells, N) each: by rays in order, without gaps or overlaps.

    Cells are enlarged by the tolerance; a stretch in several of them counts to the first entered.  What there is no
    segment for is infinite.
    """
    at = partition.barycentric(origins) + tolerance
    slope = partition.barycentric(directions) - partition.barycentric(np.zeros((1, 3)))
    with np.errstate(divide="ignore", invalid="ignore"):
        met = -at / slope
    enter = np.maximum(np.where(slope > 0, met, -np.inf).max(axis=1), 0.0)
    leave = np.where(slope < 0, met, np.inf).min(axis=1)
    leave[((slope == 0) & (at < 0)).any(axis=1)] = -np.inf
    enter[leave <= enter] = np.inf
    order = np.argsort(enter, axis=0, kind="stable")
    enter, leave = (np.take_along_axis(a, order, axis=0) for a in (enter, leave))
    leave[np.isinf(enter)] = -np.inf
    before = np.maximum.accumulate(leave, axis=0)[:-1]
    enter[1:] = np.maximum(enter[1:], before)
    enter[leave <= enter] = np.inf
    again = np.argsort(enter, axis=0, kind="stable")
    start, end, cells = (np.take_along_axis(a, again, axis=0) for a in (enter, leave, order))
    return start, end, cells


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
        points = own.origins.T[:, None] + parameters * own.directions.T[:, None]
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
    last 2 are for the coefficients' own rounding and the factor (1 - s)^n.  A point that is off by d changes the value
    by at most d P(|x| + h) / h for any h, since P is convex and grows; here h is `MARGIN`.  A point is off by at most
    four roundings of |origin| + t |direction| + |the region's place|.  On infinite segments the points' roundings are
    relative to what Horner's rule multiplies, and add 6n to g; (1 - s)^n P(|x|) is at most P(|o| + L |d|).
    """
    sizes, ways = np.abs(segments.origins), np.abs(segments.directions)
    factor: Floats | float
    if np.isinf(segments.end).any():
        furthest, factor = sizes + segments.lengths[:, None] * ways, (8 * degree + 8) * UNIT_ROUNDOFF
    else:
        ends = (np.abs(segments.points(t)) for t in (segments.start, segments.end))
        furthest = np.maximum(*ends) + MARGIN
        off = 4 * UNIT_ROUNDOFF * (reach + sizes + segments.end[:, None] * ways).max(axis=1)
        factor = (2 * degree + 8) * UNIT_ROUNDOFF + 3 * off / MARGIN
    bound = np.empty((1, len(furthest)))
    horner(np.abs(table), degree, np.ascontiguousarray(furthest.T), bound)
    return np.asarray(factor * bound[0])


@cache
def _interpolation(degree: int) -> tuple[Floats, Floats, float]:
    """Chebyshev nodes inside [0, 1], the map from values there to Bernstein coefficients, and how errors grow in it.

    The map is rounded, and so are the products with it: errors count twice its norm, and its own are small beside.
    """
    powers = range(degree + 1)
    nodes = (1 - np.cos(np.pi * (2 * np.arange(degree + 1) + 1) / (2 * degree + 2))) / 2
    basis = np.array([[comb(degree, j) * (1 - s) ** (degree - j) * s**j for j in powers] for s in nodes])
    inverse = np.linalg.inv(basis)
    return nodes, inverse, 2 * float(np.abs(inverse).sum(axis=1).max())


def scene_of(evaluator: Evaluator) -> Scene | None:
    """What compiled code shoots rays at, None without cells or for a degree that is too high."""
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
    zero, units = local.barycentric(np.zeros((1, 3))), local.barycentric(np.eye(3))
    maps = np.concatenate([units - zero, zero], axis=2).transpose(1, 2, 0)
    polynomials = (tables, np.abs(tables), np.ascontiguousarray(jets.transpose(0, 2, 1)))
    farthest = float(np.abs(local.points).max()) + MARGIN
    powers = np.array([sum(e) for e in exponents(degree)])[order]
    largest = (polynomials[1] * farthest**powers).sum(axis=1) * (1 + RELATIVE)
    limits = (farthest, growth, evaluator.tolerance, evaluator.reach)
    return Scene(degree, np.ascontiguousarray(maps), piece_of, *polynomials, nodes, to_bernstein, largest, *limits)


def bernstein_values(forms: Floats, shares: Floats) -> Floats:
    """Values (M,) of polynomials in Bernstein form (n+1, M) at points (M,) of [0, 1]."""
    degree, rest = len(forms) - 1, 1 - shares
    power, result = np.ones_like(shares), forms[0].copy()
    for i in range(1, degree + 1):
        power *= shares
        result *= rest
        result += (comb(degree, i) * power) * forms[i]
    return result
