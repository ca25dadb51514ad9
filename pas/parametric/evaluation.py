"""Evaluation of the Hermite blend in doubles, without expanding it: fast and stable.

`T = sum_i w_i(h) S_i(t, h - s_i)`, w_i = prod_{l != i} ((h - s_l)/(s_i - s_l))^(k+1) and S_i the Taylor polynomial of
degree k of P_i / w_i at s_i.  The factors w_i stay factored.  Where the denominators of a surface do not depend on h,
S_i is a combination of t^a (h - s_i)^j over them, and those of all surfaces with one denominator are added before
anything is evaluated (`Group`); the coefficients of other surfaces come from Taylor arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from math import prod
from typing import Any

import numpy as np
from flint import fmpq, fmpq_poly

from pas.algebra.horner import as_arrays, dense, horner, product
from pas.algebra.jets import Jet, along, constant, nilpotency, power, variables
from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.algebra.rational_function import RationalFunction
from pas.parametric.data import BlendingData
from pas.parametric.hermite import inverse_series
from pas.parametric.series import in_one, taylor
from pas.parametric.surface import ParametricSurface


@dataclass(frozen=True, eq=False)
class HermiteValues:
    """The coordinates of the Hermite blend at two arrays or jets, prepared when first asked for."""

    data: BlendingData
    order: int

    def __call__(self, t: Any, h: Any) -> tuple[Any, ...]:
        groups, series = self._parts
        if isinstance(t, Jet) or isinstance(h, Jet):
            like = t if isinstance(t, Jet) else h
            t, h = (x if isinstance(x, Jet) else constant(x, like) for x in (t, h))
        else:
            t, h = as_arrays(t, h)
        nodes = [to_float(s) for s in self.data.values]
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
        data, order = self.data, self.order
        columns: dict[str, tuple[fmpq_poly, dict[tuple[int, int], list[fmpq_poly]]]] = {}
        series: list[tuple[int, _NumericSeries]] = []
        for i, (surface, value) in enumerate(zip(data.surfaces, data.values, strict=True)):
            inverse = inverse_series(data.values, i, order)
            if not surface.is_exact or any(c.denominator.degrees()[1] for c in surface.components):
                series.append((i, _NumericSeries(surface, to_float(value), [to_float(v) for v in inverse])))
                continue
            for axis, component in enumerate(surface.components):
                below, lead = in_one(component.denominator, 0), component.denominator.leading_coefficient()
                _, found = columns.setdefault(str(below / lead), (below / lead, {}))
                found[axis, i * (order + 1)] = [p / lead for p in _mixed(component, value, inverse)]
        number = len(data.surfaces) * (order + 1)
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
    ahead, behind = [steps[0]], [steps[-1]]
    for step, back in zip(steps[1:-1], steps[-2:0:-1], strict=True):
        ahead.append(ahead[-1] * step)
        behind.append(behind[-1] * back)
    result: Any = [None] * (len(nodes) * (order + 1))
    if not isinstance(h, Jet):
        result = np.empty((len(result), *h.shape))
    for i, (node, step) in enumerate(zip(nodes, steps, strict=True)):
        others = behind[-1] if i == 0 else ahead[-1] if i == len(nodes) - 1 else ahead[i - 1] * behind[-1 - i]
        first = i * (order + 1)
        result[first] = power(others * (1.0 / prod(node - other for j, other in enumerate(nodes) if j != i)), order + 1)
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
