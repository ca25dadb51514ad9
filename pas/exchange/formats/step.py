"""STEP files (ISO 10303-21) of rational patches and exact parametric surfaces, by Open Cascade.

Guaranteed: each patch is one face on a rational B-spline surface with the patch's own control points, weights and
knots, and exact surfaces and blends are written as their Bezier patches, so nothing is approximated but that
fractions become doubles; files are whole or not at all.  Not guaranteed: trimmed faces (a patch
is written whole), and names of faces.  Open Cascade's settings of units and product names, which are of the whole
process, are set by each call.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from pas.algebra.monomials import Floats
from pas.errors import GeometryError, MissingLibraryError, library
from pas.exchange.formats import UNITS, Format, Request
from pas.exchange.parts import PATCHES
from pas.parametric.patches import RationalPatch


def write_faces(patches: Sequence[RationalPatch], path: Path, request: Request) -> None:
    """Each patch as a face, sewn where that is asked for; raises `GeometryError` for one that is refused."""
    _require_library()
    with _quiet():
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
        (u, many), (v, times) = (_open_knots(k) for k in patch.knots)
        surface = Geom_BSplineSurface(points, weights, u, v, many, times, *patch.degrees)
    made = BRepBuilderAPI_MakeFace(surface, 1e-9 * size)  # shorter sides are points to Open Cascade
    if not made.IsDone():
        raise GeometryError(f"patches[{number}] is no surface to Open Cascade: {made.Error().name}")
    return made.Face()


def _open_knots(knots: Floats) -> tuple[Any, Any]:
    """The distinct knots and how often each occurs, as Open Cascade's arrays."""
    from OCP.collections import Array1_double, Array1_int

    distinct, times = np.unique(knots, return_counts=True)
    values, counts = Array1_double(1, len(distinct)), Array1_int(1, len(distinct))
    for place, (value, count) in enumerate(zip(distinct.tolist(), times.tolist(), strict=True), start=1):
        values.SetValue(place, value)
        counts.SetValue(place, count)
    return values, counts


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
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer
    from OCP.StepData import StepData_StepWriter
    from OCP.STEPEdit import STEPEdit

    writer = STEPControl_Writer()  # before the settings, which do not exist without one
    Interface_Static.SetCVal_s("xstep.cascade.unit", unit)
    Interface_Static.SetCVal_s("write.step.unit", unit)
    Interface_Static.SetCVal_s("write.step.product.name", name.encode("ascii", "replace").decode("ascii"))
    Interface_Static.SetIVal_s("write.step.assembly", 0)
    status = writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    if status != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise GeometryError(f"Open Cascade could not translate the patches to STEP ({status.name})")
    text, buffer = StepData_StepWriter(writer.Model()), BytesIO()
    # doubles come back as they were, which its own twelve digits would round; its suppression of zeros stays off
    text.FloatWriter().SetFormat("%.16E")
    text.SendModel(STEPEdit.Protocol_s())
    if not text.Print(buffer):
        raise GeometryError("Open Cascade could not write the patches as STEP")
    path.write_bytes(buffer.getvalue())


def _is_installed(_: Any) -> bool:
    """What a shape lacks is said before what the machine lacks: so `require` is none."""
    try:
        _require_library()
    except MissingLibraryError:
        return False
    return True


STEP = Format(".step", PATCHES, write_faces, limits=_is_installed)
