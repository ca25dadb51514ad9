"""A method of solving of one's own: the linear system and the syzygies, which must find the same space."""

from __future__ import annotations

from typing import Any

import pas
from pas.blending.solving import solve


def _solve(placed: Any, degree: int) -> Any:
    linear, syzygy = (solve(placed, degree, method) for method in ("linear", "syzygy"))
    if not linear.equals(syzygy):
        raise ArithmeticError(f"two methods find different spaces of degree {degree}")
    return linear.patches


CHECKED = pas.register_method(pas.SolvingMethod("checked", _solve, several=True))
