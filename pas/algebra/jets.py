"""Truncated Taylor series in two variables on arrays: derivatives of any order without formulas.

A `Jet` of orders (A, B) holds the coefficients of d^a e^b, a <= A, b <= B, of a function of (t + d,
h + e), each an array; multiplied by a! b! they are the partial derivatives (Griewank and Walther
2008, chapter 13).  It takes part in arithmetic and in numpy's elementary functions, so a callable
written for arrays yields its own derivatives when it is called on the jets of its parameters.

Guaranteed: the derivatives are those of the operations carried out, up to rounding; nothing is
divided by a step.  Not guaranteed: anything where a function is not smooth (at the kink of abs),
nor functions outside the table below: those raise `TypeError`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import factorial
from typing import Any

import numpy as np

from pas.arrays import Floats


class Jet:
    """A Taylor polynomial: `coefficients` has shape (A+1, B+1, ...)."""

    __slots__ = ("coefficients",)

    def __init__(self, coefficients: Floats) -> None:
        self.coefficients = coefficients

    @property
    def orders(self) -> tuple[int, int]:
        """The highest powers kept, (A, B)."""
        return self.coefficients.shape[0] - 1, self.coefficients.shape[1] - 1

    @property
    def value(self) -> Floats:
        """The constant coefficient."""
        return self.coefficients[0, 0]

    def derivative(self, first: int, second: int) -> Floats:
        """The partial derivative of these orders."""
        return self.coefficients[first, second] * float(factorial(first) * factorial(second))

    def __add__(self, other: Any) -> Jet:
        added = other if isinstance(other, Jet) else constant(other, self)
        left, right = _aligned(self.coefficients, added.coefficients)
        return Jet(left + right)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.coefficients)

    def __sub__(self, other: Any) -> Jet:
        return self + (-other)

    def __rsub__(self, other: Any) -> Jet:
        return (-self) + other

    def __mul__(self, other: Any) -> Jet:
        if isinstance(other, Jet):
            return Jet(_product(self.coefficients, other.coefficients))
        factor = _array(other)
        left, right = _aligned(self.coefficients, factor[None, None])
        return Jet(left * right)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        if isinstance(other, Jet):
            return Jet(_quotient(self.coefficients, other.coefficients))
        return self * (1.0 / _array(other))

    def __rtruediv__(self, other: Any) -> Jet:
        return constant(other, self) / self

    def __pow__(self, exponent: Any) -> Jet:
        if isinstance(exponent, Jet):
            return np.exp(np.log(self) * exponent)  # type: ignore[return-value]  # by RULES
        number = float(exponent)
        if number == int(number):
            result: Jet = power(self, abs(int(number)))
            return result if number >= 0 else 1.0 / result
        return _binomial(self, number)

    def __rpow__(self, base: Any) -> Jet:
        return np.exp(self * np.log(_array(base)))  # type: ignore[return-value]  # by RULES

    def __pos__(self) -> Jet:
        return self

    def __array__(self, *_: Any, **__: Any) -> Floats:
        raise TypeError("a Taylor series is no array of numbers")

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        rule = RULES.get(ufunc)
        if rule is None or method != "__call__" or options:
            return NotImplemented
        return rule(*inputs)


def variables(t: Any, h: Any, orders: tuple[int, int]) -> tuple[Jet, Jet]:
    """The jets of two parameters at `t`, `h` (arrays that broadcast), to be kept to `orders`."""
    first, second = (np.asarray(v, dtype=float) for v in (t, h))
    one = np.zeros((orders[0] + 1, orders[1] + 1, *first.shape))
    two = np.zeros((orders[0] + 1, orders[1] + 1, *second.shape))
    one[0, 0], two[0, 0] = first, second
    one[1:2, 0], two[0, 1:2] = 1.0, 1.0
    return Jet(one), Jet(two)


def along(x: Jet, taylor: Sequence[Any]) -> Jet:
    """sum_m taylor[m] (x - value)^m."""
    rest = x.coefficients.copy()
    rest[0, 0] = 0.0
    step, result = Jet(rest), constant(taylor[-1], x)
    for coefficient in reversed(taylor[:-1]):
        result = result * step + coefficient
    return result


def power(x: Any, exponent: int) -> Any:
    """A whole power >= 0 of an array or a jet by repeated squaring (numpy's own takes a logarithm)."""
    result: Any = None
    while exponent:
        if exponent & 1:
            result = x if result is None else result * x
        exponent >>= 1
        if exponent:
            x = x * x
    return x * 0.0 + 1.0 if result is None else result


def constant(value: Any, like: Jet) -> Jet:
    """A jet of the same orders without dependence on the parameters."""
    array = _array(value)
    coefficients = np.zeros((*like.coefficients.shape[:2], *array.shape))
    coefficients[0, 0] = array
    return Jet(coefficients)


def composed(derivative: Callable[[int, int], Floats], t: Any, h: Any) -> Any:
    """f(t, h) for jets (or arrays) t, h from partial derivatives of f at their values.

    `derivative(a, b)` is asked only for the orders that the jets need.
    """
    if not isinstance(t, Jet) and not isinstance(h, Jet):
        return derivative(0, 0)
    like = t if isinstance(t, Jet) else h
    first = [constant(1.0, like), *_powers(t, sum(like.orders))]
    second = [constant(1.0, like), *_powers(h, sum(like.orders))]
    total = constant(0.0, like)
    for a, left in enumerate(first):
        for b, right in enumerate(second):
            step = left * right
            if (a, b) == (0, 0) or step.coefficients.any():
                total = total + step * (derivative(a, b) / float(factorial(a) * factorial(b)))
    return total


def nilpotency(x: Any) -> int:
    """The highest power of the part without a constant that is not zero (0 for an array)."""
    return len(_powers(x, sum(x.orders))) if isinstance(x, Jet) else 0


def _powers(x: Any, highest: int) -> list[Jet]:
    """The powers of the part of x without a constant that are not zero, from the first on."""
    if not isinstance(x, Jet):
        return []
    rest = x.coefficients.copy()
    rest[0, 0] = 0.0
    powers: list[Jet] = []
    step = Jet(rest)
    while step.coefficients.any() and len(powers) < highest:
        powers.append(step)
        step = step * Jet(rest)
    return powers


def _array(value: Any) -> Floats:
    if isinstance(value, Jet):
        raise TypeError("a Taylor series where a number is needed")
    return np.asarray(value, dtype=float)


def _aligned(left: Floats, right: Floats) -> tuple[Floats, Floats]:
    """Views with equally many axes after the first two, so that these broadcast together."""
    size = max(left.ndim, right.ndim)
    return _widened(left, size), _widened(right, size)


def _widened(array: Floats, size: int) -> Floats:
    return array.reshape(array.shape[:2] + (1,) * (size - array.ndim) + array.shape[2:])


def _product(left: Floats, right: Floats) -> Floats:
    left, right = _aligned(left, right)
    rows, columns = left.shape[:2]
    result = np.zeros((rows, columns, *np.broadcast_shapes(left.shape[2:], right.shape[2:])))
    for i in range(rows):
        for j in range(columns):
            if left[i, j].any():
                result[i:, j:] += left[i, j] * right[: rows - i, : columns - j]
    return result


def _quotient(left: Floats, right: Floats) -> Floats:
    left, right = _aligned(left, right)
    rows, columns = left.shape[:2]
    result = np.zeros((rows, columns, *np.broadcast_shapes(left.shape[2:], right.shape[2:])))
    result[:] = left
    for i in range(rows):
        for j in range(columns):
            result[i, j] /= right[0, 0]
            for p in range(rows - i):
                for q in range(columns - j):
                    if p or q:
                        result[i + p, j + q] -= right[p, q] * result[i, j]
    return result


def _binomial(x: Jet, exponent: float) -> Jet:
    taylor, factor = [], 1.0
    for m in range(sum(x.orders) + 1):
        taylor.append(factor * x.value ** (exponent - m))
        factor *= (exponent - m) / (m + 1)
    return along(x, taylor)


def _cyclic(functions: tuple[Callable[[Any], Any], ...], x: Jet) -> Jet:
    """A function whose m-th derivative is `functions[m mod len]`."""
    values = [f(x.value) for f in functions]
    return along(x, [values[m % len(values)] / factorial(m) for m in range(sum(x.orders) + 1)])


def _integrated(function: Callable[[Any], Any], slope: Callable[[Jet], Jet], x: Jet) -> Jet:
    """A function known by its value and, as a formula, by its derivative."""
    highest = sum(x.orders)
    line, _ = variables(x.value, 0.0, (highest, 0))
    series = slope(line).coefficients[:, 0]
    return along(x, [function(x.value), *(series[m] / (m + 1) for m in range(highest))])


RULES: dict[np.ufunc, Callable[..., Any]] = {
    np.add: lambda a, b: b + a if isinstance(b, Jet) else a + b,
    np.subtract: lambda a, b: a - b if isinstance(a, Jet) else b.__rsub__(a),
    np.multiply: lambda a, b: b * a if isinstance(b, Jet) else a * b,
    np.true_divide: lambda a, b: a / b if isinstance(a, Jet) else b.__rtruediv__(a),
    np.power: lambda a, b: a**b if isinstance(a, Jet) else b.__rpow__(a),
    np.float_power: lambda a, b: a**b if isinstance(a, Jet) else b.__rpow__(a),
    np.negative: lambda a: -a,
    np.positive: lambda a: a,
    np.square: lambda a: a * a,
    np.reciprocal: lambda a: 1.0 / a,
    np.absolute: lambda a: a * np.sign(a.value),
    np.sqrt: lambda a: _binomial(a, 0.5),
    np.exp: lambda a: _cyclic((np.exp,), a),
    np.log: lambda a: _integrated(np.log, lambda v: 1.0 / v, a),
    np.sin: lambda a: _cyclic((np.sin, np.cos, lambda v: -np.sin(v), lambda v: -np.cos(v)), a),
    np.cos: lambda a: _cyclic((np.cos, lambda v: -np.sin(v), lambda v: -np.cos(v), np.sin), a),
    np.tan: lambda a: np.sin(a) / np.cos(a),
    np.sinh: lambda a: _cyclic((np.sinh, np.cosh), a),
    np.cosh: lambda a: _cyclic((np.cosh, np.sinh), a),
    np.tanh: lambda a: np.sinh(a) / np.cosh(a),
    np.arctan: lambda a: _integrated(np.arctan, lambda v: 1.0 / (1.0 + v * v), a),
    np.arcsin: lambda a: _integrated(np.arcsin, lambda v: (1.0 - v * v) ** -0.5, a),
    np.arccos: lambda a: _integrated(np.arccos, lambda v: -((1.0 - v * v) ** -0.5), a),
}
"""How the elementary functions of numpy act on jets."""
