"""Solids as people model them first: rounded edges, brackets with ribs and holes, lattices of struts."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import reduce
from itertools import product
from math import pi
from operator import or_

import numpy as np
import pytest

from pas import limit, solid
from pas.algebra.polynomial import Polynomial
from pas.errors import LimitError, MeshError
from pas.mesh import remesher
from pas.mesh.first import first_lattice, unsound
from pas.mesh.labelled import Labelled

HALF = Fraction(1, 2)
BLOCK = solid.box((0, 0, 0), (4, 3, 2))
ROUNDED = (1 - pi / 4) * 0.25
"""What rounding an edge to the radius 1/2 takes, over the edge's length."""


def cutter(axis, low=0, high=None):
    """What rounds the block's edge along an axis at its far corner to the radius 1/2, its ends flush with the block."""
    far = (4, 3, 2)
    start, end = ([f - HALF for f in far] for _ in range(2))
    start[axis], end[axis] = low, far[axis] if high is None else high
    ends = [*far]
    ends[axis] = end[axis]
    return solid.box(start, ends) - solid.cylinder(start, end, HALF)


def bracket(thickness, hole=Fraction(1, 4), rib=Fraction(1, 5)):
    """Two plates with a rib between them, two holes through each."""
    made = solid.box((0, 0, 0), (4, 3, thickness), face="base") | solid.box((0, 0, 0), (thickness, 3, 3), face="wall")
    sides = Fraction(3, 2) - rib / 2, Fraction(3, 2) + rib / 2
    web = solid.box((thickness, sides[0], thickness), (Fraction(5, 2), sides[1], Fraction(5, 2)), face="rib")
    made |= web.cap(Polynomial("x + z - 3"), name="slope")
    for y in (HALF, Fraction(5, 2)):
        made -= solid.cylinder((3, y, -1), (3, y, 4), hole)
    for y in (Fraction(3, 4), Fraction(9, 4)):
        made -= solid.cylinder((-1, y, 2), (4, y, 2), hole)
    return made


def bracket_volume(t, rib):
    """The volume of a bracket without its holes: of its plates, and of the rib, a square less its far corner."""
    return 12 * t + (3 - t) * 3 * t + rib * ((2.5 - t) ** 2 - 2.0**2 / 2)


@pytest.mark.sampled(10)
@pytest.mark.parametrize("tolerance", [None, 0.05])
@pytest.mark.parametrize("axes", [[0], [2], [0, 2], [1, 2], [0, 1, 2]])
def test_edges_are_rounded_by_cutters_with_flush_ends(axes, tolerance):
    shape = reduce(lambda made, axis: made - cutter(axis), axes, BLOCK)
    mesh = shape.mesh(tolerance)
    taken = sum((4, 3, 2)[axis] for axis in axes) * ROUNDED
    twice = {1: 0.0, 2: 0.125 * (5 / 3 - pi / 2)}  # of two cutters, both of which take the corner
    assert mesh.is_closed and mesh.euler_characteristic == 2
    if len(axes) in twice:
        assert mesh.volume == pytest.approx(24 - taken + twice[len(axes)], abs=2 * mesh.deviation * len(axes))
    assert sum(name.startswith("cylinder") for name in mesh.names) >= 1


@pytest.mark.parametrize("tolerance", [0.05, 0.02, 0.2])
@pytest.mark.sampled(3)
def test_brackets_with_ribs_are_meshed_with_each_tolerance(tolerance):
    thickness, rib = Fraction(1, 10), Fraction(1, 5)
    shape = bracket(thickness, rib=rib)
    mesh = shape.mesh(tolerance)
    assert mesh.is_closed and mesh.euler_characteristic == 2 - 2 * 4
    expected = bracket_volume(0.1, 0.2) - 4 * pi / 16 * 0.1
    assert mesh.volume == pytest.approx(expected, abs=4 * 0.1 * 2 * pi * 0.25 * mesh.deviation + 1e-9)


