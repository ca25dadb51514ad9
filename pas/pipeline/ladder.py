"""The ladder: layouts one after the other, on each the degrees, until a surface is proved and fair."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree
from pas.blending.solving import solve
from pas.errors import InfeasibleError, NotProvedError
from pas.fairing.fair import BeyondLimitsError
from pas.fairing.wishes import Wishes
from pas.pipeline.fit import choose
from pas.pipeline.result import Attempt, Blend
from pas.pipeline.space import SolutionSpace
from pas.pipeline.stages import Stages
from pas.surface.placed import PlacedContacts

DEGREES_TRIED, DEGREES_ON_LAYOUTS_TRIED = 4, 2
"""Degrees with regular members that are tried before giving up, and on layouts that the program chose, before the next
one, but see `DEGREES_PER_ORDER`; corners of order up to 4 needed at most three."""

DEGREES_PER_ORDER = 2
"""The degree up to which they are tried in any case is so many times the order: products of the contacts' surfaces
meet them with any order from one low degree on, and of use are others.  Perpendicular pipes have a proved surface of
degree 2k - 2 where the order k is 5, 6 or 7, and at degree 6 such a product."""

DEGREES_FOR_FAIRNESS = 2
"""Degrees above the first that is proved which are tried for a fair surface; beyond, nothing was gained."""

FEWEST_UNKNOWNS, MOST_UNKNOWNS = 15, 160
"""Spaces of smaller dimension are not tried on layouts that the program chose: there is always a larger one, and
none of these was fair.  Elsewhere they are put aside where the first way down does not end at a fair surface.  Spaces
of larger dimension are not tried for fairness alone: they take many seconds."""

STIFF = 4
"""Spaces with fewer unknowns for each piece are put aside in the same way on layouts that the program chose: GC^1
surfaces of degree 4 around four pipes and more, few of which are fair."""

MANY_PIECES = 20
"""Pieces, as strips have, on which no further degree is tried for fairness: its space has hundreds of dimensions."""

WORTH_WHILE = 0.5
"""A degree that leaves more than this share of what is beyond the limits is the last on layouts that the program
chose: where a fillet has no room, no degree makes it fair."""

NEARLY, FURTHER = 0.25, 4.0
"""What is beyond limits by less than this, in units of the measures, is settled once more under limits that lie so many
times as far inside: the limits are soft on the way, and give a little.  Small spaces are too stiff for it: the next
degree is smoother all over."""

DEGREES_ON_LAYOUTS = 1
"""The same on layouts that the program chose, of which the first that has a proved surface is kept: more half-planes
made no shape fairer that another degree did not."""


class Replay:
    """What an iterator has, to be gone through as often as one likes, each thing fetched when it is first needed."""

    def __init__(self, source: Iterable[PlacedContacts]) -> None:
        self._known: list[PlacedContacts] = []
        self._source = iter(source)

    def __iter__(self) -> Iterator[PlacedContacts]:
        yield from self._known
        for place in self._source:
            self._known.append(place)
            yield place


@dataclass
class Ladder:
    """What was tried.

    `degree` is the only one to try, or None; `order` that of contact; `raised` says whether degrees and layouts are
    tried for fairness too; `aside` are small spaces of the present layout, by their degrees, in which no fair surface
    was in sight.
    """

    wishes: Wishes
    degree: int | None
    order: int
    raised: bool
    stages: Stages
    attempts: list[Attempt] = field(default_factory=list)
    aside: dict[int, SolutionSpace] = field(default_factory=dict)
    failure: InfeasibleError | NotProvedError | None = None

    def climb(self, places: Iterable[PlacedContacts], fewest: int = 0) -> Blend | None:
        """The fairest blend that was found on one layout, of which `places` are regions; None where none was.

        Each degree is tried on one region after the other.  Spaces of fewer than `fewest` unknowns are left out.
        """
        below: Blend | None = None  # the fairest on this layout
        home: PlacedContacts | None = None  # its region
        self.aside = {}
        first = 0
        for space in self._spaces(Replay(places), fewest):
            if home is not None and space.placed is not home:
                continue
            if below is not None and space.dimension > MOST_UNKNOWNS:
                self._note(space, f"not tried: more than {MOST_UNKNOWNS} unknowns")
                break
            began = time.perf_counter()
            stiff = fewest and space.dimension < STIFF * len(space.partition.pieces)
            patient = not self.raised or not (stiff or space.dimension < FEWEST_UNKNOWNS)
            try:
                # around a node the fair surface of a higher degree is often not near that of a lower one
                start = None if below is None or fewest else below.surface
                found = choose(space, self.wishes, self.attempts, self.stages, start, patient)
            except BeyondLimitsError as error:
                self._note(space, f"{error}, a higher degree comes first", time.perf_counter() - began)
                first = first or space.degree
                self.aside[space.degree] = space
                continue
            except (InfeasibleError, NotProvedError) as error:
                self._note(space, str(error), time.perf_counter() - began)
                self.failure = error
                continue
            if not self.raised:
                return found
            home = space.placed
            with self.stages.stage("measure", f" (degree {space.degree})"):
                found = judged(found)
                nearly = 0 < excess(found) < NEARLY and space.dimension >= FEWEST_UNKNOWNS
            if nearly:
                found = self._pressed(space, found)
            self.attempts.append(found.attempts[-1])
            hopeless = fewest and below is not None and excess(found) > WORTH_WHILE * excess(below)
            below = found if below is None or excess(found) < excess(below) else below
            first = first or space.degree
            more = 0 if len(space.partition.pieces) > MANY_PIECES else DEGREES_ON_LAYOUTS
            highest = first + (more if fewest else DEGREES_FOR_FAIRNESS)
            if not excess(found) or hopeless or found.surface.degree >= highest:
                break
        if below is None:
            below = self._patiently()
        return below and replace(below, attempts=tuple(self.attempts))

    def _pressed(self, space: SolutionSpace, found: Blend) -> Blend:
        """The surface settled once more under limits further inside, where that makes it fairer."""
        inner = found.surface.fairness().inside(found.limits, FURTHER)
        try:
            moved = choose(space, self.wishes.changed(limits=inner), self.attempts, self.stages, found.surface)
        except (InfeasibleError, NotProvedError):
            return found
        last = moved.attempts[-1]
        attempt = replace(last, seconds=last.seconds + found.attempts[-1].seconds)
        moved = judged(replace(moved, wishes=found.wishes, attempts=(*moved.attempts[:-1], attempt)))
        return moved if excess(moved) < excess(found) else found

    def _patiently(self) -> Blend | None:
        """What small spaces have to give where no higher degree had anything."""
        for space in self.aside.values():
            try:
                found = judged(choose(space, self.wishes, self.attempts, self.stages))
            except (InfeasibleError, NotProvedError) as error:
                self.failure = error
            else:
                self.attempts.append(found.attempts[-1])
                return found
        return None

    def _spaces(self, places: Iterable[PlacedContacts], fewest: int) -> Iterator[SolutionSpace]:
        """Solution spaces with regular members, of rising degree, each on all regions; others are noted as attempts.

        Which spaces are of use does not hang on the region.
        """
        degrees = range(1, HIGHEST_DEGREE + 1) if self.degree is None else [check_degree(self.degree)]
        yielded = 0
        for candidate in degrees:
            for number, placed in enumerate(places):
                with self.stages.stage("solve", f" (degree {candidate})"):
                    space = SolutionSpace.of(solve(placed, candidate))
                    small = 0 < space.dimension < fewest
                    usable = not small and space.regular
                if usable:
                    yield space
                    yielded += not number
                    if candidate in self.aside:
                        break
                    continue
                if space.dimension == 0:
                    self._note(space, "no solution")
                else:
                    reason = f"not tried: fewer than {fewest} unknowns"
                    self._note(space, reason if small else "all members have alpha = 0 on a contact curve")
                break
            enough = DEGREES_ON_LAYOUTS_TRIED if fewest else DEGREES_TRIED
            if yielded >= enough and candidate >= DEGREES_PER_ORDER * self.order:
                return

    def _note(self, space: SolutionSpace, outcome: str, seconds: float = 0.0) -> None:
        self.attempts.append(Attempt(space.degree, space.dimension, outcome, seconds, space.partition.title))


def judged(found: Blend) -> Blend:
    """The same blend with what its last attempt came to in fairness."""
    beyond = found.surface.fairness().beyond(found.limits)
    last = found.attempts[-1]
    words = f"{last.outcome}, not fair: {', '.join(beyond)}" if beyond else f"{last.outcome}, fair"
    return replace(found, attempts=(*found.attempts[:-1], replace(last, outcome=words)))


def excess(found: Blend) -> float:
    """How far beyond its limits of fairness a blend is, in all: 0 within them."""
    return found.surface.fairness().excess(found.limits)
