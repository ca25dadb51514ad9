"""Syzygies and submodules: agreement with sympy, the published generators, the promises."""

from __future__ import annotations

from math import comb

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import pas
from pas import Ideal, Polynomial, Submodule, contact_ideal, syzygies
from pas.algebra.monomials import count_members, exponents, homogeneous_exponents, minimal

X, Y, Z = sympy.symbols("x y z")
CASES = {
    "koszul 2": ["x^2 + y", "z^3 - 1"],
    "koszul 3": ["x", "y^2 - 1/2", "z^3 + x"],
    "coaxial cylinders": ["y^2+z^2-1", "(x-1)^2", "4-y^2-z^2", "-(x+1)^2"],
    "perpendicular cylinders": ["y^2+z^2-1", "(x-2)^2", "1-x^2-z^2", "-(y-2)^2"],
    "twisted cubic": ["x*z - y^2", "y - x^2", "z - x*y"],
    "common factor": ["x^2*y - x", "x*z", "x^3 - x"],
    "with zero": ["x - 1", 0, "y"],
    "unit": ["x", 1, "y^2 - z"],
    "homogeneous parts cancel": ["x*y - 1", "x - 1", "x + z^2"],
    "pairs": [("x", "y"), ("y", "z"), ("z", "x"), ("1", "x*y")],
    "zero entries": [("x^2", 0), (0, "y - 1"), ("z", "z"), (0, 0)],
    "three cylinders": [
        ("y^2+z^2-1", 0, "1-y^2-z^2"),
        ("(x-2)^2", 0, "-(x-2)^2"),
        ("1-x^2-z^2", "x^2+z^2-1", 0),
        ("-(y-2)^2", "(y-2)^2", 0),
        (0, "1-x^2-y^2", "x^2+y^2-1"),
        (0, "-(z-2)^2", "(z-2)^2"),
    ],
}


def as_tuples(case):
    return [v if isinstance(v, tuple) else (v,) for v in case]


def combine(coefficients, vectors):
    rows = [[Polynomial(p) for p in v] for v in vectors]
    return [
        sum((a * r[j] for a, r in zip(coefficients, rows, strict=True)), Polynomial(0)) for j in range(len(rows[0]))
    ]


def degree_of(syzygy, vectors):
    tops = [max(*(Polynomial(p).degree for p in v), 0) for v in vectors]
    return max(a.degree + d for a, d in zip(syzygy, tops, strict=True) if not a.is_zero)


def by_sympy(vectors):
    """Generators of the syzygies, by sympy's module Groebner bases."""
    ring = sympy.QQ.old_poly_ring(X, Y, Z, order="grevlex")
    module = ring.free_module(len(vectors[0])).submodule(*[[Polynomial(p).to_sympy() for p in v] for v in vectors])
    rows = module.syzygy_module().gens
    return [tuple(Polynomial(ring.to_sympy(a)) for a in row) for row in rows]


def test_what_syzygies_gives_submodules_take():
    found = syzygies(["x", "y", "z"])
    module = Submodule(*found)
    assert Submodule(found).generators == Submodule(list(found)).generators == module.generators
    assert Submodule(module.groebner_basis()).groebner_basis() == module.groebner_basis()
    assert Submodule(("x", "y")).generators == Submodule([("x", "y")]).generators == (("x", "y"),)
    assert Submodule("x").width == Submodule(["x"]).width == 1
    with pytest.raises(ValueError, match="generators must be at least one"):
        Submodule(())


@pytest.mark.parametrize("name", CASES)
def test_the_module_is_sympys(name):
    vectors = as_tuples(CASES[name])
    ours, theirs = syzygies(CASES[name]), by_sympy(vectors)
    assert all(all(p.is_zero for p in combine(s, vectors)) for s in [*ours, *theirs])
    assert Submodule(*ours) == Submodule(*theirs)


@pytest.mark.parametrize("name", CASES)
def test_generators_come_by_degree_and_none_is_a_combination_within_its_degree(name):
    vectors = as_tuples(CASES[name])
    found = syzygies(CASES[name])
    degrees = [degree_of(s, vectors) for s in found]
    assert degrees == sorted(degrees)
    for degree in range(max(degrees) + 1):
        bounded = syzygies(CASES[name], degree)
        assert all(degree_of(s, vectors) <= degree for s in bounded)
        span = rank([s for s, d in zip(found, degrees, strict=True) for s in multiples(s, degree - d)])
        assert len(bounded) == rank(bounded) == span == rank([*bounded, *spanned(found, degrees, degree)])
        for number in (i for i, d in enumerate(degrees) if d == degree):
            others, rest = found[:number] + found[number + 1 :], degrees[:number] + degrees[number + 1 :]
            assert rank(spanned(others, rest, degree)) < span


def multiples(syzygy, degree):
    return [tuple(Polynomial({e: 1}) * a for a in syzygy) for e in exponents(degree)] if degree >= 0 else []


