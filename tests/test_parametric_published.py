"""Published parametric blends: every verified number, exactly."""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import combinations
from math import factorial, prod

import pytest
from conftest import DATA
from flint import fmpq, fmpq_mat

import pas
from pas import RationalFunction
from pas.parametric.data import contact_order
from pas.parametric.hermite import blending_polynomial

FACTS = json.loads((DATA / "parametric.json").read_text())
EXAMPLES = {name: FACTS[name] for name in ("ex1", "ex2", "ex3")}
CASES = EXAMPLES | FACTS["inputs"]
POLYNOMIAL = FACTS["polynomial_inputs"]


def data_of(name: str) -> pas.BlendingData:
    case = CASES[name]
    return pas.BlendingData([pas.ParametricSurface(*p) for p in case["P"]], case.get("s"))


def same(components, expected) -> bool:
    return all(c == RationalFunction(e) for c, e in zip(components, expected, strict=True))


def confluent_vandermonde(values, order) -> fmpq_mat:
    size = len(values) * (order + 1)
    rows = [
        [fmpq(factorial(p), factorial(p - j)) * fmpq(s) ** (p - j) if p >= j else fmpq(0) for p in range(size)]
        for s in values
        for j in range(order + 1)
    ]
    return fmpq_mat(rows)


@pytest.mark.parametrize("values", [(0, 1), (0, 1, 3), (-2, "1/2", 5, 7)])
@pytest.mark.parametrize("order", [0, 1, 2, 3, 4])
def test_hermite_basis_and_determinant(values, order):
    exact = [Fraction(v) for v in values]
    basis = pas.hermite_basis(values, order)
    for i, j, r, m in (
        (i, j, r, m)
        for i in range(len(values))
        for j in range(order + 1)
        for r in range(len(values))
        for m in range(order + 1)
    ):
        assert basis[i][j].diff(0, m).at(0, exact[r]) == ((i, j) == (r, m))
    assert all(f.degree <= len(values) * (order + 1) - 1 for row in basis for f in row)
    determinant = confluent_vandermonde([fmpq(v.numerator, v.denominator) for v in exact], order).det()
    assert pas.hermite_determinant(values, order) == Fraction(int(determinant.p), int(determinant.q))


def test_determinant_where_the_printed_constant_is_wrong():
    case = FACTS["determinant"]
    n, k = len(case["s"]), case["k"]
    differences = prod((b - a) ** ((k + 1) ** 2) for a, b in combinations(case["s"], 2))
    printed = k**n * prod((k - i) ** (2 * (n + i - 1)) for i in range(1, k))
    assert printed == int(case["printed_const"])
    assert pas.hermite_determinant(case["s"], k) == int(case["true_const"]) * differences


def test_hermite_formula_as_printed():
    """L_ij = sum_m 1/(m! j!) [d^m/dh^m ((h - s_i)^(k+1) / W)] (s_i) W / (h - s_i)^(k+1-j-m)."""
    values, k = (0, 1, 3), 2
    whole = RationalFunction("1")
    for s in values:
        whole = whole * RationalFunction(f"(h - {s})^{k + 1}")
    for i, s in enumerate(values):
        inverse = RationalFunction(f"(h - {s})^{k + 1}") / whole
        for j in range(k + 1):
            total = RationalFunction(0)
            for m in range(k - j + 1):
                factor = inverse.diff(0, m).at(0, s) / (factorial(m) * factorial(j))
                total = total + whole / RationalFunction(f"(h - {s})^{k + 1 - j - m}") * factor
            assert total == pas.hermite_basis(values, k)[i][j]


def test_example_1_data():
    case, data = EXAMPLES["ex1"], data_of("ex1")
    assert same(data.curve(1), case["Q2"])
    assert same(data.coefficients(0, 1)[1], case["dP1"])
    assert same(data.coefficients(1, 1)[1], case["dP2"])


def test_example_1_as_printed_is_of_order_two():
    case, data = EXAMPLES["ex1"], data_of("ex1")
    second = pas.hermite_blend(data, 2).surface
    assert same(second.components, case["T_printed"])
    assert second.degrees[1] == 5
    assert same(pas.hermite_blend(data, 1).surface.components, case["T_k1"])
    assert pas.hermite_blend(data, 1).all_solutions().contains(second)
    assert not pas.hermite_blend(data, 2).all_solutions().contains(pas.hermite_blend(data, 1).surface)


@pytest.mark.parametrize("name", ["ex2", "ex3"])
def test_hermite_examples(name):
    blend = pas.hermite_blend(data_of(name), CASES[name]["k"])
    assert same(blend.surface.components, CASES[name]["T"])


def test_example_2_by_weights():
    case = EXAMPLES["ex2"]
    blend = pas.weighted_blend(data_of("ex2"), case["k"], balance=case["u"])
    assert same(blend.surface.components, case["T_alg2"])
    assert all(v.proved for v in blend.prove().contacts)


def test_example_3_by_weights():
    case = EXAMPLES["ex3"]
    blend = pas.weighted_blend(data_of("ex3"), case["k"], balance=case["u"])
    assert blend.weights.exponent == 2
    assert blend.surface.z == RationalFunction(case["D3"]) / RationalFunction(case["D_over_t2p1"])
    assert all(c.denominator.gcd(blend.surface.z.denominator) != 1 for c in blend.surface.components)


