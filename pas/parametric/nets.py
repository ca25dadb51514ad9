"""Bernstein nets of exact surfaces over rectangles, exact, and halved in doubles with bounds on rounding.

A rational surface over one denominator is a net in four coordinates, weight times point and weight (Farin 2002,
chapter 13).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import comb
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.algebra.rational_function import GENERATORS, ONE, RING, lcm
from pas.bernstein.boxes import Table, box_form
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.subdivision import halved
from pas.parametric.framed import Rectangle
from pas.parametric.maps import ParametricMap

SMALLEST = math.ulp(0.0)
"""By which the smallest numbers err that doubles hold."""


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
        pairs = zip((*self.tops, self.below), scales, strict=True)
        net = np.stack([np.array([[to_float(c / s) for c in row] for row in table]) for table, s in pairs], axis=-1)
        return Nets(net[None], np.array([UNIT_ROUNDOFF * np.abs(net).max() + SMALLEST]))


@dataclass(frozen=True)
class Nets:
    """Nets of cells in doubles (C, m+1, n+1, d), and what any coefficient of a cell may be off by (C,).

    Of surfaces d is 4, weights last.

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


def exact_net(surface: ParametricMap, rectangle: Rectangle) -> ExactNet:
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
    x, y, z, w = (box_form(p * sign, degrees) for p in parts)
    return ExactNet((x, y, z), w, rectangle)


def _moved(polynomial: fmpq_mpoly, rectangle: Rectangle) -> fmpq_mpoly:
    """The polynomial as one on [0, 1]^2."""
    first, second = (low + (high - low) * g for g, (low, high) in zip(GENERATORS, rectangle, strict=True))
    return polynomial.compose(first, second, ctx=RING)


def bernstein_at(degree: int, t: Floats, order: int = 0) -> Floats:
    """The derivatives of an order of the Bernstein polynomials at t (...): (..., degree + 1)."""
    if order > degree:
        return np.zeros((*t.shape, degree + 1))
    low = degree - order
    rows = np.stack([comb(low, i) * t**i * (1.0 - t) ** (low - i) for i in range(low + 1)], axis=-1)
    for k in range(order):
        wide = np.zeros((*t.shape, rows.shape[-1] + 1))
        wide[..., 1:] += rows
        wide[..., :-1] -= rows
        rows = wide * (low + k + 1)
    return rows


def bernstein_polynomials(degree: int, generator: fmpq_mpoly, low: fmpq, high: fmpq) -> list[fmpq_mpoly]:
    """The exact Bernstein polynomials of [low, high] in a generator of the ring."""
    ahead, behind = (generator - low) / (high - low), (high - generator) / (high - low)
    return [comb(degree, i) * ahead**i * behind ** (degree - i) for i in range(degree + 1)]
