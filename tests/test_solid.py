"""Solids: exact membership, meshes of known volume and area, set operations, joints, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import reduce
from math import pi, sqrt
from operator import and_

import numpy as np
import pytest

import pas
from pas import solid
from pas.errors import MeshError
from pas.mesh import closed
from pas.mesh.faces import _roots
from pas.mesh.labelled import Labelled
from pas.mesh.quality import Quality
from pas.mesh.topology import twins_of
from pas.solid import measures

CYLINDER = solid.cylinder((-2, 0, 0), (2, 0, 0), 1)
STEINMETZ = CYLINDER & CYLINDER.rotate((0, 0, 1), 90)
LENS = solid.ball((0, 0, 0), 1) & solid.ball((1, 0, 0), 1)

KNOWN = {
    "ball": (solid.ball((1, 2, 3), 1), 4 * pi / 3, 4 * pi, 2),
    "cone": (solid.cone((0, 0, 0), (0, 0, 1), 1), pi / 3, pi * (1 + sqrt(2)), 2),
    "oblique cylinder": (solid.cylinder((0, 0, 0), (1, 2, 3), 1), pi * sqrt(14), 2 * pi * (1 + sqrt(14)), 2),
    "torus": (solid.torus((0, 0, 0), (1, 1, 1), 2, "1/2"), pi**2, 4 * pi**2, 0),
    "box": (solid.box((0, 0, 0), (1, 2, 3)), 6, 22, 2),
    "two boxes": (solid.box((0, 0, 0), (1, 1, 1)) | solid.box((1, 0, 0), (2, 1, "1/2")), 1.5, 9, 2),
    "steinmetz": (STEINMETZ, 16 / 3, 16, 2),
    "lens": (LENS, 5 * pi / 12, 2 * pi, 2),
    "drilled ball": (
        solid.ball((0, 0, 0), 1) - solid.cylinder((0, 0, -2), (0, 0, 2), "3/5"), 4 / 3 * pi * 0.8**3,
        4 * pi * 0.8 + 2 * pi * 0.6 * 1.6, 0,
    ),
}  # fmt: skip


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", KNOWN)
def test_volume_area_and_topology(name):
    shape, volume, area, euler = KNOWN[name]
    mesh = shape.mesh()
    assert mesh.is_closed
    assert mesh.components == 1
    assert mesh.euler_characteristic == euler
    assert shape.volume() == pytest.approx(volume, rel=1e-5)
    assert shape.area() == pytest.approx(area, rel=1e-5)
    assert mesh.volume == pytest.approx(volume, rel=6e-3)  # of vertices on the surface, as few as the tolerance allows
    has_lines = shape.field.ruled(np.arange(2 * len(shape.field.evaluator.columns))).any()
    assert mesh.smallest_angles.min() > (0.5 if has_lines else 15)  # triangles are long along straight lines


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", ["ball", "torus", "steinmetz", "lens"])
def test_volume_and_area_converge_at_second_order(name):
    shape, volume, area, _ = KNOWN[name]
    tolerances = np.array([4e-3, 2e-4]) * np.ptp(shape.box, axis=0).max()
    # the error of the flat mesh is of first order in what tolerance was really reached
    reached = [abs(shape.mesh(t).volume / volume - 1) for t in tolerances]
    assert reached[1] < reached[0] * 0.8
    for exact, measure in ((volume, shape.volume), (area, shape.area)):
        errors = [max(abs(measure(t) / exact - 1), 1e-10) for t in tolerances]
        slope = np.log(errors[0] / errors[1]) / np.log(reached[0] / reached[1])
        assert slope > 1.4 or errors[0] < 1e-8, (errors, reached)
        assert errors[1] < 2e-6


def test_volumes_of_cones_converge_faster_than_their_meshes():
    frustum, exact = solid.cone((0, 0, 0), (0, 0, 1), 1, "1/2"), pi * 7 / 12
    errors = [abs(frustum.volume(t) / exact - 1) for t in (1e-2, 2e-4)]
    assert errors[1] < errors[0] / 400 and errors[1] < 2e-7


def test_faces_that_are_planes_are_measured_as_they_are_meshed(monkeypatch):
    """A mesh of planes is as good as rounding, and by that its edges would be cut for as long as there is room."""
    x, y, z = (pas.Polynomial(name) for name in "xyz")
    parts = {"left": -x, "front": -y, "slope": 4 * x + 3 * y - 12, "bottom": -z, "top": z - "1/2"}
    wedge = reduce(and_, (solid.half_space(part, name) for name, part in parts.items()))
    made = []
    monkeypatch.setattr(measures, "_cut", lambda *of, cut=measures._cut: made.append((of, cut(*of))) or made[-1][1])
    assert wedge.volume() == pytest.approx(3, rel=1e-13)
    assert wedge.area() == pytest.approx(18, rel=1e-13)
    assert made and all(mesh is found.mesh for (found, _), mesh in made)


def test_vertices_lie_on_their_faces_and_edges_on_curves():
    mesh = STEINMETZ.mesh(1e-2)
    assert len(STEINMETZ.mesh(1e-2).names) == 1  # both cylinders have one name
    named = solid.cylinder((-2, 0, 0), (2, 0, 0), 1, "a") & solid.cylinder((0, -2, 0), (0, 2, 0), 1, "b")
    mesh = named.mesh(1e-2)
    x, y, _ = mesh.points[np.unique(mesh.feature_edges)].T
    assert np.abs(np.abs(x) - np.abs(y)).max() < 1e-10
    for name, (i, j) in {"a": (1, 2), "b": (0, 2)}.items():
        vertices = mesh.points[np.unique(mesh.triangles[mesh.faces == mesh.names.index(name)])]
        assert np.abs(np.hypot(vertices[:, i], vertices[:, j]) - 1).max() < 1e-10


def test_contains_and_value():
    shape = solid.ball((0, 0, 0), 1) - solid.box((0, 0, 0), (2, 2, 2))
    points = np.array([[0, 0, -0.5], [0.5, 0.5, 0.5], [1, 0, 0], [5, 5, 5], [-1, 0, 0]])
    assert shape.contains(points).tolist() == [True, False, False, False, True]  # (1, 0, 0) was cut away
    values = shape.value(points)
    assert values[0] < 0 < values[1]
    assert values[4] == 0
    assert shape.contains(points.reshape(5, 1, 3)).shape == (5, 1)
    halves = solid.patch("top", "x^2+y^2+z^2-1", "z") | solid.patch("bottom", "x^2+y^2+z^2-1", "-z")
    assert (halves.value([[0, 0, 0], [0.5, 0, 0]]) < 0).all()  # no zero on the wall between them


@pytest.mark.parametrize("offset, factor", [((1e6, -3e6, 7), 1), ((0, 0, 0), "1/100000"), ((1, 2, 3), 1000)])
def test_place_and_scale_do_not_matter(offset, factor):
    shape = (CYLINDER | CYLINDER.rotate((0, 0, 1), 90)).scale(factor).translate(offset)
    scale = float(pas.Polynomial(factor).at((0, 0, 0)))
    assert shape.volume() == pytest.approx((8 * pi - 16 / 3) * scale**3, rel=1e-5)
    assert shape.mesh().euler_characteristic == 2


def test_transformations_are_exact():
    ball = solid.ball((1, 0, 0), 1)
    turned = ball.rotate((0, 0, 1), 90)
    assert turned.polynomials["ball"][0] == pas.Polynomial("x^2 + (y - 1)^2 + z^2 - 1")
    third = ball.rotate((1, 1, 1), 120)
    assert third.polynomials["ball"][0] == turned.polynomials["ball"][0]
    assert ball.mirror((1, 0, 0)).polynomials["ball"][0] == pas.Polynomial("(x + 1)^2 + y^2 + z^2 - 1")
    assert ball.scale((2, 1, 1)).volume() == pytest.approx(8 * pi / 3, rel=1e-5)
    seven = ball.rotate((0, 0, 1), 7)
    assert seven.contains([[np.cos(np.radians(7)), np.sin(np.radians(7)), 0.999999]])[0]


def test_a_mesh_is_cut_where_patches_meet():
    ball = "x^2 + y^2 + z^2 - 1"
    shape = solid.patch("upper", ball, "z - 1/3") | solid.patch("lower", "x^2 + y^2 + z^2 - 1 + (z - 1/3)^2", "1/3 - z")
    shape = shape.joined("upper", "lower", (ball, "z - 1/3"), 1)
    assert shape.proved
    mesh = shape.mesh(1e-2)
    assert set(mesh.names) == {"upper", "lower"}
    assert np.abs(mesh.points[np.unique(mesh.feature_edges)][:, 2] - 1 / 3).max() < 1e-12
    points, triangles, _ = mesh.shading
    assert len(points) == len(mesh.points)  # shaded smoothly across the joint
    assert len(triangles) == len(mesh.triangles)


def test_joints_that_are_not_there_say_which_order_there_is():
    ball, other = "x^2 + y^2 + z^2 - 1", "x^2 + y^2 + z^2 - 1 + (z - 1/3)^2"
    shape = solid.patch("upper", ball, "z - 1/3") | solid.patch("lower", other, "1/3 - z")
    assert "none claimed, none proved" in str(shape)
    assert not shape.proved
    wrong = shape.joined("upper", "lower", (ball, "z - 1/3"), 2)
    assert not wrong.proved
    assert "they meet with GC^1 there" in str(wrong.verdicts[0])
    with pytest.raises(pas.GeometryError, match=r"joint not there.*GC\^1"):
        wrong.require_joints()
    assert "do not meet" in str(shape.joined("upper", "lower", (ball, "z - 1/2"), 0).verdicts[0])
    apart = solid.patch("upper", ball, "z - 2/3") | solid.patch("lower", other, "1/3 - z")
    assert "regions" in str(apart.joined("upper", "lower", (ball, "z - 1/3"), 1).verdicts[0])
    with pytest.raises(pas.GeometryError, match="has no face 'lid'"):
        shape.joined("lid", "lower", (ball, "z"), 1)
    empty_curve = shape.joined("upper", "lower", (ball, "z - 1/3"), 1)
    assert empty_curve.verdicts[0].proved


def test_singular_points_on_a_joint_are_found():
    cone = "x^2 + y^2 - z^2"
    shape = solid.patch("cone", cone, "z", "1 - z") | solid.patch("other", cone, "-z", "z + 1")
    assert not shape.joined("cone", "other", (cone, "x - y"), 0).verdicts[0].proved  # they meet in the apex alone
    whole = solid.patch("cone", cone, "x", "2 - x^2 - z^2") | solid.patch("other", cone, "-x", "2 - x^2 - z^2")
    verdict = whole.joined("cone", "other", (cone, "x"), 1).verdicts[0]
    assert not verdict.proved
    assert "singular" in verdict.reason


def test_part_list_names_degrees_and_verdicts():
    shape = solid.ball((0, 0, 0), 1).cap("z - 1/2", "lid")
    assert shape.faces == ("ball", "lid")
    assert "lid   1" in str(shape)
    assert shape.mesh(1e-2).face_areas["lid"] == pytest.approx(pi * 3 / 4, rel=1e-2)


@pytest.mark.parametrize(
    "make, error, words",
    [
        (lambda: (solid.ball((0, 0, 0), 1) & solid.ball((5, 0, 0), 1)).mesh(), pas.GeometryError, "empty"),
        (lambda: solid.half_space("x").mesh(), pas.GeometryError, "unbounded.*intersect it with a box"),
        (lambda: solid.implicit("x^2 + y^2 - 1").volume(), pas.GeometryError, "unbounded"),
        (lambda: solid.ball((0, 0, 0), 0), ValueError, "radius must be positive"),
        (lambda: solid.box((0, 0, 0), (1, 0, 1)), ValueError, "in y"),
        (lambda: solid.torus((0, 0, 0), (0, 0, 1), 1, 2), ValueError, "minor must be smaller"),
        (lambda: solid.cone((0, 0, 0), (0, 0, 0), 1), ValueError, "different points"),
        (lambda: solid.half_space("x^2"), ValueError, "linear"),
        (lambda: solid.patch("a", 3), ValueError, "not constant"),
        (lambda: solid.ball((0, 0, 0), 1).mesh(-1), ValueError, "tolerance"),
        (lambda: solid.ball((0, 0, 0), 1).scale(0), ValueError, "positive"),
        (lambda: solid.ball((0, 0, 0), 1).contains([1, 2]), ValueError, "shape"),
        (lambda: solid.union([]), ValueError, "at least one"),
        (lambda: solid.assembly(), ValueError, "at least one part"),
        (lambda: solid.assembly(a=3), TypeError, "part 'a'"),
        (lambda: solid.assembly(a=(solid.ball((0, 0, 0), 1), "red")), ValueError, "#rrggbb"),
        (
            lambda: (solid.implicit("(x^2+y^2+z^2-1)*(x+3)", face="a") | solid.ball((0, 0, 0), 1)).mesh(),
            pas.GeometryError,
            "unbounded|coincide",
        ),
    ],
)
def test_bad_input(make, error, words):
    with pytest.raises(error, match=words):
        make()


def test_coincident_faces_are_refused():
    box = solid.box((-2, -2, -2), (2, 2, 2))
    doubled = solid.implicit("(x^2 + y^2 + z^2 - 1)*(x^2 + 1)", face="a") & box
    with pytest.raises(pas.GeometryError, match=r"'a' and 'ball' coincide|'ball' and 'a' coincide"):
        (doubled | solid.ball((0, 0, 0), 1)).mesh()


@pytest.mark.parametrize(
    "shape, low, high",
    [
        (solid.ball((0, 0, 0), 1), (-1, -1, -1), (1, 1, 1)),
        (solid.ball((10**5, 0, 0), 1), (10**5 - 1, -1, -1), (10**5 + 1, 1, 1)),
        (solid.cylinder((0, 0, 0), (10, 10, 10), "1/100"), (0, 0, 0), (10, 10, 10)),
        (solid.ball((0, 0, 0), 1) - solid.ball((0, 0, 0), "99/100"), (-1, -1, -1), (1, 1, 1)),
        (solid.ball((0, 0, 0), 1) | solid.ball((100, 0, 0), 2), (-1, -2, -2), (102, 2, 2)),
        (solid.ball((0, 0, 0), 1) & solid.half_space("x + y + z - 3/2"), (-1, -1, -1), (1, 1, 1)),
    ],
)
def test_boxes_hold_solids_tightly(shape, low, high):
    further = np.stack([low - shape.box[0], shape.box[1] - high]) / np.ptp([low, high], axis=0)
    assert further.min() > -1e-6 and further.max() < 0.06


def test_boxes_of_prisms_are_exact():
    prism = solid.intersection([solid.half_space(f"{p} - 1") for p in ("x + y", "x - y", "-2*x", "z", "-z")])
    assert prism.box == pytest.approx(np.array([[-0.5, -1.5, -1], [1, 1.5, 1]]), abs=1e-7)


def test_boxes_of_four_planes_in_a_ball_hold_what_is_there():
    """Of tetrahedra, and of wedges that the ball ends."""
    generator, ball = np.random.default_rng(3), solid.ball((0, 0, 0), 1)
    points = generator.uniform(-1, 1, (20000, 3))
    for _ in range(12):
        planes = [f"{a}*x + {b}*y + {c}*z - 2" for a, b, c in generator.integers(-6, 7, (4, 3)).tolist()]
        part = reduce(and_, (solid.half_space(plane, f"side {n}") for n, plane in enumerate(planes)), ball)
        inside = points[part.contains(points)]
        ends = np.stack([inside.min(axis=0), inside.max(axis=0)])
        assert (part.box[0] <= ends[0]).all() and (part.box[1] >= ends[1]).all()
        assert part.box == pytest.approx(ends, abs=0.15)


@pytest.mark.slow
def test_thin_solids_are_refused_in_words():
    sheet = solid.half_space("z - 1/100000") & solid.half_space("-z", "below") & solid.ball((0, 0, 0), 1)
    with pytest.raises(MeshError, match="too thin for its size"):
        sheet.mesh()


@pytest.mark.parametrize("sides", [(1, 1, "1/100000"), (1000, 1000, 1), (1000, 1, 1)])
def test_boxes_mesh_however_thin_or_long_they_are(sides):
    box = solid.box((0, 0, 0), sides).rotate((1, 2, 2), 30).translate((1, 2, 3))
    mesh = box.mesh()
    assert len(mesh.triangles) == 12 and mesh.is_closed and set(mesh.names) == set(box.faces)
    assert mesh.volume == pytest.approx(float(np.prod([float(Fraction(t)) for t in sides])), rel=1e-9)


def test_long_pipes_and_plates_with_holes():
    bore = solid.cylinder((-1, 0, 0), (1001, 0, 0), 4, "bore")
    pipe = (solid.cylinder((0, 0, 0), (1000, 0, 0), 5) - bore).mesh(0.02)
    assert pipe.is_closed and pipe.euler_characteristic == 0
    assert pipe.volume == pytest.approx(9000 * pi, rel=5e-3)
    plate = solid.box((0, 0, 0), (1000, 1000, 1)) - solid.cylinder((500, 1, -1), (500, 1, 2), "1/5", "hole")
    mesh = plate.mesh(0.02)
    assert mesh.is_closed and mesh.euler_characteristic == 0 and "hole" in mesh.names
    assert mesh.volume == pytest.approx(1e6 - pi / 25, abs=0.02)


@pytest.mark.parametrize("second", [solid.ball((0, 0, "3/2"), "1/2"), solid.cylinder((-1, 0, 2), (1, 0, 2), 1)])
def test_what_touches_a_box_from_above_is_no_piece_of_its_own(second):
    box = solid.box((-1, -1, 0), (1, 1, 1))
    with pytest.raises(MeshError, match="touch, and the parts that they bound do not overlap"):
        (box | second).mesh(1e-2)
    almost = (box | second.translate((0, 0, "1/100000"))).mesh(1e-2)
    assert almost.components == 2 and almost.is_closed


SLAB = solid.box((-2, -2, 0), (2, 2, 1))


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "shape",
    [
        SLAB | solid.cone((0, 0, 2), (0, 0, 1), 1, 0),
        SLAB | solid.box((0, 0, 0), (1, 1, 1), "corner").rotate((1, -1, 0), 45).translate((0, 0, 1)),
        SLAB | solid.torus((0, 0, "5/4"), (0, 0, 1), 1, "1/4"),
        (SLAB - solid.cylinder((0, 0, -1), (0, 0, 2), 1, "bore")) | solid.ball((0, 0, "1/2"), 1),
    ],
    ids=["apex", "corner", "torus", "ball in a bore"],
)
def test_pieces_that_touch_in_a_vertex_or_along_a_curve_are_no_surface(shape):
    with pytest.raises(MeshError, match=r"touch|meet in one point"):
        shape.mesh(1e-2)


def roof(face):
    """Half of a square bar below its upper edge, which is along z."""
    return solid.polygon([(-1, -1), (1, -1), (0, 0)], face).extrude(2).translate(0, 0, -1)


def upside_down(offset):
    """Such a bar above its lower edge, which is along x."""
    return roof("other").rotate((0, 1, 0), 90).mirror((0, 1, 0)).translate(offset)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("known", [True, False], ids=["by meshes of the parts", "by a lattice"])
@pytest.mark.parametrize("offset", [("1/100", 0, 0), ("1/3", 0, "1/7")])
def test_edges_that_cross_in_one_point_make_no_surface(offset, known):
    shape = roof("one") | upside_down(offset)
    with pytest.raises(MeshError, match="the solid could not be meshed"):
        (shape if known else replace(shape, sheets=None)).mesh(1e-2)
    almost = roof("one") | upside_down((offset[0], "1/100", offset[2]))
    assert (almost if known else replace(almost, sheets=None)).mesh(1e-3).components == 2


def test_pieces_that_touch_are_known_on_a_lattice_as_well():
    tip = solid.box((-1, -1, -1), (1, 1, 1)) - solid.cone((0, 0, "-1/2"), (0, 0, 1), "1/2", 0)
    corner = SLAB | solid.box((2, 2, 1), (3, 3, 2), "corner")
    for shape in (tip, corner):
        with pytest.raises(MeshError, match=r"touch|is singular"):
            replace(shape, sheets=None).mesh(1e-2)


def test_meshes_have_no_triangles_that_cross():
    """Two balls that overlap, as if they were apart: what bounds them is no surface."""
    balls = solid.ball((0, 0, 0), 1, "one"), solid.ball((1, 0, 0), 1, "other")
    both = balls[0] | balls[1]
    field, parts = both.field, []
    for ball in balls:
        mesh = ball.face_mesh(1e-2).mesh
        points = field.evaluator.local(ball.field.world(mesh.points))
        parts.append((points, mesh.triangles, field.labels_of(ball.field, mesh.labels)))
    points, triangles, labels = (np.concatenate(some) for some in zip(*parts, strict=True))
    triangles[len(parts[0][1]) :] += len(parts[0][0])
    crossed = Labelled.of(points, triangles, labels)
    with pytest.raises(MeshError, match="triangles of 'one' and 'other' cross"):
        closed.refined_faces(crossed, field, 1e-2, Quality.BALANCED)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(3))
def test_planes_that_are_equal_to_rounding_are_one(seed):
    """A flange that ends where a bored pipe does, at points and in a direction that are doubles."""
    way = np.random.default_rng(seed).normal(size=3)
    way /= np.linalg.norm(way)
    start = 3 * way[::-1]
    pipe = solid.cylinder(start, start + 5 * way, 1, "pipe")
    flange = solid.cylinder(start + 4.7 * way, start + 5 * way, 2, "flange")
    made = (pipe | flange) - solid.cylinder(start - way, start + 6 * way, "3/4", "bore")
    for known in (made, replace(made, sheets=None)):
        mesh = known.mesh(1e-2)
        assert mesh.euler_characteristic == 0 and "pipe end + flange end" in mesh.names
        assert mesh.volume == pytest.approx(pi * (5 * (1 - 9 / 16) + 0.3 * 3), rel=2e-2)


def test_planes_that_are_nearly_equal_are_two():
    """Seen from where they are, which is far from the origin, and beside it."""
    for far in (0, 10**6):
        stack = solid.box((far, 0, 0), (far + 1, 1, 1)) | solid.box(
            (far + Fraction(1, 10**6), 0, 1), (far + 1, 1, 2), "b"
        )
        assert {"box x-", "b x-"} <= {*stack.mesh(2.1e-7).names}


def test_faces_that_lie_in_one_plane_are_no_contact():
    """Of two boxes a little apart: each has vertices in the planes of the other's sides."""
    near = SLAB | solid.box(("2001/1000", -2, 0), (3, 2, 1), "other")
    assert near.mesh(1e-2).components == 2


