"""The choice as a convex programme: without constraints of one's own it is the usual one, with them they hold."""

from __future__ import annotations

import cvxpy
import numpy as np
import pytest
from conftest import EQUAL, UNEQUAL, pipes

import pas

LOW, HIGH = ("1/4", "1/4", "1/4"), ("-3/10", "-3/10", "-3/10")


@pytest.fixture(scope="module")
def space():
    return pas.solutions(pipes(UNEQUAL), 1, 4)


def test_the_plain_problem_is_the_usual_choice(space):
    usual = space.fit(energy=pas.ThinPlate())
    found = space.problem().solve()
    assert found.certificate.proved and found.plate == pas.ThinPlate()
    assert found.energy == pytest.approx(usual.energy, rel=0.05)


def test_a_constraint_of_ones_own_holds_and_the_surface_is_proved(space):
    """The function has one value at two points, which it has not without being asked, and a slope that is bounded."""
    free = space.problem().solve()
    problem = space.problem()
    low, high = problem.values([LOW]), problem.values([HIGH])
    line = problem.values([(t, t, t) for t in ("1/4", "3/10", "7/20")])
    found = problem.solve([low == high, cvxpy.norm(cvxpy.diff(line)) <= 0.03])
    assert found.certificate.proved
    at = [float(v) for v in found.surface(np.array([[0.25] * 3, [-0.3] * 3]))]
    before = [float(v) for v in free.surface(np.array([[0.25] * 3, [-0.3] * 3]))]
    assert at[0] == pytest.approx(at[1], abs=1e-7) and abs(before[0] - before[1]) > 1e-3
    along = found.surface(np.array([[0.25] * 3, [0.3] * 3, [0.35] * 3]))
    assert np.linalg.norm(np.diff(along)) < 0.03 + 1e-7
    assert found.energy > free.energy
    assert np.array_equal(found.space.member(found.coefficients).patches, found.surface.patches)


def test_points_and_terms_go_together(space):
    point = ("-1/5", "-1/5", "-1/5")
    problem = space.problem(through=[point])
    found = problem.solve(term=100 * cvxpy.sum_squares(problem.values([LOW]) + 0.1))
    assert found.surface([-0.2] * 3) == pytest.approx(0, abs=1e-15)


def test_users_may_solve_it_themselves(space):
    problem = space.problem(prove=False)
    with pytest.raises(ValueError, match="no solution yet"):
        problem.member()
    cvxpy.Problem(cvxpy.Minimize(problem.energy), problem.constraints).solve(solver=cvxpy.CLARABEL)
    assert isinstance(problem.missed(), list) and problem.member().dimension == space.dimension
    assert "25 variables" in repr(problem)


def test_what_cannot_be_is_said(space):
    with pytest.raises(ValueError, match="quadratic form"):
        space.problem(energy=pas.CurvatureVariation())
    problem = space.problem()
    with pytest.raises(pas.InfeasibleError, match="cvxpy says of the constraints in degree 4: infeasible"):
        problem.solve([problem.values([LOW]) >= 1, problem.values([LOW]) <= 0])
    with pytest.raises(pas.NoSolutionError):
        pas.solutions(pipes(EQUAL), 3, 3).problem()
