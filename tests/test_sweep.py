"""Triangles on a cylinder between circles and holes: all of it is covered once, by none that is wider than a step."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from pas.mesh.sweep import between_loops
from pas.mesh.topology import euler_characteristic

AROUND, HEIGHT = 32, 10.0

HOLES = {
    "one": [(0, 3, 1, 1.5)],
    "one at the cut": [(np.pi, 3, 1, 1.5)],
    "above one another": [(0, 3, 1, 1.5), (0, 7, 1, 1.5)],
    "all around, so that each line meets one": [(k * np.pi / 2, 3 + 3.5 * (k % 2), 1, 1.5) for k in range(4)],
    "of several sizes": [(0, 3, 1, 1.5), (0.1, 6, 0.05, 0.6), (3, 8.7, 0.5, 0.7), (2, 3, 0.8, 2.5)],
}
"""Middles and semiaxes of ellipses."""


def loops_of(holes, around=40):
    angles = 2 * np.pi * np.arange(AROUND) / AROUND
    ends = [np.stack([angles, np.full(AROUND, height)], axis=1) for height in (0, HEIGHT)]
    ways = -2 * np.pi * (np.arange(around) + 0.3) / around  # clockwise: what is between has them to its right
    curves = [np.stack([a + r * np.cos(ways), h + s * np.sin(ways)], axis=1) for a, h, r, s in holes]
    flat, starts = np.concatenate([*ends, *curves]), np.cumsum([0, AROUND, AROUND, *[around] * len(holes)])
    flat[:, 0] = (flat[:, 0] + np.pi) % (2 * np.pi) - np.pi
    loops = [np.arange(a, b) for a, b in pairwise(starts)]
    return flat, (loops[0], loops[1][::-1]), loops[2:]


@pytest.mark.parametrize("case", HOLES)
def test_all_between_the_loops_is_covered_once(case):
    flat, circles, holes = loops_of(HOLES[case])
    triangles = between_loops(flat, circles, holes)
    assert euler_characteristic(triangles) == -len(holes) and {*triangles.ravel()} == {*range(len(flat))}
    corners = flat[triangles]
    corners[..., 0] = corners[:, :1, 0] + (corners[..., 0] - corners[:, :1, 0] + np.pi) % (2 * np.pi) - np.pi
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    polygons = [20 * r * s * np.sin(2 * np.pi / 40) for *_, r, s in HOLES[case]]
    assert areas.min() > 0 and areas.sum() == pytest.approx(2 * np.pi * HEIGHT - sum(polygons))
    assert np.ptp(corners[..., 0], axis=1).max() <= 2 * np.pi / AROUND * (1 + 1e-5)
    places = np.stack([np.cos(flat[:, 0]), np.sin(flat[:, 0]), flat[:, 1]], axis=1)[triangles]
    normals, middles = (
        np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]),
        places.mean(axis=1) * (1, 1, 0),
    )
    cosines = (normals * middles).sum(axis=1) / np.linalg.norm(normals, axis=1) / np.linalg.norm(middles, axis=1)
    assert cosines.min() > np.sqrt(1 / 2)  # turned by less than 45 degrees from the cylinder


def test_loops_that_meet_are_refused():
    for holes in ([(0, 3, 1, 1.5), (0.5, 3, 1, 1.5)], [(0, 1, 1, 1.5)], [(0, 3, 0.5, 1), (0, 3, 1, 2)]):
        assert between_loops(*loops_of(holes)) is None


def test_a_hole_that_goes_to_and_fro_is_refused():
    flat, circles, holes = loops_of([(0, 3, 1, 1.5)])
    top = flat[holes[0]][:, 1].argmax()
    flat[holes[0][top - 2 : top + 3], 0] *= -1
    assert between_loops(flat, circles, holes) is None
