"""Ideals: the published intersections, and agreement with sympy."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
import sympy
from conftest import DATA

import pas
from pas import Ideal, Polynomial, contact_ideal

X, Y, Z, W = sympy.symbols("x y z w")
PUBLISHED = json.loads((DATA / "ideals.json").read_text())


def intersection(case) -> Ideal:
    first, *others = (contact_ideal(tuple(pair), case["order"]) for pair in case["pairs"])
    for other in others:
        first = first & other
    return first


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_intersections(name):
    case = PUBLISHED[name]
    ideal = intersection(case)
    for degree, dimension in case["dim"].items():
        assert len(ideal.members(int(degree))) == dimension
    assert ideal.lowest_degree() == min(int(d) for d, n in case["dim"].items() if n)
    for g in case.get("members", []):
        assert g in ideal
    if "generators" in case:
        assert ideal == Ideal(*case["generators"])
    if "basis" in case:
        basis = [Polynomial(g) for g in case["basis"]]
        assert all(g in ideal for g in basis)
        assert ideal == Ideal(*basis)
        assert len(ideal.groebner_basis()) == len(basis)


@pytest.mark.parametrize("name", PUBLISHED)
def test_members_are_in_every_ideal_by_sympy(name):
    case = PUBLISHED[name]
    for g in intersection(case).groebner_basis():
        for surface, clip in case["pairs"]:
            generators = [Polynomial(surface).to_sympy(), Polynomial(clip).to_sympy() ** (case["order"] + 1)]
            basis = sympy.groebner(generators, X, Y, Z, order="grevlex", domain="QQ")
            assert basis.contains(g.to_sympy())


SMALL = [
    (["x^2 + y^2 - 1", "z^2"], ["y - z", "x*z - 1/3"]),
    (["x*y", "y*z"], ["x^2", "z"]),
    (["x - 1"], ["y^2 - z"]),
    (["x", "y"], ["x", "z"]),
    (["x^2 + 2*x*y - z", "y^2/3 - 5"], ["x", "y", "z"]),
    (["x", "x - 1"], ["y^2"]),
]


@pytest.mark.parametrize(("first", "second"), SMALL)
def test_intersections_are_those_of_elimination(first, second):
    """w I + (1 - w) J without w, by sympy in an elimination order."""
    a, b = ([Polynomial(g).to_sympy() for g in ideal] for ideal in (first, second))
    mixed = [W * g for g in a] + [(1 - W) * g for g in b]
    basis = sympy.groebner(mixed, W, X, Y, Z, order="lex")
    eliminated = Ideal(*[g for g in basis.exprs if W not in g.free_symbols])
    assert Ideal(*first) & Ideal(*second) == eliminated
    assert Ideal(*second) & Ideal(*first) == eliminated


@pytest.mark.parametrize("order", ["grevlex", "grlex", "lex"])
@pytest.mark.parametrize(
    "generators", [s for pair in SMALL for s in pair] + [["x^3 - y*z", "y^2 - x*z", "z^2 - x^2*y"]]
)
def test_groebner_bases_are_sympys(order, generators):
    ours = Ideal(*generators).groebner_basis(order)
    theirs = sympy.groebner([Polynomial(g).to_sympy() for g in generators], X, Y, Z, order=order).exprs
    assert set(ours) == {Polynomial(g) for g in theirs}


def test_membership_and_normal_forms():
    ideal = Ideal("x^2 + y^2 - 1", "z - x")
    assert "(x^2 + y^2 - 1)*(x + 3) - 7*(z - x)*y^5" in ideal
    assert "x" not in ideal
    assert ideal.normal_form("x^2 + y^2") == 1
    assert ideal.contains(0)


def test_a_list_of_generators_is_taken_as_well():
    ideal = Ideal("x*y - 1", "z")
    assert Ideal(["x*y - 1", "z"]) == Ideal(ideal.generators) == Ideal(ideal.groebner_basis()) == ideal
    assert Ideal(["x"]) == Ideal("x") and Ideal({(1, 0, 0): 1}) == Ideal("x")
    with pytest.raises(ValueError, match="needs a generator"):
        Ideal([])


def test_arithmetic():
    ideal = Ideal("x", "y")
    assert ideal**2 == Ideal("x^2", "x*y", "y^2") == ideal * ideal
    assert Ideal("x") + Ideal("y") == ideal == Ideal("x + y", "y")
    assert hash(ideal) == hash(Ideal("y", "x"))
    assert Ideal("x", "x - 1").is_whole_ring
    assert not ideal.is_whole_ring
    assert Ideal("x") & Ideal("x") == Ideal("x")
    assert Ideal("x^2") & Ideal("x*y") == Ideal("x^2*y")
    assert [len(Ideal("x").members(d)) for d in range(4)] == [0, 1, 4, 10]


def test_contact_ideals_of_pipes():
    pipe = pas.Pipe((1, 0, 0), "1/3", 1)
    assert contact_ideal(pipe, 2) == Ideal("y^2 + z^2 - 1/9", "(x - 1)^3") == contact_ideal(pipe.contact, 2)


def test_large_numerators():
    big = 10**100 + 1
    first, second = (
        contact_ideal((f"x^2 + y^2 - {big}", "z - 1/3"), 1),
        contact_ideal(("x^2 + z^2 - 4", f"y - {big}/7"), 1),
    )
    assert [len((first & second).members(d)) for d in (3, 4)] == [0, 4]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (Ideal, "generator that is not zero"),
        (lambda: Ideal(0, "x - x"), "generator that is not zero"),
        (lambda: Ideal("w"), "variable 'w'"),
        (lambda: Ideal("x").groebner_basis("degrevlex"), "order must be one of grevlex, grlex, lex"),
        (lambda: Ideal("x").members(-1), "degree must be a whole number"),
        (lambda: Ideal("x") ** 0, "exponent of an ideal"),
        (lambda: contact_ideal(("x", "y"), -1), "order must be a whole number"),
        (lambda: contact_ideal(("x", "x*y"), 1), "common factor"),
    ],
)
def test_errors(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_bases_with_long_numbers_hold_all_generators():
    """Coefficients beyond the first room: what is given must not be lost on the way."""
    far = Polynomial({(1, 0, 0): 7, (0, 1, 0): -5, (0, 0, 1): 3, (0, 0, 0): Fraction(3**700, 10**333 + 1)})
    ideal = Ideal("x^2 + y^2 - x - 1/10^30", "z^2 + x - 1 + 1/10^30", far)
    assert all(g in ideal for g in ideal.generators)
    assert len(ideal.groebner_basis()) == 3