def spanned(found, degrees, degree):
    return [m for s, d in zip(found, degrees, strict=True) for m in multiples(s, degree - d)]


def rank(rows):
    entries = [{(i, e): c for i, a in enumerate(row) for e, c in a.coefficients().items()} for row in rows]
    columns = sorted({key for row in entries for key in row})
    return (
        sympy.polys.matrices.DomainMatrix(
            [[sympy.QQ(*row.get(key, 0).as_integer_ratio()) for key in columns] for row in entries],
            (len(rows), len(columns)),
            sympy.QQ,
        ).rank()
        if rows and columns
        else 0
    )


@pytest.mark.parametrize("name", ["koszul 2", "koszul 3", "coaxial cylinders", "perpendicular cylinders"])
@pytest.mark.parametrize("degree", [2, 4, 6])
def test_the_dimension_in_a_degree_is_that_of_the_ideal_of_top_forms(name, degree):
    """The products of degree <= n span the members of degree n of the homogenised ideal."""
    polynomials = [Polynomial(p) for p in CASES[name]]
    unknowns = sum(comb(degree - p.degree + 3, 3) for p in polynomials if p.degree <= degree)
    w = sympy.Symbol("w")
    forms = [sympy.Poly(p.to_sympy(), X, Y, Z).homogenize(w) for p in polynomials]
    basis = sympy.groebner([f.as_expr() for f in forms], X, Y, Z, w, order="grevlex")
    leads = [sympy.Poly(g, X, Y, Z, w).monoms(order="grevlex")[0] for g in basis.exprs]
    image = sum(
        any(all(a <= b for a, b in zip(lead, e, strict=True)) for lead in leads)
        for e in homogeneous_exponents(degree, 4)
    )
    assert len(syzygies(CASES[name], degree)) == unknowns - image


@pytest.mark.parametrize("name", ["koszul 2", "koszul 3"])
def test_regular_sequences_have_koszul_syzygies_alone(name):
    f = [Polynomial(p) for p in CASES[name]]
    zero = Polynomial(0)
    koszul = [
        tuple(f[j] if n == i else -f[i] if n == j else zero for n in range(len(f)))
        for i in range(len(f))
        for j in range(i + 1, len(f))
    ]
    found = syzygies(f)
    assert len(found) == len(koszul)
    assert Submodule(*found) == Submodule(*koszul)


@pytest.mark.parametrize(
    ("name", "first", "second", "published"),
    [
        (
            "coaxial cylinders",
            ("y^2+z^2-1", "x-1"),
            ("y^2+z^2-4", "x+1"),
            [
                "4*y^2+4*z^2-16+(6-3*x)*(x+1)^2",
                "-4*x*(y^2+z^2-4)-3*(x+1)^2",
                "(y^2+z^2-1)*(x+1)^2",
                "(y^2+z^2-1)*(y^2+z^2-4)",
            ],
        ),
        (
            "perpendicular cylinders",
            ("y^2+z^2-1", "x-2"),
            ("x^2+z^2-1", "y-2"),
            [
                "(x+y-4)*(y^2+z^2-1)+(x+y)*(x-2)^2",
                "(z^2-4*y+11)*(y^2+z^2-1)+(z^2-4*x-5)*(x-2)^2",
                "(y^2-4*y+4)*(x-2)^2",
                "(y^2-4*y+4)*(y^2+z^2-1)+(y^2-4*y+4)*(x-2)^2",
                "(x^2+z^2-1)*(x-2)^2",
            ],
        ),
    ],
)
def test_the_published_generators_of_two_blends(name, first, second, published):
    f, power = (Polynomial(p) for p in CASES[name][:2])
    products = Ideal(*[a * f + b * power for a, b, _, _ in syzygies(CASES[name])])
    assert products == Ideal(*published)
    assert products == contact_ideal(first, 1) & contact_ideal(second, 1)


def test_irredundant_generators():
    found = Submodule(*syzygies(CASES["coaxial cylinders"]))
    fewer = found.irredundant()
    assert (len(found.generators), len(fewer.generators)) == (5, 3)  # a free module of rank 3
    assert fewer == found
    for number in range(3):
        others = Submodule(*(g for i, g in enumerate(fewer.generators) if i != number))
        assert fewer.generators[number] not in others
    assert len(Submodule(("x",), ("x",)).irredundant().generators) == 1


def test_large_numerators():
    big = 10**100 + 1
    case = [f"{big}*x^2 - y", f"x*z - {big}/3", f"y^2 + {big}"]
    found = syzygies(case)
    assert len(found) == 3
    assert all(combine(s, as_tuples(case)) == [0] for s in found)


