"""Another member near one that is there, for other points or another tension: for sliders and for settling again."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np
from scipy.linalg import null_space

from pas.arrays import Floats
from pas.errors import InfeasibleError
from pas.fairing.basis import to_doubles
from pas.fairing.constraints import Inequalities
from pas.fairing.prepared import LIVE, SETTINGS, SLIM, PreparedSpace, SampledConditions
from pas.fairing.solver import FitSolver, FittedMember, Iterate, coordinates
from pas.fairing.wishes import Wishes
from pas.piecewise import PiecewiseSurface

SETTLED = 1e-8
"""Singular values of equations, over the largest, that are taken for 0."""


def refitted(
    space: PreparedSpace, surface: PiecewiseSurface, fitted: FittedMember | None, wishes: Wishes, steps: int | None
) -> FittedMember:
    """The member after so many steps, or settled; `fitted` is how the surface was chosen, where that is known.

    Where the way there is too long for one linear step, it is found anew among the same members, not proved.  Raises
    `InfeasibleError` where the wishes cannot be met so either.
    """
    with suppress(InfeasibleError):
        return _stepped(space, surface, fitted, wishes, steps)
    return FitSolver(space, wishes.changed(prove=False)).fitted()


def _stepped(
    space: PreparedSpace, surface: PiecewiseSurface, fitted: FittedMember | None, wishes: Wishes, steps: int | None
) -> FittedMember:
    """The member after some steps; raises `InfeasibleError` where rays from the centre miss the surface."""
    live = steps is not None
    solver = FitSolver(space, wishes, LIVE if live else SETTINGS)
    if not solver.energy.on_surface:
        rows = _rows(space, fitted)
        member = solver.programme.optimum(rows)
        if member is None:
            raise solver.programme.conflict(rows)
        return solver.rounded(Iterate(member, rows, 0.0), _share(fitted))
    s = solver.settings
    first = _sampled(solver, surface, fitted, live)
    *_, last = first, *solver.descent(first, SampledConditions(space, _share(fitted), s.lattices[0]), steps)
    if last is first and not solver.programme.holds(last.member):
        raise InfeasibleError("one step does not reach what is wished")
    found = solver.rounded(last, _share(fitted))
    return replace(found, iterate=last if live else None)


def compliance(space: PreparedSpace, surface: PiecewiseSurface, fitted: FittedMember | None, wishes: Wishes) -> Floats:
    """How the member follows where something pulls at it, to first order: (m, m), symmetric, on working coefficients.

    Where a linear form r of the coefficients is held at a value that is 1 more, another form v changes by
    `v C r / r C r`: C is the inverse of the objective's second derivatives as Gauss and Newton have them, among the
    members for which the wishes' equations hold, and the inequalities on which the member is.  Raises
    `InfeasibleError` where rays from the centre miss or graze the surface.
    """
    near = 1e-6  # how near an inequality a member is on it, over the lengths of both: solvers leave 1e-9
    solver = FitSolver(space, wishes, LIVE)
    if solver.energy.on_surface:
        at = _sampled(solver, surface, fitted, True)
    else:
        at = Iterate(_member(space, surface, fitted), _rows(space, fitted), 0.0)
    matrix, _ = solver.model(at).matrices()
    rows = _rows(space, fitted) if wishes.guard else Inequalities.none(len(at.member))
    left = rows.rows @ at.member - rows.at_least
    touched = rows.rows[left <= near * np.linalg.norm(rows.rows, axis=1) * np.linalg.norm(at.member)]
    free = null_space(np.concatenate([solver.programme.equations[:, :-1], touched]), SETTLED)
    inner = free.T @ matrix @ free
    stiff = 1e-9  # added to second derivatives that are 0, over their mean: so that these can be inverted
    inner += stiff * np.trace(inner) / max(len(inner), 1) * np.eye(len(inner))
    return np.asarray(free @ np.linalg.solve(inner, free.T))


def _share(fitted: FittedMember | None) -> float:
    """The share of the margins under which a surface was chosen; of one whose choice is not known, the least."""
    return SLIM if fitted is None else fitted.share


def _rows(space: PreparedSpace, fitted: FittedMember | None) -> Inequalities:
    """The inequalities under which a surface was chosen, or those to begin with."""
    if fitted is not None:
        return fitted.rows
    return SampledConditions(space, _share(None)).first


def _member(space: PreparedSpace, surface: PiecewiseSurface, fitted: FittedMember | None) -> Floats:
    return coordinates(space, surface) if fitted is None else to_doubles(fitted.working)[0]


def _sampled(solver: FitSolver, surface: PiecewiseSurface, fitted: FittedMember | None, live: bool) -> Iterate:
    """The surface with its geometry along rays: as the last step left it, or anew."""
    before = fitted.iterate if fitted is not None and live else None
    if before is not None and before.value is not None:
        return replace(before, value=before.value.of(solver.energy))
    found = solver.iterate(_member(solver.space, surface, fitted), _rows(solver.space, fitted), live)
    if found is None:
        raise InfeasibleError("the surface cannot be seen from the centre along all rays, so that no step can be taken")
    return found
