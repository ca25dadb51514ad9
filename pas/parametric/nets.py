"""Bernstein nets: polynomials and exact surfaces over rectangles, exact, and halved in doubles with bounds on rounding.

Over [0, 1]^2 a polynomial has the coefficients b_ij = sum_{p<=i, q<=j} C(i,p) C(j,q) / (C(n,p) C(m,q)) a_pq in the
basis B_i(u) B_j(v) and its values lie between them (Farin 2002, chapters 6 and 13).  A rational surface over one
denominator is a net in four coordinates, weight times point and weight.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.bernstein.signs import UNIT_ROUNDOFF
from pas.parametric.rational_function import GENERATORS, ONE, RING, lcm

if TYPE_CHECKING:
    from pas.parametric.surface import ParametricSurface

SMALLEST = math.ulp(0.0)
"""By which the smallest numbers err that doubles hold."""

Table = list[list[fmpq]]
Rectangle = tuple[tuple[fmpq, fmpq], tuple[fmpq, fmpq]]


@dataclass(frozen=True)
class ExactNet:
    """An exact surface over a rectangle: tables of the three numerators and of the common denominator.

    All have the shape (m+1, n+1), m and n at least 1; the denominator is positive in the middle, if not zero there.
    """

    tops: tuple[Table, Table, Table]
    below: Table
    rectangle: Rectangle

    def rounded(self, unit: fmpq | int = 1) -> Nets:
        """The net in doubles, scaled exactly to weights of at most 1, lengths over `unit`, as one cell."""
        scale = max(abs(w) for row in self.below for w in row)
        scales = (*(scale * unit,) * 3, scale)
        tables = (*self.tops, self.below)
        net = np.stack(
            [
                np.array([[to_float(c / s) for c in row] for row in table])
                for table, s in zip(tables, scales, strict=True)
            ],
            axis=-1,
        )
        return Nets(net[None], np.array([UNIT_ROUNDOFF * np.abs(net).max() + SMALLEST]))


@dataclass(frozen=True)
class Nets:
    """Nets of cells in doubles (C, m+1, n+1, 4), weights last, and what any coefficient of a cell may be off by (C,).

    Coefficients err by 2^-53 of the greatest of their cell when they are rounded, and halving, a product with weights
    of sum 1, adds (n+3) times that, n the degree (Higham 2002, section 3.1).
    """

    table: Floats
    off: Floats

    def __len__(self) -> int:
        return len(self.table)

    def part(self, chosen: Any) -> Nets:
        """Some of the cells."""
        return Nets(self.table[chosen], self.off[chosen])

    def halves(self, axis: int) -> Nets:
        """The first halves of all cells along a parameter, then the second ones."""
        greatest = np.abs(self.table).max(axis=(1, 2, 3))
        off = self.off + (self.table.shape[1 + axis] + 2) * UNIT_ROUNDOFF * greatest
        return Nets(np.concatenate(halved(self.table, axis)), np.concatenate([off, off]))


def exact_net(surface: ParametricSurface, rectangle: Rectangle) -> ExactNet:
    """The net of an exact surface, over the least common denominator; raises `ValueError` for any other."""
    below = ONE
    for c in surface.components:
        below = lcm(below, c.denominator)
    parts = [
        _moved(p, rectangle) for p in (*(c.numerator * (below / c.denominator) for c in surface.components), below)
    ]
    sizes = [p.degrees() for p in parts if not p.is_zero()]
    degrees = [max(1, *(int(d[axis]) for d in sizes)) for axis in (0, 1)]
    sign = -1 if parts[3](fmpq(1, 2), fmpq(1, 2)) < 0 else 1
    x, y, z, w = (bernstein(p * sign, degrees) for p in parts)
    return ExactNet((x, y, z), w, rectangle)


def bernstein(polynomial: fmpq_mpoly, degrees: list[int]) -> Table:
    """The coefficients over [0, 1]^2 as a polynomial of these degrees, exact."""
    n, m = degrees
    table = [[fmpq(0)] * (m + 1) for _ in range(n + 1)]
    for (p, q), c in polynomial.to_dict().items():
        table[int(p)][int(q)] = c / (math.comb(n, int(p)) * math.comb(m, int(q)))
    rows = [_accumulated(row) for row in table]
    return [list(row) for row in zip(*(_accumulated(list(c)) for c in zip(*rows, strict=True)), strict=True)]


def halved(nets: Floats, axis: int) -> tuple[Floats, Floats]:
    """Both halves of nets (C, m+1, n+1, d) along parameter `axis`, by de Casteljau's subdivision."""
    if axis == 0:
        flat = nets.reshape(*nets.shape[:2], -1)
        left, right = (np.matmul(matrix, flat).reshape(nets.shape) for matrix in _halving(nets.shape[1]))
    else:
        left, right = (np.matmul(matrix, nets) for matrix in _halving(nets.shape[2]))
    return left, right


def product(left: Floats, right: Floats) -> Floats:
    """Products of nets (C, m+1, n+1, d) and (C, k+1, l+1, d): degrees add, C and d broadcast (Farin 2002, 5.12)."""
    degrees = [(a - 1, b - 1) for a, b in zip(left.shape[1:3], right.shape[1:3], strict=True)]
    (rows, more), (columns, further) = ((_binomials(a), _binomials(b)) for a, b in degrees)
    first = left * (rows[:, None] * columns[None, :])[..., None]
    second = right * (more[:, None] * further[None, :])[..., None]
    count, last = max(len(left), len(right)), max(left.shape[3], right.shape[3])
    result = np.zeros((count, degrees[0][0] + degrees[0][1] + 1, degrees[1][0] + degrees[1][1] + 1, last))
    for i in range(right.shape[1]):
        for j in range(right.shape[2]):
            result[:, i : i + left.shape[1], j : j + left.shape[2]] += first * second[:, i, j][:, None, None]
    return result / (_binomials(sum(degrees[0]))[:, None] * _binomials(sum(degrees[1]))[None, :])[..., None]


def _binomials(degree: int) -> Floats:
    return np.array([math.comb(degree, i) for i in range(degree + 1)], dtype=float)


@lru_cache(maxsize=64)
def _halving(size: int) -> tuple[Floats, Floats]:
    left = np.array([[math.comb(i, k) / 2**i for k in range(size)] for i in range(size)])
    return left, np.ascontiguousarray(left[::-1, ::-1])


def _moved(polynomial: fmpq_mpoly, rectangle: Rectangle) -> fmpq_mpoly:
    """The polynomial as one on [0, 1]^2."""
    first, second = (low + (high - low) * g for g, (low, high) in zip(GENERATORS, rectangle, strict=True))
    return polynomial.compose(first, second, ctx=RING)


def _accumulated(values: list[fmpq]) -> list[fmpq]:
    """b_i = sum_p C(i, p) a_p by repeated sums."""
    result, row = [], list(values)
    while row:
        result.append(row[0])
        row = [a + b for a, b in pairwise(row)]
    return result
