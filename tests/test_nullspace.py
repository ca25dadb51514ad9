"""Nullspaces by dense and by sparse elimination, against a naive one and sympy."""

from __future__ import annotations

import random
import time
from fractions import Fraction

import numpy as np
import pytest
import sympy
from flint import fmpq, fmpq_mat, fmpz_mat
from hypothesis import given, settings
from hypothesis import strategies as st

import pas
from pas.algebra import nullspace as module
from pas.algebra.nullspace import integral, nullspace, solve_sparse

NUMBERS = st.builds(Fraction, st.integers(-9, 9), st.integers(1, 5))
SYSTEMS = st.integers(1, 9).flatmap(
    lambda n: st.tuples(st.lists(st.dictionaries(st.integers(0, n - 1), NUMBERS, max_size=4), max_size=12), st.just(n))
)


def exact(rows):
    return [{j: fmpq(v.numerator, v.denominator) for j, v in row.items()} for row in rows]


def reduced(rows, unknowns) -> list[list[Fraction]]:
    """The reduced basis by naive elimination from the last unknown, in fractions."""
    table = [[Fraction(row.get(j, 0)) for j in reversed(range(unknowns))] for row in rows]
    pivots: list[int] = []
    for column in range(unknowns):
        rank = len(pivots)
        lead = next((i for i in range(rank, len(table)) if table[i][column]), None)
        if lead is None:
            continue
        table[rank], table[lead] = table[lead], table[rank]
        table[rank] = [v / table[rank][column] for v in table[rank]]
        for i in range(len(table)):
            if i != rank and table[i][column]:
                table[i] = [a - table[i][column] * b for a, b in zip(table[i], table[rank], strict=True)]
        pivots.append(column)
    basis = []
    for free in sorted(set(range(unknowns)) - set(pivots), reverse=True):
        member = [Fraction(0)] * unknowns
        member[unknowns - 1 - free] = Fraction(1)
        for i, pivot in enumerate(pivots):
            member[unknowns - 1 - pivot] = -table[i][free]
        basis.append(member)
    return basis


def as_fractions(matrix: fmpq_mat) -> list[list[Fraction]]:
    return [[Fraction(int(v.p), int(v.q)) for v in row] for row in matrix.tolist()]


@pytest.mark.parametrize(("dense", "prime"), [(10**6, module.FIRST_PRIME), (10**6, 2), (0, module.FIRST_PRIME)])
@settings(max_examples=60, deadline=None)
@given(system=SYSTEMS)
def test_the_reduced_basis_is_that_of_naive_elimination(dense, prime, system):
    rows, unknowns = system
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "DENSE", dense)
        patch.setattr(module, "FIRST_PRIME", prime)
        assert as_fractions(nullspace(exact(rows), unknowns)) == reduced(rows, unknowns)


@pytest.mark.parametrize(
    ("table", "pivots"),
    [
        pytest.param([[2, 1, 0], [0, 0, 2]], [0, 2], id="a pivot would be later, and a row too few"),
        pytest.param([[2, 1, 0], [0, 2, 1]], [0, 1], id="both pivots would be later"),
        pytest.param([[1, 1, 0], [1, 3, 0], [0, 0, 1]], [0, 1, 2], id="two rows would be one"),
        pytest.param([[2, 4, 6]], [0], id="nothing would be left"),
    ],
)
def test_what_a_prime_gets_wrong_is_noticed(monkeypatch, table, pivots):
    """Modulo 2 each of these has other pivots than over the rationals."""
    monkeypatch.setattr(module, "FIRST_PRIME", 2)
    found, values, denominator = module.bound_values(table)
    reduced, common, rank = fmpz_mat(table).rref()
    assert found == pivots and rank == len(pivots)
    free = [j for j in range(3) if j not in pivots]
    assert values == [[reduced[i, j] * denominator / common for j in free] for i in range(rank)]


@settings(max_examples=60, deadline=None)
@given(SYSTEMS)
def test_sparse_solutions_are_all_of_them(system):
    rows, unknowns = system
    solved = solve_sparse(exact(rows), unknowns)
    assert len(solved.free) + len(solved.bound) == unknowns
    matrix = sympy.Matrix(len(rows), unknowns, lambda i, j: sympy.Rational(rows[i].get(j, 0))) if rows else None
    assert len(solved.bound) == (matrix.rank() if matrix is not None else 0)
    for free in solved.free:
        member = [Fraction(0)] * unknowns
        member[free] = Fraction(1)
        for j, values in solved.bound.items():
            value = values.get(free, fmpq(0))
            member[j] = Fraction(int(value.p), int(value.q))
        assert all(sum(v * member[j] for j, v in row.items()) == 0 for row in rows)


def test_a_larger_system_both_ways(monkeypatch):
    """30 equations in 25 unknowns of rank 17, with numerators of a hundred digits."""
    generator = np.random.default_rng(11)
    left = [[int(v) for v in row] for row in generator.integers(-3, 4, (30, 17))]
    big = 10**100 + 3
    right = [
        {int(j): Fraction(int(generator.integers(1, 9)) * big + 1, 7) for j in generator.choice(25, 4)}
        for _ in range(17)
    ]
    rows = []
    for combination in left:
        total: dict[int, Fraction] = {}
        for a, row in zip(combination, right, strict=True):
            for j, v in row.items():
                total[j] = total.get(j, 0) + a * v
        rows.append({j: v for j, v in total.items() if v})
    dense = nullspace(exact(rows), 25)
    monkeypatch.setattr(module, "DENSE", 0)
    assert nullspace(exact(rows), 25) == dense
    rank = fmpq_mat(
        [[fmpq(r.get(j, Fraction(0)).numerator, r.get(j, Fraction(0)).denominator) for j in range(25)] for r in right]
    ).rank()
    assert dense.nrows() == 25 - rank


def test_degenerate_systems():
    assert nullspace([], 3) == fmpq_mat(3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1])
    assert nullspace([{}], 2).nrows() == 2
    assert nullspace([{0: fmpq(2)}, {1: fmpq(1, 3)}], 2).nrows() == 0
    assert integral({0: fmpq(2, 3), 4: fmpq(4, 9), 5: fmpq(0)}) == {0: 3, 4: 2}


def test_limits_stop_sparse_elimination_and_break_nothing():
    rows = [{i: fmpq(1), i + 1: fmpq(2), (i * 7) % 200: fmpq(3)} for i in range(199)]
    before = [dict(row) for row in rows]
    with (
        pas.limit(seconds=1e-9),
        pytest.raises(pas.LimitError, match="while eliminating 199 equations in 200 unknowns"),
    ):
        solve_sparse(rows, 200)
    assert rows == before
    assert len(solve_sparse(rows, 200).free) >= 1


def test_long_eliminations_end_with_the_limit():
    """Of many long numbers, which combine rows with a short basis of their nullspace."""
    generator, size, free = random.Random(1), 60, 10
    short = [
        [int(i == j) if j >= free else generator.randrange(-9, 9) for j in range(size + free)]
        for i in range(free, size + free)
    ]
    long = fmpz_mat(size, size, [generator.getrandbits(2000) for _ in range(size**2)]) * fmpz_mat(short)
    rows = [{j: fmpq(v) for j, v in enumerate(row)} for row in long.tolist()]
    began = time.monotonic()
    with pytest.raises(pas.LimitError, match="while eliminating 60 x 70"), pas.limit(seconds=0.01):
        nullspace(rows, size + free)
    assert time.monotonic() - began < 5
    basis = nullspace(rows, size + free)
    assert basis.nrows() == free and not any((fmpq_mat(short) * basis.transpose()).entries())
