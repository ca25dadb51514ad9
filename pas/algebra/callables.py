"""Components of surfaces, as the user wrote them: exact where they can be, else functions of arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import comb
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.expressions import Formula, Names, NotRationalError, as_text, read_formula
from pas.algebra.jets import Jet, composed, variables
from pas.algebra.rational_function import FunctionLike, RationalFunction
from pas.arrays import Floats

Values = Callable[[Any, Any], tuple[Any, ...]]
"""Three coordinates at two arrays (or jets) of parameters that broadcast."""

ComponentLike: TypeAlias = "FunctionLike | Callable[..., ArrayLike]"
"""What is taken for one coordinate: an expression, or a callable of arrays."""

Derivatives: TypeAlias = Mapping[tuple[int, int], Callable[[Floats, Floats], Sequence[ArrayLike]]]
"""Three coordinates of d^(i+j) P / dt^i dh^j at two arrays of parameters, by (i, j)."""

PROBE = (np.array([0.3125, 0.4375]), np.array([0.28125, 0.40625]))
"""Parameters at which a callable is tried for whether it takes arrays and Taylor series."""


@dataclass(frozen=True)
class Component:
    """One coordinate: `exact` where it is a rational function over Q, else `reason` says why not."""

    exact: RationalFunction | None
    formula: Formula
    reason: str = ""


def component(expression: Any, names: Names, name: str) -> Component:
    """Read one coordinate; errors name it."""
    if is_function(expression):
        return Component(None, _differentiable(expression, name), f"{name} is a callable")
    try:
        exact = RationalFunction(expression, names)
        return Component(exact, exact)
    except NotRationalError as error:
        return Component(None, read_formula(expression, names), f"{name}: {error}")
    except (ValueError, TypeError) as error:
        raise type(error)(f"{name}: {error}") from None


def from_derivatives(values: Values, given: Derivatives) -> Values:
    """Evaluation on Taylor series by the derivatives that the user gave, and by no others."""

    def derivative(t: Floats, h: Floats, first: int, second: int) -> Floats:
        if (first, second) != (0, 0) and (first, second) not in given:
            raise ValueError(
                f"the derivative of orders ({first}, {second}) is not among those given; "
                "add it, or give none to have all worked out"
            )
        parts = values(t, h) if (first, second) == (0, 0) else given[first, second](t, h)
        return np.stack(np.broadcast_arrays(*parts), axis=-1).astype(float)

    return on_series(derivative)


def on_series(derivative: Callable[[Floats, Floats, int, int], Floats], size: int = 3) -> Values:
    """Evaluation of `size` coordinates at arrays or Taylor series from their partial derivatives.

    `derivative(t, h, i, j)` has them as (..., size) at arrays; each order is asked for once.
    """

    def values(t: Any, h: Any) -> tuple[Any, ...]:
        known = cache(lambda first, second: derivative(plain(t), plain(h), first, second))
        return tuple(composed(lambda i, j, axis=axis: known(i, j)[..., axis], t, h) for axis in range(size))  # type: ignore[misc]

    return values


def plain(x: Any) -> Any:
    """The value of a jet, anything else as it is."""
    return x.value if isinstance(x, Jet) else x


def is_function(expression: Any) -> bool:
    """Whether an expression is a callable, and none that is exact."""
    exact = isinstance(expression, RationalFunction) or hasattr(expression, "free_symbols")
    return callable(expression) and not exact


def texts_of(expressions: Any, names: Names) -> list[str] | None:
    """Expressions in parameters of these names as strings; None where there are none, and where one is a callable."""
    if expressions is None or callable(expressions) or any(map(is_function, expressions)):
        return None
    return [as_text(e) or str(RationalFunction(e, names)) for e in expressions]


def _differentiable(function: Formula, name: str) -> Formula:
    """The callable itself if it takes Taylor series, else with differences in place of derivatives."""
    try:
        with np.errstate(all="ignore"):
            result = function(*PROBE)
            np.broadcast_to(np.asarray(result, dtype=float), PROBE[0].shape)
    except (TypeError, AttributeError, ValueError) as error:
        raise TypeError(f"{name}: the callable must take two numpy arrays and return one ({error})") from None
    try:
        with np.errstate(all="ignore"):
            series = function(*variables(*PROBE, (1, 1)))
    except (TypeError, AttributeError, ValueError):
        series = None
    if isinstance(series, Jet) or (np.ndim(result) == 0 and series is not None):
        return function
    return lambda t, h: composed(lambda i, j: _difference(function, plain(t), plain(h), i, j), t, h)


def _difference(function: Formula, t: Any, h: Any, first: int, second: int) -> Floats:
    """The central difference quotient of these orders; steps balance truncation and rounding."""
    roundoff = 2.0**-52
    root = roundoff ** (1 / (first + second + 2))
    steps = [root * np.maximum(1.0, np.abs(np.asarray(x, dtype=float))) for x in (t, h)]
    total = np.zeros(np.broadcast_shapes(np.shape(t), np.shape(h)))
    for i in range(first + 1):
        for j in range(second + 1):
            weight = (-1) ** (i + j) * comb(first, i) * comb(second, j)
            total = total + weight * function(t + (first / 2 - i) * steps[0], h + (second / 2 - j) * steps[1])
    return total / (steps[0] ** first * steps[1] ** second)
