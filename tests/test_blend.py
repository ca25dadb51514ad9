"""The whole pipeline: proved surfaces at the degrees measured, shapes as asked, errors in words."""

from __future__ import annotations

import random
import runpy
from fractions import Fraction

import numpy as np
import pytest
from conftest import AXES, EQUAL, ROOT, UNEQUAL, pipes, solved

import pas
from pas.pipeline.search import GIVEN, SearchSettings


@pytest.mark.parametrize(
    ("radii", "order", "degree"),
    [
        (EQUAL, 1, 3),
        (EQUAL, 2, 4),
        (EQUAL, 3, 6),
        (UNEQUAL, 1, 4),
        (UNEQUAL, 2, 5),
        (UNEQUAL, 3, 7),
        (EQUAL, 4, 7),
        pytest.param(UNEQUAL, 4, 8, marks=pytest.mark.slow),
    ],
)
def test_proved_at_the_lowest_degree(radii, order, degree):
    blend = solved(radii, order)
    assert blend.certificate.proved
    assert blend.surface.degree == degree
    assert blend.surface.certify().proved
    assert [a.degree for a in blend.attempts] == list(range(1, degree + 1))
    assert blend.attempts[-1].outcome == "proved"
    surface = blend.space.member(blend.coefficients)
    assert surface.patches == blend.surface.patches


@pytest.mark.parametrize("position", range(2))
def test_moved_turned_and_scaled_corners(position):
    center = [(0, 0, 0), (1000, "-2000/3", 77)][position]
    items = [
        pas.Pipe(axis=(3, 4, 0), radius="5/3", clip=1, point=center),
        pas.Pipe(axis=(4, -3, 0), radius="5/4", clip=-1, point=center),
        pas.Pipe(axis=(0, 0, 2), radius=2, clip="5/2", point=center),
    ]
    blend = pas.blend(items, 2, energy=pas.ThinPlate())
    assert blend.certificate.proved
    assert blend.surface.degree == 5
    # five times the unit corner: f is a length, so Hess f scales with 1/5 and the volume with 125
    assert blend.energy == pytest.approx(5 * solved(UNEQUAL, 2).energy, rel=0.02)


