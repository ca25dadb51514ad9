"""Exact numbers from input: whatever the user writes becomes a `flint.fmpq` here.

Accepted: `int`, `Fraction`, `str` ("1/3", "0.25", "1e-3", taken as the decimal written), sympy
rationals, numpy integers and floats, and `float`, which is taken as the shortest decimal that it
prints as: 0.1 is 1/10.  Numbers that the program itself worked out in floating point are no such
decimals; `exact` takes them as the binary fractions they are.

How long a number may be is said in `pas.algebra.inputs`.
"""

from __future__ import annotations

import math
import numbers
import re
import sys
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Protocol, SupportsFloat, TypeAlias, TypeVar, cast

from flint import fmpq, fmpz

from pas.algebra.inputs import FINEST, LONGEST_NUMBER, MOST_DIGITS, short, shown

if TYPE_CHECKING:
    from pas.arrays import AnyArray

NUMBER = re.compile(
    r"(?P<sign>[+-]?)(?=[.0-9])(?P<whole>[0-9]*)(?:/(?P<below>[0-9]+)|(?:\.(?P<decimals>[0-9]*))?"
    r"(?:[eE](?P<exponent>[+-]?[0-9]+))?)"
)
"""A quotient of integers or a decimal."""

R = TypeVar("R")
T = TypeVar("T")
Vector = tuple[fmpq, fmpq, fmpq]


Exact: TypeAlias = int | float | str | Fraction | fmpq | SupportsFloat
"""What is taken for an exact number, as the head of this module says."""

VectorLike: TypeAlias = "Sequence[Exact] | AnyArray"
"""What is taken for three exact numbers: a sequence of them, or an array of shape (3,)."""


class Symbolic(Protocol):
    """An expression of sympy, by what tells it: sympy itself is not imported for it."""

    @property
    def free_symbols(self) -> Any:
        """Its symbols."""


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
            return read_number(value)
        except ZeroDivisionError:
            raise ValueError(f"{name} divides by zero: {shown(value)}") from None
        except ValueError as error:
            raise ValueError(f"{name} {error}") from None
    if isinstance(value, numbers.Rational):
        return fmpq(int(value.numerator), int(value.denominator))
    if isinstance(value, numbers.Real):
        if not math.isfinite(value):
            raise ValueError(f"{name} must be finite, not {float(value)}")
        return read_number(str(value))
    if getattr(value, "is_Rational", False):  # sympy, not imported here
        return fmpq(int(value.p), int(value.q))
    if getattr(value, "is_Float", False):
        return rational(float(value), name)
    if hasattr(value, "is_Number") or hasattr(value, "free_symbols"):
        raise ValueError(f"{name} must be a rational number, not {shown(value)}")
    raise TypeError(f"{name} must be a number or a string such as '1/3', not {shown(value)}")


def amount(value: Any, name: str) -> fmpq:
    """The number that `value` stands for, not negative and within doubles; raises as `rational` does."""
    number = rational(value, name)
    if number < 0:
        raise ValueError(f"{name} must not be negative, not {short(plain(number))}")
    if to_float(number) == math.inf:
        raise ValueError(f"{name} must be below {sys.float_info.max:.2g}, not {shown(value)}")
    return number


def positive(value: Any, name: str) -> fmpq:
    """The number that `value` stands for, which is positive; raises as `rational` does."""
    number = rational(value, name)
    if number <= 0:
        raise ValueError(f"{name} must be positive, not {short(plain(number))}")
    return number


def check_tolerance(tolerance: Any, size: float | None = None, name: str = "tolerance") -> float:
    """The tolerance of a mesh, or what `name` says, in the model's units; `size` is that of the model, where known.

    Raises `TypeError` for no number, `ValueError` for one that is not positive or below `FINEST` times the size.
    """
    try:
        value = to_float(rational(tolerance))
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name} must be a positive number, not {shown(tolerance)}") from None
    if not 0 < value < math.inf:
        raise ValueError(f"{name} must be a positive number, not {value:g}")
    if size is not None and value < FINEST * size:
        raise ValueError(
            f"tolerance must be at least {FINEST * size:.2g}, {FINEST:g} of the model's size, below which a mesh "
            f"would be finer than its vertices are placed; it is {value:.3g}"
        )
    return value


def near(value: float) -> fmpq:
    """The nearest rational number whose denominator is at most 10^9; it is off by less than 10^-9."""
    return rational(Fraction(value).limit_denominator(10**9))


def decimal(value: float) -> fmpq:
    """The decimal number of six digits nearest to a double."""
    return rational(f"{value:.6g}")


