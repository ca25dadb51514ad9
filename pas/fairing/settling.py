"""From a clean member to the fair one: Gauss-Newton steps on the surface, each a quadratic programme.

Each step minimises `|r + J dq|^2 + mu |dq|^2` (Levenberg 1944, Marquardt 1963) under the normalisation, the user's
points and the guard rows; a member that is not clean on the fixed rays adds rows, as in `pas.fairing.exchange`,
and the step is solved again.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from pas.algebra.monomials import Floats
from pas.fairing.energy import Energy
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

STEEP = 0.1
"""Up to the first step that lowers the objective by a smaller share, the way down is steep: of 12 and 14 steps around a
corner of degree 6 and 5 these are the first 7 and 10, which hardly know the tension."""

LOSS = 1e-2
"""The share of the objective that a live step may lose to rows that it adds: they ask for a margin that the member
itself has not, so that it would stay where it is, after all trials."""

FAR_BEYOND, HOPELESS = 3.0, 0.03
"""Where what is beyond the limits is more than so many times the energy, limits are not met: a step that lowers the
objective by this share is then the last."""


@dataclass(frozen=True)
class State:
    """A member as it is seen in a landscape, the guard rows under which it was found, and the damping to go on with."""

    landscape: Landscape
    look: Look
    rows: Rows
    damping: float = DAMPING

    @property
    def member(self) -> Floats:
        """The working coefficients."""
        return self.look.view.member

    def under(self, energy: Energy) -> State:
        """The same member in the landscape of another energy."""
        landscape, look = self.landscape.of(energy, self.look)
        return replace(self, landscape=landscape, look=look)


Steep = tuple[tuple[State, ...], bool]
"""The first part of a way down, with its beginning, and whether it is all of the way."""


class Settling:
    """The way down landscapes under the conditions of a search; `live` ones take single steps for sliders."""

    def __init__(self, search: Search, live: bool = False) -> None:
        self.search, self.programme = search, search.programme
        self.loss = 1 + LOSS if live else 0.0

    def steps(self, state: State, number: int = STEPS) -> Iterator[State]:
        """Clean members of less and less energy, until one is as good as settled."""
        for _ in range(number):
            checkpoint("making the surface fair")
            new = self._step(state)
            if new is None:
                return
            before, state = state, new
            yield state
            if self._settled(before, state):
                return

    def steep(self, state: State) -> Steep:
        """The way from a state up to a step that does not lower the objective by much."""
        states = [state]
        for new in self.steps(state):
            states.append(new)
            if self._lowers_less(STEEP, *states[-2:]) and not self._settled(*states[-2:]):
                return tuple(states), False
        return tuple(states), True

    def met(self, state: State) -> list[State]:
        """The way down from where the programme's conditions hold, one step from a state, with that; empty where none
        is seen."""
        first = state if self.programme.holds(state.member) else self.forced(state)
        return [] if first is None else [first, *self.steps(first)]

    def _settled(self, before: State, after: State) -> bool:
        enough = HOPELESS if after.look.beyond > FAR_BEYOND * after.look.energy else ENOUGH
        return self._lowers_less(enough, before, after)

    def _lowers_less(self, share: float, before: State, after: State) -> bool:
        return self._objective(after.look) > (1 - share) * self._objective(before.look)

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

    def _step(self, state: State) -> State | None:
        normal, slope = self._linearised(state)
        size = np.trace(normal) / len(normal)
        rows, damping, cuts = state.rows, state.damping, 0
        most = (1 - NOISE) * self._objective(state.look)
        for _ in range(TRIES):
            matrix = normal + damping * size * np.eye(len(normal))
            new = self.programme.step(matrix, slope - matrix @ state.member, rows)
            look = None if new is None else state.landscape.look(new, state.look)
            if new is None or look is None or not self._objective(look) < most:
                damping *= SLOWER
                continue
            edges, sheet = self.search.failures(new)
            if not len(edges) + len(sheet):
                return State(state.landscape, look, rows, max(damping / FASTER, LEAST_DAMPING))
            rows, cuts = rows + edges + sheet, cuts + 1
            most = max(most, self.loss * self._objective(state.look))
            if cuts > 2:
                damping *= SLOWER / 2
            if cuts == CUTS:
                break
        return None