def test_where_a_rib_stands_on_plates_the_boundary_is_one_sheet():
    """The plates' planes bound the rib as well: both say on which side they are, and only the plates end there."""
    assert first_lattice(bracket(Fraction(1, 10)).field).open_share < 0.01


def test_a_lattice_of_struts_is_meshed():
    places = [(i, j, axis) for i, j in product(range(2), repeat=2) for axis in range(3)]
    ends = [[np.insert([i, j], axis, end).tolist() for end in (0, 1)] for i, j, axis in places]
    mesh = reduce(or_, (solid.cylinder(*pair, Fraction(1, 4)) for pair in ends)).mesh(0.05)
    assert mesh.is_closed and mesh.components == 1
    assert mesh.euler_characteristic == 2 - 2 * (12 - 8 + 1)  # struts less nodes, and one


def test_three_meshes_are_united_in_a_row():
    a, b, c = (solid.ball((i, 0, 0), 0.8).mesh(0.05) for i in range(3))
    mesh = a | b | c
    assert mesh.is_closed and mesh.components == 1
    assert mesh.volume == pytest.approx(3 * a.volume - 2 * (a & b).volume, rel=1e-6)
    assert (mesh - b).is_closed


TANGENT = {
    "hole": (BLOCK - solid.cylinder((HALF, 1, -1), (HALF, 1, 3), HALF), "'box x-' and 'cylinder'", "no thickness"),
    "tunnel": (BLOCK - solid.cylinder((-1, 1, 1), (5, 1, 1), 1), "'box [yz][+-]' and 'cylinder'", "no thickness"),
    "rod": (BLOCK | solid.cylinder((-HALF, 1, 0), (-HALF, 1, 2), HALF), "'box x-' and 'cylinder'", "do not overlap"),
}


@pytest.mark.parametrize("name", TANGENT)
def test_cylinders_that_touch_a_side_are_refused(name):
    shape, faces, words = TANGENT[name]
    with pytest.raises(MeshError, match=f"near .* the faces {faces} touch, and .*{words}"):
        shape.mesh()


def test_cylinders_that_touch_a_side_where_the_solid_ends_are_none_of_its_business():
    """The plane x = 0 and the cylinder touch, but the solid is on one side of both all along the line."""
    shape = BLOCK - solid.cylinder((HALF, 1, -1), (HALF, 1, 3), HALF) - solid.box((-1, HALF / 2, -1), (1, 2, 3))
    assert shape.mesh(0.05).is_closed


def test_a_wall_that_is_no_face_is_called_a_wall():
    """Of a half ball with an open end, one vertex of which is off the edge by more than rounding."""
    shape = solid.patch("ball", "x^2 + y^2 + z^2 - 1", "z")
    mesh = shape.face_mesh(0.1).mesh
    points = mesh.points.copy()
    points[np.flatnonzero(mesh.topology.label_count == 2)[0]] += 1e-5
    sentence, _ = unsound(Labelled.of(points, mesh.triangles, mesh.labels), shape.field, 0.1)
    assert "'ball' and the wall -z = 0 come close without meeting" in sentence


def test_a_cut_into_many_triangles_looks_at_the_clock(monkeypatch):
    """Before the cut, and after it: millions of triangles take seconds."""
    seen = []
    monkeypatch.setattr(remesher, "checkpoint", lambda task="": seen.append(task))
    solid.ball((0, 0, 0), 1).mesh(1e-2)
    first = next(i for i, task in enumerate(seen) if task.startswith("cutting the triangles"))
    assert seen[first + 1] == ""


@pytest.mark.slow
def test_a_cut_into_millions_of_triangles_gives_up():
    with pytest.raises(LimitError, match="gave up after"), limit(0.5):
        solid.torus((0, 0, 0), (0, 0, 1), 2, HALF).mesh(1e-5)


