"""Solids of blends in which pipes go straight through: closed, with every face under its name, their joints proved."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from conftest import read

import pas
from pas import solid
from pas.algebra.ideal import Ideal
from pas.mesh.diagnostics import _Place, diagnosis
from pas.pipeline.blend import struts
from pas.solid.seams import Seam, seams_of

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


def both(*axes):
    return [way for axis in axes for way in (axis, tuple(-c for c in axis))]


def tee(*clip):
    return [*((way, 1, *clip) for way in both(X)), (Y, "4/5", *clip)]


BICYCLE = [*((way, "17.45") for way in both(X)), ((0.292372, 0.956305, 0), "14.3")]

NODES = {
    "T": (tee(), 1),
    "T GC^2": (tee(), 2),
    "T clipped at 2": (tee(2), 1),
    "T GC^2 clipped at 2": (tee(2), 2),
    "bicycle": (BICYCLE, 1),
    "cross": ([(way, 1) for way in both(X, Y)], 2),
    "six-way": ([(way, 1) for way in both(X, Y, Z)], 1),
    "tetrahedral": ([((1, 1, 1), 1), ((1, -1, -1), 1), ((-1, 1, -1), 1), ((-1, -1, 1), 1)], 1),
}
"""The struts of a node, and its order."""

QUICK = {("T", None)}

CASES = [
    pytest.param(name, length, marks=() if (name, length) in QUICK else pytest.mark.slow)
    for name in NODES
    for length in ((None, 2, 0) if name == "six-way" else (None,))
]


@pytest.mark.parametrize("name, length", CASES)
def test_nodes_are_closed_bodies_with_proved_joints(name, length):
    items, order = NODES[name]
    pipes = struts(items, order)
    radius = max(float(p.radius) for p in pipes)
    body = (read("tee") if name == "T" else pas.blend(pipes, order)).solid(length)
    mesh = body.mesh(radius / 50)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2)
    assert mesh.deviation <= radius / 50
    assert mesh.volume == pytest.approx(body.volume(radius / 50), rel=2e-2)
    assert mesh.volume > 0
    assert length == 0 or body.proved
    ends = {f"neighbour {i + 1} end" for i in range(len(items))}
    tubes = set() if length == 0 else {f"neighbour {i + 1}" for i in range(len(items))}
    assert len(mesh.names) == len({*mesh.names}) and {*mesh.names} == {"blend", *ends, *tubes}
    for number, (axis, *_) in enumerate(items):
        direction = np.array(axis, dtype=float) / np.linalg.norm(np.array(axis, dtype=float))
        for part in ("", " end") if tubes else (" end",):
            rows = mesh.faces == mesh.names.index(f"neighbour {number + 1}{part}")
            corners = mesh.points[mesh.triangles[rows]]
            assert (corners @ direction).min() > 0.9 * radius  # beyond the clip of its own strut
            if not part:
                across = np.linalg.norm(corners - (corners @ direction)[..., None] * direction, axis=-1)
                assert across == pytest.approx(float(pipes[number].radius), rel=1e-3)


PIPE, WALLS = pas.Polynomial("y^2 + z^2 - 1"), [pas.Polynomial(w) for w in ("x - 2", "x + 3", "x - 9")]
TUBE = solid.patch("tube", PIPE)


def squeezed(wall):
    """A surface that touches the pipe along its circle on a wall."""
    return PIPE + wall**2


def test_curves_that_two_faces_share_are_one_seam():
    bent = squeezed(WALLS[0] * WALLS[1])
    tree = (TUBE | solid.patch("bent", bent)).tree
    seams = seams_of(tree, {(PIPE, WALLS[0]): 1, (WALLS[1], -3 * PIPE): 1, (PIPE, WALLS[2]): 1})
    assert len(seams) == 4
    assert [len(seam.curves) for seam in seams] == [2, 1, 1, 1]
    common, product = seams[0].functions
    assert common.primitive() == PIPE.primitive()
    assert product.primitive() == (WALLS[0] * WALLS[1]).primitive()  # not with the wall that the other is not on
    assert seams[0].is_on([PIPE]) and seams[0].is_on([bent]) and not seams[0].is_on([squeezed(WALLS[0])])


def test_a_curve_that_is_claimed_twice_counts_once():
    bent = squeezed(WALLS[0])
    tree = (TUBE | solid.patch("bent", bent)).tree
    for claims in ([(PIPE, WALLS[0]), (bent, WALLS[0])], [(PIPE, WALLS[0]), (PIPE, -WALLS[0])]):
        first = seams_of(tree, dict.fromkeys(claims, 1))[0]
        assert Ideal(*first.functions).contains(WALLS[0]) and Ideal(*first.functions).contains(PIPE)


def test_planes_that_touch_cylinders_and_cones_have_a_seam():
    box = solid.box((0, 0, 0), (2, 3, 4))
    tube, cone = solid.cylinder((1, 2, -1), (1, 2, 5), 1), solid.patch("cone", "x*y - z^2")
    assert {seam.functions[1].primitive() for seam in seams_of((box & tube).tree, {})} == {
        pas.Polynomial("x - 1").primitive(),
        pas.Polynomial("y - 2").primitive(),
    }
    seams = seams_of((solid.half_space("3*x", "side") & cone).tree, {})
    assert [f.primitive() for f in seams[0].functions] == [pas.Polynomial("x"), pas.Polynomial("z")]
    for across in ("x - 1/2", "x - 2/5"):  # in lines that are not rational, and in rational ones
        assert not seams_of((solid.half_space(across, "side") & tube).tree, {})


def test_places_modulo_a_prime_exclude_no_member():
    """Of ideals of a plane and a function all members vanish there, of other functions hardly one."""
    plane, pipe = pas.Polynomial("3*x + 5*y - z/7 - 2"), pas.Polynomial("x^2 + 2*y^2 + z^2/3 - 5*x*z - 11")
    seam = Seam((pipe, plane), (Ideal(pipe, plane),))
    (mark,) = seam.marks
    members = [
        pipe * pas.Polynomial(a) + plane * pas.Polynomial(b)
        for a, b in (("x^3 - 1/2", "y*z^2"), ("1", "x + z"), ("0", "y"))
    ]
    assert mark is not None and all(not m.residues(*mark) and seam.is_on([m]) for m in members)
    others = [m + pas.Polynomial(c) for m in members for c in ("1", "x/13", "y^2 - z")]
    assert all(m.residues(*mark) and not seam.is_on([m]) for m in others)
    assert Seam((pipe, pipe + 1), (Ideal(pipe, pipe + 1),)).marks == [None]
    flat = pas.Polynomial({(1, 0, 0): 2**31 - 1, (0, 0, 0): 1})  # a plane without slope modulo the prime
    assert Seam((pipe, flat), (Ideal(pipe, flat),)).marks == [None]


def test_a_name_with_a_plus_is_one_name():
    mesh = solid.ball((0, 0, 0), 1, "a + b").mesh(0.1)
    assert mesh.names == ("a + b",)
    stacked = solid.box((0, 0, 0), (2, 2, 1), "a + b") | solid.box((1, 1, 0), (3, 3, 1), "c")
    mesh = stacked.mesh(0.1)
    assert "a + b z- + c z-" in mesh.names and ("a + b z-", "c z-") in mesh.solid_faces


def test_a_face_with_a_plus_in_its_name_is_filleted():
    plate = solid.box((-2, -2, -1), (2, 2, 0), "plate")
    boss = solid.cylinder((0, 0, -1), (0, 0, 1), "1/2", "boss + ring")
    for made in ((plate | boss).fillet("boss + ring", "plate z+", "1/8"), solid.smooth_union(plate, boss, "1/8")):
        assert made.proved and {"boss + ring", "fillet"} <= {*made.mesh().names}


def test_faces_that_share_a_surface_are_apart_from_one_of_the_joined_name():
    """One end of a bar is of two faces, `a` and `b`, the other one is the face `a + b`."""
    bar = solid.box((0, 0, 0), (4, 2, 1)).renamed({"box x-": "a", "box x+": "a + b"})
    mesh = (bar | solid.box((0, 0, 0), (3, 1, 1), "less").renamed({"less x-": "b"})).mesh(0.1)
    assert {("a", "b"), ("a + b",)} <= {*mesh.solid_faces} and len(mesh.names) == len({*mesh.solid_faces})
    assert mesh.face_areas["a + b"] == pytest.approx(4) and mesh.area == pytest.approx(sum(mesh.face_areas.values()))
    moved = mesh.translate(9, 0, 0)
    assert moved.solid_faces == mesh.solid_faces
    assert (mesh | moved).solid_faces == tuple((name,) for name in dict.fromkeys(mesh.names))


def test_of_faces_that_lie_on_one_another_both_are_named():
    pin = solid.box((1, 1, 0), (2, 2, 1), "pin")
    assert {"plate z- + pin z-", "plate z+ + pin z+"} <= {
        *(solid.box((0, 0, 0), (3, 3, 1), "plate") | pin).mesh().names
    }


def test_faces_that_are_apart_on_one_surface_keep_their_names():
    """Two bars in line, of one cylinder, through a plate between them that is wider."""
    first, second = (solid.cylinder((0, 0, 0), (0, 0, 3 * s), 1, f"bar {s}") for s in (1, -1))
    plate = solid.box((-2, -2, -1), (2, 2, 1), "plate")
    mesh = (first | second | plate).mesh(1e-2)
    assert {"bar 1", "bar -1"} <= {*mesh.names}
    for side in (1, -1):
        corners = mesh.points[mesh.triangles[mesh.faces == mesh.names.index(f"bar {side}")]]
        assert (side * corners[..., 2]).min() > 1 - 1e-9
    assert (first | second).mesh(1e-2).names[0] == "bar 1 + bar -1"  # one piece


def test_a_face_has_the_names_of_those_that_make_it():
    """Four plates end in one plane; what is left of three, with the third taken away, is nothing."""
    first, second, taken, last = (solid.box((-n, -n, -n), (n, n, 1), f"plate {n}") for n in (4, 5, 6, 3))
    body = ((first & second) - taken) | last
    assert {name for name in body.mesh(1e-1).names if "z+" in name} == {"plate 3 z+"}


ROUNDED = {
    "a cutter that reaches beyond": ((10, 2, 8), "3/2", 1),
    "a flush cutter": ((10, 6, 4), 3, 0),
    "a flush cutter beside a narrow rest": (("79/8", "21/4", "53/8"), 5, 0),
    "a narrow edge": (("57/8", "13/4", "77/8"), "1/4", 0),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", ROUNDED)
def test_an_edge_is_rounded_by_a_flush_cut(name):
    (w, d, h), radius, beyond = ROUNDED[name]
    w, d, h, r = (Fraction(v) for v in (w, d, h, radius))
    block = solid.box((w - r, d - r, -beyond), (w + beyond, d + beyond, h + beyond), "cutter")
    shape = solid.box((0, 0, 0), (w, d, h)) - (
        block - solid.cylinder((w - r, d - r, -beyond), (w - r, d - r, h + beyond), r, "round")
    )
    mesh = shape.mesh()
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2)
    assert shape.volume() == pytest.approx(float(w * d * h) - (1 - np.pi / 4) * float(r * r * h), rel=1e-3)
    assert "round" in mesh.names


BOX = solid.box((0, 0, 0), (2, 2, 2))
TANGENT = {
    "a hole": (
        lambda: BOX - solid.cylinder((1, "3/2", -1), (1, "3/2", 3), "1/2", "hole"),
        "near (1, 2, ",
        "the faces 'box y+' and 'hole' touch, and the solid has no thickness between them there",
    ),
    "a boss": (
        lambda: BOX | solid.cylinder((1, "5/2", 0), (1, "5/2", 2), "1/2", "boss"),
        "near (1, 2, ",
        "the faces 'box y+' and 'boss' touch, and the parts that they bound do not overlap there",
    ),
    "a circle inscribed in a square": (
        lambda: (solid.rectangle(2, 2) - solid.circle((1, 1), 1)).extrude(1),
        "near (",  # one of four places
        "and 'circle' touch, and the solid has no thickness between them there",
    ),
    "two pipes": (
        lambda: solid.cylinder((0, 0, 0), (0, 0, 2), 1, "a") | solid.cylinder((2, 0, 0), (2, 0, 2), 1, "b"),
        "near (1, 0, ",
        "the faces 'a' and 'b' touch, and the parts that they bound do not overlap there",
    ),
}


@pytest.mark.parametrize("name", TANGENT)
def test_tangent_faces_are_named_with_the_place_and_what_would_be_right(name):
    make, place, what = TANGENT[name]
    with pytest.raises(pas.MeshError, match=f"{re.escape(place)}.*{re.escape(what)}; let them cross, "):
        make().mesh(1e-2)


def test_a_plate_that_touches_a_run_is_refused_at_once_with_how_far_to_move_it(monkeypatch):
    """By which they cross as steeply as meshes need."""
    body = read("hollow_elbow").solid(4)
    plate = solid.box((3, -3, 1), (5, 3, "3/2"))
    told = r"near \([^,]*, 0, 1\).*do not overlap there.*move one by 0\.022\)"
    with monkeypatch.context() as patch, pytest.raises(pas.MeshError, match=told):
        patch.delattr("pas.mesh.closed.first_lattice")  # no lattice is looked at
        (body | plate).mesh(2e-2)
    assert (body | plate.translate((0, 0, "-22/1000"))).mesh(2e-2).components == 1


def test_lines_of_contact_inside_a_third_part_are_no_trouble():
    touching = solid.cylinder((-2, 0, 0), (2, 0, 0), 1) | solid.box((-2, -2, 1), (2, 2, 2))
    assert (touching | solid.box((-2, -1, "-1/2"), (2, 1, "3/2"))).mesh(5e-2).components == 1
    with pytest.raises(pas.MeshError, match=r"near \(.*, 0, 1\) the faces 'cylinder' and 'box z-' touch"):
        (touching | solid.box((-2, -1, "-1/2"), (0, 1, "3/2"))).mesh(5e-2)


def test_a_hole_that_touches_a_side_from_outside_is_none():
    mesh = (BOX - solid.cylinder((1, "5/2", -1), (1, "5/2", 3), "1/2", "hole")).mesh(1e-2)
    assert len(mesh.triangles) == 12 and mesh.volume == pytest.approx(8)


def test_known_seams_are_no_trouble_and_walls_are_not_blamed():
    body = pas.blend([pas.Pipe(axis, 1, 2) for axis in (X, Y)], 1).solid()
    place = np.array([[2.0, 0.0, 1.0]])
    unclaimed = replace(body, joints=())
    known, unknown = (diagnosis(b.field, b.field.evaluator.local(place), 0.05) for b in (body, unclaimed))
    assert known is None
    assert "the faces 'blend' and 'neighbour 1' touch; claim the curve as a joint" in unknown.sentence
    wave = (solid.half_space("z", face="flat") | solid.implicit("z - x^3", face="wave")) & solid.ball((0, 0, 0), 1)
    known = wave.joined("flat", "wave", ("z", "x"), 2)  # they go on in one another, and no third face says where
    place = np.array([[0, 0.3, 0]])
    words, nothing = (diagnosis(b.field, b.field.evaluator.local(place), 0.02) for b in (wave, known))
    assert known.proved and nothing is None and "the faces 'flat' and 'wave' touch" in words.sentence
    field = body.field
    (wall, *_), (face, other, *_) = (np.flatnonzero(field.evaluator.walls == is_wall) for is_wall in (True, False))
    words = _Place(field, field.evaluator.local(np.array([2.0, 0, 1])), 0.05)._names
    assert words([face, wall, other]) == "the faces 'blend' and 'neighbour 1'"
    assert re.fullmatch("the face 'blend' and the wall .* = 0", words([face, wall]))
    assert re.fullmatch("the wall .* = 0", words([wall]))


def test_booleans_of_meshes_go_on():
    a, b, c = (solid.ball((i, 0, 0), 1, f"ball {i}").mesh(0.05) for i in range(3))
    row = a | b | c
    assert row.is_closed and row.names == ("ball 0", "ball 1", "ball 2")
    assert row.volume == pytest.approx(3 * a.volume - 2 * (a & b).volume, rel=1e-3)
    assert (a | (b | c)).volume == pytest.approx(row.volume)
    assert (row - a - c).volume == pytest.approx(row.volume - 2 * a.volume, rel=1e-3)
    assert (row & b & a).volume == pytest.approx((a & b).volume)
    closed = pas.Mesh.from_triangles(np.asfortranarray(a.points.astype(np.float32)), a.triangles.astype(np.int32))
    assert (closed | b).volume == pytest.approx((a | b).volume, rel=1e-3)


def test_operators_between_kinds_say_what_to_do():
    ball = solid.ball((0, 0, 0), 1)
    mesh = ball.mesh(0.2)
    for mixed in (lambda: ball | mesh, lambda: mesh - ball):
        with pytest.raises(TypeError, match=r"two solids or two meshes.*take the mesh of the solid first"):
            mixed()
    with pytest.raises(TypeError, match=r"make a solid of the assembly first"):
        _ = ball & solid.assembly(ball=ball)
    with pytest.raises(TypeError, match="take two solids or two meshes, not a mesh and 3"):
        _ = mesh & 3
