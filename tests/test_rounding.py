"""Rounded edges with their corners: proved joints, the ball that rolls, meshes, and what is refused."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import pas
from pas import solid
from pas.algebra.lengths import lengths
from pas.errors import GeometryError
from pas.solid.joints import prove


def box() -> solid.Solid:
    return solid.box((0, 0, 0), (3, 2, 1))


def wedge() -> solid.Solid:
    """3, 4 and 5 are the sides of a triangle, so that its normals have rational lengths."""
    return solid.polygon([(0, 0), (4, 0), (4, 3)]).extrude(1)


def tetrahedron() -> solid.Solid:
    planes = {"a": "-x", "b": "-y", "c": "-z", "d": "x+y+z-1"}
    return solid.intersection(*(solid.half_space(plane, face=name) for name, plane in planes.items()))


def drilled() -> solid.Solid:
    return box() - solid.cylinder((1, 1, -1), (1, 1, 2), "1/2", face="hole")


UPRIGHT = ["box x-", "box x+", "box y-", "box y+"]
CASES = {
    "box": (box, None, "1/4", 48),
    "upright edges": (box, UPRIGHT, "1/4", 8),
    "upright edges and top": (box, [*UPRIGHT, "box z+"], "3/10", 28),
    "wedge": (wedge, None, "1/4", 36),
    "tetrahedron": (tetrahedron, None, "1/8", 24),
    "drilled": (drilled, None, "1/4", 48),
}


@pytest.mark.sampled(12)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", CASES)
def test_all_joints_are_proved(name, order):
    make, faces, radius, joints = CASES[name]
    made = make().rounded(faces, radius=radius, order=order)
    assert len(made.joints) == joints and made.proved


@pytest.mark.sampled(2)
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("name", ["upright edges and top", "wedge", "tetrahedron"])
def test_meshes_are_of_the_solid(name, order):
    make, faces, radius, _ = CASES[name]
    made = make().rounded(faces, radius=radius, order=order)
    mesh = made.mesh(2e-3)
    assert mesh.is_closed and {*mesh.names} == {*made.faces} and mesh.deviation <= 2e-3
    field = made.field.evaluator
    off = field.field(field.local(mesh.points)) / np.linalg.norm(made.box[1] - made.box[0])
    assert np.abs(off).max() < 1e-9
    middle = mesh.points.mean(axis=0)
    assert made.contains(middle + 0.999 * (mesh.points - middle)).all()
    assert not made.contains(middle + 1.001 * (mesh.points - middle)).any()


def test_of_order_1_it_is_what_a_ball_reaches():
    """The volume of a body with all points up to r from a box, by Steiner's formula."""
    r = 0.25
    a, b, c = 3 - 2 * r, 2 - 2 * r, 1 - 2 * r
    expected = a * b * c + 2 * r * (a * b + b * c + c * a) + np.pi * r * r * (a + b + c) + 4 / 3 * np.pi * r**3
    made = box().rounded(radius=r)
    assert made.volume(1e-3) == pytest.approx(expected, rel=1e-5)
    ball = solid.ball((r, r, r), r).polynomials["ball"][0]
    assert made.polynomials["box x- / box y- / box z-"][0].primitive() == ball.primitive()


@pytest.mark.parametrize(("make", "corner", "radius"), [(wedge, (4, 3, 1), 0.25), (tetrahedron, (0, 0, 1), 0.125)])
def test_corners_at_any_angle_are_of_a_sphere(make, corner, radius):
    """All points of it are at the radius from one that is as far from all planes, to what their lengths are rounded."""
    plain = make()
    made = plain.rounded(radius=radius)
    planes = {n: f for n, (f,) in plain.polynomials.items() if abs(f(np.array(corner, dtype=float))) < 1e-12}
    normals = np.array([f.gradient(np.zeros(3)) for f in planes.values()])
    center = corner - np.linalg.solve(normals, radius * np.linalg.norm(normals, axis=1))
    mesh = made.mesh(2e-3)
    face = mesh.names.index(" / ".join(planes))
    points = mesh.points[np.unique(mesh.triangles[mesh.faces == face])]
    assert np.linalg.norm(points - center, axis=1) == pytest.approx(radius, rel=1e-5)


