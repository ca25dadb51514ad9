"""Hermite interpolation: the basis L_ij whose derivatives up to order k at given values are unit vectors, and blends.

With W = prod (h - s_l)^(k+1) and i, j fixed, L_ij is the Taylor polynomial of (h - s_i)^(k+1) / W at
s_i, cut off at degree k - j, times (h - s_i)^j / j! and W / (h - s_i)^(k+1) (Spitzbart 1960; used
for blending by Perez-Diaz and Sendra 2003).  The degree is n(k+1) - 1 at most, and the basis is
unique since the confluent Vandermonde determinant does not vanish.

The Hermite blend is T = sum_i sum_{j<=k} (d^j P_i/dh^j)(t, s_i) L_ij(h) (Perez-Diaz and Sendra 2003, algorithm 1).  The
denominators are polynomials in t alone, so the sum is a product of two matrices of rationals, and lowest terms need
greatest common divisors in t only.

In doubles it is evaluated without expanding it, fast and stable: T = sum_i w_i(h) S_i(t, h - s_i),
w_i = prod_{l != i} ((h - s_l)/(s_i - s_l))^(k+1) and S_i the Taylor polynomial of degree k of P_i / w_i at s_i.  The
factors w_i stay factored.  Where the denominators of a surface do not depend on h, S_i is a combination of
t^a (h - s_i)^j over them, and those of all surfaces with one denominator are added before anything is evaluated
(`Group`); the coefficients of other surfaces come from Taylor arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, reduce
from itertools import combinations
from math import factorial, prod
from operator import mul
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_poly

from pas.algebra.expressions import Names
from pas.algebra.horner import as_arrays, dense, horner, product
from pas.algebra.inputs import check_order, short, shown
from pas.algebra.jets import Jet, along, constant, nilpotency, power, variables
from pas.algebra.monomials import Floats
from pas.algebra.rational import Exact, plain, rational, to_float, to_fraction
from pas.algebra.rational_function import ONE, RING, RationalFunction
from pas.limits import checkpoint
from pas.parametric.series import Components, in_one, padded, taylor, univariate
from pas.parametric.surface import ParametricSurface


@dataclass(frozen=True)
class Expansion:
    """Taylor coefficients in h of one component: `numerators[j] / denominator` as functions of t.

    The denominator is the least common one of all j (in lowest terms, monic).
    """

    numerators: tuple[fmpq_poly, ...]
    denominator: fmpq_poly

    @property
    def functions(self) -> list[RationalFunction]:
        """The coefficients, each in lowest terms."""
        below = univariate(self.denominator, 0)
        return [RationalFunction.quotient(univariate(n, 0), below) for n in self.numerators]


def hermite_basis(values: Sequence[Exact], order: int) -> tuple[tuple[RationalFunction, ...], ...]:
    """The polynomials L[i][j] in h, i = 0..n-1, j = 0..order.

    The m-th derivative of L[i][j] at values[l] is 1 for (l, m) = (i, j), else 0, for m <= order (Spitzbart 1960).
    Raises `ValueError` for equal values or a negative order.
    """
    at, k = distinct(values), check_order(order)
    return tuple(
        tuple(
            RationalFunction.from_lowest_terms(univariate(p * fmpq(1, factorial(j)), 1), ONE)
            for j, p in enumerate(taylor_basis(at, i, k))
        )
        for i in range(len(at))
    )


def hermite_determinant(values: Sequence[Exact], order: int) -> Fraction:
    """The determinant of the interpolation problem, in rows d^j/dh^j at values[i] (i outer, j inner).

    `prod_j (j!)^n prod_{i<r} (s_r - s_i)^((k+1)^2)`, j = 0..k: not zero, so there is one solution (Spitzbart 1960).

    Raises `ValueError` for equal values or an order out of range.
    """
    at, k = distinct(values), check_order(order)
    differences = prod(((b - a) ** ((k + 1) ** 2) for a, b in combinations(at, 2)), start=fmpq(1))
    return to_fraction(differences * prod(factorial(j) ** len(at) for j in range(k + 1)))


def blending_polynomial(values: Sequence[fmpq], order: int) -> fmpq_poly:
    """W = prod (h - s_l)^(k+1)."""
    return prod((fmpq_poly([-s, 1]) for s in values), start=fmpq_poly([1])) ** (order + 1)


def taylor_basis(values: Sequence[fmpq], number: int, order: int) -> list[fmpq_poly]:
    """The basis for Taylor coefficients instead of derivatives: j! L_ij, j = 0..order."""
    node = values[number]
    step = fmpq_poly([-node, 1])
    outer = fmpq_poly([1])
    for other in _others(values, number):
        outer = outer * fmpq_poly([-other / (node - other), 1 / (node - other)])
    outer = outer ** (order + 1)
    inverse = inverse_series(values, number, order)
    basis = []
    for j in range(order + 1):
        cut = fmpq_poly([fmpq(0)])
        for coefficient in reversed(inverse[: order - j + 1]):
            cut = cut * step + coefficient
        basis.append(outer * cut * step**j)
    return basis


def inverse_series(values: Sequence[fmpq], number: int, order: int) -> list[fmpq]:
    """Taylor coefficients at s_i of prod_{l != i} ((s_i - s_l) / (h - s_l))^(k+1)."""
    node = values[number]
    series = fmpq_poly([1])
    for other in _others(values, number):
        geometric = fmpq_poly([(-1 / (node - other)) ** m for m in range(order + 1)])
        series = series.mul_low(geometric, order + 1)
    whole = fmpq_poly([1])
    for _ in range(order + 1):
        whole = whole.mul_low(series, order + 1)
    return padded(whole, order + 1)


def _others(values: Sequence[fmpq], number: int) -> list[fmpq]:
    return [value for i, value in enumerate(values) if i != number]


def distinct(values: Sequence[Exact]) -> tuple[fmpq, ...]:
    """Exact values, checked to be at least one and distinct."""
    if isinstance(values, str) or not hasattr(values, "__len__") or len(values) == 0:
        raise TypeError(f"values must be a sequence of numbers, not {shown(values)}")
    exact = tuple(rational(value, f"values[{i}]") for i, value in enumerate(values))
    for (i, a), (j, b) in combinations(enumerate(exact), 2):
        if a == b:
            raise ValueError(f"values[{i}] and values[{j}] are both {short(plain(a))}; give each surface its own value")
    return exact


def exact_hermite(
    values: Sequence[fmpq], expansions: Sequence[Sequence[Expansion]], order: int, names: Names
) -> Components:
    """The blend in lowest terms from the expansions of the three components of each surface."""
    rows = [p for i in range(len(values)) for p in taylor_basis(values, i, order)]
    width = max(p.length() for p in rows)
    basis = fmpq_mat(len(rows), width, [c for p in rows for c in padded(p, width)])
    x, y, z = (_summed([parts[axis] for parts in expansions], basis, names) for axis in range(3))
    return x, y, z


def _summed(parts: Sequence[Expansion], basis: fmpq_mat, names: Names) -> RationalFunction:
    """One component: coefficients in t (columns) times the basis (rows) is a matrix of coefficients."""
    checkpoint("adding up the Hermite blend")
    below = fmpq_poly([1])
    for part in parts:
        below = below * (part.denominator / below.gcd(part.denominator))
    tops = [n * (below / part.denominator) for part in parts for n in part.numerators]
    height = max(p.length() for p in tops)
    if height == 0:
        return RationalFunction(0, names)
    table = fmpq_mat(len(tops), height, [c for p in tops for c in padded(p, height)]).transpose() * basis
    columns = [fmpq_poly([table[a, b] for a in range(height)]) for b in range(table.ncols())]
    common = below
    for column in columns:
        common = common.gcd(column)
    terms: dict[tuple[int, ...], fmpq] = {
        (a, b): c for b, column in enumerate(columns) for a, c in enumerate((column / common).coeffs()) if c != 0
    }
    return RationalFunction.from_lowest_terms(RING.from_dict(terms), univariate(below / common, 0), names)


@dataclass(frozen=True, eq=False)
class HermiteValues:
    """The coordinates of the Hermite blend at two arrays or jets, prepared when first asked for."""

    surfaces: tuple[ParametricSurface, ...]
    values: tuple[fmpq, ...]
    order: int

    def __call__(self, t: Any, h: Any) -> tuple[Any, ...]:
        groups, series = self._parts
        if isinstance(t, Jet) or isinstance(h, Jet):
            like = t if isinstance(t, Jet) else h
            t, h = (x if isinstance(x, Jet) else constant(x, like) for x in (t, h))
        else:
            t, h = as_arrays(t, h)
        nodes = [to_float(s) for s in self.values]
        total: list[Any] = [0.0, 0.0, 0.0]
        with np.errstate(all="ignore"):
            functions = _functions_of_h(h, nodes, self.order)
            stacked = functions if isinstance(functions, np.ndarray) else np.stack([f.coefficients for f in functions])
            for group in groups:
                for axis, value in zip(group.axes, group.values(t, stacked), strict=True):
                    total[axis] = value if isinstance(total[axis], float) else total[axis] + value
            for number, part in series:
                outer, step = functions[number * (self.order + 1)], h - nodes[number]
                for axis, coefficients in enumerate(part(t)):
                    total[axis] = total[axis] + reduce(lambda inner, c: inner * step + c, coefficients[::-1]) * outer
        return tuple(total)

    @cached_property
    def _parts(self) -> tuple[list[Group], list[tuple[int, _NumericSeries]]]:
        """What can be added over denominators in t alone, and the other surfaces by their numbers."""
        values, order = self.values, self.order
        columns: dict[str, tuple[fmpq_poly, dict[tuple[int, int], list[fmpq_poly]]]] = {}
        series: list[tuple[int, _NumericSeries]] = []
        for i, (surface, value) in enumerate(zip(self.surfaces, values, strict=True)):
            inverse = inverse_series(values, i, order)
            if not surface.is_exact or any(c.denominator.degrees()[1] for c in surface.components):
                series.append((i, _NumericSeries(surface, to_float(value), [to_float(v) for v in inverse])))
                continue
            for axis, component in enumerate(surface.components):
                below, lead = in_one(component.denominator, 0), component.denominator.leading_coefficient()
                _, found = columns.setdefault(str(below / lead), (below / lead, {}))
                found[axis, i * (order + 1)] = [p / lead for p in _mixed(component, value, inverse)]
        number = len(values) * (order + 1)
        return [Group.of(below, found, number) for below, found in columns.values()], series


@dataclass(frozen=True)
class Group:
    """Components (numbers `axes`) over one denominator (coefficients in t, None for 1).

    `matrix[a, c, m]` is the coefficient of t^a times function m of h in component `axes[c]`.
    """

    axes: tuple[int, ...]
    matrix: Floats
    below: Floats | None

    @classmethod
    def of(cls, below: fmpq_poly, columns: dict[tuple[int, int], list[fmpq_poly]], number: int) -> Group:
        """The sums of columns[axis, first][j](t) / below(t) times function first + j of the `number` there are."""
        scale = max(abs(c) for c in below.coeffs())
        axes = tuple(sorted({axis for axis, _ in columns}))
        length = max(p.length() for polynomials in columns.values() for p in polynomials)
        matrix = np.zeros((max(length, 1), len(axes), number))
        for (axis, first), polynomials in columns.items():
            table = dense(polynomials, scale)
            matrix[: len(table), axes.index(axis), first : first + len(polynomials)] = table
        return cls(axes, matrix, None if below.degree() == 0 else dense([below], scale)[:, 0])

    def values(self, t: Any, functions: Floats) -> list[Any]:
        """Values of the components `axes`; `functions` are stacked (of jets, the coefficients)."""
        rows = product(self.matrix, functions)
        inverse = None if self.below is None else 1.0 / horner(self.below, t)
        if isinstance(t, Jet):
            parts = [_along_t([Jet(row) for row in rows[:, c]], t) for c in range(len(self.axes))]
            return parts if inverse is None else [part * inverse for part in parts]
        whole = _along_t(rows, t)
        if inverse is not None:
            whole = np.multiply(whole, inverse, out=whole if whole.shape[1:] == inverse.shape else None)
        return list(whole)


def _along_t(rows: Sequence[Any] | Floats, t: Any) -> Any:
    """Horner's rule in t, in place once the shape is the full one."""
    value = rows[-1]
    for row in rows[-2::-1]:
        if isinstance(value, np.ndarray) and value.shape[1:] == t.shape:
            np.multiply(value, t, out=value)
        else:
            value = value * t
        value += row
    return value


