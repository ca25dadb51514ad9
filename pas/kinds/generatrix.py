"""Blends by a generatrix, and such through a sphere, as kinds of shapes: their boundaries and shape functions.

Boundaries are kept as the tables that make them (`pas.exchange.parametric_problem`) and how they were turned, so that
reading searches nothing; shape functions as their exact coefficients.

Guaranteed: what is read is the same blend.  Not possible: boundaries and middle curves that are callables.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

from pas.algebra.callables import texts_of
from pas.exchange.parametric_problem import boundary_from
from pas.exchange.schema import (
    ANYTHING,
    FLAG,
    NUMBER,
    REAL,
    TEXT,
    WHOLE,
    Table,
    choice,
    list_of,
    maybe,
    one_of,
    table_of,
)
from pas.kinds.parametric import exact_patches
from pas.mesh.mesh import Mesh
from pas.parametric.generatrix.align import Alignment, alignment
from pas.parametric.generatrix.blend import GeneratrixBlend
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.paths import NAMES
from pas.parametric.generatrix.shape import MANY, GeneratrixShape, ShapeFunction
from pas.parametric.generatrix.sphere import SphereBlend, blend_through_sphere
from pas.parametric.nets import extent
from pas.render.parametric import layers, sphere_layers
from pas.settings import RELATIVE_TOLERANCE, MeshSettings
from pas.shape import Kind

VALUES = ("l1", "l2", "lambda1", "lambda2")


def _boundary_entries(boundary: Boundary) -> dict[str, Any]:
    """The table that makes a boundary, and how it was turned; raises `ValueError` for one of callables or samples."""
    if boundary.source is None:
        raise ValueError(
            f"{boundary.name} was not made of plain data and cannot be saved; give its curve, vectors and surface as "
            "expressions, with t and h for the parameters of a surface that is not exact"
        )
    table = {**boundary.source, **({"side": boundary.side} if boundary.side else {})}
    return {"table": table, "phase": boundary.phase, "backwards": boundary.backwards}


def _coefficients(coefficients: list[Any]) -> ShapeFunction:
    if not 0 < len(coefficients) <= MANY:
        raise ValueError(f"a shape function must have 1 to {MANY} coefficients, not {len(coefficients)}")
    constant = [ShapeFunction.constant(c).coefficients for c in coefficients]
    return ShapeFunction(tuple(c for (c,) in constant))


def _shape_entries(shape: GeneratrixShape) -> dict[str, Any]:
    """The shape functions by name, and the middle curve; raises `ValueError` for one that is callable."""
    middle = texts_of(shape.middle, NAMES)
    if middle is None and shape.middle is not None:
        raise ValueError("a middle curve that is no list of three expressions in s cannot be saved")
    return {name: getattr(shape, name) for name in VALUES} | {"middle": middle}


_FUNCTION = choice(
    "a shape function: a table with a cosine or coefficients",
    Table(
        {"cosine": list_of(REAL, 3)},
        make=lambda cosine: ShapeFunction.cosine(*map(float, cosine)),
        entries=lambda function: {"cosine": function.wave},
        of=lambda function: function.wave is not None,
    ),
    Table({"coefficients": list_of(NUMBER)}, make=_coefficients),
)
_BOUNDARY = Table(
    {"table": table_of(ANYTHING), "phase": REAL, "backwards": FLAG},
    make=lambda table, phase, backwards: replace(boundary_from(table), phase=float(phase), backwards=backwards),
    entries=_boundary_entries,
)
_SHAPE = Table(
    dict.fromkeys(VALUES, _FUNCTION) | {"middle": maybe(list_of(choice("a formula", TEXT, WHOLE), 3))},
    make=GeneratrixShape,
    entries=_shape_entries,
)
_ALIGNMENT = {"reversed": FLAG, "shift": REAL, "distance": REAL, "opposed": FLAG, "reason": TEXT}


def _blend(boundaries: Any, signs: Any, unit: bool, shape: GeneratrixShape, alignment: Alignment) -> GeneratrixBlend:
    """The blend of a file: how the second curve was turned must be how it is turned anew, once it is turned back."""
    (first, second), (a, b) = boundaries, signs
    found = _found_again(alignment, first, second, (a, b))
    return GeneratrixBlend.of_turned((first, second), (a, b), shape, found, unit)


_BLEND = Table(
    {
        "boundaries": list_of(_BOUNDARY, 2),
        "signs": list_of(one_of((1, -1)), 2),
        "unit": FLAG,
        "shape": _SHAPE,
        "alignment": Table(_ALIGNMENT, {"by_length": FLAG}, make=Alignment, entries=asdict),
    },
    make=_blend,
    names={"signs": "frames.signs", "unit": "frames.unit"},
)


def _found_again(told: Alignment, first: Boundary, second: Boundary, signs: tuple[int, int]) -> Alignment:
    """How the second curve was turned, with what is said of it found anew; raises `ValueError` where it was not so.

    On another machine a shift (of a turn) and a mean distance (over itself) may come out otherwise by 1e-6: the best
    shift is found to about 1e-8.
    """
    same = 1e-6
    before = second.turned(False, -told.shift) if told.shift else second
    before = before.turned(told.reversed, 0.0)
    for turn in (True, False):  # a blend may have been made of curves as they are
        found = alignment(first, before, signs, turn)
        apart = abs((found.shift - told.shift + 0.5) % 1.0 - 0.5)
        near = abs(found.distance - told.distance) <= same * found.distance
        if found.reversed == told.reversed and apart <= same and near:
            break
    else:
        raise ValueError("alignment must be how the second curve was turned to fit the first, and it was not so")
    lengths = [b.source is not None and bool(b.source.get("by_length")) for b in (first, second)]
    if told.by_length and not all(lengths):
        raise ValueError("alignment.by_length must be false unless both curves have their lengths as parameters")
    return replace(told, opposed=found.opposed, reason=found.reason)


def _mesh(blend: GeneratrixBlend, settings: MeshSettings) -> Mesh:
    """Within a tolerance, too, where none is given: its own mesh would be a grid of which no distance is known."""
    if settings.domain is not None:
        return blend.surface.meshed(settings)
    usual = RELATIVE_TOLERANCE * extent(blend.surface)[1]
    return blend.meshed(replace(settings, tolerance=settings.tolerance or usual))


BLEND = Kind(
    "generatrix blend",
    GeneratrixBlend,
    _BLEND,
    layers,
    mesh=_mesh,
    patches=lambda blend, domain: exact_patches(blend.surface, domain),
    open=True,
    curved=True,
    kept=True,
)


def _sphere_blend(boundaries: Any, center: Any, radius: float, angles: Any, shapes: Any) -> SphereBlend:
    """The blend of a file: made anew, each part with its own shape."""
    made = blend_through_sphere(boundaries, center, radius, angles)
    if len(shapes) != len(made.blends):
        raise ValueError(f"there must be a shape for each of the {len(made.blends)} boundaries, not {len(shapes)}")
    parts = [
        part.with_shape(**{name: getattr(shape, name) for name in (*VALUES, "middle")})
        for part, shape in zip(made.blends, shapes, strict=True)
    ]
    return replace(made, blends=tuple(parts))


_SPHERE_BLEND = Table(
    {
        "boundaries": list_of(_BOUNDARY),
        "center": list_of(REAL, 3),
        "radius": REAL,
        "angles": list_of(REAL),
        "shapes": list_of(_SHAPE),
    },
    make=_sphere_blend,
    entries=lambda blend: {
        "boundaries": [part.boundaries[0] for part in blend.blends],
        **{name: getattr(blend, name) for name in ("center", "radius", "angles")},
        "shapes": [part.shape for part in blend.blends],
    },
)
SPHERE_BLEND = Kind("sphere blend", SphereBlend, _SPHERE_BLEND, sphere_layers, curved=True)
