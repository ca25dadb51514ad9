"""Finite rectangles of parameters, surfaces in a frame of their own, and their Bernstein nets.

In its frame a surface is over the unit square, and about as large as 1.  Bounds and meshes are made there, so that they
do not depend on the units of space or parameters: squares of distances neither vanish nor overflow, and the parameters
of halved rectangles are exact.  Space is scaled by a power of two, which rounds nothing.

A rational surface over one denominator is a net in four coordinates, weight times point and weight (Farin 2002,
chapter 13): exact, and halved in doubles with bounds on rounding.  On [0, 1]^2 a polynomial has the coefficients b_ij =
sum_{p<=i, q<=j} C(i,p) C(j,q) / (C(n,p) C(m,q)) a_pq, and its values lie between them (Farin 2002, chapter 6).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from math import comb
from typing import Any, Self

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_mpoly
from numpy.typing import NDArray

from pas.algebra.jets import Jet
from pas.algebra.rational import rational, to_float
from pas.algebra.rational_function import GENERATORS, RING, over_common
from pas.arrays import AnyArray, Floats, Integers
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.search import Cells
from pas.bernstein.simplices import halved, halves
from pas.errors import GeometryError
from pas.parametric.maps import Domain, DomainLike, Interval, ParametricMap

Rectangle = tuple[tuple[fmpq, fmpq], tuple[fmpq, fmpq]]
Table = list[list[fmpq]]

SMALLEST = math.ulp(0.0)
"""The error of the smallest numbers that doubles hold."""


def exact_rectangle(surface: ParametricMap, domain: DomainLike = None) -> Rectangle:
    """The finite rectangle to mesh, exact as its ends are given: `domain`, completed by the surface's own.

    An interval None, or an end None, is that of the surface.  Raises `ValueError` naming a parameter that has no
    finite interval or one outside the surface's domain.
    """
    given, result = surface.with_domain(domain), []
    for axis, name in enumerate(surface.parameters):
        own = surface.domain[axis]
        low, high = (e if math.isfinite(e) else o for e, o in zip(given.domain[axis], own, strict=True))
        if not math.isfinite(high - low):
            sides = ["(-1, 1)" if not np.isfinite(side).all() else "None" for side in surface.domain]
            raise ValueError(
                f"the domain of {name} is infinite ({low:g} to {high:g}); ready-made surfaces (spheres, tori, tubes, "
                "surfaces of revolution) are made with angle=True to go round the whole turn; of others, or for a part "
                f"of the turn, give a finite one, such as domain=({', '.join(sides)})"
            )
        if not own[0] <= low < high <= own[1]:
            raise ValueError(
                f"the interval [{low:g}, {high:g}] of {name} is not within the surface's domain "
                f"[{own[0]:g}, {own[1]:g}]"
            )
        lows, highs = zip(surface.ends[axis], given.ends[axis], strict=True)
        ends = max(rational(e) for e in lows if e is not None), min(rational(e) for e in highs if e is not None)
        result.append(ends)  # a double given for an end may lie outside by its rounding
    return result[0], result[1]


def finite_domain(surface: ParametricMap, domain: DomainLike = None) -> Domain:
    """The finite rectangle to mesh in doubles; raises as `exact_rectangle` does."""
    first, second = ((to_float(low), to_float(high)) for low, high in exact_rectangle(surface, domain))
    return first, second


def finite_part(interval: Interval) -> Interval:
    """An interval itself, or a part, about 2 long, of one longer than doubles hold, in which samples are taken."""
    low, high = interval
    part = max(low, min(-1.0, high - 2.0)), min(high, max(1.0, low + 2.0))
    return interval if math.isfinite(high - low) else part


@dataclass(frozen=True)
class Framed:
    """`surface` is (P(low + (high - low) u, ...) - center) / 2^exponent over [0, 1]^2, with `bounded` P and its finite
    domain, and the center (3,) a whole multiple of 2^exponent."""

    bounded: ParametricMap
    surface: ParametricMap
    center: Floats
    exponent: int
    size: float

    @classmethod
    def of(cls, bounded: ParametricMap) -> Framed:
        """The frame of a surface with a finite domain; raises as `extent` does."""
        middle, size = extent(bounded)
        exponent = math.frexp(size)[1] - 1
        center = np.ldexp(np.round(np.ldexp(middle, -exponent)), exponent)
        first, second = bounded.domain

        def values(u: Any, v: Any) -> tuple[Any, ...]:
            given = bounded.values(_moved(u, first), _moved(v, second))
            parts = (p - c for p, c in zip(given, center, strict=True))
            return tuple(
                Jet(np.ldexp(p.coefficients, -exponent)) if isinstance(p, Jet) else np.ldexp(p, -exponent)
                for p in parts
            )

        made = ParametricMap.from_parts(values, None, bounded.parameters, ((0, 1), (0, 1)), "it is framed")
        return cls(bounded, made, center, exponent, math.ldexp(size, -exponent))

    def inside(self, length: float) -> float:
        """A length of the model's in this frame; at most 1e300."""
        return min(float(np.ldexp(length, -self.exponent)), 1e300)

    def outside(self, length: float) -> float:
        """A bound of this frame in the model's lengths, rounded upwards, points being rounded to doubles."""
        return math.nextafter(float(np.ldexp(length, self.exponent)), math.inf) + 2 * SMALLEST

    def points_outside(self, points: Floats) -> tuple[Floats, float]:
        """Points (..., 3) of this frame in the model's coordinates, and how far, in this frame, that rounds them."""
        moved = np.ldexp(points, self.exponent) + self.center
        off = np.where(self.center == 0, 0.0, 2 * UNIT_ROUNDOFF * np.abs(moved))  # 2 > sqrt(3) coordinates
        return moved, float(np.ldexp(off.max(initial=0.0), -self.exponent))

    def parameters_outside(self, shares: Floats) -> Floats:
        """Parameters (..., 2) of the surface from those of the unit square."""
        parts = [_moved(shares[..., axis], interval) for axis, interval in enumerate(self.bounded.domain)]
        return np.stack(parts, axis=-1)