def _functions_of_h(h: Any, nodes: Sequence[float], order: int) -> Any:
    """w_i(h) (h - s_i)^j, i outer, j inner: one array, these along its first axis, or a list for a jet."""
    steps = [h - node for node in nodes]
    result: Any = [None] * (len(nodes) * (order + 1))
    if not isinstance(h, Jet):
        result = np.empty((len(result), *h.shape))
    for i, (node, step) in enumerate(zip(nodes, steps, strict=True)):
        others = [(s, node - other) for j, (s, other) in enumerate(zip(steps, nodes, strict=True)) if j != i]
        first, scale = i * (order + 1), 1.0 / prod(width for _, width in others)
        result[first] = power(reduce(mul, (s for s, _ in others)) * scale, order + 1)
        for place in range(first + 1, first + order + 1):
            result[place] = result[place - 1] * step
    return result


def _mixed(component: RationalFunction, value: fmpq, inverse: Sequence[fmpq]) -> list[fmpq_poly]:
    """Taylor coefficients of the numerator over w_i."""
    top = taylor(component.numerator, value, len(inverse) - 1)
    return [sum((top[m] * inverse[j - m] for m in range(j + 1)), fmpq_poly([0])) for j in range(len(inverse))]


@dataclass(frozen=True)
class _NumericSeries:
    """Taylor coefficients of P_i / w_i at s_i by derivatives in h; `inverse` are those of 1 / w_i."""

    surface: ParametricSurface
    value: float
    inverse: list[float]

    def __call__(self, t: Any) -> list[list[Any]]:
        """The coefficients j = 0..k of (h - value)^j of each coordinate at t, arrays or jets."""
        base, order = (t.value if isinstance(t, Jet) else t), len(self.inverse) - 1
        parts = self.surface.values(*variables(base, self.value, (nilpotency(t), order)))
        return [self._mixed(part, t, order) for part in parts]

    def _mixed(self, part: Any, t: Any, order: int) -> list[Any]:
        if not isinstance(part, Jet):
            return [part * v + 0.0 * t for v in self.inverse]
        table = part.coefficients
        rows = [along(t, list(table[:, j])) if isinstance(t, Jet) else table[0, j] for j in range(order + 1)]
        return [sum(rows[m] * self.inverse[j - m] for m in range(j + 1)) for j in range(order + 1)]