def bars(size, low, high):
    """Three square bars along the axes, from `low` to `high`, that cross in the middle of a cube of a given size."""
    ends = [[*((1, 2),) * axis, (low, high), *((1, 2),) * (2 - axis)] for axis in range(3)]
    return [solid.box(*zip(*sides, strict=True)) for sides in ends]


@pytest.mark.sampled(4)
@pytest.mark.parametrize("tolerance", [None, 0.1])
@pytest.mark.parametrize("flush", [True, False])
def test_square_bars_and_holes_that_cross_meet_in_corners_of_six_edges(flush, tolerance):
    low, high = (0, 3) if flush else (-1, 4)
    frame = reduce(lambda made, bar: made - bar, bars(3, low, high), solid.box((0, 0, 0), (3, 3, 3)))
    cross = solid.union(bars(3, low, high))
    for known in (frame.sheets, None):  # by meshes of the parts, and by lattices
        mesh = replace(frame, sheets=known).mesh(tolerance)
        assert mesh.is_closed and mesh.euler_characteristic == 2 - 2 * 5
        assert (len(mesh.points), mesh.volume) == (8 + 24 + 8, pytest.approx(27 - 7))
        mesh = replace(cross, sheets=known and cross.sheets).mesh(tolerance)
        assert (len(mesh.points), mesh.volume) == (24 + 8, pytest.approx(1 + 3 * (high - low - 1)))


def bend():
    """A quarter of a torus between two straight pipes."""
    quarter = solid.torus((0, 0, 0), (0, 0, 1), 2, HALF) & solid.box((0, 0, -1), (3, 3, 1))
    return solid.union(
        quarter, solid.cylinder((2, -2, 0), (2, 0, 0), HALF), solid.cylinder((-2, 2, 0), (0, 2, 0), HALF)
    )


def rounded_disc(inner=Fraction(5, 2)):
    """A disc whose upper rim is rounded by a torus; without an `inner` disc there is a pan in its middle."""
    made = solid.cylinder((0, 0, 0), (0, 0, HALF), 3) | solid.torus((0, 0, HALF), (0, 0, 1), Fraction(5, 2), HALF)
    return made | solid.cylinder((0, 0, 0), (0, 0, 1), inner) if inner else made


HALF_RING = pi / 8 * (2 * pi * 2.5)
"""The volume of the upper half of a torus of the radii 5/2 and 1/2."""

TANGENT_MODELS = {
    "bend": (bend, pi / 4 * (4 + pi)),
    "pan": (lambda: rounded_disc(0), 9 * pi / 2 + HALF_RING),
    "disc": (rounded_disc, 9 * pi / 2 + 2.5**2 * pi / 2 + pi / 16 * 2 * pi * (2.5 + 2 / (3 * pi))),
}


@pytest.mark.sampled(9)
@pytest.mark.parametrize("tolerance", [None, 0.05, 0.2])
@pytest.mark.parametrize("name", TANGENT_MODELS)
def test_faces_that_touch_along_a_plane_section_go_on_smoothly(name, tolerance):
    make, volume = TANGENT_MODELS[name]
    shape = make()
    mesh = shape.mesh(tolerance)
    assert mesh.is_closed and mesh.euler_characteristic == 2
    assert mesh.volume == pytest.approx(volume, abs=mesh.area * mesh.deviation)
    assert shape.volume(tolerance) == pytest.approx(volume, rel=4e-3)


def test_faces_that_touch_along_a_plane_section_may_cross_elsewhere():
    """Beside a straight pipe half a ring goes its way: they touch where both begin, and cross further on."""
    ring = solid.torus((0, 0, 0), (0, 0, 1), 2, HALF) - solid.box((0, -3, -1), (3, 0, 1))
    mesh = (ring | solid.cylinder((2, 0, 0), (2, 4, 0), HALF)).mesh(0.05)
    assert mesh.is_closed and mesh.euler_characteristic == 2
