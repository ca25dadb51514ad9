"""Picking one member of a solution space: a quadratic programme, then exact rounding.

Minimise the energy (and the squared values at `near` points) over the space, subject to one
normalisation, the user's points and the guard rows.  The answer is rounded to rationals of
modest size; the exact equations among the constraints (`through` points, a value, a sum) are
then solved exactly for the coefficients that they determine best, so they hold exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import floor, log2

import numpy as np
from flint import fmpq, fmpq_mat
from scipy.linalg import qr

from pas.algebra.monomials import Floats, exponents
from pas.algebra.polynomial import RING, Polynomial
from pas.algebra.rational import Vector, to_float
from pas.errors import InfeasibleError, NotSolvedError
from pas.fairing.basis import WorkingBasis, to_doubles
from pas.fairing.constraints import DEFAULT_MARGIN, Constraints, MeanAlpha, SumOfCoefficients
from pas.fairing.energy import Box, ThinPlate
from pas.fairing.guard import LADDER, Guard, Margins, Rows
from pas.fairing.qp import Outcome, Programme, feasible, solve
from pas.partition.cells import Partition
from pas.surface.contact import Contact
from pas.surface.piecewise import PiecewiseSurface
from pas.surface.proofs import violations

FRACTION_BITS = 36
"""Coefficients are rounded to this many bits below the largest: 10 digits, of which a basis as
badly conditioned as `pas.fairing.basis.CONDITION` may cost four."""

ROUNDING = 1e-7
"""What rounding and the solver may cost a point without margin, over the region's radius."""

SIDES = (("inside", -1.0), ("outside", 1.0))
"""The kinds of points with an inequality, and the sign of f there."""

EXCHANGE_ROUNDS = 16
"""Rounds of the exchange method before a degree is given up; successes took 1 to 10."""


@dataclass(frozen=True)
class Choice:
    """A member: its exact surface, its working coefficients, and the guard rows it was found with."""

    surface: PiecewiseSurface
    working: fmpq_mat
    rows: Rows
    margins: Margins | None
    rounds: int


