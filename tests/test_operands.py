"""Solids with rounds, and others that sheets bound, after set operations: meshed from their parts' meshes."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from pas import solid
from pas.errors import GeometryError, MeshError
from pas.mesh.closed import _bounding
from pas.mesh.diagnostics import diagnosis
from pas.mesh.labelled import Labelled
from pas.solid.operands import Operands


def soft(order=1):
    return solid.box((0, 0, 0), (40, 30, 10)).rounded(radius=2, order=order)


def upright(x, y, radius=5, low=-1, high=11):
    return solid.cylinder((x, y, low), (x, y, high), radius, face="hole")


CASES = {
    "a hole": (lambda: soft() - upright(20, 15), 0),
    "a hole through a round": (lambda: soft() - upright(39, 15), 2),
    "a hole through a corner": (lambda: soft(2) - upright(39, 29), 2),
    "a bore along a round": (lambda: soft() - solid.cylinder((-1, 1, 5), (41, 1, 5), 2, face="hole"), 2),
    "holes in a pattern": (lambda: soft() - upright(5, 5, 1).pattern(4, (10, 0, 0)), -6),
    "bores that cross": (lambda: soft() - upright(20, 15, 2) - solid.cylinder((-1, 15, 5), (41, 15, 5), 2), -4),
    "a boss over a round": (lambda: soft() | upright(38, 15, 5, 8, 15), 2),
    "a block flush with the top": (lambda: soft() | solid.box((30, 5, 0), (60, 20, 10)), 2),
    "raised letters": (lambda: soft() | solid.text("l", size=10).extrude(2).translate((15, 10, 10)), 2),
    "two that meet": (lambda: soft() | soft().translate((35, 25, 5)), 2),
    "two in common": (lambda: soft() & soft().translate((20, 11, 5)), 2),
    "two a little apart": (lambda: soft() | soft().translate((0, 0, "10.001")), 4),
    "the same twice": (lambda: soft() | soft(), 2),
    "half of it": (lambda: soft() - solid.half_space("z - 5", face="cut"), 2),
    "rounded afterwards": (lambda: (solid.box((0, 0, 0), (40, 30, 10)) - upright(20, 15)).rounded(radius=2), 0),
    "moved": (lambda: (soft() - upright(20, 15)).rotate((1, 2, 3), 33).translate(1000, 0, 0), 0),
    "a plate of a profile": (lambda: solid.rounded_rectangle(40, 30, 3).extrude(10) - upright(20, 15), 0),
}


@pytest.mark.sampled(16)
@pytest.mark.parametrize("name", CASES)
def test_closed_with_the_topology_and_the_volume(name):
    make, euler = CASES[name]
    made = make()
    mesh = made.mesh()
    assert isinstance(made.sheets, Operands) or name == "the same twice"
    assert mesh.is_closed and mesh.euler_characteristic == euler
    low, high = made.box
    points = low + np.random.default_rng(1).random((40_000, 3)) * (high - low)
    inside = np.prod(high - low) * made.contains(points).mean()
    spread = np.prod(high - low) / 2 / 200
    assert abs(inside - mesh.volume) < 4 * spread + mesh.deviation * mesh.area


@pytest.mark.slow
def test_volume_of_a_drilled_rounded_box():
    """Steiner's formula, less a cylinder."""
    r, a, b, c = 2.0, 36.0, 26.0, 6.0
    whole = a * b * c + 2 * r * (a * b + b * c + c * a) + np.pi * r * r * (a + b + c) + 4 / 3 * np.pi * r**3
    made = soft() - upright(20, 15)
    assert made.volume(1e-2) == pytest.approx(whole - np.pi * 25 * 10, rel=1e-6)
    assert made.proved


def test_faces_of_what_is_taken_away_look_into_it():
    """On the mesh that the parts' meshes make, each function rises out of the solid."""
    made = soft() - solid.box((10, 10, 5), (20, 20, 20)).rounded(radius=1)
    cut = made.sheets._cut(made.field, 0.5, 1)
    a, b, c = np.moveaxis(cut.points[cut.triangles], 1, 0)
    slopes = made.field.jets((a + b + c) / 3, cut.faces)[:, 1:]
    assert ((slopes * np.cross(b - a, c - a)).sum(axis=1) > 0).all()


@pytest.mark.slow
def test_rounded_twice():
    """Two edges that do not meet, each with a quarter of a circle instead of a square."""
    once = solid.box((0, 0, 0), (4, 3, 2)).rounded(["box x+", "box y+"], radius="1/4")
    twice = once.rounded(["box z+", "box x-"], radius="1/8")
    assert twice.proved and {*twice.mesh().names} == {*twice.faces}
    assert twice.volume(1e-3) == pytest.approx(24 - (1 - np.pi / 4) * (2 / 16 + 3 / 64), rel=1e-6)


def test_cut_through_points_where_four_faces_meet():
    """The plane passes through two ends of a round's lines."""
    made = soft() & solid.half_space("x + y + z - 50", face="cut")
    mesh = made.mesh()
    assert mesh.is_closed and "cut" in mesh.names
    for corner in ((40, 2, 8), (38, 2, 10)):
        assert np.linalg.norm(mesh.points - np.array(corner), axis=1).min() < 1e-6


def test_corners_of_smooth_faces_are_no_trouble_for_a_lattice():
    shape = replace(soft(), sheets=None)
    mesh = shape.mesh()
    assert mesh.is_closed and {*mesh.names} == {*soft().faces}
    found = shape.face_mesh().mesh
    found = diagnosis(shape.field, found.points[found.topology.label_count > 2], 1e-2)
    assert found is None or not found.stays


