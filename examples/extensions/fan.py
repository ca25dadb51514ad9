"""A partition of one's own: a fan of tetrahedra around an axis, as in six tetrahedra, but of any number."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import pas


@pas.register_partition
class Fan(pas.Partition):
    """The tetrahedra `top bottom rim[i] rim[i + 1]` around the axis from `bottom` to `top`.

    The arguments are points (three exact numbers each), and the keys of its table in problem files.
    Project files hold it as the tetrahedra that it is.
    """

    name = "fan"

    def __init__(self, top: Any, bottom: Any, rim: Sequence[Any]) -> None:
        around = range(len(rim))
        cells = [(0, 1, 2 + i, 2 + (i + 1) % len(rim)) for i in around]
        middle = [(Fraction(a) + Fraction(b)) / 2 for a, b in zip(top, bottom, strict=True)]
        super().__init__([top, bottom, *rim], cells, middle)
