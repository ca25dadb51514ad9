"""The whole method on one screen: problem -> contacts in place -> space -> fit -> proved surface.

`blend` raises the degree until a member of the solution space passes every proof, so the degree
it returns is the lowest at which this program found one.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Literal, Unpack, cast

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree
from pas.blending.place import place
from pas.blending.regularity import is_regular
from pas.blending.solving import solve
from pas.errors import InfeasibleError, NoSolutionError, NotProvedError
from pas.fairing.contradictions import check_wishes
from pas.fairing.wishes import Options, Wishes, as_wishes
from pas.limits import Report, limited
from pas.partition.cells import Partition
from pas.pipeline.fit import choose
from pas.pipeline.result import Attempt, Blend
from pas.pipeline.space import SolutionSpace
from pas.pipeline.stages import OnStage, Stages
from pas.surface.contact import ContactLike
from pas.surface.placed import PlacedContacts

DEGREES_TRIED = 4
"""Degrees with regular members that are tried before giving up; corners needed at most three."""

DEGREES_FOR_FAIRNESS = 2
"""Degrees above the first that is proved which are tried for a fair surface; beyond, nothing was gained."""

MOST_UNKNOWNS = 160
"""Spaces of larger dimension are not tried for fairness alone: they take many seconds."""


@limited("finding a blend", "a lower order")
def blend(
    contacts: Sequence[ContactLike],
    order: int,
    degree: int | Literal["lowest"] | None = None,
    partition: Partition | None = None,
    *,
    wishes: Wishes | None = None,
    on_stage: OnStage | None = None,
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[Options],
) -> Blend:
    """Find, choose and prove the blend of two or three pipes or contacts.

    `contacts` are pipes, contacts or pairs (surface, clip), `order` the k of GC^k.  Without a
    `degree` it is raised until the proofs pass, and by default further while the surface is not fair (see
    `pas.FairnessLimits`): the fairest is returned.  With degree="lowest" the first that is proved is.

    What shapes the surface is in `wishes` (see `pas.Wishes`), or said by keywords, which go before
    these: `energy`, `tension`, `limits`, `inside`, `outside`, `through`, `near`, `near_weight`, `handles`,
    `margin`, `normalize`, `prove`, `guard`, `basis`.  The energy is minimised over the members: by default
    `pas.CurvatureVariation()`, that of the surface, whose `tension` goes from 0 (full) over 23/5 (as usual) up
    (slim); for a quadratic form such as `pas.ThinPlate()` the lowest degree is taken.  Points are sequences of
    three exact numbers: `inside` ones get f <= -margin, `outside` ones f >= margin (by default 10^-4 of the
    region's radius), the surface passes `through` others exactly and `near` still others by least squares with
    weight `near_weight` (or one for each).  `handles` maps B-coefficients (cell, multi-index) to values that
    they get exactly.  `normalize` fixes the scale of f (`pas.MeanAlpha()` by default).  `basis` (members, each
    one polynomial a cell) restricts a given `degree` to the span of these members.

    With `prove` (the default) the surface returned is proved in every verdict.  Without, it is
    the optimum under sampled conditions, or with `guard=False` under the points alone, and its
    certificate is worked out when asked for.  `on_stage` is told the name and the seconds of each stage
    at its end.

    Raises `GeometryError` (contacts that do not fit), `NoSolutionError` (no usable surface),
    `InfeasibleError` (constraints that contradict), `NotProvedError`; `ValueError` and
    `TypeError` for wrong arguments.
    """
    wished = as_wishes(wishes).changed(**options)
    wanted = check_wanted_degree(degree)
    given = None if wanted is None or wanted == "lowest" else wanted
    if wished.basis is not None and given is None:
        raise ValueError("a basis needs the degree of its members: give degree as well")
    stages = Stages(on_stage)
    with stages.stage("partition"):
        placed = place(contacts, order, partition)
        check_wishes(wished, placed)
        wished = wished.settled(placed)
    if order == 0 and len(placed.partition.pieces) > 1:
        raise ValueError(
            "order must be at least 1 where the region has several pieces: with order 0 they would meet in creases"
        )
    raised = degree is None and wished.energy is not None and wished.energy.on_surface
    attempts: list[Attempt] = []
    failure: InfeasibleError | NotProvedError | None = None
    fairest: Blend | None = None
    for space in _spaces(placed, given, attempts, stages):
        if fairest is not None and space.dimension > MOST_UNKNOWNS:
            attempts.append(Attempt(space.degree, space.dimension, f"not tried: more than {MOST_UNKNOWNS} unknowns"))
            break
        began = time.perf_counter()
        try:
            found = choose(space, wished, attempts, stages, None if fairest is None else fairest.surface)
        except (InfeasibleError, NotProvedError) as error:
            attempts.append(Attempt(space.degree, space.dimension, str(error), time.perf_counter() - began))
            failure = error
            continue
        if not raised:
            return found
        with stages.stage("measure", f" (degree {space.degree})"):
            found = judged(found)
            attempts.append(found.attempts[-1])
            fairest = found if fairest is None or excess(found) < excess(fairest) else fairest
        if not excess(found) or found.surface.degree >= _first_proved(attempts) + DEGREES_FOR_FAIRNESS:
            break
    if fairest is not None:
        return replace(fairest, attempts=tuple(attempts))
    if failure is None and given is not None:
        raise _too_low(attempts[-1], _lowest(placed, given), order)
    raise _given_up(attempts, failure, order)


def check_wanted_degree(degree: Any) -> int | Literal["lowest"] | None:
    """A degree, "lowest" for the lowest that is proved, or None for that at which the surface is fair."""
    if degree is None or (isinstance(degree, str) and degree == "lowest"):
        return cast(Literal["lowest"] | None, degree)
    try:
        return check_degree(degree)
    except TypeError as error:
        raise TypeError(f'{error}; or "lowest", the lowest that is proved') from None


def judged(found: Blend) -> Blend:
    """The same blend with what its last attempt came to in fairness."""
    beyond = found.surface.fairness().beyond(found.limits)
    last = found.attempts[-1]
    words = f"{last.outcome}, not fair: {', '.join(beyond)}" if beyond else f"{last.outcome}, fair"
    return replace(found, attempts=(*found.attempts[:-1], replace(last, outcome=words)))


def excess(found: Blend) -> float:
    """How far beyond its limits of fairness a blend is, in all: 0 within them."""
    return found.surface.fairness().excess(found.limits)


def _first_proved(attempts: Sequence[Attempt]) -> int:
    return next(a.degree for a in attempts if a.outcome.startswith(("proved", "fitted")))


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
