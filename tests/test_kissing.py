"""Surfaces that touch in points bound no manifold: solids of such are refused, with the faces and the place."""

from __future__ import annotations

import pytest

from pas import solid
from pas.errors import MeshError

BALL = solid.ball((0, 0, 0), 1, "ball")
SMALL = solid.ball((0, 0, "1/2"), "1/2", "small")
BOX = solid.box((0, 0, 0), (1, 1, 1), "box")

TOUCHING = {
    "two balls": (BALL | solid.ball((0, 0, 2), 1, "other"), r"\(0, 0, 1\).*'ball' and 'other' touch.*do not overlap"),
    "a ball on a box": (
        BOX | solid.ball(("1/2", "1/2", "3/2"), "1/2", "ball"),
        r"\(0.5, 0.5, 1\).*'box z\+' and 'ball' touch.*do not overlap",
    ),
    "a ball in a box": (BOX - solid.ball(("1/2",) * 3, "1/2", "ball"), "'box ..' and 'ball' touch.*no thickness"),
    "a ball less one that touches it": (BALL - SMALL, r"\(0, 0, 1\).*'ball' and 'small' touch.*no thickness"),
    "along a curve": (solid.cylinder((0, 0, -1), (0, 0, 1), 1) - solid.ball((0, 0, 0), 1, "ball"), "touch"),
}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", TOUCHING)
def test_what_touches_is_refused_with_the_faces_and_the_place(name):
    shape, sentence = TOUCHING[name]
    with pytest.raises(MeshError, match=sentence):
        shape.mesh(2e-2)