def test_of_order_2_it_is_flat_where_it_begins_and_bends_little():
    made = solid.box((0, 0, 0), (4, 4, 4)).rounded(["box x+", "box y+"], radius=1, order=2)
    (f,) = made.polynomials["box x+ / box y+"]
    mesh = made.mesh(1e-4)
    points = mesh.points[np.unique(mesh.triangles[mesh.faces == mesh.names.index("box x+ / box y+")])]
    slope, second = f.gradient(points), pas.Evaluator(f).hessians(points)
    bend = np.abs(second[:, 0, 0] * slope[:, 1] ** 2 + second[:, 1, 1] * slope[:, 0] ** 2) / lengths(slope) ** 3
    assert bend[points[:, 0] > 4 - 1e-9].max() < 1e-6 and 1.2 < bend.max() < 1.25


def test_it_stays_where_it_is_moved():
    made = box().rounded(radius="1/4").rotate((0, 0, 1), 90).scale(1000).translate(10**6, 0, 0)
    mesh = made.mesh(2)
    assert mesh.is_closed and mesh.volume == pytest.approx(5.69e9, rel=2e-3)
    assert prove(made.joints[0], made.tree, lambda: made.box).proved


LARGEST = [
    (box, 1, 0.5),
    (box, 2, 0.5),
    (wedge, 1, 0.5),
    (wedge, 2, 0.5),
    (tetrahedron, 1, 1 / (3 + 3**0.5)),  # the radius of the ball in it
    (tetrahedron, 2, 1 / (2 + 3**0.5)),  # that of the circle in the smallest face, whose sides move as their planes do
]


@pytest.mark.parametrize(("make", "order", "most"), LARGEST)
def test_the_largest_radius_is_exact(make, order, most):
    assert make().rounded(radius=0.999 * most, order=order).mesh(1e-2).is_closed
    with pytest.raises(GeometryError, match="where an edge is used up, not 1") as caught:
        make().rounded(radius=1, order=order)
    assert float(str(caught.value).split("below ")[1].split(",")[0]) == pytest.approx(most, rel=1e-5)


