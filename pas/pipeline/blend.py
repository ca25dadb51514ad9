"""The whole method on one screen: problem -> contacts in place -> space -> fit -> proved surface.

`blend` raises the degree until a member of the solution space passes every proof, so the degree
it returns is the lowest at which this program found one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Unpack

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree
from pas.blending.place import place
from pas.blending.regularity import is_regular
from pas.blending.solving import solve
from pas.errors import InfeasibleError, NoSolutionError, NotProvedError
from pas.fairing.contradictions import check_wishes
from pas.fairing.wishes import Options, Wishes
from pas.limits import Report, limited
from pas.partition.cells import Partition
from pas.pipeline.fit import choose
from pas.pipeline.result import Attempt, Blend
from pas.pipeline.space import SolutionSpace
from pas.pipeline.stages import OnStage, Stages
from pas.surface.placed import PlacedContacts

DEGREES_TRIED = 4
"""Degrees with regular members that are tried before giving up; corners needed at most three."""


@limited("finding a blend", "a lower order")
def blend(
    contacts: Sequence[Any],
    order: int,
    degree: int | None = None,
    partition: Partition | None = None,
    *,
    wishes: Wishes | None = None,
    on_stage: OnStage | None = None,
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[Options],
) -> Blend:
    """Find, choose and prove the blend of three pipes or contacts.

    `contacts` are pipes, contacts or pairs (surface, clip), `order` the k of GC^k.  Without a
    `degree` it is raised until the proofs pass.

    What shapes the surface is in `wishes` (see `pas.Wishes`), or said by keywords, which go before
    these: `energy`, `inside`, `outside`, `through`, `near`, `near_weight`, `handles`, `margin`,
    `normalize`, `prove`, `guard`, `basis`.  The energy is minimised over the members
    (`pas.ThinPlate()` by default).  Points are sequences of three exact numbers: `inside` ones
    get f <= -margin, `outside` ones f >= margin (by default 10^-4 of the region's radius), the surface passes `through`
    others exactly and `near` still others by least squares with weight `near_weight` (or one for
    each).  `handles` maps B-coefficients (cell, multi-index) to values that they get exactly.
    `normalize` fixes the scale of f (`pas.MeanAlpha()` by default).  `basis` (members, each one
    polynomial a cell) restricts a given `degree` to the span of these members.

    With `prove` (the default) the surface returned is proved in every verdict.  Without, it is
    the optimum under sampled conditions, or with `guard=False` under the points alone, and its
    certificate is worked out when asked for.  `on_stage` is told the name and the seconds of each stage
    at its end.

    Raises `GeometryError` (contacts that do not fit), `NoSolutionError` (no usable surface),
    `InfeasibleError` (constraints that contradict), `NotProvedError`; `ValueError` and
    `TypeError` for wrong arguments.
    """
    wished = (wishes or Wishes()).changed(**options)
    if wished.basis is not None and degree is None:
        raise ValueError("a basis needs the degree of its members: give degree as well")
    stages = Stages(on_stage)
    with stages.stage("partition"):
        placed = place(contacts, order, partition)
        check_wishes(wished, placed)
    if order == 0 and len(placed.partition.pieces) > 1:
        raise ValueError(
            "order must be at least 1 where the region has several pieces: with order 0 they would meet in creases"
        )
    attempts: list[Attempt] = []
    failure: InfeasibleError | NotProvedError | None = None
    for space in _spaces(placed, degree, attempts, stages):
        try:
            return choose(space, wished, attempts, stages)
        except (InfeasibleError, NotProvedError) as error:
            attempts.append(Attempt(space.degree, space.dimension, str(error)))
            failure = error
    if failure is None and degree is not None:
        raise _too_low(attempts[-1], _lowest(placed, degree), order)
    raise _given_up(attempts, failure, order)


def _spaces(
    placed: PlacedContacts, degree: int | None, attempts: list[Attempt], stages: Stages
) -> Iterator[SolutionSpace]:
    """Solution spaces with regular members, of rising degree; others are noted as attempts."""
    degrees = range(1, HIGHEST_DEGREE + 1) if degree is None else [check_degree(degree)]
    yielded = 0
    for candidate in degrees:
        with stages.stage("solve", f" (degree {candidate})"):
            space = SolutionSpace.of(solve(placed, candidate))
            usable = space.regular
        if usable:
            yield space
            yielded += 1
            if yielded == DEGREES_TRIED:
                return
        else:
            reason = "no solution" if space.dimension == 0 else "all members have alpha = 0 on a contact curve"
            attempts.append(Attempt(candidate, space.dimension, reason))


def _lowest(placed: PlacedContacts, degree: int) -> int | None:
    """The lowest degree above `degree` with a regular member, if it is not far."""
    above = range(degree + 1, HIGHEST_DEGREE + 1)
    return next((n for n in above if is_regular(solve(placed, n))), None)


def _too_low(attempt: Attempt, lowest: int | None, order: int) -> NoSolutionError:
    known = f"the lowest degree with solutions is {lowest}" if lowest else "nor has a higher one"
    return NoSolutionError(
        f"no usable surface of degree {attempt.degree} meets the contacts with GC^{order} "
        f"(degree {attempt.degree}: dimension {attempt.dimension}, {attempt.outcome}); {known}",
        {attempt.degree: attempt.dimension},
    )


def _given_up(attempts: Sequence[Attempt], failure: InfeasibleError | NotProvedError | None, order: int) -> Exception:
    tried = "; ".join(f"degree {a.degree}: dimension {a.dimension}" for a in attempts)
    if failure is None:
        return NoSolutionError(
            f"no usable surface meets the contacts with GC^{order} ({tried}); a higher degree may have one",
            {a.degree: a.dimension for a in attempts},
        )
    text = f"{failure} (tried {tried})"
    if isinstance(failure, NotProvedError):
        return NotProvedError(text, failure.blend)
    return InfeasibleError(text, failure.conflict)
