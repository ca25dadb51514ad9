"""Maps of two parameters into space: exact rational ones, and any that can be evaluated.

The parameters are t and h unless named otherwise.  Rational expressions over Q are held exactly (lowest terms); others
(sines, callables) are only evaluated.  Derivatives of any order are carried along by Taylor arithmetic
(`pas.algebra.jets`), so an exact map and a callable share one road.

Guaranteed: exact components, derivatives and residuals are exact.  Not guaranteed: that the map is injective or
regular; `regularity` decides the latter for exact ones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cache, cached_property
from typing import Any, Self, TypeAlias

import numpy as np
from flint import fmpq
from numpy.typing import ArrayLike

from pas.algebra.brief import cut
from pas.algebra.callables import ComponentLike, Derivatives, Values, component, from_derivatives, texts_of
from pas.algebra.evaluation import Bundle
from pas.algebra.expressions import Names
from pas.algebra.inputs import check_count, check_derivative, shown
from pas.algebra.jets import Jet, variables
from pas.algebra.lengths import scaled, unit
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, Vector, VectorLike, plain, rational, to_float, to_floats, to_fraction, vector
from pas.algebra.rational_function import PARAMETERS, RationalFunction, total
from pas.arrays import AnyArray, Floats
from pas.limits import checkpoint
from pas.parametric.series import Components, composed

Interval = tuple[float, float]
Domain = tuple[Interval, Interval]
Ends = tuple[Fraction | None, Fraction | None]
"""Exact ends; None at infinity."""

IntervalLike: TypeAlias = Sequence[Exact | None] | None
DomainLike: TypeAlias = Sequence[IntervalLike] | None
"""What is taken for an interval and for two of them; None stands for an end at infinity, and for both."""

ExactDomain = tuple[Ends, Ends]

Text = Sequence[str]
"""Three components as expressions."""

CHUNK = 1 << 14
"""Points evaluated at once: some dozen intermediate arrays of this length fit into the caches."""


@dataclass(frozen=True, eq=False, init=False)
class ParametricMap:
    """A map (x, y, z)(t, h).

    Each of `x`, `y`, `z` is a string (`"2*t/(1 + t^2)"`, `"h*sin(t)"`), a sympy expression, a number, or a callable of
    two numpy arrays.  It is exact where all three are rational functions with rational coefficients.  `domain` is a
    pair of closed intervals, `((0, 1), (None, 2))`, None for an end at infinity; without it the domain is the whole
    plane.  It is kept in doubles, and `ends` has the exact numbers, None for infinite ones.

    Derivatives of callables are automatic: by Taylor arithmetic through numpy's elementary functions, else by central
    differences (relative error about 1e-10 for the first, 1e-7 for the second).  Or give them: `derivatives` maps
    orders (i, j) to a callable that returns the three components of d^(i+j) P / dt^i dh^j; then no others are made up.

    Raises `ValueError` for unknown variables, unreadable expressions or an empty domain.
    """

    parameters: Names
    domain: Domain
    ends: ExactDomain
    values: Values
    source: Callable[[], Components] | None
    inexact: str
    text: Text | None

    def __init__(
        self,
        x: ComponentLike,
        y: ComponentLike,
        z: ComponentLike,
        parameters: Names = PARAMETERS,
        domain: DomainLike = None,
        derivatives: Derivatives | None = None,
    ) -> None:
        names = _names(parameters)
        parts = [component(e, names, f"component {axis}") for e, axis in zip((x, y, z), "xyz", strict=True)]
        exact = [p.exact for p in parts if p.exact is not None]
        if len(exact) == 3:
            whole: Components = (exact[0], exact[1], exact[2])
            bundle = cache(lambda: Bundle.of_pairs([(c.numerator, c.denominator) for c in whole]))
            self._fill(names, domain, lambda t, h: bundle().quotients(t, h), lambda: whole, "", None)
            return
        formulas = [p.formula for p in parts]
        values: Values = lambda t, h: (formulas[0](t, h), formulas[1](t, h), formulas[2](t, h))  # noqa: E731
        if derivatives is not None:
            values = from_derivatives(values, derivatives)
        text = None if derivatives is not None else texts_of((x, y, z), names)
        self._fill(names, domain, values, None, next(p.reason for p in parts if p.exact is None), text)

    @classmethod
    def from_parts(
        cls,
        values: Values,
        source: Callable[[], Components] | None,
        parameters: Names = PARAMETERS,
        domain: DomainLike = None,
        inexact: str = "",
        text: Text | None = None,
    ) -> Self:
        """A map with its own way of evaluation; `source` makes its exact components when asked, `text` are expressions
        that come to the same, where there are any: they can be saved."""
        result = cls.__new__(cls)
        result._fill(_names(parameters), domain, values, source, inexact, text)
        return result

    def _fill(self, parameters: Names, domain: DomainLike, *others: Any) -> None:
        """Set the fields, `others` being the last four."""
        for field, value in zip(fields(self), (parameters, *read_domain(domain, parameters), *others), strict=True):
            object.__setattr__(self, field.name, value)

    @property
    def is_exact(self) -> bool:
        """Whether the components are known as rational functions over Q."""
        return self.source is not None

    @cached_property
    def components(self) -> Components:
        """The three exact components; raises `ValueError` for a surface that is not exact."""
        if self.source is None:
            raise ValueError(f"this needs an exact surface (rational functions over Q); {self.inexact}")
        return self.source()

    @property
    def x(self) -> RationalFunction:
        """The exact first component."""
        return self.components[0]

    @property
    def y(self) -> RationalFunction:
        """The exact second component."""
        return self.components[1]

    @property
    def z(self) -> RationalFunction:
        """The exact third component."""
        return self.components[2]

    @property
    def degree(self) -> int:
        """The greatest total degree of a numerator or denominator."""
        return max(c.degree for c in self.components)

    @property
    def degrees(self) -> tuple[int, int]:
        """The greatest degrees of numerators and denominators in each parameter."""
        return max(c.degrees[0] for c in self.components), max(c.degrees[1] for c in self.components)

    @property
    def is_polynomial(self) -> bool:
        """Whether the components are polynomials."""
        return all(c.is_polynomial for c in self.components)

    def __call__(self, points: ArrayLike) -> Floats:
        """Points of the surface at parameters `points` (..., 2): shape (..., 3).

        Infinite or nan at poles.  Raises `ValueError` outside the domain.
        """
        return self._chunked(points, self.values, ())

    def on_grid(self, t: ArrayLike, h: ArrayLike) -> Floats:
        """Points at all pairs from two sequences of parameters: shape (len(t), len(h), 3).

        Faster than points one by one, since what depends on one parameter is done once.
        """
        first, second = (np.atleast_1d(np.asarray(v, dtype=float)) for v in (t, h))
        self._check(first, second)
        result = np.empty((len(first), len(second), 3))
        step = max(1, CHUNK // max(len(second), 1))
        with np.errstate(all="ignore"):
            for start in range(0, len(first), step):
                checkpoint("evaluating a surface on a grid", start / len(first))
                rows = slice(start, start + step)
                for axis, part in enumerate(self.values(first[rows, None], second[None, :])):
                    result[rows, :, axis] = part
        return result

    def derivative(self, points: ArrayLike, first: int = 0, second: int = 0) -> Floats:
        """Partial derivatives of orders `first` in t, `second` in h at `points` (..., 2): (..., 3)."""
        orders = check_derivative(first, "first"), check_derivative(second, "second")
        return self.partials(points, orders)[..., 0, :] if sum(orders) else self(points)

    def tangents(self, points: ArrayLike) -> Floats:
        """Both tangent vectors, dP/dt and dP/dh, at `points` (..., 2): shape (..., 2, 3)."""
        return self.partials(points, (1, 0), (0, 1))

    def partials(self, points: ArrayLike, *orders: tuple[int, int]) -> Floats:
        """Partial derivatives of k orders at `points` (..., 2), from one expansion: (..., k, 3)."""
        highest = max(i for i, _ in orders), max(j for _, j in orders)

        def at(t: Floats, h: Floats) -> tuple[Any, ...]:
            result = np.zeros((3, len(orders), *t.shape))
            for rows, part in zip(result, self.values(*variables(t, h, highest)), strict=True):
                for row, order in zip(rows, orders, strict=True):
                    row[:] = part.derivative(*order) if isinstance(part, Jet) else 0.0 if any(order) else part
            return tuple(result)

        return np.moveaxis(self._chunked(points, at, (len(orders),)), 0, -2)

    def normals(self, points: ArrayLike) -> Floats:
        """Unit normals, along dP/dt x dP/dh, at `points` (..., 2): (..., 3); nan where that is zero."""
        tangents = scaled(self.tangents(points))
        with np.errstate(all="ignore"):
            return unit(np.cross(tangents[..., 0, :], tangents[..., 1, :]))

    def at(self, t: Exact, h: Exact) -> tuple[Fraction, Fraction, Fraction]:
        """The exact point at rational parameters; raises `ValueError` at a pole."""
        x, y, z = (c.at(t, h) for c in self.components)
        return x, y, z

    def diff(self, first: int = 0, second: int = 0) -> Self:
        """The exact partial derivative as a surface of its own."""
        orders = check_derivative(first, "first"), check_derivative(second, "second")
        x, y, z = (c.diff(*orders) for c in self.components)
        return type(self)(x, y, z, self.parameters, self.ends)

    def implicit_residual(self, polynomial: PolynomialLike) -> RationalFunction:
        """f(x(t, h), y(t, h), z(t, h)), exactly: the zero function iff the surface lies on f = 0."""
        return composed(Polynomial(polynomial), self.components)

    def moved(self, matrix: Sequence[Sequence[Exact]] | AnyArray | None = None, offset: VectorLike = (0, 0, 0)) -> Self:
        """The image under p -> matrix p + offset; rational numbers keep an exact surface exact."""
        rows = [vector(r, f"matrix[{i}]") for i, r in enumerate(np.eye(3, dtype=int) if matrix is None else matrix)]
        if len(rows) != 3:
            raise ValueError(f"matrix must have 3 rows, not {len(rows)}")
        shift = vector(offset, "offset")
        table, start = np.array([to_floats(row) for row in rows]), to_floats(shift)

        def values(t: Any, h: Any) -> tuple[Any, ...]:
            p = self.values(t, h)
            return tuple(r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + s for r, s in zip(table, start, strict=True))

        def source() -> Components:
            x, y, z = (total([c * a for c, a in zip(self.components, row, strict=True)]) for row in rows)
            return x + shift[0], y + shift[1], z + shift[2]

        made = source if self.is_exact else None
        text = None if self.text is None else _moved_text(self.text, rows, shift)
        return self.from_parts(values, made, self.parameters, self.ends, self.inexact, text)

    def with_domain(self, domain: DomainLike) -> Self:
        """This surface on another domain."""
        return self.from_parts(self.values, self.source, self.parameters, domain, self.inexact, self.text)

    def contains(self, value: fmpq, axis: int) -> bool:
        """Whether a value of parameter number `axis` lies in the domain, as doubles go."""
        low, high = self.domain[axis]
        return low <= to_float(value) <= high

    def __str__(self) -> str:
        if not self.is_exact:
            return f"a parametric surface that is not exact; {self.inexact}"
        return "({}, {}, {})".format(*self.components)

    def __repr__(self) -> str:
        return cut(f"{type(self).__name__}{self}" if self.is_exact else f"<{self}>")

    def _chunked(self, points: ArrayLike, work: Values, extra: tuple[int, ...]) -> Floats:
        """Results of `work`, three arrays of shape (*extra, n) for n points, gathered: (*extra, ..., 3)."""
        array = np.asarray(points, dtype=float)
        if array.ndim == 0 or array.shape[-1] != 2:
            raise ValueError(f"points must have shape (..., 2), parameters t and h, not {array.shape}")
        flat = array.reshape(-1, 2)
        result = np.empty((3, *extra, len(flat)))
        with np.errstate(all="ignore"):
            for start in range(0, len(flat), CHUNK):
                checkpoint("evaluating a surface", start / len(flat))
                block = np.ascontiguousarray(flat[start : start + CHUNK].T)
                self._check(block[0], block[1])
                for axis, part in enumerate(work(block[0], block[1])):
                    result[axis, ..., start : start + CHUNK] = part
        return np.moveaxis(result.reshape(3, *extra, *array.shape[:-1]), 0, -1)

    def _check(self, t: Floats, h: Floats) -> None:
        for name, values, (low, high) in zip(self.parameters, (t, h), self.domain, strict=True):
            if values.size == 0 or (values.min() >= low and values.max() <= high):
                continue
            bad = values[~((values >= low) & (values <= high))][0]
            raise ValueError(f"parameter {name} = {bad:.6g} lies outside the domain [{low:.6g}, {high:.6g}]")


def _names(parameters: Any) -> Names:
    names = tuple(parameters)
    if len(names) != 2 or names[0] == names[1] or not all(isinstance(n, str) and n.isidentifier() for n in names):
        raise ValueError(f"parameters must be two different names such as ('t', 'h'), not {shown(parameters)}")
    return names[0], names[1]


def _moved_text(text: Text, rows: Sequence[Vector], shift: Vector) -> Text:
    """The expressions after p -> rows p + shift."""
    parts = ([f"({plain(c)})*({e})" for c, e in zip(row, text, strict=True)] for row in rows)
    return [" + ".join([*part, f"({plain(s)})"]) for part, s in zip(parts, shift, strict=True)]


def read_domain(domain: DomainLike, names: Names) -> tuple[Domain, ExactDomain]:
    """Two intervals as the user writes them, in doubles and exact, as proofs take them.

    Raises `ValueError` for anything else, empty intervals and ends that doubles do not hold or tell apart.
    """
    domain = (None, None) if domain is None else domain
    check_count(domain, 2, "domain must be two intervals such as ((0, 1), (None, 2))", ValueError)
    first, second = (_interval(i, name) for i, name in zip(domain, names, strict=True))
    return (first[0], second[0]), (first[1], second[1])


def _interval(given: IntervalLike, name: str) -> tuple[Interval, Ends]:
    interval = (None, None) if given is None else given
    check_count(interval, 2, f"the domain of {name} must be an interval such as (0, 1)", ValueError)
    infinite = [end is None or (isinstance(end, float) and math.isinf(end)) for end in interval]
    what = f"an end of the domain of {name}"
    ends = [None if no else rational(end, what) for end, no in zip(interval, infinite, strict=True)]
    low = -math.inf if ends[0] is None else to_float(ends[0])
    high = math.inf if ends[1] is None else to_float(ends[1])
    if any(not no and math.isinf(end) for end, no in zip((low, high), infinite, strict=True)):
        raise ValueError(f"{what} is beyond the range of doubles (1.8e308): {shown(interval)}")
    if not low < high:
        raise ValueError(f"the domain of {name} must be an interval (low, high) with low < high, not {shown(interval)}")
    first, last = (None if e is None else to_fraction(e) for e in ends)
    return (low, high), (first, last)
