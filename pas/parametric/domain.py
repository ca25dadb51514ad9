"""Domains of parametric surfaces: two closed intervals, exact as they are given and in doubles.

Proofs take the exact ends, since a surface may well be singular at 2/3 and regular up to the double below it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

from pas.algebra.expressions import Names
from pas.algebra.inputs import shown
from pas.algebra.rational import Exact, rational, to_float, to_fraction

Interval = tuple[float, float]
Domain = tuple[Interval, Interval]
Ends = tuple[Fraction | None, Fraction | None]
"""Exact ends; None at infinity."""

IntervalLike: TypeAlias = Sequence[Exact | None] | None
DomainLike: TypeAlias = Sequence[IntervalLike] | None
"""What is taken for an interval and for two of them; None stands for an end at infinity, and for both."""

ExactDomain = tuple[Ends, Ends]
PLANE: Domain = ((-math.inf, math.inf), (-math.inf, math.inf))


def read_domain(domain: DomainLike, names: Names) -> tuple[Domain, ExactDomain]:
    """Two intervals as the user writes them, in doubles and exact, None for an end at infinity.

    Raises `ValueError` for anything else, empty intervals and ends that doubles do not hold or tell apart.
    """
    if domain is None:
        return PLANE, ((None, None), (None, None))
    if not hasattr(domain, "__len__") or len(domain) != 2:
        raise ValueError(f"domain must be two intervals such as ((0, 1), (None, 2)), not {shown(domain)}")
    (first, exactly), (second, precisely) = (_interval(i, name) for i, name in zip(domain, names, strict=True))
    return (first, second), (exactly, precisely)


def _interval(given: IntervalLike, name: str) -> tuple[Interval, Ends]:
    interval = (None, None) if given is None else given
    if isinstance(interval, str) or not hasattr(interval, "__len__") or len(interval) != 2:
        raise ValueError(f"the domain of {name} must be an interval such as (0, 1), not {shown(interval)}")
    low, high = (_end(end, name) for end in interval)
    rounded = (
        -math.inf if low is None else to_float(rational(low)),
        math.inf if high is None else to_float(rational(high)),
    )
    for exact, double in zip((low, high), rounded, strict=True):
        if exact is not None and math.isinf(double):
            raise ValueError(
                f"an end of the domain of {name} is beyond the range of doubles (1.8e308): {shown(interval)}"
            )
    if not (low is None or high is None or low < high) or not rounded[0] < rounded[1]:
        raise ValueError(f"the domain of {name} must be an interval (low, high) with low < high, not {shown(interval)}")
    return rounded, (low, high)


def _end(end: Exact | None, name: str) -> Fraction | None:
    if end is None or (isinstance(end, float) and math.isinf(end)):
        return None
    return to_fraction(rational(end, f"an end of the domain of {name}"))
