"""Rays in local coordinates, and where they are in the cells of a partition, between bounds on all rounding.

A ray is `origin + t way` with its direction times one power of two, so that the largest coordinate of `way` is from
1/2 to 1, and local coordinates.  That is exact but for the local origin's rounding and what is below 2^-1074, which is
far below all widths here and `TINY`.  Rays that start too far away are left to exact work.

Barycentric coordinates along a ray are `at + t slope`.  Their maps are exact and then rounded, and with the width
`8 u (sum of sizes of a map's four numbers)`, u = 2^-53, the sum `at` errs by at most `width (1 + |origin| + reach)` and
`slope` by at most the width, of which some roundings are left for what is done with them.  So the ray is in a cell
at most where all four of the larger lines are not negative, and certainly where the smaller are: it is in the cell from
somewhere between `start` and `first` to somewhere between `last` and `end`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from flint import fmpq, fmpq_mat
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.rational import dot, to_floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.partition.cells import Partition

if TYPE_CHECKING:
    from pas.surface.evaluator import Evaluator

MARGIN = 1 / 8
"""Local units by which points are moved outwards where errors are bounded (see `pas.surface.ray_forms`)."""

FARTHEST = 2.0**46
"""Local units beyond which nothing is tried: points of a ray that starts there may be off by `MARGIN` / 8 and more."""

ROUNDINGS = 8
"""Of which each number of a map is worth one unit roundoff in `widths`: six in sums, two in quotients of these."""

RELATIVE = 1e-9
"""Of sums that are bounds, more than their rounding."""

TINY = 2.0**-1000
"""Numbers of this size may have lost digits by underflow, 2^-1075 each time."""

Rows = NDArray[np.intp]
Bools = NDArray[np.bool_]


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
    def of(cls, evaluator: Evaluator, origins: Floats, directions: Floats) -> LocalRays:
        """Those of rays (N, 3) in the user's coordinates."""
        frame = evaluator.partition.frame
        sizes = np.frexp(np.abs(directions).max(axis=1))[1]
        ways = np.ldexp(directions, -sizes[:, None])
        with np.errstate(over="ignore"):
            starts = np.ascontiguousarray(frame.local_points(origins))
        doubtful = ~(np.abs(starts).max(axis=1) < FARTHEST)
        return cls(starts, ways, sizes - (np.frexp(evaluator.scale)[1] - 1), doubtful)

    def some(self, chosen: Rows | Bools) -> LocalRays:
        """Some of them, by numbers or by which are wanted."""
        return LocalRays(*(column[chosen] for column in vars(self).values()))

    def parameters(self, rays: Rows, lengths: Floats) -> Floats:
        """The user's parameters (M,) for those here, of rays with these numbers (M,): the nearest doubles."""
        with np.errstate(over="ignore", under="ignore"):
            return np.asarray(np.ldexp(lengths, -self.exponents[rays]))

    def points(self, evaluator: Evaluator, origins: Floats, rays: Rows, lengths: Floats) -> Floats:
        """The user's points (M, 3) at parameters here of rays with these numbers and origins (N, 3)."""
        ways = self.ways[rays]
        with np.errstate(invalid="ignore"):
            return np.asarray(origins[rays] + np.where(ways == 0, 0.0, (evaluator.scale * lengths)[:, None] * ways))


@dataclass(frozen=True)
class Walls:
    """The barycentric coordinates of C cells: `exact` (4C, 4), a row the constant and the factors of x, y and z.

    As doubles they are `maps` (4, 4, C), the factors of x, y, z and then the constant, which err as `widths` (4, C)
    say.  The cells' polynomials have no zero closer to 0 than `clear` (C,), in the maximum norm; no coordinate of the
    region is as large as `farthest`.
    """

    exact: fmpq_mat
    maps: Floats
    widths: Floats
    clear: Floats
    farthest: float

    @classmethod
    def of(cls, evaluator: Evaluator) -> Walls:
        """Those of the cells of an evaluator."""
        local = evaluator.partition.local
        rows = [row for cell in range(len(local.cells)) for row in _barycentric(local, cell)]
        rounded = np.array([to_floats(row) for row in rows]).reshape(-1, 4, 4)
        maps = np.ascontiguousarray(rounded[:, :, [1, 2, 3, 0]].transpose(1, 2, 0))
        widths = ROUNDINGS * UNIT_ROUNDOFF * np.abs(maps).sum(axis=1)
        clear = np.array([_clear(table[0]) for table in evaluator.tables[0]])[local.piece_of]
        entries = [value for row in rows for value in row]
        return cls(fmpq_mat(len(rows), 4, entries), maps, widths, clear, float(np.abs(local.points).max()) + MARGIN)


def _barycentric(partition: Partition, cell: int) -> list[list[fmpq]]:
    """The four coordinates of a cell: each is 0 on a face and 1 at the corner that is not on it."""
    rows = []
    for plane, corner in zip(partition.planes(cell), sorted(partition.cells[cell], reverse=True), strict=True):
        constant, *slope = plane.row(1)
        height = constant + dot(slope, partition.vertices[corner])
        rows.append([value / height for value in (constant, *slope)])
    return rows


def _clear(coefficients: Floats) -> float:
    """Up to which size of coordinates, at most 1, the constant of a polynomial outweighs its other terms."""
    constant, rest = abs(float(coefficients[0])), float(np.abs(coefficients[1:]).sum())
    return (1 - RELATIVE) * constant / max(constant, rest) if constant > TINY else 0.0


class Stretches(NamedTuple):
    """Where rays are in cells, (cells, N) each: of each ray in order of `start`, infinite where there is none.

    See the head of this module; where it is not certain that a ray is in a cell at all, `first` is not below `last`.
    """

    cells: Rows
    start: Floats
    first: Floats
    last: Floats
    end: Floats

    @classmethod
    def of(cls, walls: Walls, origins: Floats, ways: Floats, reach: float) -> Stretches:
        """Those of rays (N, 3) in local coordinates that are not doubtful."""
        sizes = np.abs(origins).max(axis=1)
        longest = 2 * (sizes + walls.farthest)
        factors = walls.maps[:, :3].transpose(0, 2, 1)
        at, slope = factors @ origins.T + walls.maps[:, 3, :, None], factors @ ways.T
        wide = walls.widths[:, :, None]
        off = wide * (1 + sizes + reach)
        start, end = _between(at + off, slope + wide, longest)
        first, last = _between(at - off, slope - wide, longest)
        start[(end < start) | (sizes + end <= walls.clear[:, None])] = np.inf
        order = np.argsort(start, axis=0, kind="stable")
        return cls(order, *(np.take_along_axis(column, order, axis=0) for column in (start, first, last, end)))


def _between(at: Floats, slope: Floats, longest: Floats) -> tuple[Floats, Floats]:
    """Where `at + t slope` (4, cells, N) are not negative: from where to where, (cells, N); below 0 for nowhere."""
    with np.errstate(divide="ignore", invalid="ignore"):
        met = -at / slope
    start = np.where(slope > 0, met, np.where((slope == 0) & (at < 0), np.inf, 0.0)).max(axis=0)
    end = np.where(slope < 0, met, longest).min(axis=0)
    return np.maximum(start, 0.0), end
