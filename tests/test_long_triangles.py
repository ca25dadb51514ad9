"""Faces with straight lines keep long triangles: counts near the ideal ones, whatever the tolerance."""

from __future__ import annotations

from functools import reduce
from math import acos, ceil, pi

import numpy as np
import pytest

from pas import solid
from pas.designs.teapot import teapot
from pas.mesh.halfedges import HalfEdges
from pas.mesh.labelled import Labelled
from pas.mesh.quality import smallest_angles

HOLES = 15


def plate():
    holes = [
        solid.cylinder((1 + 2 * i, 1 + 2 * j, -1), (1 + 2 * i, 1 + 2 * j, 2), "3/5", face=f"hole {i} {j}")
        for i in range(5)
        for j in range(3)
    ]
    return reduce(lambda a, b: a - b, holes, solid.box((0, 0, 0), (10, 6, 1)))


def sides(radius, tolerance):
    """Of a regular polygon inside a circle that is as near to it."""
    return ceil(pi / acos(1 - tolerance / radius))


@pytest.mark.parametrize("tolerance", [1e-2, pytest.param(1e-3, marks=pytest.mark.slow)])
def test_a_drilled_plate_has_at_most_twice_the_triangles_that_it_needs(tolerance):
    mesh = plate().mesh(tolerance)
    n = sides(0.6, tolerance)
    ideal = HOLES * 2 * n + 2 * (HOLES * n + 2 * HOLES + 2) + 8  # walls, top and bottom, the box's sides
    assert len(mesh.triangles) <= 2 * ideal
    assert (mesh.is_closed, mesh.euler_characteristic) == (True, 2 - 2 * HOLES)
    assert mesh.deviation <= tolerance
    assert mesh.volume == pytest.approx(60 - HOLES * pi * 0.36, rel=tolerance)


@pytest.mark.parametrize(
    "shape, triangles",
    [
        (solid.cylinder((0, 0, 0), (0, 0, 1), 1), 4 * sides(1, 1e-3)),
        (solid.cone((0, 0, 0), (0, 0, 1), 1, "1/2"), 4 * sides(1, 1e-3)),
    ],
)
def test_cylinders_and_cones_have_longer_triangles(shape, triangles):
    mesh = shape.mesh(1e-3)
    assert len(mesh.triangles) <= 3 * triangles
    assert mesh.deviation <= 1e-3
    assert mesh.is_closed


def test_triangles_on_planes_are_not_slender():
    shape = solid.ball((0, 0, 0), 1) & solid.half_space("z", "cut")
    mesh, few = shape.mesh(2e-3), shape.mesh(2e-3, quality="count")
    cut = mesh.faces == mesh.names.index("cut")
    assert cut.sum() > 50
    assert mesh.smallest_angles[cut].min() > 5
    assert len(mesh.triangles) < 1.02 * len(few.triangles)


def test_quality_prefers_angles_or_few_triangles():
    shape = solid.cylinder((0, 0, 0), (0, 0, 3), "1/2")
    found = {q: shape.mesh(2e-3, quality=q) for q in ("angles", "balanced", "count")}
    numbers = [len(mesh.triangles) for mesh in found.values()]
    assert numbers[0] > 3 * numbers[1] and numbers[2] <= numbers[1]
    assert found["angles"].smallest_angles.min() > 10 > found["balanced"].smallest_angles.min() > 0.19
    assert all(mesh.is_closed and mesh.deviation <= 2e-3 for mesh in found.values())
    assert len(solid.assembly(a=shape).mesh(2e-3, quality="angles").triangles) == numbers[0]
    with pytest.raises(ValueError, match="quality must be one of 'angles', 'balanced', 'count', not 'good'"):
        shape.mesh(2e-3, quality="good")


def test_bars_that_cross_keep_few_triangles_and_the_points_where_their_curves_turn():
    """A bar that ends on the axis of an equal one: their curve turns by a right angle at two points."""
    across = solid.cylinder((0, -1, 0), (0, 1, 0), "1/5", "a")
    mesh = (across | solid.cylinder((0, 0, -1), (0, 0, 0), "1/5", "b")).mesh(2e-3)
    n = sides(0.2, 2e-3)
    assert len(mesh.triangles) <= 22 * n  # 9 n would do
    assert mesh.is_closed and mesh.deviation <= 2e-3
    for tip in ((0.2, 0, 0), (-0.2, 0, 0)):
        assert np.linalg.norm(mesh.points - tip, axis=1).min() < 1e-9
    common = 16 / 3 * 0.2**3 / 2
    assert mesh.volume == pytest.approx(3 * pi * 0.2**2 - common, rel=1e-2)


