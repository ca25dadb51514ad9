"""From a clean member to the fair one: Gauss-Newton steps on the surface, each a quadratic programme.

Each step minimises `|r + J dq|^2 + mu |dq|^2` (Levenberg 1944, Marquardt 1963) under the normalisation, the user's
points and the guard rows; a member that is not clean on the fixed rays adds rows, as in `pas.fairing.exchange`,
and the step is solved again.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats
from pas.fairing.exchange import Search
from pas.fairing.guard import Rows
from pas.fairing.landscape import Landscape, Look
from pas.limits import checkpoint

STEPS, TRIES, CUTS = 24, 16, 8
"""Steps until it is given up; trials of one step, and how many of these may add rows."""

DAMPING, LEAST_DAMPING, SLOWER, FASTER = 1e-4, 1e-9, 8.0, 6.0
"""The first damping, the least, over the mean of the programme's diagonal, and how it grows and shrinks."""

ENOUGH, NOISE = 3e-4, 1e-7
"""A step that lowers the objective by a smaller share is the last one; by less than the other, it is none."""

SHORTEST = 1 / 16
"""The shortest part of a step that is gone."""

FAR_BEYOND, HOPELESS = 3.0, 0.03
"""Where what is beyond the limits is more than so many times the energy, limits are not met: a step that lowers the
objective by this share is then the last."""


@dataclass(frozen=True)
class State:
    """A member as it is seen in a landscape, and the guard rows under which it was found."""

    landscape: Landscape
    look: Look
    rows: Rows

    @property
    def member(self) -> Floats:
        """The working coefficients."""
        return self.look.view.member


class Settling:
    """The way down landscapes under the conditions of a search.

    A `live` one, of single steps for sliders, goes a part of a step where rows that it adds leave no way down: they are
    asked with a margin that the member itself has not, so that the surface would stay where it is, after all trials.
    """

    def __init__(self, search: Search, live: bool = False) -> None:
        self.search, self.programme, self.live = search, search.programme, live

    def steps(self, state: State, number: int = STEPS) -> Iterator[State]:
        """Clean members of less and less energy, until one is as good as settled."""
        damping = DAMPING
        for _ in range(number):
            checkpoint("making the surface fair")
            new, damping = self._step(state, damping)
            if new is None:
                return
            enough = HOPELESS if new.look.beyond > FAR_BEYOND * new.look.energy else ENOUGH
            done = self._objective(new.look) > (1 - enough) * self._objective(state.look)
            state = new
            yield state
            if done:
                return
            damping = max(damping / FASTER, LEAST_DAMPING)

    def forced(self, state: State) -> State | None:
        """A step to where the programme's conditions hold, whatever the energy there; None where none is seen."""
        normal, slope = self._linearised(state)
        damping = DAMPING
        for _ in range(TRIES):
            matrix = normal + damping * np.trace(normal) / len(normal) * np.eye(len(normal))
            new = self.programme.step(matrix, slope - matrix @ state.member, state.rows)
            if new is None:
                return None
            look = state.landscape.look(new, state.look)
            if look is not None:
                return State(state.landscape, look, state.rows)
            damping *= SLOWER
        return None

    def _objective(self, look: Look) -> float:
        q = look.view.member
        return look.objective + float(q @ self.programme.quadratic_part @ q) / 2

    def _linearised(self, state: State) -> tuple[Floats, Floats]:
        """The matrix `J^T J` and the slope `J^T r` of half of the objective at a state."""
        normal, slope = state.landscape.linearised(state.look)
        half = self.programme.quadratic_part / 2
        return normal + half, slope + half @ state.member

    def _step(self, state: State, damping: float) -> tuple[State | None, float]:
        normal, slope = self._linearised(state)
        size = np.trace(normal) / len(normal)
        rows, cuts, aim = state.rows, 0, state.member
        most = (1 - NOISE) * self._objective(state.look)
        for _ in range(TRIES):
            matrix = normal + damping * size * np.eye(len(normal))
            new = self.programme.step(matrix, slope - matrix @ state.member, rows)
            look = None if new is None else state.landscape.look(new, state.look)
            if new is None or look is None or not self._objective(look) < most:
                if cuts and self.live:
                    return self._part(state, aim, most), damping
                damping *= SLOWER
                continue
            edges, sheet = self.search.failures(new)
            if not len(edges) + len(sheet):
                return State(state.landscape, look, rows), damping
            aim = new
            rows, cuts = rows + edges + sheet, cuts + 1
            if cuts > 2:
                damping *= SLOWER / 2
            if cuts == CUTS:
                break
        return None, damping

    def _part(self, state: State, aim: Floats, most: float) -> State | None:
        """The longest part of the way to a member of less energy on which all are clean; None where there is none."""
        share = 0.5
        while share >= SHORTEST:
            trial = state.member + share * (aim - state.member)
            look = state.landscape.look(trial, state.look)
            if look is not None and self._objective(look) < most and not any(map(len, self.search.failures(trial))):
                return State(state.landscape, look, state.rows)
            share /= 2
        return None
