"""Limits of the sizes of inputs, in one place: numbers, polynomials, orders, degrees, tolerances, texts and records.

Ten characters can ask for what no machine holds (`1e99999999`, `((9^60)^60)^60`, `"order": 2001`), and the exact
library ends the process where memory does.  So whatever enters, from a script, a problem file or a project file, passes
one of these doors, and what is too large is refused in one sentence.  Behind them nothing is checked again.

Not limited is what exists already: a `Fraction` that somebody made has its digits, however many.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Sequence
from math import comb
from numbers import Integral
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from pas.arrays import Floats

if TYPE_CHECKING:
    from flint import fmpq, fmpq_mpoly

MOST_DIGITS = 1000
"""Digits that an exponent or a power may make of a few characters: doubles need 325, and a corner whose radii have
1000 takes minutes to solve."""

LONGEST_NUMBER = 100_000
"""Characters of one number: coefficients of an exact corner have 1700 at GC^2, and 30 000 with radii of 300 digits."""

LONGEST_TEXT = 200_000
"""Characters of one expression: the 455 terms of degree 12 with coefficients of 200 digits have half as many."""

MAXIMAL_DEGREE = 60
"""The highest degree of polynomials that are written down; higher powers are surely slips."""

HIGHEST_POWER = 200
"""Degree of powers that are worked out: evaluated, such a polynomial has C(203, 3) = 1.4 million coefficients."""

MOST_TERMS = 100_000
"""Terms that a power may have: those of degree 60 in x, y, z are 39 711."""

WIDEST = 300
"""Decimal exponent of how much larger coefficients of one function that is evaluated in doubles may be than others."""

HIGHEST_ORDER = 8
"""The highest order of contact: a corner takes degree 8 at order 4 already, and the search ends at degree 12."""

HIGHEST_DEGREE = 12
"""The highest degree of a blend, where the search for a lowest degree ends: matrices of 2730 unknowns on the corner."""

HIGHEST_SURFACE_DEGREE = 16
"""Of a piecewise surface from elsewhere: a corner is proved in 0.04 s at degree 4, 7 s at 16, 76 s at 24."""

MOST_PIECES = 100_000
"""The most pieces of a partition: the largest problem measured has 162."""

MOST_SURFACES = 32
"""The most surfaces that a parametric blend meets: by Hermite interpolation of order 8 it is of degree 287 then."""

HIGHEST_EXPONENT = 24
"""Of the weights of a parametric blend: that for contact of order 8 is 9 or 10, others only flatten the ends."""

FINEST = 1e-7
"""Tolerance of a mesh over the model's size: vertices are on the surface to 1e-9 of it, and at 1e-6 a corner takes
some millions of triangles."""

DEEPEST = 200
"""Lists within lists of a file: a solid made by a hundred operations in turn has a tree of that depth."""

SHOWN = 60
"""Characters of a wrong value that a sentence quotes."""


def shown(value: Any) -> str:
    """A wrong value as a sentence quotes it: its `repr`, shortened."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # Python writes out no integer of more than 4300 digits
        text = f"a very long {type(value).__name__}"
    return short(text)


def shown_point(point: Iterable[Any], digits: int = 4) -> str:
    """A point in a sentence: its coordinates in brackets, to some number of digits."""
    return "(" + ", ".join(f"{float(c):.{digits}g}" for c in point) + ")"


def short(text: str) -> str:
    """A formula, a name or a number of a sentence, which may be long, shortened."""
    return text if len(text) <= SHOWN else f"{text[: 2 * SHOWN // 3]}...{text[-SHOWN // 4 :]}"


def whole(value: Any, name: str, least: int, most: int, words: str = "") -> int:
    """A whole number from `least` to `most`; `words` says in brackets what they mean.

    Raises `TypeError` for what is no whole number (a truth value is none), `ValueError` for another.
    """
    meaning = f" ({words})" if words else ""
    sentence = f"{name} must be a whole number from {least} to {most}{meaning}, not {shown(value)}"
    if isinstance(value, bool):
        raise TypeError(sentence)
    try:
        number = operator.index(value)
    except TypeError:  # an array has an index where it has one entry
        raise TypeError(sentence) from None
    if not least <= number <= most:
        raise ValueError(sentence)
    return number


def natural(value: Any, name: str, least: int = 0, words: str = "") -> int:
    """A whole number from `least` on, however large; raises `ValueError` for anything else (see also `whole`)."""
    if not isinstance(value, int) or isinstance(value, bool) or value < least:
        raise ValueError(f"{name} must be a whole number >= {least}{words}, not {shown(value)}")
    return value


def check_flag(value: Any, name: str) -> bool:
    """A truth value, of Python or numpy; raises `TypeError` for anything else, which might mean the opposite."""
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"{name} must be True or False, not {shown(value)}")
    return bool(value)


def check_order(order: Any) -> int:
    """An order of contact or continuity."""
    return whole(order, "order", 0, HIGHEST_ORDER, "0 for continuous, 1 for GC^1, ...")


def check_degree(degree: Any, name: str = "degree") -> int:
    """The degree of a blend."""
    return whole(degree, name, 1, HIGHEST_DEGREE)


