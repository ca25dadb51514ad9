"""Products of whole matrices that stand for rational ones, and what is worked out from few of their digits."""

from __future__ import annotations

import random

import numpy as np
import pytest
from flint import fmpq, fmpq_mat, fmpz_mat

from pas.algebra.matrices import Products
from pas.fairing.basis import orthonormal, to_doubles


def whole(rows: int, columns: int, bits: int, seed: int) -> fmpz_mat:
    draw = random.Random(seed)
    return fmpz_mat(rows, columns, [draw.getrandbits(bits) * draw.choice((-1, 1)) for _ in range(rows * columns)])


@pytest.fixture
def products() -> Products:
    return Products(whole(3, 5, 900, 1), (whole(5, 4, 20, 2), whole(5, 6, 20, 3)), 7**40)


def test_products_are_those_of_the_matrices(products):
    expected = [fmpq_mat(products.rows * table) * fmpq(1, 7**40) for table in products.tables]
    assert list(products.matrices) == expected
    assert [fmpq(v) / 7**40 for v in products.row(1, 2)] == expected[1].tolist()[2]
    some = whole(2, 3, 8, 4)
    assert [fmpq_mat(m) * fmpq(1, 7**40) for m in products.combined(some)] == [fmpq_mat(some) * m for m in expected]


def test_given_matrices_stay(products):
    again = Products.of(products.matrices)
    assert again.matrices == products.matrices
    assert again.size == products.size
    assert [fmpq(v) / again.denominator for v in again.row(0, 1)] == products.matrices[0].tolist()[1]


@pytest.mark.parametrize("cancel", [0, 300, 1200])
def test_few_digits_serve_even_where_members_cancel(cancel):
    """Members whose combinations are 2^cancel times as large as they are themselves."""
    huge = 1 << cancel
    rows = whole(3, 4, 40, 5).tolist()
    table = whole(4, 6, 10, 6).tolist()
    # two generators that are nearly the same, taken with opposite signs
    rows = [[*row, huge * 3**50 + int(row[0]), -huge * 3**50] for row in rows]
    table = [*table, table[0], table[0]]
    source = Products(fmpz_mat([[int(v) for v in row] for row in rows]), (fmpz_mat(table),))
    change, (doubles,) = orthonormal(source, lambda tables: tables[0].T)
    exact = to_doubles(change.matrix * source.matrices[0])
    assert doubles == pytest.approx(exact, rel=1e-12, abs=1e-12 * np.abs(exact).max())
    assert np.linalg.cond(doubles) < 1e4
