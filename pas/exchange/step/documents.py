"""STEP files of parts: written with their names and colours, read again and checked before anybody else reads them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

from pas.errors import GeometryError
from pas.exchange.step.model import StepPart, StepReport, adaptive_volume, explored, is_valid, largest_tolerance


def write_parts(parts: Sequence[StepPart], path: Path, name: str, unit: str) -> tuple[StepReport, ...]:
    """A file of parts, an assembly where there are several, in a unit by Open Cascade's name of it.

    Raises `GeometryError` where what is read again is not one valid closed solid for each that was written, with the
    volume that it should have.
    """
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_StepModelType

    writer = STEPCAFControl_Writer()
    set_names(name, unit)
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    if not writer.Transfer(_document(parts, name, unit), STEPControl_StepModelType.STEPControl_AsIs):
        raise GeometryError("Open Cascade could not translate the solid to STEP")
    print_model(writer.ChangeWriter().Model(), path)
    return _checked(parts, path)


def set_names(name: str, unit: str) -> None:
    """Open Cascade's settings for the file that is written next, which are of the whole process."""
    from OCP.Interface import Interface_Static

    Interface_Static.SetCVal_s("xstep.cascade.unit", unit)
    Interface_Static.SetCVal_s("write.step.unit", unit)
    Interface_Static.SetCVal_s("write.step.product.name", name.encode("ascii", "replace").decode("ascii"))
    Interface_Static.SetIVal_s("write.step.assembly", 0)


def print_model(model: Any, path: Path) -> None:
    """A model as text, in which doubles come back as they were; raises `GeometryError` where that fails."""
    from OCP.StepData import StepData_StepWriter
    from OCP.STEPEdit import STEPEdit

    text, buffer = StepData_StepWriter(model), BytesIO()
    # its own twelve digits would round; its suppression of zeros stays off
    text.FloatWriter().SetFormat("%.16E")
    text.SendModel(STEPEdit.Protocol_s())
    if not text.Print(buffer):
        raise GeometryError("Open Cascade could not write the shape as STEP")
    path.write_bytes(buffer.getvalue())


def _document(parts: Sequence[StepPart], name: str, unit: str) -> Any:
    """Open Cascade's document with a product for each part, and one that has several as components."""
    from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    whole = shapes.NewShape() if len(parts) > 1 else None
    if whole is not None:
        TDataStd_Name.Set_s(whole, TCollection_ExtendedString(name, True))
    for part in parts:
        label = shapes.AddShape(part.shape, False)
        title = TCollection_ExtendedString(part.name, True)
        TDataStd_Name.Set_s(label, title)
        if part.color is not None:
            red, green, blue = (value / 255 for value in part.color)
            color = Quantity_Color(red, green, blue, Quantity_TypeOfColor.Quantity_TOC_sRGB)
            colors.SetColor(label, color, XCAFDoc_ColorType.XCAFDoc_ColorSurf)
        if whole is not None:
            TDataStd_Name.Set_s(shapes.AddComponent(whole, label, TopLoc_Location()), title)
    shapes.UpdateAssemblies()
    return document


def _checked(parts: Sequence[StepPart], path: Path) -> tuple[StepReport, ...]:
    """What is known of the parts of a file, read again."""
    from OCP.STEPControl import STEPControl_Reader

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
        volume, loose = sum(map(adaptive_volume, mine)), max(map(largest_tolerance, mine))
        off = volume - part.volume
        if abs(off) > part.bound:
            raise _refused(f"the volume of {part.name!r} would be {volume:.6g} in the place of {part.volume:.6g}")
        if loose > part.loosest:
            raise _refused(f"edges of {part.name!r} would be {loose:.1e} from their faces, above {part.loosest:.1e}")
        reports.append(replace(part.report, volume=volume, volume_difference=off, gap=loose))
    return tuple(reports)


def _refused(reason: str) -> GeometryError:
    return GeometryError(f"no STEP file was written, because {reason}; try another tolerance, or write triangles")