draw = runpy.run_path(str(ROOT / "benchmarks/random_corners.py"))["draw"]
"""Three pipes with circles that fit their faces with 10% to spare, from a random generator."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("order", "count"), [(1, 4), (2, 2), (3, 1)])
def test_random_corners(order, count):
    generator = random.Random(7)
    for _ in range(count):
        assert pas.blend(draw(generator), order, energy=pas.ThinPlate()).certificate.proved


@pytest.mark.slow
@pytest.mark.parametrize(("order", "least"), [(1, 100), (2, 98), (3, 95)])
def test_a_hundred_random_corners(order, least):
    generator = random.Random(2026)
    proved = 0
    for _ in range(100):
        try:
            proved += pas.blend(draw(generator), order, energy=pas.ThinPlate()).certificate.proved
        except pas.PasError:
            continue
    assert proved >= least


def test_points_shape_the_surface():
    free = solved(UNEQUAL, 1)
    direction = np.array([-1.0, -1, -1]) / np.sqrt(3)
    before = float(free.surface.intersect_rays(np.zeros(3), direction))
    through = Fraction(round(1000 * (before + 0.1) / np.sqrt(3)), -1000)
    plate = pas.ThinPlate()  # as of the free one
    moved = pas.blend(pipes(UNEQUAL), 1, degree=4, energy=plate, through=[(through,) * 3])
    assert moved.certificate.proved
    cell = moved.surface.cells[0]
    assert cell.polynomial.at((through,) * 3) == 0
    assert moved.energy > free.energy
    points = {"inside": [("-1/4",) * 3], "outside": [("-13/40",) * 3]}
    outside = pas.blend(pipes(UNEQUAL), 1, degree=4, energy=plate, **points)
    assert outside.certificate.proved
    assert outside.surface.contains([[-0.25] * 3, [-0.325] * 3]).tolist() == [True, False]
    assert outside.surface.cells[0].polynomial.at(("-1/4",) * 3) <= -Fraction(9, 10**5)


def test_near_points_are_approached_with_their_weight():
    space = solved(UNEQUAL, 1).space
    wishes = pas.Wishes(energy=pas.ThinPlate(), near=[("-3/10", "-3/10", "-3/10")])
    values = [abs(float(space.fit(wishes, near_weight=w).surface([-0.3] * 3))) for w in (0, 10, 10**4)]
    assert values[0] > 1.2 * values[1] > 10 * values[2]


def test_normalisations():
    space = pas.solutions(pipes(EQUAL), 1)
    total = space.fit(normalize=pas.SumOfCoefficients(), prove=False, guard=False)
    assert sum(total.coefficients) == 1
    point = ("1/10", 0, "1/20")
    value = space.fit(normalize=pas.ValueAt(point, "-1/3"))
    assert value.certificate.proved
    assert value.surface(np.array([0.1, 0, 0.05])) == pytest.approx(-1 / 3)
    mean = space.fit()
    near_pipe = mean.surface.jets([[1 - 1e-9, 1 / 3, 0]])[0]
    assert np.linalg.norm(near_pipe[1:]) == pytest.approx(1, rel=0.5)


def test_the_plain_optimum_is_that_of_the_kkt_equations():
    """With `sum a = 1` alone, K a = lambda 1 has a closed form, solved here exactly."""
    space = pas.solutions(pipes(EQUAL), 1)
    import sympy

    matrix = sympy.Matrix([[sympy.Rational(v.numerator, v.denominator) for v in row] for row in space.energy_matrix()])
    direction = matrix.LUsolve(sympy.ones(3, 1))
    expected = direction / sum(direction)
    fit = space.fit(normalize=pas.SumOfCoefficients(), prove=False, guard=False)
    assert [float(c) for c in fit.coefficients] == pytest.approx([float(e) for e in expected], rel=1e-7)
    energy = (expected.T * matrix * expected)[0] / 2
    assert fit.energy == pytest.approx(float(energy))


@pytest.mark.parametrize("point", ["-1/5", "-1/10", "0"])
def test_the_published_restrictions_are_solved_to_optimality(facts, point):
    """KKT by hand: minimise 1/2 a^T K a, sum a = 1, two linear inequalities, by enumeration."""
    space = pas.solutions(pipes(facts["r"], facts["h"]), 1, 3)
    canonical = space.change_basis([space.coordinates(m["G"]) for m in facts["k1_cubic_basis"]])
    lower, upper = zip(*facts["Omega"], strict=True)
    fit = canonical.fit(
        energy=pas.ThinPlate(pas.Box(lower, upper)),
        inside=[("1/2",) * 3, (point,) * 3],
        margin=0,
        normalize=pas.SumOfCoefficients(),
        prove=False,
        guard=False,
    )
    k = np.array([[float(Fraction(v)) for v in row] for row in facts["k1_cubic_K_on_Omega"]])
    rows = np.array([[float(m[0].at((p,) * 3)) for m in canonical.basis] for p in ("1/2", point)])
    best = np.inf
    for active in ([], [0], [1], [0, 1]):
        constraints = np.vstack([np.ones(3), *rows[active]])
        size = len(constraints)
        system = np.block([[k, constraints.T], [constraints, np.zeros((size, size))]])
        a = np.linalg.solve(system, np.concatenate([np.zeros(3), [1], np.zeros(len(active))]))[:3]
        if (rows @ a <= 1e-9).all():
            best = min(best, a @ k @ a / 2)
    assert fit.energy == pytest.approx(best, rel=1e-6)
    assert sum(fit.coefficients) == 1
    assert not fit.certificate.proved


def test_refit_is_the_same_problem_with_other_points():
    blend = solved(UNEQUAL, 2)
    again = blend.refit()
    assert again.energy == pytest.approx(blend.energy, rel=1e-6)
    moved = blend.refit(near=[("-1/2",) * 3], near_weight=10**6)
    assert abs(moved.surface([-0.5] * 3)) < abs(blend.surface([-0.5] * 3))


def test_without_proof_the_certificate_waits_until_asked():
    blend = pas.blend(
        pipes(EQUAL), 1, prove=False, limits=pas.FairnessLimits(2, 3, 1, 1)
    )  # the first degree keeps them
    assert set(blend.timings) == {"partition", "solve", "fit", "measure"}
    assert blend.certificate.proved


def test_progress_and_timings():
    seen = []
    blend = pas.blend(pipes(EQUAL), 1, on_stage=lambda stage, seconds: seen.append((stage, seconds)))
    assert [s for s, _ in seen][-3:] == [
        "solve (degree 4)",
        "fit and prove (degree 4, dimension 26)",
        "measure (degree 4)",
    ]
    assert set(blend.timings) == {"partition", "solve", "fit and prove", "measure"}


def test_summary():
    text = str(solved(UNEQUAL, 2))
    for words in ("six tetrahedra", "GC^2", "degree", "dimension", "energy", "one sheet", "11 of 11 verdicts proved"):
        assert words in text


X, Y, Z = AXES


@pytest.mark.parametrize(
    ("items", "words"),
    [
        (pipes(EQUAL)[:1], "two or three pipes, not 1"),
        ([*pipes(EQUAL), pas.Pipe((-1, 0, 0), "1/3", 1)], "two or three pipes, not 4"),
        ([pas.Pipe(X, "1/3", 1), pas.Pipe(X, "1/4", 1), pas.Pipe(Z, "1/3", 1)], "pipes 1 and 2 are parallel"),
        (
            [pas.Pipe(X, "1/3", 1), pas.Pipe((1, 1, 0), "1/3", 1), pas.Pipe(Z, "1/3", 1)],
            "pipes 1 and 2 are not perpendicular",
        ),
        (
            [pas.Pipe(X, "1/3", 1), pas.Pipe(Y, "1/3", 1, point=(0, 0, "1/8")), pas.Pipe(Z, "1/3", 1)],
            "axes of pipes 1 and 2 miss each other by 0.125",
        ),
        (
            [pas.Pipe(X, "1/3", 1), pas.Pipe(Y, "1/3", 1), pas.Pipe(Z, "1/3", 1, point=(0, 0, 1))][:2]
            + [pas.Pipe(Z, "1/3", -1, point=(0, 0, 1))],
            "clip plane of pipe 3 passes through the centre",
        ),
        (pipes(("9/20", "1/3", "1/3")), r"pipe 1: .* sticks out by 0.002786.* below 0.447214"),
        (pipes((2, "1/3", "1/3")), "pipe 1: .* does not fit"),
        ([("y^2+z^2-4", "x-1"), *pipes(EQUAL)[1:]], "contact 1: its curve is not closed inside its face"),
        ([("1/9-y^2-z^2", "x-1"), *pipes(EQUAL)[1:]], "sign"),
        ([("y^2+z^2+1/9", "x-1"), *pipes(EQUAL)[1:]], "contact 1: .* nowhere negative"),
        ([("y^2+z^2-1/9", "x^2-1"), *pipes(EQUAL)[1:]], "clip x\\^2 - 1 of contact 1 is not a plane"),
        ([("y^3+z^2-1/9", "x-1"), *pipes(EQUAL)[1:]], "surface 1 is of degree 3.*give the partition"),
    ],
)
def test_geometry_that_cannot_be(items, words):
    with pytest.raises(pas.GeometryError, match=words):
        pas.blend(items, 1, partition="six tetrahedra")
    with pytest.raises(pas.GeometryError, match=words):
        pas.solutions(items, 1, partition="six tetrahedra")


def test_a_clip_that_is_tangent_is_refused():
    # two cylinders that touch in the clip plane: the curve (y^2+z^2-r^2)(...) has a singular point
    surface = "(y^2 + (z - 1/10)^2 - 1/100)*((y)^2 + (z + 1/10)^2 - 1/100)"
    with pytest.raises(pas.GeometryError, match="contact 1: its clip does not cut its surface transversally"):
        pas.solutions([(surface, "x-1"), *pipes(EQUAL)[1:]], 1, 5, pas.SixTetrahedra())


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"order": -1}, ValueError, "order must be a whole number from 0"),
        ({"order": 1.5}, TypeError, "order must be a whole number"),
        ({"order": True}, TypeError, "order"),
        ({"degree": 0}, ValueError, "degree must be a whole number from 1"),
        ({"degree": "3"}, TypeError, "degree must be a whole number"),
        ({"inside": [(0, 0)]}, ValueError, r"inside\[0\] must be three numbers"),
        ({"inside": 3}, TypeError, "inside must be a sequence of points"),
        ({"outside": [(9, 9, 9)]}, ValueError, r"outside \(9, 9, 9\) lies outside the region"),
        ({"near": [(0, 0, float("nan"))]}, ValueError, "finite"),
        ({"near_weight": -1}, ValueError, "must not be negative"),
        ({"energy": "thin"}, TypeError, "energy must be a pas.Energy"),
        ({"normalize": "sum"}, TypeError, "normalize must be"),
        ({"guard": False}, ValueError, "needs guard=True"),
        ({"basis": [[0] * 6]}, ValueError, "degree"),
        ({"partition": 3}, TypeError, "partition must be"),
    ],
)
def test_wrong_arguments(options, error, words):
    with pytest.raises(error, match=words):
        pas.blend(pipes(EQUAL), **({"order": 1} | options))
    with pytest.raises(TypeError, match=r"contacts\[0\] must be a Pipe"):
        pas.blend([1, 2, 3], 1)


def test_a_degree_too_low_says_what_was_tried():
    with pytest.raises(
        pas.NoSolutionError, match=r"degree 4: dimension 0.*lowest degree with solutions is 5"
    ) as caught:
        pas.blend(pipes(UNEQUAL), 2, degree=4)
    assert caught.value.dimensions == {4: 0}
    with pytest.raises(pas.NoSolutionError, match="degree 3: dimension 1"):
        pas.blend(pipes(UNEQUAL), 1, degree=3)


def test_no_provable_member_is_said():
    with pytest.raises(pas.InfeasibleError, match=r"no member of degree 5 .*degree 5: dimension 1"):
        pas.blend(pipes(EQUAL), 3, degree=5)


def test_degrees_are_tried_up_to_twice_the_order_at_least(monkeypatch):
    """Degree 5 has a surface that is not proved, the first of so many that would end the search."""
    few = SearchSettings(degrees=1, above=0, fewest=1)
    monkeypatch.setattr("pas.pipeline.search.CORNER", few)
    monkeypatch.setattr("pas.pipeline.search.GIVEN", few)
    blend = pas.blend(pipes(EQUAL), 3, "lowest")
    assert blend.certificate.proved
    assert [(a.degree, a.dimension) for a in blend.attempts[4:]] == [(5, 1), (6, 12)]


@pytest.mark.slow
@pytest.mark.parametrize(("order", "degree"), [(6, 10), (7, 11)])
def test_products_of_the_pipes_do_not_end_the_search(order, degree):
    """From degree 6 on there are products of the three pipes, which are of no use."""
    blend = pas.blend(pipes(EQUAL), order, "lowest")
    assert blend.certificate.proved and blend.surface.degree == degree
    assert sum(a.dimension > 0 for a in blend.attempts) > GIVEN.degrees


def test_a_refusal_says_where_the_search_ended(monkeypatch):
    few = SearchSettings(degrees=1, above=0, fewest=1, per_order=1)
    monkeypatch.setattr("pas.pipeline.search.CORNER", few)
    monkeypatch.setattr("pas.pipeline.search.GIVEN", few)
    with pytest.raises(pas.InfeasibleError, match=r"; the search ended at degree 5 \(degree=6 goes on\); ") as one:
        pas.blend(pipes(EQUAL), 3)
    assert str(one.value).endswith("six tetrahedra (degrees 1 to 4: dimension 0, degree 5: dimension 1)")
    with pytest.raises(pas.InfeasibleError) as other:
        pas.blend(pipes(EQUAL), 3, degree=5)
    assert "search" not in str(other.value)


@pytest.mark.slow
def test_the_search_ends_at_the_highest_degree():
    with pytest.raises(pas.InfeasibleError, match=r"ended at degree 12 \(the highest there is\).*degree 11: dimension"):
        pas.blend(pipes(EQUAL), 8)


def test_contradictory_points_are_named():
    point = ("1/2", "1/2", "1/2")
    with pytest.raises(pas.InfeasibleError) as caught:
        pas.solutions(pipes(UNEQUAL), 1, 4).fit(
            inside=[(0, 0, 0), point], outside=[("-1/2", "-1/2", "-1/2"), point], through=[("-3/10", "-3/10", "-3/10")]
        )
    assert set(caught.value.conflict) == {"inside (1/2, 1/2, 1/2)", "outside (1/2, 1/2, 1/2)"}
    assert "contradict one another" in str(caught.value)
    with pytest.raises(pas.InfeasibleError, match=r"outside \(0, 0, 0\) cannot be met"):
        pas.solutions(pipes(UNEQUAL), 1, 4).fit(outside=[(0, 0, 0)])
    with pytest.raises(pas.InfeasibleError, match=r"through \(0, 0, 0\) cannot be met"):
        pas.solutions(pipes(UNEQUAL), 1, 4).fit(through=[(0, 0, 0)], normalize=pas.ValueAt((0, 0, 0), 1))


def test_a_solvers_failure_is_not_called_a_contradiction(monkeypatch):
    from pas.fairing.qp import Outcome, QuadraticSolution

    space = pas.solutions(pipes(EQUAL), 1)
    failed = QuadraticSolution(Outcome.FAILED, np.zeros(space.dimension))
    monkeypatch.setattr("pas.fairing.programme.solve", lambda *_: failed)
    with pytest.raises(pas.NotSolvedError, match="the solver found no optimum that passes its checks"):
        space.fit(inside=[(0, 0, 0)])


def test_contradictory_points_do_not_pass_at_any_degree():
    point = ("1/2", "1/2", "1/2")
    for margin in (None, "1/100"):
        with pytest.raises(
            pas.InfeasibleError, match=r"inside \(1/2, 1/2, 1/2\), outside \(1/2, 1/2, 1/2\) contradict"
        ):
            pas.blend(pipes(EQUAL), 1, inside=[point], outside=[point], margin=margin)
