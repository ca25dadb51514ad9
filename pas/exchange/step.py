"""STEP files (ISO 10303-21) of rational patches and exact parametric surfaces, by Open Cascade.

Guaranteed: each patch is one face on a rational B-spline surface with the patch's own control points, weights and
knots, and exact surfaces and blends are written as their Bezier patches, so nothing is approximated but that
fractions become doubles; files are whole or not at all.  Not guaranteed: trimmed faces (a patch
is written whole), and names of faces.  Open Cascade's settings of units and product names, which are of the whole
process, are set by each call.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from pas.algebra.monomials import Floats
from pas.errors import GeometryError, MissingLibraryError
from pas.exchange.files import replacing, target
from pas.generatrix.blend import GeneratrixBlend
from pas.limits import Report, limited
from pas.parametric.blends import ParametricBlend
from pas.parametric.conversion import bezier_patches
from pas.parametric.patches import RationalPatch
from pas.parametric.surface import ParametricSurface
from pas.surface.piecewise import PiecewiseSurface

Shape = RationalPatch | ParametricSurface | ParametricBlend | GeneratrixBlend

SUFFIXES = (".step", ".stp")

UNITS = {"micrometer": "UM", "millimeter": "MM", "centimeter": "CM", "meter": "M", "inch": "INCH", "foot": "FT"}
"""Units of lengths by name, and what Open Cascade calls them."""

DEGENERATE = 1e-9
"""Sides of patches that are shorter, over the patch's size, are points to Open Cascade."""

HIGHEST_DEGREE = 25
"""In each direction: what the common kernels take."""

FORMAT = "%.16E"
"""Of numbers: doubles come back as they were, which Open Cascade's own twelve digits would round.  Its
suppression of zeros must stay off: it drops exponents of this format."""


@limited("writing a STEP file", "fewer patches")
def write_step(
    patches: Shape | Sequence[Shape],
    path: str | Path,
    *,
    domain: Any = None,
    sew: float | None = None,
    unit: str = "millimeter",
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """Write patches, exact surfaces and exact blends as the faces of a STEP file; returns the path.

    A surface or a blend is one face for each of its `bezier_patches` over `domain` (by default its own; see
    `ParametricSurface.mesh`); `fit_patch` makes patches of what is not exact.  With `sew`, faces whose sides are
    within that distance are joined to shells, and a shell that is closed becomes a solid.  `unit` is micrometer,
    millimeter, centimeter, meter, inch or foot.

    Raises `ValueError` for another suffix or unit, no patches, a degree above HIGHEST_DEGREE or a surface that is not
    exact or has an infinite domain, `TypeError` for what is no patch, surface or blend, `GeometryError` for a patch
    that Open Cascade refuses or a surface with a pole, `MissingLibraryError` without Open Cascade.
    """
    target(path, SUFFIXES, "STEP")
    if unit not in UNITS:
        raise ValueError(f"unit must be one of {', '.join(UNITS)}, not {unit!r}")
    if sew is not None and not 0 < sew < float("inf"):
        raise ValueError(f"sew must be a positive number, not {sew}")
    items = _patches(patches, domain)
    _require_library()
    with replacing(path) as temporary, _quiet():
        faces = [_face(item, number) for number, item in enumerate(items)]
        _export(_compound(faces) if sew is None else _sewn(faces, sew), temporary, Path(path).stem, UNITS[unit])
    return Path(path)


def _patches(patches: Any, domain: Any) -> list[RationalPatch]:
    """All patches, checked; an error names the item by its number."""
    items = list(patches) if isinstance(patches, Iterable) else [patches]
    if not items:
        raise ValueError("there must be at least one patch")
    found: list[RationalPatch] = []
    for number, item in enumerate(items):
        surface = item.surface if isinstance(item, ParametricBlend | GeneratrixBlend) else item
        if isinstance(surface, ParametricSurface) and not surface.is_exact:
            raise ValueError(f"patches[{number}] is not exact; write fit_patch(surface, tolerance) in its place")
        if isinstance(surface, ParametricSurface):
            found += bezier_patches(surface, domain)
        elif isinstance(surface, RationalPatch):
            found.append(surface)
        else:
            raise TypeError(_refusal(item))
        if max(found[-1].degrees) > HIGHEST_DEGREE:
            raise ValueError(
                f"patches[{number}] has the degrees {found[-1].degrees}, but STEP is read up to {HIGHEST_DEGREE}; "
                "write fit_patch(surface, tolerance) in its place"
            )
    return found


def _refusal(item: Any) -> str:
    if isinstance(getattr(item, "surface", item), PiecewiseSurface):
        return (
            "STEP has faces with parameters only, and a piecewise algebraic surface has none; write its triangles "
            "with pas.write_mesh(surface.mesh(), 'name.stl') or pas.write_solid(blend.solid(), 'name.3mf')"
        )
    return f"patches must be RationalPatch objects, parametric surfaces or parametric blends, not {item!r}"


def _require_library() -> None:
    try:
        import OCP.STEPControl  # noqa: F401
    except ImportError:
        raise MissingLibraryError("STEP files need Open Cascade: pip install 'pas[step]'") from None


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
    made = BRepBuilderAPI_MakeFace(surface, DEGENERATE * size)
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
    text.FloatWriter().SetFormat(FORMAT)
    text.SendModel(STEPEdit.Protocol_s())
    if not text.Print(buffer):
        raise GeometryError("Open Cascade could not write the patches as STEP")
    path.write_bytes(buffer.getvalue())