def extent(surface: ParametricMap) -> tuple[Floats, float]:
    """The middle (3,) and the longest side of the box around a few points of a surface on a finite domain.

    Raises `GeometryError` where that is zero or infinite.
    """
    t, h = (_moved(np.linspace(0.0, 1.0, 17), interval) for interval in surface.domain)
    points = surface.on_grid(t, h).reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    with np.errstate(over="ignore"):
        size = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    if not 0 < size < math.inf:
        raise GeometryError("the surface is a single point, or has no finite points, on this domain")
    return (points.min(axis=0) + points.max(axis=0)) / 2, size


def _moved(u: Any, interval: Interval) -> Any:
    """low + (high - low) u, at arrays or series, such that ends go to ends and nothing outside."""
    low, high = interval
    width = high - low
    share = u.value if isinstance(u, Jet) else np.asarray(u, dtype=float)
    place = np.clip(np.where(share <= 0.5, low + width * share, high - width * (1.0 - share)), low, high)
    if not isinstance(u, Jet):
        return place
    coefficients = u.coefficients * width
    coefficients[0, 0] = place
    return Jet(coefficients)


@dataclass(frozen=True, eq=False)
class ExactNet:
    """An exact surface over a rectangle: an array (m+1, n+1, 4) of rationals, three numerators and their denominator.

    m and n are at least 1; the denominator is positive in the middle, if not zero there.
    """

    table: NDArray[np.object_]
    rectangle: Rectangle

    @property
    def weights(self) -> NDArray[np.object_]:
        """The coefficients (m+1, n+1) of the denominator."""
        return self.table[..., 3]

    def halves(self, axis: int) -> tuple[ExactNet, ExactNet]:
        """Both halves along a parameter."""
        (low, high), other = self.rectangle[axis], self.rectangle[1 - axis]
        sides = (low, (low + high) / 2), ((low + high) / 2, high)
        first, second = ((other, side) if axis else (side, other) for side in sides)
        lower, upper = halves(self.table, axis)
        return ExactNet(lower, first), ExactNet(upper, second)

    def rounded(self) -> Nets:
        """The net in doubles, scaled exactly to weights of at most 1, as one cell."""
        net = np.vectorize(to_float, otypes=[float])(self.table / np.abs(self.weights).max())[None]
        return Nets(net, UNIT_ROUNDOFF * np.abs(net).max(axis=3) + SMALLEST)


