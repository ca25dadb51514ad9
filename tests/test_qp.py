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
]


@pytest.mark.parametrize(("problem", "optimum"), CASES)
def test_optima(problem, optimum):
    solution = solve(problem)
    assert solution.outcome is Outcome.SOLVED
    assert solution.unknowns == pytest.approx(optimum, abs=1e-5)


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
