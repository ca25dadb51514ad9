"""Multipliers: the same spaces as from normal forms, the published ones, completeness."""

from __future__ import annotations

from fractions import Fraction
from math import comb

import pytest
from conftest import AXES, EQUAL, UNEQUAL, pipes
from flint import fmpq_mat

import pas
from pas import Contact, Polynomial, contact_ideal
from pas.algebra.monomials import exponents
from pas.blending.lifting import lift, product_degree
from pas.blending.multipliers import Consistency, Multipliers
from pas.blending.solving import solve
from pas.partition.complex import InteriorFace
from pas.surface.placed import PlacedContacts

PUBLISHED = ("3/5", "1/5")


def corner(clips, radii, order):
    contacts = tuple(p.contact for p in pipes(tuple(radii), tuple(clips)))
    legs = [tuple(Fraction(h) if c else 0 for c in axis) for h, axis in zip(clips, AXES, strict=True)]
    partition = pas.SixTetrahedra(legs=legs)
    return partition, Consistency(partition.interior_faces, contacts, ((0,), (2,), (4,)), 6, order)


def check(system, solution):
    """Every relation, multiplied out."""
    k, m = system.order, solution.multipliers
    for (i, c), gamma, beta in zip(system.sites, m.gamma, m.beta, strict=True):
        contact = system.contacts[i]
        assert solution.patches[c] == gamma * contact.surface + beta * contact.clip ** (k + 1)
    for face, alpha in zip(system.interior_faces, m.alpha, strict=True):
        assert solution.patches[face.second] == solution.patches[face.first] + alpha * face.plane ** (k + 1)


def rank(members):
    rows = [{(i, e): c for i, p in enumerate(member) for e, c in p.coefficients().items()} for member in members]
    columns = sorted({key for row in rows for key in row})
    if not columns:
        return 0
    table = [[row.get(key, Fraction(0)) for key in columns] for row in rows]
    return fmpq_mat([[pas.algebra.rational.rational(v) for v in row] for row in table]).rank()


UNIT = (1, 1, 1)
SPACES = [
    *((("3/5",) * 3, ("1/5",) * 3, k, n) for k, n in ((0, 2), (1, 2), (1, 3), (1, 4), (1, 5), (2, 4), (2, 5), (3, 5))),
    *((UNIT, EQUAL, k, n) for k, n in ((1, 3), (2, 4), (3, 6))),
    *((UNIT, UNEQUAL, k, n) for k, n in ((1, 3), (1, 4), (2, 4), (2, 5))),
    *(((1, 2, 3), ("1/2", "1/3", "1/4"), k, n) for k, n in ((1, 4), (3, 6))),
    (("3/5", "3/5", "4/5"), ("1/5", "1/5", "1/7"), 2, 5),
]


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("clips", "radii", "order", "degree"), SPACES)
def test_the_space_is_that_of_normal_forms(clips, radii, order, degree):
    partition, system = corner(clips, radii, order)
    space = solve(PlacedContacts(partition, system.contacts, order), degree)
    found = system.solve(degree)
    assert len(found) == space.dimension
    assert rank([s.patches for s in found]) == len(found)
    for solution in found:
        check(system, solution)
        assert solution.degree <= degree
        space.coordinates(solution.patches)  # a member, or ValueError
        assert system.multipliers(solution.patches) == solution.multipliers
        assert system.solution(solution.multipliers) == solution


def published_multipliers(facts, printed, system):
    """Printed multipliers, with alpha for our planes and our orientation of the faces."""
    planes = [Polynomial(_plane(text)) for text in facts["pi"]]
    alpha = [Polynomial(0)] * 6
    for number, text in enumerate(printed["alpha"]):
        ends = number, (number + 1) % 6
        j = next(j for j, f in enumerate(system.interior_faces) if {f.first, f.second} == set(ends))
        face = system.interior_faces[j]
        pi = next(p for p in planes if divmod(p.raw, face.plane.raw)[1].is_zero())
        scale = Polynomial.from_raw(divmod(pi.raw, face.plane.raw)[0])
        alpha[j] = Polynomial(text) * scale ** (system.order + 1) * (1 if face.first == number else -1)
    gamma, beta = (tuple(map(Polynomial, printed[name])) for name in ("gamma", "beta"))
    return Multipliers(gamma, beta, tuple(alpha))


def _plane(text):
    for name in ("h1", "h2", "h3"):
        text = text.replace(name, "(3/5)")
    return text


