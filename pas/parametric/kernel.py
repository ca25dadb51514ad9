"""Fast values of the part of a Hermite blend whose denominators do not depend on h.

Such components of P_i are N(t, h) / d(t), so their Taylor polynomials divided by w_i are combinations of
t^a (h - s_i)^j w_i(h) over d(t).  Those of all surfaces with the same d are added before anything is
evaluated: a matrix times the values of w_i(h) (h - s_i)^j gives the coefficients in t, then Horner's rule.
The factors w_i stay factored.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from flint import fmpq, fmpq_poly

from pas.algebra.horner import dense, horner, product
from pas.algebra.jets import Jet, power
from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float


@dataclass(frozen=True)
class Group:
    """Components (numbers `axes`) over one denominator (coefficients in t, None for 1).

    `matrix[a, c, m]` is the coefficient of t^a times function m of h in component `axes[c]`.
    """

    axes: tuple[int, ...]
    matrix: Floats
    below: Floats | None

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


@dataclass(frozen=True)
class FactoredGroup:
    """The same where each component is p(t) F(h) over `below`, as for circles.

    `matrix[d]` gives F_d, each once; `parts[c]` is d and the coefficients of p for component `axes[c]`.
    """

    axes: tuple[int, ...]
    matrix: Floats
    parts: tuple[tuple[int, Floats], ...]
    below: Floats | None

    def values(self, t: Any, functions: Floats) -> list[Any]:
        """Values of the components `axes`; `functions` are stacked (of jets, the coefficients)."""
        rows: Any = product(self.matrix, functions)
        if isinstance(t, Jet):
            rows = [Jet(row) for row in rows]
        inverse = None if self.below is None else 1.0 / horner(self.below, t)
        result = []
        for number, polynomial in self.parts:
            factor = horner(polynomial, t) if len(polynomial) > 1 else polynomial[0]
            whole = factor if inverse is None else inverse * factor
            result.append(rows[number] * whole)
        return result


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


def functions_of_h(h: Any, nodes: Sequence[float], order: int) -> Any:
    """w_i(h) (h - s_i)^j, i outer, j inner, with w_i = prod_{l != i} ((h - s_l)/(s_i - s_l))^(k+1).

    One array, these along its first axis; a list for a jet.
    """
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


def stacked(functions: Any) -> Floats:
    """The functions as one array: of jets, their coefficients."""
    return functions if isinstance(functions, np.ndarray) else np.stack([f.coefficients for f in functions])


class GroupBuilder:
    """Collects components over equal denominators."""

    def __init__(self, functions: int) -> None:
        self.functions = functions
        self.entries: dict[str, tuple[fmpq_poly, dict[tuple[int, int], list[fmpq_poly]]]] = {}

    def add(self, axis: int, below: fmpq_poly, first: int, above: Sequence[fmpq_poly]) -> None:
        """Add sum_j above[j](t) / below(t) times functions first + j to component `axis`."""
        lead = below.leading_coefficient()
        monic = below / lead
        _, columns = self.entries.setdefault(str(monic), (monic, {}))
        columns[axis, first] = [p / lead for p in above]

    def groups(self) -> tuple[Group | FactoredGroup, ...]:
        """The groups, as matrices of doubles."""
        return tuple(self._group(below, columns) for below, columns in self.entries.values())

    def _group(self, below: fmpq_poly, columns: dict[tuple[int, int], list[fmpq_poly]]) -> Group | FactoredGroup:
        scale = fmpq(1) if below.degree() == 0 else max(abs(c) for c in below.coeffs())
        bottom = None if below.degree() == 0 else dense([below], scale)[:, 0]
        axes = tuple(sorted({axis for axis, _ in columns}))
        rows: dict[tuple[int, int], dict[int, fmpq]] = {}
        for (axis, first), polynomials in columns.items():
            for j, p in enumerate(polynomials):
                for a, c in enumerate(p.coeffs()):
                    if c != 0:
                        rows.setdefault((a, axes.index(axis)), {})[first + j] = c / scale
        factored = self._factored(rows, axes, bottom)
        if factored is not None:
            return factored
        matrix = np.zeros((max((a for a, _ in rows), default=0) + 1, len(axes), self.functions))
        for (a, place), row in rows.items():
            for m, c in row.items():
                matrix[a, place, m] = to_float(c)
        return Group(axes, matrix, bottom)

    def _factored(
        self, rows: dict[tuple[int, int], dict[int, fmpq]], axes: tuple[int, ...], below: Floats | None
    ) -> FactoredGroup | None:
        """The group with rows that are multiples of one another put together, if each component then has one part."""
        known: dict[tuple[tuple[int, fmpq], ...], int] = {}
        parts: list[dict[int, dict[int, float]]] = [{} for _ in axes]
        for (a, place), row in sorted(rows.items()):
            entries = sorted(row.items())
            lead = entries[0][1]
            number = known.setdefault(tuple((m, c / lead) for m, c in entries), len(known))
            parts[place].setdefault(number, {})[a] = to_float(lead)
        if len(known) == len(rows) or any(len(part) != 1 for part in parts):
            return None
        matrix = np.zeros((len(known), self.functions))
        for entry, number in known.items():
            for m, c in entry:
                matrix[number, m] = to_float(c)
        made = tuple(
            (number, np.array([p.get(a, 0.0) for a in range(max(p) + 1)]))
            for part in parts
            for number, p in part.items()
        )
        return FactoredGroup(axes, matrix, made, below)