class Fairing:
    """The choice among the members of one solution space, for one energy.

    `patches[p]` (m, C(n+3, 3)) are the members' patches in local coordinates, exact.
    """

    def __init__(
        self,
        partition: Partition,
        contacts: Sequence[Contact],
        order: int,
        degree: int,
        patches: Sequence[fmpq_mat],
        energy: ThinPlate,
    ) -> None:
        self.partition, self.contacts, self.order, self.degree = partition, tuple(contacts), order, degree
        self.energy = energy
        self.basis = WorkingBasis.of(partition.local, patches, degree)

    @cached_property
    def guard(self) -> Guard:
        """The guard rows of this space."""
        zero = [Polynomial(0)] * len(self.partition.pieces)
        return Guard(self.basis, PiecewiseSurface(self.partition, self.contacts, self.order, zero, self.degree))

    @cached_property
    def hessian(self) -> Floats:
        """The energy matrix H in the working basis, in the user's units: `1/2 q^T H q`."""
        if self.energy.domain is None:
            factor = self.basis.cell_energy
        else:
            frame = self.partition.frame
            box = Box(frame.local_point(self.energy.domain.lower), frame.local_point(self.energy.domain.upper))
            factor = self.basis.box_energy(self.energy.piece, box)
        return factor.T @ factor * (to_float(self.energy.weight) / to_float(self.partition.frame.scale))

    def energy_of(self, working: fmpq_mat) -> float:
        """The energy of a member."""
        q = to_doubles(working)[0]
        return float(q @ self.hessian @ q) / 2

    def surface(self, working: fmpq_mat) -> PiecewiseSurface:
        """The exact surface with given working coefficients (1, m)."""
        monomials = exponents(self.degree)
        patches = []
        for entries in self.basis.combine(working):
            terms = {e: c for e, c in zip(monomials, entries, strict=True) if c != 0}
            patches.append(Polynomial.from_raw(RING.from_dict(terms)))
        return PiecewiseSurface(self.partition, self.contacts, self.order, patches, self.degree)

    def choose(self, constraints: Constraints, rows: Rows) -> fmpq_mat:
        """The optimal member under the constraints and guard rows, rounded: (1, m), exact.

        Raises `InfeasibleError`, naming an irreducible set of conflicting points where the
        conflict involves the user's, and `NotSolvedError` where the solvers failed.
        """
        problem = _Problem(self, constraints)
        solution = problem.optimum(rows)
        if solution is None:
            raise self._conflict(constraints, rows)
        return problem.rounded(solution)

    def choose_proved(self, constraints: Constraints) -> Choice:
        """The first member on the ladder of margins whose inequalities are all proved.

        Raises `InfeasibleError` where there is none.
        """
        failure: InfeasibleError | None = None
        for margins in LADDER:
            try:
                choice = self._exchange(constraints, margins)
            except InfeasibleError as error:
                failure = error
                continue
            if choice is not None:
                return choice
        raise failure or InfeasibleError(
            f"no member of degree {self.degree} passed the proofs in {EXCHANGE_ROUNDS} rounds of new constraints"
        )

    def _exchange(self, constraints: Constraints, margins: Margins) -> Choice | None:
        """The exchange method for one set of margins; None where it does not converge."""
        rows = self.guard.initial(margins)
        for number in range(1, EXCHANGE_ROUNDS + 1):
            working = self.choose(constraints, rows)
            surface = self.surface(working)
            found = violations(surface)
            cuts = self.guard.cuts(found, margins, to_doubles(working)[0])
            if not found.none and not cuts.violated_by(to_doubles(working)[0]):
                # the points left open satisfy their conditions: look closer
                found = violations(surface, deep=True)
                cuts = self.guard.cuts(found, margins, to_doubles(working)[0])
            if found.none:
                return Choice(surface, working, rows, margins, number)
            if not cuts.violated_by(to_doubles(working)[0]):
                return None
            rows += cuts
        return None

    def choose_guarded(self, constraints: Constraints) -> Choice:
        """The optimum under the sampled guard rows alone, with the widest margins that can be.

        Without proofs to point to failures, the sheet condition is asked everywhere.
        """
        for margins in (m for m in LADDER if m.everywhere):
            rows = self.guard.initial(margins)
            try:
                working = self.choose(constraints, rows)
            except InfeasibleError as error:
                failure = error
                continue
            return Choice(self.surface(working), working, rows, margins, 1)
        raise failure

    def choose_plain(self, constraints: Constraints) -> Choice:
        """The optimum under the user's constraints alone."""
        rows = Rows.none(self.basis.size)
        working = self.choose(constraints, rows)
        return Choice(self.surface(working), working, rows, None, 1)

    def _conflict(self, constraints: Constraints, rows: Rows) -> InfeasibleError:
        """An error naming an irreducible infeasible set of the user's points (deletion filter)."""
        points = list(constraints.hard())
        if not points or not _Problem(self, constraints.without(points)).possible(rows):
            return InfeasibleError(
                f"no member of degree {self.degree} has clean contacts, walls and a single sheet at the sampled points"
                if len(rows.rows)
                else f"no member of degree {self.degree} satisfies the normalisation"
            )
        dropped: list[tuple[str, int]] = []
        for point in points:
            if not _Problem(self, constraints.without([*dropped, point])).possible(rows):
                dropped.append(point)
        conflict = [constraints.describe(p) for p in points if p not in dropped]
        if len(conflict) == 1:
            text = f"the point constraint {conflict[0]} cannot be met by any member of degree {self.degree}"
        else:
            text = f"the point constraints {', '.join(conflict)} contradict one another in degree {self.degree}"
        return InfeasibleError(text, conflict)


