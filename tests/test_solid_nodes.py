"""Solids whose faces meet in more than threes, touch or lie flush: what they must come out as is known exactly."""

from __future__ import annotations

from functools import reduce
from itertools import combinations, pairwise, product
from math import cos, pi, sin, sqrt

import numpy as np
import pytest

import pas
from pas import solid
from pas.errors import MeshError
from pas.mesh.faces import BoundaryCrossings
from pas.mesh.nodes import Nodes, contracted, find_nodes
from pas.mesh.octree import Octree
from pas.mesh.topology import is_closed_manifold
from pas.solid.seams import Seams, multiples

AXES = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
RADIUS = 0.1
NOTHING = np.empty(0, dtype=int)


def bar(start, end, number=0, radius="1/10"):
    return solid.cylinder(start, end, radius, face=f"bar {number}")


def united(parts):
    return reduce(lambda a, b: a | b, parts)


def struts(ends):
    return united(bar((0, 0, 0), end, i) for i, end in enumerate(ends))


def frame():
    """The edges of a cube as bars: at each corner three begin."""
    corners = list(product((0, 1), repeat=3))
    edges = [(a, b) for a, b in combinations(corners, 2) if sum(map(lambda x, y: x != y, a, b)) == 1]
    return united(bar(a, b, i, "1/8") for i, (a, b) in enumerate(edges))


def lattice():
    """27 bars of length 2 through 27 nodes, three of them equal and perpendicular through each."""
    bars = []
    for axis, (i, j) in product(range(3), product(range(3), repeat=2)):
        start, end = [i, j], [i, j]
        start.insert(axis, 0)
        end.insert(axis, 2)
        bars.append(bar(start, end, len(bars)))
    return united(bars)


def cross(turned=(0, 2, 0)):
    back = tuple(-x for x in turned)
    return bar((-2, 0, 0), (2, 0, 0), 0, "1/2") | bar(back, turned, 1, "1/2")


CORNER = 3 * pi * RADIUS**2 - 4 * RADIUS**3 + (2 - sqrt(2)) * RADIUS**3
"""Three struts: less half of what each two have in common, with what all have."""

KNOWN = {
    "three struts": (lambda: struts(AXES), CORNER, 2),
    "equal cylinders crossing": (cross, 2 * pi - 2 / 3, 2),
    "equal cylinders at 45 degrees": (lambda: cross((2, 2, 0)), pi + pi * sqrt(2) - 2 / 3 * sqrt(2), 2),
    "flush boxes": (lambda: solid.box((0, 0, 0), (1, 1, 1), "a") | solid.box(("1/2", "1/2", 0), (2, 2, 1), "b"), 3, 2),
    "flush cylinders": (
        lambda: solid.cylinder((0, 0, 0), (0, 0, 1), 1, "a") | solid.cylinder((1, 0, 0), (1, 0, 1), 1, "b"),
        2 * pi - (2 * pi / 3 - sqrt(3) / 2),
        2,
    ),
    "coaxial bars": (lambda: bar((0, 0, 0), (1, 0, 0)) | bar((1, 0, 0), (2, 0, 0), 1), 2 * pi * RADIUS**2, 2),
    "a ball that touches one around it": (
        lambda: solid.ball((0, 0, 0), 1, "a") | solid.ball((0, 0, "1/2"), "1/2", "b"), 4 / 3 * pi, 2,
    ),
}  # fmt: skip


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", KNOWN)
def test_coincident_corners_and_touching_faces_are_meshed(name):
    make, volume, euler = KNOWN[name]
    shape = make()
    tolerance = 4e-3
    mesh = shape.mesh(tolerance)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, euler)
    assert mesh.deviation <= tolerance
    assert mesh.volume == pytest.approx(volume, rel=5e-2)
    assert shape.volume(tolerance) == pytest.approx(volume, rel=1e-3)
    values = shape.value(mesh.points)
    assert np.abs(values).max() < 1e-8  # every vertex lies on the boundary


def test_frames_of_bars_have_the_holes_that_they_should():
    mesh = frame().mesh(1e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2 * (8 - 12))


@pytest.mark.slow
def test_a_lattice_of_27_bars():
    mesh = lattice().mesh()
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2 * (27 - 54))


