"""Existence conditions: the published ones, others found here, and checks at points."""

from __future__ import annotations

from fractions import Fraction

import pytest
import sympy

import pas

X, Y, Z = sympy.symbols("x y z")
R1, R2, R3, D1, D2, D3 = sympy.symbols("r1 r2 r3 d1 d2 d3", positive=True)
ELBOW = [("y^2 + z^2 - r1^2", "x - d1"), (X**2 + Z**2 - R2**2, Y - D2)]
COAXIAL = [("y^2 + z^2 - r1^2", "x - d1"), ("y^2 + z^2 - r2^2", "x - d2")]
THREE = [("y^2 + z^2 - r1^2", "x - d1"), ("x^2 + z^2 - r2^2", "y - d2"), ("x^2 + y^2 - r3^2", "z - d3")]
EQUAL = R1**2 + D1**2 - R2**2 - D2**2


def same(conditions, expected) -> bool:
    """Whether polynomials are the same up to order and factors."""
    found = {sympy.Poly(c, R1, R2, R3, D1, D2, D3).primitive()[1].as_expr() for c in conditions}
    wanted = {sympy.Poly(c, R1, R2, R3, D1, D2, D3).primitive()[1].as_expr() for c in expected}
    return {c for c in found if -c not in wanted} <= wanted and len(found) == len(wanted)


def dimension_at(contacts, order, degree, values) -> int:
    """The dimension for numbers, by intersection of ideals."""
    numbers = {str(k): sympy.Rational(v) for k, v in values.items()}

    def put(expression):
        return sympy.sympify(str(expression).replace("^", "**")).subs(numbers)

    first, *others = (pas.contact_ideal((put(f), put(h)), order) for f, h in contacts)
    for other in others:
        first = first & other
    return len(first.members(degree))


def test_two_perpendicular_cylinders_degree_2_never():
    found = pas.existence(ELBOW, 1, 2, (R1, R2, D1, D2))
    assert found.exists == ()
    assert [c.dimension for c in found.cases] == [0]
    assert "never a solution" in str(found)


def test_two_perpendicular_cylinders_degree_3_under_the_published_condition():
    found = pas.existence(ELBOW, 1, 3, (R1, R2, D1, D2))
    (case,) = found.exists
    assert same(case.conditions, [EQUAL])
    assert case.inequations == ()
    assert case.dimension == 1
    square = R1**2 + D1**2
    published = (X**2 + Y**2 + Z**2 - square) * (D1 * (X - D1) + D2 * (Y - D2)) - 2 * D1 * D2 * (X - D1) * (Y - D2)
    # equal up to a factor free of x, y, z, on the condition
    r1 = sympy.sqrt(R2**2 + D2**2 - D1**2)
    ratio = sympy.simplify((case.basis[0] / published).subs(R1, r1))
    assert ratio.free_symbols <= {R2, D1, D2}
    assert ratio != 0
    assert [c.dimension for c in found.cases] == [0, 1]


def test_two_perpendicular_cylinders_degree_4_always():
    """The published "if and only if" holds for cubics alone."""
    found = pas.existence(ELBOW, 1, 4, (R1, R2, D1, D2))
    assert [c.dimension for c in found.cases] == [4, 7]
    generic, special = found.cases
    assert generic.conditions == ()
    assert same(generic.inequations, [EQUAL])
    assert same(special.conditions, [EQUAL])
    f1, f2 = Y**2 + Z**2 - R1**2, X**2 + Z**2 - R2**2
    products = [f1 * f2, f1 * (Y - D2) ** 2, f2 * (X - D1) ** 2, (X - D1) ** 2 * (Y - D2) ** 2]
    numbers = {R1: 1, R2: sympy.Rational(1, 3), D1: 2, D2: sympy.Rational(5, 7)}
    both = [sympy.Poly(p.subs(numbers), X, Y, Z) for p in (*generic.basis, *products)]
    monomials = sorted({m for p in both for m in p.monoms()})
    table = sympy.Matrix([[p.coeff_monomial(m) for m in monomials] for p in both])
    assert table.rank() == table[:4, :].rank() == 4


