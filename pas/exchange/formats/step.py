"""STEP files (ISO 10303-21) of solids, rational patches and exact parametric surfaces, by Open Cascade.

Guaranteed: each patch is one face on a rational B-spline surface with the patch's own control points, weights and
knots, and exact surfaces and blends are written as their Bezier patches, so nothing is approximated but that
fractions become doubles; a solid is what `pas.exchange.step.model` says, and is read again and checked before the file
takes its place; files are whole or not at all.  Not guaranteed: names of faces.  Open Cascade's settings of units and
product names, which are of the whole process, are set by each call.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pas.errors import GeometryError, MissingLibraryError, library
from pas.exchange.formats import UNITS, Format, Request
from pas.exchange.parts import FACES, ExactPart
from pas.exchange.step.documents import print_model, set_names, write_parts
from pas.exchange.step.model import step_part
from pas.exchange.step.shapes import knots_of
from pas.parametric.patches import RationalPatch


def write_faces(content: Sequence[RationalPatch] | Sequence[ExactPart], path: Path, request: Request) -> None:
    """Solids with all their faces, or each patch as a face, sewn where that is asked for.

    Raises `GeometryError` for one that is refused.
    """
    _require_library()
    with _quiet():
        solids = [part for part in content if isinstance(part, ExactPart)]
        if solids:
            parts = [step_part(part.solid, part.name, part.color, request.mesh.tolerance) for part in solids]
            write_parts(parts, path, request.name, UNITS[request.told_unit].step)
            return
        patches = [item for item in content if not isinstance(item, ExactPart)]
        faces = [_face(item, number) for number, item in enumerate(patches)]
        whole = _compound(faces) if request.sew is None else _sewn(faces, request.sew)
        _export(whole, path, request.name, UNITS[request.told_unit].step)


def _require_library() -> Any:
    return library("OCP.STEPControl", "STEP files need Open Cascade: pip install 'pas[step]'")


@contextmanager
def _quiet() -> Iterator[None]:
    """Without the statistics that Open Cascade prints."""
    from OCP.Message import Message, Message_Gravity

    printers = [(p, p.GetTraceLevel()) for p in Message.DefaultMessenger_s().Printers()]
    for printer, _ in printers:
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    try:
        yield
    finally:
        for printer, level in printers:
            printer.SetTraceLevel(level)


def _face(patch: RationalPatch, number: int) -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.collections import Array2_double, Array2_gp_Pnt
    from OCP.Geom import Geom_BezierSurface, Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    size = float(abs(patch.points - patch.points[0, 0]).max())
    if size == 0:
        raise GeometryError(f"patches[{number}] is a single point")
    rows, columns = patch.weights.shape
    points, weights = Array2_gp_Pnt(1, rows, 1, columns), Array2_double(1, rows, 1, columns)
    for i in range(rows):
        for j in range(columns):
            points.SetValue(i + 1, j + 1, gp_Pnt(*patch.points[i, j].tolist()))
            weights.SetValue(i + 1, j + 1, float(patch.weights[i, j]))
    if patch.is_bezier:
        surface: Any = Geom_BezierSurface(points, weights)
    else:
        (u, many), (v, times) = (knots_of(k) for k in patch.knots)
        surface = Geom_BSplineSurface(points, weights, u, v, many, times, *patch.degrees)
    made = BRepBuilderAPI_MakeFace(surface, 1e-9 * size)  # shorter sides are points to Open Cascade
    if not made.IsDone():
        raise GeometryError(f"patches[{number}] is no surface to Open Cascade: {made.Error().name}")
    return made.Face()


def _compound(shapes: Sequence[Any]) -> Any:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    builder, result = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(result)
    for shape in shapes:
        builder.Add(result, shape)
    return result


def _sewn(faces: Sequence[Any], distance: float) -> Any:
    """One shell, solid or compound of shells."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing
    from OCP.BRepLib import BRepLib
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS_Solid

    sewing = BRepBuilderAPI_Sewing(distance)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    result = sewing.SewedShape()
    if result.ShapeType() != TopAbs_ShapeEnum.TopAbs_SHELL or sewing.NbFreeEdges():
        return result
    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    builder.Add(solid, result)
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def _export(shape: Any, path: Path, name: str, unit: str) -> None:
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    writer = STEPControl_Writer()  # before the settings, which do not exist without one
    set_names(name, unit)
    status = writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    if status != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise GeometryError(f"Open Cascade could not translate the patches to STEP ({status.name})")
    print_model(writer.Model(), path)


def _is_installed(_: Any) -> bool:
    """What a shape lacks is said before what the machine lacks: so `require` is none."""
    try:
        _require_library()
    except MissingLibraryError:
        return False
    return True


STEP = Format(".step", FACES, write_faces, limits=_is_installed)
