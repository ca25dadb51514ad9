"""Solving for all surfaces that meet contacts, by linear algebra over the rationals."""

from __future__ import annotations

from collections.abc import Sequence

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree
from pas.blending.place import PartitionLike, place
from pas.blending.regularity import is_regular
from pas.blending.solving import check_method, solve
from pas.contacts.contact import ContactLike
from pas.limits import Report, checkpoint, limited
from pas.pipeline.result import SolutionSpace


@limited("solving for all surfaces", "a lower degree")
def solutions(
    contacts: Sequence[ContactLike],
    order: int,
    degree: int | None = None,
    partition: PartitionLike | None = None,
    *,
    method: str = "linear",
    regular: bool = False,
    highest_degree: int = HIGHEST_DEGREE,
    seconds: float | None = None,
    progress: Report | None = None,
) -> SolutionSpace:
    """All surfaces that meet the contacts with GC^`order`, exact.

    `contacts` are pipes, contacts or pairs (surface, clip); clips that are "auto" are placed as by
    `pas.blend`.  The `partition` is a
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
    check_degree(highest_degree, "highest_degree")
    placed = place(contacts, order, partition)
    check_method(method, placed.partition)
    if degree is not None:
        return SolutionSpace.of(solve(placed, check_degree(degree), method))
    tried: dict[int, int] = {}
    for candidate in range(1, highest_degree + 1):
        checkpoint(f"solving for degree {candidate}")
        space = solve(placed, candidate, method)
        tried[candidate] = space.dimension
        if space.dimension and (not regular or is_regular(space)):
            break
    return SolutionSpace(placed, space.degree, space.source, degrees_tried=tried)
