"""What is straight stays straight: runs between contacts in line, their waist, and the guide that keeps them."""

from dataclasses import replace
from functools import cache
from math import cos, radians, sin

import numpy as np
import pytest

import pas
from pas.fairing.energy import Sizes, SurfacePoints, differences
from pas.surface.fairness_limits import neighbour
from pas.surface.straight_runs import guided, straight_runs, waists

X, BACK, Y, DOWN, Z = (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1)


def towards(angle, across="0"):
    """A direction in the plane of x and y, by its angle from x in degrees, with three decimals."""
    return f"{cos(radians(angle)):.3f}", f"{sin(radians(angle)):.3f}", across


T = [(X, 1, 2), (BACK, 1, 2), (Y, "4/5", 2)]
CROSS = [(X, 1, 2), (BACK, 1, 2), (Y, 1, 2), (DOWN, 1, 2)]
STAR = [((2, -1, -1), 1), ((-1, 2, -1), 1), ((-1, -1, 2), 1)]
REDUCER = [(X, 1, 2), (BACK, "1/2", 2), (Y, "2/5", 2)]


def runs_of(contacts):
    """The runs between contacts as the measures see them."""
    placed = pas.solutions(contacts, 1, 1).placed
    scale = float(placed.partition.frame.scale)
    return straight_runs([neighbour(join, scale) for join in placed.joins])


def pairs_of(contacts):
    return sorted(run.contacts for run in runs_of(contacts))


def test_contacts_that_continue_one_another():
    assert pairs_of(pas.struts(T, 1)) == [(0, 1)]
    assert pairs_of(pas.struts(CROSS, 1)) == [(0, 1), (2, 3)]
    assert pairs_of(pas.struts(STAR, 1)) == [(0, 1), (0, 2), (1, 2)]
    assert pairs_of(pas.struts(REDUCER, 1)) == [(0, 1)]
    assert pairs_of(pas.struts([(X, 1), (towards(155), 1), (towards(270), "3/5")], 1)) == [(0, 1)]


def test_what_is_no_run():
    assert not pairs_of(pas.struts([(X, 1, 2), (Y, 1, 2)], 1))
    assert not pairs_of(pas.struts([(X, 1), (towards(145), 1), (towards(270), "3/5")], 1))
    assert not pairs_of([pas.Cone(X, "1/4", 2, "-1/4"), pas.Cone(BACK, "1/4", 2, "-1/4"), pas.Pipe(Y, "1/4", 2)])
    aside = [pas.Pipe(X, "1/2", 2, (0, 0, "1/8")), pas.Pipe(BACK, "1/2", 2), pas.Pipe(Y, "1/2", 2)]
    assert not pairs_of(aside)


def test_a_contact_continues_one_other_the_straightest():
    items = [(X, "1/2"), (BACK, "1/2"), (towards(155), "1/4"), (Z, "1/4")]
    assert pairs_of(pas.struts(items, 1)) == [(0, 1)]


def test_distances_from_the_tube():
    (run,) = runs = runs_of(pas.struts(T, 1))
    assert run.radii == pytest.approx((1, 1)) and run.lengths == pytest.approx((2, 2))
    points = np.array([[0, -1, 0], [1, -0.9, 0], [0.5, 0, 1.3], [0, 1, 0], [2.5, -1, 0]], dtype=float)
    distance, cosines = run.seen(points)
    assert distance[:4] == pytest.approx([0, -0.1, 0.3, 0]) and np.isnan(distance[4])
    assert cosines[:4, 0] == pytest.approx([-1, -1, 0, 1])
    assert guided(runs, points)[1][:, 0] == pytest.approx([1, 1, 1, 0, 0])
    assert waists(runs, points) == pytest.approx([0, -0.1, 0.3, 0, 0])


def test_where_runs_cross_the_outer_tube_counts():
    """Of runs of radius 1 and 0.96 the wider one has the top of the crossing; equal ones have it by halves."""
    top = np.array([[0, 0, 0.98], [0.1, 0, 0.9]])
    unequal = runs_of(pas.struts([(X, 1, 2), (BACK, 1, 2), (Y, "24/25", 2), (DOWN, "24/25", 2)], 1))
    distances, shares = guided(unequal, top)
    assert distances[0] == pytest.approx([-0.02, 0.02])
    first, second = 0.5 + 0.04 / (0.2 * 0.96), 0.5 - 0.04 / 0.2
    assert shares[0] == pytest.approx([u * u * (3 - 2 * u) for u in (first, second)])
    assert waists(unequal, top) == pytest.approx([-0.02, -0.1])
    equal = runs_of(pas.struts(CROSS, 1))
    assert guided(equal, top[:1])[1][0] == pytest.approx([0.5, 0.5])
    assert not guided(equal, np.array([[3.0, 3, 0]]))[1].any()  # beyond the ends of both
    assert waists(equal, top[:1]) == pytest.approx([-0.02])


