"""Wishes that cannot hold are named at once, before any degree is solved; the programmes behind the choice."""

from __future__ import annotations

import cvxpy
import numpy as np
import pytest
from conftest import EQUAL, UNEQUAL, pipes, solved

import pas
from pas.fairing.constraints import Margins
from pas.fairing.prepared import SLIM
from pas.fairing.qp import Outcome, Programme, solve

CENTRE = (0, 0, 0)
PLACE = ("1/2", 0, 0)


def refused(monkeypatch, **wishes):
    """The error of a blend that must not come to solving anything."""

    def never(*_):
        raise AssertionError("a degree was solved before the wishes were looked at")

    monkeypatch.setattr("pas.pipeline.search.solve", never)
    with pytest.raises(pas.InfeasibleError) as caught:
        pas.blend(pipes(UNEQUAL), 2, **wishes)
    return caught.value


@pytest.mark.parametrize("kind", ["outside", "through"])
def test_the_centre_must_be_inside(monkeypatch, kind):
    error = refused(monkeypatch, **{kind: [CENTRE]})
    assert "the centre (0, 0, 0) of the partition" in str(error) and "must be inside" in str(error)
    assert error.conflict == (f"{kind} (0, 0, 0)",)


@pytest.mark.parametrize("kinds", [("inside", "outside"), ("inside", "through"), ("through", "outside")])
def test_a_point_has_one_sign(monkeypatch, kinds):
    error = refused(monkeypatch, **{kind: [("1/2",) * 3] for kind in kinds})
    assert "a point has one sign" in str(error)
    assert set(error.conflict) == {f"{kind} (1/2, 1/2, 1/2)" for kind in kinds}


@pytest.mark.parametrize("kind", ["outside", "through"])
def test_the_way_into_a_pipe_is_inside(monkeypatch, kind):
    error = refused(monkeypatch, **{kind: [PLACE]})
    assert "the ray from the centre through it leaves the region through the inside of contact 1" in str(error)
    assert error.conflict == (f"{kind} (1/2, 0, 0)",)


def test_wishes_that_can_hold_are_not_refused():
    blend = pas.blend(pipes(EQUAL), 1, inside=[("1/10", 0, 0)], outside=[("-1/2", "-1/2", "-1/2")])
    assert blend.certificate.proved
    assert blend.surface(np.array([[0.1, 0, 0]]))[0] < 0


def test_the_surface_keeps_away_from_the_centre():
    for radii, order in ((EQUAL, 1), (EQUAL, 2), (EQUAL, 3), (UNEQUAL, 1)):
        points = solved(radii, order).surface.mesh(0.05).points
        assert np.linalg.norm(points, axis=1).min() > 0.09, (radii, order)


def test_the_centre_is_inside_by_a_margin():
    problem = pas.solutions(pipes(EQUAL), 1, 4).problem(near=[("1/50", "1/50", "1/50")], near_weight=10_000)
    radius = 1 / 3
    assert np.isclose(problem.solve().surface(np.zeros(3)), -SLIM * Margins.depth * radius, rtol=1e-4)


def test_members_with_huge_coefficients_can_be_chosen_from():
    """Skew pipes in one piece have members whose coefficients overflow doubles when they are squared."""
    y = [pas.Pipe(axis, "1/3", clip) for axis, clip in (((1, 0, 0), 1), ((-4, 7, 0), "1/8"), ((-4, -7, 0), "1/8"))]
    space = pas.solutions(y, 2, 6, partition=pas.SingleCell((-1, -1, -1), (1, 1, 1)))
    assert space.dimension == 2
    blend = space.fit(prove=False, guard=False, normalize=pas.SumOfCoefficients())
    assert np.isfinite(blend.energy) and all(v.proved for v in blend.certificate.faces)