def test_what_touches_is_refused_by_name():
    with pytest.raises((GeometryError, MeshError), match="'box x\\+' and 'hole' touch"):
        (soft() - upright(35, 15)).mesh()


def test_a_mesh_that_is_not_all_of_the_boundary_is_known():
    """That of one part of a union is no mesh of both, nor is one with another label."""
    made = soft() - upright(20, 15)
    mesh, field = made.face_mesh().mesh, made.field
    assert _bounding(mesh, field, 1e-3)
    turned = Labelled.of(mesh.points, mesh.triangles, mesh.labels ^ 1)
    assert not _bounding(turned, field, 1e-3)
    plain = soft().face_mesh(1e-2).mesh
    labels = field.labels_of(soft_field := soft().field, plain.labels)
    moved = Labelled.of(field.evaluator.local(soft_field.world(plain.points)), plain.triangles, labels)
    assert _bounding(plain, soft_field, 1e-3) and not _bounding(moved, (made - upright(8, 8)).field, 1e-3)


CONES = [
    ((9, 1, 3), (2, 5, 1), "1/2"),
    ((0, 2, 2), (7, 7, 3), 1),
    ((3, 3, 3), (4, 7, 9), "6/5"),
    ((0, 0, 0), (0, 0, 9), 1),
]


@pytest.mark.parametrize(("start", "end", "radius"), CONES)
@pytest.mark.parametrize("tolerance", [3e-2, 3e-3])
def test_cones_in_any_position_have_their_apex(start, end, radius, tolerance):
    mesh = solid.cone(start, end, radius).mesh(tolerance)
    assert mesh.is_closed and np.linalg.norm(mesh.points - np.array(end), axis=1).min() < 1e-9
    exact = np.pi / 3 * float(Fraction(radius)) ** 2 * np.linalg.norm(np.subtract(end, start))
    assert exact * (1 - 3 * tolerance / float(Fraction(radius))) < mesh.volume <= exact
    even = solid.cone(start, end, radius).mesh(tolerance, quality="angles")
    assert even.is_closed and np.linalg.norm(even.points - np.array(end), axis=1).min() < 1e-9


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("axis", "angle"), [((-2, 3, 3), 200), ((-2, 1, 2), 321), ((0, -2, -2), 136)])
def test_a_face_that_covers_another_one_in_its_plane_is_not_lost(axis, angle):
    """Once turned, which of both is in front is rounding."""
    plate = solid.rounded_rectangle(40, 30, 5, face="plate").extrude(5)
    part = plate | solid.box((10, 10, 5), (20, 20, 9), "boss")
    mesh = part.rotate(axis, angle).mesh()
    assert mesh.is_closed and mesh.euler_characteristic == 2
    assert mesh.volume == pytest.approx(5 * (1200 - 25 * (4 - np.pi)) + 400, rel=1e-3)


def cube(x, y, z, size=2):
    return solid.box((x, y, z), (x + size, y + size, z + size))


def test_operands_of_operands_are_one_list():
    """Of what was made in one way, in one step; of what is taken away a union is several."""
    a, b, c, d = (cube(k, 0, 0) for k in range(4))

    def steps(made):
        return [(step.read, step.operation, step.many) for step in made.sheets.steps]

    assert steps((a | b) | (c | d)) == steps(a | b | c | d) == [(4, "Add", 4)]
    assert steps(a & (b & c)) == [(3, "Intersect", 3)]
    assert steps(a - (b | c)) == steps(a - b - c) == [(3, "Subtract", 3)]
    assert steps(a - (b - c)) == [(3, "Subtract", 2), (3, "Subtract", 2)]
    assert steps((a | b) - c | d) == [(2, "Add", 2), (3, "Subtract", 2), (4, "Add", 2)]
    assert steps((a - b) | (c - d)) == [(2, "Subtract", 2), (4, "Subtract", 2), (4, "Add", 2)]
    assert (a - (b - (c | d))).sheets.turned == [0, 1, 0, 0] and (a - b - c).sheets.turned == [0, 1, 1]


@pytest.mark.parametrize("seed", range(6))
def test_what_operations_in_any_order_make(seed):
    """Of cubes, the volume is that of the cells of a grid that are inside, and faces look outwards."""
    rng = np.random.default_rng(seed)
    some = [(cube(*place), np.array(place)) for place in rng.integers(0, 3, (6, 3)).tolist()]
    cells = np.indices((5, 5, 5)).reshape(3, -1).T
    sets = [(shape, ((cells >= low) & (cells < low + 2)).all(axis=1)) for shape, low in some]
    while len(sets) > 1:
        (one, here), (other, there) = (sets.pop(int(rng.integers(len(sets)))) for _ in range(2))
        ways = [(one | other, here | there), (one & other, here & there), (one - other, here & ~there)]
        sets.append(next(way for way in [ways[int(rng.integers(3))], ways[0]] if way[1].any()))
    made, inside = sets[0]
    cut = made.sheets._cut(made.field, 0.1, 4)
    a, b, c = np.moveaxis(made.field.world(cut.points)[cut.triangles], 1, 0)
    assert (a * np.cross(b, c)).sum() / 6 == pytest.approx(inside.sum())
    slopes = made.field.jets(made.field.evaluator.local((a + b + c) / 3), cut.faces)[:, 1:]
    assert ((slopes * np.cross(b - a, c - a)).sum(axis=1) > 0).all()