def square_root(value: fmpq) -> fmpq:
    """The root of a number that is not negative: exact where it is rational, else off by less than 2^-60 of it."""
    p, q = math.isqrt(int(value.p)), math.isqrt(int(value.q))
    if p * p == value.p and q * q == value.q:
        return fmpq(p, q)
    product = int(value.p) * int(value.q)  # of which the root, over q, is that of p / q
    shift = max(0, 62 - product.bit_length() // 2)
    return fmpq(math.isqrt(product << 2 * shift), int(value.q) << shift)


def read_number(text: str) -> fmpq:
    """The number that a text such as "1/3" or "1.5e-3" stands for.

    Raises `ValueError`, to be continued after a name ("is not a rational number: ..."), and `ZeroDivisionError`.
    """
    plain_text = text.strip().replace("_", "")
    if len(plain_text) > LONGEST_NUMBER:
        raise ValueError(f"is written with {len(plain_text)} characters; a number may have {LONGEST_NUMBER}")
    found = NUMBER.fullmatch(plain_text)
    if not found or not any(found[part] for part in ("whole", "decimals")):
        raise ValueError(f"is not a rational number: {shown(text)}; write it as 3, '1/3' or '0.25'")
    whole, below, decimals, exponent = (found[part] or "" for part in ("whole", "below", "decimals", "exponent"))
    shift = int(exponent[:9] or 0)
    if len(exponent) > 9 or abs(shift) > MOST_DIGITS:
        raise ValueError(f"has an exponent beyond {MOST_DIGITS}: {shown(text)}")
    number = fmpq(fmpz(whole + decimals)) * fmpq(10) ** (shift - len(decimals))
    return (-number if found["sign"] == "-" else number) / fmpz(below or "1")


def exact(value: float) -> fmpq:
    """The binary fraction that a double is; for numbers worked out, not for those that somebody wrote.

    Raises `ValueError` for one that is not finite.
    """
    if not math.isfinite(value):
        raise ValueError(f"a number worked out is not finite: {value}")
    return fmpq(*float(value).as_integer_ratio())


def three(values: Iterable[T]) -> tuple[T, T, T]:
    """Three values as a tuple, such as a vector's coordinates; raises `ValueError` for more or fewer."""
    x, y, z = values
    return x, y, z


UNITS = three((fmpq(i == 0), fmpq(i == 1), fmpq(i == 2)) for i in range(3))


def exact_vector(values: Sequence[float]) -> Vector:
    """Three doubles as the binary fractions that they are."""
    return three(map(exact, values))


def vector(value: Any, name: str = "vector") -> Vector:
    """Three exact rationals from any sequence of three numbers."""
    if isinstance(value, str) or not hasattr(value, "__len__"):
        raise TypeError(f"{name} must be three numbers, not {shown(value)}")
    if len(value) != 3:
        raise ValueError(f"{name} must be three numbers, not {len(value)}: {shown(value)}")
    return three(rational(entry, f"{name}[{i}]") for i, entry in enumerate(value))


def to_fraction(value: fmpq) -> Fraction:
    """The number as a `fractions.Fraction`."""
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


def dot(left: Sequence[R], right: Sequence[R]) -> R:
    """The scalar product, exact for exact entries: numbers or polynomials."""
    first, second = cast(Sequence[Any], left), cast(Sequence[Any], right)
    return sum((a * b for a, b in zip(first[1:], second[1:], strict=True)), first[0] * second[0])


def minus(left: Sequence[R], right: Sequence[R]) -> tuple[R, R, R]:
    """The difference of two vectors in space, exact for exact entries."""
    (a, b, c), (d, e, f) = cast(Sequence[Any], left), cast(Sequence[Any], right)
    return a - d, b - e, c - f


def cross(left: Sequence[R], right: Sequence[R]) -> tuple[R, R, R]:
    """The vector product of two vectors in space, exact for exact entries: numbers or polynomials."""
    (a, b, c), (d, e, f) = cast(Sequence[Any], left), cast(Sequence[Any], right)
    return b * f - c * e, c * d - a * f, a * e - b * d


def moved(point: Sequence[fmpq], *steps: tuple[fmpq | int, Sequence[fmpq]]) -> Vector:
    """A point and the sum of some vectors, each given with its factor."""
    return three(c + sum((s * v[i] for s, v in steps), fmpq(0)) for i, c in enumerate(point))


def two_across(normal: Vector) -> tuple[Vector, Vector]:
    """Two vectors across a vector and across one another, right-handed with it, of any lengths."""
    least = min(range(3), key=lambda i: abs(normal[i]))
    first = cross(normal, UNITS[least])
    return first, cross(normal, first)


def determinant(a: Sequence[R], b: Sequence[R], c: Sequence[R]) -> R:
    """The determinant of three vectors: positive where they go round counterclockwise, seen from their tips."""
    return dot(a, cross(b, c))


def plain(value: fmpq) -> str:
    """The number as a user would write it: '3', '-1/3'."""
    return str(value)


def listed(values: Vector) -> str:
    """Three exact numbers as a sentence has them."""
    return ", ".join(map(plain, values))


def texts(point: Vector) -> list[str]:
    """Three exact numbers as records hold them."""
    return [plain(c) for c in point]
