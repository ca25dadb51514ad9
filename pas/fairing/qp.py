"""Convex quadratic programmes, in doubles or exactly: minimise `1/2 q^T H q + g^T q`, `E q = e` and `A q >= b`.

DAQP, a dual active-set method (Arnstrom, Bemporad and Axehill 2022), solves these dense, small programmes in a
fraction of a millisecond, in unknowns in which H, unless it is singular, is the unit matrix: else pivots of 1e-11 count
as zeros.  An answer is returned only if it satisfies the Karush-Kuhn-Tucker conditions: the constraints, and a gradient
that is a combination of those that are active, with multipliers of the right sign (found anew by nonnegative least
squares, whatever the solver says).

With rational data and g = 0 (`solve_exactly`) the constraints that are active at the optimum are guessed by that solver
and put right by an active-set iteration; the unknowns and multipliers then solve the Karush-Kuhn-Tucker equations over
Q.  The answer is returned only if it satisfies all of these conditions exactly: for a positive semidefinite H they are
sufficient, so the optimum is exact and certain.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from flint import fmpq, fmpq_mat
from scipy.linalg import LinAlgError, cholesky, solve_triangular
from scipy.optimize import nnls

from pas.algebra.matrices import leads, solved
from pas.arrays import Bools, Floats
from pas.errors import InfeasibleError, NotSolvedError
from pas.fairing.basis import to_doubles
from pas.fairing.constraints import Inequalities, lengths
from pas.limits import checkpoint

RESIDUAL, ACTIVE = 1e-7, 1e-6
"""Largest violation of a constraint accepted, and how near to equality one is active, relative to the unknowns; rows
have unit length."""

STATIONARITY = 1e-3
"""Largest gradient left over, relative to the gradient.  It costs fairness, not truth: the
optimum is unique, and the solver reaches 1e-6 or better where it does not fail."""

TOLERANCE = 1e-9
"""DAQP's primal tolerance: its default, 1e-6, hides contradictions of points."""

ITERATIONS = 200
"""Changes of the active set before giving up; the solver's guess was right in nearly all cases."""


class Outcome(Enum):
    """The outcome of a programme."""

    SOLVED = "solved"
    INFEASIBLE = "infeasible"
    FAILED = "failed"


@dataclass(frozen=True)
class Programme:
    """A convex quadratic programme in m unknowns; rows of unit length serve the solver best."""

    hessian: Floats
    linear: Floats
    equalities: Floats
    equal_to: Floats
    rows: Floats
    at_least: Floats

    @classmethod
    def scaled(cls, hessian: Floats, linear: Floats, equations: Floats, inequalities: Inequalities) -> Programme:
        """One with equations of unit length and a Hessian of largest entry 1; `equations` (p, m + 1) with right-hand
        sides as their last column."""
        size = float(np.abs(hessian).max()) or 1.0
        equations = equations / lengths(equations[:, :-1])[:, None]
        sides = inequalities.rows, inequalities.at_least
        return cls(hessian / size, linear / size, equations[:, :-1], equations[:, -1], *sides)


@dataclass(frozen=True)
class QuadraticSolution:
    """The outcome of a programme, and its unknowns (zeros unless SOLVED)."""

    outcome: Outcome
    unknowns: Floats


def feasible(programme: Programme) -> bool:
    """Whether the constraints can hold together, whatever the objective.

    Only the solver's finding that they cannot counts as no; its failure does not.
    """
    m = len(programme.linear)
    return solve(replace(programme, hessian=np.eye(m), linear=np.zeros(m))).outcome is not Outcome.INFEASIBLE


def solve(programme: Programme, near: Floats | None = None) -> QuadraticSolution:
    """The optimum, by the rows that matter: as many as there are unknowns that are next to being active at unknowns
    `near` the optimum, where such are known, then those that the optimum without them misses, the worst first.

    The optimum under some of the rows that meets the others too is that under all of them.
    """
    m, root = len(programme.linear), _root(programme.hessian)
    chosen = np.zeros(len(programme.rows), dtype=bool)
    if near is not None and len(programme.rows) > m:
        left = programme.rows @ near - programme.at_least
        chosen = left <= np.partition(left, m)[m]
    while True:
        q, flag = _daqp(programme, chosen, root)
        if flag in (-1, -6):
            return QuadraticSolution(Outcome.INFEASIBLE, np.zeros(m))
        failed = flag <= 0 or not np.isfinite(q).all()
        if failed and chosen.all():
            return QuadraticSolution(Outcome.FAILED, np.zeros(m))
        if failed:  # as where the rows alone keep the unknowns from going on for ever
            chosen[:] = True
            continue
        missed = np.where(chosen, 0.0, programme.at_least - programme.rows @ q)
        more = missed > TOLERANCE
        if not more.any():
            found = checked(programme, q)
            return checked(programme, _refined(programme, q)) if found.outcome is Outcome.FAILED else found
        if more.sum() > m:
            more &= missed >= np.partition(missed, -m)[-m]
        chosen |= more


def _root(hessian: Floats) -> Floats | None:
    """The lower triangle L (m, m) with L L^T = H; None where H is singular, but for rounding."""
    try:
        root = np.asarray(cholesky(hessian, lower=True, check_finite=False))
    except LinAlgError:
        return None
    rounding = len(root) * np.finfo(float).eps * np.diag(hessian)
    return root if (np.diag(root) ** 2 > rounding).all() else None


