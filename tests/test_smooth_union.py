"""Smooth unions: the edges are found, their fillets are proved, and all else is refused with what is wrong."""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from test_fillets import CORNER

from pas import solid
from pas.errors import GeometryError
from pas.solid.face_seams import edges_between


def plate() -> solid.Solid:
    return solid.box((-2, -2, -1), (2, 2, 0), face="plate")


def peg(bottom: int = 0) -> solid.Solid:
    return solid.cylinder((0, 0, bottom), (0, 0, 2), "3/4", face="peg")


def pipe(*, below: int = 0, radius: str = "1") -> solid.Solid:
    return solid.cylinder((0, 0, below), (0, 0, "9/4"), radius, face="branch")


def run() -> solid.Solid:
    return solid.cylinder((-2, 0, 0), (2, 0, 0), 1, face="run")


def bars(height: int = 1) -> tuple[solid.Solid, solid.Solid]:
    one = solid.box((-2, "-1/2", 0), (2, "1/2", 1), face="a")
    return one, solid.box(("-1/2", -2, 0), ("1/2", 2, height), face="b")


MADE = {
    "peg on plate": (lambda: (plate(), peg()), {("plate z+", "peg")}),
    "peg through plate": (lambda: (plate(), peg(-3)), {("plate z+", "peg"), ("plate z-", "peg")}),
    "ball on plate": (lambda: (plate(), solid.ball((0, 0, "1/2"), 1)), {("plate z+", "ball")}),
    "branch on pipe": (lambda: (run(), pipe(radius="3/5")), {("run", "branch")}),
    "branches on pipe": (lambda: (run(), pipe(below=-2, radius="3/5")), {("run", "branch")}),
    "cross of equal bars": (bars, {(f"a y{s}", f"b x{t}") for s in "+-" for t in "+-"}),
    "two pegs": (
        lambda: (plate(), solid.cylinder((-1, 0, 0), (-1, 0, 2), "1/2", face="peg").pattern(2, (2, 0, 0))),
        {("plate z+", "peg"), ("plate z+", "peg #2")},
    ),
}


@pytest.mark.sampled(16)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", MADE)
def test_all_edges_between_the_solids_are_rounded(name, order):
    make, pairs = MADE[name]
    a, b = make()
    made = solid.smooth_union(a, b, "1/4", order)
    fillets = [face for face in made.faces if face.startswith("fillet")]
    assert len(fillets) == len(pairs) and made.proved and len(made.verdicts) == 2 * len(pairs)
    assert {v.claim.rpartition("^")[2].partition(" on a part")[0] for v in made.verdicts} == {str(order)}
    joined = [{j.second for j in made.joints if j.first == face} for face in fillets]
    assert {frozenset(pair) for pair in pairs} == {frozenset(faces) for faces in joined}
    mesh = made.mesh()
    assert mesh.is_closed and mesh.components == 1 and mesh.volume > (a | b).mesh().volume
    for one in (k for k, names in enumerate(mesh.solid_faces) if {*names} <= {*a.faces}):
        others = [k for k, names in enumerate(mesh.solid_faces) if {*names} <= {*b.faces}]
        assert not len(edges_between(mesh, [one], others))


@pytest.mark.slow
def test_the_material_of_a_cross_is_that_of_four_cylinders():
    a, b = bars()
    assert solid.smooth_union(a, b, "1/4").volume() == pytest.approx((a | b).volume() + 4 * CORNER / 16, rel=1e-4)


def test_the_solids_stay_what_they_were_away_from_the_edge():
    made = solid.smooth_union(plate(), peg(), "1/4")
    points = np.random.default_rng(1).uniform(-2.5, 2.5, (2000, 3))
    away = (points[:, 2] < 0) | (points[:, 2] > 0.26) | (np.hypot(points[:, 0], points[:, 1]) > 1.01)
    assert (made.contains(points[away]) == (plate() | peg()).contains(points[away])).all()
    assert made.contains([[0.78, 0, 0.03]]).all() and not (plate() | peg()).contains([[0.78, 0, 0.03]]).any()


