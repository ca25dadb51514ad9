"""A body is what is joined to the blend: no far side of a torus, no other nappe, and nothing that is not proved."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import read
from flint import fmpq

import pas
from pas.algebra.rational import to_floats
from pas.contacts.joins import joins
from pas.pipeline import neighbours
from pas.pipeline.neighbours import Slab, is_left_once, kuhn, proved


def tapering():
    return [
        pas.Pipe((0, 1, 0), "1/2", 2),
        pas.Cone((1, -1, 0), "1/2", 2, slope="1/8"),
        pas.Cone((-1, -1, 0), "1/2", 2, slope="-1/8"),
    ]


@pytest.fixture(scope="module")
def bent():
    """A bent pipe, which is a torus, and two cones."""
    return read("bent")


@pytest.mark.slow
@pytest.mark.parametrize("length", ["1/2", 1])
def test_the_far_side_of_a_torus_is_no_part_of_a_body(bent, length):
    body = bent.solid(length)
    assert body.proved and not body.contains([(-4, 2.1, 0), (-4, 2.4, 0.1)]).any()
    assert body.contains([(0, 2.1, 0), (0, 2.2, 0.2), (0, 0, 0)]).all()
    mesh = body.mesh(5e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 2)


def test_a_contact_from_a_file_knows_its_curve(bent):
    """The clip plane cuts the torus in two circles, around (0, 2, 0) and (-4, 2, 0)."""
    assert bent.surface.contacts[0].near is None
    assert np.abs(to_floats(bent.surface.placed.located(0).rim.center) - np.array([0, 2, 0])).max() < 0.1


def test_a_piece_that_is_not_proved_to_be_one_is_refused(bent):
    """Within twice its major radius the tube turns round and comes back."""
    with pytest.raises(pas.GeometryError, match=r"neighbour 1 is not proved to go on in one piece for 4 beyond"):
        bent.solid(4)


@pytest.mark.slow
def test_the_other_nappe_of_a_cone_is_no_part_of_a_body(bent):
    """The third contact tapers by an eighth of its axis' unit: from 1/2 to 0 within four of them."""
    with pytest.raises(
        pas.GeometryError, match=r"neighbour 3 comes back within 7 of its clip; take a length of at most 5\.654"
    ):
        pas.blend(tapering(), 1).solid(7)
    assert pas.blend(tapering(), 1).solid(5).proved


@pytest.mark.slow
@pytest.mark.parametrize("length", ["1/2", 1])
def test_a_hollow_body_asks_no_more_of_its_cavity_than_of_its_outside(bent, length):
    """The cavity's tube is narrower, and goes on little beyond the caps."""
    wall = bent.hollow("1/8").solid(length)
    assert wall.proved
    mesh = wall.mesh(5e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, -2)


@pytest.mark.slow
def test_a_cavity_that_comes_back_is_named_with_a_length_that_works():
    hollow = pas.blend(tapering(), 1).hollow("1/8")
    assert hollow.solid(4).proved
    with pytest.raises(pas.GeometryError, match=r"inside of neighbour 3 comes back within 4\.5 .* at most 4\.173"):
        hollow.solid("9/2")
    assert hollow.solid("4173/1000").proved


def test_six_tetrahedra_fill_a_frustum():
    corners = ((-1, -1), (-1, 1), (1, 1), (1, -1))
    quads = [[tuple(fmpq(c) for c in (s * x, s * y, s)) for x, y in corners] for s in (1, 3)]
    tetrahedra = [np.array([to_floats(p) for p in t]) for t in kuhn(quads)]
    volumes = [abs(np.linalg.det(t[1:] - t[0])) / 6 for t in tetrahedra]
    assert sum(volumes) == pytest.approx(4 * (27 - 1) / 3) and min(volumes) > 0


def test_claims_on_simplices_are_decided():
    triangle = [tuple(map(fmpq, p)) for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0))]
    f = pas.Polynomial("x + y + 1/10")
    assert proved((f, ()), [triangle]) and not proved((f - pas.Polynomial("1/5"), ()), [triangle])
    assert proved((f - pas.Polynomial("1/5"), (pas.Polynomial("1/5 - x"),)), [triangle])


TUBE = "x^2 + y^2 - 1"


def slab(text, length=1):
    """What is over the plane z = 0 up to a height, of a surface that a square of that plane is cut by."""
    corners = [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)]
    cells = [(0, 1, 2, 4), (0, 2, 3, 4)]
    partition = pas.Partition([*corners, (0, 0, -3)], cells, None, [(0, 1)])
    join = joins(partition, [pas.Contact(text, "z")])[0]
    return Slab(join, fmpq(length))


@pytest.mark.parametrize(
    ("text", "one"),
    [
        (TUBE, True),
        (f"({TUBE})*((x - 5)^2 + y^2 + (z - 1/2)^2 - 1/9)", True),  # a ball far away
        (f"({TUBE})*((x - 3/2)^2 + y^2 + (z - 1/2)^2 - 1/100)", False),  # a ball inside the wall
        (f"({TUBE})*((x - 9/4)^2 + y^2 + (z - 1/2)^2 - 1/100)", False),  # one on the wall
        (f"({TUBE})*((x - 9/4)^2 + y^2 - z^2/100 - 1/1000)", False),  # a tube on the wall, which meets all sections
        (f"({TUBE})*((x - 7/4)^2 + (y - 7/4)^2 - 1/100)", True),  # outside of the wall
        (f"({TUBE})*((x - 21/10)^2 + (y - 0)^2 - 1/500)", False),  # inside of it, and beside the clip faces
        (f"({TUBE})*(x^2 + y^2 - z + 1/2)", False),  # sections become rings
        (f"({TUBE})*((x + z - 11/4)^2/2 + y^2 - 1/100)", False),  # a tube that comes in through the wall
    ],
)
def test_each_claim_is_needed(text, one):
    """With a wall of radius 9/4 around the tube."""
    assert slab(text).is_one_piece(fmpq(9, 4)) == one


def test_the_wall_is_inside_the_box_in_which_it_is_looked_at(monkeypatch):
    monkeypatch.setattr(neighbours, "BEYOND", fmpq(1, 2))
    assert not slab(TUBE).is_one_piece(fmpq(9, 4))


def quad(height, wide=1):
    return [tuple(fmpq(c) for c in (x * height * wide, y * height * wide, height)) for x, y in CORNERS]


CORNERS = ((-1, -1), (-1, 1), (1, 1), (1, -1))
CONE = pas.Polynomial("4*x^2 + 4*y^2 - z^2")


@pytest.mark.parametrize(
    ("text", "wide", "once"),
    [
        ("z - 2", 1, True),
        ("x^2 + y^2 + z^2 - 4", 1, True),
        ("(z - 2)*(z - 9/4)*(z - 5/2)", 1, False),  # three times
        ("z - 4", 1, False),  # not below the roof
        ("z - 1/2", 1, False),  # below the floor
        ("(z - 3/2)*(z - 5/2)", 1, False),  # begins outside
        ("z - 2", "1/4", False),  # the cone is wider
    ],
)
def test_rays_leave_once(text, wide, once):
    assert is_left_once(pas.Polynomial(text), CONE, quad(1, fmpq(wide)), quad(3, fmpq(wide))) == once