small = st.dictionaries(st.tuples(*[st.integers(0, 2)] * 3), st.fractions(-3, 3, max_denominator=3), max_size=3).map(
    Polynomial
)


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 2).flatmap(lambda width: st.lists(st.tuples(*[small] * width), min_size=2, max_size=3)))
def test_random_tuples(vectors):
    found = syzygies(vectors)
    assert all(all(p.is_zero for p in combine(s, vectors)) for s in found)
    degrees = [degree_of(s, vectors) for s in found]
    for degree in (2, 4):
        bounded = syzygies(vectors, degree)
        assert rank(spanned(found, degrees, degree)) == len(bounded)
        assert not found or all(s in Submodule(*found) for s in bounded)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(small, small), min_size=1, max_size=3), st.lists(small, min_size=3, max_size=3))
def test_random_members_and_normal_forms(generators, factors):
    module = Submodule(*generators)
    member = combine(factors[: len(generators)], generators)
    assert member in module
    moved = [member[0] + "x*y", member[1] - 1]
    assert module.normal_form(moved) == module.normal_form(("x*y", -1))
    assert (("x*y", -1) in module) == all(p.is_zero for p in module.normal_form(moved))
    assert Submodule(*module.groebner_basis() or [(0, 0)]) == module == Submodule(*reversed(generators))


def test_the_order_of_terms_is_by_degree_then_position():
    module = Submodule(("0", "x"), ("x", "0"), ("y^2", "z"), ("1", "z^3 - y"))
    leads = [("x", "0"), ("0", "x"), ("y^2", "z"), ("1", "z^3 - y")]
    assert module.groebner_basis() == tuple(tuple(map(Polynomial, g)) for g in [leads[3], leads[2], leads[0], leads[1]])


def test_submodules_of_rank_one_are_ideals():
    generators = ["x^2 + 2*x*y - z", "y^2/3 - 5", "x*z - 1/7"]
    module = Submodule(*[(g,) for g in generators])
    assert {g for (g,) in module.groebner_basis()} == set(Ideal(*generators).groebner_basis())
    assert module.normal_form(["x^3*y - z/7"]) == (Ideal(*generators).normal_form("x^3*y - z/7"),)
    assert module.width == 1
    assert len({module, Submodule(*[(g,) for g in reversed(generators)])}) == 1
    assert Submodule((0, 0)).groebner_basis() == ()
    assert Submodule((0, 0)) != Submodule((0,))
    assert eval(repr(module), {"Submodule": Submodule}) == module


MONOMIALS = st.lists(st.tuples(*[st.integers(0, 4)] * 4), max_size=5)


@given(MONOMIALS, st.integers(-1, 7))
def test_hilbert_functions_count(monomials, degree):
    listed = homogeneous_exponents(degree, 4) if degree >= 0 else ()
    inside = [e for e in listed if any(all(a <= b for a, b in zip(m, e, strict=True)) for m in monomials)]
    assert count_members(monomials, degree, 4) == len(inside)
    assert all(any(all(a <= b for a, b in zip(k, m, strict=True)) for k in minimal(monomials)) for m in monomials)


def test_hilbert_functions_are_those_of_normal_forms():
    form = Ideal("x^2*y - 1", "z^3 - x", "y^4")
    leads = [next(iter(g.terms()))[0] for g in form.basis]
    counts = [sum(count_members(leads, d, 3) for d in range(n + 1)) for n in range(7)]
    assert [comb(n + 3, 3) - c for n, c in enumerate(counts)] == [len(form.standard(n)) for n in range(7)]


def test_a_deadline_ends_it():
    with pytest.raises(pas.LimitError, match="while finding syzygies"), pas.limit(seconds=1e-9):
        syzygies(CASES["pairs"])


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda: syzygies([]), ValueError, "at least one polynomial or tuple"),
        (lambda: syzygies("x"), TypeError, "must be a sequence of polynomials or of tuples"),
        (lambda: syzygies(3), TypeError, "must be a sequence"),
        (lambda: syzygies([("x", "y"), ("z",)]), ValueError, r"polynomials\[1\] must be a tuple of 2 .* not of 1"),
        (lambda: syzygies([(), ()]), ValueError, r"polynomials\[0\] must be a tuple of at least 1"),
        (lambda: syzygies(["x", ("y",)]), TypeError, "all polynomials or all tuples; number 2 differs"),
        (lambda: syzygies(["x", "w"]), ValueError, r"polynomials\[1\]: .*'w'"),
        (lambda: syzygies([("x", None)]), TypeError, r"polynomials\[0\]"),
        (lambda: syzygies(["x"], -1), ValueError, "degree must be a whole number >= 0 or None, not -1"),
        (lambda: syzygies(["x"], 1.5), ValueError, "degree must be"),
        (Submodule, ValueError, "generators must be at least one"),
        (lambda: Submodule(("x", "y")).contains(("x",)), ValueError, "must have 2 polynomials, not 1"),
    ],
)
def test_errors(call, kind, words):
    with pytest.raises(kind, match=words):
        call()
