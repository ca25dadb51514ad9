"""Least quotients refined: every digit right, from starts that have a few."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb, fmpq, fmpq_mat
from hypothesis import given, settings
from hypothesis import strategies as st

import pas
from pas.blending.refining import refined


def hilbert(n):
    """The worst of bases: of condition 10^13 for n = 10."""
    return fmpq_mat([[fmpq(1, i + j + 1) for j in range(n)] for i in range(n)])


def identity(n):
    return fmpq_mat([[fmpq(int(i == j)) for j in range(n)] for i in range(n)])


def ones(n):
    return [arb(1)] * n


@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(1, 9), min_size=2, max_size=7, unique=True), st.integers(0, 6), st.integers(-9, 9))
def test_the_vector_is_found_to_the_last_digit(roots, place, error):
    n, place = len(roots), place % len(roots)
    start = np.full(n, error * 1e-4)
    start[place] = 1.0
    diagonal = fmpq_mat([[fmpq(r * int(i == j)) for j in range(n)] for i, r in enumerate(roots)])
    vector, quotient = refined(start, diagonal, identity(n), (ones(n), ones(n)), identity(n))
    assert np.abs(np.delete(vector, place)).max() < 1e-45
    assert quotient == roots[place] ** 2


def test_a_change_of_basis_does_not_cost_digits():
    """In the rows of a Hilbert matrix doubles keep three digits; the vector comes out whole all the same."""
    n = 10
    weights, change = [arb(i + 1) for i in range(n)], hilbert(n)
    exact = change.inv().tolist()[0]  # times `change`: the first unit vector, the quotient of which is 1
    start = np.array([float(int(v.p) / int(v.q)) for v in exact])
    vector, quotient = refined(start, change, change, (weights, ones(n)), change)
    assert vector[0] != 0
    assert np.abs(vector[1:]).max() < 1e-30 * abs(vector[0])
    assert quotient == 1


def test_what_has_no_single_answer_is_left_alone():
    assert refined(np.array([1.0, 0.0]), identity(2), identity(2), (ones(2), ones(2)), identity(2)) is None


def test_a_quotient_that_vanishes_is_zero():
    above = fmpq_mat([[fmpq(0), fmpq(0)], [fmpq(0), fmpq(1)]])
    vector, quotient = refined(np.array([1.0, 1e-6]), above, identity(2), (ones(2), ones(2)), identity(2))
    assert (abs(vector[1]) < 1e-100, quotient) == (True, 0.0)


@pytest.mark.parametrize("by_gradient", [False, True])
def test_the_space_has_it(by_gradient):
    """The quotient of the member that comes out is the one that is told, worked out from its values alone."""
    space = pas.solutions([("x^2+y^2+z^2-1", "z"), ("x^2+y^2-1", "z-2")], 1, 3, pas.SingleCell())
    points = np.random.default_rng(2).uniform(-1, 1, (30, 3)).round(3)
    fit = space.least_squares(points.tolist(), by_gradient=by_gradient)
    member = fit.surface.polynomials[0]
    below = (member.gradient(points) ** 2).sum() if by_gradient else sum(c**2 for c in member.coefficients().values())
    assert fit.quotient == pytest.approx((member(points) ** 2).sum() / float(below), rel=1e-10)
