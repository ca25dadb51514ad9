"""Nodes in the place of fillets: pipes and bores of one radius that cross, and three in a point."""

from __future__ import annotations

import numpy as np
import pytest

from pas import solid
from pas.errors import GeometryError
from pas.pipeline.pipe_nodes import PipeNode
from pas.solid.fillets import Filling, fillet_methods
from pas.solid.linked import RenamedBoundary
from pas.solid.operands import Operands


def run() -> solid.Solid:
    return solid.cylinder((-3, 0, 0), (3, 0, 0), 1, face="run")


def branch(end=(0, 0, 3), radius="1", start=(0, 0, 0)) -> solid.Solid:
    return solid.cylinder(start, end, radius, face="branch")


def third(radius="1") -> solid.Solid:
    return solid.cylinder((0, 0, 0), (0, 3, 0), radius, face="third")


def collar(start: str) -> solid.Solid:
    return solid.cylinder((start, 0, 0), ("12/5", 0, 0), "13/10", face="collar")


def bored() -> solid.Solid:
    return solid.box((-2, -2, -2), (2, 2, 2)) - run() - branch()


CASES = {
    "tee": (lambda: run() | branch(), 3),
    "cross": (lambda: run() | branch(start=(0, 0, -3)), 4),
    "in a corner": (lambda: run() | branch() | third(), 4),
    "unequal ones in a corner": (lambda: run() | branch(radius="4/5") | third("7/10"), 4),
    "bend": (lambda: solid.cylinder((0, 0, 0), (3, 0, 0), 1, face="run") | branch(), 2),
    "bores": (bored, 3),
    "nearly equal": (lambda: run() | branch(radius="19/20"), 3),
    "tee with a hole": (lambda: (run() | branch()) - solid.cylinder((-4, 0, 0), (4, 0, 0), "3/5", face="hole"), 3),
    "turned and moved": (lambda: (run() | branch()).rotate((1, 2, 2), 90).translate(7, 8, 9), 3),
}

ALIKE = {"unequal ones in a corner", "cross", "bend", "turned and moved"}
"""Cases that are found, proved and meshed as others are."""


@pytest.mark.sampled(10)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n in ALIKE else n for n in CASES])
def test_the_node_is_a_part_of_the_solid_with_proved_joints(name, order):
    make, arms = CASES[name]
    made = make().fillet("run", "branch", "1/2", order)
    assert made.proved and [v.claim.rpartition("^")[2] for v in made.verdicts] == [str(order)] * arms
    mesh = made.mesh()
    assert mesh.is_closed and mesh.components == 1 and {"fillet", "run", "branch"} <= {*mesh.names}
    assert isinstance(made.sheets, Operands if name in ("bores", "tee with a hole") else RenamedBoundary)


def test_it_fills_the_corner_as_a_ball_would_and_leaves_the_rest():
    plain, made = run() | branch(), (run() | branch()).fillet("run", "branch", "1/2", face="tee")
    points = np.random.default_rng(3).uniform(-3.5, 3.5, (4000, 3))
    away = (np.abs(points[:, 0]) > 1.5) | (points[:, 2] > 1.5)
    assert (made.contains(points[away]) == plain.contains(points[away])).all()
    added, free = [[x, 0, 2.15 - x] for x in (1.05, 1.1)], [[1.5, 0, 1.5], [-1.4, 0, 1.4]]
    assert made.contains(added).all() and not plain.contains(added).any() and not made.contains(free).any()
    assert made.faces == ("tee", "run", "run start", "run end", "branch", "branch start", "branch end")
    assert {*made.mesh().names} == {*made.faces} - {"branch start"}


def test_bores_take_the_corner_away():
    made = bored().fillet("run", "branch", "1/2")
    assert made.proved and isinstance(made.sheets, Operands)
    assert not made.contains([[1.05, 0, 1.1]]).any() and bored().contains([[1.05, 0, 1.1]]).all()
    assert made.contains([[1.5, 0, 1.5]]).all() and made.volume(5e-2) < 47.8171


