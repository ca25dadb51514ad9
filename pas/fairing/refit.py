"""Another member near one that is there, for other points or another tension: for sliders and for settling again."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from pas.errors import InfeasibleError
from pas.fairing.basis import to_doubles
from pas.fairing.exchange import Exchange, Search
from pas.fairing.fair import coordinates
from pas.fairing.guard import SLIM
from pas.fairing.landscape import Landscape, Look
from pas.fairing.programme import MemberProgramme
from pas.fairing.settling import STEPS, Settling, State
from pas.fairing.wishes import Wishes
from pas.surface.piecewise import PiecewiseSurface

if TYPE_CHECKING:
    from pas.fairing.fairing import Choice, Fairing

LIVE_LATTICE, LATTICE = 16, 32
"""Subdivisions of the outer faces for single steps, and for settling."""

MOST_STEPS = 1000
"""Steps that may be asked for."""


def refitted(
    fairing: Fairing, surface: PiecewiseSurface, choice: Choice | None, wishes: Wishes, steps: int | None
) -> Choice:
    """The member after so many steps, or settled; `choice` is how the surface was chosen, where that is known.

    Raises `InfeasibleError` where the wishes contradict, or move the surface so far that it is lost from sight.
    """
    rows, margins = (None, None) if choice is None else (choice.rows, choice.margins)
    if rows is None:
        margins = SLIM
        rows = fairing.guard.initial(margins)
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
            raise programme.conflict(rows)
        state, steps = moved, None if steps is None else steps - 1
    for passed in settling.steps(state, STEPS if steps is None else steps):
        state = passed
    found = fairing.chosen(programme, state, margins)
    return replace(found, state=state if live else None)


def _seen(
    fairing: Fairing, surface: PiecewiseSurface, choice: Choice | None, wishes: Wishes, live: bool
) -> tuple[Landscape, Look]:
    """The surface as it is seen: as the last step left it, or anew."""
    if live and choice is not None and choice.state is not None:
        return choice.state.landscape.of(fairing.energy, choice.state.look)
    member = coordinates(fairing, surface) if choice is None else to_doubles(choice.working)[0]
    landscape = fairing.landscape(wishes.limits_at(fairing.placed), member, live)
    if landscape.first is None:
        raise InfeasibleError("the surface cannot be seen from the centre along all rays, so that no step can be taken")
    return landscape, landscape.first
