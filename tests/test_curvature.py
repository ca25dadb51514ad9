"""The Gauss curvature check: what passes, what fails, and that it is weaker than GC^2."""

from __future__ import annotations

import pytest
import sympy

import pas
from pas import Ideal, Pipe, contact_ideal, curvature_contact

SPHERE = ("x^2 + y^2 + z^2 - 4", "x + y - 1")
CYLINDER = Pipe((1, 2, -2), "1/3", 1)
TORUS = ("(x^2 + y^2 + z^2 + 3)^2 - 16*(x^2 + y^2)", "z - x")
CONTACTS = [SPHERE, CYLINDER, TORUS, ("x*y - z", "x + z - 2")]
X, Y, Z = SYMBOLS = sympy.symbols("x y z")


def surface(contact):
    return contact.contact.surface if isinstance(contact, Pipe) else pas.Polynomial(contact[0])


def clip(contact):
    return contact.contact.clip if isinstance(contact, Pipe) else pas.Polynomial(contact[1])


def remainder_by_sympy(f, g, curve):
    """H^2 V* - H*^2 V modulo the curve, from sympy's matrices."""

    def parts(p):
        gradient = sympy.Matrix([p.diff(v) for v in SYMBOLS])
        return gradient.dot(gradient), (gradient.T * sympy.hessian(p, SYMBOLS).adjugate() * gradient)[0]

    (h, v), (hs, vs) = parts(f), parts(g)
    basis = sympy.groebner([p.to_sympy() for p in curve], *SYMBOLS, order="grevlex")
    return basis.reduce(sympy.expand(h**2 * vs - hs**2 * v))[1]


@pytest.mark.parametrize("contact", CONTACTS, ids=str)
def test_members_of_order_two_pass(contact):
    f, h = surface(contact), clip(contact)
    for alpha, beta in ((1, 1), ("2", "x - z"), ("1 + x^2", "y + 3")):
        g = f * pas.Polynomial(alpha) + h**3 * pas.Polynomial(beta)
        assert g in contact_ideal(contact, 2)
        result = curvature_contact(f, g, contact)
        assert result.holds
        assert result.gc2
        assert not result.singular
        assert result.membership == 0


@pytest.mark.sampled(3)
@pytest.mark.parametrize("contact", CONTACTS, ids=str)
def test_members_of_order_one_only_fail(contact):
    f, h = surface(contact), clip(contact)
    g = f + h**2 * 3
    result = curvature_contact(f, g, contact)
    assert (result.on_curve, result.tangent_planes, result.equal_curvature) == (True, True, False)
    assert not result.holds
    assert result.gc2 is False
    assert result.membership not in contact_ideal(contact, 2)
    assert result.curvature.to_sympy() == remainder_by_sympy(f.to_sympy(), g.to_sympy(), (f, h))


def test_members_of_order_zero_only_fail_in_the_tangent_planes():
    f, h = surface(SPHERE), clip(SPHERE)
    result = curvature_contact(f, f + h, SPHERE)
    assert result.on_curve
    assert not result.tangent_planes
    assert result.tangent[2] == contact_ideal(SPHERE, 0).normal_form("2*x - 2*y")
    assert not curvature_contact(f, f + 1, SPHERE).on_curve


def test_the_check_is_weaker_than_contact_of_second_order():
    result = curvature_contact("z", "z - y^2", ("z", "y"))
    assert result.holds
    assert result.gc2 is False
    assert result.membership == "-y^2"
    assert str(result).splitlines()[2].endswith("yes")
    assert str(result).splitlines()[4].endswith("no")


@pytest.mark.parametrize("contact", CONTACTS, ids=str)
def test_squares_are_singular(contact):
    f, h = surface(contact), clip(contact)
    for g in (f**2, h**2 - f**2 * 3, f * h):
        result = curvature_contact(f, g, contact)
        assert result.singular
        assert result.holds
        assert result.gc2 is False


def test_the_contact_may_be_the_ideal_of_the_curve():
    result = curvature_contact("z", "z - y^3", Ideal("y", "z"))
    assert result.holds
    assert result.gc2 is None
    assert "not decided" in str(result)
    other = curvature_contact("z - y^3", "z", ("z", "y"))
    assert other.holds
    assert other.gc2 is None
    assert curvature_contact("2*z", "z + y^3", ("z", "y")).gc2


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        (("z - 1", "z", ("z", "y")), pas.GeometryError, "does not contain the curve"),
        (("z^2", "z", ("z", "y")), pas.GeometryError, "singular along the whole curve"),
        (("z", "w", ("z", "y")), ValueError, "variable 'w'"),
        (("z", "z", "y"), TypeError, "must be a Pipe, a Contact or a pair"),
    ],
)
def test_errors(arguments, error, words):
    with pytest.raises(error, match=words):
        curvature_contact(*arguments)


def test_no_truth_value():
    with pytest.raises(TypeError, match="holds"):
        bool(curvature_contact("z", "z", ("z", "y")))
