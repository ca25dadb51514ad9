"""A solid as Open Cascade's shapes, with what is known of it: made, measured, and halves joined again.

Guaranteed of what is returned: each part is one valid closed solid for each outer surface; faces on planes, quadrics
and tori are these surfaces, edges that are lines, circles or ellipses these curves, both up to rounding; other faces
are splines of degree 5 within the tolerance of the solid's; faces share their edges.  Not guaranteed: that a spline is
within the tolerance between the points at which that was measured, some thousand a face.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Pnt, gp_Trsf, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.Standard import Standard_Failure
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Compound

from pas.algebra.rational import Exact, check_tolerance
from pas.arrays import Floats
from pas.errors import GeometryError
from pas.exchange.step.borders import Borders
from pas.exchange.step.charts import NEAR, Atlas
from pas.exchange.step.division import divide
from pas.exchange.step.parameters import SplinePatch
from pas.exchange.step.shapes import ShapeMaker
from pas.mesh.field import column_of, place_of
from pas.settings import RELATIVE_TOLERANCE
from pas.solid.measures import curved_measures
from pas.solid.solid import Solid


def explored(shape: Any, kind: str) -> list[Any]:
    """The SOLID, SHELL, FACE or EDGE shapes within one, each once for each place in which it is."""
    explorer, found = TopExp_Explorer(shape, getattr(TopAbs_ShapeEnum, f"TopAbs_{kind}")), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def is_valid(shape: Any) -> bool:
    """Whether all of a shape's geometry and topology is consistent, and its shells are closed."""
    return bool(BRepCheck_Analyzer(shape).IsValid()) and all(map(BRep_Tool.IsClosed_s, explored(shape, "SHELL")))


def adaptive_volume(shape: Any, error: float = 5e-7) -> float:
    """The volume of the solids in a shape, negative where they are inside out, by quadrature that aims at a relative
    error: one that does not adapt is off by 13 % on some valid solids.
    """
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, error, False, False)
    return float(found.Mass())


def meshed_volume(shape: Any, distance: float) -> float:
    """The volume of a mesh of the solids in a shape, within a distance: rougher than by quadrature, which does not
    converge on some trimmed rational faces.
    """
    BRepMesh_IncrementalMesh(shape, distance, False, 0.1, False)
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, False, False, True)
    return float(found.Mass())


def largest_tolerance(shape: Any) -> float:
    """The largest distance within which vertices and edges of a shape are taken to be on what they belong to."""
    return float(ShapeAnalysis_ShapeTolerance().Tolerance(shape, 1))


def smoothness(maker: ShapeMaker) -> tuple[float, float]:
    """The smoothness across charts that are claimed to continue each other: across GC^1 borders the largest angle
    between normals, in radians, across GC^2 ones the largest jump of curvature, over the largest curvature."""
    angle = jump = largest = 0.0
    for border, curve in zip(maker.borders.borders, maker.curves, strict=True):
        if border.order < 1:
            continue
        places = curve.parameters(19)[1:-1]
        step = (curve.end - curve.start) * 1e-4
        along = curve(places + step) - curve(places - step)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        (one, k), (other, m) = (_across(maker, chart, curve(places), along) for chart in (border.left, border.right))
        sines = np.linalg.norm(np.cross(one, other), axis=1)
        angle = max(angle, float(np.arctan2(sines, (one * other).sum(axis=1)).max()))
        largest = max(largest, float(np.abs([k, m]).max()))
        jump = max(jump, float(np.abs(k - m).max()) if border.order > 1 else 0.0)
    return angle, jump / largest if largest else 0.0