def test_where_curves_between_faces_cross_there_is_a_corner():
    mesh = cross().mesh(1e-2)
    for node in ((0, 0, 0.5), (0, 0, -0.5)):
        distance = np.linalg.norm(mesh.points - node, axis=1)
        nearest = int(distance.argmin())
        assert distance[nearest] < 1e-9
        assert (mesh.feature_edges == nearest).sum() == 4
    mesh = struts(AXES).mesh(2e-3)
    for node in -RADIUS * np.eye(3):  # two cylinders touch, and two flat ends begin
        distance = np.linalg.norm(mesh.points - node, axis=1)
        assert distance.min() < 1e-9
        assert len(np.unique(mesh.faces[(mesh.triangles == distance.argmin()).any(axis=1)])) == 4


@pytest.mark.parametrize(
    "second, place",
    [
        (solid.box((1, 1, 1), (2, 2, 2), "b"), r"near \(1, 1, 1\)"),
        (solid.box((1, 1, 0), (2, 2, 1), "b"), r"near \(1, 1, "),
    ],
)
def test_solids_that_touch_themselves_are_refused_with_the_place(second, place):
    with pytest.raises(MeshError, match=place + ".*touches itself"):
        (solid.box((0, 0, 0), (1, 1, 1), "a") | second).mesh()


def test_what_is_drawn_into_a_node_is_a_disc_of_its_faces():
    shape = solid.box((0, 0, 0), (1, 1, 1))
    field, mesh = shape.field, shape.face_mesh(1e-2).mesh
    corner = field.evaluator.local(np.array([[1.0, 1.0, 1.0]]))[0]
    crossings = BoundaryCrossings(field, *Octree(field, 0.2).tetrahedra())
    points, triangles, source = crossings._merged()
    place = np.linalg.norm(points[triangles].mean(axis=1) - corner, axis=1).argmin()
    nodes = find_nodes(field, points, triangles, crossings.crossed[1][source], np.array([place]), NOTHING)
    assert np.linalg.norm(nodes.points - corner, axis=1).min() < 1e-9
    everything = type(nodes)(corner[None], np.array([10.0]))
    refused = contracted(field, mesh.points, mesh.triangles, mesh.labels, everything)
    assert isinstance(refused, Nodes)  # all of the box is no disc
    assert np.array_equal(refused.points, corner[None])
    small = type(nodes)(corner[None], np.array([1e-3]))
    points, triangles, _, drawn = contracted(field, mesh.points, mesh.triangles, mesh.labels, small)
    assert np.array_equal(points[drawn], corner[None])
    assert is_closed_manifold(triangles)
    assert len(points) == len(mesh.points)


def test_walls_through_corners_of_a_gear_do_no_harm():
    """Where two teeth meet on the axis a wall between wedges passes as well: four functions vanish at the corner."""
    count, height = 20, "2/5"
    turns = [2 * pi * (k + side / 2) / count for k in range(count) for side in (0, 1)]
    rim = [(round(r * cos(t), 4), round(r * sin(t), 4)) for t, r in zip(turns, (1.0, 1.25) * count, strict=True)]
    wedges = []
    for k in range(count):
        corners = [(0, 0), *(rim[(2 * k + i) % len(rim)] for i in range(3)), (0, 0)]
        sides = [f"{p - r!r}*(y - ({q!r})) + {s - q!r}*(x - ({p!r}))" for (p, q), (r, s) in pairwise(corners)]
        flanks = [solid.half_space(side, f"side {2 * k + i}") for i, side in enumerate(sides[1:3])]
        wedges.append(solid.intersection([*flanks, solid.patch("", sides[0]), solid.patch("", sides[3])]))
    mesh = (solid.union(wedges) & solid.half_space("-z") & solid.half_space(f"z - {height}")).mesh(1e-3)
    assert mesh.is_closed and len(mesh.triangles) <= 160  # 156 would do
    # what is folded in few triangles is mended: no finer lattice is needed; 9 is what 20 teeth allow
    assert mesh.smallest_angles.min() > 8.9


Z = (0, 0, 1)

