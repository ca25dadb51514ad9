"""Surfaces of single polynomials in boxes: what they are, their meshes, bad input."""

from __future__ import annotations

import numpy as np
import pytest

import pas

TORUS = "(x^2 + y^2 + z^2 + 8/9)^2 - 4*(x^2 + y^2)"
BOX = ((-2, -2, -2), (2, 2, 2))


def test_a_polynomial_in_a_box_is_a_surface_like_any_other(tmp_path):
    surface = pas.Polynomial(TORUS).surface(*BOX)
    assert surface.polynomials == (pas.Polynomial(TORUS),)
    assert surface.evaluator.values([[4 / 3, 0, 0]]) == pytest.approx(0, abs=1e-12)
    again = pas.load(surface.save(tmp_path / "torus.pas.json"))
    assert again.polynomials == surface.polynomials
    assert again.partition.box == surface.partition.box
    assert surface.draw(tmp_path / "torus.png", size=(80, 60)).exists()


@pytest.mark.parametrize(
    ("text", "lower", "upper", "words"),
    [
        ("0", *BOX, "constant: it vanishes everywhere"),
        ("3", *BOX, "constant: it vanishes nowhere"),
        ("x", (0, 0, 0), (1, 0, 1), "from 0 to 1, 0 to 0, 0 to 1"),
        ("x", (0, 0, 2), (1, 1, 1), "below the upper one"),
        ("x", (0, 0, 0), (1, 1, float("nan")), r"upper\[2\] must be finite"),
        ("x", (0, 0, float("-inf")), (1, 1, 1), r"lower\[2\] must be finite"),
        ("x", (0, 0), (1, 1, 1), "lower must be three numbers"),
    ],
)
def test_what_is_no_surface_or_no_box(text, lower, upper, words):
    with pytest.raises(ValueError, match=words):
        pas.Polynomial(text).surface(lower, upper)


def test_a_constant_in_a_cell_has_no_mesh():
    surface = pas.PiecewiseSurface.from_polynomials(pas.SingleCell(*BOX), [], 0, ["0"])
    with pytest.raises(pas.MeshError, match="constant in each piece"):
        surface.mesh()


def distance(surface, points):
    """Of points from the zeros, to first order."""
    jets = surface.evaluator.jets(points)
    return np.abs(jets[..., 0]) / np.linalg.norm(jets[..., 1:], axis=-1)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
@pytest.mark.parametrize(
    ("text", "size", "euler", "angle"),
    [
        (TORUS, 2, 0, 28),
        ("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 59/5", 3, -8, 22),
        ("x^2 + 2*y^2 - z^2 - 1/4 + x/7", 1, 0, 25),
        ("x*y - z/3", 1, 1, 20),
        ("x + y + z - 1/3", 1, 1, 15),
    ],
)
def test_meshes_in_boxes(text, size, euler, angle, tolerance):
    surface = pas.Polynomial(text).surface((-size,) * 3, (size,) * 3)
    mesh = surface.mesh(tolerance * 2 * size)
    assert mesh.is_manifold
    assert mesh.euler_characteristic == euler
    assert mesh.components == 1
    assert distance(surface, mesh.points).max() < 1e-12 * size
    assert mesh.deviation <= tolerance * 2 * size
    assert distance(surface, mesh.points[mesh.triangles].mean(axis=1)).max() <= tolerance * 2 * size
    assert mesh.smallest_angles.min() > angle
    assert (np.abs(mesh.points) <= size).all()
    assert (np.abs(mesh.points[mesh.boundary]).max(axis=1) == size).all()


def test_a_mesh_ends_on_the_edges_of_its_box():
    mesh = pas.Polynomial("z - x/2 - y/3").surface((-1, -1, -1), (1, 1, 1)).mesh(1e-2)
    corners = mesh.points[(np.abs(mesh.points) == 1).sum(axis=1) >= 2]
    assert sorted(map(tuple, corners[:, :2].tolist())) == [(-1, -1), (-1, 1), (1, -1), (1, 1)]
    assert corners[:, 2] == pytest.approx(corners[:, 0] / 2 + corners[:, 1] / 3, abs=1e-15)


def test_meshes_are_the_same_each_time_and_move_with_the_surface():
    f = pas.Polynomial("x^2 + y^2 - z - 1/2")
    mesh, again = (f.surface((-1,) * 3, (1,) * 3).mesh(1e-2) for _ in range(2))
    assert np.array_equal(mesh.points, again.points)
    assert np.array_equal(mesh.triangles, again.triangles)
    x, y, z = (pas.Polynomial(v) for v in "xyz")
    large = f.compose((x - 40) / 8, (y + 24) / 8, (z - 8) / 8).surface((32, -32, 0), (48, -16, 16)).mesh(8e-2)
    assert np.array_equal(large.triangles, mesh.triangles)
    assert large.points == pytest.approx(8 * mesh.points + [40, -24, 8], abs=1e-10)


def test_a_box_without_zeros_is_said():
    with pytest.raises(pas.MeshError, match="there is no surface in the region"):
        pas.Polynomial("x^2 + y^2 + z^2 + 1/100").surface((-1,) * 3, (1,) * 3).mesh()


def ring(radius):
    """A torus of a radius."""
    return pas.Polynomial(f"(x^2 + y^2 + z^2 + 1 - {radius}^2)^2 - 4*(x^2 + y^2)").surface(*BOX)


def test_a_mesh_follows_a_surface_that_moves():
    mesh, tolerance = ring("0.333").mesh(1e-2), 1e-2
    near = mesh.follow(ring("0.334"))
    assert np.array_equal(near.triangles, mesh.triangles)
    far = near.follow(ring("0.4"))
    assert len(mesh.triangles) < len(far.triangles) < 1.3 * len(mesh.triangles)
    for moved, radius in ((near, "0.334"), (far, "0.4")):
        assert distance(ring(radius), moved.points).max() < 1e-12
        assert distance(ring(radius), moved.points[moved.triangles].mean(axis=1)).max() <= tolerance
        assert moved.deviation <= tolerance
        assert moved.certificate.holds


def test_a_mesh_that_cannot_follow_is_made_anew():
    mesh = ring("0.333").mesh(1e-2)
    other = pas.Polynomial("x^2 + y^2 + z^2 - 1").surface(*BOX)
    ball = mesh.follow(other)
    assert ball.euler_characteristic == 2
    assert ball.certificate.holds


def test_a_mesh_follows_through_the_walls():
    mesh = pas.Polynomial("x^2 + 2*y^2 - z^2 - 1/4").surface((-1,) * 3, (1,) * 3).mesh(1e-2)
    moved = mesh.follow(pas.Polynomial("x^2 + 2*y^2 - z^2 - 1/4 + x/50").surface((-1,) * 3, (1,) * 3))
    assert moved.certificate.holds
    assert (np.abs(moved.points[moved.boundary]).max(axis=1) == 1).all()
    with pytest.raises(ValueError, match="tolerance must be a positive number"):
        mesh.follow(moved.surface, 0)
