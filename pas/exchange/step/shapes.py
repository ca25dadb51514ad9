"""Shapes of Open Cascade made of charts and borders: vertices, edges and faces that share these, shells and solids.

Everything is made in a solid's local coordinates, in which it is of size 1, as Open Cascade's smallest lengths are
absolute; the whole is then moved to where it belongs.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from OCP import Geom
from OCP.BRep import BRep_Builder
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_gp_Pnt2d, Array1_int, Array2_double, Array2_gp_Pnt
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface, Geom_Circle, Geom_Ellipse, Geom_Line
from OCP.Geom2d import Geom2d_BSplineCurve
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Pnt, gp_Pnt2d, gp_Vec
from OCP.TopAbs import TopAbs_Orientation, TopAbs_State
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shell, TopoDS_Solid, TopoDS_Vertex, TopoDS_Wire
from scipy.interpolate import BSpline, make_interp_spline

from pas.arrays import Floats
from pas.exchange.step.borders import DEGREE, Borders, Curve
from pas.exchange.step.carriers import LEAST, CarrierKind
from pas.exchange.step.parameters import CarrierParameters, Parameters, SeenPatch, SplinePatch
from pas.limits import checkpoint
from pas.mesh.topology import connected


class ShapeMaker:
    """The solid of an atlas with parameters and curves for its charts and borders, in local coordinates.

    `surfaces` are by chart, and `natural` says of which of them the own normal points outwards; `faces` are
    those that `solids` made.
    """

    def __init__(self, borders: Borders, parameters: dict[int, Parameters], curves: Sequence[Curve]) -> None:
        self.borders, self.parameters, self.curves = borders, parameters, curves
        self._builder = BRep_Builder()
        self.surfaces = {chart: surface_of(found) for chart, found in parameters.items()}
        self.natural = {chart: self._is_natural(chart) for chart in parameters}
        self.faces: dict[int, Any] = {}
        self._vertices: dict[int, Any] = {}
        self._edges = [self._edge(number) for number in range(len(curves))]

    def _edge(self, number: int) -> Any:
        """The edge of a border, with a curve in the parameters of each chart beside it, and its vertices."""
        builder, border, curve = self._builder, self.borders.borders[number], self.curves[number]
        flats = {}
        tolerance = LEAST
        for chart in (border.left, border.right):
            found = self.parameters[chart]
            if isinstance(found, SplinePatch) or found.carrier.kind is not CarrierKind.PLANE:
                flats[chart] = flat_curve(found, curve)
                tolerance = max(tolerance, self._gap(chart, flats[chart], curve))
        edge = TopoDS_Edge()
        builder.MakeEdge(edge, curve_of(curve), tolerance)
        for chart, flat in flats.items():
            builder.UpdateEdge(edge, flat_spline(flat), self.surfaces[chart], TopLoc_Location(), tolerance)
        ways = TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED
        for end, way in zip((border.chain[0], border.chain[-1]), ways, strict=True):
            if end not in self._vertices:
                self._vertices[end] = TopoDS_Vertex()
                builder.MakeVertex(self._vertices[end], point_of(self.borders.points[end]), LEAST)
            builder.UpdateVertex(self._vertices[end], 1.01 * tolerance)  # which never makes it smaller
            builder.Add(edge, self._vertices[end].Oriented(way))
        builder.Range(edge, curve.start, curve.end)
        return edge

    def _gap(self, chart: int, flat: BSpline, curve: Curve) -> float:
        """How far a curve is at most from what its parameters say on a chart: twice the largest distance at points.

        It is a little larger between them, and Open Cascade looks at others.
        """
        places = curve.parameters(33)
        there = np.array([_floats(self.surfaces[chart].Value(*uv)) for uv in flat(places).tolist()])
        return 2 * float(np.linalg.norm(there - curve(places), axis=1).max())

    def _face(self, chart: int) -> Any:
        """The face of a chart, outside out."""
        builder, face, natural = self._builder, TopoDS_Face(), self.natural[chart]
        builder.MakeFace(face, self.surfaces[chart], LEAST)
        for loop in self.borders.loops(chart):
            wire = TopoDS_Wire()
            builder.MakeWire(wire)
            directed = loop if natural else [(number, not forward) for number, forward in reversed(loop)]
            for one, other in pairwise([*directed, directed[0]]):
                way = TopAbs_Orientation.TopAbs_FORWARD if one[1] else TopAbs_Orientation.TopAbs_REVERSED
                builder.Add(wire, TopoDS.Edge(self._edges[one[0]].Oriented(way)))
                apex = self._apex(chart, one, other)
                if apex is not None:
                    builder.Add(wire, apex)
            wire.Closed(True)
            builder.Add(face, wire)
        return face if natural else TopoDS.Face(face.Reversed())

    def _is_natural(self, chart: int) -> bool:
        atlas = self.borders.atlas
        corners = atlas.points[atlas.triangles[atlas.rows(chart)]]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        middle = corners[int(np.argmax(areas))].mean(axis=0)[None]
        u, v = gp_Vec(), gp_Vec()
        self.surfaces[chart].D1(*self.parameters[chart].uv(middle)[0].tolist(), gp_Pnt(), u, v)
        return bool(_floats(u.Crossed(v)) @ atlas.sheets[chart].normals(middle)[0] > 0)

    def _apex(self, chart: int, one: tuple[int, bool], other: tuple[int, bool]) -> Any:
        """The edge without length at a cone's apex, between two others that meet there; None elsewhere."""
        found = self.parameters[chart]
        if not isinstance(found, CarrierParameters) or found.carrier.kind is not CarrierKind.CONE:
            return None
        vertex = self.borders.borders[one[0]].chain[-1 if one[1] else 0]
        if np.linalg.norm(self.borders.points[vertex] - found.carrier.place) > LEAST:
            return None
        ends = []
        for (number, forward), last in ((one, True), (other, False)):
            curve = self.curves[number]
            ends.append(flat_curve(found, curve)(curve.end if forward == last else curve.start))
        if np.linalg.norm(ends[0] - ends[1]) < LEAST:
            return None
        builder, edge = self._builder, TopoDS_Edge()
        flat = BSpline(np.array([0.0, 0.0, 1.0, 1.0]), np.array(ends), 1)
        builder.MakeEdge(edge)
        builder.UpdateEdge(edge, flat_spline(flat), self.surfaces[chart], TopLoc_Location(), LEAST)
        builder.Degenerated(edge, True)
        for way in (TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED):
            builder.Add(edge, self._vertices[vertex].Oriented(way))
        builder.Range(edge, 0.0, 1.0)
        return edge

    def solids(self) -> list[Any]:
        """A solid for each outer surface, with the surfaces of its cavities."""
        atlas, charts, solids = self.borders.atlas, np.array(sorted(self.parameters)), []
        ends = np.array([(b.left, b.right) for b in self.borders.borders], dtype=np.intp).reshape(-1, 2)
        part = connected(np.searchsorted(charts, ends), len(charts))
        shells = []
        for number in range(int(part.max()) + 1):
            mine = charts[part == number].tolist()
            shell = TopoDS_Shell()
            self._builder.MakeShell(shell)
            for chart in mine:
                checkpoint("making faces")
                self.faces[chart] = self._face(chart)
                self._builder.Add(shell, self.faces[chart])
            shell.Closed(True)
            a, b, c = atlas.points[atlas.triangles[np.isin(atlas.chart, mine)]].transpose(1, 0, 2)
            shells.append((float((a * np.cross(b, c)).sum()), shell, a[0]))
        for volume, shell, point in sorted(shells, key=lambda found: -found[0]):
            if volume > 0:
                solids.append(TopoDS_Solid())
                self._builder.MakeSolid(solids[-1])
                self._builder.Add(solids[-1], shell)
                continue
            where = [BRepClass3d_SolidClassifier(solid, point_of(point), LEAST).State() for solid in solids]
            around = [solid for solid, state in zip(solids, where, strict=True) if state == TopAbs_State.TopAbs_IN]
            self._builder.Add((around or solids)[-1], shell)  # the smallest of them
        return solids