@pytest.mark.parametrize("number", range(3))
def test_example_3_lies_on_its_quadrics(number):
    case = EXAMPLES["ex3"]
    surface = pas.ParametricSurface(*case["P"][number])
    assert surface.implicit_residual(case["implicit"][number]).is_zero
    assert not surface.implicit_residual("x^2 + y^2 + (z + 1)^2 - 1").is_zero


@pytest.mark.parametrize("name", FACTS["inputs"])
def test_degrees_of_the_inputs(name):
    data = data_of(name)
    assert [list(data.degrees), list(data.curve_degrees)] == CASES[name]["table"]


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("way", ["hermite", "weights", "normalized"])
def test_contact_is_proved(name, way):
    data, order = data_of(name), CASES[name]["k"]
    if way == "hermite":
        blend = pas.hermite_blend(data, order)
        assert blend.surface.degrees[1] <= len(data.values) * (order + 1) - 1
        assert all(c.denominator.degrees()[1] == 0 for c in blend.surface.components)
    else:
        blend = pas.weighted_blend(data, order, normalized=way == "normalized")
        assert not any(pole.inside for pole in blend.weights.poles())
    assert all(v.proved for v in blend.prove(effort=1).contacts)
    assert blend.all_solutions().contains(blend.surface)


@pytest.mark.parametrize("name", CASES)
def test_polynomial_solutions(name):
    data, order = data_of(name), CASES[name]["k"]
    criterion = pas.has_polynomial_solution(data, order)
    blend = pas.hermite_blend(data, order)
    assert bool(criterion) == (name in POLYNOMIAL) == blend.surface.is_polynomial
    if criterion:
        member = pas.weighted_blend(data, order).all_polynomial_solutions().member("t", "h", "t*h")
        assert member.is_polynomial
        assert blend.all_solutions().contains(member)
    else:
        assert "is no polynomial; its denominator is" in criterion.reason
        with pytest.raises(pas.NoSolutionError, match="denominator"):
            blend.all_polynomial_solutions()


def test_printed_exponent_has_poles_for_even_order_and_more_than_two_surfaces():
    data, order = data_of("VII"), CASES["VII"]["k"]
    printed = pas.Weights(data.values, order, exponent=order + 1)
    assert CASES["VII"]["weight_poles"] and any(pole.inside for pole in printed.poles())
    with pytest.raises(pas.GeometryError, match="even exponent such as 4"):
        pas.weighted_blend(data, order, exponent=order + 1)
    corrected = pas.weighted_blend(data, order)
    assert corrected.weights.exponent == 4
    assert corrected.weights.poles() == ()


@pytest.mark.parametrize("n", [2, 3, 4, 5])
@pytest.mark.parametrize("order", [0, 1, 2, 3, 4])
@pytest.mark.parametrize("normalized", [False, True])
@pytest.mark.sampled(4)
def test_weights_of_any_number_and_order(n, order, normalized):
    balance = "1/3" if n == 2 else [Fraction(i + 1, n + 2) for i in range(n)]
    weights = pas.Weights(range(n), order, balance, normalized)
    poles = weights.poles()
    assert not any(pole.inside for pole in poles) and (n == 2 or not poles)
    for i, f in enumerate(weights.functions):
        for s in range(n):
            assert contact_order(f, RationalFunction(int(i == s)), fmpq(s), order) == order
    total = sum(weights.functions[1:], weights.functions[0])
    assert (total == 1) == (normalized or n == 2)


def test_isolated_points_are_reported():
    kinds = {name: [p.kind for p in data_of(name).isolated_points()] for name in CASES}
    assert {name: len(found) for name, found in kinds.items()} == {
        **{"ex1": 0, "ex2": 0, "ex3": 0, "I": 0, "II": 0, "III": 0, "IV": 5, "VII": 2, "VIII": 3}
    }
    assert all(kind is pas.PointKind.POLE for found in kinds.values() for kind in found)
    second, *rest = [p for p in data_of("ex1").isolated_points(everywhere=True) if p.axis == "z"]
    assert second.kind is pas.PointKind.BASE_POINT and (second.surface, second.t, rest) == (1, 2.0, [])
    found = {name: [len(pas.base_points(s)) for s in data_of(name).surfaces] for name in CASES}
    assert found["ex1"] == [2, 2] and found["IV"] == [6, 5]
    assert found["VII"] == [0, 0, 2, 0] and found["VIII"] == [2, 0, 0, 1]
    assert not any(any(found[name]) for name in ("ex2", "ex3", "I", "II", "III"))
    assert [(p.t, p.h) for p in pas.base_points(data_of("VII").surfaces[2])] == [(0, -1), (7, -8)]


def test_blending_polynomial():
    solutions = pas.hermite_blend(data_of("ex3"), 1).all_solutions()
    assert solutions.multiplier == RationalFunction("h^2*(h - 1)^2*(h - 2)^2")
    assert blending_polynomial(data_of("ex3").values, 1).degree() == 6