def test_the_canonical_cubics_are_the_published_ones(facts):
    _, system = corner(facts["h"], facts["r"], 1)
    found = system.solve(3)
    assert len(found) == 3
    for ours, printed in zip(found, facts["k1_cubic_basis"], strict=True):
        assert ours.patches == tuple(map(Polynomial, printed["G"]))
        assert ours.multipliers == published_multipliers(facts, printed, system)


@pytest.mark.parametrize(
    ("key", "order", "degree"), [("k2_quartic_simple_solution", 2, 4), ("k3_quintic_solution", 3, 5)]
)
def test_published_higher_order_multipliers_satisfy_the_system(facts, key, order, degree):
    partition, system = corner(facts["h"], facts["r"], order)
    solution = system.solution(published_multipliers(facts, facts[key], system))
    check(system, solution)
    assert any(solve(PlacedContacts(partition, system.contacts, order), degree).coordinates(solution.patches))
    assert system.multipliers(solution.patches) == solution.multipliers


@pytest.mark.parametrize(
    ("clips", "radii", "order", "degrees"),
    [
        (("3/5",) * 3, ("1/5",) * 3, 1, (2, 3, 4, 5)),
        (UNIT, UNEQUAL, 1, (3, 4, 5)),
        (UNIT, EQUAL, 2, (4, 5)),
        (UNIT, EQUAL, 3, (5, 6)),
    ],
)
@pytest.mark.sampled(4)
def test_generators_span_all_solutions_of_each_degree(clips, radii, order, degrees):
    partition, system = corner(clips, radii, order)
    generators = system.generators()
    for g in generators:
        check(system, g)
        assert g.degree >= 0
    for degree in degrees:
        space = solve(PlacedContacts(partition, system.contacts, order), degree)
        members = [
            [Polynomial({e: 1}) * p for p in g.patches]
            for g in generators
            if g.degree <= degree
            for e in exponents(degree - g.degree)
        ]
        assert rank(members) == rank([*members, *space.basis]) == space.dimension


def test_no_generator_can_be_left_out_within_its_degree():
    _, system = corner(("3/5",) * 3, ("1/5",) * 3, 1)
    generators = system.generators()
    degrees = [g.degree for g in generators]
    assert degrees == sorted(degrees)
    top = max(degrees)

    def span(chosen):
        return rank([[Polynomial({e: 1}) * p for p in g.patches] for g in chosen for e in exponents(top - g.degree)])

    whole = span(generators)
    quartics = [g for g in generators if g.degree == top]
    assert all(span([h for h in generators if h is not g]) == whole - 1 for g in quartics)


SINGLE = [
    ([("y^2+z^2-1", "x-1"), ("y^2+z^2-4", "x+1")], 1, (2, 3, 4)),
    ([("y^2+z^2-1", "x-2"), ("x^2+z^2-1", "y-2")], 1, (3, 4, 5)),
    ([("x*y-1", "x-1")], 0, (1, 2, 3)),
    ([("x*y-1", "x-1")], 2, (2, 3, 4, 5)),
    ([("x*y-1", "x-1"), ("x*y*z-2", "x+z")], 1, (4, 5)),
    ([("x*z - y^2", "x - 1"), ("x^2+y^2-1", "x*z - y")], 0, (3, 4)),
    ([("z - x^3", "x*y - 2")], 1, (3, 4, 5)),
]


@pytest.mark.parametrize(("pairs", "order", "degrees"), SINGLE)
def test_one_polynomial_has_the_intersection_of_ideals(pairs, order, degrees):
    """Also where top-degree forms have a common factor, and products need a higher degree."""
    contacts = tuple(Contact(*pair) for pair in pairs)
    system = Consistency((), contacts, ((0,),) * len(contacts), 1, order)
    ideal = contact_ideal(pairs[0], order)
    for pair in pairs[1:]:
        ideal = ideal & contact_ideal(pair, order)
    for degree in degrees:
        found = system.solve(degree)
        assert len(found) == len(ideal.members(degree)) == rank([s.patches for s in found])
        for solution in found:
            check(system, solution)
            assert solution.degree <= degree
            assert solution.patches[0] in ideal
            assert system.multipliers(solution.patches) == solution.multipliers
    assert pas.Ideal(*(g.patches[0] for g in system.generators())) == ideal


def test_products_get_the_degree_that_they_need():
    assert product_degree(Contact("y^2+z^2-1", "x-1"), 3, 5) == 5
    hyperbolic = Contact("x*y-1", "x-1")
    assert product_degree(hyperbolic, 0, 1) == 2
    assert lift("y - 1", hyperbolic, 0) == (Polynomial(1), Polynomial("-y"))
    assert lift(0, hyperbolic, 0) == (Polynomial(0), Polynomial(0))