def flat_curve(found: Parameters, curve: Curve) -> BSpline:
    """A curve in the parameters of a chart, by its own parameter: straight where it is that, else a quintic spline."""
    if curve.spline is not None and isinstance(found, SeenPatch) and found.weights is None:
        return BSpline(curve.spline.t, found.uv(curve.spline.c), DEGREE)
    number = 9
    while True:
        places = curve.parameters(2 * number - 1)
        uv = _continued(found, found.uv(curve(places)))
        share = np.linspace(0, 1, len(uv))[:, None]
        size = max(1.0, float(np.abs(uv).max()))
        if np.abs(uv[0] + share * (uv[-1] - uv[0]) - uv).max() < 1e-10 * size:
            return BSpline(np.repeat([curve.start, curve.end], 2), uv[[0, -1]], 1)
        spline = make_interp_spline(places[::2], uv[::2], k=DEGREE)
        if np.abs(spline(places[1::2]) - uv[1::2]).max() < 1e-9 * size or number > 500:
            return spline
        number = 2 * number - 1


def _continued(found: Parameters, uv: Floats) -> Floats:
    """Parameters along an edge, at a cone's apex those of the point next to it, for there is no angle."""
    if isinstance(found, CarrierParameters) and found.carrier.kind is CarrierKind.CONE:
        low = -found.height * np.hypot(1.0, found.carrier.radius)
        for end, inner in ((0, 1), (-1, -2)):
            if abs(uv[end, 1] - low) < LEAST:
                uv[end, 0] = uv[inner, 0]
    return uv


