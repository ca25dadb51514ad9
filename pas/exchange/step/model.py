"""A solid as Open Cascade's shapes, with what is known of it: made, measured, and halves joined again.

Guaranteed of what is returned: each part is one valid closed solid for each outer surface; faces on planes, quadrics
and tori are these surfaces, edges that are lines, circles or ellipses these curves, both up to rounding; other faces
are splines of degree 5 within the tolerance of the solid's; faces share their edges.  Not guaranteed: that a spline is
within the tolerance between the points at which that was measured, some thousand a face.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pas.algebra.inputs import check_tolerance
from pas.errors import GeometryError
from pas.exchange.step.borders import Borders
from pas.exchange.step.charts import Atlas
from pas.exchange.step.checks import adaptive_volume, explored, is_valid
from pas.exchange.step.division import divide
from pas.exchange.step.graphs import Graph
from pas.exchange.step.shapes import ShapeMaker
from pas.exchange.step.smoothness import smoothness
from pas.settings import RELATIVE_TOLERANCE
from pas.solid.measures import curved_measures
from pas.solid.solid import Solid

COARSER = 10
"""The tolerance of the mesh that says which faces meet where, over that of the faces; also of meshes' usual tolerance
over the usual one here."""


CURVES = 1e-8
"""Distance of splines from the curves in which faces meet, in local coordinates."""

SAME = 1e-6
"""Share of a solid's volume by which that with joined faces may differ, twice what quadrature allows itself."""


@dataclass(frozen=True)
class StepReport:
    """What a part of a STEP file is, in the model's units.

    `faces` are its faces, `exact` those on planes, quadrics and tori; the others are within `distance` of the solid's
    and their edges within `gap` of all their faces, as measured at many points.  `volume` is the file's, by adaptive
    quadrature, `volume_difference` by how much the solid's own, by its mesh, is smaller.  `angle` is the largest
    between normals, in radians, where charts of one face or faces with a joint go on in each other, and
    `curvature_jump` the largest jump of the curvature across where that should have none, over the largest there is.
    """

    name: str
    faces: int
    exact: int
    distance: float
    gap: float
    volume: float
    volume_difference: float
    angle: float
    curvature_jump: float

    def __str__(self) -> str:
        return (
            f"{self.name}: {self.faces} faces, {self.exact} of them exact, the others within {self.distance:.1e} of the "
            f"solid; edges within {self.gap:.1e} of their faces; volume {self.volume:.7g}, {self.volume_difference:+.1e} "
            f"from the mesh's; smooth joints within {self.angle:.1e} rad, curvature within {self.curvature_jump:.1e} "
            "of the largest"
        )


@dataclass(frozen=True)
class StepPart:
    """A part of a STEP file: its name, colour (red, green, blue up to 255) or None, and Open Cascade's `shape`.

    `count` is how many solids it has, `volume` what they should have together, `bound` by how much that may be off,
    `loosest` how far edges may be from their faces.
    """

    name: str
    color: tuple[int, int, int] | None
    shape: Any
    count: int
    volume: float
    bound: float
    loosest: float
    report: StepReport


def step_part(
    solid: Solid, name: str, color: tuple[int, int, int] | None = None, tolerance: float | None = None
) -> StepPart:
    """A solid as a part of a STEP file, whose faces are within `tolerance` (the model's units) of the solid's.

    By default that is 1e-4 of the longest side of the box.  Raises what meshing raises, and `GeometryError` where a
    face is followed by no spline or Open Cascade finds the result not valid.
    """
    field = solid.field
    size = float(np.ptp(solid.box, axis=0).max())
    within = RELATIVE_TOLERANCE / COARSER * size if tolerance is None else check_tolerance(tolerance, size)
    found = solid.face_mesh(min(COARSER * within, RELATIVE_TOLERANCE * COARSER * size))
    volume, area = curved_measures(found, field)
    atlas = Atlas(found.mesh, field)
    local = within / field.scale
    parameters = divide(atlas, local / 4, within / size / 4)
    borders = Borders(atlas, lambda one, other: _order(solid, one, other))
    curves = [borders.curve(border, CURVES) for border in borders.borders]
    maker = ShapeMaker(borders, parameters, curves)
    smooth = smoothness(maker)
    solids = [_joined(made, name) for made in maker.solids()]
    shape = _in_world(solids, field.scale, field.world(np.zeros(3)))
    graphs = [p for p in parameters.values() if isinstance(p, Graph)]
    faces = len(explored(shape, "FACE"))
    distance = max((p.distance for p in graphs), default=0.0) * field.scale
    report = StepReport(
        name,
        faces,
        faces - len(graphs),
        distance,
        maker.gap * field.scale,
        volume * field.scale**3,
        0.0,
        smooth.angle,
        smooth.curvature_jump,
    )
    bound = area * field.scale**2 * within
    return StepPart(name, color, shape, len(solids), volume * field.scale**3, bound, max(within, 1e-6 * size), report)


def _order(solid: Solid, one: int, other: int) -> int:
    """The order of the joint that is claimed between faces of two labels; 0 where there is none."""
    columns = solid.field.evaluator.columns
    names = set(columns[one // 2].names), set(columns[other // 2].names)
    orders = [
        j.order
        for j in solid.joints
        if (j.first in names[0] and j.second in names[1]) or (j.first in names[1] and j.second in names[0])
    ]
    return max(orders, default=0)


def _joined(solid: Any, name: str) -> Any:
    """A valid solid with faces joined that are on one surface, where what comes of it is as good."""
    from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain

    if not is_valid(solid):
        raise GeometryError(
            f"Open Cascade finds the faces of {name!r} not to be a valid solid; write it with another tolerance, or as "
            "triangles"
        )
    joining = ShapeUpgrade_UnifySameDomain(solid, True, True, False)
    joining.Build()
    found = joining.Shape()
    whole = explored(found, "SOLID")
    if len(whole) != 1 or not is_valid(found):
        return solid
    before, after = adaptive_volume(solid), adaptive_volume(found)
    return whole[0] if abs(after - before) < SAME * abs(before) else solid


def _in_world(solids: list[Any], scale: float, place: Any) -> Any:
    """Solids in the user's coordinates, several as a compound."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Pnt, gp_Trsf, gp_Vec
    from OCP.TopoDS import TopoDS_Compound

    move = gp_Trsf()
    move.SetScale(gp_Pnt(0, 0, 0), scale)
    move.SetTranslationPart(gp_Vec(*place.tolist()))
    moved = [BRepBuilderAPI_Transform(solid, move, True).Shape() for solid in solids]
    if len(moved) == 1:
        return moved[0]
    builder, result = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(result)
    for solid in moved:
        builder.Add(result, solid)
    return result