@dataclass(frozen=True)
class Nets(Cells):
    """Nets of cells in doubles (C, m+1, n+1, d), and what the coefficients may be off by (C, m+1, n+1).

    Of surfaces d is 4, weights last.

    Coefficients err by 2^-53 of themselves when they are rounded.  Halving, a product with weights of sum 1, takes
    means of these errors, and adds (n+3) 2^-53 of the mean of absolute values, n the degree (Higham 2002, section 3.1).
    """

    table: Floats
    off: Floats

    def halves(self, axis: int) -> Self:
        """The first halves of all cells along a parameter, then the second ones."""
        off = self.off + (self.table.shape[1 + axis] + 2) * UNIT_ROUNDOFF * np.abs(self.table).max(axis=3)
        off = off[..., None] * (1 + 2.0**-40)  # their own rounding
        others = {name: np.concatenate([a, a]) for name, a in self._arrays.items() if name not in ("table", "off")}
        table, off = (np.concatenate(halved(nets, axis)) for nets in (self.table, off))
        return replace(self, table=table, off=off[..., 0], **others)

    def split(self, axes: Integers) -> Self:
        """Both halves of all cells, each along a parameter of its own, `axes` (C,)."""
        if axes.min() == axes.max():
            return self.halves(int(axes[0]))
        first, second = (self.select(axes == axis).halves(axis) for axis in (0, 1))
        return first.joined([second])


@dataclass(frozen=True)
class PlacedNets(Nets):
    """Nets on parts of the unit square, whose lower corners are at `start` / 2^`steps` (C, 2).

    `steps` are the halvings so far, `start` whole numbers of any size.
    """

    start: AnyArray
    steps: Integers

    def halves(self, axis: int) -> Self:
        step, count, both = (np.arange(2) == axis).astype(int), len(self), super().halves(axis)
        start = both.start * (1 + step)
        start[count:] += step
        return replace(both, start=start, steps=both.steps + step)


def exact_net(surface: ParametricMap, rectangle: Rectangle, framed: Framed | None = None) -> ExactNet:
    """The net of an exact surface, as it is or in a frame, over the least common denominator; raises `ValueError` for
    any other."""
    center, exponent = ([0.0] * 3, 0) if framed is None else (framed.center.tolist(), framed.exponent)
    tops, below = over_common(surface.components)
    moved = [low + (high - low) * g for g, (low, high) in zip(GENERATORS, rectangle, strict=True)]
    whole = [*((top - rational(c) * below) / fmpq(2) ** exponent for top, c in zip(tops, center, strict=True)), below]
    parts = [p.compose(*moved, ctx=RING) for p in whole]
    sizes = [p.degrees() for p in parts if not p.is_zero()]
    degrees = [max(1, *(int(d[axis]) for d in sizes)) for axis in (0, 1)]
    sign = -1 if parts[3](fmpq(1, 2), fmpq(1, 2)) < 0 else 1
    return ExactNet(np.stack([np.array(box_form(p * sign, degrees)) for p in parts], axis=-1), rectangle)


def bernstein_at(degree: int, t: Floats, order: int = 0) -> Floats:
    """The derivatives of an order of the Bernstein polynomials at t (...): (..., degree + 1)."""
    if order > degree:
        return np.zeros((*t.shape, degree + 1))
    low = degree - order
    rows = np.stack([comb(low, i) * t**i * (1.0 - t) ** (low - i) for i in range(low + 1)], axis=-1)
    for k in range(order):
        rows = -np.diff(rows, axis=-1, prepend=0.0, append=0.0) * (low + k + 1)
    return rows


def bernstein_polynomials(degree: int, generator: fmpq_mpoly, low: fmpq, high: fmpq) -> list[fmpq_mpoly]:
    """The exact Bernstein polynomials of [low, high] in a generator of the ring."""
    ahead, behind = (generator - low) / (high - low), (high - generator) / (high - low)
    return [comb(degree, i) * ahead**i * behind ** (degree - i) for i in range(degree + 1)]


def box_form(polynomial: fmpq_mpoly, degrees: list[int]) -> Table:
    """The coefficients over [0, 1]^2 as a polynomial of these degrees, exact."""
    table = fmpq_mat(degrees[0] + 1, degrees[1] + 1)
    for (p, q), c in polynomial.to_dict().items():
        table[int(p), int(q)] = c
    first, second = map(_to_bernstein, degrees)
    return (first * table * second.transpose()).tolist()


@cache
def _to_bernstein(degree: int) -> fmpq_mat:
    """The matrix C(i, p) / C(n, p), from the coefficients of powers to those of Bernstein polynomials."""
    return fmpq_mat([[fmpq(comb(i, p), comb(degree, p)) for p in range(degree + 1)] for i in range(degree + 1)])


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
    return np.array([comb(degree, i) for i in range(degree + 1)], dtype=float)
