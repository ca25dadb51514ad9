"""Solids: meshes of bodies made of exact surfaces, beside booleans of meshes."""

from __future__ import annotations

from math import acos, ceil, pi
from typing import Any

from pas.bench.case import Case, Suite, Work

HOLES = [(x, y) for x in range(-4, 5, 2) for y in (-2, 0, 2)]
TOLERANCE = 1e-3


def _plate() -> Work:
    from pas.solid import primitives as solid

    def work() -> Any:
        body = solid.box((-5, -3, 0), (5, 3, 1))
        for x, y in HOLES:
            body = body - solid.cylinder((x, y, -1), (x, y, 2), "1/2")
        return body.mesh(TOLERANCE)

    return work


def _plate_of_meshes() -> Work:
    import manifold3d

    sides = ceil(pi / acos(1 - TOLERANCE / 0.5))

    def work() -> Any:
        body = manifold3d.Manifold.cube((10, 6, 1)).translate((-5, -3, 0))
        for x, y in HOLES:
            body = body - manifold3d.Manifold.cylinder(3, 0.5, 0.5, sides).translate((x, y, -1))
        return body.to_mesh()

    return work


def _crossing() -> Work:
    from pas.solid import primitives as solid

    return lambda: (solid.cylinder((-2, 0, 0), (2, 0, 0), 1) & solid.cylinder((0, -2, 0), (0, 2, 0), 1)).mesh(TOLERANCE)


def _crossing_of_meshes() -> Work:
    import manifold3d

    sides = ceil(pi / acos(1 - TOLERANCE))

    def work() -> Any:
        pipe = manifold3d.Manifold.cylinder(4, 1, 1, sides).translate((0, 0, -2))
        return (pipe.rotate((0, 90, 0)) ^ pipe.rotate((90, 0, 0))).to_mesh()

    return work


def _teapot() -> Work:
    from pas.designs.teapot import teapot

    pot = teapot().solid
    return lambda: pot.translate((0, 0, 0)).mesh(TOLERANCE)


def cases() -> list[Case]:
    """Those of this suite."""
    about = "the peer has booleans of prisms with as many sides as the tolerance asks for: no exact faces"
    return [
        Case(f"plate with {len(HOLES)} holes", _plate, {"manifold3d": _plate_of_meshes}, about),
        Case("two equal cylinders crossing", _crossing, {"manifold3d": _crossing_of_meshes}, about),
        Case("teapot", _teapot),
    ]


SOLIDS = Suite("solid", "meshes of solids", cases)
