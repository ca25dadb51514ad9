"""One choice among the members as a quadratic programme, with its equations kept exact."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import floor, log2

import numpy as np
from flint import fmpq, fmpq_mat
from scipy.linalg import eigh, null_space, qr

from pas.algebra.matrices import leads
from pas.algebra.rational import Vector, to_float
from pas.arrays import Floats
from pas.errors import InfeasibleError, NotSolvedError
from pas.fairing.basis import to_doubles
from pas.fairing.constraints import Inequalities
from pas.fairing.energy import as_energy
from pas.fairing.functionals import Functional, b_coefficient, value_at
from pas.fairing.prepared import PreparedSpace
from pas.fairing.qp import Outcome, Programme, feasible, solve
from pas.fairing.wishes import (
    DEFAULT_MARGIN,
    MeanAlpha,
    SumOfCoefficients,
    UnitCoefficients,
    ValueAt,
    Wishes,
    check_member,
)
from pas.partition.cells import Partition

ROUNDING = 1e-7
"""The value that rounding and the solver may cost a point without margin, over the region's radius."""

SIDES = (("inside", -1), ("outside", 1))
"""The kinds of points with an inequality, and the sign of f there."""

UNIT_STEPS = 100
"""Steps of the iteration for coefficients of length 1 under inequalities; 3 to 20 were needed."""


