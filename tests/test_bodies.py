"""Blends as solids: closed bodies with their neighbours, joints proved anew, and what cannot be one."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from conftest import AXES, UNEQUAL, fair

import pas
from pas import solid
from pas.cli import main
from pas.pipeline.bodies import body as body_of
from pas.solid.functions import Pieces
from pas.solid.tree import atoms


@pytest.fixture(scope="module")
def corner() -> pas.Blend:
    return fair(UNEQUAL, 1)


@pytest.fixture(scope="module")
def body(corner: pas.Blend) -> solid.Solid:
    return corner.solid("1/2", ["x pipe", "y pipe", "z pipe"])


def test_contacts_become_proved_joints(body):
    assert body.faces[0] == "blend"
    assert set(body.faces[1:]) == {f"{n} pipe{end}" for n in "xyz" for end in ("", " end")}
    assert [v.claim for v in body.verdicts] == [f"blend meets {n} pipe with GC^1" for n in "xyz"]
    assert body.proved
    assert all("exactly GC^1" in v.reason for v in body.verdicts)


def test_a_claim_above_the_order_is_refuted(corner, body):
    contact = corner.surface.contacts[0]
    verdict = body.joined("blend", "x pipe", (contact.surface, contact.clip), 2).verdicts[-1]
    assert verdict.status is pas.Status.REFUTED
    assert "GC^1" in verdict.reason


def test_the_body_is_a_ball_with_flat_ends(body):
    mesh = body.mesh(4e-3)
    assert mesh.is_closed
    assert mesh.components == 1
    assert mesh.euler_characteristic == 2
    areas = mesh.face_areas
    for name, r in zip("xyz", (1 / 3, 1 / 4, 2 / 5), strict=True):
        assert areas[f"{name} pipe end"] == pytest.approx(pi * r * r, rel=2e-2)
        assert areas[f"{name} pipe"] == pytest.approx(pi * r, rel=2e-2)
    assert np.allclose(mesh.points.max(axis=0), 1.5, atol=1e-6)


def test_volume_is_the_blend_and_three_cylinders(corner, body):
    low, high = np.array([-1.5] * 3), np.array([1.0] * 3)
    random = np.random.default_rng(1).uniform(low, high, (200_000, 3))
    inside = corner.surface.contains(random)
    assert np.array_equal(body.contains(random), inside)
    middle = inside.mean() * 2.5**3
    pipes = sum(pi * r * r / 2 for r in (1 / 3, 1 / 4, 2 / 5))
    error = 2.5**3 * np.sqrt(inside.mean() / len(random))
    assert body.volume(4e-3) == pytest.approx(middle + pipes, abs=5 * error)


def test_vertices_lie_on_their_faces(corner, body):
    mesh = body.mesh(4e-3)
    on_blend = np.unique(mesh.triangles[mesh.faces == mesh.names.index("blend")])
    jets = corner.surface.jets(mesh.points[on_blend])
    inner = ~np.isnan(jets[:, 0])
    assert inner.mean() > 0.9
    distance = np.abs(jets[inner, 0]) / np.linalg.norm(jets[inner, 1:], axis=1)
    assert distance.max() < 1e-8


def test_bodies_compose_move_and_survive_files(body, tmp_path):
    hollow = body - solid.cylinder((0, 0, 0), (0, 0, 2), "1/5", face="bore")
    moved = hollow.rotate((1, 1, 0), 40).translate((10, 0, 3)).scale((2, 1, 1))
    assert hollow.proved
    assert [v.status for v in moved.verdicts] == [pas.Status.PROVED] * 3
    path = pas.save_solid(moved, tmp_path / "body.pas.json")
    again = pas.load(path)
    points = np.random.default_rng(0).uniform(moved.box[0], moved.box[1], (5000, 3))
    assert np.array_equal(again.contains(points), moved.contains(points))
    assert 0.01 < moved.contains(points).mean() < 0.9
    assert str(again) == str(moved)
    assert hollow.volume(1e-2) < body.volume(1e-2) - pi / 25


def test_length_zero_ends_at_the_clips(corner):
    body = corner.solid(0)
    assert not body.joints
    assert body.mesh(1e-2).points.max() == pytest.approx(1.0, abs=1e-9)
    assert body.mesh(1e-2).euler_characteristic == 2


@pytest.mark.parametrize(
    "arguments, words",
    [
        ((-1,), "length must not be negative"),
        ((1, ["a", "b"]), "3 different names"),
        ((1, ["a", "b", "blend"]), "none of them 'blend'"),
        ((1, "abc"), "3 different names"),
    ],
)
def test_bad_arguments(corner, arguments, words):
    with pytest.raises(ValueError, match=words):
        corner.solid(*arguments)


def test_a_blend_without_region_is_no_solid():
    region = pas.SingleCell()
    surface = pas.PiecewiseSurface.from_polynomials(region, (), 1, ["x^2 + y^2 + z^2 - 1"])
    with pytest.raises(pas.GeometryError, match="no region"):
        body_of(surface)


def test_curved_clips_have_no_flat_cap():
    contact = pas.Contact("x^2 + y^2 - 1", "z - x^2")
    region = pas.SingleCell((-2, -2, -2), (2, 2, 2))
    surface = pas.PiecewiseSurface.from_polynomials(region, (contact,), 1, ["x^2 + y^2 - 1"])
    with pytest.raises(pas.GeometryError, match=r"neighbour 1 ends in .* no plane"):
        body_of(surface)


def test_a_gap_along_a_joint_is_found():
    pipe, other = "x^2 + y^2 - 1", "x^2 + y^2 - 1 + z^2"
    whole = solid.patch("pipe", pipe, "z", "1 - z") | solid.patch("dome", other, "-z")
    assert whole.joined("pipe", "dome", (pipe, "z"), 1).proved
    part = solid.patch("pipe", pipe, "z", "1 - z") | solid.patch("dome", other, "-z", "x + 1/2")
    verdict = part.joined("pipe", "dome", (pipe, "z"), 1).verdicts[0]
    assert verdict.status is pas.Status.REFUTED
    assert "dome is missing" in verdict.reason
    assert verdict.witness[0] < -1 / 2


def test_the_command_line_makes_a_body(corner, tmp_path, capsys):
    project = corner.save(tmp_path / "corner.pas.json")
    out = tmp_path / "body.stl"
    assert main(["convert", str(project), str(out), "--length", "1/4", "--tolerance", "0.01"]) == 0
    assert str(out) in capsys.readouterr().out
    assert (len(out.read_bytes()) - 84) // 50 == len(corner.solid("1/4").mesh(0.01).triangles)
    assert main(["convert", str(project), str(out), "--length", "a yard"]) == 2
    assert "length" in capsys.readouterr().err
    ball = pas.save_solid(solid.ball((0, 0, 0), 1), tmp_path / "ball.pas.json")
    assert main(["convert", str(ball), str(tmp_path / "ball.stl"), "--length", "1"]) == 2
    assert "--length is for blends" in capsys.readouterr().err
    assert not (tmp_path / "ball.stl").exists()


def test_size_and_place_are_kept():
    """Axes of other lengths than 1, a corner twenty times as large: lengths are in the model's units."""
    pipes = [pas.Pipe(tuple(3 * c for c in a), 7, "20/3", (5, 6, 7)) for a in AXES]
    body = pas.blend(pipes, order=1, energy=pas.ThinPlate()).solid(10)
    assert np.allclose(body.mesh(0.5).points.max(axis=0), [35, 36, 37], atol=1e-6)
    pieces = next(a.function for a in atoms(body.tree) if isinstance(a.function, Pieces))
    points = np.random.default_rng(0).uniform(-2, 2, (50, 3)) + [15, 6, 7]
    jets, step = pieces.jets(points), 1e-4
    for axis in range(3):
        shift = step * np.eye(3)[axis]
        slope = (pieces.jets(points + shift)[:, 0] - pieces.jets(points - shift)[:, 0]) / (2 * step)
        assert np.allclose(jets[:, 1 + axis], slope, rtol=1e-4, atol=1e-6 * np.abs(jets[:, 1:]).max())
    cells = pieces.cells
    assert all(p(points).shape == (50,) and len(walls) == 4 for p, walls in cells)
    yes, no = pieces.decided(points, np.full((50, 3), 0.5))
    inside = pieces.jets(points)[:, 0] <= 0
    assert not (yes & ~inside).any()
    assert not (no & inside).any()
    far = pieces.decided(np.array([[5.0, 6.0, 7.0]]), np.full((1, 3), 1e-3))
    assert bool(far[0][0]) != bool(far[1][0])  # a small box well inside is decided
