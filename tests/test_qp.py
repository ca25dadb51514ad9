"""The door to the solver: optima with checked conditions, and infeasibility."""

from __future__ import annotations

import numpy as np
import pytest

from pas.fairing import qp
from pas.fairing.qp import Outcome, Programme, checked, feasible, solve


def programme(hessian, linear, equalities=(), equal_to=(), rows=(), at_least=()):
    m = len(linear)
    return Programme(
        np.array(hessian, dtype=float),
        np.array(linear, dtype=float),
        np.array(equalities, dtype=float).reshape(-1, m),
        np.array(equal_to, dtype=float),
        np.array(rows, dtype=float).reshape(-1, m),
        np.array(at_least, dtype=float),
    )


CASES = [
    (programme(np.eye(2), [0, 0], [[1, 1]], [1]), [0.5, 0.5]),
    (programme(np.eye(2), [0, 0], [[1, 1]], [1], [[1, 0]], [0.8]), [0.8, 0.2]),
    (programme(np.diag([2, 1]), [-2, -4], (), (), [[-1, 0], [0, -1]], [-0.5, -3]), [0.5, 3]),
    (programme(np.diag([1, 0]), [0, 1], (), (), [[0, 1]], [-2]), [0, -2]),
    (programme(np.diag([1, 1e-12, 1e-12]), [-1, -1e-12, 1e-12], (), (), [[0, 1, 1]], [-5]), [1, 1, -1]),
]


@pytest.mark.parametrize(("problem", "optimum"), CASES)
def test_optima(problem, optimum):
    solution = solve(problem)
    assert solution.outcome is Outcome.SOLVED
    assert solution.unknowns == pytest.approx(optimum, abs=1e-5)


@pytest.mark.parametrize("seed", range(8))
def test_a_hessian_of_condition_1e13_is_solved(seed):
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(24, 24)))[0]
    hessian, rows, optimum = (
        (turn * np.geomspace(1, 1e-13, 24)) @ turn.T,
        rng.normal(size=(200, 24)),
        rng.normal(size=24),
    )
    active = np.arange(200) < 5
    linear = rows[active].T @ rng.uniform(1e-8, 1e-7, 5) - hessian @ optimum
    problem = programme(hessian, linear, (), (), rows, rows @ optimum - np.where(active, 0, rng.uniform(0.1, 1, 200)))
    solution = solve(problem)
    assert solution.outcome is Outcome.SOLVED
    assert rows[active] @ solution.unknowns == pytest.approx(rows[active] @ optimum, abs=1e-6)


def test_a_hessian_that_rounding_alone_makes_definite_is_singular():
    nearly = np.array([[1, 1], [1, 1 + 2.0**-52]])
    assert np.linalg.cholesky(nearly)[1, 1] > 0
    assert qp._root(nearly) is None
    assert qp._root(nearly + np.diag([0, 1e-13])) is not None


def test_where_the_search_for_active_rows_starts_does_not_change_the_optimum():
    rng = np.random.default_rng(3)
    root, rows = rng.normal(size=(6, 6)), rng.normal(size=(60, 6))
    problem = programme(root @ root.T, rng.normal(size=6), (), (), rows, rows @ rng.normal(size=6) - 0.1)
    plain = solve(problem).unknowns
    for near in (plain, -plain, np.zeros(6), *rng.normal(scale=9, size=(20, 6))):
        started = solve(problem, near)
        assert started.outcome is Outcome.SOLVED and started.unknowns == pytest.approx(plain, abs=1e-7)


@pytest.mark.parametrize(
    "problem",
    [
        programme(np.eye(2), [0, 0], [[1, 0], [1, 0]], [0, 1]),
        programme(np.eye(2), [0, 0], (), (), [[1, 0], [-1, 0]], [1e-4, 1e-4]),
        programme(np.eye(1), [0], [[1]], [1], [[1]], [2]),
    ],
)
def test_contradictions(problem):
    assert solve(problem).outcome is Outcome.INFEASIBLE


def test_feasible():
    assert feasible(CASES[0][0])
    assert not feasible(programme(np.eye(1), [0], (), (), [[1], [-1]], [1, 0]))


def test_wrong_answers_are_not_let_through(monkeypatch):
    problem = CASES[1][0]
    assert checked(problem, np.array([0.7, 0.3])).outcome is Outcome.FAILED  # violates
    assert checked(problem, np.array([0.9, 0.1])).outcome is Outcome.FAILED  # not optimal
    assert checked(problem, np.array([0.8, 0.2])).outcome is Outcome.SOLVED
    monkeypatch.setattr(qp, "_daqp", lambda *_: (np.array([0.9, 0.1]), 1))
    assert solve(problem).outcome is Outcome.FAILED


def test_numbers_beyond_doubles_are_a_failure_and_no_error():
    programme = Programme(np.diag([1, np.nan, 1]), np.ones(3), np.ones((1, 3)), np.ones(1), np.eye(3), np.zeros(3))
    assert solve(programme).outcome is Outcome.FAILED
