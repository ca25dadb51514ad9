"""Unions of blends' solids that go on in one another, meshed from their surfaces' meshes, beside their lattices'."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import product

import numpy as np
import pytest
from test_sheet_bodies import is_sound

import pas
from pas import solid
from pas.algebra.rational import rational, to_float
from pas.solid.linked import LinkedBodies
from pas.solid.operands import Operands
from pas.solid.runs import plain_run

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
AXES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]


@cache
def branch():
    """A T, which ends at x = 3 and -3, and y = 3."""
    return pas.blend([pas.Pipe(X, 1, 2), pas.Pipe((-1, 0, 0), 1, 2), pas.Pipe(Y, "4/5", 2)], 1)


@cache
def made(thickness=None):
    return (branch() if thickness is None else branch().hollow(thickness)).solid(1)


def row(count, thickness=None):
    return solid.union([made(thickness).translate((6 * i, 0, 0)) for i in range(count)])


def longest_side(whole):
    return np.ptp(whole.sheets.coarse.box, axis=0).max()


def test_three_in_a_row_are_one():
    whole = row(3)
    assert isinstance(whole.sheets, LinkedBodies) and len(whole.sheets.links) == 2
    for tolerance in (1e-1, 1e-2):
        mesh = is_sound(whole.mesh(tolerance), whole, tolerance, 2)
        assert mesh.volume == pytest.approx(3 * made().mesh(tolerance).volume, rel=1e-3)
    ends = mesh.points[
        np.unique(mesh.triangles[np.isin(mesh.faces, [mesh.names.index(f"neighbour {i} end") for i in (1, 2)])])
    ]
    assert {*ends[:, 0].round(9)} == {-3, 15}  # none is left between


@pytest.mark.slow
def test_walls_in_a_row_are_one():
    whole = row(3, "1/8")
    mesh = is_sound(whole.mesh(1e-2), whole, 1e-2, 2 * (2 - 5))
    assert mesh.volume == pytest.approx(3 * made("1/8").mesh(1e-2).volume, rel=1e-2)
    moved = whole.rotate((1, 2, 2), 40).mirror((1, 2, 3))
    assert moved.mesh(1e-2).volume == pytest.approx(mesh.volume, rel=1e-3)


@pytest.mark.parametrize("count", [1, 2])
def test_the_usual_tolerance_is_that_of_the_box(count):
    """Measured on a coarse mesh, where the box of the inequalities takes long."""
    whole = row(count)
    longest = np.ptp(whole.box, axis=0).max()
    assert longest_side(whole) == pytest.approx(longest, rel=2e-2) == pytest.approx(6 * count, rel=2e-2)
    assert longest_side(whole.scale("1/1000")) == pytest.approx(longest / 1000, rel=2e-2)
    assert whole.mesh().deviation <= 1e-3 * longest and len(whole.mesh().triangles) > len(whole.mesh(3e-2).triangles)


def test_faces_of_one_name_are_measured_on_their_own_surfaces():
    whole = row(2)
    assert whole.volume(2e-2) == pytest.approx(2 * made().volume(2e-2), rel=1e-4)
    assert np.median(whole.mesh(5e-2, quality="angles").smallest_angles) > 30


def test_measures_go_by_the_mesh_of_the_sheets(monkeypatch):
    """The box of the inequalities, and where these hold, take much longer."""
    single = made().volume(2e-2), made().area(2e-2)
    disc = np.pi  # of the ends that are left away where two go on in one another
    monkeypatch.setattr("pas.solid.solid.bounding_box", None)
    whole = row(3)
    assert whole.volume(2e-2) == pytest.approx(3 * single[0], rel=1e-4)
    assert whole.area(2e-2) == pytest.approx(3 * single[1] - 4 * disc, rel=1e-3)
    assert np.ptp(whole.bounding_box, axis=0)[0] == pytest.approx(18)


@pytest.mark.slow
def test_the_lattice_says_the_same_of_two():
    whole = row(2)
    lattice = replace(whole, sheets=None)
    assert whole.volume(2e-2) == pytest.approx(lattice.volume(2e-2), rel=1e-3)
    assert whole.area(2e-2) == pytest.approx(lattice.area(2e-2), rel=1e-3)


def test_bodies_apart_are_so_in_their_mesh():
    """Beside one another, by boxes; with ends in one plane, by these; above one another, turned by the same."""
    for offset, parts in (((0, 0, 3), 2), ((6, 0, 3), 2), ((0, -6, 0), 2), ((6, -4, 0), 2)):
        whole = made() | made().translate(offset)
        assert whole.sheets is not None and not whole.sheets.links
        mesh = whole.mesh(1e-2)
        assert (mesh.is_closed, mesh.components) == (True, parts)


@pytest.mark.parametrize("offset", [(1, 0, 0), ("49/10", 0, 0), (6, "1/2", 0), (6, 0, "3/2"), (0, 0, "19/10")])
def test_bodies_that_meet_elsewhere_have_no_sheets(offset):
    """Overlapping, or with ends in one plane that are not those of one pipe."""
    assert isinstance((made() | made().translate(offset)).sheets, Operands)


@pytest.mark.sampled(7)
@pytest.mark.parametrize(
    ("first", "second", "apart"),
    [(1, 1, 5), (1, "1/2", "11/2"), (2, "1/2", 6), (0, 2, 6), (2, [0, 1, 1], 6), (2, [1, 0, 1], 6), (2, 2, "13/2")],
)
def test_ends_that_overlap_are_one_pipe(first, second, apart):
    """By a part of their lengths or all of it, and where one of them has none."""
    bodies = branch().solid(first), branch().solid(second)
    whole = bodies[0] | bodies[1].translate((apart, 0, 0))
    assert len(whole.sheets.links) == 1
    is_sound(whole.mesh(1e-2), whole, 1e-2, 2)
    between = to_float(rational(apart, "distance")) - 4
    own = [body.volume(1e-2) for body in bodies]
    lengths = [to_float(rational(of, "length")) for of in (first, second[1] if isinstance(second, list) else second)]
    assert whole.volume(1e-2) == pytest.approx(sum(own) - np.pi * (sum(lengths) - between), rel=1e-4)


@pytest.mark.parametrize("thickness", [pytest.param("1/8", marks=pytest.mark.slow), None])
def test_overlaps_are_those_of_the_inequalities(thickness):
    whole = (made(thickness) | made(thickness).translate(("11/2", 0, 0))).rotate((1, 2, 2), 40).scale("1/3")
    mesh = whole.mesh(3e-3)
    inward = mesh.points[mesh.triangles].mean(axis=1) - 0.02 * mesh.normals.mean(axis=1)
    assert whole.contains(inward).mean() > 0.99 and not whole.contains(inward + 0.04 * mesh.normals.mean(axis=1)).any()


REACH = r"near .* '(.*)' goes on beyond the curve in which that meets 'blend', and leaves it without an angle"


@pytest.mark.sampled(3)
@pytest.mark.parametrize("apart", ["9/2", 4, 1])
def test_straight_ends_that_reach_the_other_blend_are_refused(apart):
    """Its surface leaves theirs without an angle, so that no mesh shows where they cross."""
    whole = made() | made().translate((apart, 0, 0))
    for solid_ in (whole, whole - solid.ball((0, 0, 0), "1/2")):
        with pytest.raises(pas.MeshError, match=REACH):
            solid_.mesh(1e-2)
    half_way = branch().solid(["1/2", "1/2", 1])
    assert (half_way | half_way.translate(("9/2", 0, 0))).mesh(1e-2).components == 1


@pytest.mark.sampled(2)
@pytest.mark.parametrize("thickness", [None, "1/8"])
def test_tubes_that_reach_into_a_blend_are_refused_at_once_where_they_leave_it(thickness, monkeypatch):
    """Along the run the blend is outside of it here and inside there; on the branch it is outside all around."""
    body = made(thickness)
    tube, branch_tube = (
        solid.cylinder([start * c for c in axis], [6 * c for c in axis], radius, "tube")
        for axis, radius, start in ((X, 1, 1), (Y, "4/5", 1))
    )
    for whole in (body | tube, (body | tube).rotate((1, 2, 2), 40), body - tube, body & tube, tube - body):
        with monkeypatch.context() as patch, pytest.raises(pas.MeshError, match=REACH) as found:
            patch.delattr("pas.mesh.closed.first_lattice")  # no lattice is looked at
            whole.mesh(1e-2)
        assert "tube" in str(found.value)
    if thickness is None:
        inside = body | tube | solid.box(("1/2", -2, -2), (3, 2, 2))  # of a third part
        assert inside.mesh(5e-2).components == 1
        longer = body | solid.cylinder((0, 2, 0), (0, 6, 0), "4/5", "tube")
        assert (body | branch_tube).volume(1e-2) == pytest.approx(longer.volume(1e-2), rel=1e-4)


def test_ends_are_those_of_one_pipe():
    """A narrower one, or a wall, does not go on from it."""
    narrower = pas.blend([pas.Pipe((-1, 0, 0), "1/2", 2), pas.Pipe(Y, "1/2", 2)], 1).solid(1).translate((6, 0, 0))
    assert isinstance((made() | narrower).sheets, Operands)
    assert isinstance((made() | narrower.translate((1, 0, 0))).sheets, LinkedBodies)


@pytest.mark.slow
def test_crosses_in_a_square_are_one():
    """Those at opposite corners are apart by slanting planes alone."""
    node = pas.node([(axis, 1) for axis in (X, (-1, 0, 0), Y, (0, -1, 0))], 1).solid("5/2")
    whole = solid.union([node.translate((8 * i, 8 * j, 0)) for i, j in product(range(2), repeat=2)])
    assert len(whole.sheets.links) == 4 and is_sound(whole.mesh(1e-1), whole, 1e-1, 0)


def test_walls_and_full_bodies_are_not_linked():
    wall = made("1/8")
    assert wall.sheets is not None and isinstance((made() | wall.translate((6, 0, 0))).sheets, Operands)


def test_what_is_bowed_is_not_joined_by_straight_strips():
    """A ball that ends at its equator, and its image, are no cylinder."""
    ball = pas.blend([pas.Contact("x^2 + y^2 + (z + 2)^2 - 4", "-z - 3/2"), pas.Pipe(Z, "1/2", 1)], 1).solid("1/2")
    assert ball.sheets is not None and isinstance((ball | ball.mirror(Z, (0, 0, -2))).sheets, Operands)


@pytest.mark.slow
@pytest.mark.parametrize("count", [2, 3])
def test_a_cubic_lattice_of_struts_is_one_solid(count):
    """Its surface has as many handles as the graph has independent circuits."""
    nodes = []
    for place in product(range(count), repeat=3):
        axes = [axis for axis in AXES if all(0 <= p + a < count for p, a in zip(place, axis, strict=True))]
        node = pas.node([(axis, "1/4") for axis in axes], 1)
        nodes.append(node.solid([2 - exact(end) for end in node.ends()]).translate([4 * p for p in place]))
    whole = solid.union(nodes)
    mesh = whole.mesh(1e-2)
    struts = 3 * count**2 * (count - 1)
    assert len(whole.sheets.links) == struts and mesh.deviation <= 1e-2
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2 * (count**3 - struts))


@pytest.mark.slow
def test_a_lattice_less_a_ball_is_meshed_by_what_is_near():
    """Not by each function of some thousand with all joints, nor by each wall with all pairs of faces."""
    node = pas.blend([pas.Pipe(axis, "1/2", 1) for axis in AXES], 1).solid(1)
    whole = solid.union([node.translate((4 * i, 4 * j, 0)) for i, j in product(range(3), repeat=2)])
    cut = whole - solid.ball((0, 0, 0), "3/2")
    mesh = cut.mesh(5e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 5, 2 * (8 - 10) + 2 * 4)
    assert np.linalg.norm(mesh.points, axis=1).min() == pytest.approx(1.5) and np.ptp(mesh.box, axis=0)[0] == 12
    points = np.random.default_rng(0).uniform((-3, -3, -3), (11, 11, 3), (2000, 3))
    inside, evaluator = cut.contains(points), cut.field.evaluator
    assert np.array_equal(inside, evaluator.inside(evaluator.signs(evaluator.local(points))))
    assert np.abs(cut.box - [[-2, -2, -2], [10, 10, 2]]).max() < 0.1 and 0 < inside.sum() < 200
    turned = cut.rotate((1, 2, 3), 40).mesh(5e-2)  # whose parts are turned by themselves
    assert turned.volume == pytest.approx(mesh.volume, rel=1e-2)


def tube(start, end, radius=1, bore=None, further=1):
    made = solid.cylinder((start, 0, 0), (end, 0, 0), radius)
    return made if bore is None else made - solid.cylinder((start - further, 0, 0), (end + further, 0, 0), bore, "bore")


@pytest.mark.sampled(2)
@pytest.mark.parametrize("thickness", [None, "1/8"])
def test_a_plain_tube_between_two_blends_is_linked_to_both(thickness):
    one, bore = made(thickness), None if thickness is None else "7/8"
    for further in (0, 1):
        whole = (one | tube(3, 17, bore=bore, further=further) | one.translate((20, 0, 0))).rotate((1, 2, 3), 40)
        assert len(whole.sheets.links) == 2
        mesh = is_sound(whole.mesh(1e-2), whole, 1e-2, 2 if thickness is None else 2 * (2 - 4))
        area = np.pi * (1 if thickness is None else 1 - 49 / 64)
        assert mesh.volume == pytest.approx(2 * one.mesh(1e-2).volume + 14 * area, rel=1e-2)
    assert len((one | tube(Fraction(5, 2), 17, bore=bore)).sheets.links) == 1  # which overlaps


def test_what_is_no_plain_tube_is_not_linked():
    """Of another radius, elliptic, with a leaning end or bore, one of another width or too short, full for a wall."""
    pipe, wall = tube(3, 9), made("1/8")
    leaning = solid.cylinder((2, "1/8", 0), (10, 0, 0), "3/4", "bore")
    others = [tube(3, 9, "9/10"), pipe.scale((1, 1, "9/10")), pipe & solid.half_space("x + y/8 - 8"), pipe - leaning]
    assert all(isinstance((made() | other).sheets, Operands) for other in others)
    assert [plain_run(one.tree) is not None for one in (pipe, *others[:2])] == [True, True, False]
    for bore in ("3/4", "9/8"):
        assert isinstance((wall | tube(3, 9, bore=bore)).sheets, Operands)
    for other in (pipe, pipe - tube(2, 8, "7/8"), pipe - tube(4, 10, "7/8")):
        assert isinstance((wall | other).sheets, Operands)
    assert not (made() | tube(4, 9)).sheets.links  # apart


def exact(end):
    """How far an end is from the node's centre, in which it has a double."""
    return rational(max(abs(c) for c in end.center), "distance")