def surface_of(found: Parameters) -> Any:
    """Open Cascade's surface with some parameters."""
    if isinstance(found, SplinePatch):
        return spline_surface(found.poles, found.weights, found.knots, (found.degree, found.degree))
    carrier, place = found.carrier, found.carrier.place
    if carrier.kind is CarrierKind.CONE:
        place = place + found.height * found.axis
    axes = gp_Ax3(point_of(place), gp_Dir(*found.axis.tolist()), gp_Dir(*found.start.tolist()))
    match carrier.kind:
        case CarrierKind.PLANE:
            return Geom.Geom_Plane(axes)
        case CarrierKind.CYLINDER:
            return Geom.Geom_CylindricalSurface(axes, carrier.radius)
        case CarrierKind.CONE:
            return Geom.Geom_ConicalSurface(axes, float(np.arctan(carrier.radius)), found.height * carrier.radius)
        case CarrierKind.SPHERE:
            return Geom.Geom_SphericalSurface(axes, carrier.radius)
        case CarrierKind.TORUS:
            return Geom.Geom_ToroidalSurface(axes, carrier.radius, carrier.minor)


def spline_surface(poles: Floats, weights: Floats | None, knots: Sequence[Floats], degrees: tuple[int, int]) -> Any:
    """Open Cascade's spline with control points (m, n, 3), weights (m, n) or none, and all knots of both directions."""
    rows, columns = poles.shape[:2]
    points, values = Array2_gp_Pnt(1, rows, 1, columns), Array2_double(1, rows, 1, columns)
    for i, j in np.ndindex(rows, columns):
        points.SetValue(i + 1, j + 1, point_of(poles[i, j]))
        values.SetValue(i + 1, j + 1, 1.0 if weights is None else float(weights[i, j]))
    (u, many), (v, times) = (knots_of(k) for k in knots)
    given = (points,) if weights is None else (points, values)
    return Geom_BSplineSurface(*given, u, v, many, times, *degrees)


def curve_of(curve: Curve) -> Any:
    """Open Cascade's curve with the same parameter."""
    if curve.spline is not None:
        poles = Array1_gp_Pnt(1, len(curve.spline.c))
        for i, pole in enumerate(curve.spline.c, start=1):
            poles.SetValue(i, point_of(pole))
        return Geom_BSplineCurve(poles, *knots_of(curve.spline.t), DEGREE)
    assert curve.origin is not None and curve.first is not None
    if curve.second is None:
        return Geom_Line(point_of(curve.origin), gp_Dir(*curve.first.tolist()))
    normal = gp_Vec(*curve.first.tolist()).Crossed(gp_Vec(*curve.second.tolist()))
    axes = gp_Ax2(point_of(curve.origin), gp_Dir(normal), gp_Dir(*curve.first.tolist()))
    radii = float(np.linalg.norm(curve.first)), float(np.linalg.norm(curve.second))
    return Geom_Circle(axes, radii[0]) if curve.circle else Geom_Ellipse(axes, *radii)


def flat_spline(spline: BSpline) -> Any:
    """A curve in parameters as Open Cascade's."""
    poles = Array1_gp_Pnt2d(1, len(spline.c))
    for i, pole in enumerate(spline.c.tolist(), start=1):
        poles.SetValue(i, gp_Pnt2d(*pole))
    return Geom2d_BSplineCurve(poles, *knots_of(spline.t), spline.k)


def point_of(point: Floats) -> Any:
    """Open Cascade's point."""
    return gp_Pnt(*map(float, point))


def _floats(point: Any) -> Floats:
    return np.array([point.X(), point.Y(), point.Z()])


def knots_of(knots: Floats) -> tuple[Any, Any]:
    """The distinct knots and how often each occurs, as Open Cascade's arrays."""
    distinct, times = np.unique(knots, return_counts=True)
    values, counts = Array1_double(1, len(distinct)), Array1_int(1, len(distinct))
    for place, (value, count) in enumerate(zip(distinct.tolist(), times.tolist(), strict=True), start=1):
        values.SetValue(place, value)
        counts.SetValue(place, count)
    return values, counts
