"""The choice by an energy of the surface: from a clean member down its landscape to a proved one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pas.algebra.monomials import Floats, monomial_values
from pas.errors import InfeasibleError
from pas.fairing.basis import WorkingBasis
from pas.fairing.exchange import Exchange, Search
from pas.fairing.guard import LADDER, Margins, Rows
from pas.fairing.programme import MemberProgramme
from pas.fairing.settling import DAMPING, STEPS, Settling, State, Steep
from pas.fairing.wishes import Wishes
from pas.piecewise import PiecewiseSurface

if TYPE_CHECKING:
    from pas.fairing.fairing import Choice, Fairing

LATTICES = (32, 64)
"""Subdivisions of the outer faces on whose rays members are to be clean; the finer where one is not proved."""

CLOSER_LOOKS = 3
"""Times that a surface is looked at between the rays, and settled again where its curvature is hidden there."""

GAIN = 0.5
"""A closer look that leaves more than this share of what is beyond the limits, and more than the energy, is the last:
where limits cannot be met it only weighs them more."""

NOT_FAIR = 0.1
"""Where the first way down ends with more than this share of the energy beyond limits, none of forty corners became
fair at that degree; those that did had 0.05 at most."""

_LAST: list[tuple[WorkingBasis, tuple[Wishes, Margins, int, bytes | None], Steep]] = []
"""The last steep part of a way down, with what it was asked for; no more, as it takes up to twenty megabytes."""


class BeyondLimitsError(Exception):
    """The first way down ended beyond the limits of fairness."""


class FairSearch:
    """The search for the fair member of one space under the user's wishes.

    One that is not `patient` ends with `BeyondLimitsError` where the first way down ends beyond the limits.
    """

    def __init__(
        self, fairing: Fairing, wishes: Wishes, start: PiecewiseSurface | None = None, patient: bool = True
    ) -> None:
        self.patient = patient
        self.fairing, self.wishes = fairing, wishes
        self.programme = MemberProgramme(fairing, wishes)
        self.limits = wishes.limits_at(fairing.placed)
        self.start = None if start is None else coordinates(fairing, start)

    def choice(self) -> Choice | None:
        """The fairest member found, proved where that is wished for; None where none can be seen from the centre.

        Raises `InfeasibleError` where no margins can be met.
        """
        failure: InfeasibleError | None = None
        for margins in LADDER:
            try:
                found = self._at(margins)
            except InfeasibleError as error:
                failure = error
                continue
            if found is not None:
                return found
        if failure is not None:
            raise failure
        return None

    def _at(self, margins: Margins) -> Choice | None:
        """The fairest member that keeps these margins."""
        best: Choice | None = None
        state: State | None = None
        for subdivisions in LATTICES:
            search = Search(Exchange(self.programme, self.fairing.guard, margins), subdivisions)
            states = self._down(search) if state is None else [state, *Settling(search).steps(state)]
            if not states:
                continue
            if not self.patient and states[-1].look.beyond > NOT_FAIR * states[-1].look.energy:
                raise BeyondLimitsError("settled beyond the limits of fairness")
            for _ in range(CLOSER_LOOKS):
                closer = states[-1].landscape.closer(states[-1].look)
                if closer is None:
                    break
                states.append(State(*closer, states[-1].rows))
                before = states[-1].look.beyond
                states += Settling(search).steps(states[-1])
                if states[-1].look.beyond > max(GAIN * before, states[-1].look.energy):
                    break
            found = self._furthest(states, margins)
            if found is not None and (best is None or found[0].energy <= best.energy):
                best, state = found[0], replace(found[1], damping=DAMPING)  # among other rows, begun anew
            if found is not None and found[1] is states[-1]:
                return best
        return best

    def _down(self, search: Search) -> list[State]:
        """All the way down, with its beginning; empty where no member is seen.

        Its steep part is that of the energy's `outset`; and it is that without points and handles, where these can be
        met by one step from its end, so that the rest is short.
        """
        energy, settling = self.fairing.energy, Settling(search)
        if self.start is None and self.wishes != self.wishes.plain:
            steep, _ = self._steep(search, self.wishes.plain)
            states = settling.met(steep[-1].under(energy)) if steep else []
            if len(states) > 1:
                return states
        steep, ended = self._steep(search, self.wishes)
        states = [state.under(energy) for state in steep]
        if not states or (ended and energy == energy.outset):
            return states
        return [*states, *settling.steps(states[-1], STEPS + 1 - len(states))]

    def _steep(self, search: Search, wishes: Wishes) -> Steep:
        """The first part of the way under some wishes, by the energy's `outset`; the last one asked for is kept."""
        fairing = self.fairing.of(self.fairing.energy.outset)
        start = None if self.start is None else self.start.tobytes()
        wishes = wishes.changed(energy=fairing.energy, limits=self.limits, prove=True)
        asked = wishes, search.margins, search.subdivisions, start
        for basis, before, found in _LAST:
            if basis is fairing.basis and before == asked:
                return found
        own = Search(Exchange(MemberProgramme(fairing, wishes), fairing.guard, search.margins), search.subdivisions)
        found = (), True
        for member, rows in self._starts(own):
            landscape = fairing.landscape(self.limits, member)
            if landscape.first is not None:  # where the way begins
                found = Settling(own).steep(State(landscape, landscape.first, rows))
                break
        _LAST[:] = [(fairing.basis, asked, found)]
        return found

    def _starts(self, search: Search) -> Iterator[tuple[Floats, Rows]]:
        if self.start is not None:
            yield self.start, search.guard.initial(search.margins)
        for stage in search.path():
            yield stage.unknowns, stage.rows

    def _furthest(self, states: list[State], margins: Margins) -> tuple[Choice, State] | None:
        """The member furthest down the way that is proved or need not be, by longer and longer steps back from its end
        and halving the last one.

        Where one is not proved its neighbours mostly are not: to go back through all of them took longer than the way.
        """
        back, failed = 0, -1
        found = self._proved(states[-1], margins)
        while found is None and back < len(states) - 1:
            back, failed = min(2 * back + 1, len(states) - 1), back
            found = self._proved(states[-1 - back], margins)
        while found is not None and back - failed > 1:
            middle = (back + failed) // 2
            nearer = self._proved(states[-1 - middle], margins)
            if nearer is None:
                failed = middle
            else:
                found, back = nearer, middle
        return found

    def _proved(self, state: State, margins: Margins) -> tuple[Choice, State] | None:
        """The member of a state, if it is proved or need not be."""
        try:
            found = self.fairing.chosen(self.programme, state, margins)
        except InfeasibleError:
            return None
        return (found, state) if not self.wishes.prove or found.surface.certificate.proved else None


def coordinates(fairing: Fairing, surface: PiecewiseSurface) -> Floats:
    """The working coefficients (m,) of the member nearest to a surface of no higher degree, normalised."""
    left, right = [], []
    for piece, points, weights in fairing.basis.quadrature(2 * fairing.degree):
        root = np.sqrt(weights)
        column = surface.scaled.polynomials[piece].dense(surface.degree)
        left.append(fairing.basis.values(piece, points) * root[:, None])
        right.append(column @ monomial_values(points, surface.degree) * root)
    member = np.linalg.lstsq(np.concatenate(left), np.concatenate(right), rcond=None)[0]
    return np.asarray(member / float(fairing.guard.mean_alpha @ member))
