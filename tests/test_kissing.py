"""Surfaces that touch in points: each is meshed, with a vertex of its own there, and they do not cross."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from pas import solid
from pas.errors import MeshError
from pas.mesh.surfaces import _pierced
from pas.mesh.topology import is_closed_manifold
from pas.solid.field import SolidField
from pas.solid.separate import contacts

BALL = solid.ball((0, 0, 0), 1, "ball")
SMALL = solid.ball((0, 0, "1/2"), "1/2", "small")
BOX = solid.box((0, 0, 0), (1, 1, 1), "box")
MIDDLE = ("1/2", "1/2", "1/2")
TOP = [(0, 0, 1)]

KISSING = {
    "a ball less one that touches it": (BALL - SMALL, 7 / 6 * pi, TOP, 2),
    "less two, which touch each other": (
        BALL - SMALL - solid.ball((0, 0, "-1/2"), "1/2", "third"), pi, [*TOP, (0, 0, 0), (0, 0, -1)], 3,
    ),
    "two balls": (BALL | solid.ball((0, 0, 2), 1, "other"), 8 / 3 * pi, TOP, 2),
    "two balls, moved": (
        (BALL | solid.ball((0, 0, 2), 1, "other")).rotate((1, 0, 0), 90).translate((3, 0, 0)),
        8 / 3 * pi, [(3, -1, 0)], 2,
    ),
    "a ball in a box": (
        BOX - solid.ball(MIDDLE, "1/2", "ball"), 1 - pi / 6,
        [(0.5 + side * 0.5 * (i == 0), 0.5 + side * 0.5 * (i == 1), 0.5 + side * 0.5 * (i == 2))
         for i in range(3) for side in (-1, 1)], 2,
    ),
    "a ball on a box": (BOX | solid.ball(("1/2", "1/2", "3/2"), "1/2", "ball"), 1 + pi / 6, [(0.5, 0.5, 1)], 2),
}  # fmt: skip


QUICK = ("a ball less one that touches it", "two balls")


@pytest.mark.parametrize("name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in KISSING])
def test_what_touches_in_points_is_meshed_surface_by_surface(name):
    shape, volume, places, pieces = KISSING[name]
    mesh = shape.mesh(1e-2)
    assert is_closed_manifold(mesh.triangles)
    assert (mesh.components, mesh.euler_characteristic) == (pieces, 2 * pieces)
    assert mesh.deviation <= 1e-2
    assert mesh.volume == pytest.approx(volume, rel=5e-2)
    assert set(mesh.names) == set(shape.faces)
    assert np.abs(shape.value(mesh.points)).max() < 1e-9
    for place in places:
        assert (np.linalg.norm(mesh.points - place, axis=1) < 1e-9).sum() == 2


@pytest.mark.parametrize(
    "first, second, expected",
    [
        (BALL, SMALL, TOP),
        (BALL, solid.ball((0, 0, 2), 1), TOP),
        (BALL, solid.ball(("3/5", "4/5", 1), 1), None),  # they cross
        (BALL, solid.ball((0, 0, "1/2"), "500001/1000000"), None),  # so they do by a millionth
        (BALL, solid.ball((0, 0, "1/2"), "499999/1000000"), ()),  # apart by as much
        (BALL, solid.half_space("z - 1"), TOP),
        (BALL, solid.cylinder((0, 0, -2), (0, 0, 2), 1), None),  # along a circle
        (solid.implicit("z - x^2 + y^2"), solid.half_space("z"), None),  # a saddle crosses its plane
        (BOX, solid.box((1, 1, 1), (2, 2, 2)), None),  # at corners
        (solid.implicit("z - x^4 - y^4"), solid.half_space("z"), None),  # too flat to say
    ],
)
def test_points_of_contact(first, second, expected):
    box = np.array([[-1.5] * 3, [1.5] * 3])
    fields = [SolidField(s.tree, box, (), np.empty((0, 3))) for s in (first, second)]
    found = contacts(fields[0].evaluator, fields[1].evaluator, fields[0].box)
    if expected is None:
        assert found is None
    else:
        assert found is not None and len(found) == len(expected)
        assert np.abs(fields[0].world(found) - np.reshape(expected, (-1, 3))).max(initial=0) < 1e-9


def test_what_touches_along_curves_is_refused():
    with pytest.raises(MeshError, match="touch"):
        (solid.cylinder((0, 0, -1), (0, 0, 1), 1) - solid.ball((0, 0, 0), 1, "ball")).mesh(2e-2)


def test_edges_that_pierce_triangles():
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]] * 5)
    ends = np.array([[(x, y, -1.0), (x, y, z)] for x, y, z in
                     ((0.2, 0.2, 1), (0.2, 0.2, -0.5), (0.8, 0.8, 1), (0.2, 0.2, 0), (0.5, 0.5, 1))])  # fmt: skip
    assert _pierced(ends, corners).tolist() == [True, False, False, True, True]
    assert _pierced(ends[:, ::-1], corners).tolist() == [True, False, False, True, True]