def _daqp(programme: Programme, chosen: Bools, root: Floats | None) -> tuple[Floats, int]:
    """The optimum under some of the rows, and how DAQP ended; it is asked for L^T q by the `root` L of the Hessian."""
    import daqp

    rows = np.concatenate([programme.equalities, programme.rows[chosen]])
    lower = np.concatenate([programme.equal_to, programme.at_least[chosen]])
    upper = np.concatenate([programme.equal_to, np.full(int(chosen.sum()), 1e30)])
    sense = np.zeros(len(rows), dtype=np.int32)
    equality = 5  # DAQP's mark of an equality row
    sense[: len(programme.equalities)] = equality
    hessian, linear = np.ascontiguousarray(programme.hessian), programme.linear.copy()
    if root is not None:
        hessian, linear = np.eye(len(linear)), solve_triangular(root, linear, lower=True, check_finite=False)
        rows = solve_triangular(root, rows.T, lower=True, check_finite=False).T
    rows = np.ascontiguousarray(rows)
    q, _, flag, _ = daqp.solve(hessian, linear, rows, upper, lower, sense, primal_tol=TOLERANCE)
    q = np.asarray(q) if root is None else solve_triangular(root, q, lower=True, trans=1, check_finite=False)
    return np.asarray(q), int(flag)


def _refined(programme: Programme, q: Floats) -> Floats:
    """The unknowns after one Newton step on the active constraints: DAQP regularises a Hessian that is singular, as of
    an energy over a part of the region, which leaves its optimum some 1e-7 off."""
    near = programme.rows @ q - programme.at_least < ACTIVE * (1.0 + float(np.abs(q).max(initial=0.0)))
    held = np.concatenate([programme.equalities, programme.rows[near]])
    off = np.concatenate([programme.equal_to, programme.at_least[near]]) - held @ q
    system = np.block([[programme.hessian, held.T], [held, np.zeros((len(held), len(held)))]])
    right = np.concatenate([-(programme.hessian @ q + programme.linear), off])
    return np.asarray(q + np.linalg.lstsq(system, right, rcond=None)[0][: len(q)])


def checked(programme: Programme, q: Floats) -> QuadraticSolution:
    """The unknowns as a solution if they satisfy the Karush-Kuhn-Tucker conditions, and a failure else."""
    scale = 1.0 + float(np.abs(q).max(initial=0.0))
    equal = np.abs(programme.equalities @ q - programme.equal_to).max(initial=0.0)
    below = (programme.at_least - programme.rows @ q).max(initial=0.0)
    violation = max(float(equal), float(below))
    if not np.isfinite(violation) or violation > RESIDUAL * scale or not _stationary(programme, q, scale):
        return QuadraticSolution(Outcome.FAILED, np.zeros(len(q)))
    return QuadraticSolution(Outcome.SOLVED, q)


def _stationary(programme: Programme, q: Floats, scale: float) -> bool:
    """Whether the gradient is a combination of the active constraints with the right signs."""
    # Steps for each constraint in which the check of an optimum must end; the usual three do not always do.
    patience = 10
    gradient = programme.hessian @ q + programme.linear
    active = programme.rows[programme.rows @ q - programme.at_least < ACTIVE * scale]
    columns = np.concatenate([programme.equalities, -programme.equalities, active]).T
    if not columns.size:
        return bool(np.abs(gradient).max() <= STATIONARITY)
    try:
        left = nnls(columns, gradient, maxiter=patience * columns.shape[1])[1]
    except RuntimeError:  # of scipy, where that does not do: nothing is known then
        return False
    return bool(left <= STATIONARITY * float(np.linalg.norm(gradient)) + 1e-12)


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
        unknowns, multipliers, unique = _minimiser(programme, active)
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
    numerical = Programme.scaled(quadratic, np.zeros(m), equations, Inequalities(table[:, :m], table[:, m]).unit)
    solution = solve(numerical)
    if solution.outcome is not Outcome.SOLVED:
        return []
    slack = numerical.rows @ solution.unknowns - numerical.at_least
    return [int(i) for i in np.flatnonzero(slack < RESIDUAL * (1 + np.abs(solution.unknowns).max()))]


def _minimiser(programme: ExactProgramme, active: list[int]) -> tuple[fmpq_mat, dict[int, fmpq], bool]:
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
    found = solved(fmpq_mat(table))
    if found is None or any(_residuals(programme.equations, fmpq_mat(1, m, found[0][:m]))):
        raise InfeasibleError("the equations contradict one another")
    solution, bound = found
    multipliers = dict.fromkeys(active, fmpq(0))
    multipliers |= {active[n - equations]: solution[j] for j, n in enumerate(chosen, start=m) if n >= equations}
    return fmpq_mat(1, m, solution[:m]), multipliers, set(range(m)) <= set(bound)


def _residuals(inequalities: fmpq_mat, unknowns: fmpq_mat) -> list[fmpq]:
    """`A a - b` for each row (A, b)."""
    column = fmpq_mat(unknowns.ncols() + 1, 1, [*unknowns.entries(), fmpq(-1)])
    return (inequalities * column).entries()
