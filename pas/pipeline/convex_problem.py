"""The choice of a member as a convex programme of cvxpy, to which users add constraints and terms of their own."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any, Generic

import numpy as np

from pas.algebra.monomials import Floats
from pas.errors import InfeasibleError, NoSolutionError, NotProvedError
from pas.fairing.contradictions import check_wishes
from pas.fairing.energy import as_energy
from pas.fairing.fit_settings import SETTINGS
from pas.fairing.sampled import Inequalities
from pas.fairing.solver import FitSolver, Iterate, RayConditions
from pas.fairing.wishes import PointsLike, UnitCoefficients, Wishes, exact_points
from pas.limits import checkpoint
from pas.pipeline.chosen import B, FitSpace


class MemberProblem(Generic[B]):
    """The choice of one member of a space by a quadratic energy, in the language of cvxpy; see `pas.ConvexProblem`."""

    def __init__(self, space: FitSpace[B], wishes: Wishes) -> None:
        if space.dimension == 0:
            raise NoSolutionError(f"the solution space of degree {space.degree} is empty", {space.degree: 0})
        wishes = wishes.changed(energy=as_energy(wishes.energy))
        if as_energy(wishes.energy).on_surface or isinstance(wishes.normalize, UnitCoefficients):
            raise ValueError(
                "a convex problem needs an energy that is a quadratic form, such as pas.ThinPlate(), and another "
                "normalisation than pas.UnitCoefficients()"
            )
        check_wishes(wishes, space.placed)
        self.space, self.wishes = space, wishes
        self._solver = FitSolver(space.prepared, wishes)
        self._conditions = RayConditions(space.prepared, SETTINGS.lattices[0], SETTINGS.margins[-1], SETTINGS.clean)
        cvxpy: Any = import_module("cvxpy")
        programme = self._solver.programme
        if programme.exact is None:
            raise programme.conflict(Inequalities.none(space.dimension))
        self.variable: Any = cvxpy.Variable(space.dimension, name="coordinates")
        self.energy: Any = cvxpy.quad_form(self.variable, cvxpy.psd_wrap(programme.quadratic_part)) / 2
        self.constraints: list[Any] = [programme.equations[:, :-1] @ self.variable == programme.equations[:, -1]]
        self.constraints += self._stated(programme.points)
        if wishes.guard:
            self.constraints += self._stated(self._conditions.first)

    def values(self, points: PointsLike) -> Any:
        """The values (N,) of the surface's function at points, three exact numbers each, as a cvxpy expression."""
        rows = self.space.prepared.basis.transform * self.space.values(exact_points(points, "points")).transpose()
        table = np.array([[float(v.p) / float(v.q) for v in row] for row in rows.transpose().tolist()])
        return table @ self.variable

    def missed(self) -> list[Any]:
        """Constraints that the solution misses along rays from the centre, where it crosses them less than once
        clearly; none where it is one sheet as far as these see.  Raises `ValueError` before there is a solution."""
        rows = self._conditions.missed(self._found) if self.wishes.guard else Inequalities.none(self.space.dimension)
        return self._stated(rows)

    def member(self) -> B:
        """The blend of the solution, rounded so that exact equations hold exactly; it is proved when first asked.

        Raises `ValueError` before there is a solution, `InfeasibleError` where rounding moves a wished point across.
        """
        iterate = Iterate(self._found, self._conditions.first, SETTINGS.damping)
        fitted = self._solver.rounded(iterate, self._conditions.share)
        return self.space.blend(fitted, self.wishes, {}, ())

    def solve(self, constraints: Sequence[Any] = (), *, term: Any = 0.0, rounds: int = SETTINGS.rounds) -> B:
        """The member of least energy, and of a convex `term` added to it, under one's own constraints too.

        Constraints of one sheet are added where they are missed, for so many rounds.  Raises `InfeasibleError` where
        cvxpy finds no solution, `NotProvedError` where proofs are wished for and the surface found does not pass them.
        """
        cvxpy: Any = import_module("cvxpy")
        asked = [*self.constraints, *constraints]
        for _ in range(rounds):
            checkpoint(f"solving a convex problem of degree {self.space.degree}")
            problem = cvxpy.Problem(cvxpy.Minimize(self.energy + term), asked)
            problem.solve(solver=cvxpy.CLARABEL)
            if problem.status not in (cvxpy.OPTIMAL, cvxpy.OPTIMAL_INACCURATE):
                raise InfeasibleError(f"cvxpy says of the constraints in degree {self.space.degree}: {problem.status}")
            missed = self.missed()
            if not missed:
                break
            asked += missed
        found = self.member()
        if self.wishes.prove and not found.certificate.proved:
            failed = next(v for v in found.certificate.verdicts if not v.proved)
            raise NotProvedError(f"the surface of degree {self.space.degree} is not proved: {failed}", found)
        return found

    @property
    def _found(self) -> Floats:
        if self.variable.value is None:
            raise ValueError("the problem has no solution yet: solve it by cvxpy, or by its method solve")
        return np.asarray(self.variable.value)

    def _stated(self, rows: Inequalities) -> list[Any]:
        """Inequalities as cvxpy says them, with rows of unit length."""
        if not len(rows):
            return []
        lengths = np.linalg.norm(rows.rows, axis=1)
        lengths = np.where(lengths > 0, lengths, 1.0)
        return [(rows.rows / lengths[:, None]) @ self.variable >= rows.at_least / lengths]

    def __repr__(self) -> str:
        return f"<ConvexProblem of degree {self.space.degree}, {self.space.dimension} variables>"