@pytest.mark.slow
def test_faces_of_one_name_are_told_apart():
    """The joint that the second solid claims is kept, under the new name."""
    ball = solid.ball((0, 0, "1/2"), 1)
    rounded = solid.smooth_union(plate(), ball, "1/4")
    again = solid.smooth_union(ball.scale("1/4").translate(0, 0, "3/2"), rounded, "1/16")
    assert again.faces == ("ball", *plate().faces, "ball #2", "fillet", "fillet 2") and len(again.joints) == 4
    assert [(j.first, j.second) for j in again.joints[:2]] == [("fillet", "plate z+"), ("fillet", "ball #2")]
    assert again.proved


def test_a_name_that_is_numbered_already_is_left_alone():
    small = solid.ball((0, 0, 0), "1/2")
    other = solid.ball((0, 0, "1/2"), "1/4") | solid.ball((0, 0, -5), "1/4", face="ball #2")
    assert solid.smooth_union(small, other, "1/16").faces == ("ball", "ball #3", "ball #2", "fillet")


def test_what_stands_on_a_face_does_not_name_it():
    """Seen from outside, the bottom of a peg is nowhere; tops of one height are both there."""
    assert (plate() | peg()).mesh().names == (*plate().faces, "peg", "peg end")
    assert (plate() - peg(-1).translate(0, 0, -1)).mesh().names[-2:] == ("plate z+", "peg")
    a, b = bars()
    assert {"a z+ + b z+", "a z- + b z-"} <= {*(a | b).mesh().names}


def test_what_a_fillet_leaves_is_told(monkeypatch):
    module = importlib.import_module("pas.solid.smooth_union")
    monkeypatch.setattr(module, "filled", lambda whole, *_: whole)
    with pytest.raises(GeometryError, match=r"the fillet of 'plate z\+' and 'peg' leaves a part of their edge near"):
        solid.smooth_union(plate(), peg(), "1/4")


MEET = "the solids do not meet in an edge where a face of one crosses a face of the other"
REFUSED = {
    "apart": (lambda: (plate(), solid.ball((9, 0, 0), 1)), MEET),
    "inside": (lambda: (plate(), solid.ball((0, 0, "-1/2"), "1/4")), f"{MEET}, as one is inside the other"),
    "around": (lambda: (solid.ball((0, 0, "-1/2"), "1/4"), plate()), f"{MEET}, as one is inside the other"),
    "one on the other": (lambda: (plate(), plate().translate(0, 0, 1)), MEET),
    "itself": (lambda: (plate(), plate()), MEET),
    "bars": (lambda: bars(2), "'b x-' near (-0.5, -0.5, 1): fillets do not meet in corners"),
    "peg at an edge": (
        lambda: (plate(), solid.cylinder((2, 0, -2), (2, 0, 1), "1/2", face="peg")),
        "the edge of 'plate x+' and 'peg' goes on as that of 'plate z-' and 'peg' near (2, ",
    ),
    "too large": (
        lambda: (plate(), peg(), "5/2"),
        "a fillet of radius 5/2 between 'plate z+' and 'peg' is not proved: ",
    ),
    "order": (lambda: (plate(), peg(), "1/4", 0), "order must be at least 1; chamfer cuts edges off flatly"),
    "radius": (lambda: (plate(), peg(), 0), "radius must be positive, not 0"),
    "mesh": (
        lambda: (plate(), peg().mesh()),
        "smooth_union takes two solids and a radius, as in smooth_union(a, b, 1), not <Mesh",
    ),
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name == "too large" else name for name in REFUSED]
)
def test_refused(name):
    make, sentence = REFUSED[name]
    a, b, radius, *order = *make(), *(["1/4"] if len(make()) == 2 else [])
    with pytest.raises((GeometryError, ValueError, TypeError)) as caught:
        solid.smooth_union(a, b, radius, *order)
    assert sentence in str(caught.value) and "\n" not in str(caught.value)