def _across(maker: ShapeMaker, chart: int, points: Floats, along: Floats) -> tuple[Floats, Floats]:
    """Outward normals (N, 3) and curvatures (N,) of a chart's surface, across directions (N, 3) along a border."""
    point, vectors = gp_Pnt(), [gp_Vec() for _ in range(5)]
    found = np.empty((len(points), 5, 3))
    for row, uv in enumerate(maker.parameters[chart].uv(points).tolist()):
        maker.surfaces[chart].D2(*uv, point, *vectors)
        found[row] = [(v.X(), v.Y(), v.Z()) for v in vectors]
    first, second = found[:, :2], found[:, [2, 4, 4, 3]]
    normals = np.cross(first[:, 0], first[:, 1]) * (1.0 if maker.natural[chart] else -1.0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    metric = first @ first.transpose(0, 2, 1)
    parts = np.linalg.solve(metric, first @ np.cross(normals, along)[..., None])
    bends = (second @ normals[..., None]).reshape(-1, 2, 2)
    return normals, (parts.transpose(0, 2, 1) @ bends @ parts)[:, 0, 0]


COARSER = 10
"""The tolerance of the mesh that says which faces meet where, over that of the faces; also of meshes' usual tolerance
over the usual one here."""


@dataclass(frozen=True)
class StepReport:
    """The facts about a part of a STEP file, in the model's units.

    `faces` are its faces, `exact` those on planes, quadrics and tori; the others are within `distance` of the solid's
    and their edges within `gap` of all their faces, as measured at many points.  `volume` is the file's, by adaptive
    quadrature or its mesh, `volume_difference` by how much the solid's own, by its mesh, is smaller.  `angle` is the
    largest between normals, in radians, where charts of one face or faces with a joint go on in each other, and
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
        others = "" if self.exact == self.faces else f", the others within {self.distance:.1e} of the solid's"
        return (
            f"{self.name}: {self.faces} faces, {self.exact} of them exact{others}; edges within {self.gap:.1e}; "
            f"volume {self.volume:.7g}, {self.volume_difference:+.1e} from the mesh's; where faces go on smoothly "
            f"normals differ by {self.angle:.1e} rad at most, curvatures by {self.curvature_jump:.1e} of the largest"
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
    solid: Solid, name: str, color: tuple[int, int, int] | None = None, tolerance: Exact | None = None
) -> StepPart:
    """A solid as a part of a STEP file, whose faces are within `tolerance` (the model's units) of the solid's.

    By default that is 1e-4 of the longest side of the box.  Raises what meshing raises, and `GeometryError` where a
    face is followed by no spline or Open Cascade finds the result not valid.
    """
    field = solid.field
    size = float(np.ptp(solid.box, axis=0).max())
    within = RELATIVE_TOLERANCE / COARSER * size if tolerance is None else check_tolerance(tolerance, size)
    found = solid.face_mesh(min(COARSER * within, RELATIVE_TOLERANCE * COARSER * size))
    measured = curved_measures(found, field).scaled(field.scale, field.world(np.zeros(3)))
    atlas = Atlas(found.mesh, field)
    parameters = divide(atlas, within / field.scale / 4, within / size / 2)
    borders = Borders(atlas, partial(_order, solid))
    near = 1e-8  # of splines to the curves in which faces meet, in local coordinates
    maker = ShapeMaker(borders, parameters, [borders.curve(border, near) for border in borders.borders])
    angle, jump = smoothness(maker)
    made = maker.solids()
    if not all(map(is_valid, made)):
        raise _not_valid(maker, name)
    solids = list(map(_joined, made))
    shape = _in_world(solids, field.scale, field.world(np.zeros(3)))
    off = [p.distance * field.scale for p in parameters.values() if isinstance(p, SplinePatch) and p.weights is None]
    faces = len(explored(shape, "FACE"))
    report = StepReport(name, faces, faces - len(off), max(off, default=0.0), 0.0, measured.volume, 0.0, angle, jump)
    bound, loosest = measured.area * within, max(within, 1e-6 * size)
    return StepPart(name, color, shape, len(solids), measured.volume, bound, loosest, report)


def _order(solid: Solid, one: int, other: int, points: Floats) -> int:
    """The order of the joint along local points (N, 3) that is claimed between faces of two labels; 0 without one.

    Between pieces of one face it is the highest of its joints.
    """
    field = solid.field
    names = [field.evaluator.columns[column_of(label)].names for label in (one, other)]
    if one == other:
        return max((j.order for j in solid.joints if {j.first, j.second} & {*names[0]}), default=1)
    places, order = field.world(points), 0
    for joint in solid.joints:
        if any(joint.first in a and joint.second in b for a, b in (names, names[::-1])):
            slopes = [np.linalg.norm(f.gradient(places), axis=1) for f in joint.along]
            off = [np.abs(f(places)) / np.maximum(g, 1e-300) for f, g in zip(joint.along, slopes, strict=True)]
            order = max(order, joint.order if np.max(off) < NEAR * field.scale else 0)
    return order


def _not_valid(maker: ShapeMaker, name: str) -> GeometryError:
    """The error for a solid that Open Cascade refuses, with the first face that it refuses, if there is one."""
    atlas = maker.borders.atlas
    wrong = next((chart for chart, face in maker.faces.items() if not is_valid(face)), None)
    where = ""
    if wrong is not None:
        middle = atlas.points[atlas.triangles[atlas.rows(wrong)]].mean(axis=(0, 1))
        where = f": a part of {atlas.field.face(atlas.sheets[wrong].label)!r} near {place_of(atlas.field, middle)}"
    return GeometryError(
        f"no STEP file was written, because Open Cascade finds the faces of {name!r} not to be a valid solid{where}; "
        "try another tolerance, or write triangles"
    )


def _joined(solid: Any) -> Any:
    """A valid solid with faces joined that are on one surface, where what comes of it is as good."""
    joining = ShapeUpgrade_UnifySameDomain(solid, True, True, False)
    try:
        joining.Build()
    except Standard_Failure:  # it may fail on edges that it has joined itself; the solid as it is stays valid
        return solid
    found = explored(joining.Shape(), "SOLID")
    if len(found) != 1 or not is_valid(found[0]):
        return solid
    areas = []
    for some in (solid, found[0]):
        faces, area = [*map(TopoDS.Face, explored(some, "FACE"))], GProp_GProps()
        exact = [face for face in faces if not isinstance(BRep_Tool.Surface_s(face), Geom_BSplineSurface)]
        BRepGProp.SurfaceProperties_s(compound(exact), area, 1e-7, False)  # splines are as they were
        areas.append(area.Mass())
    return found[0] if abs(areas[1] - areas[0]) < 1e-6 * areas[0] else solid


def _in_world(solids: list[Any], scale: float, place: Floats) -> Any:
    """Solids in the user's coordinates, several as a compound."""
    move = gp_Trsf()
    move.SetScale(gp_Pnt(0, 0, 0), scale)
    move.SetTranslationPart(gp_Vec(*place.tolist()))
    moved = [BRepBuilderAPI_Transform(solid, move, True).Shape() for solid in solids]
    return moved[0] if len(moved) == 1 else compound(moved)


def compound(shapes: Sequence[Any]) -> Any:
    """Several shapes as one."""
    builder, result = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(result)
    for shape in shapes:
        builder.Add(result, shape)
    return result
