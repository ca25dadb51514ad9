"""Solution spaces: dimensions, exactness checked by another path, and the published numbers."""

from __future__ import annotations

from fractions import Fraction

import pytest
import sympy
from conftest import AXES, EQUAL, UNEQUAL, pipes
from flint import fmpq_mat

import pas
from pas.algebra.ideal import Ideal
from pas.algebra.polynomial import RING

X, Y, Z = sympy.symbols("x y z")
TABLE = {
    EQUAL: {(1, 3): 3, (1, 4): 26, (1, 5): 76, (2, 4): 3, (2, 5): 18, (2, 6): 60, (3, 5): 1, (3, 6): 12, (3, 7): 50},
    UNEQUAL: {(1, 3): 1, (1, 4): 25, (1, 5): 76, (2, 4): 0, (2, 5): 10, (2, 6): 59},
}
CASES = [(radii, k, n, dimension) for radii, table in TABLE.items() for (k, n), dimension in table.items()]


@pytest.mark.parametrize(("radii", "order", "degree", "dimension"), CASES)
@pytest.mark.sampled(3)
def test_dimensions_of_the_unit_corner(radii, order, degree, dimension):
    space = pas.solutions(pipes(radii), order, degree)
    assert space.dimension == dimension
    assert (space.order, space.degree) == (order, degree)


FACT_CASES = ["equal", "generic", "two_equal_case", "const_r2h2_case"]


@pytest.mark.parametrize("case", FACT_CASES)
def test_dimensions_and_regular_ranks_of_the_published_corner(facts, case):
    data = {"equal": facts, "generic": facts["generic_case"]}.get(case, facts.get(case))
    dims = facts["dim"][case] if case in facts["dim"] else data["dim"]
    ranks = facts["genuine_rank"].get(case) or data.get("genuine_rank", {})
    for key, dimension in dims.items():
        order, degree = map(int, key.split(","))
        # unlike circles that overlap in print, spaces do not need them apart: skip the placement
        space = _space(data["h"], data["r"], order, degree)
        assert space.dimension == dimension, key
        if key in ranks:
            assert regular_rank(space) == ranks[key], key
            assert space.regular == (ranks[key] > 0)


def _space(clips, radii, order, degree):
    from pas.blending.solving import solve
    from pas.pipeline.result import SolutionSpace
    from pas.surface.placed import PlacedContacts

    contacts = [p.contact for p in pipes(tuple(radii), tuple(clips))]
    legs = [tuple(Fraction(h) if c else 0 for c in axis) for h, axis in zip(clips, AXES, strict=True)]
    return SolutionSpace.of(solve(PlacedContacts(pas.SixTetrahedra(legs=legs), contacts, order), degree))


def regular_rank(space: pas.SolutionSpace) -> int:
    """The rank of the map from members to their alphas on the contact curves."""
    rows = []
    for member in space.basis:
        row = []
        for number, contact in enumerate(space.contacts):
            form = Ideal(contact.surface**2, contact.clip)
            images = form.images(space.degree)
            total: dict = {}
            for e, c in member[2 * number].raw.to_dict().items():
                for m, v in images[tuple(map(int, e))].items():
                    total[m] = total.get(m, 0) + c * v
            row.append(RING.from_dict(total))
        rows.append(row)
    monomials = sorted({(i, e) for row in rows for i, p in enumerate(row) for e in p.to_dict()})
    if not monomials:
        return 0
    return fmpq_mat([[row[i].to_dict().get(e, 0) for i, e in monomials] for row in rows]).rank()


@pytest.mark.sampled(6)
@pytest.mark.parametrize(
    ("radii", "order", "degree"),
    [(EQUAL, 1, 3), (EQUAL, 2, 4), (EQUAL, 3, 5), (EQUAL, 3, 6), (UNEQUAL, 1, 4), (UNEQUAL, 2, 5)],
)
def test_every_member_satisfies_every_condition(radii, order, degree):
    """By sympy's substitution and division alone: no normal form, no code of the construction."""
    space = pas.solutions(pipes(radii), order, degree)
    faces = space.partition.interior_faces
    t, u, v = sympy.symbols("t u v")
    for member in space.basis[:3]:
        patches = [p.to_sympy() for p in member]
        for face in faces:
            difference = sympy.Poly(patches[face.first] - patches[face.second], X, Y, Z)
            _, remainder = sympy.div(difference, sympy.Poly(face.plane.to_sympy() ** (order + 1), X, Y, Z))
            assert remainder.is_zero
        for number, (symbol, radius) in enumerate(zip((X, Y, Z), radii, strict=True)):
            # with h = t + 1 and the circle's y^2 = r^2 - z^2: terms of t up to the order vanish
            first, second = [s for s in (X, Y, Z) if s != symbol]
            patch = sympy.Poly(patches[2 * number].subs({symbol: t + 1, first: u, second: v}), t, u, v)
            circle = sympy.Poly(u**2 + v**2 - sympy.Rational(radius) ** 2, u, v)
            jets = [sympy.Poly(0, u, v)] * (order + 1)
            for (i, j, k), c in patch.terms():
                if i <= order:
                    jets[i] += sympy.Poly(c * u**j * v**k, u, v)
            assert all(sympy.rem(jet, circle, u).is_zero if not jet.is_zero else True for jet in jets)


@pytest.mark.parametrize(("radii", "order", "degree"), [(EQUAL, 2, 4), (UNEQUAL, 2, 5)])
def test_the_check_above_can_fail(radii, order, degree):
    space = pas.solutions(pipes(radii), order, degree)
    broken = space.basis[0][0] + "x^4/1000000"
    _, remainder = sympy.div(
        sympy.Poly((broken - space.basis[0][1]).to_sympy(), X, Y, Z),
        sympy.Poly(space.partition.interior_faces[0].plane.to_sympy() ** (order + 1), X, Y, Z),
    )
    assert not remainder.is_zero


