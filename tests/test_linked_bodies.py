"""Unions of blends' solids that go on in one another, meshed from their surfaces' meshes, beside their lattices'."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from test_sheet_bodies import is_sound

import pas
from pas import solid
from pas.solid.linked import LinkedBodies
from pas.solid.operands import Operands

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
    assert whole.sheets.size == pytest.approx(longest, rel=2e-2) == pytest.approx(6 * count, rel=2e-2)
    assert whole.scale("1/1000").sheets.size == pytest.approx(longest / 1000, rel=2e-2)
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


@pytest.mark.parametrize("offset", [(1, 0, 0), ("59/10", 0, 0), (6, "1/2", 0), (6, 0, "3/2"), (0, 0, "19/10")])
def test_bodies_that_meet_elsewhere_have_no_sheets(offset):
    """Overlapping, or with ends in one plane that are not those of one pipe."""
    assert isinstance((made() | made().translate(offset)).sheets, Operands)


def test_ends_are_those_of_one_pipe():
    """A narrower one, or a wall, does not go on from it."""
    narrower = pas.blend([pas.Pipe((-1, 0, 0), "1/2", 2), pas.Pipe(Y, "1/2", 2)], 1).solid(1).translate((6, 0, 0))
    assert isinstance((made() | narrower).sheets, Operands)
    assert isinstance((made() | narrower.translate((1, 0, 0))).sheets, LinkedBodies)


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


def exact(end):
    """How far an end is from the node's centre, in which it has a double."""
    return pas.algebra.rational.rational(max(abs(c) for c in end.center), "distance")
