"""Curves and vectors along them as the user writes them: three expressions in s, or one callable."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.callables import ComponentLike, component
from pas.algebra.expressions import Names
from pas.algebra.inputs import shown
from pas.algebra.monomials import Floats
from pas.algebra.rational import Exact
from pas.algebra.rational_function import RationalFunction
from pas.generatrix.exact import on_unit_interval
from pas.parametric.surface import ParametricSurface

NAMES: Names = ("s", "t")

CurveLike: TypeAlias = "ParametricSurface | Sequence[ComponentLike] | Callable[[Floats], ArrayLike]"
"""What is taken for vectors along a curve: three expressions in s, or a callable from (n,) to (n, 3)."""


def space_curve(expression: CurveLike, name: str) -> ParametricSurface:
    """A curve given by three expressions in s or one callable, as a surface that does not depend on t."""
    if isinstance(expression, ParametricSurface):
        return expression
    if callable(expression):
        return ParametricSurface(
            _coordinate(expression, 0), _coordinate(expression, 1), _coordinate(expression, 2), NAMES
        )
    if isinstance(expression, str) or not hasattr(expression, "__len__") or len(expression) != 3:
        raise TypeError(f"{name} must be three expressions in s or one callable, not {shown(expression)}")
    parts = []
    for entry, axis in zip(expression, "xyz", strict=True):
        made = component(entry if not callable(entry) else _of_one(entry), ("s", ""), f"{axis} of {name}")
        parts.append(made.formula if made.exact is None else RationalFunction(made.exact, NAMES))
    return ParametricSurface(parts[0], parts[1], parts[2], NAMES)


def read_path(curve: CurveLike, interval: Sequence[Exact], name: str) -> ParametricSurface:
    """A curve as a surface in (s, t), t without influence, over 0 <= s <= 1."""
    (low, high), line = on_unit_interval(interval, name)
    path = space_curve(curve, name)
    if path.is_exact:
        x, y, z = (c.substitute(line, line) for c in path.components)
        return ParametricSurface(x, y, z, NAMES)
    return ParametricSurface.from_parts(
        lambda s, t: path.values(low + (high - low) * s, t), None, NAMES, None, path.inexact
    )


def value_at(path: ParametricSurface, s: Floats, order: int = 0) -> Floats:
    """Points, or derivatives in s of an order, (n, 3) at s (n,)."""
    return path.derivative(np.stack([s, np.zeros_like(s)], axis=-1), order, 0)


def _of_one(function: Any) -> Any:
    return (
        function if hasattr(function, "free_symbols") or isinstance(function, RationalFunction) else _ignoring(function)
    )


def _ignoring(function: Callable[[Any], Any]) -> Callable[[Any, Any], Any]:
    return lambda s, _: function(s)


def _coordinate(function: Any, axis: int) -> Callable[[Any, Any], Any]:
    return lambda s, _: np.asarray(function(s), dtype=float)[..., axis]
