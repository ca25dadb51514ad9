"""From sampled conditions to a proved member: the exchange method, and a descent on the surface itself.

One sheet asks for `grad f . u > 0` where `f = 0`: linear in the member at each point, but the points
move with the surface.  So conditions are asked where the last member's surface failed and the
programme is solved again, until a member is clean on fixed rays: an exchange method for a
semi-infinite programme (Hettich and Kortanek 1993).  By then the surface has left behind many of the
points.  The descent therefore asks the conditions on the surface that was reached and nowhere
else, and goes towards that programme's optimum as far as the surface stays clean; again and again.

Each step follows from the member before it by an optimum that is unique and by comparisons in which no
rounding can decide: no order of points, no witness of a search, no choice among the worst.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pas.algebra.monomials import Floats
from pas.fairing.guard import Guard, Margins, Rows
from pas.fairing.programme import MemberProgramme
from pas.limits import checkpoint

LATTICES = (16, 32, 64)
"""Subdivisions of the outer faces; a finer one is taken where a clean member is not proved."""

ROUNDS = 16
"""Rounds of the exchange before it is given up; successes took 1 to 6."""

CLEAN = 0.5
"""The share of the margins that a clean member reaches everywhere on the lattice: the other half
keeps points between those that were asked for from being asked for in turn, round after round."""

GRAZING = 10.0
"""On its own surface a member is held where it is less steep than so many margins: where it is
steeper one step does not make it graze."""

STEPS, SHORTEST = 8, 1 / 8
"""Steps of the descent, and the share of a step below which it ends."""

ENOUGH = 0.01
"""A step that lowers the objective by a smaller share is the last one."""


@dataclass(frozen=True)
class Stage:
    """A clean member, and rows under which it is the optimum."""

    unknowns: Floats
    rows: Rows


class Exchange:
    """The search for clean members of one programme at one set of margins."""

    def __init__(self, programme: MemberProgramme, guard: Guard, margins: Margins) -> None:
        self.programme, self.guard, self.margins = programme, guard, margins

    def stages(self) -> Iterator[Stage]:
        """Clean members in the order in which to prove them: the fairest of each lattice, then the others.

        Raises `InfeasibleError` where the conditions contradict.
        """
        others: list[Stage] = []
        for subdivisions in LATTICES:
            path = list(Search(self, subdivisions).path())
            if path:
                yield path.pop()
            others = path or others
        yield from reversed(others)


class Search:
    """The search on one lattice."""

    def __init__(self, exchange: Exchange, subdivisions: int) -> None:
        self.programme, self.guard, self.margins = exchange.programme, exchange.guard, exchange.margins
        self.subdivisions = subdivisions
        self.rays = exchange.programme.fairing.rays(subdivisions)
        self.all_edges = self.guard.edges(subdivisions, self.margins)

    def path(self) -> Iterator[Stage]:
        """The clean member that the exchange ends with, and those of the descent from it."""
        settled = self.settled()
        if settled is None:
            return
        first, rounds, edges = settled
        yield first
        if rounds == 1 or not self.programme.quadratic:
            return  # no sheet is asked for that could be left behind, or the objective is no quadratic form
        member = first.unknowns
        rows = edges + self._own(member)
        for _ in range(STEPS):
            step = self._step(member, rows)
            if step is None:
                return
            enough = self.programme.objective(step) >= (1 - ENOUGH) * self.programme.objective(member)
            member, rows = step, edges + self._own(step)
            yield Stage(member, rows + self.programme.slope(member))
            if enough:
                return

    def settled(self) -> tuple[Stage, int, Rows] | None:
        """The exchange: the member, its rounds, and the rows of walls and clip faces; None without end."""
        edges, sheet = self.guard.initial(self.margins), Rows.none(self.guard.basis.size)
        for number in range(1, ROUNDS + 1):
            checkpoint(f"choosing a member of degree {self.guard.basis.degree}")
            member = self.programme.optimum(edges + sheet)
            new_edges, new_sheet = self.failures(member)
            if not len(new_edges) + len(new_sheet):
                return Stage(member, edges + sheet), number, edges
            edges, sheet = edges + new_edges, sheet + new_sheet
        return None

    def _step(self, member: Floats, rows: Rows) -> Floats | None:
        """A clean member between this one and the optimum under the rows, the further the better."""
        checkpoint(f"choosing a member of degree {self.guard.basis.degree}")
        aim, share = self.programme.optimum(rows), 1.0
        while share >= SHORTEST:
            trial: Floats = member + share * (aim - member)
            if not any(map(len, self.failures(trial))):
                return trial
            share /= 2
        return None

    def failures(self, member: Floats) -> tuple[Rows, Rows]:
        """Rows of the walls and clip faces, and of the sheet, that a member misses by too much."""
        unknowns = self.programme.normalised(member)
        crossings = self.rays.crossings(unknowns, self.margins.band * self.guard.reach)
        sheet = self.rays.rows(crossings.below(CLEAN * self.margins.sheet), self.margins.sheet)
        return self.all_edges.missed(unknowns, CLEAN), sheet

    def _own(self, member: Floats) -> Rows:
        """Rows of the sheet on the member's own surface, which it satisfies."""
        crossings = self.rays.crossings(member, self.margins.band * self.guard.reach)
        return self.rays.rows(crossings.below(GRAZING * self.margins.sheet), CLEAN * self.margins.sheet)
