"""Lifting: the multipliers of one polynomial that meets a contact.

A member g of `<f, h^(k+1)>` is `gamma f + beta h^(k+1)`, and (gamma + q h^(k+1), beta - q f) serve
as well (the Koszul syzygy is the only one, f and h having no common factor).  With gamma reduced
modulo h^(k+1) the multipliers are unique, and no degree is raised.

If g has degree n, the products need not: in `y - 1 = (xy - 1) - y (x - 1)` the top-degree forms
cancel.  They have degree n where those of f and h have no common factor (Macaulay 1916).
"""

from __future__ import annotations

from typing import Any

from flint import fmpq, fmpq_mpoly

from pas.algebra.buchberger import TupleEncoding, graded_basis, vector_degree
from pas.algebra.curve import leading_form
from pas.algebra.ideal import Ideal
from pas.algebra.monomials import Exponents
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import RING, Polynomial
from pas.contacts.contact import Contact


def lift(polynomial: Any, contact: Contact, order: int) -> tuple[Polynomial, Polynomial]:
    """The multipliers (gamma, beta) with `polynomial = gamma f + beta h^(k+1)`, gamma reduced.

    gamma is a remainder modulo h^(k+1) (no term divisible by its leading one), which makes them
    unique.  Raises `ValueError` where the polynomial does not meet the contact with GC^`order`.
    """
    target, f, power = Polynomial(polynomial), contact.surface, contact.clip ** (order + 1)
    top = product_degree(contact, order, max(target.degree, 0))
    ideal = Ideal(power)
    unknowns = ideal.standard(top - f.degree)
    columns = [(number, _shifted(f.raw, shift)) for number, shift in enumerate(unknowns)]
    columns.append((len(unknowns), _shifted(-target.raw, (0, 0, 0))))
    system = ideal.equations(columns, max(top, target.degree, 0))
    # f is no zero divisor modulo h^(k+1): the target's own unknown is the only one that can be free
    solutions = [row for row in nullspace(system, len(unknowns) + 1).tolist() if row[-1] != 0]
    if not solutions:
        raise ValueError(f"the polynomial {target} does not meet {contact} with GC^{order}")
    scale = 1 / solutions[0][-1]
    terms = {e: v * scale for e, v in zip(unknowns, solutions[0], strict=False) if v != 0}
    gamma = RING.from_dict(terms)
    beta, remainder = divmod(target.raw - gamma * f.raw, power.raw)
    if not remainder.is_zero():
        raise ArithmeticError("a lifting that was found is none")  # pragma: no cover
    return Polynomial.from_raw(gamma), Polynomial.from_raw(beta)


def product_degree(contact: Contact, order: int, degree: int) -> int:
    """A degree of products gamma f and beta h^(k+1) that is enough for all members of `degree`.

    It is `degree` itself where the top-degree forms of f and h have no common factor (pipes);
    otherwise the members of a graded Groebner basis of `<f, h^(k+1)>` tell, by the power of t that
    brings each, made homogeneous with t, into the ideal of the homogenised f and h^(k+1).
    """
    surface, power = contact.surface.raw, contact.clip.raw ** (order + 1)
    if leading_form(surface).gcd(leading_form(contact.clip.raw)).is_constant():
        return degree
    encoding = TupleEncoding((0,))
    basis = graded_basis([encoding.write((p,), vector_degree((p,))) for p in (surface, power)])
    excess = 0
    for g in contact.ideal(order).basis:
        own = vector_degree((g,))
        while own <= degree and not basis.reduce(encoding.write((g,), own + excess)).is_zero():
            excess += 1
    return degree + excess


def _shifted(polynomial: fmpq_mpoly, shift: Exponents) -> list[tuple[Exponents, fmpq]]:
    """The terms of a polynomial times a monomial."""
    i, j, k = shift
    return [((int(a) + i, int(b) + j, int(c) + k), value) for (a, b, c), value in polynomial.to_dict().items()]
