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
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
from OCP.BRepLib import BRepLib
from OCP.Interface import Interface_Static
from OCP.Message import Message, Message_Gravity
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_Reader, STEPControl_StepModelType
from OCP.StepData import StepData_StepWriter
from OCP.STEPEdit import STEPEdit
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Solid
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from pas.errors import GeometryError
from pas.exchange.formats import UNITS, Request
from pas.exchange.parts import ExactPart
from pas.exchange.step.model import (
    StepPart,
    StepReport,
    adaptive_volume,
    compound,
    explored,
    is_valid,
    largest_tolerance,
    meshed_volume,
    step_part,
)
from pas.exchange.step.shapes import spline_surface
from pas.parametric.patches import RationalPatch

Named = tuple[str, tuple[int, int, int] | None, Any]
"""A shape of Open Cascade with its name, and its colour (red, green, blue up to 255) or None."""


def write_faces(
    content: Sequence[RationalPatch] | Sequence[ExactPart], path: Path, request: Request
) -> Sequence[StepReport] | None:
    """Solids with all their faces, or each patch as a face, sewn where that is asked for.

    Raises `GeometryError` for one that is refused.
    """
    with _quiet():
        solids = [part for part in content if isinstance(part, ExactPart)]
        if solids:
            parts = [step_part(part.solid, part.name, part.color, request.mesh.tolerance) for part in solids]
            return write_parts(parts, path, request.name, UNITS[request.told_unit].step)
        patches = [item for item in content if not isinstance(item, ExactPart)]
        faces = [_face(item, number) for number, item in enumerate(patches)]
        whole = compound(faces) if request.sew is None else _sewn(faces, request.sew)
        _print([(request.name, None, whole)], path, request.name, UNITS[request.told_unit].step)
        return None


@contextmanager
def _quiet() -> Iterator[None]:
    """Without the statistics that Open Cascade prints."""
    printers = [(p, p.GetTraceLevel()) for p in Message.DefaultMessenger_s().Printers()]
    for printer, _ in printers:
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    try:
        yield
    finally:
        for printer, level in printers:
            printer.SetTraceLevel(level)


def _face(patch: RationalPatch, number: int) -> Any:
    size = float(abs(patch.points - patch.points[0, 0]).max())
    if size == 0:
        raise GeometryError(f"patches[{number}] is a single point")
    surface = spline_surface(patch.points, patch.weights, patch.knots, patch.degrees)
    made = BRepBuilderAPI_MakeFace(surface, 1e-9 * size)  # shorter sides are points to Open Cascade
    if not made.IsDone():
        raise GeometryError(f"patches[{number}] is no surface to Open Cascade: {made.Error().name}")
    return made.Face()


def _sewn(faces: Sequence[Any], distance: float) -> Any:
    """One shell, solid or compound of shells."""
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


def write_parts(parts: Sequence[StepPart], path: Path, name: str, unit: str) -> tuple[StepReport, ...]:
    """A file of parts, an assembly where there are several, in a unit by Open Cascade's name of it.

    Raises `GeometryError` where what is read again is not one valid closed solid for each that was written, with the
    volume that it should have.
    """
    _print([(part.name, part.color, part.shape) for part in parts], path, name, unit)
    return _checked(parts, path)


def _print(parts: Sequence[Named], path: Path, name: str, unit: str) -> None:
    """A file of shapes, in whose text doubles come back as they were."""
    writer = STEPCAFControl_Writer()  # before the settings, which do not exist without one
    Interface_Static.SetCVal_s("xstep.cascade.unit", unit)
    Interface_Static.SetCVal_s("write.step.unit", unit)
    Interface_Static.SetCVal_s("write.step.product.name", name.encode("ascii", "replace").decode("ascii"))
    Interface_Static.SetIVal_s("write.step.assembly", 0)
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    if not writer.Transfer(_document(parts, name), STEPControl_StepModelType.STEPControl_AsIs):
        raise GeometryError("Open Cascade could not translate the shapes to STEP")
    text, buffer = StepData_StepWriter(writer.ChangeWriter().Model()), BytesIO()
    # its own twelve digits would round; its suppression of zeros stays off
    text.FloatWriter().SetFormat("%.16E")
    text.SendModel(STEPEdit.Protocol_s())
    if not text.Print(buffer):
        raise GeometryError("Open Cascade could not write the shapes as STEP")
    path.write_bytes(buffer.getvalue())


def _document(parts: Sequence[Named], name: str) -> Any:
    """Open Cascade's document with a product for each part, and one that has several as components."""
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    whole = shapes.NewShape() if len(parts) > 1 else None
    if whole is not None:
        TDataStd_Name.Set_s(whole, TCollection_ExtendedString(name, True))
    for part, color, shape in parts:
        label, title = shapes.AddShape(shape, False), TCollection_ExtendedString(part, True)
        TDataStd_Name.Set_s(label, title)
        if color is not None:
            shown = Quantity_Color(*(value / 255 for value in color), Quantity_TypeOfColor.Quantity_TOC_sRGB)
            colors.SetColor(label, shown, XCAFDoc_ColorType.XCAFDoc_ColorSurf)
        if whole is not None:
            TDataStd_Name.Set_s(shapes.AddComponent(whole, label, TopLoc_Location()), title)
    shapes.UpdateAssemblies()
    return document


def _checked(parts: Sequence[StepPart], path: Path) -> tuple[StepReport, ...]:
    """The reports on the parts of a file, read again."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    solids = explored(reader.OneShape(), "SOLID")
    if len(solids) != sum(part.count for part in parts):
        raise _refused(f"it would have {len(solids)} solids in the place of {sum(part.count for part in parts)}")
    reports, first = [], 0
    for part in parts:
        mine, first = solids[first : first + part.count], first + part.count
        if not all(map(is_valid, mine)):
            raise _refused(f"the part {part.name!r} would not be valid when it is read again")
        error = max(5e-7, part.bound / part.volume / 50)
        volume, loose = sum(adaptive_volume(solid, error) for solid in mine), max(map(largest_tolerance, mine))
        if abs(volume - part.volume) > part.bound:
            volume = sum(meshed_volume(solid, part.loosest) for solid in mine)
        off = volume - part.volume
        if abs(off) > part.bound:
            raise _refused(f"the volume of {part.name!r} would be {volume:.6g} in the place of {part.volume:.6g}")
        if loose > part.loosest:
            raise _refused(f"edges of {part.name!r} would be {loose:.1e} from their faces, above {part.loosest:.1e}")
        reports.append(replace(part.report, volume=volume, volume_difference=off, gap=loose))
    return tuple(reports)


def _refused(reason: str) -> GeometryError:
    return GeometryError(f"no STEP file was written, because {reason}; try another tolerance, or write triangles")
