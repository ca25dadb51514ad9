"""Sentences about long names and numbers quote a part of them."""

from __future__ import annotations

import re

import pytest

import pas

D = "7" * 300
NAME = "t" * 400
CYLINDER = pas.elliptic_cylinder(1, 1)
POLE = pas.ParametricSurface("t", f"1/(h - {D})", "h")


def section(quadric: str, plane: str) -> pas.Boundary:
    return pas.plane_section(quadric, plane)


LONG = {
    "an empty section": lambda: section(f"x^2 + y^2 + {D}*z^2 + {D}", "z - 1"),
    "a quadric of degree 3": lambda: section(f"x^3 + {D}*y", "z"),
    "a plane of degree 2": lambda: section("x^2 + y^2 - 1", f"z^2 - {D}*x"),
    "an open section": lambda: section(f"x^2 - {D}*y^2 - 1", f"z - {D}"),
    "planes": lambda: section(f"x^2 - {D}*y^2", f"z - {D}"),
    "a section that is a line": lambda: section(f"{D}*x^2 + y*z", f"z - y/{D}"),
    "quadrics": lambda: pas.blend_quadrics(f"x^3 - {D}", "z", "x^2 + y^2 - 1", "z - 1"),
    "a length": lambda: pas.GeneratrixShape(l1=f"-{D}"),
    "pairs": lambda: pas.GeneratrixShape(l1=((D, 1), (D, 2))),
    "a slant": lambda: pas.GeneratrixShape(l1=1, l2=1, lambda1=D),
    "a radius": lambda: pas.blend_through_sphere([section("x^2 + y^2 - 1", "z - 2")] * 2, (0, 0, 0), f"-{D}"),
    "a domain": lambda: pas.ParametricSurface("t", "h", "t*h", domain=((int(D), 0), None)),
    "a domain that is none": lambda: pas.ParametricSurface("t", "h", "t*h", domain=D),
    "a domain beyond doubles": lambda: pas.ParametricSurface("t", "h", "t", domain=((int(D * 2), int(D * 3)), None)),
    "a variable": lambda: pas.ParametricSurface(NAME, "h", "t"),
    "parameters": lambda: pas.ParametricSurface("q", "h", "t", parameters=(NAME, "u")),
    "equal parameters": lambda: pas.ParametricSurface("t", "h", "t", parameters=(NAME, NAME)),
    "equal values": lambda: pas.BlendingData([CYLINDER, CYLINDER], values=[D, D]),
    "values that are none": lambda: pas.BlendingData([CYLINDER, CYLINDER], values=D),
    "a value at a pole": lambda: pas.hermite_blend(pas.BlendingData([POLE, CYLINDER], values=[D, 1]), 1),
    "a surface that is none": lambda: pas.BlendingData([CYLINDER, D]),
    "a balance": lambda: pas.weighted_blend(pas.BlendingData([CYLINDER, CYLINDER]), 1, balance=D),
    "a pole": lambda: POLE.components[1].at(0, D),
    "an iso-curve": lambda: pas.iso_curve(CYLINDER.with_domain(((-1, 1), (0, 1))), h=D),
    "a size": lambda: pas.elliptic_cylinder(f"-{D}", 1),
    "a torus": lambda: pas.torus(1, D),
    "an order": lambda: pas.hermite_blend(pas.BlendingData([CYLINDER, CYLINDER]), int(D)),
    "a denominator": lambda: pas.hermite_blend(
        pas.BlendingData([pas.ParametricSurface(f"1/(t + {D})", "h", "t"), CYLINDER]), 1
    ).all_polynomial_solutions(),
}


@pytest.mark.parametrize("what", LONG)
def test_long_values_are_shortened(what):
    with pytest.raises((ValueError, TypeError, pas.PasError)) as caught:
        LONG[what]()
    assert len(str(caught.value)) < 400
    assert max(map(len, re.findall(r"\w+", str(caught.value)))) <= 60


def test_shape_values_beyond_doubles():
    with pytest.raises(ValueError, match="shape values must not be above 1e300"):
        pas.ShapeFunction.constant("1e400")
    with pytest.raises(ValueError, match="shape values must not be above 1e300"):
        pas.ShapeFunction.through([(0, 1), (1, "1e400")])
