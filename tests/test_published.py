"""Published single-surface blends: every verified number of their shape control, exactly."""

from __future__ import annotations

import json
from fractions import Fraction
from math import sqrt

import numpy as np
import pytest
import sympy
from conftest import DATA

import pas

PUBLISHED = json.loads((DATA / "published.json").read_text())
COAXIAL, PERPENDICULAR, HEMISPHERES = (PUBLISHED[name] for name in ("coaxial", "perpendicular", "hemispheres"))
BELOW = [(Fraction(-4, 5), Fraction(8, 5), 0), (-2 + sqrt(2), sqrt(2), 0)]
POINTS = [
    (0, "1/2", 0),
    (0.5, sqrt(3) / 2, 0),
    ("2/5", "4/5", 0),
    (1 - 1 / sqrt(2), 1 / sqrt(2), 0),
    (-1, sqrt(3), 0),
    *BELOW,
]


def fractions(values) -> tuple[Fraction, ...]:
    return tuple(map(Fraction, values))


def given_basis(case, degree=4, order=1) -> pas.SolutionSpace:
    """The span of the published generators, inside the space of all solutions."""
    space = pas.solutions([tuple(p) for p in case["pairs"]], order, degree, pas.SingleCell())
    chosen = [g for g in case["gens"] if pas.Polynomial(g).degree <= degree]
    return space.restricted([(g,) for g in chosen])


def energy(case) -> pas.ThinPlate:
    lower, upper = zip(*case["box"], strict=True)
    return pas.ThinPlate(pas.Box(lower, upper))


@pytest.mark.parametrize("case", [COAXIAL, PERPENDICULAR])
def test_dimensions_by_degree(case):
    for degree, dimension in case["dim_by_degree"].items():
        space = pas.solutions([tuple(p) for p in case["pairs"]], 1, int(degree), pas.SingleCell())
        assert space.dimension == dimension


def test_coaxial_energy_and_optimum():
    basis = given_basis(COAXIAL)
    matrix = basis.energy_matrix(energy(COAXIAL))
    reduced = [[matrix[i][j] - matrix[i][3] - matrix[3][j] + matrix[3][3] for j in range(3)] for i in range(3)]
    assert [fractions(row) for row in COAXIAL["H"]] == [tuple(row) for row in reduced]
    assert fractions(COAXIAL["b"]) == tuple(matrix[i][3] - matrix[3][3] for i in range(3))
    best = basis.optimum(energy(COAXIAL))
    assert best.coefficients == fractions([*COAXIAL["x"], COAXIAL["a4"]])
    assert best.energy == best.value == Fraction(COAXIAL["E"])
    assert best.unique
    assert best.active == {}


def test_coaxial_cubic_optimum():
    best = given_basis(COAXIAL, degree=3).optimum(energy(COAXIAL))
    assert best.coefficients == fractions(COAXIAL["cubic"]["a"])
    assert best.energy == Fraction(COAXIAL["cubic"]["E"])


def test_perpendicular_energy_and_optima():
    basis, plate, point = given_basis(PERPENDICULAR), energy(PERPENDICULAR), PERPENDICULAR["point"]
    assert [tuple(row) for row in basis.energy_matrix(plate)] == [fractions(row) for row in PERPENDICULAR["K"]]
    assert tuple(fractions(str(v) for v in basis.values([point]).entries())) == fractions(PERPENDICULAR["g_at_point"])
    free = basis.optimum(plate)
    assert free.coefficients == fractions(PERPENDICULAR["unconstrained_sum1"])
    value = free.surface.polynomials[0].at(point)
    assert float(value) == pytest.approx(PERPENDICULAR["unconstrained_f_at_point_float"], rel=1e-15)
    inside = basis.optimum(plate, inside=[point])
    assert inside.coefficients == fractions(PERPENDICULAR["constrained_sum1"])
    assert inside.surface.polynomials[0].at(point) == 0
    assert list(inside.active) == ["inside (-1/4, -1/4, 0)"]
    assert inside.active["inside (-1/4, -1/4, 0)"] > 0
    assert float(inside.energy) == pytest.approx(449.2, abs=0.05)


