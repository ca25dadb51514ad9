"""Tables of dimensions: how many surfaces of each degree a layout has that meet contacts.

Without contacts it is the sum over all degrees d <= n of the dimensions of homogeneous splines of degree d on the
sphere of directions (Alfeld, Neamtu and Schumaker 1996); contacts are joined to these (see `pas.blending.spherical`).
Counted by exact linear algebra, degree by degree.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from pas.algebra.inputs import check_degree, check_order
from pas.blending.place import place
from pas.blending.solving import solve
from pas.blending.spherical import splines
from pas.limits import checkpoint
from pas.partition.layout import Layout


def dimensions(layout: Layout, contacts: Sequence[Any], order: int, degrees: Iterable[int] | int) -> dict[int, int]:
    """See `Layout.dimensions`."""
    check_order(order)
    several = [degrees] if isinstance(degrees, int) else degrees
    if isinstance(several, str) or not isinstance(several, Iterable):
        raise TypeError(f"degrees must be whole numbers, such as range(1, 7), not {several!r}")
    wanted = [check_degree(degree, f"degrees[{i}]") for i, degree in enumerate(several)]
    placed = place(contacts, order, layout) if len(contacts) else None
    table = {}
    for degree in wanted:
        checkpoint(f"counting for degree {degree}")
        if placed is None:
            table[degree] = sum(splines(layout, order, d)[0].nrows() for d in range(degree + 1))
        else:
            table[degree] = solve(placed, degree).dimension
    return table