@pytest.mark.slow
def test_what_else_is_united_or_taken_away_stays():
    bolt = solid.cylinder((-2, 0, -2), (-2, 0, 2), "1/4", face="bolt")
    foot = solid.box((-3, -1, -2), (-2, 1, 0), face="foot")
    made = (((run() - bolt) | branch() | foot) - bolt.translate(4, 0, 0).renamed("other")).fillet(
        "run", "branch", "1/2"
    )
    assert {"bolt", "other", "foot z-", "fillet"} <= {*made.mesh().names} and made.proved
    assert not made.contains([[2, 0, 0.5]]).any() and made.contains([[-2.5, 0.5, -1.9]]).all()


def test_pipes_that_an_edge_serves_have_a_fillet_of_the_edge():
    apart = run() | branch(radius="3/5") | solid.cylinder((0, 0, 0), (0, 0, -3), "3/5", face="third")
    first, *others = fillet_methods(apart, ("run", "branch"), 1, ())
    assert isinstance(first, Filling) and isinstance(*others, PipeNode)
    assert (
        len(fillet_methods(apart, ("run", "branch"), 0, ()))
        == len(fillet_methods(apart, ("run", "branch"), 1, ["z"]))
        == 1
    )
    aside = run() | branch(radius="3/5").translate(0, "1/10", 0)
    assert len(fillet_methods(aside, ("run", "branch"), 1, ())) == 1


@pytest.mark.slow  # the refusal of what is too long finds the same one
def test_the_largest_ends_where_the_pipes_do():
    assert 2 * 29 / 30 < (run() | branch()).largest_fillet("run", "branch") < 2


@pytest.mark.slow
def test_smooth_unions_of_pipes_are_nodes():
    for other, arms in ((branch(), 3), (branch() | third(), 4)):
        made = solid.smooth_union(run(), other, "1/2")
        assert made.proved and len(made.verdicts) == arms and made.mesh().is_closed


REFUSED = {
    "too long": (
        lambda: run() | branch(),
        3,
        "'run' ends 3 from where the axes meet, before a ball touches it; one of",
    ),
    "too short": (lambda: run() | branch(), "1/20", 'leave room, and clip="auto" finds such; one of radius 1.97'),
    "a common part": (lambda: run() & branch(start=(0, 0, -3)), "1/4", "touch, or nearly so, near"),
    "a collar over its end": (
        lambda: run() | branch() | collar("3/2"),
        "1/2",
        "is not proved: fillet meets run with GC^1: the regions of the two faces do not both reach the curve",
    ),
    "axes that miss": (
        lambda: run() | branch().translate(0, "1/10", 0),
        "1/4",
        "one of the faces does not go on so far from the edge; one of radius 0.1",
    ),
    "a fillet in its place": (
        lambda: (run() | collar("8/5")).fillet("run", "collar start", "1/5", face="ring") | branch(),
        "1/2",
        "is not proved: ring meets run with GC^1: the regions of the two faces do not both reach the curve",
    ),
}


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(n, marks=pytest.mark.slow) if n in ("axes that miss", "a fillet in its place") else n
        for n in REFUSED
    ],
)
def test_refused(name):
    make, radius, sentence = REFUSED[name]
    with pytest.raises(GeometryError, match="'run' and 'branch'") as caught:
        make().fillet("run", "branch", radius)
    assert sentence in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("cut", "face"),
    [
        (lambda: run() - solid.cylinder((-9, "3/10", 0), (9, "3/10", 0), "3/10", "hole"), "hole"),
        (lambda: run() & solid.half_space("y + z/2 - 9/10", "flat"), "flat"),
    ],
)
def test_a_face_that_would_be_lost_is_told(cut, face):
    """A flat part of one pipe, and a hole along it, which the node would not have."""
    with pytest.raises(GeometryError, match=rf"the face '{face}' near \(.*\) would end there; take it away from the"):
        (cut() | branch()).fillet("run", "branch", "1/2")


def test_other_names_keep_what_is_known_to_bound_a_solid():
    prism = solid.rounded_rectangle(1, "4/5", "1/5").extrude(3)
    named = prism.renamed("all")
    assert {*named.mesh().names} == {"all"} and isinstance(named.sheets, RenamedBoundary)
    assert named.mesh().volume == prism.mesh().volume and named.proved
    cut = solid.ball((0, 0, 1), "6/5") - named.translate("-1/2", "-2/5", 0).rotate((1, 2, 3), 33)
    assert cut.mesh().is_closed and {*cut.mesh().names} == {"ball", "all"}
