"""Convex quadratic programmes with rational data, solved exactly.

minimise `1/2 a^T Q a` subject to `E a = e` and `A a >= b`.

The constraints that are active at the optimum are guessed by the numerical solver and put right
by an active-set iteration; the unknowns and multipliers then solve the Karush-Kuhn-Tucker
equations over Q.  The answer is returned only if it satisfies all of these conditions exactly:
for a positive semidefinite Q they are sufficient, so the optimum is exact and certain.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import fmpq, fmpq_mat

from pas.errors import InfeasibleError, NotSolvedError
from pas.fairing.basis import to_doubles
from pas.fairing.qp import Outcome, Programme, solve
from pas.limits import checkpoint

ITERATIONS = 200
"""Changes of the active set before giving up; the solver's guess was right in nearly all cases."""


@dataclass(frozen=True)
class ExactProgramme:
    """The data, exact: `quadratic` (m, m) positive semidefinite, `equations` (p, m + 1) and
    `inequalities` (q, m + 1) with the right-hand side as their last column."""

    quadratic: fmpq_mat
    equations: fmpq_mat
    inequalities: fmpq_mat


@dataclass(frozen=True)
class ExactSolution:
    """The optimum (1, m), its `value`, the active inequalities with their multipliers (all
    positive or zero), and whether it is the only one."""

    unknowns: fmpq_mat
    value: fmpq
    multipliers: dict[int, fmpq]
    unique: bool


def solve_exactly(programme: ExactProgramme) -> ExactSolution:
    """The exact optimum.

    Raises `InfeasibleError` where the constraints contradict, `NotSolvedError` where no active set
    was found to be optimal.
    """
    active = _guess(programme)
    for _ in range(ITERATIONS):
        checkpoint("solving a quadratic programme exactly")
        unknowns, multipliers, unique = _stationary(programme, active)
        slack = _residuals(programme.inequalities, unknowns)
        worst = min(range(len(slack)), key=lambda i: slack[i], default=None)
        dropped = min(active, key=lambda i: multipliers[i], default=None)
        if worst is not None and slack[worst] < 0:
            active = [*active, worst]
        elif dropped is not None and multipliers[dropped] < 0:
            active = [i for i in active if i != dropped]
        else:
            value = (unknowns * programme.quadratic * unknowns.transpose())[0, 0] / 2
            return ExactSolution(unknowns, value, multipliers, unique)
    raise NotSolvedError(f"no optimal set of active constraints was found in {ITERATIONS} steps")


def _guess(programme: ExactProgramme) -> list[int]:
    """The inequalities that are active at the numerical optimum."""
    m, count = programme.quadratic.ncols(), programme.inequalities.nrows()
    if not count:
        return []
    equations, rows = to_doubles(programme.equations), to_doubles(programme.inequalities)
    quadratic = to_doubles(programme.quadratic)
    scale = np.linalg.norm(rows[:, :m], axis=1, keepdims=True)
    rows = rows / np.where(scale > 0, scale, 1.0)
    length = np.linalg.norm(equations[:, :m], axis=1, keepdims=True)
    equations = equations / np.where(length > 0, length, 1.0)
    numerical = Programme(
        quadratic / max(float(np.abs(quadratic).max()), 1e-300),
        np.zeros(m),
        equations[:, :m],
        equations[:, m],
        rows[:, :m],
        rows[:, m],
    )
    solution = solve(numerical)
    if solution.outcome is not Outcome.SOLVED:
        return []
    slack = rows[:, :m] @ solution.unknowns - rows[:, m]
    return [int(i) for i in np.flatnonzero(slack < 1e-7 * (1 + np.abs(solution.unknowns).max()))]


def _stationary(programme: ExactProgramme, active: list[int]) -> tuple[fmpq_mat, dict[int, fmpq], bool]:
    """The minimiser with the active inequalities as equations, and the multipliers of these.

    Dependent rows get multiplier 0; of several minimisers the one with zeros in the free unknowns.
    """
    m = programme.quadratic.ncols()
    equations = programme.equations.tolist()
    chosen = _independent(equations + [programme.inequalities.tolist()[i] for i in active], m, len(equations))
    rows = [row for _, row in chosen]
    size = m + len(rows)
    table = [[fmpq(0)] * (size + 1) for _ in range(size)]
    for i, values in enumerate(programme.quadratic.tolist()):
        table[i][:m] = values
        for j, row in enumerate(rows):
            table[i][m + j] = -row[i]
            table[m + j][i] = row[i]
    for j, row in enumerate(rows):
        table[m + j][size] = row[m]
    reduced, rank = fmpq_mat(table).rref()
    leads = [next(j for j in range(size + 1) if reduced[i, j] != 0) for i in range(rank)]
    if size in leads:
        raise InfeasibleError("the equations contradict one another")
    solution = [fmpq(0)] * size
    for i, lead in enumerate(leads):
        solution[lead] = reduced[i, size]
    multipliers = dict.fromkeys(active, fmpq(0))
    for j, (number, _) in enumerate(chosen):
        if number >= len(equations):
            multipliers[active[number - len(equations)]] = solution[m + j]
    return fmpq_mat(1, m, solution[:m]), multipliers, all(j in leads for j in range(m))


def _independent(rows: list[list[fmpq]], m: int, equations: int) -> list[tuple[int, list[fmpq]]]:
    """A largest set of rows with independent left-hand sides, the first ones first.

    Raises `InfeasibleError` where an equation contradicts those before it.
    """
    chosen: list[tuple[int, list[fmpq]]] = []
    rank = 0
    for number, row in enumerate(rows):
        trial = fmpq_mat([r for _, r in chosen] + [row])
        left = fmpq_mat([r[:m] for _, r in chosen] + [row[:m]])
        if left.rank() > rank:
            chosen.append((number, row))
            rank += 1
        elif number < equations and trial.rank() > rank:
            raise InfeasibleError("the equations contradict one another")
    return chosen


def _residuals(inequalities: fmpq_mat, unknowns: fmpq_mat) -> list[fmpq]:
    """`A a - b` for each inequality."""
    m = unknowns.ncols()
    values = unknowns.entries()
    return [sum((row[j] * values[j] for j in range(m)), -row[m]) for row in inequalities.tolist()]
