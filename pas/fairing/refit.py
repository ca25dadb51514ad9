"""Another member near one that is there, for other points or another tension: for sliders and for settling again."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from pas.errors import InfeasibleError
from pas.fairing.basis import to_doubles
from pas.fairing.exchange import Exchange, Search
from pas.fairing.fair import coordinates
from pas.fairing.guard import SLIM
from pas.fairing.programme import MemberProgramme
from pas.fairing.settling import STEPS, Settling, State
from pas.fairing.wishes import Wishes
from pas.surface.fairness import FairnessLimits
from pas.surface.piecewise import PiecewiseSurface

if TYPE_CHECKING:
    from pas.fairing.fairing import Choice, Fairing

LIVE_RAYS, LIVE_LATTICE, LATTICE = 300, 16, 32
"""Rays, about, and subdivisions of the outer faces for single steps, and those for settling."""

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
    member = coordinates(fairing, surface) if choice is None else to_doubles(choice.working)[0]
    programme = MemberProgramme(fairing, wishes)
    live = steps is not None
    seen = None if choice is None or not live else choice.landscape
    limits = wishes.limits or FairnessLimits.of_order(fairing.placed.order)
    if seen is None:
        landscape = fairing.landscape(limits, member, LIVE_RAYS if live else None)
        look = landscape.first
    else:
        landscape = seen.of(fairing.energy)
        look = None if landscape.first is None else landscape.look(member, landscape.first)
    if look is None:
        raise InfeasibleError("the surface cannot be seen from the centre along all rays, so that no step can be taken")
    search = Search(Exchange(programme, fairing.guard, margins or SLIM), LIVE_LATTICE if live else LATTICE)
    settling, state = Settling(search), State(landscape, look, rows)
    if not programme.holds(member):
        moved = settling.forced(state)
        if moved is None:
            raise programme.conflict(rows)
        state, steps = moved, None if steps is None else steps - 1
    for passed in settling.steps(state, STEPS if steps is None else steps):
        state = passed
    found = fairing.chosen(programme, state, margins)
    return replace(found, landscape=landscape if live else None)