@pytest.mark.parametrize("seed", range(6))
def test_the_solver_agrees_with_another_one(seed):
    rng = np.random.default_rng(seed)
    m, rows = 6, 25
    factor, equations, inequalities = (rng.normal(size=(n, m)) for n in (m, 1, rows))
    known = rng.normal(size=m)  # satisfies all
    slack = np.abs(rng.normal(size=rows))
    programme = Programme(
        factor @ factor.T, rng.normal(size=m), equations, equations @ known, inequalities, inequalities @ known - slack
    )
    unknowns = cvxpy.Variable(m)
    cost = cvxpy.quad_form(unknowns, cvxpy.psd_wrap(programme.hessian)) / 2 + programme.linear @ unknowns
    constraints = [equations @ unknowns == programme.equal_to, inequalities @ unknowns >= programme.at_least]
    cvxpy.Problem(cvxpy.Minimize(cost), constraints).solve(solver=cvxpy.CLARABEL)
    solution = solve(programme)
    assert solution.outcome is Outcome.SOLVED
    assert np.allclose(solution.unknowns, unknowns.value, atol=1e-5)


def test_settings_have_one_list_of_names():
    from dataclasses import fields

    from pas.fairing.wishes import Options, PointOptions

    assert [f.name for f in fields(pas.Wishes)] == [name for name in Options.__annotations__ if name != "tension"]
    assert PointOptions.__annotations__.keys() <= Options.__annotations__.keys()
    with pytest.raises(TypeError, match="there is no option 'insid'; is 'inside' meant"):
        pas.Wishes(insid=[PLACE])
    with pytest.raises(TypeError, match="there is no option 'nears'; is 'near' meant"):
        pas.blend(pipes(EQUAL), 1, nears=[PLACE])
    space = pas.solutions(pipes(EQUAL), 1, 3)
    for call in (space.optimum, solved(EQUAL, 1).refit):
        with pytest.raises(TypeError, match="there is no option 'prove' here"):
            call(prove=False)


def test_wishes_without_points_are_plain():
    every = {kind: [PLACE] for kind in ("inside", "outside", "through", "near")}
    more = {"near_weight": 7, "margin": 1, "handles": {(0, (3, 0, 0, 0)): 1}, "coefficients": {0: 1}}
    kept = {"tension": 2, "normalize": pas.SumOfCoefficients(), "limits": pas.FairnessLimits.of_order(1)}
    assert pas.Wishes(**every, **more, **kept).plain == pas.Wishes(**kept) != pas.Wishes(**kept, margin=1)


def test_settings_are_exact_and_can_be_changed():
    wishes = pas.Wishes(near=[(0.5, "1/3", 1), PLACE], near_weight=(1, 2), handles={(0, (1, 0, 0, 0)): "1/2"}, margin=1)
    assert wishes.near[0] == pas.Wishes(near=["1/2", "1/3", "1"]).near[0]
    assert wishes.changed() == wishes
    assert wishes.changed(margin=None) == pas.Wishes(near=wishes.near, near_weight=(1, 2), handles=wishes.handles)
    assert wishes.changed(near_weight=[3, 3]).near_weight == 3
    assert wishes.changed(near=(), near_weight=()) == pas.Wishes(handles=wishes.handles, margin=1)
    with pytest.raises(ValueError, match="one for each of the 1 near points"):
        wishes.changed(near=[PLACE])
    assert hash(wishes) == hash(wishes.changed())


def test_settings_and_keywords_say_the_same():
    wishes = pas.Wishes(inside=[("1/2", 0, 0)], energy=pas.Membrane(), prove=False)
    by_settings = pas.blend(pipes(EQUAL), 1, 3, wishes=wishes)
    by_keywords = pas.blend(pipes(EQUAL), 1, 3, inside=[("1/2", 0, 0)], energy=pas.Membrane(), prove=False)
    assert by_settings.surface.patches == by_keywords.surface.patches
    assert by_settings.wishes == by_keywords.wishes == wishes
    plain = pas.blend(pipes(EQUAL), 1, 3, wishes=wishes, energy=pas.ThinPlate())
    assert plain.wishes == wishes.changed(energy=pas.ThinPlate())
    assert by_settings.refit(inside=[]).wishes == wishes.changed(inside=[])
    assert by_settings.space.fit(wishes).coefficients == by_settings.coefficients