TOUCHING = {
    "along an edge": lambda: box() & solid.half_space("x + y - 5", face="along"),
    "in a corner": lambda: box() & solid.half_space("x + y + z - 6", face="in"),
    "equal": lambda: solid.half_space("2*x - 6", face="") & box(),
    "in three corners": lambda: box() & solid.box((0, 0, 0), (4, 3, 2), face="larger"),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", TOUCHING)
def test_planes_that_only_touch_are_left_out(name, order):
    made, expected = TOUCHING[name]().rounded(radius="1/4", order=order), box().rounded(radius="1/4", order=order)
    assert {*made.joints} == {*expected.joints}
    assert made.mesh(1e-2).is_closed and made.volume(1e-2) == pytest.approx(expected.volume(1e-2), rel=1e-12)


def leaning(wall: str) -> solid.Solid:
    """A prism with an upright wall, a top, and opposite the former one that leans."""
    planes = {"wall": "-x", "foot": "-y", "front": "-z", "back": "z-1", "top": "y-1", "leaning": wall}
    return solid.intersection(*(solid.half_space(plane, face=name) for name, plane in planes.items()))


@pytest.mark.parametrize("order", [1, 2])
def test_a_round_ends_at_the_sharp_edge_of_a_plane_that_it_touches(order):
    """The top is 1/2 wide, and less deep it is wider: there a larger ball would have room."""
    made = leaning("x+19*y-39/2").rounded(["wall", "top"], radius=0.499, order=order)
    assert made.proved and made.mesh(1e-2).is_closed
    with pytest.raises(GeometryError, match=r"radius must be below 0\.5, where an edge is used up"):
        leaning("x+19*y-39/2").rounded(["wall", "top"], radius="9/10", order=order)


@pytest.mark.parametrize("order", [1, 2])
def test_edges_away_from_a_round_are_no_limit_to_it(order):
    """The far side is only as high as 1/10, and stays so."""
    roof = {"wall": "-x", "foot": "-y", "front": "-z", "back": "z-1", "far": "x-1", "roof": "9*x+10*y-10"}
    plain = solid.intersection(*(solid.half_space(plane, face=name) for name, plane in roof.items()))
    made = plain.rounded(["wall", "roof"], radius="1/5", order=order)
    mesh = made.mesh(1e-3)
    assert made.proved and mesh.is_closed and mesh.points[mesh.points[:, 0] > 1 - 1e-9, 1].max() == pytest.approx(0.1)
    if order == 1:  # the kite between the edge, both lines of contact and the centre, less the sector of the ball
        turn = np.pi - np.arctan2(10, 9)
        assert 0.55 - made.volume(1e-4) == pytest.approx(0.04 * (np.tan(turn / 2) - turn / 2), rel=1e-3)


def pyramid() -> solid.Solid:
    sides = {f"{a}{s}": f"{s}{a}+z-1" for a in "xy" for s in "+-"}
    return solid.intersection(
        solid.half_space("-z", face="ground"), *(solid.half_space(plane, face=name) for name, plane in sides.items())
    )


def test_a_corner_of_four_is_left_alone():
    foot = pyramid().rounded(["ground", "x+", "x-"], radius="1/8")
    assert len(foot.joints) == 4 and foot.proved and foot.mesh(1e-2).is_closed


REFUSED = {
    "four planes": (lambda: pyramid().rounded(radius="1/8"), "ends in 2 planes near (0, 0, 1): only corners of three"),
    "no end": (
        lambda: (solid.half_space("x", face="a") & solid.half_space("y", face="b")).rounded(radius=1),
        "the edge of 'a' and 'b' does not end",
    ),
    "no face": (lambda: box().rounded(["box x", "box y+"], radius=1), "no plane face 'box x' that bounds all of it"),
    "curved": (lambda: drilled().rounded(["hole", "box z+"], radius=1), "no plane face 'hole' that bounds all of it"),
    "apart": (lambda: box().rounded(["box x-", "box x+"], radius=1), "no two of the faces are planes that meet"),
    "union": (lambda: (box() | box().translate(1, 1, 1)).rounded(radius=1), "no two of the faces are planes that"),
    "twice": (
        lambda: box().rounded(UPRIGHT, radius="1/4").rounded(radius="1/8"),
        "the edge 'box x+ / box y+' is rounded already",
    ),
    "text": (lambda: box().rounded("box x-", radius=1), "faces must be a sequence of names"),
    "radius": (lambda: box().rounded(radius=0), "radius must be positive, not 0"),
    "order": (lambda: box().rounded(radius=1, order=0), "order must be at least 1"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name):
    make, sentence = REFUSED[name]
    with pytest.raises((GeometryError, ValueError, TypeError)) as caught:
        make()
    assert sentence in str(caught.value) and "\n" not in str(caught.value)


def plate() -> solid.Solid:
    return solid.rounded_rectangle(8, 6, 1).extrude(2)


def spandrel(radius: float) -> tuple[float, float]:
    """The area of what a ball does not reach in a right angle, and how far its centre of mass is from the ball's."""
    area = (1 - np.pi / 4) * radius**2
    return area, radius**3 / 6 / area


PROFILES = {
    "plate": (plate, None, "1/2", 56, 4 * [2], []),
    "top only": (plate, ["top", *(f"side {i}" for i in range(1, 9))], "1/2", 32, 4 * [1], []),
    "with a hole": (
        lambda: (solid.rounded_rectangle(8, 6, 1) - solid.circle((4, 3), 1, "hole")).extrude(2),
        None,
        "1/2",
        60,
        4 * [2],
        [2],
    ),
    "moved, drilled": (
        lambda: (plate() - solid.cylinder((4, 3, -1), (4, 3, 3), 1)).rotate((1, 2, 3), 40).scale(2),
        None,
        1,
        56,
        4 * [2],
        [],
    ),
}


@pytest.mark.parametrize(
    "name", [n if n == "with a hole" else pytest.param(n, marks=pytest.mark.slow) for n in PROFILES]
)
def test_rounds_of_profiles_with_arcs_are_those_of_a_ball(name):
    """By Pappus: what is cut off turns about the arcs' centres, and about the hole's."""
    make, faces, radius, joints, corners, holes = PROFILES[name]
    before, made = make(), make().rounded(faces, radius=radius)
    assert len(made.joints) == joints and made.proved
    (area, far), ends = spandrel(0.5), corners[0]
    gone = ends * area * (2 * (6 + 4) + 2 * np.pi * (0.5 + far)) + sum(
        n * area * 2 * np.pi * (1.5 - far) for n in holes
    )
    scale = 8 if "moved" in name else 1
    assert before.volume(1e-2) - made.volume(1e-2) == pytest.approx(scale * gone, rel=2e-3)
    mesh = made.mesh()
    assert mesh.is_closed and {*mesh.names} == {*made.faces} - {"cylinder start", "cylinder end"}
    assert "side 2 / top" in made.faces


@pytest.mark.sampled(4)
@pytest.mark.parametrize("radius", ["3/10", "1/2", "4/5", "95/100"])
def test_tori_that_meet_themselves_cut_off_no_more_than_others(radius):
    """The set of inequalities, not the mesh, beside the volume by Pappus."""
    made, size = plate().rounded(radius=radius), float(Fraction(radius))
    assert made.proved and ("4 (torus)" in made.description) == (radius == "3/10")
    points = np.random.default_rng(0).random((50_000, 3)) * (8, 6, 2)
    area, far = spandrel(size)
    gone = 2 * area * (20 + 2 * np.pi * (1 - size + far)) + 2 * (4 - np.pi)
    assert (~made.contains(points)).mean() * 96 == pytest.approx(gone, abs=0.3)
    assert plate().volume(1e-2) - made.volume(1e-2) == pytest.approx(gone - 2 * (4 - np.pi), rel=2e-3)


@pytest.mark.slow
def test_rounds_of_the_radius_of_an_arc_have_a_part_of_a_ball():
    made = solid.rounded_rectangle(8, 6, 1).extrude(4).rounded(radius=1)
    area, far = spandrel(1)
    gone = 2 * area * (2 * (6 + 4) + 2 * np.pi * far)
    assert made.proved and len(made.joints) == 48 and "2 (sphere)" in made.description
    assert made.mesh().is_closed and made.volume() == pytest.approx(4 * (48 - 4 + np.pi) - gone, rel=1e-6)


@pytest.mark.slow
def test_rounds_of_profiles_of_order_2_have_the_section_of_fillets():
    made = plate().rounded(radius="1/2", order=2)
    single = solid.box((0, 0, 0), (8, 6, 2)).fillet("box z+", "box y-", "1/2", 2)
    assert made.proved and made.mesh().is_closed and {joint.order for joint in made.joints} == {1, 2}
    assert made.polynomials["side 1 / top"][0].primitive() == single.polynomials["fillet"][0].primitive()


@pytest.mark.slow
def test_rounded_profiles_go_on_as_solids():
    made = plate().rounded(radius="1/2") | solid.cylinder((4, 3, 1), (4, 3, 4), 2, face="boss")
    assert made.mesh().is_closed and made.fillet("top", "boss", "1/4").proved
    half = plate().rounded(radius="1/2") - solid.half_space("x - 4 - (y - 3)/3", "cut")
    assert 2 * half.volume(4e-3) == pytest.approx(plate().rounded(radius="1/2").volume(4e-3), rel=1e-3)


NOT_ROUNDED = {
    "radius must be at most 1, that of the edge 'side 2', not 5/4": lambda: plate().rounded(radius="5/4"),
    "radius must be below 1, that of the edge 'side 2', not 1": lambda: plate().rounded(radius=1, order=2),
    "radius must be below 1/4, where the sides are used up": lambda: (
        solid.rounded_rectangle(8, 6, 1).extrude("1/2").rounded(radius="1/4")
    ),
    "rounds of the profile's edges would meet on an end": lambda: (
        (solid.rounded_rectangle(8, 6, 1) - solid.circle((7, 3), "1/2", "hole")).extrude(2).rounded(radius="1/3")
    ),
    "meet with an angle at (0, 2)": lambda: (
        solid.sketch((0, 0)).line_to(2, 0).arc_to(2, 2, radius=1).line_to(0, 2).close().extrude(1).rounded(radius="1/4")
    ),
    "go on smoothly in one another; name both or none": lambda: plate().rounded(["top", "side 1"], radius="1/4"),
    "has no face 'topp'; is 'top' meant?": lambda: plate().rounded(["topp"], radius="1/4"),
    "no edge at the top or bottom": lambda: plate().rounded(["top"], radius="1/4"),
    "order is 1 or 2": lambda: plate().rounded(radius="1/4", order=3),
    "are rounded already": lambda: plate().rounded(radius="1/4").rounded(radius="1/8"),
    "is no arc of a circle of rational radius": lambda: solid.text("o", 4).extrude(1).rounded(radius="1/16"),
}


@pytest.mark.parametrize("sentence", NOT_ROUNDED)
def test_what_is_no_round_of_a_profile_is_told(sentence):
    with pytest.raises(GeometryError) as caught:
        NOT_ROUNDED[sentence]()
    assert sentence in str(caught.value) and "\n" not in str(caught.value)