class MemberProgramme:
    """The choice of one member: a quadratic programme over the working coefficients, with its exact equations."""

    def __init__(self, space: PreparedSpace, wishes: Wishes) -> None:
        self.space, self.wishes, self.basis = space, wishes, space.basis
        self.energy = as_energy(wishes.energy)
        self._asked = ExactRows(wishes, space.partition, space.degree, self._on)
        m, table = self.basis.size, self._asked.equations(self.basis.transform)
        self.exact = _reduce(table, m) if table else (fmpq_mat(0, m + 1), [])
        """The exact equations in reduced form with their pivots; None where they contradict."""

    def optimum(self, rows: Inequalities) -> Floats | None:
        """The working coefficients of the least quadratic form (for an energy of the surface that of the thin plate)
        under the constraints and rows; None where these contradict.

        Raises `NotSolvedError` where the solvers failed.
        """
        if self.exact is None:
            return None
        if not self.quadratic:
            return self._unit_optimum(rows)
        return self._solved(self._programme(self.equations, self.points.unit + rows))

    def possible(self, rows: Inequalities) -> bool:
        """Whether all constraints can hold together."""
        if self.exact is None:
            return False
        if not self.quadratic:
            return self.optimum(rows) is not None
        return feasible(self._programme(self.equations, self.points.unit + rows))

    def holds(self, member: Floats) -> bool:
        """Whether the user's points and the normalisation hold for a member already."""
        points, equations = self.points, self.equations
        slack = ROUNDING * self._radius
        left = equations[:, :-1] @ member - equations[:, -1]
        return bool((points.rows @ member >= points.at_least - slack).all() and (np.abs(left) <= slack).all())

    def conflict(self, rows: Inequalities) -> InfeasibleError:
        """An error naming an irreducible infeasible set of the user's points (deletion filter)."""
        degree, points = self.space.degree, list(self.wishes.hard())
        nothing = Inequalities.none(self.basis.size)
        rows = rows if self.possible(nothing) else nothing
        if not points or not self._without(points).possible(rows):
            return InfeasibleError(
                f"no member of degree {degree} has clean contacts, walls and a single sheet at the sampled points"
                if len(rows)
                else f"no member of degree {degree} satisfies the normalisation"
            )
        dropped: list[tuple[str, int]] = []
        for point in points:
            if not self._without([*dropped, point]).possible(rows):
                dropped.append(point)
        conflict = [self.wishes.describe(p) for p in points if p not in dropped]
        if len(conflict) == 1:
            text = f"the constraint {conflict[0]} cannot be met by any member of degree {degree}"
        else:
            text = f"the constraints {', '.join(conflict)} contradict one another in degree {degree}"
        return InfeasibleError(text, conflict)

    def step(self, hessian: Floats, slope: Floats, rows: Inequalities, at: Floats, near: Floats) -> Floats | None:
        """The step d from a member of least `1/2 d^T H d + g^T d` under the constraints and rows, and `near` another;
        None where there is none."""
        equations, rows = self.equations, self.points.unit + rows
        left = equations[:, -1:] - equations[:, :-1] @ at[:, None]
        from_here = Inequalities(rows.rows, rows.at_least - rows.rows @ at)
        equations = np.concatenate([equations[:, :-1], left], axis=1)
        return self._solved(self._programme(equations, from_here, hessian, slope), near)

    @property
    def quadratic(self) -> bool:
        """Whether a quadratic form is minimised, and not its quotient by a length."""
        return not isinstance(self.wishes.normalize, UnitCoefficients)

    def normalised(self, q: Floats) -> Floats:
        """A multiple of the member to which guard rows refer."""
        return q if self.quadratic else q / float(self.space.guard.mean_alpha @ q)

    @cached_property
    def quadratic_part(self) -> Floats:
        """The part of the energy that is a quadratic form, and the squares at `near` points: (m, m)."""
        return self._form + self._near

    def quadratic_energy(self, q: Floats) -> float:
        """The part of a member's energy that is a quadratic form."""
        return float(q @ self._form @ q) / 2

    @cached_property
    def _form(self) -> Floats:
        return self.space.form(self.energy)

    def rounded(self, q: Floats) -> fmpq_mat:
        """Nearby rationals that satisfy the exact equations exactly.

        Raises `InfeasibleError` where a point of the user's does not hold for them, exactly.
        """
        assert self.exact is not None
        # Coefficients are rounded to this many bits below the largest: 10 digits, of which a basis as badly conditioned
        # as `pas.fairing.basis.CONDITION` may cost four.
        fraction_bits = 36
        shift = floor(log2(np.abs(q).max())) - fraction_bits
        step = fmpq(2**shift) if shift >= 0 else fmpq(1, 2**-shift)
        result = fmpq_mat(1, len(q), [round(float(x) / to_float(step)) * step for x in q])
        equations, pivots = self.exact
        for i, pivot in enumerate(pivots):
            others = sum((equations[i, j] * result[0, j] for j in range(len(q)) if j not in pivots), fmpq(0))
            result[0, pivot] = equations[i, len(q)] - others
        slack = max(self._margin / 2, ROUNDING * self._radius)
        for kind, sign in SIDES:
            for index, values in enumerate(self._asked.values(kind)):
                value = (fmpq_mat([values]) * result.transpose())[0, 0]
                if sign * to_float(value) < self._margin - slack:
                    words = self.wishes.describe((kind, index))
                    raise InfeasibleError(f"the constraint {words} is missed narrowly")
        return result

    def _without(self, points: Sequence[tuple[str, int]]) -> MemberProgramme:
        return MemberProgramme(self.space, self.wishes.without(points))

    @property
    def _radius(self) -> float:
        """The radius of the region in the user's units."""
        partition = self.space.partition
        return float(np.linalg.norm(partition.local.points, axis=1).max()) * to_float(partition.frame.scale)

    @property
    def _margin(self) -> float:
        margin = self.wishes.margin
        return DEFAULT_MARGIN * self._radius if margin is None else to_float(margin)

    def _programme(
        self, equations: Floats, inequalities: Inequalities, hessian: Floats | None = None, linear: Floats | None = None
    ) -> Programme:
        """The programme of the objective, or of another quadratic one."""
        form = self._hessian if hessian is None else hessian
        by = np.zeros(self.basis.size) if linear is None else linear
        return Programme.scaled(form, by, equations, inequalities)

    def _solved(self, programme: Programme, near: Floats | None = None) -> Floats | None:
        solution = solve(programme, near)
        if solution.outcome is Outcome.FAILED:
            raise NotSolvedError(f"the solver found no optimum that passes its checks in degree {self.space.degree}")
        return solution.unknowns if solution.outcome is Outcome.SOLVED else None

    @cached_property
    def equations(self) -> Floats:
        """All equations of the wishes with their right-hand sides, (p, m + 1)."""
        assert self.exact is not None
        m = self.basis.size
        equations = to_doubles(self.exact[0]) if self.exact[0].nrows() else np.empty((0, m + 1))
        if isinstance(self.wishes.normalize, MeanAlpha):
            equations = np.concatenate([equations, np.append(self.space.guard.mean_alpha, 1.0)[None]])
        return equations

    def _unit_optimum(self, rows: Inequalities) -> Floats | None:
        """The smallest quotient of the objective by the coefficients' squared length.

        Without active inequalities an eigenvector.  With some, the length is linearised at the
        last member again and again: a fixed point satisfies the optimality conditions.
        """
        m = self.basis.size
        gram, equations = self.space.coefficient_gram, self.equations
        if len(equations) and np.abs(equations[:, m]).max() > 0:
            raise ValueError("a handle or coefficient other than 0 fixes the length: it needs another normalisation")
        free = null_space(equations[:, :m]) if len(equations) else np.eye(m)
        if not free.shape[1]:
            return None
        vector = free @ eigh(free.T @ self._hessian @ free, free.T @ gram @ free, subset_by_index=[0, 0])[1][:, 0]
        inequalities = self.points.unit + self._homogeneous(rows)
        starts = sorted((vector, -vector), key=lambda q: self._missed(inequalities, q))
        if self._missed(inequalities, starts[0]) <= 0:
            return starts[0]
        for start in starts:
            found = self._unit_iteration(start, gram, equations, inequalities)
            if found is not None:
                return found
        return None

    def _unit_iteration(
        self, start: Floats, gram: Floats, equations: Floats, inequalities: Inequalities
    ) -> Floats | None:
        q = start
        for _ in range(UNIT_STEPS):
            length = np.append(gram @ q, 1.0)[None]
            solution = self._solved(self._programme(np.concatenate([equations, length]), inequalities))
            if solution is None:
                return None
            unit = solution / np.sqrt(solution @ gram @ solution)
            if np.abs(unit - q).max() <= 1e-9 * np.abs(unit).max():
                return unit
            q = unit
        raise NotSolvedError(f"the coefficients of length 1 did not settle in {UNIT_STEPS} steps")

    def _missed(self, rows: Inequalities, q: Floats) -> float:
        """The largest miss of an inequality; without any, the sign that makes alpha positive."""
        if not len(rows.rows):
            return -float(self.space.guard.mean_alpha @ q) if self.space.guard.alphas else 0.0
        return float((rows.at_least - rows.rows @ q).max())

    def _homogeneous(self, rows: Inequalities) -> Inequalities:
        """Guard rows, which refer to a mean alpha of 1, for any scale."""
        if not len(rows.rows):
            return rows
        shifted = rows.rows - rows.at_least[:, None] * self.space.guard.mean_alpha
        return Inequalities(shifted, np.zeros(len(shifted))).unit

    @cached_property
    def _hessian(self) -> Floats:
        """The Hessian of the first quadratic form to be minimised."""
        return (self.space.thin_plate if self.energy.on_surface else self._form) + self._near

    @cached_property
    def _near(self) -> Floats:
        total = np.zeros((self.basis.size, self.basis.size))
        for weight, values in zip(self.wishes.near_weights, self._asked.values("near"), strict=True):
            row = to_doubles(fmpq_mat([values]))
            total += 2 * to_float(weight) * row.T @ row
        return total

    @cached_property
    def points(self) -> Inequalities:
        """The inequalities of the points wished to be inside and outside."""
        rows = Inequalities.none(self.basis.size)
        for kind, sign in SIDES:
            for values in self._asked.values(kind):
                rows += Inequalities(sign * to_doubles(fmpq_mat([values])), np.array([self._margin]))
        return rows

    def _on(self, functional: Functional) -> list[fmpq]:
        """Exact values of a functional on the working basis."""
        values = functional.on(self.basis.members)
        return list((self.basis.transform * fmpq_mat(self.basis.size, 1, values)).entries())