def test_which_faces_have_straight_lines_is_decided_exactly():
    shapes = {
        solid.box((0, 0, 0), (1, 1, 1)): True,
        solid.ball((0, 0, 0), 1): False,
        solid.implicit("x^2 + 2*y^2 - 1", "z", "1 - z"): True,
        solid.implicit("x^2 + y^2 - (z - 2)^2", "z", "1 - z"): True,
        solid.implicit("x^2 + y^2 - z^2 - 1", "z", "1 - z"): False,  # ruled, but normals turn along its lines
        solid.implicit("x^2 + y^2 + z^4 - 1"): False,
    }
    for shape, expected in shapes.items():
        assert (shape.field.ruled(np.array([0, 1])) > 0).tolist() == [expected] * 2


@pytest.mark.parametrize("sagging, flips", [((0, 2), True), ((1, 3), False)])
def test_along_straight_lines_the_diagonal_that_is_nearer_to_the_face_is_taken(sagging, flips):
    """Both diagonals of a square meet Delaunay's criterion; normals that turn along one say how far it is off."""
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    first = Labelled.of(points, np.array([[0, 1, 2], [0, 2, 3]]), np.zeros(2, dtype=np.intp))
    normals = np.tile([0.0, 0.0, 1.0], (4, 1))
    for end, sign in zip(sagging, (-1, 1), strict=True):
        normals[end, :2] = sign * 0.1 * (points[sagging[1]] - points[sagging[0]])[:2]
    for ruled in (True, False):
        mesh = HalfEdges(first, np.array([ruled], dtype=np.int8))
        mesh.normals[:] = normals
        mesh.flip(1e-3)
        assert (mesh.triangles != first.triangles).any() == (flips and ruled)


@pytest.mark.parametrize(
    "corners", [[(0, 0), (3, 0), (0, 4)], [(0, 0), (3, 0), (4, 2), (1, 4)], [(0, 0), (9, 1), (0, 2)]]
)
def test_prisms_with_sharp_edges_have_as_few_triangles_as_there_can_be(corners):
    """At a coarse lattice the nodes at sharp corners are found from far away, and draw in nothing."""
    body = solid.half_space("-z") & solid.half_space("z - 1/2")
    for (a, b), (c, d) in zip(corners, [*corners[1:], corners[0]], strict=True):
        body = body & solid.half_space(f"{d - b}*(x - {a}) - {c - a}*(y - {b})")
    mesh = body.mesh(0.01)
    assert mesh.is_closed and len(mesh.triangles) == 4 * len(corners) - 4
    area = sum(a * d - b * c for (a, b), (c, d) in zip(corners, [*corners[1:], corners[0]], strict=True)) / 2
    assert mesh.volume == pytest.approx(area / 2)


def crossing(radius):
    return solid.cylinder((-2, 0, 0), (2, 0, 0), 1, "a") | solid.cylinder((0, -2, 0), (0, 2, 0), radius, "b")


ANGLED = {
    "equal cylinders": (lambda: crossing(1), 4e-3),
    "unequal cylinders": (lambda: crossing("3/4"), 1e-2),
    "teapot": (lambda: teapot().solid, 4e-3),
    "the paper's teapot": (lambda: teapot("paper").solid, 4e-3),
    "the paper's teapot, finer": (lambda: teapot("paper").solid, 1e-3),
    "lid": (lambda: teapot().lid, 4e-3),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * ("cyl" not in n)) for n in ANGLED])
@pytest.mark.parametrize("quality", ["balanced", "angles"])
def test_small_angles_are_at_curves_and_along_straight_lines(name, quality):
    """Away from the curves where faces meet they are 15 degrees at least; along straight lines if these are wanted."""
    make, tolerance = ANGLED[name]
    shape = make()
    found = shape.face_mesh(tolerance, quality=quality)
    mesh, reached = found.mesh, found.deviation * shape.field.scale
    inside = (mesh.topology.label_count == 1)[mesh.triangles].all(axis=1)
    chosen = inside if quality == "angles" else inside & (shape.field.ruled(mesh.labels) == 0)
    angles = np.degrees(smallest_angles(mesh.points[mesh.triangles]))
    assert angles[chosen].min(initial=90.0) >= 15.0 - 1e-9
    assert reached <= tolerance
    if "cylinders" in name:
        along = angles < 15
        assert along.any() == (quality == "balanced") or along.mean() < 1e-3