def check_surface_degree(highest: int, degree: Any = None) -> int:
    """The degree of a piecewise surface: that of its patches, or a higher one that is stated."""
    if highest > HIGHEST_SURFACE_DEGREE:
        raise ValueError(f"the patches of a surface may be of degree {HIGHEST_SURFACE_DEGREE}, and one is of {highest}")
    return (
        highest if degree is None else whole(degree, "degree", highest, HIGHEST_SURFACE_DEGREE, "not below a patch's")
    )


def check_derivative(order: Any, name: str) -> int:
    """The order of a derivative."""
    # Order of derivatives that are evaluated by Taylor series in two parameters, whose coefficients are 325 then.
    highest_derivative = 24
    return whole(order, name, 0, highest_derivative)


def check_limit(most: Any) -> int | None:
    """A limit to the number of triangles, None for none; raises `TypeError` or `ValueError` for what is none."""
    if most is None:
        return None
    if isinstance(most, bool) or not isinstance(most, Integral):
        raise TypeError(f"max_triangles must be a whole number, not {shown(most)}")
    if most < 1:
        raise ValueError(f"max_triangles must be at least 1, not {int(most)}")
    return int(most)


def points_of(points: ArrayLike, name: str = "points") -> Floats:
    """Points (..., 3) as an array.  Raises `ValueError` for what are none."""
    try:
        array = np.asarray(points, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be numbers of shape (..., 3), not {shown(points)}") from None
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"{name} must have shape (..., 3), not {array.shape}")
    return array


def set_fields(made: Any, **fields: Any) -> None:
    """Set the fields of a frozen object, in its constructor alone."""
    for name, value in fields.items():
        object.__setattr__(made, name, value)


def check_count(given: Any, count: int, must: str, without: type[Exception] = TypeError) -> None:
    """Raise `ValueError` for a text and for another number of things than there `must` be, and an error of some type
    for what has no number."""
    if isinstance(given, str) or not hasattr(given, "__len__") or len(given) != count:
        raise (ValueError if hasattr(given, "__len__") else without)(f"{must}, not {shown(given)}")


def check_names(names: Iterable[Any]) -> None:
    """Raise `ValueError` for a name of a face that is no text, or an empty one, as walls have."""
    for name in names:
        if not isinstance(name, str) or not name:
            raise ValueError(f"the name of a face must be a text that is not empty, not {shown(name)}")


def check_text(text: str) -> str:
    """An expression of bearable length; raises `ValueError`."""
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"it has {len(text)} characters; an expression may have {LONGEST_TEXT}")
    return text


def check_product(left: fmpq_mpoly, right: fmpq_mpoly) -> None:
    """Raise `ValueError` where a product of polynomials that are written down would be too large."""
    if not left.is_zero() and not right.is_zero():
        degree = int(left.total_degree()) + int(right.total_degree())
        _check_size(degree, len(left) * len(right), len(left.degrees()), MAXIMAL_DEGREE)
        check_digits(left, right)


def check_digits(left: fmpq_mpoly, right: fmpq_mpoly) -> None:
    """Raise `ValueError` where the numbers of a product or quotient that is written down would be too long."""
    if binary_digits(left.coeffs()) + binary_digits(right.coeffs()) > 2 * LONGEST_NUMBER * math.log2(10):
        raise ValueError(f"it has numbers of more than {2 * LONGEST_NUMBER} digits")


def check_power(base: fmpq_mpoly, exponent: int, highest: int = HIGHEST_POWER) -> None:
    """Raise `ValueError` where `base ** exponent` would be of a degree above `highest`, or very long."""
    if exponent <= 1 or base.is_zero():
        return
    terms = comb(exponent + len(base) - 1, exponent) if len(base) <= MOST_TERMS else len(base)
    _check_size(int(base.total_degree()) * exponent, terms, len(base.degrees()), highest)
    if binary_digits(base.coeffs()) * exponent > MOST_DIGITS * math.log2(10):
        raise ValueError(f"it has numbers of more than {MOST_DIGITS} digits")


def check_coefficients(polynomial: fmpq_mpoly, name: str) -> None:
    """Raise `ValueError` for coefficients that doubles cannot hold together; `name` says whose they are."""
    sizes = [abs(int(c.p)).bit_length() - int(c.q).bit_length() for c in polynomial.coeffs()]
    if sizes and max(sizes) - min(sizes) > WIDEST * math.log2(10):
        raise ValueError(
            f"{name} has coefficients more than 1e{WIDEST} times as large as others, which cannot be evaluated in "
            "floating point together; choose another unit of length"
        )


def _check_size(degree: int, terms: int, letters: int, highest: int) -> None:
    if degree > highest:
        raise ValueError(f"it is of degree {degree}, above {highest}")
    if terms > MOST_TERMS and comb(degree + letters, letters) > MOST_TERMS:
        raise ValueError(f"it may have more than {MOST_TERMS} terms")


def binary_digits(numbers: Sequence[fmpq]) -> int:
    """The binary digits of the longest numerator or denominator; none where all are 1 or -1."""
    return max(((abs(int(part)) - 1).bit_length() for c in numbers for part in (c.p, c.q)), default=0)


def depth(data: Any, most: int = DEEPEST) -> int:
    """How many lists and tables are within one another, `most` + 1 where there are more."""
    level, reached = [data], 0
    while reached <= most:
        inner = [v for v in level if isinstance(v, dict | list)]
        if not inner:
            break
        level = [v for holder in inner for v in (holder.values() if isinstance(holder, dict) else holder)]
        reached += 1
    return reached