def test_the_published_cubics_are_a_basis_with_the_published_energy(facts):
    space = pas.solutions(pipes(facts["r"], facts["h"]), 1, 3)
    published = [space.coordinates(member["G"]) for member in facts["k1_cubic_basis"]]
    canonical = space.change_basis(published)
    assert canonical.dimension == 3
    for ours, printed in zip(canonical.basis, facts["k1_cubic_basis"], strict=True):
        assert list(ours) == [pas.Polynomial(g) for g in printed["G"]]
        for i, number in enumerate((0, 2, 4)):
            contact = space.contacts[i]
            multiplied = pas.Polynomial(printed["gamma"][i]) * contact.surface
            assert ours[number] == multiplied + pas.Polynomial(printed["beta"][i]) * contact.clip**2
    lower, upper = zip(*facts["Omega"], strict=True)
    energy = pas.ThinPlate(pas.Box(lower, upper))
    assert canonical.energy_matrix(energy) == [[Fraction(v) for v in row] for row in facts["k1_cubic_K_on_Omega"]]


@pytest.mark.parametrize(
    ("key", "order", "degree"), [("k2_quartic_simple_solution", 2, 4), ("k3_quintic_solution", 3, 5)]
)
def test_published_higher_order_solutions_are_members(facts, key, order, degree):
    space = pas.solutions(pipes(facts["r"], facts["h"]), order, degree)
    printed = facts[key]
    patches = {}
    for i, number in enumerate((0, 2, 4)):
        contact = space.contacts[i]
        gamma, beta = pas.Polynomial(printed["gamma"][i]), pas.Polynomial(printed["beta"][i])
        patches[number] = gamma * contact.surface + beta * contact.clip ** (order + 1)
    # the transitions follow from alpha across the planes, up to the sign of pi
    planes = [pas.Polynomial(_pi(text)) for text in facts["pi"]]
    for number in (0, 2, 4):
        for sign in (1, -1):
            alpha = pas.Polynomial(printed["alpha"][number])
            step = alpha * (planes[_plane_of(space, number, planes)] ** (order + 1)) * sign
            candidate = patches[number] + step
            after = patches[(number + 2) % 6] - candidate
            face = _face(space, number + 1, (number + 2) % 6)
            if divmod(after.raw, (face.plane ** (order + 1)).raw)[1].is_zero():
                patches[number + 1] = candidate
    assert sorted(patches) == list(range(6))
    assert any(space.coordinates([patches[i] for i in range(6)]))


def _pi(text):
    for name in ("h1", "h2", "h3"):
        text = text.replace(name, "(3/5)")
    return text


def _face(space, a, b):
    return next(f for f in space.partition.interior_faces if {f.first, f.second} == {a, b})


def _plane_of(space, number, planes):
    face = _face(space, number, number + 1)
    return next(i for i, p in enumerate(planes) if divmod(p.raw, face.plane.raw)[1].is_zero())


def test_members_are_exact_combinations():
    space = pas.solutions(pipes(EQUAL), 1)
    assert (space.degree, space.dimension, space.regular) == (3, 3, True)
    surface = space.member(["1/3", -2, Fraction(5, 7)])
    for i, cell in enumerate(surface.cells):
        a, b, c = (member[i] for member in space.basis)
        assert cell.polynomial == a / 3 - 2 * b + c * "5/7"
    assert space.coordinates([c.polynomial for c in surface.cells]) == (Fraction(1, 3), -2, Fraction(5, 7))
    with pytest.raises(ValueError, match="must be 3 numbers, not 2"):
        space.member([1, 2])
    with pytest.raises(ValueError, match="not a member"):
        space.coordinates(["x"] * 6)
    with pytest.raises(ValueError, match="degree above"):
        space.coordinates(["x^4"] * 6)


def test_position_orientation_and_scale_do_not_matter():
    moved = [
        pas.Pipe(axis=(3, 4, 0), radius="5/3", clip=1, point=(100, -50, "1/7")),
        pas.Pipe(axis=(4, -3, 0), radius="5/4", clip=-1, point=(100, -50, "1/7")),
        pas.Pipe(axis=(0, 0, 2), radius=2, clip="5/2", point=(100, -50, "1/7")),
    ]
    for order, degree, dimension in ((1, 4, 25), (2, 5, 10)):
        assert pas.solutions(moved, order, degree).dimension == dimension


def test_pairs_and_contacts_serve_as_pipes_do():
    pairs = [("y^2+z^2-1/9", "x-1"), pas.Contact("x^2+z^2-1/9", "1-y"), pas.Pipe((0, 0, 1), "1/3", 1)]
    assert pas.solutions(pairs, 1, 3).dimension == 3


def test_no_solution_is_an_answer():
    space = pas.solutions(pipes(UNEQUAL), 2, 4)
    assert space.dimension == 0
    assert space.basis == ()
    assert not space.regular
    with pytest.raises(pas.NoSolutionError):
        space.fit()


def test_energy_over_cells_is_exact_and_agrees_with_quadrature():
    from pas.fairing.basis import to_doubles

    space = pas.solutions(pipes(EQUAL), 1)
    exact = space.energy_matrix()
    change = to_doubles(space.prepared.basis.transform)
    matrix = [[float(v) for v in row] for row in exact]
    assert space.prepared.form(pas.ThinPlate()) == pytest.approx(change @ matrix @ change.T)