def test_first_meshes_are_no_finer_than_they_must_be():
    """Cuts of fine meshes would take many times as long as all the rest."""
    shape = SLAB - solid.ball((0, 0, 1), "1/2")
    assert shape.mesh(2e-4).deviation <= 2e-4
    assert [tolerance for tolerance, _ in shape.sheets.parts[1]._cache] == [pytest.approx(1e-3, rel=0.1)]


def test_a_face_that_first_meshes_show_is_not_lost_by_a_lattice(monkeypatch):
    shape = solid.box((0, 0, 0), (1000, 1000, 1)) - solid.cylinder((500, 1, -1), (500, 1, 2), "1/5", "hole")
    monkeypatch.setattr(closed, "_from_first", lambda *_: None)
    monkeypatch.setattr(closed, "_bounded", lambda *_: shape.sheets.parts[0].face_mesh(1))
    with pytest.raises(MeshError, match="hole did not come out"):
        shape.mesh(0.02)


def test_booleans_of_meshes():
    a, b = solid.ball((0, 0, 0), 1).mesh(1e-2), solid.ball((1, 0, 0), 1, "other").mesh(1e-2)
    for result, expected in ((a | b, 8 * pi / 3 - 5 * pi / 12), (a & b, 5 * pi / 12), (a - b, 11 * pi / 12)):
        assert result.is_closed
        assert result.volume == pytest.approx(expected, rel=3e-2)
        assert result.names == ("ball", "other")
    opened = solid.SolidMesh(a.points, a.triangles[1:], a.faces[1:], a.names, a.normals[1:])
    with pytest.raises(pas.GeometryError, match="open or no manifold"):
        _ = opened | b
    with pytest.raises(pas.GeometryError, match="inside out"):
        solid.SolidMesh.from_triangles(a.points, a.triangles[:, ::-1])
    for corner in (-1, -(10**9), len(a.points), 10**9):
        triangles = np.concatenate([a.triangles[1:], [[0, 1, corner]]])
        with pytest.raises(pas.GeometryError, match=f"corners are not numbers of its {len(a.points)} points"):
            solid.SolidMesh.from_triangles(a.points, triangles)
    with pytest.raises(ValueError, match="triangles must be numbers of points"):
        _ = pas.Mesh.smooth(np.zeros((3, 3)), np.array([[0, 1, -5]]), np.zeros((3, 3))).is_closed
    with pytest.raises(ValueError, match="triangles must be numbers of points"):
        twins_of(np.array([[0, 1, -1]]), 3)
    far = solid.ball((9, 0, 0), 1).mesh(1e-2)
    with pytest.raises(pas.GeometryError, match="empty"):
        _ = a & far