def test_a_thinner_tube_is_hidden_in_the_run_that_it_crosses():
    """Its two ends are branches, with fillets; their guides pinched the wider run by 0.06 of its radius."""
    assert pairs_of(pas.struts([(X, 1, 2), (BACK, 1, 2), (Y, "9/10", 2), (DOWN, "9/10", 2)], 1)) == [(0, 1)]
    assert pairs_of(pas.struts([(X, "1/2", 2), (BACK, "1/2", 2), (Y, 1, 2), (DOWN, 1, 2)], 1)) == [(2, 3)]
    leaning = [(X, 1), (BACK, 1), (("0.36", "-0.895", "-0.265"), "2/5"), (("0.029", "0.958", "0.284"), 1)]
    blend = pas.node(leaning, 1)
    assert blend.surface.degree == 4 and not blend.fairness.beyond(blend.limits)


@pytest.mark.slow
def test_the_search_goes_on_to_the_degree_that_keeps_a_run_straight():
    """A T that leans: at degree 5 the space is stiff and the waist is 0.53, at degree 6 it is 0.017."""
    items = [(X, 1), (BACK, 1), (("0.564", "-0.802", "-0.196"), "4/5")]
    blend = pas.node(items, 2)
    assert [a.degree for a in blend.attempts if "proved" in a.outcome] == [5, 6]
    assert not blend.fairness.beyond(blend.limits)


def test_a_run_of_two_radii_has_both_at_its_ends():
    (run,) = runs_of(pas.struts(REDUCER, 1))
    ends = np.array([[1.999999, 0, 1], [-1.999999, 0, -0.5], [0, 0, 0.75]])
    assert run.seen(ends)[0] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("bend", [170, 155])
def test_a_bend_follows_the_arc_tangent_to_both_axes(bend):
    (run,) = runs_of(pas.struts([(X, 1, 5), (towards(bend), 1, 4), (towards(270), "3/5", 4)], 1))
    inward = (run.first + run.second) / np.linalg.norm(run.first + run.second)
    middle = inward * run.tangent * (1 / np.cos(run.half) - np.tan(run.half))
    up = np.array([0, 0, 1.0])
    points = np.array([middle + up, middle - up, middle - inward, 4.5 * run.first + up])
    assert run.seen(points)[0] == pytest.approx(0, abs=1e-9)
    assert sum(run.reach) < sum(run.lengths)


def test_the_slopes_of_the_guide_are_those_of_differences():
    runs = runs_of(pas.struts([(X, 1), (towards(160), "4/5"), (towards(270), "3/5")], 1))
    generator = np.random.default_rng(5)
    places = generator.normal(size=(200, 3))
    places *= (1.2 / np.linalg.norm(places[:, 1:], axis=1))[:, None]
    zeros = np.zeros((200, 3))
    frame = np.zeros((200, 3, 2))
    points = SurfacePoints(places + [1, 2, 3], zeros, np.ones(200), zeros, np.zeros((200, 4)), frame)
    sizes = Sizes(1.0, 2.0, np.array([1.0, 2.0, 3.0]), runs)
    energy = pas.CurvatureVariation()
    own = energy.slopes(points, sizes)
    found = differences(lambda moved: energy.residuals(moved, sizes), points)
    assert own.shape == (200, 7, 14) and np.abs(own[:, 6]).max() > 1
    assert np.abs(own - found).max() <= 1e-5 * np.abs(own).max()


JUNCTIONS = {
    "T": T,
    "cross": CROSS,
    "star": STAR,
    "reducer": REDUCER,
    "bend": [(X, 1), (towards(165), 1), (DOWN, "1/2")],
}


@pytest.mark.sampled(10)
@pytest.mark.parametrize("name", JUNCTIONS)
@pytest.mark.parametrize("order", [1, 2])
def test_junctions_are_proved_and_straight(name, order):
    blend = pas.node(JUNCTIONS[name], order)
    assert blend.certificate.proved and not blend.fairness.beyond(blend.limits)
    assert 0 < blend.fairness.waist <= 0.03


@cache
def junction(degree, guide=True, waist=None):
    """That of a T, solved once for all tests, with a limit of its own to the waist or the usual one."""
    options = {} if guide else {"energy": pas.CurvatureVariation(straight=0)}
    if waist is not None:
        options["limits"] = replace(junction(degree).limits, waist=waist)
    return pas.node(T, 1, degree=degree, **options)


def test_without_the_guide_a_junction_has_a_waist():
    kept, loose = junction(5), junction(5, guide=False, waist=1000)
    assert loose.fairness.waist > 0.1
    assert loose.fairness.beyond(kept.limits) == (f"waist {loose.fairness.waist:.3g} above 0.03",)
    assert loose.fairness.waisted[1] < -0.5  # opposite to the branch
    assert kept.fairness.waist < loose.fairness.waist / 5
    assert f"{loose.fairness.waist:.3f} of the radius of the run, at (" in str(loose.fairness)


def test_what_is_beyond_the_limit_is_pressed_in_without_the_guide():
    free, kept = (junction(5, guide=False, waist=waist) for waist in (1000, 0.03))
    assert kept.fairness.waist < free.fairness.waist / 2


def test_the_limit_can_be_changed():
    blend = junction(4, waist=0.001)
    assert blend.limits.told.endswith("waist 0.001")
    assert any(word.startswith("waist") for word in blend.fairness.beyond(blend.limits))


def test_corners_have_no_run():
    assert not pairs_of([pas.Pipe(axis, "1/3", 1) for axis in (X, Y, Z)])
    blend = pas.blend([pas.Pipe(axis, "1/3", 1) for axis in (X, Y, Z)], 1)
    assert blend.fairness.waist == 0 and "waist         no run" in str(blend.fairness)
