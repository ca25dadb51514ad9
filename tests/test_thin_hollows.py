"""Closed hollows with thin walls: the two sides are proved to be apart and meshed one by one."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

import pas
from pas import solid
from pas.mesh.topology import is_closed_manifold
from pas.solid.bank import Bank
from pas.solid.separate import apart, cavities

BALL = solid.ball((0, 0, 0), 1)
THIN = "1/200"
BOX = solid.box((0, 0, 0), (1, 1, 1), "outside")

HOLLOWS = {
    "ball": (BALL - solid.ball((0, 0, 0), "99/100", "inside"), 4 / 3 * pi * (1 - 0.99**3), 2),
    "hollow aside": (BALL - solid.ball((0, 0, "1/200"), "99/100", "inside"), 4 / 3 * pi * (1 - 0.99**3), 2),
    "box": (BOX - solid.box((THIN,) * 3, ("199/200",) * 3, "inside"), 1 - 0.99**3, 2),
    "two hollows": (
        BOX - solid.box((THIN,) * 3, ("1/2", "199/200", "199/200"), "a")
        - solid.box(("101/200", "1/100", "1/100"), ("199/200", "99/100", "99/100"), "b"),
        1 - 0.495 * 0.99**2 - 0.49 * 0.98**2, 3,
    ),
}  # fmt: skip


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
    assert len(cavities(shape.tree, shape.box)) == pieces - 1


def test_pieces_that_bound_nothing_are_left_out():
    far = solid.ball((0, 0, 0), "1/2", "core")
    shape = BALL - solid.ball((0, 0, 0), "99/100") - far  # which is in the hollow
    assert shape.mesh(5e-3).components == 2


@pytest.mark.parametrize(
    "first, second, expected",
    [
        (BALL, solid.ball((0, 0, 0), "999/1000"), True),
        (BALL, solid.ball((0, 0, "1/10"), "99/100"), False),
        (BALL, solid.ball((0, 0, "1/2"), "1/2"), False),  # touches it
        (BALL, solid.box(("-1/2",) * 3, ("1/2",) * 3), True),
        (BALL, solid.box(("-3/5",) * 3, ("3/5",) * 3), False),
    ],
)
def test_surfaces_are_told_apart(first, second, expected):
    shape = first - second
    inner, outer = (type(shape.field)(s.tree, shape.box, (), np.empty((0, 3))) for s in (second, first))
    assert apart(inner.program, outer.program, shape.field.box) is expected
    assert len(shape.field.shells()) == (2 if expected else 1)


def test_polynomials_that_vanish_together_are_not_told_apart():
    sphere = pas.Polynomial("x^2 + y^2 + z^2 - 1")
    centers, half = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.9]]), np.full((1, 3), 0.1)
    wider = pas.Polynomial("x^2 + y^2 + z^2 - 2")
    assert Bank([sphere, wider]).never_both(centers, half).all()
    assert not Bank([sphere, pas.Polynomial("z - 1")]).never_both(centers, half)[0]
    assert not Bank([sphere, sphere]).never_both(centers, half).any()
