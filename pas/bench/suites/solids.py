"""Solids: meshes of bodies made of exact surfaces, beside booleans of meshes."""

from __future__ import annotations

from collections.abc import Callable
from math import acos, ceil, cos, pi, sin
from typing import TYPE_CHECKING, Any

from pas.bench.case import Case, Suite, Work

if TYPE_CHECKING:
    from pas.solid.solid import Solid

HOLES = [(x, y) for x in range(-4, 5, 2) for y in (-2, 0, 2)]
TOLERANCE, HOLLOW_TOLERANCE = 1e-3, 4e-3
GEAR_TEETH = 20


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


def gear(teeth: int) -> Solid:
    """A disc of radius 1 with pointed teeth up to 5/4: each tooth is what two half planes and the disc's edge leave."""
    from pas.solid import primitives as solid
    from pas.solid.assembly import intersection, union
    from pas.solid.solid import patch

    turns = [2 * pi * (k + side / 2) / teeth for k in range(teeth) for side in (0, 1)]
    rim = [(round(r * cos(t), 4), round(r * sin(t), 4)) for t, r in zip(turns, (1.0, 1.25) * teeth, strict=True)]
    wedges = []
    for k in range(teeth):
        (a, b), (c, d), (e, f) = rim[2 * k], rim[2 * k + 1], rim[(2 * k + 2) % len(rim)]
        edges = (((0, 0), (a, b)), ((a, b), (c, d)), ((c, d), (e, f)), ((e, f), (0, 0)))
        sides = [f"({r - p!r})*(y - ({q!r})) - ({s - q!r})*(x - ({p!r}))" for (p, q), (r, s) in edges]
        flanks = [solid.half_space(f"-({side})", f"side {2 * k + i}") for i, side in enumerate(sides[1:3])]
        walls = [patch("", f"-({side})") for side in (sides[0], sides[3])]
        wedges.append(intersection([*flanks, *walls]))
    return union(wedges) & solid.half_space("-z", "bottom") & solid.half_space("z - 2/5", "top")


def _gear() -> Work:
    return lambda: gear(GEAR_TEETH).mesh(TOLERANCE)


def _teapot(style: str, part: str, tolerance: float) -> Callable[[], Work]:
    """A part of the teapot of a style, with nothing kept from its proofs."""

    def prepare() -> Work:
        from pas.designs.teapot import teapot

        shape = getattr(teapot(style), part)
        return lambda: shape.translate((0, 0, 0)).mesh(tolerance)

    return prepare


def cases() -> list[Case]:
    """Those of this suite."""
    about = "the peer has booleans of prisms with as many sides as the tolerance asks for: no exact faces"
    return [
        Case(f"plate with {len(HOLES)} holes", _plate, {"manifold3d": _plate_of_meshes}, about),
        Case("two equal cylinders crossing", _crossing, {"manifold3d": _crossing_of_meshes}, about),
        Case(f"gear of {2 * GEAR_TEETH} sides", _gear),
        Case("teapot", _teapot("better", "solid", TOLERANCE)),
        Case("teapot of the paper", _teapot("paper", "solid", TOLERANCE)),
        Case("hollow pot at 4e-3", _teapot("better", "pot", HOLLOW_TOLERANCE)),
    ]


SOLIDS = Suite("solid", "meshes of solids", cases)
