"""Closed hollows with thin walls: the two sides are proved to be apart and meshed one by one."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from pas import solid
from pas.mesh.topology import is_closed_manifold
from pas.solid.shell import shelled

BALL = solid.ball((0, 0, 0), 1)
THIN = "1/200"


def box(lower, upper, face="box"):
    """A box as lattices show it, without what is known to bound it."""
    return replace(solid.box(lower, upper, face), sheets=None)


BOX = box((0, 0, 0), (1, 1, 1), "outside")

HOLLOWS = {
    "ball": (BALL - solid.ball((0, 0, 0), "99/100", "inside"), 4 / 3 * pi * (1 - 0.99**3), 2),
    "hollow aside": (BALL - solid.ball((0, 0, "1/200"), "99/100", "inside"), 4 / 3 * pi * (1 - 0.99**3), 2),
    "box": (BOX - box((THIN,) * 3, ("199/200",) * 3, "inside"), 1 - 0.99**3, 2),
    "two hollows": (
        BOX - box((THIN,) * 3, ("1/2", "199/200", "199/200"), "a")
        - box(("101/200", "1/100", "1/100"), ("199/200", "99/100", "99/100"), "b"),
        1 - 0.495 * 0.99**2 - 0.49 * 0.98**2, 3,
    ),
}  # fmt: skip


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", HOLLOWS)
def test_walls_of_a_200th_of_the_size(name):
    shape, volume, pieces = HOLLOWS[name]
    mesh = shape.mesh(2e-3)
    assert is_closed_manifold(mesh.triangles)
    assert (mesh.components, mesh.euler_characteristic) == (pieces, 2 * pieces)
    assert mesh.deviation <= 2e-3
    assert mesh.volume == pytest.approx(volume, rel=5e-2)
    assert set(mesh.names) == set(shape.faces)
    assert np.abs(shape.value(mesh.points)).max() < 1e-9
    assert len(shape.field.shells()) == pieces


@pytest.mark.slow
def test_a_slot_across_a_bore_is_in_no_vertex_of_either():
    """Each passes through the other's sides, far from their corners: they are no surfaces apart."""
    block = box((0, 0, 0), (10, 1, 1)) - box(("4.9", "1/5", -1), ("5.1", 2, 2), "slot")
    shape = block - box((1, "1/20", "1/20"), (9, "19/20", "19/20"), "bore")
    assert len(shape.field.shells()) == 2
    mesh = shape.mesh(1e-2)
    assert is_closed_manifold(mesh.triangles) and mesh.euler_characteristic == 2
    assert mesh.volume == pytest.approx(10 - 0.16 - 8 * 0.81 + 0.2 * 0.75 * 0.9, rel=1e-2)


def test_pieces_that_bound_nothing_are_left_out():
    far = solid.ball((0, 0, 0), "1/2", "core")
    shape = BALL - solid.ball((0, 0, 0), "99/100") - far  # which is in the hollow
    assert shape.mesh(5e-3).components == 2


def test_hollows_that_pass_the_outside_are_no_surface_of_their_own():
    """The hollow's meshes cross the ball's, so that all is meshed together."""
    shape = BALL - solid.ball(("2/5",) * 3, "59/100")
    assert len(shape.field.shells()) == 2
    mesh = shape.mesh(1e-2)
    assert (mesh.components, mesh.euler_characteristic) == (1, 2)


ROUND = solid.ball((0, 0, 0), 1, "ball")
LENS = ROUND & solid.ball((0, 0, 1), 1, "other")


def lens(radius, apart):
    """The volume that two equal balls have in common."""
    return pi / 12 * (4 * radius + apart) * (2 * radius - apart) ** 2


SHELLS = {
    "ball": (ROUND, 0.01, 4 / 3 * pi * (1 - 0.99**3), 2),
    "box": (BOX, 0.005, 1 - 0.99**3, 2),
    "cylinder": (solid.cylinder((0, 0, -1), (0, 0, 1), 1, face="tin"), 0.01, 2 * pi * (1 - 0.99**3), 2),
    "sharp edge": (LENS, 0.01, lens(1, 1) - lens(0.99, 1), 2),
    "two balls": (ROUND | solid.ball((0, 0, 1), 1, "other"), 0.015, None, 2),
    "torus": (solid.torus((0, 0, 0), (0, 0, 1), 1, "1/3"), 0.0133, 2 * pi**2 * (1 / 9 - (1 / 3 - 0.0133) ** 2), 0),
}  # fmt: skip


def hollowed(shape, thickness, volume, characteristic, tolerance=None):
    hollow = shape.shell(thickness)
    mesh = hollow.mesh(tolerance)
    assert is_closed_manifold(mesh.triangles)
    assert (mesh.components, mesh.euler_characteristic) == (2, 2 * characteristic)
    assert set(mesh.names) == set(hollow.faces)
    assert np.abs(hollow.value(mesh.points)).max() < 1e-9
    if volume is not None:
        assert mesh.volume == pytest.approx(volume, rel=2e-2)  # both sides are off by up to a fifth of a wall


@pytest.mark.slow
@pytest.mark.parametrize("name", SHELLS)
def test_shells_of_a_200th_of_the_size(name):
    hollowed(*SHELLS[name])


def test_a_thin_shell_is_meshed_side_by_side_wherever_it_is_moved():
    shape = ROUND.shell(0.02).scale("1/2").rotate((1, 1, 0), 30).translate((1, 2, 3))
    mesh = shape.mesh(1.5e-3)
    assert (mesh.components, mesh.euler_characteristic, mesh.is_closed) == (2, 4, True)
    assert mesh.volume == pytest.approx(pi / 6 * (1 - 0.98**3), rel=1e-2)
    assert len(mesh.triangles) < 10_000


def test_distances_are_negative_outside():
    near = shelled(BOX, 0.1, (), 0.05).parts[-1].parts[0].function  # from x = 0
    depths = np.array([-0.2, -0.05, 0.05, 0.1, 0.3])
    places = np.stack([depths, np.full(5, 0.5), np.full(5, 0.5)], axis=1)
    values = near.jets(places)[:, 0]
    assert (np.sign(values[[0, 1, 2, 4]]) == [-1, -1, -1, 1]).all()
    assert np.abs(values - (depths - 0.1))[1:4].max() < 1e-12
    inside, outside = near.decided(places, np.full((5, 3), 0.01))
    assert (inside.tolist(), outside.tolist()) == ([True, True, True, False, False], [False] * 4 + [True])
