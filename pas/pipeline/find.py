"""The whole method on one screen: problem -> contacts in place -> space -> fit -> proved surface.

`find` raises the degree until a member of the solution space passes every proof and is fair, and goes on to other
layouts where that fails; what was tried is said in the blend's summary.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, groupby, tee
from typing import Any, Literal, cast

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree
from pas.blending.place import PartitionLike, ended, places
from pas.blending.regularity import is_regular
from pas.blending.solving import solve
from pas.contacts.contact import ContactLike, as_contact
from pas.errors import InfeasibleError, NoSolutionError, NotProvedError
from pas.fairing.contradictions import check_wishes
from pas.fairing.wishes import Wishes
from pas.partition.cells import Partition
from pas.partition.six_tetrahedra import SixTetrahedra
from pas.pipeline.chosen import Attempt, B, FitSpace
from pas.pipeline.search import CHOSEN, CORNER, GIVEN, Search
from pas.pipeline.session import key_of, open_session
from pas.pipeline.stages import Stages
from pas.surface.placed import PlacedContacts


def find(
    spaces: type[FitSpace[B]],
    contacts: Sequence[ContactLike],
    order: int,
    degree: int | Literal["lowest"] | None,
    partition: PartitionLike | None,
    wished: Wishes,
    stages: Stages,
) -> B:
    """The blend of contacts by wishes, chosen from spaces of that class; the arguments and errors of `pas.blend`."""
    wanted = check_wanted_degree(degree)
    given = None if wanted is None or wanted == "lowest" else wanted
    if wished.basis is not None and given is None:
        raise ValueError("a basis needs the degree of its members: give degree as well")
    contacts = ended(contacts, order, partition)
    key = key_of(wished, order, wanted, partition) if isinstance(partition, str | None) else None
    session = None if key is None else open_session()
    if session is not None:
        with stages.stage("repeated"):
            known = session.find([as_contact(item, f"contacts[{i}]") for i, item in enumerate(contacts)], key)
        if known is not None:
            return known.blend(spaces, stages.seconds)
    with stages.stage("partition"):
        candidates = places(contacts, order, partition)
        placed = next(candidates)
        check_wishes(wished, placed)
        wished = wished.settled(placed)
    if order == 0 and len(placed.partition.pieces) > 1:
        raise ValueError(
            "order must be at least 1 where the region has several pieces: with order 0 they would meet in creases"
        )
    raised = degree is None and wished.energy is not None and wished.energy.on_surface
    search = Search(spaces, wished, given, order, raised, stages)
    corner = isinstance(placed.partition, SixTetrahedra)
    free = raised and not isinstance(partition, Partition)
    several = free and not corner
    ways = [CHOSEN] if several else [CORNER, GIVEN] if free and wished.limits is None else [GIVEN]

    def layout_of(place: PlacedContacts) -> Any:
        return place.partition.layout if several else place

    for _, regions in groupby(chain([placed], candidates), layout_of):
        each = zip(tee(regions, len(ways)), ways, strict=True)
        found = next(filter(None, (search.on_layout(here, settings) for here, settings in each)), None)
        if found is not None:
            if session is not None:
                session.keep(found, key)
            return found
    if search.failure is None and given is not None:
        raise _too_low(search.attempts[-1], _lowest(placed, given), order)
    raise _given_up(search, order)


def check_wanted_degree(degree: Any) -> int | Literal["lowest"] | None:
    """A degree, "lowest" for the lowest that is proved, or None for that at which the surface is fair."""
    if degree is None or (isinstance(degree, str) and degree == "lowest"):
        return cast(Literal["lowest"] | None, degree)
    try:
        return check_degree(degree)
    except TypeError as error:
        raise TypeError(f'{error}; or "lowest", the lowest that is proved') from None


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


def _tried(attempts: Sequence[Attempt]) -> str:
    """The degrees that were tried with their dimensions, on each partition; those without any surface, the first, as
    one."""
    found = []
    for title in dict.fromkeys(a.partition for a in attempts):
        here = {a.degree: a.dimension for a in attempts if a.partition == title}
        empty = [n for n, m in here.items() if not m]
        words = [f"degree{f's {empty[0]} to' if len(empty) > 1 else ''} {empty[-1]}: dimension 0"] if empty else []
        words += [f"degree {n}: dimension {m}" for n, m in here.items() if m]
        found.append(f"{title} ({', '.join(words)})")
    return "; ".join(found)


def _ended(attempts: Sequence[Attempt]) -> str:
    """Where a search through several degrees ended."""
    last = max(a.degree for a in attempts)
    beyond = f"degree={last + 1} goes on" if last < HIGHEST_DEGREE else "the highest there is"
    return f"the search ended at degree {last} ({beyond})"


def _given_up(search: Search[Any], order: int) -> Exception:
    attempts, failure = search.attempts, search.failure
    ended = f"; {_ended(attempts)}" if search.degree is None else ""
    tried = f"tried: {_tried(attempts)}"
    if failure is None:
        return NoSolutionError(
            f"no usable surface meets the contacts with GC^{order}{ended}; {tried}",
            {a.degree: a.dimension for a in attempts},
        )
    text = f"{failure}{ended}; {tried}"
    if isinstance(failure, NotProvedError):
        return NotProvedError(text, failure.blend)
    return InfeasibleError(text, failure.conflict)
