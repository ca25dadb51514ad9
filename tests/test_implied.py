"""Conditions that others imply: which these are, and meshes of solids whose faces meet by threes in a curve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pas import MeshError, solid
from pas.solid.field import SolidField, without_implied
from pas.solid.tree import atoms


def unbounded(shape):
    """A solid as lattices show it, without what is known to bound it."""
    return replace(shape, sheets=None)


CUBE = unbounded(solid.box((-1, -1, -1), (1, 1, 1)))
CUBIC = solid.implicit("z - x^3")


FINE = 1e-3


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("g", "h", "k", "expected"),
    [
        ("z - 1", "x - 1", "z - x^3", True),
        ("1/2 - x", "1/8 - z", "z - x^3", True),
        ("x + y - 1", "x - 1/2", "y - 1/2", True),
        ("x*y - 1/4", "x - 1/2", "y - 1/2", True),
        ("z - 99/100", "x - 1", "z - x^3", False),
        ("1 - z", "x - 1", "z - x^3", False),
        ("z - 9/10", "1/2 - x", "z - x^3", False),
        ("x - 3/4", "y - 1/2", "z - x^3", False),
        ("z - 1/8", "x - 1/2", "x^3 - z", False),
        ("x - y", "x - 1/2", "1/4 - y", False),
    ],
)
def test_what_is_implied_in_the_unit_cube(g, h, k, expected):
    """That g <= 0 where h <= 0 and k <= 0, in the unit cube."""
    room = np.array([[2.0 / 9] * 3, [7.0 / 9] * 3])  # 0.4 of its sides more make it the unit cube
    for order in ((g, h, k), (k, g, h), (h, k, g)):
        parts = [solid.implicit(text, face=text) for text in order]
        left = without_implied(solid.intersection(*parts).tree, room, FINE)
        assert (g not in [atom.face for atom in atoms(left)]) is expected


SOLIDS = {
    "below": (CUBE & CUBIC, 4),
    "above": (CUBE - CUBIC, 4),
    "along the other axis": (CUBE & solid.implicit("z - y^3"), 4),
    "beside": (unbounded(solid.box((-1, 0, -1), (1, 2, 1))) & CUBIC, 4),
    "moved and larger": ((CUBE & CUBIC).scale(3).translate((7, "1/3", -2)).mirror((1, 0, 0)), 4 * 27),
    "by inequalities": (solid.implicit("z - x^3", "1 - x", "1 + x", "1 - y", "1 + y", "1 + z", "1 - z"), 4),
    "with a hole": ((CUBE & CUBIC) - unbounded(solid.cylinder((0, 0, -2), (0, 0, 2), "1/2", "hole")), 4 - np.pi / 4),
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", SOLIDS)
def test_three_faces_that_meet_in_a_curve_where_two_are_enough(name):
    shape, volume = SOLIDS[name]
    extent = float(np.ptp(shape.box, axis=0).max())
    mesh = shape.mesh(1e-2 * extent)
    assert mesh.is_closed
    assert mesh.components == 1
    assert mesh.volume == pytest.approx(volume, rel=5e-3)
    assert mesh.deviation <= 1e-2 * extent
    assert set(mesh.face_areas) <= {*shape.faces, *(f for f in mesh.face_areas if f.endswith(" = 0"))}


@pytest.mark.sampled(7)
@pytest.mark.parametrize("name", SOLIDS)
def test_without_what_is_implied_it_is_the_same_set(name):
    shape, _ = SOLIDS[name]
    field = shape.field
    rest = field.needed(FINE)
    assert rest is not field
    low, high = field.box
    points = np.random.default_rng(1).uniform(low - 0.2 * (high - low), high + 0.2 * (high - low), (20_000, 3))
    inside = field.inside(field.signs(points))
    assert inside.any()
    assert np.array_equal(inside, rest.inside(rest.signs(points)))
    assert rest.scale == field.scale


def test_what_is_left_out():
    shape = CUBE & CUBIC
    names = [atom.face for atom in atoms(without_implied(shape.tree, shape.box, FINE))]
    assert names == ["box x+", "box y-", "box y+", "box z-", "surface"]
    both = shape | solid.ball(("3/2", 0, 0), "1/4")
    assert [atom.face for atom in atoms(without_implied(both.tree, both.box, FINE))] == [*names, "ball"]


@pytest.mark.parametrize(
    "shape",
    [
        CUBE,
        solid.ball((0, 0, 0), 1),
        CUBE & solid.implicit("z - x^3 - 1/2"),
        CUBE - solid.ball((1, 1, 1), 1),
        solid.cylinder((0, 0, 0), (0, 0, 1), 1) | CUBE,
    ],
    ids=["box", "ball", "crossing", "corner cut out", "union"],
)
def test_what_is_needed_is_kept(shape):
    assert shape.field.needed(FINE) is shape.field
    assert without_implied(shape.tree, shape.box, FINE) == shape.tree


def test_what_stays_undecided_is_kept():
    """The set without the plane meets boxes along an edge, however small these are."""
    shape = CUBE & CUBIC
    assert without_implied(shape.tree, shape.box, 1e-9) == shape.tree


def test_small_hollows_are_no_condition_that_others_imply():
    """No sample need be in them: boxes that cover all of the solid are looked at."""
    mesh = (CUBE & CUBIC - solid.ball(("0.313", "-0.217", "-0.513"), "0.02", "hollow")).mesh(1e-2)
    assert mesh.is_closed and mesh.components == 2 and "hollow" in mesh.names


def test_what_only_seems_to_be_implied_is_not_left_out_of_a_mesh(monkeypatch):
    """Without the plane the mesh is of a larger set, so that the first refusal stands."""
    shape = (CUBE - CUBIC) & solid.half_space("x - 1/2", "cut")
    wrong = (CUBE - CUBIC).field.needed(FINE)
    monkeypatch.setattr(SolidField, "needed", lambda self, within: wrong)
    with pytest.raises(MeshError, match=r"'box x.', 'box z.' and 'surface' touch, or meet in one curve"):
        shape.mesh(2e-2)


def test_a_refusal_names_all_faces_that_meet():
    """A wedge in a direction in which its edge is too sharp for a lattice: the first refusal says more."""
    shape = (CUBE & solid.half_space("z - 5*x + 4")).mirror((1, 2, 0))
    assert shape.field.needed(FINE) is not shape.field
    with pytest.raises(MeshError, match=r"the faces 'box x.', 'box z.' and 'plane' touch, or meet in one curve"):
        shape.mesh(5e-2)
