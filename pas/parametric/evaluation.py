"""Evaluation of the Hermite blend in doubles, without expanding it: fast and stable.

`T = sum_i w_i(h) S_i(t, h - s_i)`, w_i = prod_{l != i} ((h - s_l)/(s_i - s_l))^(k+1) and S_i the Taylor
polynomial of degree k of P_i / w_i at s_i.  The factors w_i stay factored; the S_i come from the Taylor
polynomials of numerators and denominators, or from Taylor arithmetic for surfaces that are not exact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq, fmpq_poly

from pas.algebra.callables import Values
from pas.algebra.horner import as_arrays, combinations, dense, horner
from pas.algebra.jets import Jet, along, constant, nilpotency, variables
from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.algebra.rational_function import RationalFunction
from pas.parametric.data import BlendingData
from pas.parametric.hermite import inverse_series
from pas.parametric.kernel import FactoredGroup, Group, GroupBuilder, functions_of_h, stacked
from pas.parametric.series import taylor
from pas.parametric.surface import ParametricSurface

_Series = Callable[[Any], list[tuple[int, list[Any]]]]
"""Maps t to pairs of an axis and the coefficients j = 0..k of (h - s_i)^j, arrays or jets; None for zero."""


def hermite_values(data: BlendingData, order: int) -> Values:
    """Evaluation of the Hermite blend from the given surfaces, prepared when first asked for."""
    nodes = [to_float(s) for s in data.values]
    prepared: list[tuple[tuple[Group | FactoredGroup, ...], list[tuple[int, _Series]]]] = []

    def values(t: Any, h: Any) -> tuple[Any, ...]:
        if not prepared:
            prepared.append(_prepared(data, order))
        groups, series = prepared[0]
        if isinstance(t, Jet) or isinstance(h, Jet):
            t, h = (x if isinstance(x, Jet) else constant(x, h if x is t else t) for x in (t, h))
        else:
            t, h = as_arrays(t, h)
        total: list[Any] = [0.0, 0.0, 0.0]
        with np.errstate(all="ignore"):
            functions = functions_of_h(h, nodes, order)
            matrix = stacked(functions)
            for group in groups:
                for axis, value in zip(group.axes, group.values(t, matrix), strict=True):
                    total[axis] = value if isinstance(total[axis], float) else total[axis] + value
            for number, part in series:
                outer = functions[number * (order + 1)]
                for axis, coefficients in part(t):
                    inner = _polynomial(coefficients, h - nodes[number])
                    total[axis] = total[axis] if inner is None else total[axis] + inner * outer
        return tuple(total)

    return values


def _prepared(data: BlendingData, order: int) -> tuple[tuple[Group | FactoredGroup, ...], list[tuple[int, _Series]]]:
    """What can be added over denominators in t alone, and the rest surface by surface."""
    builder = GroupBuilder(len(data.surfaces) * (order + 1))
    series: list[tuple[int, _Series]] = []
    for i, (surface, value) in enumerate(zip(data.surfaces, data.values, strict=True)):
        inverse = inverse_series(data.values, i, order)
        if not surface.is_exact:
            series.append((i, _NumericSeries(surface, to_float(value), [to_float(v) for v in inverse])))
            continue
        left = []
        for axis, component in enumerate(surface.components):
            below = taylor(component.denominator, value, order)
            if all(p.is_zero() for p in below[1:]):
                builder.add(axis, below[0], i * (order + 1), _mixed(component, value, inverse))
            else:
                left.append(axis)
        if left:
            series.append((i, _ExactSeries.of(surface, value, inverse, tuple(left))))
    return builder.groups(), series


def _mixed(component: RationalFunction, value: fmpq, inverse: Sequence[fmpq]) -> list[fmpq_poly]:
    """Taylor coefficients of the numerator over w_i."""
    top = taylor(component.numerator, value, len(inverse) - 1)
    return [sum((top[m] * inverse[j - m] for m in range(j + 1)), fmpq_poly([0])) for j in range(len(inverse))]


@dataclass(frozen=True)
class _ExactSeries:
    """Taylor coefficients of P_i / w_i at s_i from polynomials in t (columns of `table`).

    `above[c][j]`, `below[c][j]` are the columns of the j-th coefficient of numerator and denominator of
    component `axes[c]`, None where it is zero.
    """

    axes: tuple[int, ...]
    table: Floats
    above: tuple[tuple[int | None, ...], ...]
    below: tuple[tuple[int | None, ...], ...]

    @classmethod
    def of(
        cls, surface: ParametricSurface, value: fmpq, inverse: Sequence[fmpq], axes: tuple[int, ...]
    ) -> _ExactSeries:
        """Of the components `axes` of an exact surface; `inverse` are the Taylor coefficients of 1 / w_i."""
        columns: list[Floats] = []
        known: dict[str, tuple[int | None, ...]] = {}
        above, below = [], []
        for component in (surface.components[axis] for axis in axes):
            bottom = taylor(component.denominator, value, len(inverse) - 1)
            scale = max(abs(c) for p in bottom for c in p.coeffs())
            above.append(_stored(_mixed(component, value, inverse), scale, columns))
            key = str(component.denominator)
            if key not in known:
                known[key] = _stored(bottom, scale, columns)
            below.append(known[key])
        table = np.zeros((max((len(c) for c in columns), default=1), len(columns)))
        for i, column in enumerate(columns):
            table[: len(column), i] = column
        return cls(axes, table, tuple(above), tuple(below))

    def __call__(self, t: Any) -> list[tuple[int, list[Any]]]:
        if isinstance(t, Jet):
            rows: Sequence[Any] = [horner(column, t) for column in self.table.T]
        else:
            rows = list(combinations(t, self.table))
        inverses = {columns: 1.0 / rows[_first(columns)] for columns in set(self.below)}
        parts = zip(self.axes, self.above, self.below, strict=True)
        return [(axis, self._divided(rows, a, b, inverses)) for axis, a, b in parts]

    @staticmethod
    def _divided(
        rows: Sequence[Any], above: tuple[int | None, ...], below: tuple[int | None, ...], inverses: dict[Any, Any]
    ) -> list[Any]:
        result: list[Any] = [None if i is None else rows[i] for i in above]
        for j in range(len(result)):
            for m in range(1, j + 1):
                column, earlier = below[m], result[j - m]
                if column is not None and earlier is not None:
                    step = rows[column] * earlier
                    result[j] = -step if result[j] is None else result[j] - step
            if result[j] is not None:
                result[j] = result[j] * inverses[below]
        return result


@dataclass(frozen=True)
class _NumericSeries:
    """The same for a surface that can only be evaluated, by its derivatives in h."""

    surface: ParametricSurface
    value: float
    inverse: list[float]

    def __call__(self, t: Any) -> list[tuple[int, list[Any]]]:
        order = len(self.inverse) - 1
        base = t.value if isinstance(t, Jet) else t
        parts = self.surface.values(*variables(base, self.value, (nilpotency(t), order)))
        return [(axis, self._mixed(part, t, order)) for axis, part in enumerate(parts)]

    def _mixed(self, part: Any, t: Any, order: int) -> list[Any]:
        if not isinstance(part, Jet):
            return [part * v + 0.0 * t for v in self.inverse]
        table = part.coefficients
        rows = [along(t, list(table[:, j])) if isinstance(t, Jet) else table[0, j] for j in range(order + 1)]
        return [sum(rows[m] * self.inverse[j - m] for m in range(j + 1)) for j in range(order + 1)]


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


def _polynomial(coefficients: Sequence[Any], step: Any) -> Any:
    """Horner's rule, skipping zeros; None for the zero polynomial."""
    result: Any = None
    for coefficient in reversed(coefficients):
        if result is not None:
            result = result * step
        if coefficient is not None:
            result = coefficient if result is None else result + coefficient
    return result