def test_the_printed_four_numbers_are_not_the_optimum():
    """They satisfy the constraint with its constant term dropped; energy 70762 against 449."""
    basis = given_basis(PERPENDICULAR)
    printed = fractions(PERPENDICULAR["printed4"])
    coefficients = (*printed, 1 - sum(printed))
    matrix = basis.energy_matrix(energy(PERPENDICULAR))
    spent = sum(a * matrix[i][j] * b for i, a in enumerate(coefficients) for j, b in enumerate(coefficients)) / 2
    assert float(spent) == pytest.approx(70762, abs=0.5)
    g = fractions(PERPENDICULAR["g_at_point"])
    assert abs(sum(a * (v - g[4]) for a, v in zip(printed, g[:4], strict=True))) < Fraction(2, 10**5)


def hemispheres(method="intersection") -> pas.SolutionSpace:
    contacts = [(HEMISPHERES["g1"], HEMISPHERES["h1"]), (HEMISPHERES["g2"], HEMISPHERES["h2"])]
    space = pas.solutions(contacts, 2, 4, pas.SingleCell(), method=method)
    return space.restricted([(p,) for p in HEMISPHERES["gb"]])


def test_hemispheres_interpolation():
    basis = hemispheres()
    assert basis.dimension == 3
    rows = [[sympy.Rational(str(v)) for v in basis.values([POINTS[0]]).entries()]]
    # the second point is irrational: exactly, by sympy
    x, y, z = sympy.symbols("x y z")
    there = {x: sympy.Rational(1, 2), y: sympy.sqrt(3) / 2, z: 0}
    rows.append([sympy.expand(pas.Polynomial(p).to_sympy().subs(there)) for p in HEMISPHERES["gb"]])
    wanted = sympy.Matrix([sympy.Rational(c) for c in HEMISPHERES["interp_coeffs"]])
    assert sympy.simplify(sympy.Matrix(rows) * wanted) == sympy.zeros(2, 1)
    through = basis.through(POINTS[:2])
    assert through.dimension == 1
    found = np.array([float(v) for v in basis.coordinates(through.basis[0])])
    expected = np.array([float(Fraction(c)) for c in HEMISPHERES["interp_coeffs"]])
    assert found / found[2] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("key", "points"), [("PS1", POINTS), ("PS1_with_(0,1,0)", [(0, 1, 0), *POINTS[1:]])], ids=["PS1", "other"]
)
def test_hemispheres_least_squares(key, points):
    fit = hemispheres().least_squares(points)
    assert fit.quotient == pytest.approx(float(HEMISPHERES["ls"][key]["lambda"]), rel=1e-9)
    assert fit.coefficients == pytest.approx([float(c) for c in HEMISPHERES["ls"][key]["c"]], rel=1e-9)


def test_hemispheres_matrices():
    basis = hemispheres()
    gram = [
        [sum(a * q.coefficients().get(e, 0) for e, a in p.coefficients().items()) for (q,) in basis.basis]
        for (p,) in basis.basis
    ]
    assert [tuple(row) for row in gram] == [fractions(row) for row in HEMISPHERES["B"]]
    values = np.array([[float(Fraction(str(v))) for v in row] for row in basis.values(POINTS).tolist()])
    exact = [[float(sympy.sympify(entry)) for entry in row] for row in HEMISPHERES["A_PS1"]]
    assert values.T @ values == pytest.approx(np.array(exact), rel=1e-6)


def test_least_squares_with_weights_is_the_smallest_eigenvalue():
    """Against scipy's generalised eigenproblem, on the whole space of dimension 3 and on quintics."""
    from scipy.linalg import eigh

    contacts = [(HEMISPHERES["g1"], HEMISPHERES["h1"]), (HEMISPHERES["g2"], HEMISPHERES["h2"])]
    space = pas.solutions(contacts, 2, 5, pas.SingleCell())
    generator = np.random.default_rng(5)
    points = generator.uniform(-1, 1, (30, 3))
    weights = generator.uniform(0.5, 2, 30)
    fit = space.least_squares(points.tolist(), weights.tolist())
    values = np.array([[float(m[0](p)) for m in space.basis] for p in points])
    coefficients = np.array([m[0].dense(5) for m in space.basis])
    smallest, vectors = eigh(values.T @ (weights[:, None] * values), coefficients @ coefficients.T)
    assert fit.quotient == pytest.approx(smallest[0], rel=1e-6)
    vector = vectors[:, 0] / vectors[np.flatnonzero(np.abs(vectors[:, 0]) > 1e-9)[-1], 0]
    assert fit.coefficients == pytest.approx(vector, rel=1e-5)
