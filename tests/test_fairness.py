"""Measures of fairness, on surfaces whose curvature is known, and on corners."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from conftest import ELBOW, EQUAL, UNEQUAL, fair, solved
from scipy.integrate import quad

import pas
from pas.surface.fairness_limits import largest_arc, neighbour

BOX = pas.SingleCell((-1, -2, -2), (1, 2, 2))


def revolved(text):
    """A surface of revolution about the x-axis between x = -1 and x = 1, its own neighbour on both sides."""
    return pas.PiecewiseSurface.from_polynomials(
        BOX, [pas.Contact(text, "x - 1"), pas.Contact(text, "-x - 1")], 2, [text]
    )


def integrals(radius, slope, second, third):
    """Area, bending and variation of a surface of revolution r(x), by one integral each."""

    def along(x):
        r, d, e, f = radius(x), slope(x), second(x), third(x)
        w = np.sqrt(1 + d * d)
        meridian, parallel = -e / w**3, 1 / (r * w)
        meridian_slope = (-f / w**3 + 3 * e * e * d / w**5) / w
        parallel_slope = (-d / (r * r * w) - e * d / (r * w**3)) / w
        return 2 * np.pi * r * w * np.array([1, meridian**2 + parallel**2, meridian_slope**2 + 3 * parallel_slope**2])

    return [quad(lambda x, i=i: along(x)[i], -1, 1)[0] for i in range(3)]


def test_a_straight_pipe():
    found = revolved("y^2 + z^2 - 1/9").fairness()
    assert found.sharpness == pytest.approx(1) and found.hollowness == found.arc == 0
    assert found.bulge < 0.01 and found.wrong_sign < 1e-9 and found.inflections == 0
    assert found.area == pytest.approx(4 * np.pi / 3, rel=2e-3)
    assert found.bending == pytest.approx(9 * 4 * np.pi / 3, rel=2e-3) and found.variation < 1e-12
    assert found.to_record()["hollowness"] == 0
    assert found.gradients == pytest.approx((1, 1)) and found.points >= 4000


def numbers(value):
    """All numbers of a record."""
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, tuple) else None
    return [value] if parts is None else [number for part in parts for number in numbers(part)]


@cache
def coaxial():
    """The blend of a wide pipe and a thin one that face one another."""
    return pas.blend([pas.Pipe((1, 0, 0), 1, 2), pas.Pipe((-1, 0, 0), "1/2", 2)], 1)


def flat():
    """The plane above a centre, which is its own neighbour on both sides."""
    contacts = [pas.Contact("z - 1", "x - 1"), pas.Contact("z - 1", "-x - 1")]
    return pas.PiecewiseSurface.from_polynomials(BOX, contacts, 1, ["z - 1"])


@pytest.mark.parametrize("surface", [lambda: coaxial().surface, flat, lambda: solved(EQUAL, 1).surface])
def test_measures_are_finite_numbers_of_python(surface):
    for value in numbers(surface().fairness().to_record()):
        assert type(value) in (float, int) and np.isfinite(value)


def test_limits_are_told_but_those_that_are_none():
    assert (
        pas.FairnessLimits.of_order(1).told == "sharpness 1.02, hollowness 1.6, bulge 0.05, wrong sign 0.2, waist 0.03"
    )
    blend = coaxial()
    lines = str(blend).splitlines()
    assert any(
        line.split() == ["fairness", "within", "its", "limits:", "bulge", "0.1,", "waist", "0.03"] for line in lines
    )
    assert "; sections turn nowhere" in str(blend) and not any(line.endswith(" 0.000") for line in lines)
    wall = str(blend.hollow("1/5"))
    assert "outer: GC^1, degree 4, fan of 6 half-planes around (0, 0, 1), fair\n" in wall
    assert wall.endswith("verdicts: all proved")


def test_where_no_arc_fits_there_is_no_hollowness():
    found, limits = coaxial().fairness, pas.FairnessLimits(2, 0, 1, 1)
    assert found.hollowness == 0 and found.within(limits) and found.excess(limits) == 0
    assert found.inside(limits, 3) == limits
    assert "hollowness    none: no arc fits between two neighbours\n" in str(found)
    assert "nan" not in str(found) and "hollow" not in repr(found)
    assert flat().fairness().sharpness == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("name", ["barrel", "waist"])
def test_surfaces_of_revolution(name):
    sign, text = (-1, "x^2/4 + y^2 + z^2 - 1") if name == "barrel" else (1, "y^2 + z^2 - x^2/4 - 1/4")
    c = 1.0 if name == "barrel" else 0.25  # r^2 = c + sign x^2/4
    radius = lambda x: np.sqrt(c + sign * x * x / 4)  # noqa: E731
    slope = lambda x: sign * x / 4 / radius(x)  # noqa: E731
    second = lambda x: (sign / 4 - slope(x) ** 2) / radius(x)  # noqa: E731
    third = lambda x: -3 * slope(x) * second(x) / radius(x)  # noqa: E731
    area, bending, variation = integrals(radius, slope, second, third)
    found = revolved(text).fairness()
    assert found.area == pytest.approx(area, rel=2e-3)
    assert found.bending == pytest.approx(bending, rel=5e-3)
    assert found.variation == pytest.approx(radius(1) ** 2 * variation, rel=2e-2)
    ends = max(abs(second(1) / (1 + slope(1) ** 2) ** 1.5), 1 / (radius(1) * np.sqrt(1 + slope(1) ** 2)))
    middle = max(abs(second(0)), 1 / radius(0))
    assert found.sharpness == pytest.approx(max(1, middle / ends), rel=1e-2)


def test_measures_are_those_of_the_surface_itself():
    surface = solved(UNEQUAL, 2).surface
    found = surface.fairness()
    mean, gauss = surface.curvatures(found.hollowest)
    near = [neighbour(join, float(surface.partition.frame.scale)) for join in surface.joins]
    assert largest_arc(near) == pytest.approx(1 - 2 / 5)  # pipes of radius 2/5 and 1/4: clip less the other's radius
    assert found.hollowness == pytest.approx((np.sqrt(mean**2 - gauss) - mean) * largest_arc(near))
    mean, gauss = surface.curvatures(found.sharpest)
    assert found.sharpness == pytest.approx((abs(mean) + np.sqrt(mean**2 - gauss)) / 4)
    text = str(found)
    assert f"{found.sharpness:.3f} of the sharpest neighbour" in text and f"at {found.points} points" in text
    assert json.loads(json.dumps(found.to_record()))["points"] == found.points
    beyond = found.beyond(pas.FairnessLimits.of_order(2))
    assert beyond and not found.within(pas.FairnessLimits.of_order(2))
    assert found.within(pas.FairnessLimits(*[1e9] * 5))
    assert any(word.startswith("sharpness") for word in found.beyond(pas.FairnessLimits(sharpness=0.5)))


def test_measures_do_not_depend_on_place_and_size():
    first = solved(EQUAL, 1).fairness
    corner = [pas.Pipe(a, 100, 300, (1000, 0, 7)) for a in ((0, 1, 0), (1, 0, 0), (0, 0, -1))]
    second = pas.blend(corner, 1, energy=pas.ThinPlate()).surface.fairness()
    for name in ("sharpness", "hollowness", "bulge", "wrong_sign", "variation", "bending"):
        assert getattr(second, name) == pytest.approx(getattr(first, name), rel=1e-3, abs=1e-3)
    assert second.area == pytest.approx(first.area * 300**2, rel=1e-3)


def test_what_cannot_be_measured():
    with pytest.raises(pas.GeometryError, match="rays from the centre of a region with contacts"):
        pas.PiecewiseSurface.from_polynomials(BOX, [], 1, ["x^2 + y^2 + z^2 - 1/4"]).fairness()
    with pytest.raises(pas.GeometryError, match="it is not inside the surface"):
        revolved("(y - 1)^2 + z^2 - 1/9").fairness()
    curved = [pas.Contact("y^2 + z^2 - 1/4", "x^2 + y^2 + z^2 - 1")]
    with pytest.raises(pas.GeometryError, match="no face of the region has a contact curve"):
        pas.PiecewiseSurface.from_polynomials(BOX, curved, 1, ["y^2 + z^2 - 1/4"]).fairness()


def test_limits_further_inside():
    found = fair(ELBOW, 1).fairness
    usual = pas.FairnessLimits()
    wide = replace(usual, sharpness=9, hollowness=9, bulge=9, wrong_sign=9, waist=9)
    assert found.inside(wide, 4) == wide  # nothing is beyond
    narrow = replace(wide, sharpness=found.sharpness - 0.01, bulge=found.bulge / 2 or 9)
    inner = found.inside(narrow, 4)
    assert inner.sharpness == pytest.approx(found.sharpness - 0.05)
    assert inner.bulge >= narrow.bulge / 2 and inner.hollowness == 9
