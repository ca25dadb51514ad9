"""Polynomials and formulas as people write them, and what is said of slips."""

from __future__ import annotations

import re

import numpy as np
import pytest

import pas
from pas.algebra.expressions import FUNCTIONS
from pas.algebra.grammar import steps
from pas.algebra.rational_function import RationalFunction

MEANT = [
    ("2y^2", "2*y**2"),
    ("2 y^2", "2*y**2"),
    ("xy^2z", "x*y**2*z"),
    ("2(x + y)(x - y)", "2*x^2 - 2*y^2"),
    ("x² + 3y³", "x^2 + 3*y^3"),
    ("x¹⁰", "x^10"),
    ("x^2y", "x**2*y"),
    ("(x)²y", "x^2*y"),
    ("x² + y² = 1/9", "x^2 + y^2 - 1/9"),
    ("x = y - 1", "x - y + 1"),
    ("z == 3", "z - 3"),
    ("x \u2212 y·z ÷ 2", "x - y*z/2"),
    ("(1/2)x", "x/2"),
    ("x/2 + 3y", "x/2 + 3*y"),
    ("007x", "7*x"),
    ("1_000x", "1000*x"),
    ("1.5e1x", "15*x"),
    (".5x", "x/2"),
    ("-x(y)", "-x*y"),
    ("x^2\n + y", "x^2 + y"),
    ("2^3x", "8*x"),
]

SLIPS = [
    ("x^2 +* y", "unexpected '*' at column 6"),
    ("x^2 + (y", "the bracket at column 7 is never closed"),
    ("x + y)", "the bracket closed at column 6 was never opened"),
    ("x +", "it ends too early, after '+'"),
    ("2 3", "unexpected '3' at column 3"),
    ("x 2", "unexpected '2' at column 3"),
    ("x, y", "unexpected ',' at column 2"),
    ("x < y", "unexpected '<' at column 3"),
    ("x <= y", "unexpected '<=' at column 3"),
    ("x = y = 1", "unexpected '=' at column 7"),
    ("(x = y)", "unexpected '=' at column 4"),
    ("= x", "unexpected '=' at column 1"),
    ("x // 2", "unexpected '/' at column 4"),
    ("x^2 + ()", "unexpected ')' at column 8"),
    ("1/2x", "column 4 can be read in two ways, since 1/2x may be (1/2)*x or 1/(2*x)"),
    ("1/2^2 x", "column 7 can be read in two ways"),
    ("1/(2)x", "column 6 can be read in two ways"),
    ("X^2 + y", "'X' is not one of x, y, z; is 'x' meant"),
    ("w^2", "'w' is not one of x, y, z$"),
    ("x.real", "unexpected '.' at column 2"),
    ("x[0]", "unexpected '[' at column 2"),
    ("'x'", 'unexpected "\'" at column 1'),
    ("1.2.3", "unexpected '.3' at column 4"),
    ("(" * 100 + "x" + ")" * 100, "nested more than 90 deep at column 91"),
]


@pytest.mark.parametrize(("text", "meant"), MEANT, ids=lambda t: repr(t))
def test_what_people_write(text, meant):
    assert pas.Polynomial(text) == pas.Polynomial(meant)


@pytest.mark.parametrize(("text", "said"), SLIPS, ids=lambda t: repr(t)[:30])
def test_slips_are_named_with_their_column(text, said):
    said = re.escape(said).replace(r"\$", "$")
    with pytest.raises(ValueError, match=said) as caught:
        pas.Polynomial(text)
    assert str(caught.value).startswith("cannot read the polynomial")


def test_columns_are_those_of_the_text_as_written():
    for text, where in (("x² + x³ + )", 11), ("  x +\n\t y ]", 11)):
        with pytest.raises(ValueError, match=f"at column {where}$|closed at column {where} was"):
            pas.Polynomial(text)
        assert text[where - 1] in ")]"


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("2t(h + 1)", "2*t*(h+1)"),
        ("th", "t*h"),
        ("t²/(1 + t²)", "t**2/(1 + t**2)"),
        ("(1 - t^2)(1 + h)", "(1-t^2)*(1+h)"),
    ],
)
def test_formulas_take_the_same(text, meant):
    assert RationalFunction(text) == RationalFunction(meant)


def words(text, names, functions=()):
    """The steps of a text, in the order in which they are done."""
    return " ".join(step.text for step in steps(text, names, functions))


@pytest.mark.parametrize(
    ("text", "order"),
    [
        ("-x^2", "x 2 ** negative"),
        ("2^-x^2*y", "2 x 2 ** negative ** y *"),
        ("x^y^2", "x y 2 ** **"),
        ("x - y - 2/x/y", "x y - 2 x / y / -"),
        ("x - -y + +2", "x y negative - 2 +"),
        ("-x*y", "x negative y *"),
        ("(x - (y + 2))x", "x y 2 + - x *"),
        ("x*-y^2/2", "x y 2 ** negative * 2 /"),
    ],
)
def test_the_order_of_operations_is_that_of_mathematics(text, order):
    assert words(text, ("x", "y")) == order


def test_nothing_is_too_deep():
    """Whatever the stack of the Python that reads it."""
    assert pas.Polynomial("-" * 20_001 + "x") == pas.Polynomial("-x")
    assert pas.Polynomial("+".join(["x"] * 3000)) == pas.Polynomial("3000*x")
    assert pas.Polynomial("x" + "*1" * 20_000) == pas.Polynomial("x")
    assert pas.Polynomial("2" + "^1" * 20_000) == pas.Polynomial("2")
    curved = pas.ParametricSurface("cos(t)" + "*1" * 10_000, "t" + "+0" * 2000, "h")
    assert np.allclose(curved([[0.0, 1.0]]), [[1, 0, 1]])


def test_functions_are_called_not_multiplied():
    assert words("2sin(2pi t)cos(t)", ("t", "h", "pi"), FUNCTIONS) == "2 2 pi * t * sin * t cos *"
    for text, said in (
        ("snh(t)", "there is no function 'snh'; is 'sinh' meant"),
        ("foo(t)", "there is no function 'foo'; there are Abs"),
        ("sin t", "the function 'sin' needs its argument in brackets, at column 5"),
        ("sin", "it ends too early"),
        ("1/2t", "can be read in two ways"),
        ("s + t", "the variable 's' is not one of t, h, pi, E"),
    ):
        with pytest.raises(ValueError, match=said):
            pas.ParametricSurface(text, "t", "h")


def test_names_of_several_letters_are_parted_only_in_one_way():
    assert words("r1x", ("r1", "x")) == "r1 x *"
    with pytest.raises(ValueError, match="'rrr' is not one of r, rr"):
        words("rrr", ("r", "rr"))
    assert words("rr", ("r", "rr")) == "rr"
