"""Exact numbers at the door: whatever the user writes becomes a `flint.fmpq` here.

Accepted: `int`, `Fraction`, `str` ("1/3", "0.25", "1e-3", taken as the decimal written), sympy
rationals, numpy integers and floats, and `float`, which is taken as the exact rational it is.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from flint import fmpq, fmpz

Vector = tuple[fmpq, fmpq, fmpq]


def rational(value: Any, name: str = "number") -> fmpq:
    """The exact rational that `value` stands for.

    Raises `TypeError` where `value` is no number, `ValueError` where it is not finite or not
    rational; both name the argument by `name`.
    """
    if isinstance(value, fmpq):
        return value
    if isinstance(value, fmpz):
        return fmpq(value)
    if isinstance(value, bool):
        raise TypeError(f"{name} must be a number, not the truth value {value}")
    if isinstance(value, str):
        try:
            return _from_fraction(Fraction(value.strip()))
        except ZeroDivisionError:
            raise ValueError(f"{name} divides by zero: {value!r}") from None
        except ValueError:
            raise ValueError(f"{name} is not a rational number: {value!r}; write it as 3, '1/3' or '0.25'") from None
    if isinstance(value, numbers.Rational):
        return fmpq(int(value.numerator), int(value.denominator))
    if isinstance(value, numbers.Real):
        number = float(value)
        if not math.isfinite(number):
            raise ValueError(f"{name} must be finite, not {number}")
        return _from_fraction(Fraction(number))
    if getattr(value, "is_Rational", False):  # sympy, not imported here
        return fmpq(int(value.p), int(value.q))
    if getattr(value, "is_Float", False):
        return rational(float(value), name)
    if hasattr(value, "is_Number") or hasattr(value, "free_symbols"):
        raise ValueError(f"{name} must be a rational number, not {value}")
    raise TypeError(f"{name} must be a number or a string such as '1/3', not {value!r}")


def vector(value: Any, name: str = "vector") -> Vector:
    """Three exact rationals from any sequence of three numbers."""
    if isinstance(value, str) or not hasattr(value, "__len__"):
        raise TypeError(f"{name} must be three numbers, not {value!r}")
    if len(value) != 3:
        raise ValueError(f"{name} must be three numbers, not {len(value)}: {value!r}")
    x, y, z = (rational(entry, f"{name}[{i}]") for i, entry in enumerate(value))
    return x, y, z


def to_fraction(value: fmpq) -> Fraction:
    """The same number as `fractions.Fraction`."""
    return Fraction(int(value.p), int(value.q))


def to_float(value: fmpq) -> float:
    """The nearest double (correctly rounded; infinite beyond the range of doubles)."""
    try:
        return int(value.p) / int(value.q)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def to_floats(values: Sequence[fmpq]) -> tuple[float, ...]:
    """The nearest doubles of a sequence."""
    return tuple(to_float(value) for value in values)


def binary_exponent(value: fmpq) -> int:
    """The whole number e with `2^e <= value < 2^(e+1)`, exact; the value must be positive."""
    e = int(value.p).bit_length() - int(value.q).bit_length()
    return e if value >= fmpq(2) ** e else e - 1


def dot(left: Sequence[fmpq], right: Sequence[fmpq]) -> fmpq:
    """Exact scalar product."""
    return sum((a * b for a, b in zip(left, right, strict=True)), fmpq(0))


def cross(left: Sequence[fmpq], right: Sequence[fmpq]) -> Vector:
    """Exact vector product of two vectors in space."""
    a, b, c = left
    d, e, f = right
    return b * f - c * e, c * d - a * f, a * e - b * d


def plain(value: fmpq) -> str:
    """The number as a user would write it: '3', '-1/3'."""
    return str(to_fraction(value))


def _from_fraction(value: Fraction) -> fmpq:
    return fmpq(value.numerator, value.denominator)
