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
    with pytest.raises(pas.NoSolutionError):
        pas.solutions(pipes(EQUAL), 3, 3).problem()


def test_constraints_that_contradict_are_named(space):
    """Among themselves, with what the problem asks, and those of the problem alone: others are not blamed."""
    problem = space.problem()
    low, high, size = problem.values([LOW])[0], problem.values([HIGH])[0], cvxpy.norm(problem.variable)
    with pytest.raises(
        pas.InfeasibleError, match=r"constraints\[0\] and constraints\[2\] contradict one another; "
    ) as two:
        problem.solve([low >= 1, high <= 1, low <= 0])
    assert two.value.conflict == ("constraints[0]", "constraints[2]")
    with pytest.raises(
        pas.InfeasibleError, match=r"\[1\] cannot be met beside what the problem itself asks in degree 4"
    ):
        problem.solve([high <= 1, size <= 1e-3])
    with pytest.raises(pas.InfeasibleError, match=r"constraints\[0\] cannot be met; without constraints of your own"):
        problem.solve([size <= -1])
    apart = space.problem(outside=[("1/10", "1/10", "1/10")])
    with pytest.raises(pas.InfeasibleError, match="the constraint outside") as own:
        apart.solve([problem.values([LOW]) <= 1])
    assert own.value.conflict and "constraints[" not in str(own.value)
    with pytest.raises(ValueError, match="no solution yet"):
        apart.member()
    with pytest.raises(pas.NotSolvedError, match="no least value that cvxpy finds: it says unbounded"):
        problem.solve(term=cvxpy.Variable())


@pytest.mark.parametrize(
    ("arguments", "error", "sentence"),
    [
        (
            lambda p: {"constraints": "x"},
            TypeError,
            "constraints must be a list of constraints of cvxpy, .*'x'",
        ),
        (lambda p: {"constraints": 1}, TypeError, "constraints must be a list of constraints of cvxpy"),
        (lambda p: {"constraints": p.energy <= 1}, TypeError, "constraints must be a list of constraints of cvxpy"),
        (
            lambda p: {"constraints": [True, 1]},
            TypeError,
            r"s\[1\] must be a constraint of cvxpy, .*, not 1",
        ),
        (lambda p: {"constraints": [p.energy >= 1]}, ValueError, r"constraints\[0\] must be convex by cvxpy's rules"),
        (lambda p: {"term": "x"}, TypeError, "term must be a number or a convex expression of cvxpy .*, not 'x'"),
        (lambda p: {"term": -p.energy}, ValueError, "term must be a number or a convex expression"),
        (lambda p: {"term": p.variable}, ValueError, "term must be a number or a convex expression"),
        (lambda p: {"rounds": 0}, ValueError, "rounds must be a whole number from 1"),
    ],
)
def test_misuse_is_one_sentence(space, arguments, error, sentence):
    problem = space.problem()
    with pytest.raises(error, match=sentence) as caught:
        problem.solve(**arguments(problem))
    assert "\n" not in str(caught.value)