def test_gamma_is_reduced_so_unique():
    contact = Contact("y^2+z^2-1/9", "x-1")
    gamma, beta = lift("(x-1)^4*(y^2+z^2-1/9) + x*(y^2+z^2-1/9) + (x-1)^2", contact, 1)
    assert (gamma, beta) == (Polynomial("x"), Polynomial("1 + (x-1)^2*(y^2+z^2-1/9)"))


FACE = InteriorFace((0, 1, 2), 0, 1, Polynomial("x - 2*y"))
PIPE = Contact("y^2+z^2-1", "x-1")


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("degree", [0, 2, 4])
def test_without_contacts_they_are_splines(order, degree):
    system = Consistency((FACE,), (), (), 3, order)
    found = system.solve(degree)
    assert len(found) == 2 * comb(degree + 3, 3) + (comb(degree - order + 2, 3) if degree > order else 0)
    assert rank([s.patches for s in found]) == len(found)
    assert [g.degree for g in system.generators()] == [0, 0, order + 1]


@pytest.mark.parametrize("carriers", [((0, 1),), ((1, 0, 1),)])
def test_a_contact_with_two_carriers_has_a_gamma_for_each(carriers):
    system = Consistency((FACE,), (PIPE,), carriers, 2, 1)
    assert len(system.sites) == 2
    found = system.solve(4)
    for solution in found:
        check(system, solution)
        assert all(p in contact_ideal(PIPE, 1) for p in solution.patches)
        assert system.solution(system.multipliers(solution.patches)) == solution
    # a pair (p, p + q): p in I, q in I and divisible by the plane's square
    ideal = contact_ideal(PIPE, 1)
    assert len(found) == len(ideal.members(4)) + len((ideal & pas.Ideal("(x - 2*y)^2")).members(4))
    assert all(p in ideal for g in system.generators() for p in g.patches)


def test_position_does_not_matter():
    moved = [
        pas.Pipe(axis=(3, 4, 0), radius="5/3", clip=1, point=(100, -50, "1/7")),
        pas.Pipe(axis=(4, -3, 0), radius="5/4", clip=-1, point=(100, -50, "1/7")),
        pas.Pipe(axis=(0, 0, 2), radius=2, clip="5/2", point=(100, -50, "1/7")),
    ]
    space = pas.solutions(moved, 1, 4)
    system = Consistency(space.partition.interior_faces, space.contacts, ((0,), (2,), (4,)), 6, 1)
    assert len(system.solve(4)) == space.dimension == 25
    for member in space.basis[:3]:
        assert system.solution(system.multipliers(member)).patches == member


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda s: s.multipliers(["x"]), "there must be 2 patches, not 1"),
        (lambda s: s.multipliers([0, "x"]), r"patches 1 and 2 do not meet with C\^1 in the plane x - 2\*y = 0"),
        (lambda s: s.multipliers(["x", "x"]), r"the polynomial x does not meet y\^2 .* with GC\^1"),
        (lambda s: s.solution(Multipliers((), (), ())), "there must be 3 multipliers in all, not 0"),
    ],
)
def test_errors(call, words):
    with pytest.raises(ValueError, match=words):
        call(Consistency((FACE,), (PIPE,), ((0,),), 2, 1))


def test_multipliers_that_do_not_fit_are_refused():
    system = Consistency((FACE,), (PIPE,), ((0, 1),), 2, 1)
    one, zero = Polynomial(1), Polynomial(0)
    with pytest.raises(ValueError, match="do not satisfy the consistency system"):
        system.solution(Multipliers((one, zero), (zero, zero), (zero,)))


def test_multipliers_of_spaces():
    """Of each basis member, and of any member, in the user's coordinates; of one piece and of several."""
    elbow = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")]
    for space in (pas.solutions(elbow, 1, 3, pas.SingleCell()), pas.solutions(pipes(UNEQUAL), 1, 4)):
        assert len(space.multipliers) == space.dimension
        for member, found in zip(space.basis, space.multipliers, strict=True):
            sites = [(c, p) for c, join in zip(space.contacts, space.placed.joins, strict=True) for p in join.pieces]
            for (contact, piece), gamma, beta in zip(sites, found.gamma, found.beta, strict=True):
                assert member[piece] == gamma * contact.surface + beta * contact.clip**2
            for face, alpha in zip(space.partition.interior_faces, found.alpha, strict=True):
                first, second = member[face.first], member[face.second]
                assert second - first == alpha * face.plane**2
