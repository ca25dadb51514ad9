"""From contacts to the space of all surfaces that meet them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import fmpq_mat

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree, check_order
from pas.algebra.monomials import count
from pas.blending.conditions import Conditions
from pas.blending.multipliers import consistency
from pas.blending.net import Net
from pas.blending.place import place
from pas.blending.single import METHODS, members
from pas.blending.space import SolutionSpace
from pas.limits import Report, checkpoint, limited
from pas.partition.cells import Partition
from pas.surface.contact import Contact
from pas.surface.joins import joins

MANY_CELLS = 24
"""Cells above which the net of B-coefficients serves: on C^1 quartics both take 10 to 20 ms with 6
cells, with 48 cells 1.3 s and 17 s."""

PIECEWISE = ("linear", "syzygy")
"""The methods that serve several pieces."""


@limited("solving for all surfaces", "a lower degree")
def solutions(
    contacts: Sequence[Any],
    order: int,
    degree: int | None = None,
    partition: Partition | None = None,
    *,
    method: str = "linear",
    regular: bool = False,
    highest_degree: int = HIGHEST_DEGREE,
    seconds: float | None = None,
    progress: Report | None = None,
) -> SolutionSpace:
    """All surfaces that meet the contacts with GC^`order`, exact.

    `contacts` are pipes, contacts or pairs (surface, clip).  The `partition` is a
    `pas.SingleCell(...)` for single polynomials, or several cells; without one, three
    perpendicular contacts get the six-tetrahedra corner.

    With a `degree`, all solutions of that degree (the dimension may be 0); without, those of the
    lowest degree that has any, or with `regular` a regular one (alpha not identically zero on
    the contact curves).  Where no degree up to `highest_degree` has any, the answer is the empty
    space of that degree; `degrees_tried` has the dimensions found.

    `method` is "linear", "syzygy", and for a single cell also "normal-form" and "intersection": the
    same space by different ways, with different bases.

    Raises `GeometryError` where the contacts do not fit, `ValueError` or `TypeError` for a wrong argument.
    """
    check_order(order)
    check_degree(highest_degree, "highest_degree")
    region, turned = place(contacts, partition)
    check_method(method, region)
    if degree is not None:
        return solve(region, turned, order, check_degree(degree), method)
    tried: dict[int, int] = {}
    for candidate in range(1, highest_degree + 1):
        checkpoint(f"solving for degree {candidate}")
        space = solve(region, turned, order, candidate, method)
        tried[candidate] = space.dimension
        if space.dimension and (space.regular or not regular):
            break
    space.degrees_tried = tried
    return space


def solve(
    partition: Partition, contacts: Sequence[Contact], order: int, degree: int, method: str = "linear"
) -> SolutionSpace:
    """The solution space of one degree for contacts that are in place."""
    frame = partition.frame
    if len(partition.pieces) == 1:
        # in the user's coordinates, where the numbers are short
        found = members(contacts, order, degree, method)
        rows = [frame.localise(p).row(degree) for p in found]
        patches: tuple[fmpq_mat, ...] = (fmpq_mat(len(rows), count(degree), [v for row in rows for v in row]),)
    elif method == "syzygy":
        lifted = consistency(partition, contacts, order).solve(degree)
        patches = tuple(
            fmpq_mat(
                len(lifted), count(degree), [v for s in lifted for v in frame.localise(s.patches[piece]).row(degree)]
            )
            for piece in range(len(partition.pieces))
        )
    else:
        moved = tuple(Contact(frame.localise(c.surface), frame.localise(c.clip)) for c in contacts)
        carriers = tuple(join.pieces for join in joins(partition.local, moved))
        if len(partition.cells) > MANY_CELLS:
            patches = Net(partition.local, moved, carriers, order, degree).solve()
        else:
            patches = Conditions(partition.local, moved, carriers, order).solve(degree)
    return SolutionSpace(partition, contacts, order, degree, patches)


def check_method(method: Any, partition: Partition) -> str:
    """A method's name, checked against what serves the partition."""
    single = len(partition.pieces) == 1
    served = tuple(METHODS) if single else PIECEWISE
    if method not in served:
        kind = "a single cell" if single else "several cells"
        raise ValueError(f"method must be one of {', '.join(served)} for {kind}, not {method!r}")
    return str(method)