@dataclass(frozen=True)
class ExactRows:
    """The exact equations of wishes for members on a partition; `on` gives the values (m,) of a functional on these."""

    wishes: Wishes
    partition: Partition
    degree: int
    on: Callable[[Functional], list[fmpq]]

    def values(self, kind: str) -> list[list[fmpq]]:
        """The members' values at the points of a kind: a row (m,) for each."""
        points = enumerate(getattr(self.wishes, kind))
        return [self._value(point, self.wishes.describe((kind, i))) for i, point in points]

    def equations(self, change: fmpq_mat) -> list[list[fmpq]]:
        """All equations with their right-hand sides, rows (m + 1,), where the coefficients in the solution space's
        basis are `change` (m, m) times those of the members."""
        wishes, m = self.wishes, change.nrows()
        rows = [[*values, fmpq(0)] for values in self.values("through")]
        for handle, value in wishes.handles:
            rows.append([*self.on(b_coefficient(self.partition, handle, self.degree)), value])
        for number, value in wishes.coefficients:
            column = check_member(number, m)
            rows.append([*(change[i, column] for i in range(m)), value])
        normalize = wishes.normalize
        if isinstance(normalize, SumOfCoefficients):
            rows.append([*(change * fmpq_mat(m, 1, [1] * m)).entries(), fmpq(1)])
        elif isinstance(normalize, ValueAt):
            rows.append([*self._value(normalize.point, "the normalisation's point"), normalize.value])
        return rows

    def _value(self, point: Vector, name: str) -> list[fmpq]:
        return self.on(value_at(self.partition, point, self.degree, name))


def _reduce(table: list[list[fmpq]], m: int) -> tuple[fmpq_mat, list[int]] | None:
    """Row reduction with the columns ordered by how well the equations determine them."""
    floats = to_doubles(fmpq_mat(len(table), m + 1, [v for row in table for v in row]))[:, :m]
    order = [int(j) for j in qr(floats, pivoting=True, mode="r")[1]]
    permuted = fmpq_mat(len(table), m + 1, [row[j] for row in table for j in (*order, m)])
    reduced, rank = permuted.rref()
    rows = reduced.tolist()[:rank]
    pivots = leads(reduced, rank)
    if m in pivots:
        return None
    back = [order.index(j) for j in range(m)]
    equations = fmpq_mat(rank, m + 1, [row[j] for row in rows for j in (*back, m)])
    return equations, [order[pivot] for pivot in pivots]
