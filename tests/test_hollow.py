"""Shells and tubes: exact distances, walls of the right thickness, tubes along curves."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

import pas
from pas import solid
from pas.solid.shell import FaceDistance

RING = ("cos(t)", "sin(t)", "0")
TURN = (0, "6.283185307179586")


def test_a_hollow_ball():
    hollow = solid.ball((1, 0, 0), 1).shell(0.2, tolerance=0.02)
    assert hollow.faces == ("ball", "inside of ball")
    mesh = hollow.mesh(2e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 2, 4)
    inner = np.unique(mesh.triangles[mesh.faces == 1])
    radii = np.linalg.norm(mesh.points[inner] - [1, 0, 0], axis=1)
    assert np.abs(radii - 0.8).max() < 1e-10
    assert hollow.volume(2e-2) == pytest.approx(4 / 3 * pi * (1 - 0.8**3), rel=2e-4)


def test_an_open_box_has_sharp_inner_edges():
    tray = solid.box((0, 0, 0), (4, 3, 2)).shell(0.25, open=["box z+"])
    mesh = tray.mesh(5e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2)
    assert mesh.volume == pytest.approx(24 - 3.5 * 2.5 * 1.75, rel=1e-9)
    assert mesh.face_areas["box z+"] == pytest.approx(12 - 3.5 * 2.5, rel=1e-9)
    assert mesh.face_areas["inside of box z-"] == pytest.approx(3.5 * 2.5, rel=1e-9)


def test_a_groove_is_round_inside():
    bar = solid.box((0, 0, 0), (2, 2, 1)) - solid.box((1, 1, -1), (3, 3, 3), face="cut")
    angle = bar.shell(0.25, open=["box z+", "box z-"])
    plan = 1.5**2 - (1 - (0.25**2 - pi / 4 * 0.25**2))
    assert "inside of cut x- and cut y-" in angle.faces
    assert angle.volume(2e-2) == pytest.approx(3 - plan, rel=1e-4)


def test_walls_have_the_thickness_everywhere():
    lens = solid.ball((0, 0, 0), 1, "one") & solid.ball((1, 0, 0), 1, "two")
    hollow = lens.shell(0.125)
    exact = solid.ball((0, 0, 0), "7/8") & solid.ball((1, 0, 0), "7/8")
    points = np.random.default_rng(0).uniform(-1, 1.5, (50_000, 3))
    inside = lens.contains(points) & ~exact.contains(points)
    assert np.array_equal(hollow.contains(points), inside)
    assert 0.005 < inside.mean() < 0.5


def test_the_distance_to_a_smooth_joint_of_two_faces():
    ball, other = "x^2 + y^2 + z^2 - 1", "x^2 + y^2 + z^2 - 1 + (z - 1/3)^2"
    shape = solid.patch("upper", ball, "z - 1/3") | solid.patch("lower", other, "1/3 - z")
    shape = shape.joined("upper", "lower", (ball, "z - 1/3"), 1)
    near = FaceDistance(shape, ["upper", "lower"], 0.1, 1e-2)
    mesh = shape.mesh(4e-3)
    normals = mesh.point_normals
    jets = near.jets(mesh.points - 0.1 * normals)
    assert np.abs(jets[:, 0]).max() < 1e-9
    assert np.abs(jets[:, 1:] + normals).max() < 1e-5
    hollow = shape.shell(0.1)
    assert hollow.proved
    assert hollow.faces[-1] == "inside of upper and lower"
    assert hollow.mesh(2e-2).euler_characteristic == 4


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "ends, volume, euler",
    [("flat", pi / 64 * 6 * np.sqrt(1.04), 2), ("round", pi / 64 * 6 * np.sqrt(1.04) + 4 / 3 * pi / 512, 2)],
)
def test_a_helix(ends, volume, euler):
    coil = solid.tube(("cos(t)", "sin(t)", "t/5"), "1/8", (0, 6), ends=ends)
    mesh = coil.mesh(1e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, euler)
    assert coil.volume(1e-2) == pytest.approx(volume, rel=1e-3)
    assert coil.faces == (("tube", "tube start", "tube end") if ends == "flat" else ("tube",))
    if ends == "flat":
        assert mesh.face_areas["tube end"] == pytest.approx(pi / 64, rel=8e-2)


@pytest.mark.slow
def test_a_closed_tube_is_a_torus():
    ring = solid.tube(RING, "1/4", TURN)
    assert ring.faces == ("tube",)
    torus = solid.torus((0, 0, 0), (0, 0, 1), 1, "1/4")
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (100_000, 3))
    assert np.array_equal(ring.contains(points), torus.contains(points))
    assert ring.volume(2e-2) == pytest.approx(2 * pi * pi / 16, rel=1e-3)


@pytest.mark.slow
def test_tubes_and_shells_compose_move_and_survive_files(tmp_path):
    coil = solid.tube(("t", "t^2", "0"), "1/4", (-1, 1))
    pipe = coil.shell(0.1, open=["tube start", "tube end"])
    assert pipe.faces[-1] == "inside of tube"
    moved = pipe.rotate((0, 0, 1), 30).translate((5, 0, 0)).scale(2)
    path = pas.save_solid(moved, tmp_path / "pipe.pas.json")
    again = pas.load(path)
    points = np.random.default_rng(0).uniform(moved.box[0], moved.box[1], (1000, 3))
    assert np.array_equal(moved.contains(points), again.contains(points))
    start = moved.contains(points).mean()
    assert 0.01 < start < 0.5
    with pytest.raises(ValueError, match="same factor in all directions"):
        pipe.scale((1, 2, 1))


@pytest.mark.parametrize(
    "make, error, words",
    [
        (lambda: solid.ball((0, 0, 0), 1).shell(0), ValueError, "thickness must be a positive number"),
        (lambda: solid.ball((0, 0, 0), 1).shell("3/2"), pas.GeometryError, "thicker than the part"),
        (lambda: solid.ball((0, 0, 0), 1).shell(1.5), pas.GeometryError, r"thicker than the part.*below (1|0\.9)"),
        (lambda: solid.ball((0, 0, 0), 1).shell(0.1, open=["lid"]), pas.GeometryError, "no face 'lid' to open"),
        (lambda: solid.ball((0, 0, 0), 1).shell(0.1, open=["ball"]), pas.GeometryError, "at least one face"),
        (lambda: solid.ball((0, 0, 0), 1).shell(0.1, open="ball"), TypeError, "sequence of names"),
        (
            lambda: solid.box((0, 0, 0), (4, 3, 2)).rounded(radius="1/2").shell(0.1, open=["box z+"]),
            pas.GeometryError,
            "'box z[+]' goes on smoothly, or nearly so, in 'box [xy][-+] / box z[+]', where a wall has no edge to end",
        ),
        (lambda: solid.tube(RING, 2, TURN), pas.GeometryError, "folds over at t = "),
        (lambda: solid.tube(RING, 0, TURN), ValueError, "radius must be positive"),
        (lambda: solid.tube(RING, 1, (1, 1)), ValueError, "two rising numbers"),
        (lambda: solid.tube(("t", "t"), 1, (0, 1)), ValueError, "three formulas in t"),
        (lambda: solid.tube(("t", "u", "0"), 1, (0, 1)), ValueError, "the curve's y"),
        (lambda: solid.tube(("t^2", "t^2", "0"), 1, (-1, 1)), pas.GeometryError, "stops or turns back at t = "),
        (lambda: solid.tube(("1/t", "0", "0"), 1, (0, 1)), pas.GeometryError, "not defined or not smooth at t = 0"),
        (lambda: solid.tube(RING, "1/4", TURN, ends="sharp"), ValueError, "'flat' or 'round'"),
    ],
)
def test_bad_input(make, error, words):
    with pytest.raises(error, match=words):
        make()
