"""The normal form conditions as a linear system: the published counts, and membership."""

from __future__ import annotations

import json

import pytest
from conftest import DATA

import pas
from pas import Ideal, contact_ideal, normal_form_system

PUBLISHED = json.loads((DATA / "normal_forms.json").read_text())
COUNTS = [(name, int(degree)) for name, case in PUBLISHED.items() for degree in case["counts"]]


def pairs(name):
    return [tuple(pair) for pair in PUBLISHED[name]["pairs"]]


def span(polynomials, degree):
    """The same span as a reduced set: coefficient rows in echelon form."""
    import sympy

    rows = [[p.coefficients().get(e, 0) for e in pas.algebra.monomials.exponents(degree)] for p in polynomials]
    return sympy.Matrix(rows).rref()[0] if rows else None


@pytest.mark.parametrize(("name", "degree"), COUNTS)
def test_published_counts(name, degree):
    system = normal_form_system(pairs(name), 1, degree)
    counted = [system.raw, system.distinct, system.rank, system.dimension]
    assert counted == PUBLISHED[name]["counts"][str(degree)]
    assert system.rank + system.dimension == system.unknowns
    assert f"{system.distinct} distinct equations" in str(system)


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_printed_surface_is_a_solution(name):
    printed = pas.Polynomial(PUBLISHED[name]["member"])
    system = normal_form_system(pairs(name), 1, printed.degree)
    terms = printed.coefficients()
    exponents = pas.algebra.monomials.exponents(printed.degree)
    for form in system.equations:
        assert sum(c * pas.algebra.rational.rational(terms.get(exponents[u], 0)) for u, c in form.items()) == 0


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("degree", [3, 4])
@pytest.mark.parametrize("name", PUBLISHED)
def test_solutions_are_the_members_of_the_intersection(name, order, degree):
    """For regular surfaces and radical curves G^k and membership agree (ideals are intersected otherwise)."""
    common = contact_ideal(pairs(name)[0], order)
    for pair in pairs(name)[1:]:
        common = common & contact_ideal(pair, order)
    system = normal_form_system(pairs(name), order, degree)
    assert span(system.solutions, degree) == span(common.members(degree), degree)


def test_a_curve_that_is_not_reduced_shows_the_difference():
    """Along z = 0, x^2 = 0 the conditions modulo <z, x^2> admit x^3, which is not in <z, x^4>."""
    contact = ("z", "x^2")
    solutions = Ideal(*normal_form_system([contact], 1, 3).solutions)
    assert solutions == Ideal("z", "x^3")
    assert contact_ideal(contact, 1) == Ideal("z", "x^4")


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        (([], 1, 3), ValueError, "at least one contact"),
        (([("z", "x")], -1, 3), ValueError, "order must be a whole number from 0"),
        (([("z", "x")], 1, 0), ValueError, "degree must be a whole number from 1"),
        (([("z", "x")], 1, "3"), TypeError, "degree must be a whole number"),
        ((["z"], 1, 3), TypeError, r"contacts\[0\] must be a Pipe"),
    ],
)
def test_errors(arguments, error, words):
    with pytest.raises(error, match=words):
        normal_form_system(*arguments)
