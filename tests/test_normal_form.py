"""Normal forms against sympy's reduction."""

from __future__ import annotations

import pytest
import sympy
from flint import fmpq, fmpq_mat
from hypothesis import given, settings
from hypothesis import strategies as st

from pas import Polynomial
from pas.algebra.ideal import Ideal
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import RING

X, Y, Z = sympy.symbols("x y z")
IDEALS = [
    ["y^2 + z^2 - 1/9", "(x - 1)^3"],
    ["(x - z)^2"],
    ["x*y - z^2", "y^3 - x^2*z", "x + y + z"],
    ["x^2 + y*z - 3/7", "2*x*y + z/5"],
]


@pytest.mark.parametrize("generators", IDEALS)
@pytest.mark.parametrize("expression", ["(x + 2*y - z)^5", "x^4*y*z + 1/3*y^6", "7"])
def test_agrees_with_sympy(generators, expression):
    polynomials = [Polynomial(g) for g in generators]
    form = Ideal(*polynomials)
    basis = sympy.groebner([p.to_sympy() for p in polynomials], X, Y, Z, order="grevlex")
    p = Polynomial(expression)
    expected = Polynomial(sympy.reduced(p.to_sympy(), list(basis.exprs), X, Y, Z, order="grevlex")[1])
    assert Polynomial.from_raw(form.reduce(p.raw)) == expected
    images = form.images(p.degree)
    total: dict = {}
    for e, c in p.raw.to_dict().items():
        for m, v in images[e].items():
            total[m] = total.get(m, 0) + c * v
    assert Polynomial.from_raw(RING.from_dict(total)) == expected


@pytest.mark.parametrize("generators", IDEALS)
def test_reduced_basis_is_sympys(generators):
    polynomials = [Polynomial(g) for g in generators]
    ours = {Polynomial.from_raw(g) for g in Ideal(*polynomials).basis}
    theirs = sympy.groebner([p.to_sympy() for p in polynomials], X, Y, Z, order="grevlex").exprs
    monic = {Polynomial(sympy.Poly(e, X, Y, Z).monic(auto=True).as_expr()) for e in theirs}
    # sympy's monic() divides by its own leading coefficient in lex order; compare up to scale
    assert {p / p.raw.leading_coefficient() for p in monic} == ours


def test_zero_ideal_is_refused():
    with pytest.raises(ValueError, match="not zero"):
        Ideal.from_raw(RING.constant(0))


rationals = st.fractions(min_value=-5, max_value=5, max_denominator=7)


@settings(max_examples=15, deadline=None)
@given(st.lists(st.lists(rationals, min_size=6, max_size=6), max_size=7))
def test_nullspace_is_sympys(rows):
    sparse = [{j: fmpq(v.numerator, v.denominator) for j, v in enumerate(row) if v} for row in rows]
    basis = nullspace(sparse, 6)
    matrix = sympy.Matrix(len(rows), 6, [sympy.Rational(v.numerator, v.denominator) for row in rows for v in row])
    assert basis.nrows() == 6 - matrix.rank()
    assert basis.nrows() == 0 or basis.rank() == basis.nrows()
    if rows and basis.nrows():
        dense = fmpq_mat([[fmpq(v.numerator, v.denominator) for v in row] for row in rows])
        assert all(v == 0 for v in (dense * basis.transpose()).entries())
