"""Measures of solids: volume, area, centre and moments against closed formulas, and lists of parts."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest

import pas
from pas import solid
from pas.solid.measures import PartList

PI = math.pi
EXACT = {
    "box": (solid.box((1, 2, 3), (3, 5, 4)), 6, 22, (2, 3.5, 3.5), (5, 2.5, 6.5)),
    "ball": (solid.ball((5, 0, 1), 2), 32 * PI / 3, 16 * PI, (5, 0, 1), (32 * PI / 3 * 8 / 5,) * 3),
    "cylinder": (solid.cylinder((0, 0, 0), (0, 0, 3), 1), 3 * PI, 8 * PI, (0, 0, 1.5), (3 * PI, 3 * PI, 1.5 * PI)),
    "cone": (solid.cone((0, 0, 0), (0, 0, 4), 3), 12 * PI, 24 * PI, (0, 0, 1), (23.4 * PI, 23.4 * PI, 32.4 * PI)),
    "torus": (
        *(solid.torus((0, 1, 0), (0, 0, 1), 3, 1), 6 * PI**2, 12 * PI**2, (0, 1, 0)),
        (30.75 * PI**2, 30.75 * PI**2, 58.5 * PI**2),
    ),
}
"""Solids with their volume, area, centre and moments of inertia about it."""


@pytest.mark.parametrize("name", EXACT)
def test_measures_are_within_what_they_say(name):
    shape, volume, area, center, moments = EXACT[name]
    found = shape.measures(0.02)
    assert (shape.volume(0.02), shape.area(0.02)) == (found.volume, found.area)
    size = np.ptp(shape.box, axis=0).max()
    errors = (
        abs(found.volume / volume - 1),
        abs(found.area / area - 1),
        np.abs(found.center - center).max() / size,
        np.abs(found.inertia - np.diag(moments)).max() / sum(moments),
    )
    assert max(errors) <= max(found.within, 1e-12)
    assert found.within < 0.05
    assert (found.within < 1e-12) == (name == "box")


def test_parts_are_listed_with_their_sum(tmp_path):
    box = solid.box((0, 0, 0), (1, 1, 1))
    parts = solid.assembly(left=box, right=box.translate(3, 0, 0).mesh())
    found = parts.part_list()
    assert [*found] == ["left", "right"]
    assert found.whole.volume == pytest.approx(2)
    np.testing.assert_allclose(found.whole.center, (2, 0.5, 0.5))
    np.testing.assert_allclose(found.whole.inertia, np.diag([1 / 3, 1 / 3 + 4.5, 1 / 3 + 4.5]), atol=1e-12)
    moments, axes = found.whole.principal
    np.testing.assert_allclose(moments, [1 / 3, 1 / 3 + 4.5, 1 / 3 + 4.5])
    np.testing.assert_allclose(np.abs(axes[:, 0]), (1, 0, 0), atol=1e-12)
    lines = str(found).splitlines()
    assert [line.split()[0] for line in lines] == ["part", "left", "right", "all"]
    with parts.write(tmp_path / "parts.csv", unit="mm").open(encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    assert rows[0] == [*PartList.HEADS[:1], "volume (mm^3)", "area (mm^2)", *rows[0][3:]]
    assert [row[0] for row in rows[1:]] == ["left", "right"]
    assert [float(value) for value in rows[1][1:]] == pytest.approx([*found.rows[0][1:]])


def test_lists_of_parts_are_of_bodies(tmp_path):
    ball = solid.ball((0, 0, 0), 1)
    path = ball.write(tmp_path / "ball.csv", tolerance=0.1)
    assert float(path.read_text().splitlines()[1].split(",")[1]) == ball.volume(0.1)
    with pytest.raises(TypeError, match=r"measures are those of solids, closed meshes and assemblies, not .*surface"):
        pas.torus(2, 1, angle=True).write(tmp_path / "torus.csv")
    assert [p.name for p in tmp_path.iterdir()] == ["ball.csv"]
