"""Surfaces of single polynomials in boxes: what they are, their meshes, bad input."""

from __future__ import annotations

import numpy as np
import pytest

import pas
from pas.mesh.topology import Edges

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


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("text", "tolerance", "euler"),
    [
        ("x^2 + y^2 - z^2 - 1/50", 3e-3, 0),
        ("x^2 + y^2 - z^2 - 1/50", 1e-2, 0),
        ("x^2 + (y - 1/3)^2 - z^2 - 1/50", 1e-2, 0),
        ("x^2 + (y - 1/4)^2 - z^2 - 1/500", 3e-3, 0),
        ("x^2 + y^2 + z^2 - 4 - 1/100", 3e-3, -4),
    ],
)
def test_curves_that_just_leave_a_wall_or_the_box(text, tolerance, euler):
    """Arcs between two points of one edge are in the wall in which they are in the box, and small holes are not
    closed by what is outside."""
    mesh = pas.Polynomial(text).surface(*BOX).mesh(tolerance)
    assert (np.abs(mesh.points) <= 2).all()
    assert mesh.certificate.holds, mesh.certificate
    assert mesh.euler_characteristic == euler


@pytest.mark.parametrize(
    ("text", "tolerance", "least"),
    [
        ("x^2 + y^2 + z^2 - 8 + 1/10", 3e-3, 7),
        ("x^2 + y^2 + z^2 - 8 + 1/10", 1e-3, 10),  # bridges between the holes in two walls, 0.035 wide
        ("x^2 + y^2 + z^2 - 8 + 1/10", 3e-4, 6),
        ("x^2 + y^2 + z^2 - 8 + 1/100", 1e-3, 0.5),  # 0.0035 wide
        ("x^2 + y^2 + z^2 - 8 + 1/100", 3e-4, 0.2),
    ],
)
def test_curves_that_are_close_to_one_another(text, tolerance, least):
    """Triangles that are cut into parts fold between them; of those that are not, none does."""
    mesh = pas.Polynomial(text).surface(*BOX).mesh(tolerance)
    assert mesh.certificate.holds, mesh.certificate
    assert mesh.euler_characteristic == -4
    assert mesh.smallest_angles.min() > least


def test_a_fine_tolerance_of_a_quadric():
    mesh = pas.Polynomial("x^2 + 2*y^2 - z^2 - 1/4 + x/7").surface((-1,) * 3, (1,) * 3).mesh(5e-5)
    assert mesh.deviation <= 5e-5
    assert mesh.is_manifold
    assert mesh.smallest_angles.min() > 20


@pytest.mark.parametrize("share", ["1/1000", "1/50"])
def test_triangles_about_small_holes_are_small(share):
    mesh = pas.Polynomial(f"x^2 + y^2 + z^2 - 4 - {share}").surface(*BOX).mesh(2e-3)
    assert mesh.euler_characteristic == -4
    assert mesh.smallest_angles.min() > 15
    assert np.percentile(mesh.smallest_angles, 1) > 26


def test_what_a_coarse_mesh_does_not_show_is_named():
    """Six holes of radius 0.03: more than the sphere has other places of rest."""
    mesh = pas.Polynomial("x^2 + y^2 + z^2 - 4 - 1/1000").surface(*BOX).mesh(3e-3)
    assert mesh.euler_characteristic == 2
    assert not mesh.certificate.proved
    assert len(mesh.certificate.places) == 6
    assert np.abs(np.sort(np.abs(mesh.certificate.places), axis=1) - [0, 0, 2]).max() < 0.05


def test_a_wall_that_is_grazed_is_named():
    with pytest.raises(
        pas.MeshError, match=r"near \(-?2, -?2, .*walls of the region that the surface does not graze there"
    ):
        pas.Polynomial("x*y - 4 + z/50").surface(*BOX).mesh(1e-2)


def test_an_arc_between_two_points_of_an_edge_is_in_one_of_its_walls():
    """Of a part of a ball at an edge of the box: both arcs are in the box, and the direction tells which is meant."""
    surface = pas.Polynomial("(x - 6/5)^2 + (y - 6/5)^2 + z^2 - 1/4").surface((-1,) * 3, (1,) * 3)
    mesh, field = surface.mesh(1e-3), surface.mesher.cell_field
    rim = mesh.points[Edges(mesh.triangles, len(mesh.points)).rim]
    ends = np.array([1, 1, -np.sqrt(0.17)]), np.array([1, 1, np.sqrt(0.17)])
    for axis in (0, 1):
        along = rim[(rim[..., axis] == 1).all(axis=1)]  # the edges of the arc in one wall, all in one direction
        up = along[:, 1, 2] > along[:, 0, 2]
        assert up.all() or not up.any()
        wall = int(field.nearest_walls(along.mean(axis=1)[:1] / field.scale)[0])
        off = [np.abs(p[:, :3] @ ends[0] / field.scale - p[:, 3]).max() for p in field.rims[field.walls :]]
        edge = int(np.argmin(off))
        assert wall in field.edges[edge]
        pair = np.array([ends if up.all() else ends[::-1]]) / field.scale
        assert field.between(pair, np.full((1, 2), field.walls + edge)).tolist() == [wall]


@pytest.mark.parametrize(
    "region", [pas.SingleCell((-1, 0, -1), (1, 1, "3/2")), pas.SingleCell((-1, -1, -1), (1, 1, 1))]
)
def test_points_of_convex_regions_are_placed_as_those_of_all(region):
    surface = pas.PiecewiseSurface.from_polynomials(region, (), 0, ["x + y/2 + z/3 - 1/3"])
    stage, field = surface.framed, surface.mesher.cell_field
    assert stage.convex
    points = np.random.default_rng(3).uniform(
        stage.corners.min((0, 1)) - 0.1, stage.corners.max((0, 1)) + 0.1, (400, 3)
    )
    points = np.concatenate([points, stage.corners.reshape(-1, 3), stage.corners[:, :3].mean(axis=1)])
    points[100:200, 0] = stage.corners[..., 0].max()
    inside, on = stage.placed(points)
    within = [field.within(point[None]) for point in points]
    vars(stage)["convex"] = vars(field)["_convex"] = False
    other, others = stage.placed(points)
    kept = [rows[inside[rows]] for rows in on]  # outside the region it is not asked
    assert inside.any()
    assert not inside.all()
    assert np.array_equal(inside, other)
    assert all(np.array_equal(a, b) for a, b in zip(kept, others, strict=True))
    assert within == [field.within(point[None]) for point in points] == inside.tolist()
