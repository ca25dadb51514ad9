"""Another member near one that is there, for other points or another tension: for sliders and for settling again."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import null_space

from pas.algebra.monomials import Floats
from pas.errors import InfeasibleError
from pas.fairing.basis import to_doubles
from pas.fairing.exchange import Exchange, Search
from pas.fairing.fair import coordinates
from pas.fairing.guard import SLIM, Margins, Rows
from pas.fairing.landscape import Landscape, Look
from pas.fairing.programme import MemberProgramme
from pas.fairing.settling import STEPS, Settling, State
from pas.fairing.wishes import Wishes
from pas.piecewise import PiecewiseSurface

if TYPE_CHECKING:
    from pas.fairing.fairing import Choice, Fairing

LIVE_LATTICE, LATTICE = 16, 32
"""Subdivisions of the outer faces for single steps, and for settling."""

TOUCHED = 1e-6
"""How near a guard row a member is on it, over the lengths of both: solvers leave 1e-9."""

SETTLED = 1e-8
"""Singular values of equations, over the largest, that are taken for 0."""

STIFF = 1e-9
"""Added to second derivatives that are 0, over their mean: so that these can be inverted."""

MOST_STEPS = 1000
"""Steps that may be asked for."""


def refitted(
    fairing: Fairing, surface: PiecewiseSurface, choice: Choice | None, wishes: Wishes, steps: int | None
) -> Choice:
    """The member after so many steps, or settled; `choice` is how the surface was chosen, where that is known.

    Where the way there is too long for one linear step, it is found anew among the same members, not proved.  Raises
    `InfeasibleError` where the wishes cannot be met so either.
    """
    with suppress(InfeasibleError):
        return _stepped(fairing, surface, choice, wishes, steps)
    return fairing.choose(wishes.changed(prove=False))


def _stepped(
    fairing: Fairing, surface: PiecewiseSurface, choice: Choice | None, wishes: Wishes, steps: int | None
) -> Choice:
    """The same by steps alone; raises `InfeasibleError` where these lose the surface from sight."""
    rows, margins = _rows(fairing, choice)
    if not fairing.energy.on_surface:
        return fairing.under(wishes, rows, margins)
    programme = MemberProgramme(fairing, wishes)
    live = steps is not None
    state = State(*_seen(fairing, surface, choice, wishes, live), rows)
    search = Search(Exchange(programme, fairing.guard, margins or SLIM), LIVE_LATTICE if live else LATTICE)
    settling = Settling(search, live)
    if not programme.holds(state.member):
        moved = settling.forced(state)
        if moved is None:
            raise InfeasibleError("one step does not reach what is wished")
        state, steps = moved, None if steps is None else steps - 1
    for passed in settling.steps(state, STEPS if steps is None else steps):
        state = passed
    found = fairing.chosen(programme, state, margins)
    return replace(found, state=state if live else None)


def compliance(fairing: Fairing, surface: PiecewiseSurface, choice: Choice | None, wishes: Wishes) -> Floats:
    """How the member follows where something pulls at it, to first order: (m, m), symmetric, on working coefficients.

    Where a linear form r of the coefficients is held at a value that is 1 more, another form v changes by
    `v C r / r C r`: C is the inverse of the objective's second derivatives as Gauss and Newton have them, among the
    members for which the wishes' equations hold, and the guard rows on which the member is.  Raises `InfeasibleError`
    where the surface is not seen.
    """
    programme, member = MemberProgramme(fairing, wishes), _member(fairing, surface, choice)
    matrix = programme.quadratic_part / 2
    if fairing.energy.on_surface:
        landscape, look = _seen(fairing, surface, choice, wishes, True)
        matrix = matrix + landscape.linearised(look)[0]
    rows, _ = _rows(fairing, choice) if wishes.guard else (Rows.none(len(member)), None)
    left = rows.rows @ member - rows.at_least
    touched = rows.rows[left <= TOUCHED * np.linalg.norm(rows.rows, axis=1) * np.linalg.norm(member)]
    free = null_space(np.concatenate([programme.equations()[:, :-1], touched]), SETTLED)
    inner = free.T @ matrix @ free
    inner += STIFF * np.trace(inner) / max(len(inner), 1) * np.eye(len(inner))
    return np.asarray(free @ np.linalg.solve(inner, free.T))


def _rows(fairing: Fairing, choice: Choice | None) -> tuple[Rows, Margins | None]:
    """The guard rows and margins under which a surface was chosen, or those to begin with."""
    if choice is None or choice.rows is None:
        return fairing.guard.initial(SLIM), SLIM
    return choice.rows, choice.margins


def _member(fairing: Fairing, surface: PiecewiseSurface, choice: Choice | None) -> Floats:
    return coordinates(fairing, surface) if choice is None else to_doubles(choice.working)[0]


def _seen(
    fairing: Fairing, surface: PiecewiseSurface, choice: Choice | None, wishes: Wishes, live: bool
) -> tuple[Landscape, Look]:
    """The surface as it is seen: as the last step left it, or anew."""
    if live and choice is not None and choice.state is not None:
        return choice.state.landscape.of(fairing.energy, choice.state.look)
    member = _member(fairing, surface, choice)
    landscape = fairing.landscape(wishes.limits_at(fairing.placed), member, live)
    if landscape.first is None:
        raise InfeasibleError("the surface cannot be seen from the centre along all rays, so that no step can be taken")
    return landscape, landscape.first