def test_assemblies_keep_parts_apart():
    both = solid.assembly(a=solid.ball((0, 0, 0), 1), b=(solid.box((1, -1, -1), (2, 1, 1)), "#112233"))
    assert list(both.parts) == ["a", "b"]
    assert both["b"].color == "#112233"
    assert both.colored(a="#000000")["a"].color == "#000000"
    moved = both.moved(lambda name, s: s.translate((10, 0, 0)) if name == "a" else s)
    assert moved.contains([[10, 0, 0], [0, 0, 0], [1.5, 0, 0]]).tolist() == [True, False, True]
    with pytest.raises(KeyError, match="no part 'c'"):
        both["c"]


@pytest.mark.parametrize(
    "values, root",
    [
        (lambda x: (x - 0.9, np.ones_like(x)), 0.9),
        (lambda x: ((x - 0.9) ** 3, 3 * (x - 0.9) ** 2), 0.9),
        (lambda x: (np.arctan(40 * (x - 0.2)), 40 / (1 + 1600 * (x - 0.2) ** 2)), 0.2),  # Newton alone diverges
        (lambda x: (0.3 - x**5, -5 * x**4), 0.3**0.2),  # falling
    ],
)
def test_lattice_edges_are_crossed_where_functions_vanish(values, root):
    class Along:
        def jets(self, points, labels):
            value, slope = values(points[:, 0])
            return np.stack([value, slope, 0 * slope, 0 * slope], axis=1)

    found = _roots(Along(), np.zeros(2, dtype=int), np.zeros((2, 3)), np.tile([1.0, 0, 0], (2, 1)))
    assert found == pytest.approx([root] * 2, abs=2e-3 if root == 0.9 else 1e-9)


def test_what_is_left_of_boxes_that_touch_in_a_face_is_nothing():
    left, right = solid.box((0, 2, 0), (4, 8, 2)), solid.box((4, 3, 0), (5, 6, 2))
    with pytest.raises(pas.GeometryError, match="the solid is empty"):
        (right & left).mesh(0.02)
    assert ((right & left) | solid.box((0, 0, 0), (1, 1, 1))).mesh(0.02).volume == pytest.approx(1)
