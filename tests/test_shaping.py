"""Handles, exact optima and combined wishes, on one surface and on many cells."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from conftest import EQUAL, pipes, solved
from flint import fmpq
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

import pas
from pas.algebra.rational import vector
from pas.bernstein.forms import b_form, on_simplex, polar_row
from pas.blending.shaping import handles

COAXIAL = [("y^2 + z^2 - 1", "x - 1"), ("y^2 + z^2 - 4", "x + 1")]
CELL = pas.SingleCell((-1, -3, -3), (1, 3, 3))
NUMBERS = st.fractions(min_value=-3, max_value=3, max_denominator=9)


def test_polar_forms_are_b_coefficients():
    from pas.algebra.monomials import exponents, homogeneous_exponents

    corners = [vector(c) for c in ((0, 0, 0), (1, "1/2", 0), (0, 2, 1), ("1/3", 0, -1))]
    indices = homogeneous_exponents(4, 4)
    for place in (0, 7, 19, len(indices) - 1):
        row = polar_row([c for c, times in zip(corners, indices[place], strict=True) for _ in range(times)])
        for e, value in zip(exponents(4), row, strict=True):
            assert b_form(on_simplex(pas.Polynomial({e: 1}).raw, corners), 4, 3)[place] == value


@pytest.mark.parametrize("make", [
    lambda: pas.solutions(COAXIAL, 1, 4, CELL),
    lambda: pas.solutions(COAXIAL, 1, 4, pas.SingleCell()),
    lambda: pas.solutions(pipes(EQUAL), 1, 4),
])  # fmt: skip
def test_a_determining_set_is_minimal_and_determines(make):
    space = make()
    chosen = space.determining_set()
    assert len(chosen) == len(set(chosen)) == space.dimension
    wanted = {handle: Fraction(7 * i % 5 - 2, i + 1) for i, handle in enumerate(chosen)}
    plate = pas.ThinPlate(pas.Box((0, 0, 0), (1, 1, 1)))
    found = space.optimum(plate, handles=wanted)
    assert found.unique
    if space.partition.cells:
        assert all(found.surface.cells[c].b_coefficients[i] == v for (c, i), v in wanted.items())
    # every other B-coefficient depends on these: another value for it contradicts
    other = next(h for h in handles(space) if h not in chosen)
    taken = space.functional_rows([_functional(space, other)]).tolist()[0]
    value = sum(Fraction(str(r)) * a for r, a in zip(taken, found.coefficients, strict=True))
    assert space.optimum(plate, handles=wanted | {other: value}).coefficients == found.coefficients
    with pytest.raises(pas.InfeasibleError, match="satisfies all constraints"):
        space.optimum(plate, handles=wanted | {other: value + 1})


def _functional(space, handle):
    from pas.fairing.functionals import b_coefficient

    return b_coefficient(space.partition, handle, space.degree)


def test_preferred_handles_come_first():
    space = pas.solutions(COAXIAL, 1, 4, CELL)
    prefer = [(5, (0, 1, 2, 1)), (5, (1, 1, 1, 1))]
    assert space.determining_set(prefer)[:2] == tuple(prefer)


def test_the_rest_follows_by_energy():
    """Two of nine handles are set; the others have least energy: perturbations cost more."""
    space = pas.solutions(COAXIAL, 1, 4, CELL)
    first, second, third, *_ = space.determining_set()
    best = space.optimum(handles={first: -1, second: -1})
    for value in ("1/10", "-1/10"):
        there = best.surface.cells[third[0]].b_coefficients[third[1]]
        moved = space.optimum(handles={first: -1, second: -1, third: there + Fraction(value)})
        assert moved.energy > best.energy


def test_optimum_satisfies_the_optimality_conditions():
    """Stationarity, recomputed: K a is a combination of the constraints with the right signs."""
    space = pas.solutions(COAXIAL, 1, 4, CELL)
    inside, outside, on = [(0, "3/2", 0)], [(0, 2, 0), (0, 0, "19/10")], [("-1/2", "19/10", 0)]
    found = space.optimum(inside=inside, outside=outside, through=on, margin="1/20")
    polynomial = found.surface.polynomials[0]
    assert polynomial.at(on[0]) == 0
    assert polynomial.at(inside[0]) <= Fraction(-1, 20)
    assert min(polynomial.at(p) for p in outside) >= Fraction(1, 20)
    assert sum(found.coefficients) == 1
    matrix = space.energy_matrix()
    gradient = [sum(k * a for k, a in zip(row, found.coefficients, strict=True)) for row in matrix]
    rows = [space.values([p]).tolist()[0] for p in (*inside, *outside, *on)]
    columns = np.array([[float(Fraction(str(v))) for v in row] for row in [*rows, [1] * 9]], dtype=float).T
    multipliers = np.linalg.lstsq(columns, np.array([float(g) for g in gradient]), rcond=None)[0]
    assert columns @ multipliers == pytest.approx([float(g) for g in gradient])
    named = {"inside (0, 3/2, 0)": 0, "outside (0, 2, 0)": 1, "outside (0, 0, 19/10)": 2}
    for name, value in found.active.items():
        sign = -1 if name.startswith("inside") else 1
        assert float(value) == pytest.approx(sign * multipliers[named[name]])
        assert value >= 0


@settings(max_examples=10, deadline=None)
@given(st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS), min_size=1, max_size=4, unique=True), st.integers(0, 2**20))
@example(
    points=[(Fraction(-5, 2), Fraction(0), Fraction(2)), (Fraction(-1, 2), Fraction(3, 2), Fraction(4, 3))], seed=1
)
def test_random_programmes_agree_with_the_numerical_solver(points, seed):
    """The exact active-set solution against Clarabel, where both have an answer."""
    import cvxpy

    space = pas.solutions(COAXIAL, 1, 4, pas.SingleCell())
    plate = pas.ThinPlate(pas.Box((-1, -2, -2), (1, 2, 2)))
    sides = np.random.default_rng(seed).integers(0, 2, len(points))
    inside = [p for p, s in zip(points, sides, strict=True) if s]
    outside = [p for p, s in zip(points, sides, strict=True) if not s]
    values = {k: np.array([[float(Fraction(str(v))) for v in row] for row in space.values(p).tolist()]).reshape(-1, 9)
              for k, p in (("in", inside), ("out", outside))}  # fmt: skip
    values = {k: v / np.abs(v).max(axis=1, keepdims=True, initial=1) for k, v in values.items()}
    matrix = np.array([[float(v) for v in row] for row in space.energy_matrix(plate)])
    high = np.abs(matrix).max()  # else it may stop at its limit of steps
    a = cvxpy.Variable(9)
    wishes = [(inside, values["in"] @ a <= 0), (outside, values["out"] @ a >= 0)]
    problem = cvxpy.Problem(
        cvxpy.Minimize(cvxpy.quad_form(a, cvxpy.psd_wrap(matrix / high)) / 2),
        [cvxpy.sum(a) == 1, *(wish for points, wish in wishes if points)],
    )
    problem.solve(solver=cvxpy.CLARABEL)
    assume(problem.status != cvxpy.USER_LIMIT)
    try:
        found = space.optimum(plate, inside=inside, outside=outside)
    except pas.InfeasibleError:
        assert problem.status != "optimal"
        return
    assert problem.status in ("optimal", "optimal_inaccurate")
    assert float(found.energy) == pytest.approx(high * problem.value, rel=1e-4, abs=1e-3)


def test_unit_coefficients_without_inequalities_are_least_squares():
    space = pas.solutions(COAXIAL, 1, 4, CELL)
    points = np.random.default_rng(3).uniform(-1, 1, (15, 3)).tolist()
    direct = space.least_squares(points)
    fitted = space.fit(
        near=points, near_weight=1, energy=pas.ThinPlate(weight=0), normalize=pas.UnitCoefficients(),
        prove=False, guard=False,
    )  # fmt: skip
    polynomial = fitted.surface.polynomials[0]
    length = sum(float(c) ** 2 for c in polynomial.coefficients().values())
    assert length == pytest.approx(1, abs=1e-8)
    assert sum(float(polynomial.at(p)) ** 2 for p in points) / length == pytest.approx(direct.quotient, rel=1e-6)


@pytest.mark.parametrize("by_gradient", [False, True])
def test_least_squares_are_negative_inside(by_gradient):
    """The corner of pipes is proved from points of it, whatever sign its coefficients begin with."""
    space = pas.solutions(pipes(EQUAL), 1, 3)
    member = solved(EQUAL, 1).surface
    points = member.mesh(0.05).points.tolist()
    found = [
        s.least_squares(points, by_gradient=by_gradient)
        for s in (space, space.restricted([[-p for p in m] for m in space.basis]))
    ]
    for fit in found:
        assert fit.surface([(0, 0, 0)])[0] < 0 and fit.surface.certificate.proved
    assert found[0].coefficients == pytest.approx(-found[1].coefficients, rel=1e-9)


@pytest.mark.parametrize("text", ["y^2 + z^2 - 1", "1 - y^2 - z^2"])
def test_without_a_centre_alpha_is_positive(text):
    box = pas.SingleCell((-1, -2, -2), (1, 2, 2))
    blind = pas.Partition(box.vertices, box.cells, None, box.pieces)
    contacts = [("y^2 + z^2 - 1", "x - 1"), ("y^2 + z^2 - 1", "-x - 1")]
    fits = [
        pas.solutions(contacts, 1, 2, partition).restricted([(text,)]).least_squares([(0, 1, 0.1)])
        for partition in (blind, box, pas.SingleCell())
    ]
    assert [str(fit.surface.polynomials[0]) for fit in fits[:2]] == ["y^2 + z^2 - 1"] * 2
    assert all(v.proved for v in fits[0].surface.certificate.contacts)
    assert fits[2].coefficients.tolist() == [1]  # nothing is inside of all of space


def test_everything_combined_is_proved():
    """Near and inside points, a handle, energy and unit length in one: and the proofs pass."""
    space = pas.solutions(COAXIAL, 1, 4, CELL)
    near = [(0, "8/5", 0), (0, 0, "-8/5")]
    blend = space.fit(
        near=near, near_weight=[3, 2], inside=[(0, 1, 0)], outside=[(0, 2, 2)], margin="1/1000",
        normalize=pas.UnitCoefficients(), energy=pas.ThinPlate(weight="1/100"),
    )  # fmt: skip
    assert blend.certificate.proved
    polynomial = blend.surface.polynomials[0]
    assert polynomial.at((0, 1, 0)) < 0 < polynomial.at((0, 2, 2))
    length = sum(float(c) ** 2 for c in polynomial.coefficients().values())
    assert length == pytest.approx(1, abs=1e-6)


def test_unit_length_with_active_inequalities_is_optimal():
    """No feasible member near the answer has a smaller quotient."""
    space = pas.solutions(COAXIAL, 1, 4, CELL)
    points = [(0, "3/2", 0), (0, 0, "3/2"), ("1/2", "6/5", 0)]
    wish = (0, "8/5", 0)
    blend = space.fit(
        near=points, near_weight=1, inside=[wish], margin="1/50", energy=pas.ThinPlate(weight="1/1000"),
        normalize=pas.UnitCoefficients(), prove=False, guard=False,
    )  # fmt: skip
    matrix = np.array([[float(v) for v in row] for row in space.energy_matrix()]) / 1000 / 2
    rows = np.array([[float(Fraction(str(v))) for v in row] for row in space.values([*points, wish]).tolist()])
    objective = matrix + rows[:3].T @ rows[:3]
    table = np.array([m[0].dense(4) for m in space.basis])
    gram = table @ table.T
    a = np.array([float(c) for c in blend.coefficients])

    def quotient(b):
        return b @ objective @ b / (b @ gram @ b)

    assert rows[3] @ a <= -0.0199
    generator = np.random.default_rng(0)
    for _ in range(300):
        b = a + 1e-3 * np.linalg.norm(a) * generator.normal(size=9) / 3
        b = b / np.sqrt(b @ gram @ b)
        if rows[3] @ b <= -0.02:
            assert quotient(b) >= quotient(a) * (1 - 1e-6)


def test_handles_in_a_proved_corner(tmp_path):
    space = pas.solutions(pipes(EQUAL), 1, 4)
    free = space.fit()
    handle = space.determining_set()[0]
    before = free.surface.cells[handle[0]].b_coefficients[handle[1]]
    value = Fraction(round(float(before) * 1.05, 3)).limit_denominator(1000)
    blend = space.fit(handles={handle: value})
    assert blend.certificate.proved
    assert blend.surface.cells[handle[0]].b_coefficients[handle[1]] == value
    assert pas.load(blend.save(tmp_path / "handled.pas.json")).constraints.handles == blend.constraints.handles


def test_coefficients_of_members_are_set_exactly(tmp_path):
    """Some are held, the others have least energy; one of a single cell that is proved, in every way to say it."""
    space = pas.solutions(COAXIAL, 1, 4, CELL)
    best = space.optimum(coefficients={0: "1/3", 2: "-2"})
    assert (best.coefficients[0], best.coefficients[2]) == (Fraction(1, 3), -2)
    for value in ("1/10", "-1/10"):
        held = {0: "1/3", 2: "-2", 1: best.coefficients[1] + Fraction(value)}
        assert space.optimum(coefficients=held).energy > best.energy
    balls = [("(x + 2)^2 + y^2 + z^2 - 4", "-x - 2"), ("(x - 1)^2 + y^2 + z^2 - 1", "x - 1")]
    blend = pas.blend(balls, 2, 4, pas.SingleCell((-2, -3, -3), (1, 3, 3)), coefficients={1: "-3/1000"})
    assert blend.certificate.proved and blend.coefficients[1] == Fraction(-3, 1000)
    loaded = pas.load(blend.save(tmp_path / "held.pas.json"))
    assert loaded.constraints.coefficients == blend.constraints.coefficients == ((1, fmpq(-3, 1000)),)
    moved = blend.refit(coefficients=[(1, "-7/2000"), (0, blend.coefficients[0])])
    assert moved.coefficients[:2] == (blend.coefficients[0], Fraction(-7, 2000))
    with pytest.raises(pas.InfeasibleError, match="coefficient 1 = 5 cannot be met"):
        blend.refit(coefficients={1: 5})


@pytest.mark.parametrize("steps", [1, None])
@pytest.mark.sampled(2)
def test_what_one_step_does_not_reach_is_found_anew(steps):
    """A handle far from where it was; only where no member has it so is the wish refused."""
    pipes = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")]
    blend = pas.blend(pipes, 1, 4, pas.SingleCell((-2, -2, -2), (2, 2, 2)))
    moved = blend.refit(handles={(1, (3, 0, 1, 0)): 5}, steps=steps)
    assert moved.surface.cells[1].b_coefficients[3, 0, 1, 0] == 5 and moved.standing == "not proved yet"
    assert moved.certificate.proved and moved.space is blend.space
    assert moved.wishes == blend.wishes.changed(handles={(1, (3, 0, 1, 0)): 5})
    with pytest.raises(pas.InfeasibleError, match=r"inside .*, through .* contradict one another in degree 4"):
        blend.refit(inside=[("-1/2", 0, 0)], through=[("-1/2", 0, 0)], steps=steps)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"coefficients": {9: 1}}, "is that of no member: they are numbered from 0 to 8"),
        ({"coefficients": {-1: 1}}, "coefficients must map numbers of members, from 0"),
        ({"coefficients": 3}, "coefficients must map numbers of members, from 0"),
        ({"handles": {(0, (9, 0, 0, 0)): 1}}, "four numbers >= 0 with the sum 4"),
        ({"handles": {(99, (4, 0, 0, 0)): 1}}, "in no cell: cells are numbered from 0 to 11"),
        ({"handles": {0: 1}}, r"handles must map \(cell, multi-index"),
        ({"normalize": pas.MeanAlpha()}, "linear normalisation"),
        ({"near": [(0, 0, 0)], "near_weight": [1, 2]}, "one for each of the 1 near points"),
        ({"inside": [(7, 7, 7)]}, "outside the region"),
    ],
)
def test_errors(options, words):
    space = pas.solutions(COAXIAL, 1, 4, CELL)
    with pytest.raises(ValueError, match=words):
        space.optimum(**options)


def test_contradictions_and_empty_spaces():
    space = pas.solutions(COAXIAL, 1, 3, CELL)
    with pytest.raises(pas.InfeasibleError, match="no member of degree 3"):
        space.optimum(through=[(0, 0, 0), ("1/2", 0, 0), (0, 1, 0)])
    with pytest.raises(pas.InfeasibleError, match="no member of degree 3"):
        space.optimum(inside=[(0, 1, 0)], outside=[(0, 1, 0)], margin=1)
    with pytest.raises(ValueError, match="do not determine one of 2 dimensions"):
        space.least_squares([])
    with pytest.raises(pas.NoSolutionError, match="degree 2 is empty"):
        pas.solutions(COAXIAL, 1, 2, CELL).optimum()
    with pytest.raises(ValueError, match="an energy needs a region"):
        pas.solutions(COAXIAL, 1, 3, pas.SingleCell()).optimum()
