"""One door to the solvers of convex quadratic programmes.

minimise `1/2 q^T H q + g^T q` subject to `E q = e` and `A q >= b`.

DAQP (a dual active-set method) solves these dense, small programmes in a fraction of a
millisecond; where it does not end well, or its answer fails the optimality check, the
programme goes to Clarabel (an interior-point method).  Both are called directly; `stated` says the
same in cvxpy's language.  An answer is returned only
if it satisfies the Karush-Kuhn-Tucker conditions: the constraints, and a gradient that is a
combination of those that are active, with multipliers of the right sign (found anew by
nonnegative least squares, whatever the solver says).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.sparse import csc_matrix

from pas.algebra.monomials import Floats

RESIDUAL = 1e-7
"""Largest violation of a constraint accepted, relative to the unknowns; rows have unit length."""

PATIENCE = 10
"""Steps for each constraint in which the check of an optimum must end; the usual three do not always do."""

STATIONARITY = 1e-3
"""Largest gradient left over, relative to the gradient.  It costs fairness, not truth: the
optimum is unique, and solvers reach 1e-6 or better where they do not fail."""

TOLERANCE = 1e-9
"""DAQP's primal tolerance: its default, 1e-6, hides contradictions of points."""

EQUALITY = 5
"""DAQP's mark of an equality row."""


class Outcome(Enum):
    """What a programme came to."""

    SOLVED = "solved"
    INFEASIBLE = "infeasible"
    FAILED = "failed"


@dataclass(frozen=True)
class Programme:
    """A convex quadratic programme in m unknowns; rows of unit scale serve the solver best."""

    hessian: Floats
    linear: Floats
    equalities: Floats
    equal_to: Floats
    rows: Floats
    at_least: Floats


@dataclass(frozen=True)
class QuadraticSolution:
    """The unknowns (zeros unless SOLVED) and the largest violation of a constraint."""

    outcome: Outcome
    unknowns: Floats
    violation: float


def solve(programme: Programme) -> QuadraticSolution:
    """Solve a programme: DAQP first, Clarabel where that falls short."""
    solution = _with_daqp(programme)
    if solution.outcome is Outcome.FAILED:
        return _with_clarabel(programme)
    return solution


def feasible(programme: Programme) -> bool:
    """Whether the constraints can hold together, whatever the objective.

    Only a solver's finding that they cannot counts as no; its failure does not.
    """
    m = len(programme.linear)
    probe = Programme(
        np.eye(m), np.zeros(m), programme.equalities, programme.equal_to, programme.rows, programme.at_least
    )
    return solve(probe).outcome is not Outcome.INFEASIBLE


def _with_daqp(programme: Programme) -> QuadraticSolution:
    """With the rows that matter: those that the optimum without them misses, the worst of them first.

    The optimum under some of the rows that meets the others too is that under all of them.
    """
    m = len(programme.linear)
    chosen = np.zeros(len(programme.rows), dtype=bool)
    while True:
        q, flag = _daqp(programme, chosen)
        if flag in (-1, -6):
            return QuadraticSolution(Outcome.INFEASIBLE, np.zeros(m), np.inf)
        if flag <= 0 and chosen.all():
            return _failed(m)
        if flag <= 0:  # as where the rows alone keep the unknowns from going on for ever
            chosen[:] = True
            continue
        missed = np.where(chosen, 0.0, programme.at_least - programme.rows @ q)
        more = missed > TOLERANCE
        if not more.any():
            return _checked(programme, q)
        if more.sum() > m:
            more &= missed >= np.partition(missed, -m)[-m]
        chosen |= more


def _daqp(programme: Programme, chosen: NDArray[np.bool_]) -> tuple[Floats, int]:
    """The optimum under some of the rows, and how DAQP ended."""
    import daqp

    rows = np.ascontiguousarray(np.concatenate([programme.equalities, programme.rows[chosen]]))
    lower = np.concatenate([programme.equal_to, programme.at_least[chosen]])
    upper = np.concatenate([programme.equal_to, np.full(int(chosen.sum()), 1e30)])
    sense = np.zeros(len(rows), dtype=np.int32)
    sense[: len(programme.equalities)] = EQUALITY
    hessian = np.ascontiguousarray(programme.hessian)
    q, _, flag, _ = daqp.solve(hessian, programme.linear.copy(), rows, upper, lower, sense, primal_tol=TOLERANCE)
    return np.asarray(q), int(flag)


def _with_clarabel(programme: Programme) -> QuadraticSolution:
    import clarabel

    m, equations = len(programme.linear), len(programme.equal_to)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.ZeroConeT(equations), clarabel.NonnegativeConeT(len(programme.at_least))]
    solution = clarabel.DefaultSolver(
        csc_matrix(np.triu(programme.hessian)),
        programme.linear,
        csc_matrix(np.concatenate([programme.equalities, -programme.rows])),
        np.concatenate([programme.equal_to, -programme.at_least]),
        cones,
        settings,
    ).solve()
    if solution.status in (clarabel.SolverStatus.PrimalInfeasible, clarabel.SolverStatus.AlmostPrimalInfeasible):
        return QuadraticSolution(Outcome.INFEASIBLE, np.zeros(m), np.inf)
    return _checked(programme, np.array(solution.x))


def stated(programme: Programme) -> tuple[Any, Any]:
    """The programme and its unknowns in the language of cvxpy, to be read, and to check the solvers against."""
    cvxpy: Any = import_module("cvxpy")

    q = cvxpy.Variable(len(programme.linear))
    objective = cvxpy.Minimize(cvxpy.quad_form(q, cvxpy.psd_wrap(programme.hessian)) / 2 + programme.linear @ q)
    constraints = [programme.equalities @ q == programme.equal_to, programme.rows @ q >= programme.at_least]
    return cvxpy.Problem(objective, constraints), q


def _checked(programme: Programme, q: Floats) -> QuadraticSolution:
    scale = 1.0 + float(np.abs(q).max(initial=0.0))
    equal = np.abs(programme.equalities @ q - programme.equal_to).max(initial=0.0)
    below = (programme.at_least - programme.rows @ q).max(initial=0.0)
    violation = max(float(equal), float(below), 0.0)
    if not np.isfinite(violation) or violation > RESIDUAL * scale or not _stationary(programme, q):
        return _failed(len(q))
    return QuadraticSolution(Outcome.SOLVED, q, violation)


def _stationary(programme: Programme, q: Floats) -> bool:
    """Whether the gradient is a combination of the active constraints with the right signs."""
    gradient = programme.hessian @ q + programme.linear
    active = programme.rows[programme.rows @ q - programme.at_least < 1e-6 * (1.0 + float(np.abs(q).max()))]
    columns = np.concatenate([programme.equalities, -programme.equalities, active]).T
    if not columns.size:
        return bool(np.abs(gradient).max() <= STATIONARITY)
    try:
        left = nnls(columns, gradient, maxiter=PATIENCE * columns.shape[1])[1]
    except RuntimeError:  # of scipy, where that does not do: nothing is known then
        return False
    return bool(left <= STATIONARITY * float(np.linalg.norm(gradient)) + 1e-12)


def _failed(size: int) -> QuadraticSolution:
    return QuadraticSolution(Outcome.FAILED, np.zeros(size), np.inf)
