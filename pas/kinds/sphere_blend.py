"""Blends through a sphere as a kind of shape: the boundaries, the sphere, the circles' angles, the shapes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pas.exchange.schema import REAL, List, Table
from pas.kinds.generatrix_blend import BOUNDARY, SHAPE, VALUES, boundary_record, read_boundary, shape_of, shape_record
from pas.parametric.generatrix.sphere import SphereBlend, blend_through_sphere
from pas.render.generatrix import sphere_layers
from pas.shape import Kind
from pas.verdicts import Verdicts

CONTENT = Table(
    {
        "boundaries": List(BOUNDARY),
        "center": List(REAL, 3),
        "radius": REAL,
        "angles": List(REAL),
        "shapes": List(SHAPE),
    }
)


def record(blend: SphereBlend, _: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a blend; raises `ValueError` for one made of callables."""
    return {
        "boundaries": [boundary_record(part.boundaries[0]) for part in blend.blends],
        "center": list(blend.center),
        "radius": blend.radius,
        "angles": list(blend.angles),
        "shapes": [shape_record(part.shape) for part in blend.blends],
    }


def read(content: dict[str, Any]) -> SphereBlend:
    """The blend of `record`: made anew, each part with its own shape."""
    boundaries = [read_boundary(b) for b in content["boundaries"]]
    made = blend_through_sphere(boundaries, content["center"], content["radius"], content["angles"])
    shapes = [shape_of(s) for s in content["shapes"]]
    if len(shapes) != len(made.blends):
        raise ValueError(f"there must be a shape for each of the {len(made.blends)} boundaries, not {len(shapes)}")
    parts = [
        part.with_shape(**{name: getattr(shape, name) for name in (*VALUES, "middle")})
        for part, shape in zip(made.blends, shapes, strict=True)
    ]
    return replace(made, blends=tuple(parts))


BLEND = Kind("sphere blend", SphereBlend, CONTENT, record, read, sphere_layers, curved=True)