STACKED = {
    "cones base on base": (
        lambda: solid.cone((0, 0, 0), (0, 0, 1), 1, 0, "a") | solid.cone((0, 0, 0), (0, 0, -1), 1, 0, "b"),
        2 * pi / 3,
        {"a", "b"},
    ),
    "frusta": (
        lambda: solid.cone((0, 0, 0), (0, 0, 1), 1, "1/2", "a") | solid.cone((0, 0, 0), (0, 0, -2), 1, "1/2", "b"),
        7 * pi / 4,
        {"a", "b", "a end", "b end"},
    ),
    "a cone on a cylinder": (
        lambda: solid.cylinder((0, 0, 0), (0, 0, 1), 1, "a") | solid.cone((0, 0, 1), (0, 0, 2), 1, 0, "b"),
        4 * pi / 3,
        {"a", "b", "a start"},
    ),
    "a narrower cylinder on one": (
        lambda: solid.cylinder((0, 0, 0), (0, 0, 1), 1, "a") | solid.cylinder((0, 0, 1), (0, 0, 2), "1/2", "b"),
        5 * pi / 4,
        {"a", "b", "a start", "a end", "b end"},
    ),
    "one on another, turned by seven degrees": (
        lambda: (
            solid.cylinder((0, 0, 0), (0, 0, 1), 1, "a") | solid.cylinder((0, 0, 1), (0, 0, 2), 1, "b").rotate(Z, 7)
        ),
        2 * pi,
        {"a + b", "a start", "b end"},
    ),
}


@pytest.mark.parametrize("name", STACKED)
def test_parts_that_stand_on_one_another(name):
    make, volume, faces = STACKED[name]
    mesh = make().mesh(1e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2)
    assert mesh.volume == pytest.approx(volume, rel=2e-2)
    assert set(mesh.names) == faces
    assert mesh.deviation <= 1e-2


def test_functions_on_a_plane():
    plane, first, second = (pas.Polynomial(f) for f in ("2*z - 2", "x^2 + y^2 - 4*z^2", "3*x^2 + 3*y^2 - 12"))
    assert multiples(plane, first, second)
    assert not multiples(plane, first, -second)
    assert not multiples(plane, first, second + 1)
    assert not multiples(plane, plane * first, second)


def test_a_plane_on_which_a_part_ends_stays_a_face():
    """Two halves of one curve on a plane, one inside it and one outside: the plane is a boundary everywhere."""
    base, column = solid.cylinder((0, 0, -1), (0, 0, 0), 1, "a"), solid.cylinder((0, 0, 0), (0, 0, 1), 1, "b")
    shape = base | (solid.box((-2, -2, 0), (2, 2, 1)) - column)
    assert not Seams(shape.field.evaluator, (), shape.field.box).hidden(*_undecided(shape)).any()
    cones = STACKED["cones base on base"][0]()
    assert Seams(cones.field.evaluator, (), cones.field.box).hidden(*_undecided(cones)).sum() == 1


def _undecided(shape):
    """What is known in a small cube about (1, 0, 0), and which columns matter there."""
    program = shape.field.evaluator
    yes, no = program.taylor(program.local(np.array([[1.0, 0.0, 0.0]])), np.full((1, 3), 1e-3))
    return yes, no, *program.relevant(yes, no)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("height", ["59/100", "65/100"])
def test_a_corner_where_the_sum_of_the_normals_points_into_no_side(height):
    """A plane cuts the rim of a cylinder, close to the bisector of its end and its side; the wedge is sharp."""
    rod = solid.cylinder((0, 0, "-1/2"), (0, 0, "6/5"), "3/5").rotate((3, 2, 2), 63)
    cut = solid.half_space(f"{height} - y", "cut")
    parts = [(rod & cut).mesh(2e-3), (rod - cut).mesh(2e-3)]
    assert all(part.is_closed for part in parts)
    assert sum(part.volume for part in parts) == pytest.approx(rod.mesh(2e-3).volume, rel=1e-3)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("height", ["0", "1/100", "-2/5"])
def test_a_hole_along_one_of_two_equal_pipes_ends_in_the_other(height):
    """It comes close to where the pipes touch, and is no part of what is drawn into that point."""
    run, branch = solid.cylinder((-3, 0, 0), (3, 0, 0), 1, "run"), solid.cylinder((0, 0, 0), (0, 0, 3), 1, "branch")
    hole = solid.cylinder((-4, "3/10", height), (4, "3/10", height), "3/10", "hole")
    made, filled = ((run - hole) | branch).mesh(4e-3), ((hole & run) - branch).mesh(4e-3)
    assert made.is_closed and made.volume + filled.volume == pytest.approx((run | branch).mesh(4e-3).volume, rel=1e-3)
