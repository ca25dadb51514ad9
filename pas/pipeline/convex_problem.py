"""The choice of a member as a convex programme of cvxpy, to which users add constraints and terms of their own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Generic

import numpy as np

from pas.algebra.inputs import short, shown, whole
from pas.arrays import Floats
from pas.blending.space import Space
from pas.errors import InfeasibleError, NotProvedError, NotSolvedError, optional
from pas.fairing.constraints import Inequalities
from pas.fairing.contradictions import check_wishes
from pas.fairing.energy import as_energy
from pas.fairing.prepared import SETTINGS, SLIM, SampledConditions
from pas.fairing.solver import FitSolver, Iterate
from pas.fairing.wishes import PointsLike, UnitCoefficients, Wishes, exact_points
from pas.limits import checkpoint
from pas.pipeline.chosen import B

SOLVED, INFEASIBLE = ("optimal", "optimal_inaccurate"), ("infeasible", "infeasible_inaccurate")
"""The words of cvxpy for the outcomes of programmes."""


class ConvexProblem(Generic[B]):
    """The choice of one member of a solution space by a quadratic energy, in the language of cvxpy.

        corner = [pas.Pipe((1, 0, 0), "1/3", 1), pas.Pipe((0, 1, 0), "1/4", 1), pas.Pipe((0, 0, 1), "2/5", 1)]
        problem = pas.solutions(corner, 1, 4).problem()
        values = problem.values([("1/4", "1/4", "1/4"), ("-3/10", "-3/10", "-3/10")])
        blend = problem.solve([values[0] == values[1]])

    `variable` (m,) holds the coordinates in the space's working basis; `energy` is the expression that is made small,
    in the user's units; `constraints` are the normalisation, the points and handles that are wished for, and
    inequalities at samples that ask for clean walls, clip faces and a centre inside.  That the surface is one sheet
    cannot be said beforehand: `missed` gives what a solution lacks of it, and `solve` goes on until nothing is missed.
    Made by `SolutionSpace.problem`.
    """

    def __init__(self, blends: type[B], space: Space, wishes: Wishes) -> None:
        space.check_not_empty()
        wishes = wishes.changed(energy=as_energy(wishes.energy))
        if as_energy(wishes.energy).on_surface or isinstance(wishes.normalize, UnitCoefficients):
            raise ValueError(
                "a convex problem needs an energy that is a quadratic form, such as pas.ThinPlate(), and another "
                "normalisation than pas.UnitCoefficients()"
            )
        check_wishes(wishes, space.placed)
        self.blends, self.space, self.wishes = blends, space, wishes
        self._solver = FitSolver(space.prepared, wishes)
        self._conditions = SampledConditions(space.prepared, SLIM)
        cvxpy = optional("cvxpy")
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
        return self._stated(self._missed_rows())

    def member(self) -> B:
        """The blend of the solution, rounded so that exact equations hold exactly; it is proved when first asked.

        Raises `ValueError` before there is a solution, `InfeasibleError` where rounding moves a wished point across.
        """
        iterate = Iterate(self._found, self._conditions.first, SETTINGS.damping)
        fitted = self._solver.rounded(iterate, self._conditions.share)
        return self.blends.of(self.space, fitted, self.wishes, {}, ())

    def solve(self, constraints: Sequence[Any] = (), *, term: Any = 0.0, rounds: int = SETTINGS.rounds) -> B:
        """The member of least energy, and of a convex `term` added to it, under one's own constraints too.

        Constraints of one sheet are added where they are missed, for so many rounds.  Raises `InfeasibleError` where
        constraints contradict, naming those of one's own that do, `NotSolvedError` where there is no least member or
        cvxpy's solver fails, `NotProvedError` where proofs are wished for and the surface found does not pass them,
        and `TypeError` or `ValueError` for what is no convex constraint or term.
        """
        given, term = check_constraints(constraints), check_term(term)
        rows = Inequalities.none(self.space.dimension)
        most_rounds = 1000  # rounds that may be asked for
        for _ in range(whole(rounds, "rounds", 1, most_rounds)):
            checkpoint(f"solving a convex problem of degree {self.space.degree}")
            status = self._status(self.energy + term, [*self.constraints, *given, *self._stated(rows)])
            if status in INFEASIBLE:
                error = self._conflict(given, rows)
                self.variable.value = None  # that of the last probe for the conflict is no solution
                raise error
            if status not in SOLVED:
                raise NotSolvedError(f"the energy with the term has no least value that cvxpy finds: it says {status}")
            missed = self._missed_rows()
            if not len(missed):
                break
            rows += missed
        found = self.member()
        if self.wishes.prove and not found.certificate.proved:
            failed = next(v for v in found.certificate.verdicts if not v.proved)
            raise NotProvedError(f"the surface of degree {self.space.degree} is not proved: {failed}", found)
        return found

    def _status(self, objective: Any, constraints: Sequence[Any]) -> str:
        """The status that cvxpy gives of a programme; raises `NotSolvedError` where its solver fails."""
        cvxpy = optional("cvxpy")
        problem = cvxpy.Problem(cvxpy.Minimize(objective), list(constraints))
        try:
            problem.solve(solver=cvxpy.CLARABEL)
        except cvxpy.SolverError as error:
            raise NotSolvedError(f"cvxpy's solver failed in degree {self.space.degree}: {error}") from None
        return str(problem.status)

    def _conflict(self, given: Sequence[Any], rows: Inequalities) -> InfeasibleError:
        """An error naming an irreducible set of the user's constraints that contradict, or those of the problem itself
        where these cannot be met without any others (deletion filter)."""
        own, degree = [*self.constraints, *self._stated(rows)], self.space.degree
        if not given or self._status(0.0, own) in INFEASIBLE:
            first = self._conditions.first if self.wishes.guard else Inequalities.none(self.space.dimension)
            return self._solver.programme.conflict(first + rows)
        kept = dict(enumerate(given))
        for number in range(len(given)):
            others = {n: constraint for n, constraint in kept.items() if n != number}
            if self._status(0.0, [*own, *others.values()]) in INFEASIBLE:
                kept = others
        names = [f"constraints[{number}]" for number in kept]
        text = f"{names[0]} cannot be met" if len(names) == 1 else f"{' and '.join(names)} contradict one another"
        if self._status(0.0, list(kept.values())) not in INFEASIBLE:
            text += f" beside what the problem itself asks in degree {degree}"
        return InfeasibleError(f"{text}; without constraints of your own there is a solution", names)

    def _missed_rows(self) -> Inequalities:
        """The inequalities of one sheet that the solution misses."""
        return self._conditions.missed(self._found) if self.wishes.guard else Inequalities.none(self.space.dimension)

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


def check_constraints(constraints: Any) -> list[Any]:
    """One's own constraints as a list; raises `TypeError` for what are no constraints of cvxpy, and `ValueError` for
    those that are not convex by its rules."""
    cvxpy = optional("cvxpy")
    right = "of cvxpy, such as problem.values([point]) <= 0"
    if isinstance(constraints, str | cvxpy.Constraint) or not isinstance(constraints, Iterable):
        raise TypeError(f"constraints must be a list of constraints {right}, not {shown(constraints)}")
    found = list(constraints)
    for number, constraint in enumerate(found):
        if not isinstance(constraint, cvxpy.Constraint | bool):
            raise TypeError(f"constraints[{number}] must be a constraint {right}, not {shown(constraint)}")
        if not isinstance(constraint, bool) and not constraint.is_dcp():
            raise ValueError(f"constraints[{number}] must be convex by cvxpy's rules; {short(str(constraint))} is not")
    return found


def check_term(term: Any) -> Any:
    """What is added to the energy; raises `TypeError` for what is neither a number nor an expression of cvxpy, and
    `ValueError` for one that is not a single convex value."""
    cvxpy = optional("cvxpy")
    right = "a number or a convex expression of cvxpy with a single value"
    if not isinstance(term, int | float | np.number | cvxpy.Expression):
        raise TypeError(f"term must be {right}, not {shown(term)}")
    expression = cvxpy.Constant(term) if not isinstance(term, cvxpy.Expression) else term
    if expression.size != 1 or not expression.is_convex():
        raise ValueError(f"term must be {right}; {short(str(term))} is not")
    return term
