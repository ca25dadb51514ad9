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
from pas.fairing.qp import RESIDUAL, Outcome, Programme, solve
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
    quadratic, equations, table = map(to_doubles, (programme.quadratic, programme.equations, programme.inequalities))
    numerical = Programme.scaled(quadratic, np.zeros(m), equations, table[:, :m], table[:, m])
    solution = solve(numerical)
    if solution.outcome is not Outcome.SOLVED:
        return []
    slack = numerical.rows @ solution.unknowns - numerical.at_least
    return [int(i) for i in np.flatnonzero(slack < RESIDUAL * (1 + np.abs(solution.unknowns).max()))]


def _stationary(programme: ExactProgramme, active: list[int]) -> tuple[fmpq_mat, dict[int, fmpq], bool]:
    """The minimiser with the active inequalities as equations, and the multipliers of these.

    Of dependent rows the first ones count, others get multiplier 0; of several minimisers it is the one with zeros in
    the free unknowns.  Raises `InfeasibleError` where equations contradict.
    """
    m, equations = programme.quadratic.ncols(), programme.equations.nrows()
    given, inequalities = programme.equations.tolist(), programme.inequalities.tolist()
    rows = given + [inequalities[i] for i in active]
    left = fmpq_mat(len(rows), m, [v for row in rows for v in row[:m]])
    chosen = leads(*left.transpose().rref())
    size = m + len(chosen)
    table = [[fmpq(0)] * (size + 1) for _ in range(size)]
    for i, values in enumerate(programme.quadratic.tolist()):
        table[i][:m] = values
    for j, number in enumerate(chosen, start=m):
        table[j][:m], table[j][size] = rows[number][:m], rows[number][m]
        for i in range(m):
            table[i][j] = -rows[number][i]
    reduced, rank = fmpq_mat(table).rref()
    solution, pivots = [fmpq(0)] * (size + 1), leads(reduced, rank)
    for i, lead in enumerate(pivots):
        solution[lead] = reduced[i, size]
    unknowns = fmpq_mat(1, m, solution[:m])
    if size in pivots or any(_residuals(programme.equations, unknowns)):
        raise InfeasibleError("the equations contradict one another")
    multipliers = dict.fromkeys(active, fmpq(0))
    multipliers |= {active[n - equations]: solution[j] for j, n in enumerate(chosen, start=m) if n >= equations}
    return unknowns, multipliers, all(j in pivots for j in range(m))


def leads(reduced: fmpq_mat, rank: int) -> list[int]:
    """The columns of the leading entries of a reduced matrix, row by row."""
    return [next(j for j in range(reduced.ncols()) if reduced[i, j] != 0) for i in range(rank)]


def _residuals(inequalities: fmpq_mat, unknowns: fmpq_mat) -> list[fmpq]:
    """`A a - b` for each row (A, b)."""
    column = fmpq_mat(unknowns.ncols() + 1, 1, [*unknowns.entries(), fmpq(-1)])
    residuals: list[fmpq] = (inequalities * column).entries()
    return residuals
