"""The whole method on one screen, `find`: problem -> contacts in place -> space -> fit -> proved surface.

Layouts are tried one after the other, on each the degrees in turn, until a surface is proved and fair.  On a layout the
degree rises from the first with a regular surface.  The first degree that is proved and fair is taken.
Once one is proved, a few more are tried for fairness, and the fairest is kept; one that is too stiff to be fair does
not count as that.  Where none is proved in so many degrees, the next layout is tried.  What was tried is said in the
blend's summary.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, groupby, tee
from typing import Any, Generic, Literal, cast

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree
from pas.blending.place import PartitionLike, placements, with_ends
from pas.blending.regularity import is_regular
from pas.blending.solving import fewest_members, solve
from pas.blending.space import Space
from pas.contacts.contact import ContactLike
from pas.errors import InfeasibleError, NoSolutionError, NotProvedError
from pas.fairing.contradictions import check_wishes
from pas.fairing.prepared import BRIEF, SETTINGS
from pas.fairing.wishes import Wishes
from pas.layouts.planes import has_whole_planes
from pas.partition.boxes import SixTetrahedra
from pas.partition.cells import Partition
from pas.pipeline.chosen import Attempt, B, ChosenBlend, Stages, choose
from pas.pipeline.session import key_of, open_session
from pas.surface.placed import PlacedContacts


@dataclass(frozen=True)
class SearchSettings:
    """How far a search goes."""

    degrees: int
    """Degrees with regular surfaces that are tried on a layout before it is given up, where none of them is proved."""

    above: int
    """Degrees above the first that is proved which are tried for a fair surface; beyond, nothing was gained."""

    fewest: int
    """Spaces of smaller dimension are not tried: there is always a larger one, and none of these was fair."""

    per_order: int = 2
    """The degrees up to so many times the order are tried in any case: products of the contacts' surfaces meet them
    with any order from one low degree on, and of use are others.  Perpendicular pipes have a proved surface of degree
    2k - 2 where the order k is 5, 6 or 7, and at degree 6 such a product."""

    highest: int = HIGHEST_DEGREE
    """Higher degrees are not tried."""

    few: int = 15
    stiff: int = 4
    """Spaces with fewer unknowns, or with fewer for each piece, are stiff, as of GC^1 surfaces of degree 4 around four
    pipes and more: few of them have a fair surface, and the next degree is tried however large."""

    most: int = 170
    """Spaces of larger dimension are not tried for fairness alone: they take many seconds.  Those of GC^2 and degree 7
    on fans around three and four contacts have 168 and 164, take 3 to 15, and are fair where those of degree 6 are not;
    with the 195 around five, a hard node took three times as long."""

    narrow: float = 0.25
    further: float = 4.0
    """What is beyond limits by less than the first, in units of the measures, is settled once more under limits that
    lie so many times as far inside: the limits are soft on the way, and give a little."""

    def is_stiff(self, space: Space) -> bool:
        """Whether a space has few unknowns for its pieces."""
        return space.dimension < max(self.few, self.stiff * len(space.partition.pieces))


GIVEN = SearchSettings(degrees=4, above=2, fewest=1)
"""On one partition; corners of order up to 4 needed at most three degrees."""

CORNER = replace(GIVEN, above=1, fewest=12)
"""On six tetrahedra that the program chose, within the usual limits of fairness, before all."""

CHOSEN = SearchSettings(degrees=2, above=2, fewest=15)
"""On layouts that the program chose, of which the first that has a proved surface is kept: more half-planes made no
shape fairer that another degree did not."""

PLANES = replace(CHOSEN, highest=7)
"""On full planes, 32 pieces of which take minutes to solve at degree 8."""

ORBIT = replace(PLANES, fewest=1)
"""On full planes after that, which are not given up for few unknowns: they have no more, and few of them are fair."""


@dataclass
class Search(Generic[B]):
    """What was tried.

    `blends` is the class of what is found; `degree` is the only one to try, or None; `order` that of
    contact; `raised` says whether degrees are tried for fairness too.
    """

    blends: type[B]
    wishes: Wishes
    degree: int | None
    order: int
    raised: bool
    stages: Stages
    attempts: list[Attempt] = field(default_factory=list)
    failure: InfeasibleError | NotProvedError | None = None

    def on_layout(self, regions: Iterable[PlacedContacts], settings: SearchSettings) -> B | None:
        """The fairest blend that was found on one layout, of which `regions` are regions; None where none was.

        Each degree is tried on one region after the other, and where a surface was found on that one from then on.
        """
        best: B | None = None
        tried, highest, counts = 0, settings.highest, False
        for degree in range(1, HIGHEST_DEGREE + 1) if self.degree is None else [check_degree(self.degree)]:
            enough = best is None and tried >= settings.degrees and degree > settings.per_order * self.order
            if degree > highest or enough:
                break
            tried += 1
            regions, here = tee(regions)
            for number, placed in enumerate(here):
                fewest = fewest_members(placed, degree) if counts else 0
                space = self._space(placed, degree, settings) if fewest <= settings.most else None
                dimension = fewest if space is None else space.dimension
                if counts and dimension > settings.most:
                    outcome = f"not tried: more than {settings.most} unknowns"
                    self.attempts.append(Attempt(degree, dimension, outcome, partition=placed.partition.title))
                    return self._with_attempts(best)
                if space is None:  # which spaces are of use does not hang on the region
                    tried -= not number
                    break
                found = self._fitted(space, settings)
                if found is None:
                    continue
                if not self.raised:
                    return self._with_attempts(found)
                best = found if best is None or excess(found) < excess(best) else best
                highest = min(highest, degree + settings.above)
                counts |= not settings.is_stiff(space)
                regions = [placed]
                break
            if best is not None and not excess(best):
                break
        return self._with_attempts(best)

    def _space(self, placed: PlacedContacts, degree: int, settings: SearchSettings) -> Space | None:
        """The solution space, where it has regular members and unknowns enough; else that is noted."""
        with self.stages.stage("solve", 0.01, f" (degree {degree})"):
            space = solve(placed, degree)
            small = 0 < space.dimension < settings.fewest
            if not small and is_regular(space):
                return space
        if space.dimension == 0:
            self._note(space, "no solution")
        else:
            reason = f"not tried: fewer than {settings.fewest} unknowns"
            self._note(space, reason if small else "all members have alpha = 0 on a contact curve")
        return None

    def _fitted(self, space: Space, settings: SearchSettings) -> B | None:
        """The blend of a space, measured where that is of use; None where none is proved."""
        began = time.perf_counter()
        try:
            how = BRIEF if self.raised and settings.is_stiff(space) else SETTINGS
            found = choose(self.blends, space, self.wishes, self.stages, how)
        except (InfeasibleError, NotProvedError) as error:
            self._note(space, str(error), time.perf_counter() - began)
            self.failure = error
            return None
        outcome = found.attempts[-1].outcome
        if self.raised:
            with self.stages.stage("measure", 0.4, f" (degree {space.degree})"):
                narrow = 0 < excess(found) < settings.narrow and space.dimension >= settings.few
            found = self._fitted_stricter(space, found, settings.further) if narrow else found
            beyond = found.surface.fairness().beyond(found.limits)
            outcome += f", not fair: {', '.join(beyond)}" if beyond else ", fair"
        self.attempts.append(replace(found.attempts[-1], outcome=outcome))
        return found

    def _fitted_stricter(self, space: Space, found: B, further: float) -> B:
        """The surface fitted once more under stricter limits, where that makes it fairer."""
        inner = found.surface.fairness().inside(found.limits, further)
        try:
            moved = choose(self.blends, space, self.wishes.changed(limits=inner), self.stages)
        except (InfeasibleError, NotProvedError):
            return found
        moved = replace(moved, wishes=found.wishes)
        return moved if excess(moved) < excess(found) else found

    def _with_attempts(self, found: B | None) -> B | None:
        return found and replace(found, attempts=tuple(self.attempts))

    def _note(self, space: Space, outcome: str, seconds: float = 0.0) -> None:
        self.attempts.append(Attempt(space.degree, space.dimension, outcome, seconds, space.partition.title))


def find(
    blends: type[B],
    contacts: Sequence[ContactLike],
    order: int,
    degree: int | Literal["lowest"] | None,
    partition: PartitionLike | None,
    wished: Wishes,
    stages: Stages,
) -> B:
    """The blend of contacts by wishes, as one of that class: the arguments and errors of `pas.blend`."""
    wanted = check_wanted_degree(degree)
    given = None if wanted is None or wanted == "lowest" else wanted
    if wished.basis is not None and given is None:
        raise ValueError("a basis needs the degree of its members: give degree as well")
    ended = with_ends(contacts, order, partition)
    key = key_of(wished, order, wanted, partition) if isinstance(partition, str | None) else None
    session = None if key is None else open_session()
    if session is not None:
        with stages.stage("repeated", 0.9):
            known = session.find([item.contact for item in ended], key)
        if known is not None:
            return known.blend(blends, stages.seconds)
    with stages.stage("partition", 0.03):
        candidates = placements(ended, order, partition)
        placed = next(candidates)
        check_wishes(wished, placed)
        wished = wished.settled(placed)
    if order == 0 and len(placed.partition.pieces) > 1:
        raise ValueError(
            "order must be at least 1 where the region has several pieces: with order 0 they would meet in creases"
        )
    raised = degree is None and wished.energy is not None and wished.energy.on_surface
    search = Search(blends, wished, given, order, raised, stages)
    corner = isinstance(placed.partition, SixTetrahedra)
    free = raised and not isinstance(partition, Partition)
    several = free and not corner
    ways = [CHOSEN] if several else [CORNER, GIVEN] if free and wished.limits is None else [GIVEN]

    def layout_of(place: PlacedContacts) -> Any:
        return place.partition.layout if several else place

    for layout, regions in groupby(chain([placed], candidates), layout_of):
        here = [PLANES, ORBIT] if several and layout is not None and has_whole_planes(layout) else ways
        each = zip(tee(regions, len(here)), here, strict=True)
        found = next(filter(None, (search.on_layout(here, settings) for here, settings in each)), None)
        if found is not None:
            if session is not None:
                session.keep(found, key)
            return found
    if search.failure is None and given is not None:
        above = range(given + 1, HIGHEST_DEGREE + 1)
        lowest = next((n for n in above if is_regular(solve(placed, n))), None)
        raise _too_low(search.attempts[-1], lowest, order)
    raise _given_up(search, order)


def excess(found: ChosenBlend) -> float:
    """The sum of a blend's excesses over its limits of fairness: 0 within them."""
    return found.surface.fairness().excess(found.limits)


def check_wanted_degree(degree: Any) -> int | Literal["lowest"] | None:
    """A degree, "lowest" for the lowest that is proved, or None for that at which the surface is fair."""
    if degree is None or (isinstance(degree, str) and degree == "lowest"):
        return cast(Literal["lowest"] | None, degree)
    try:
        return check_degree(degree)
    except TypeError as error:
        raise TypeError(f'{error}; or "lowest", the lowest that is proved') from None


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


def _given_up(search: Search[Any], order: int) -> Exception:
    attempts, failure = search.attempts, search.failure
    ended = ""
    if search.degree is None:
        last = max(a.degree for a in attempts)
        beyond = f"degree={last + 1} goes on" if last < HIGHEST_DEGREE else "the highest there is"
        ended = f"; the search ended at degree {last} ({beyond})"
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
