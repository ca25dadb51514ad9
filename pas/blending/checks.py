"""What orders and degrees may be."""

from __future__ import annotations

from typing import Any

HIGHEST_DEGREE = 12
"""Where the search for a lowest degree ends: matrices of 2730 unknowns on the corner."""


def check_order(order: Any) -> int:
    """The order of contact, checked."""
    if isinstance(order, bool) or not isinstance(order, int):
        raise TypeError(f"order must be a whole number (0 for continuous, 1 for GC^1, ...), not {order!r}")
    if not 0 <= order <= 8:
        raise ValueError(f"order must be from 0 to 8, not {order}")
    return order


def check_degree(degree: Any, name: str = "degree") -> int:
    """A degree, checked."""
    if isinstance(degree, bool) or not isinstance(degree, int):
        raise TypeError(f"{name} must be a whole number, not {degree!r}")
    if not 1 <= degree <= HIGHEST_DEGREE:
        raise ValueError(f"{name} must be from 1 to {HIGHEST_DEGREE}, not {degree}")
    return degree
