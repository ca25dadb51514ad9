"""Threads of screws: their points are those of a section that turns and rises, their meshes are closed."""

from __future__ import annotations

import re
from contextlib import suppress
from fractions import Fraction

import numpy as np
import pytest
from test_step import read_solids

import pas
from pas import solid
from pas.solid.thread import Flank

with suppress(ImportError):  # tests of these ask for Open Cascade
    from pas.exchange.step.model import adaptive_volume, step_part

M8 = 8, "1.25"


def section(height, pitch=1.25, crest=4.0):
    """The distance from the axis at angle 0 and heights (N,): ISO 68-1, drawn by its corners."""
    off = (height / pitch + 0.5) % 1 - 0.5
    depth = 5 / 8 * np.sqrt(3) / 2 * pitch
    return np.interp(np.abs(off), [1 / 16, 3 / 8], [crest, crest - depth])


def test_points_are_those_of_the_section_that_turns_and_rises():
    made = solid.thread(*M8, 6)
    random = np.random.default_rng(0)
    r, angle, z = random.uniform(0, 4.3, 5000), random.uniform(-np.pi, np.pi, 5000), random.uniform(0, 6, 5000)
    inside = made.contains(np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1))
    bound = section(z - 1.25 * angle / (2 * np.pi))
    clear = np.abs(r - bound) > 1e-9
    assert (inside == (r < bound))[clear].all() and 2000 < inside.sum() < 4900


@pytest.mark.parametrize(
    ("diameter", "pitch", "length"),
    [
        (8, "1.25", 20),
        (8, "1.25", "0.3"),
        (8, "1.25", "1.25"),
        (3, "1/2", 5),
        ("1.6", "0.35", 3),
        (30, "3.5", 7),
        (4, 3, 9),
    ],
)
def test_meshes_are_closed_and_their_volume_is_that_of_the_section(diameter, pitch, length):
    made = solid.thread(diameter, pitch, length)
    mesh = made.mesh()
    assert mesh.is_closed and mesh.components == 1 and mesh.euler_characteristic == 2
    p, crest, high = (float(Fraction(x)) for x in (pitch, diameter, length))
    angle, z = np.meshgrid(np.linspace(0, 2 * np.pi, 400, endpoint=False), (np.arange(400) + 0.5) * high / 400)
    volume = np.mean(section(z - p * angle / (2 * np.pi), p, crest / 2) ** 2) * np.pi * high
    assert made.volume() == pytest.approx(volume, rel=2e-4)
    assert len(made.faces) == 5 and made.faces[1] == "thread crest"


def test_flanks_change_no_faster_than_lengths_and_have_their_gradients():
    flank, random = Flank(*M8), np.random.default_rng(2)
    one = random.uniform(-4.5, 4.5, (4000, 3))
    for step in (0.01, 0.3, 3.0):
        other = one + random.normal(size=one.shape) * step
        change = np.abs(flank.jets(one)[:, 0] - flank.jets(other)[:, 0])
        assert (change <= np.linalg.norm(one - other, axis=1) + 1e-12).all()
    r = np.hypot(one[:, 0], one[:, 1])
    off = np.abs(flank.off(one))
    smooth = one[(r > flank.root) & (off > 0.01) & (off < 0.61)]
    h = 1e-6
    slopes = np.stack([(flank.jets(smooth + h * e) - flank.jets(smooth - h * e))[:, 0] / (2 * h) for e in np.eye(3)], 1)
    assert len(smooth) > 1000 and np.abs(slopes - flank.jets(smooth)[:, 1:]).max() < 1e-6


def test_screws_and_nuts_are_made_of_them():
    head = solid.regular_polygon(6, "7.5")
    screw = head.extrude(5).translate(0, 0, -5) | solid.thread(*M8, 10)
    nut = head.extrude(6) - solid.thread("8.2", "1.25", 10).translate(0, 0, -2)
    assert screw.mesh(0.05).euler_characteristic == 2 and nut.mesh(0.05).euler_characteristic == 0
    assert "thread flank" in nut.mesh(0.05).names
    left = solid.thread(*M8, 4).mirror((1, 0, 0))
    turned = np.array([[-3.9 * np.cos(a), 3.9 * np.sin(a), 1.25 * a / (2 * np.pi) + 1.25] for a in (0, 1, 2, 3)])
    assert left.contains(turned).all() and not left.contains(turned + [0, 0, 0.6]).any()
    assert left.mesh(0.05).volume == pytest.approx(solid.thread(*M8, 4).mesh(0.05).volume)


def test_threads_are_saved_and_read(tmp_path):
    made = solid.thread(*M8, 3).rotate((1, 2, 0), 30)
    read = pas.load(made.save(tmp_path / "a.pas.json"))
    points = np.random.default_rng(1).uniform(-5, 5, (2000, 3))
    assert (read.contains(points) == made.contains(points)).all() and read.faces == made.faces


@pytest.mark.parametrize(
    "name", [*(pytest.param(n, marks=pytest.mark.slow) for n in ("bolt", "nut", "left-handed")), "short"]
)
def test_threads_are_written_as_step(name, tmp_path):
    pytest.importorskip("OCP")
    made = {
        "bolt": lambda: solid.regular_polygon(6, 7).extrude(2).translate(0, 0, -2) | solid.thread(*M8, 4),
        "nut": lambda: solid.regular_polygon(6, 7).extrude(3) - solid.thread("8.2", "1.25", 6).translate(0, 0, -2),
        "left-handed": lambda: solid.thread(*M8, 3).mirror((1, 0, 0)).rotate((1, 2, 2), 40).scale(100),
        "short": lambda: solid.thread(*M8, "3/10"),
    }[name]()
    report = step_part(made, name).report
    assert report.faces - report.exact == 2 and report.distance < 1e-5 * np.ptp(made.box, axis=0).max()
    ((solid_,), kinds) = read_solids(made.write(tmp_path / "a.step"))  # it is read again and checked
    assert kinds["BSplineSurface"] == 2 and {*kinds} == {"BSplineSurface", "CylindricalSurface", "Plane"}
    assert adaptive_volume(solid_) == pytest.approx(made.volume(), rel=1e-3)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ((8, 0, 3), "pitch must be positive, not 0"),
        ((8, "1.25", -1), "length must be positive, not -1"),
        ((-8, 1, 3), "diameter must be positive"),
        ((2, 2, 3), "pitch must be below 1.50"),
    ],
)
def test_what_is_no_thread_is_told(numbers, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        solid.thread(*numbers)