@pytest.mark.parametrize(
    ("order", "degree", "dimensions"),
    [(1, 2, (0, 1, 1, 2)), (1, 3, (2, 4, 4, 8)), (2, 3, (0, 1, 4, 5)), (1, 4, (9, 11, 11, 19)), (2, 4, (3, 5, 10, 14))],
)
def test_two_coaxial_cylinders(order, degree, dimensions):
    """In general; at one and the same circle's plane; of equal radii; the same circle."""
    d1, d2 = sympy.symbols("d1 d2", real=True)
    found = pas.existence(COAXIAL, order, degree, (R1, R2, d1, d2))
    assert sorted(c.dimension for c in found.cases) == sorted(dimensions)
    assert found.at({R1: 1, R2: 2, d1: 1, d2: -1}).dimension == dimensions[0]
    assert found.at({"r1": 1, "r2": 2, "d1": 3, "d2": 3}).dimension == dimensions[1]
    assert found.at({"r1": 2, "r2": 2, "d1": 0, "d2": 3}).dimension == dimensions[2]
    assert found.at({"r1": 2, "r2": 2, "d1": 3, "d2": 3}).dimension == dimensions[3]
    for values in ({"r1": 1, "r2": 2, "d1": 1, "d2": -1}, {"r1": 2, "r2": 2, "d1": 0, "d2": 3}):
        assert found.at(values).dimension == dimension_at(COAXIAL, order, degree, values)


@pytest.mark.parametrize("degree", [3, 4])
def test_three_perpendicular_pipes(degree):
    found = pas.existence(THREE, 1, degree, (R1, R2, R3, D1, D2, D3))
    if degree == 3:
        assert found.exists == ()
        return
    (case,) = found.exists
    assert case.dimension == 2
    assert len(case.conditions) == 2
    assert case.inequations == ()
    ideal = sympy.groebner(case.conditions, R1, R2, R3, D1, D2, D3, order="grevlex")
    assert ideal.contains(EQUAL)
    assert ideal.contains(R1**2 + D1**2 - R3**2 - D3**2)
    for radii, distances in (((1, 1, 1), (2, 2, 2)), ((7, 5, 1), (4, sympy.sqrt(40), 8))):
        values = dict(zip((R1, R2, R3, D1, D2, D3), (*radii, *distances), strict=True))
        assert all(sympy.simplify(c.subs(values)) == 0 for c in case.conditions)
    values = {"r1": 7, "r2": 1, "r3": 8, "d1": 4, "d2": 8, "d3": 1}
    assert found.at(values).dimension == dimension_at(THREE, 1, 4, values) == 2
    values = {"r1": 7, "r2": 1, "r3": 8, "d1": 4, "d2": 8, "d3": 2}
    assert found.at(values).dimension == dimension_at(THREE, 1, 4, values) == 0


POINTS = [(1, 7, "8", 4), ("1", "1/3", "2", "5/7"), (3, 3, 2, 2), ("7/2", "1/2", "2", "4"), (5, 5, 1, 2)]


@pytest.mark.sampled(8)
@pytest.mark.parametrize("point", POINTS)
@pytest.mark.parametrize(("order", "degree"), [(0, 2), (1, 3), (1, 4), (2, 4), (2, 5)])
def test_dimensions_at_points_are_those_of_ideals(order, degree, point):
    values = {name: Fraction(v) for name, v in zip(("r1", "r2", "d1", "d2"), point, strict=True)}
    found = pas.existence(ELBOW, order, degree, (R1, R2, D1, D2))
    assert found.at(values).dimension == dimension_at(ELBOW, order, degree, values)


