"""A method of solving of one's own: undetermined coefficients, as in a textbook, with sympy alone.

A polynomial g meets `f = 0` along `h = 0` with GC^k iff `g = alpha f + beta h^(k+1)`.  Here g and every alpha and beta
are written out with unknown coefficients, and their terms compared.  No ideals are needed where the terms of highest
degree of f and h have no common factor, since alpha and beta then need no higher degree than g has.  A method gives a
basis: a list of polynomials for one piece, or of tuples with one polynomial for each piece.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import sympy
from sympy.polys.matrices import DomainMatrix

import pas

SYMBOLS = sympy.symbols("x y z")


def _times_monomials(polynomial: Any, degree: int) -> list[Any]:
    """All products of a polynomial and monomials of at most a degree."""
    room = degree - polynomial.total_degree()
    exponents = [e for e in product(range(room + 1), repeat=3) if sum(e) <= room]
    return [polynomial * sympy.Poly({e: 1}, *SYMBOLS) for e in exponents]


def _solve(placed: Any, degree: int) -> list[Any]:
    """A basis of all g: the unknowns are its coefficients, and for each contact those of alpha and beta."""
    monomials = _times_monomials(sympy.Poly(1, *SYMBOLS), degree)
    columns = [[*monomials]]  # what is multiplied by unknowns in each equation, with the sign it has there
    for contact in placed.contacts:
        f, h = (sympy.Poly(p.to_sympy(), *SYMBOLS) for p in (contact.surface, contact.clip))
        columns.append([-p for factor in (f, h ** (placed.order + 1)) for p in _times_monomials(factor, degree)])
    rows, start, width = [], len(monomials), sum(map(len, columns))
    for multiples in columns[1:]:
        for place, monomial in enumerate(monomials):
            (exponent,) = monomial.monoms()
            row = [0] * width
            row[place] = 1
            for number, multiple in enumerate(multiples, start):
                row[number] = multiple.coeff_monomial(exponent)
            rows.append(row)
        start += len(multiples)
    exact = [[sympy.QQ(c.p, c.q) for c in map(sympy.Rational, row)] for row in rows]
    found = DomainMatrix(exact, (len(rows), width), sympy.QQ).nullspace().to_Matrix()
    mine = found[:, : len(monomials)]  # without alpha and beta, of which there may be several for one g
    basis, pivots = DomainMatrix.from_Matrix(mine).to_field().rref()
    members = basis.to_Matrix().tolist()[: len(pivots)]
    return [sum(c * m.as_expr() for c, m in zip(row, monomials, strict=True)) for row in members]


UNDETERMINED = pas.register_method(pas.SolvingMethod("undetermined coefficients", _solve))
