"""The Hermite blend: T = sum_i sum_{j<=k} (d^j P_i/dh^j)(t, s_i) L_ij(h), exactly and in doubles.

Source: Perez-Diaz and Sendra (2003), algorithm 1, with the Hermite basis written as
`T = sum_i w_i(h) S_i(t, h - s_i)`, w_i = prod_{l != i} ((h - s_l)/(s_i - s_l))^(k+1) and S_i the Taylor
polynomial of degree k of P_i / w_i at s_i.  In doubles the factors w_i stay factored and the S_i come
from the Taylor polynomials of numerators and denominators, so nothing large is expanded or cancelled.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_poly

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.limits import checkpoint
from pas.parametric.callables import Values
from pas.parametric.data import BlendingData, Expansion
from pas.parametric.expressions import Names
from pas.parametric.hermite import inverse_series, taylor_basis
from pas.parametric.horner import as_arrays, combinations, dense, horner
from pas.parametric.jets import Jet, along, nilpotency, power, variables
from pas.parametric.rational_function import RING, RationalFunction
from pas.parametric.series import taylor, univariate
from pas.parametric.surface import Components, ParametricSurface

Series = list[list[Any]]
"""For each of the three components the coefficients j = 0..k of (h - s_i)^j, arrays or jets; None for zero."""


def exact_hermite(data: BlendingData, order: int, names: Names) -> Components:
    """The exact Hermite blend in lowest terms."""
    rows = [p for i in range(len(data.surfaces)) for p in taylor_basis(data.values, i, order)]
    width = max(p.length() for p in rows)
    basis = fmpq_mat(len(rows), width, [c for p in rows for c in _padded(p, width)])
    expansions = [data.expansions(i, order) for i in range(len(data.surfaces))]
    x, y, z = (_component([parts[axis] for parts in expansions], basis, names) for axis in range(3))
    return x, y, z


def hermite_values(data: BlendingData, order: int) -> Values:
    """Evaluation of the Hermite blend from the given surfaces."""
    nodes = [to_float(s) for s in data.values]
    series = [
        _ExactSeries.of(surface, data.values, i, order)
        if surface.is_exact
        else _NumericSeries(surface, nodes[i], [to_float(v) for v in inverse_series(data.values, i, order)])
        for i, surface in enumerate(data.surfaces)
    ]

    def values(t: Any, h: Any) -> tuple[Any, ...]:
        if not isinstance(t, Jet) and not isinstance(h, Jet):
            t, h = as_arrays(t, h)
        with np.errstate(all="ignore"):
            steps = [h - node for node in nodes]
            total: list[Any] = [0.0, 0.0, 0.0]
            for i, part in enumerate(series):
                outer = _outer(steps, nodes, i, order)
                for axis, coefficients in enumerate(part(t)):
                    inner = _polynomial(coefficients, steps[i])
                    if inner is not None:
                        total[axis] = total[axis] + inner * outer
            return tuple(total)

    return values


@dataclass(frozen=True)
class _ExactSeries:
    """Taylor coefficients of P_i / w_i at s_i from polynomials in t (columns of `table`).

    `above[axis][j]`, `below[axis][j]` are the columns of the j-th coefficient of numerator and denominator,
    None where it is zero; `below[axis]` is empty for a constant denominator.
    """

    table: Floats
    above: tuple[tuple[int | None, ...], ...]
    below: tuple[tuple[int | None, ...], ...]

    @classmethod
    def of(cls, surface: ParametricSurface, values: tuple[fmpq, ...], number: int, order: int) -> _ExactSeries:
        inverse = inverse_series(values, number, order)
        columns: list[Floats] = []
        known: dict[str, tuple[int | None, ...]] = {}
        above, below = [], []
        for component in surface.components:
            bottom = taylor(component.denominator, values[number], order)
            scale = max(abs(c) for p in bottom for c in p.coeffs())
            top = taylor(component.numerator, values[number], order)
            mixed = [sum((top[m] * inverse[j - m] for m in range(j + 1)), fmpq_poly([0])) for j in range(order + 1)]
            key = str(component.denominator)
            if component.denominator.is_constant():
                scale, known[key] = bottom[0].leading_coefficient(), ()
            above.append(_stored(mixed, scale, columns))
            if key not in known:
                known[key] = _stored(bottom, scale, columns)
            below.append(known[key])
        size = max((len(c) for c in columns), default=1)
        table = np.zeros((size, len(columns)))
        for i, column in enumerate(columns):
            table[: len(column), i] = column
        return cls(table, tuple(above), tuple(below))

    def __call__(self, t: Any) -> Series:
        if isinstance(t, Jet):
            rows: Sequence[Any] = [horner(column, t) for column in self.table.T]
        else:
            rows = list(combinations(t, self.table))
        inverses = {columns: 1.0 / rows[_first(columns)] for columns in set(self.below) if columns}
        return [self._divided(rows, a, b, inverses) for a, b in zip(self.above, self.below, strict=True)]

    @staticmethod
    def _divided(
        rows: Sequence[Any], above: tuple[int | None, ...], below: tuple[int | None, ...], inverses: dict[Any, Any]
    ) -> list[Any]:
        result: list[Any] = [None if i is None else rows[i] for i in above]
        if not below:
            return result
        for j in range(len(result)):
            for m in range(1, j + 1):
                column, earlier = below[m], result[j - m]
                if column is not None and earlier is not None:
                    product = rows[column] * earlier
                    result[j] = -product if result[j] is None else result[j] - product
            if result[j] is not None:
                result[j] = result[j] * inverses[below]
        return result


@dataclass(frozen=True)
class _NumericSeries:
    """The same for a surface that can only be evaluated, by its derivatives in h."""

    surface: ParametricSurface
    value: float
    inverse: list[float]

    def __call__(self, t: Any) -> Series:
        order = len(self.inverse) - 1
        base = t.value if isinstance(t, Jet) else t
        parts = self.surface.values(*variables(base, self.value, (nilpotency(t), order)))
        return [self._mixed(part, t, order) for part in parts]

    def _mixed(self, part: Any, t: Any, order: int) -> list[Any]:
        if not isinstance(part, Jet):
            plain = [part * v + 0.0 * t for v in self.inverse]
            return plain
        table = part.coefficients
        rows = [along(t, list(table[:, j])) if isinstance(t, Jet) else table[0, j] for j in range(order + 1)]
        return [sum(rows[m] * self.inverse[j - m] for m in range(j + 1)) for j in range(order + 1)]


def _component(parts: Sequence[Expansion], basis: fmpq_mat, names: Names) -> RationalFunction:
    """One component: coefficients in t (columns) times the basis (rows) is a matrix of coefficients."""
    checkpoint("adding up the Hermite blend")
    below = fmpq_poly([1])
    for part in parts:
        below = below * (part.denominator / below.gcd(part.denominator))
    tops = [n * (below / part.denominator) for part in parts for n in part.numerators]
    height = max(p.length() for p in tops)
    if height == 0:
        return RationalFunction(0, names)
    product = fmpq_mat(len(tops), height, [c for p in tops for c in _padded(p, height)]).transpose() * basis
    table = [[product[a, b] for b in range(product.ncols())] for a in range(height)]
    common = below
    for column in zip(*table, strict=True):
        common = common.gcd(fmpq_poly(list(column)))
    if common.degree() > 0:
        below = below / common
        table = _columns_divided(table, common)
    terms: dict[tuple[int, ...], fmpq] = {(a, b): c for a, row in enumerate(table) for b, c in enumerate(row) if c != 0}
    return RationalFunction.from_lowest_terms(RING.from_dict(terms), univariate(below, 0), names)


def _columns_divided(table: list[list[fmpq]], divisor: fmpq_poly) -> list[list[fmpq]]:
    columns = [fmpq_poly(list(column)) / divisor for column in zip(*table, strict=True)]
    height = max(p.length() for p in columns)
    return [list(row) for row in zip(*(_padded(p, height) for p in columns), strict=True)]


def _padded(polynomial: fmpq_poly, length: int) -> list[fmpq]:
    coefficients = polynomial.coeffs()
    return [*coefficients, *[fmpq(0)] * (length - len(coefficients))]


def _stored(polynomials: Sequence[fmpq_poly], scale: fmpq, columns: list[Floats]) -> tuple[int | None, ...]:
    places: list[int | None] = []
    for p in polynomials:
        places.append(None if p.is_zero() else len(columns))
        if not p.is_zero():
            columns.append(dense([p], scale)[:, 0])
    return tuple(places)


def _first(columns: tuple[int | None, ...]) -> int:
    """The column of the constant coefficient; it is not zero where the surface is defined."""
    place = columns[0]
    if place is None:
        raise ValueError("the surface is not defined at its value")
    return place


def _outer(steps: Sequence[Any], nodes: Sequence[float], number: int, order: int) -> Any:
    product: Any = None
    for i, (step, node) in enumerate(zip(steps, nodes, strict=True)):
        if i != number:
            factor = step * (1.0 / (nodes[number] - node))
            product = factor if product is None else product * factor
    return power(product, order + 1)


def _polynomial(coefficients: Sequence[Any], step: Any) -> Any:
    """Horner's rule, skipping zeros; None for the zero polynomial."""
    result: Any = None
    for coefficient in reversed(coefficients):
        if result is not None:
            result = result * step
        if coefficient is not None:
            result = coefficient if result is None else result + coefficient
    return result