@pytest.mark.parametrize(("order", "degree"), [(1, 3), (1, 4), (2, 4)])
def test_solutions_satisfy_the_contacts_at_points(order, degree):
    """Basis members, with numbers put in, lie in both ideals and are independent."""
    found = pas.existence(ELBOW, order, degree, (R1, R2, D1, D2))
    for values in ({R1: 7, R2: 1, D1: 4, D2: 8}, {R1: 1, R2: 2, D1: 3, D2: sympy.Rational(1, 2)}):
        case = found.at(values)
        members = [pas.Polynomial(sympy.expand(g.subs(values))) for g in case.basis]
        for f, h in ELBOW:
            pair = tuple(
                sympy.sympify(str(e).replace("^", "**")).subs({str(k): v for k, v in values.items()}) for e in (f, h)
            )
            ideal = pas.contact_ideal(pair, order)
            assert all(g in ideal for g in members)
        table = sympy.Matrix(
            [[g.coefficients().get(e, 0) for e in {e for m in members for e in m.coefficients()}] for g in members]
        )
        assert not members or table.rank() == len(members)


def test_assumptions_decide_which_cases_are_there():
    real = sympy.symbols("d1 d2", real=True)
    positive = pas.existence(ELBOW, 1, 3, (R1, R2, D1, D2))
    anywhere = pas.existence([ELBOW[0], (X**2 + Z**2 - R2**2, Y - real[1])], 1, 3, (R1, R2, *real))
    assert len(positive.cases) == 2
    # d1 = d2 = 0: both circles around one centre, many more solutions
    case = anywhere.at({"r1": 1, "r2": 1, "d1": 0, "d2": 0})
    assert case.dimension == dimension_at(ELBOW, 1, 3, {"r1": 1, "r2": 1, "d1": 0, "d2": 0})
    for values in (
        {"r1": 1, "r2": 2, "d1": 2, "d2": 1},
        {"r1": 2, "r2": 1, "d1": 0, "d2": "0"},
        {"r1": 1, "r2": 1, "d1": -2, "d2": 2},
    ):
        assert anywhere.at(values).dimension == dimension_at(ELBOW, 1, 3, values)
    with pytest.raises(ValueError, match="contradicts what is assumed"):
        positive.at({"r1": 1, "r2": 1, "d1": 0, "d2": 0})


def test_it_can_be_read_and_typeset():
    found = pas.existence(ELBOW, 1, 3, (R1, R2, D1, D2))
    assert "d1**2 - d2**2 + r1**2 - r2**2 = 0: dimension 1" in str(found)
    assert r"\dim = 1" in found._repr_latex_()


def test_a_limit_stops_it():
    with pas.limit(seconds=1e-9), pytest.raises(pas.LimitError, match="gave up"):
        pas.existence(THREE, 1, 4, (R1, R2, R3, D1, D2, D3))


@pytest.mark.parametrize(
    ("contacts", "parameters", "error", "words"),
    [
        ([("x^2 + y^2 - q", "z")], ("r",), ValueError, "surface of contact 1: .* 'q' is not one of x, y, z, r"),
        ([(X**2 - sympy.Symbol("q"), "z")], ("r",), ValueError, "q is neither x, y, z nor a parameter"),
        ([("x^2 + y^2 - r", "z")], (), ValueError, r"ask pas\.solutions"),
        ([("x^2 + y^2 - 1", "z")], ("x",), ValueError, "must not be called x"),
        ([("x^2 + y^2 - 1", "z")], (3,), TypeError, "sympy symbols or names"),
        ([("x^2 + y^2 - 1", "z")], ("r", "r"), ValueError, "different names"),
        ([("r - 1", "z")], ("r",), ValueError, "not constant"),
        ([("x/r", "z")], ("r",), ValueError, "divides by a polynomial"),
        ([("r*x^2 + y - 1", "x + r*y")], ("r",), pas.GeometryError, "contact 1: the leading terms"),
        (["x"], ("r",), TypeError, "must be a pair"),
        ([], ("r",), ValueError, "at least one pair"),
    ],
)  # fmt: skip
def test_errors(contacts, parameters, error, words):
    with pytest.raises(error, match=words):
        pas.existence(contacts, 1, 3, parameters)