class _Problem:
    """One quadratic programme over the working coefficients, with its exact equations."""

    def __init__(self, fairing: Fairing, constraints: Constraints) -> None:
        self.fairing, self.constraints, self.basis = fairing, constraints, fairing.basis
        self.exact = self._exact_equations()

    def optimum(self, rows: Rows) -> Floats | None:
        """The optimal working coefficients, or None where the constraints conflict."""
        if self.exact is None:
            return None
        solution = solve(self._programme(rows))
        if solution.outcome is Outcome.FAILED:
            raise NotSolvedError(
                f"neither solver found an optimum that passes its checks in degree {self.fairing.degree}"
            )
        return solution.unknowns if solution.outcome is Outcome.SOLVED else None

    def possible(self, rows: Rows) -> bool:
        """Whether all constraints can hold together."""
        return self.exact is not None and feasible(self._programme(rows))

    def rounded(self, q: Floats) -> fmpq_mat:
        """Nearby rationals that satisfy the exact equations exactly.

        Raises `InfeasibleError` where a point of the user's does not hold for them, exactly.
        """
        assert self.exact is not None
        shift = floor(log2(np.abs(q).max())) - FRACTION_BITS
        step = fmpq(2**shift) if shift >= 0 else fmpq(1, 2**-shift)
        result = fmpq_mat(1, len(q), [round(float(x) / to_float(step)) * step for x in q])
        equations, pivots = self.exact
        for i, pivot in enumerate(pivots):
            others = sum((equations[i, j] * result[0, j] for j in range(len(q)) if j not in pivots), fmpq(0))
            result[0, pivot] = equations[i, len(q)] - others
        slack = max(self._margin / 2, ROUNDING * self._radius)
        for kind, sign in SIDES:
            for item in ((kind, index) for index in range(len(getattr(self.constraints, kind)))):
                value = (self.basis.exact_values(*self._place(item)) * result.transpose())[0, 0]
                if sign * to_float(value) < self._margin - slack:
                    raise InfeasibleError(f"the point constraint {self.constraints.describe(item)} is missed narrowly")
        return result

    @property
    def _radius(self) -> float:
        """The radius of the region in the user's units."""
        partition = self.fairing.partition
        return float(np.linalg.norm(partition.local.points, axis=1).max()) * to_float(partition.frame.scale)

    @property
    def _margin(self) -> float:
        margin = self.constraints.margin
        return DEFAULT_MARGIN * self._radius if margin is None else to_float(margin)

    def _programme(self, rows: Rows) -> Programme:
        assert self.exact is not None
        m = self.basis.size
        hessian, scale = self._hessian()
        equations = to_doubles(self.exact[0]) if self.exact[0].nrows() else np.empty((0, m + 1))
        if isinstance(self.constraints.normalize, MeanAlpha):
            equations = np.concatenate([equations, np.append(self.fairing.guard.mean_alpha(), 1.0)[None]])
        unit = np.linalg.norm(equations[:, :m], axis=1, keepdims=True)
        equations = equations / unit
        inequalities = self._points() + rows
        lengths = np.linalg.norm(inequalities.rows, axis=1)
        lengths = np.where(lengths > 0, lengths, 1.0)
        return Programme(
            hessian / scale,
            np.zeros(m),
            equations[:, :m],
            equations[:, m],
            inequalities.rows / lengths[:, None],
            inequalities.at_least / lengths,
        )

    def _hessian(self) -> tuple[Floats, float]:
        hessian = self.fairing.hessian
        for piece, local in map(self._place, self._near()):
            row = to_doubles(self.basis.exact_values(piece, local))
            hessian = hessian + 2 * to_float(self.constraints.near_weight) * row.T @ row
        return hessian, float(np.abs(hessian).max()) or 1.0

    def _near(self) -> list[tuple[str, int]]:
        return [("near", i) for i in range(len(self.constraints.near))]

    def _points(self) -> Rows:
        rows = Rows.none(self.basis.size)
        for kind, sign in SIDES:
            for index in range(len(getattr(self.constraints, kind))):
                piece, local = self._place((kind, index))
                values = to_doubles(self.basis.exact_values(piece, local))
                rows += Rows(sign * values, np.array([self._margin]))
        return rows

    def _exact_equations(self) -> tuple[fmpq_mat, list[int]] | None:
        """The exact equations in reduced form with their pivots; None where they contradict."""
        m = self.basis.size
        table: list[list[fmpq]] = []
        for index in range(len(self.constraints.through)):
            piece, local = self._place(("through", index))
            table.append([*self.basis.exact_values(piece, local).entries(), fmpq(0)])
        normalize = self.constraints.normalize
        if isinstance(normalize, SumOfCoefficients):
            ones = fmpq_mat(m, 1, [1] * m)
            table.append([*(self.basis.transform * ones).entries(), fmpq(1)])
        elif not isinstance(normalize, MeanAlpha):
            piece, local = self.fairing.partition.place(normalize.point, "the normalisation's point")
            table.append([*self.basis.exact_values(piece, local).entries(), normalize.value])
        if not table:
            return fmpq_mat(0, m + 1), []
        return _reduce(table, m)

    def _place(self, item: tuple[str, int]) -> tuple[int, Vector]:
        return self.fairing.partition.place(
            getattr(self.constraints, item[0])[item[1]], self.constraints.describe(item)
        )


def _reduce(table: list[list[fmpq]], m: int) -> tuple[fmpq_mat, list[int]] | None:
    """Row reduction with the columns ordered by how well the equations determine them."""
    floats = to_doubles(fmpq_mat(len(table), m + 1, [v for row in table for v in row]))[:, :m]
    order = [int(j) for j in qr(floats, pivoting=True, mode="r")[1]]
    permuted = fmpq_mat(len(table), m + 1, [row[j] for row in table for j in (*order, m)])
    reduced, rank = permuted.rref()
    rows = reduced.tolist()[:rank]
    leads = [next(j for j, v in enumerate(row) if v != 0) for row in rows]
    if m in leads:
        return None
    back = [order.index(j) for j in range(m)]
    equations = fmpq_mat(rank, m + 1, [row[j] for row in rows for j in (*back, m)])
    return equations, [order[lead] for lead in leads]
