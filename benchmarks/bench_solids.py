"""Solids: meshes of bodies made of exact surfaces, beside booleans of meshes.

The peer has booleans of prisms with as many sides as the tolerance asks for: no exact faces.
"""

from __future__ import annotations

import tempfile
from functools import partial
from math import acos, ceil, pi
from pathlib import Path
from typing import Any

from measured import Prepare, Work, measured
from reference_cases import bars, gear

import pas
from pas import solid

HOLES = [(x, y) for x in range(-4, 5, 2) for y in (-2, 0, 2)]
TOLERANCE, HOLLOW_TOLERANCE = 1e-3, 4e-3


def plate() -> Work:
    """A plate with holes, made and meshed."""

    def work() -> Any:
        body = solid.box((-5, -3, 0), (5, 3, 1))
        for x, y in HOLES:
            body = body - solid.cylinder((x, y, -1), (x, y, 2), "1/2")
        return body.mesh(TOLERANCE)

    return work


def plate_of_meshes() -> Work:
    """The plate of meshes."""
    import manifold3d

    sides = ceil(pi / acos(1 - TOLERANCE / 0.5))

    def work() -> Any:
        body = manifold3d.Manifold.cube((10, 6, 1)).translate((-5, -3, 0))
        for x, y in HOLES:
            body = body - manifold3d.Manifold.cylinder(3, 0.5, 0.5, sides).translate((x, y, -1))
        return body.to_mesh()

    return work


def crossing() -> Work:
    """Two equal cylinders."""
    first, second = ((-2, 0, 0), (2, 0, 0)), ((0, -2, 0), (0, 2, 0))
    return lambda: (solid.cylinder(*first, 1) & solid.cylinder(*second, 1)).mesh(TOLERANCE)


def crossing_of_meshes() -> Work:
    """The cylinders of meshes."""
    import manifold3d

    sides = ceil(pi / acos(1 - TOLERANCE))

    def work() -> Any:
        pipe = manifold3d.Manifold.cylinder(4, 1, 1, sides).translate((0, 0, -2))
        return (pipe.rotate((0, 90, 0)) ^ pipe.rotate((90, 0, 0))).to_mesh()

    return work


def body(make: Any, tolerance: float) -> Prepare:
    """A mesh of a solid that is made afresh each time, its making included."""
    return lambda: lambda: make().mesh(tolerance)


def teapot(style: str, part: str, tolerance: float) -> Prepare:
    """A part of the teapot of a style, with nothing kept from its proofs."""

    def prepare() -> Work:
        shape = getattr(pas.teapot(style), part)
        return lambda: shape.translate((0, 0, 0)).mesh(tolerance)

    return prepare


def picture(part: str, **options: bool) -> Prepare:
    """A picture of the teapot, meshed before the clock starts."""

    def prepare() -> Work:
        shape = getattr(pas.teapot(), part)
        mesh, place = shape.mesh(HOLLOW_TOLERANCE), Path(tempfile.mkdtemp()) / "x.png"
        return lambda: pas.draw(shape, place, mesh=mesh, **options)

    return prepare


test_solids = measured(
    {
        f"plate with {len(HOLES)} holes": {"pas": plate, "manifold3d": plate_of_meshes},
        "two equal cylinders crossing": {"pas": crossing, "manifold3d": crossing_of_meshes},
        "gear of 40 sides": {"pas": body(partial(gear, 20), TOLERANCE)},
        "27 bars": {"pas": body(bars, 2e-3)},
        "teapot built and proved": {"pas": lambda: lambda: pas.teapot().solid.proved},
        "teapot": {"pas": teapot("better", "solid", TOLERANCE)},
        "teapot of the paper": {"pas": teapot("paper", "solid", TOLERANCE)},
        "its lid at 4e-3": {"pas": teapot("better", "lid", HOLLOW_TOLERANCE)},
        "hollow pot at 4e-3": {"pas": teapot("better", "pot", HOLLOW_TOLERANCE)},
        "its picture from four sides": {"pas": picture("solid", four_views=True)},
        "the hollow pot cut in half": {"pas": picture("assembly", cut=True)},
    }
)
