"""Shapes of Open Cascade made of charts and borders: vertices, edges and faces that share these, shells and solids.

Everything is made in a solid's local coordinates, in which it is of size 1, as Open Cascade's smallest lengths are
absolute; the whole is then moved to where it belongs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from pas.algebra.monomials import Floats
from pas.exchange.step.borders import DEGREE, Borders, ChartBorder, Curve, CurveKind
from pas.exchange.step.carriers import CarrierKind
from pas.exchange.step.division import Graph, Parameters
from pas.exchange.step.parameters import CarrierParameters, QuadricPatch
from pas.mesh.topology import connected

LEAST = 1e-7
"""Open Cascade's smallest tolerance."""


class ShapeMaker:
    """The solid of an atlas with parameters and curves for its charts and borders, in local coordinates."""

    def __init__(self, borders: Borders, parameters: dict[int, Parameters], curves: Sequence[Curve]) -> None:
        from OCP.BRep import BRep_Builder

        self.borders, self.parameters, self.curves = borders, parameters, curves
        self._builder = BRep_Builder()
        self.surfaces = {chart: surface_of(found) for chart, found in parameters.items()}
        self.gap = 0.0
        self.natural = {chart: self._is_natural(chart) for chart in parameters}
        self._edges()
        self.faces = {chart: self._face(chart) for chart in parameters}

    def _edges(self) -> None:
        from OCP.TopAbs import TopAbs_Orientation
        from OCP.TopLoc import TopLoc_Location
        from OCP.TopoDS import TopoDS_Edge, TopoDS_Vertex

        builder, here = self._builder, TopLoc_Location()
        self.vertices: dict[int, Any] = {}
        self.edges: dict[int, Any] = {}
        reach: dict[int, float] = {}
        for border, curve in zip(self.borders.borders, self.curves, strict=True):
            edge = TopoDS_Edge()
            tolerance = LEAST
            pcurves = []
            for chart in (border.left, border.right):
                found = self.parameters[chart]
                if isinstance(found, CarrierParameters) and found.carrier.kind is CarrierKind.PLANE:
                    continue
                flat = flat_curve(found, curve)
                pcurves.append((chart, flat))
                tolerance = max(tolerance, self._gap(chart, flat, curve))
            self.gap = max(self.gap, tolerance)
            builder.MakeEdge(edge, curve_of(curve), tolerance)
            for chart, flat in pcurves:
                builder.UpdateEdge(edge, flat_spline(flat), self.surfaces[chart], here, tolerance)
            ends = border.chain[0], border.chain[-1]
            for end, way in zip(
                ends, (TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED), strict=True
            ):
                if end not in self.vertices:
                    self.vertices[end] = TopoDS_Vertex()
                    builder.MakeVertex(self.vertices[end], point_of(self.borders.points[end]), LEAST)
                reach[end] = max(reach.get(end, LEAST), tolerance)
                builder.Add(edge, self.vertices[end].Oriented(way))
            builder.Range(edge, curve.start, curve.end)
            self.edges[id(border)] = edge
        for end, tolerance in reach.items():
            builder.UpdateVertex(self.vertices[end], 1.01 * tolerance)

    def _gap(self, chart: int, flat: BSpline, curve: Curve) -> float:
        """How far a curve is at most from what its parameters say on a chart: twice the largest distance at points.

        It is a little larger between them, and Open Cascade looks at others.
        """
        places = curve.parameters(33)
        points = [self.surfaces[chart].Value(*uv) for uv in flat(places).tolist()]
        there = np.array([(p.X(), p.Y(), p.Z()) for p in points])
        return 2 * float(np.linalg.norm(there - curve(places), axis=1).max())

    def _face(self, chart: int) -> Any:
        """The face of a chart, outside out."""
        from OCP.TopAbs import TopAbs_Orientation
        from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Wire

        builder, face, surface = self._builder, TopoDS_Face(), self.surfaces[chart]
        builder.MakeFace(face, surface, LEAST)
        natural = self.natural[chart]
        for loop in self.borders.loops(chart):
            wire = TopoDS_Wire()
            builder.MakeWire(wire)
            directed = loop if natural else [(border, not forward) for border, forward in reversed(loop)]
            for number, (border, forward) in enumerate(directed):
                way = TopAbs_Orientation.TopAbs_FORWARD if forward else TopAbs_Orientation.TopAbs_REVERSED
                builder.Add(wire, TopoDS.Edge(self.edges[id(border)].Oriented(way)))
                apex = self._apex(chart, directed[number], directed[(number + 1) % len(directed)])
                if apex is not None:
                    builder.Add(wire, apex)
            wire.Closed(True)
            builder.Add(face, wire)
        return face if natural else TopoDS.Face(face.Reversed())

    def _is_natural(self, chart: int) -> bool:
        """Whether the surface's own normal points outwards."""
        from OCP.gp import gp_Pnt, gp_Vec

        atlas, found = self.borders.atlas, self.parameters[chart]
        rows = atlas.rows(chart)
        corners = atlas.points[atlas.triangles[rows]]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        middle = corners[int(np.argmax(areas))].mean(axis=0)
        point, u, v = gp_Pnt(), gp_Vec(), gp_Vec()
        self.surfaces[chart].D1(*found.uv(middle[None])[0].tolist(), point, u, v)
        normal = u.Crossed(v)
        outwards = atlas.sheets[chart].normals(middle[None])[0]
        return bool(np.array([normal.X(), normal.Y(), normal.Z()]) @ outwards > 0)

    def _apex(self, chart: int, one: tuple[ChartBorder, bool], other: tuple[ChartBorder, bool]) -> Any:
        """The edge without length at a cone's apex, between two others that meet there; None elsewhere."""
        from OCP.TopAbs import TopAbs_Orientation
        from OCP.TopLoc import TopLoc_Location
        from OCP.TopoDS import TopoDS_Edge

        found = self.parameters[chart]
        if not isinstance(found, CarrierParameters) or found.carrier.kind is not CarrierKind.CONE:
            return None
        vertex = one[0].chain[-1 if one[1] else 0]
        if np.linalg.norm(self.borders.points[vertex] - found.carrier.place) > LEAST:
            return None
        ends = []
        for (border, forward), last in ((one, True), (other, False)):
            curve = self.curves[self.borders.borders.index(border)]
            ends.append(flat_curve(found, curve)(curve.end if forward == last else curve.start))
        if np.linalg.norm(ends[0] - ends[1]) < LEAST:
            return None
        builder, edge = self._builder, TopoDS_Edge()
        flat = BSpline(np.array([0.0, 0.0, 1.0, 1.0]), np.array(ends), 1)
        builder.MakeEdge(edge)
        builder.UpdateEdge(edge, flat_spline(flat), self.surfaces[chart], TopLoc_Location(), LEAST)
        builder.Degenerated(edge, True)
        builder.Add(edge, self.vertices[vertex].Oriented(TopAbs_Orientation.TopAbs_FORWARD))
        builder.Add(edge, self.vertices[vertex].Oriented(TopAbs_Orientation.TopAbs_REVERSED))
        builder.Range(edge, 0.0, 1.0)
        return edge

    def solids(self) -> list[Any]:
        """A solid for each outer surface, with the surfaces of its cavities."""
        from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid

        charts = sorted(self.faces)
        place = {chart: number for number, chart in enumerate(charts)}
        ends = np.array([(place[b.left], place[b.right]) for b in self.borders.borders], dtype=np.intp).reshape(-1, 2)
        part = connected(ends, len(charts))
        atlas = self.borders.atlas
        shells, corners = [], []
        for number in range(int(part.max()) + 1):
            mine = [chart for chart, p in zip(charts, part, strict=True) if p == number]
            shell = TopoDS_Shell()
            self._builder.MakeShell(shell)
            for chart in mine:
                self._builder.Add(shell, self.faces[chart])
            shell.Closed(True)
            shells.append(shell)
            corners.append(atlas.points[atlas.triangles[np.isin(atlas.chart, mine)]])
        volumes = [float(np.einsum("ti,ti->", c[:, 0], np.cross(c[:, 1], c[:, 2]))) for c in corners]
        solids = {}
        for number in np.flatnonzero(np.array(volumes) > 0).tolist():
            solids[number] = TopoDS_Solid()
            self._builder.MakeSolid(solids[number])
            self._builder.Add(solids[number], shells[number])
        for number in np.flatnonzero(np.array(volumes) <= 0).tolist():
            point = corners[number][0].mean(axis=0)
            around = [k for k in solids if _winding(corners[k], point) > 0.5]
            self._builder.Add(solids[min(around, key=lambda k: volumes[k])], shells[number])
        return list(solids.values())


def _winding(corners: Floats, point: Floats) -> float:
    """How often a closed mesh with corners (T, 3, 3) goes around a point (van Oosterom and Strackee 1983)."""
    a, b, c = (corners - point).transpose(1, 0, 2)
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    over = np.einsum("ti,ti->t", a, np.cross(b, c))
    under = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return float(np.arctan2(over, under).sum() / (2 * np.pi))


def flat_curve(found: Parameters, curve: Curve) -> BSpline:
    """A curve in the parameters of a chart, by its own parameter: straight where it is that, else a quintic spline."""
    if isinstance(found, Graph) and curve.spline is not None:
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
    from OCP.collections import Array2_double, Array2_gp_Pnt
    from OCP.Geom import (
        Geom_BSplineSurface,
        Geom_ConicalSurface,
        Geom_CylindricalSurface,
        Geom_Plane,
        Geom_SphericalSurface,
        Geom_ToroidalSurface,
    )
    from OCP.gp import gp_Ax3, gp_Dir

    if isinstance(found, Graph | QuadricPatch):
        grid = found.poles
        poles = Array2_gp_Pnt(1, grid.shape[0], 1, grid.shape[1])
        for i, j in np.ndindex(grid.shape[:2]):
            poles.SetValue(i + 1, j + 1, point_of(grid[i, j]))
        (u, many), (v, times) = (knots_of(k) for k in found.knots)
        if isinstance(found, Graph):
            return Geom_BSplineSurface(poles, u, v, many, times, DEGREE, DEGREE)
        weights = Array2_double(1, grid.shape[0], 1, grid.shape[1])
        for i, j in np.ndindex(grid.shape[:2]):
            weights.SetValue(i + 1, j + 1, float(found.weights[i, j]))
        return Geom_BSplineSurface(poles, weights, u, v, many, times, 2, 2)
    carrier = found.carrier
    place = carrier.place
    if carrier.kind is CarrierKind.CONE:
        place = place + found.height * found.axis
    axes = gp_Ax3(point_of(place), gp_Dir(*found.axis.tolist()), gp_Dir(*found.start.tolist()))
    match carrier.kind:
        case CarrierKind.PLANE:
            return Geom_Plane(axes)
        case CarrierKind.CYLINDER:
            return Geom_CylindricalSurface(axes, carrier.radius)
        case CarrierKind.CONE:
            return Geom_ConicalSurface(axes, float(np.arctan(carrier.radius)), found.height * carrier.radius)
        case CarrierKind.SPHERE:
            return Geom_SphericalSurface(axes, carrier.radius)
        case CarrierKind.TORUS:
            return Geom_ToroidalSurface(axes, carrier.radius, carrier.minor)


def curve_of(curve: Curve) -> Any:
    """Open Cascade's curve with the same parameter."""
    from OCP.collections import Array1_gp_Pnt
    from OCP.Geom import Geom_BSplineCurve, Geom_Circle, Geom_Ellipse, Geom_Line
    from OCP.gp import gp_Ax2, gp_Dir, gp_Vec

    if curve.spline is not None:
        poles = Array1_gp_Pnt(1, len(curve.spline.c))
        for i, pole in enumerate(curve.spline.c):
            poles.SetValue(i + 1, point_of(pole))
        return Geom_BSplineCurve(poles, *knots_of(curve.spline.t), DEGREE)
    assert curve.origin is not None and curve.first is not None
    if curve.second is None:
        return Geom_Line(point_of(curve.origin), gp_Dir(*curve.first.tolist()))
    normal = gp_Vec(*curve.first.tolist()).Crossed(gp_Vec(*curve.second.tolist()))
    axes = gp_Ax2(point_of(curve.origin), gp_Dir(normal), gp_Dir(*curve.first.tolist()))
    radii = float(np.linalg.norm(curve.first)), float(np.linalg.norm(curve.second))
    return Geom_Circle(axes, radii[0]) if curve.kind is CurveKind.CIRCLE else Geom_Ellipse(axes, *radii)


def flat_spline(spline: BSpline) -> Any:
    """A curve in parameters as Open Cascade's."""
    from OCP.collections import Array1_gp_Pnt2d
    from OCP.Geom2d import Geom2d_BSplineCurve
    from OCP.gp import gp_Pnt2d

    poles = Array1_gp_Pnt2d(1, len(spline.c))
    for i, pole in enumerate(spline.c.tolist()):
        poles.SetValue(i + 1, gp_Pnt2d(*pole))
    return Geom2d_BSplineCurve(poles, *knots_of(spline.t), spline.k)


def point_of(point: Floats) -> Any:
    """Open Cascade's point."""
    from OCP.gp import gp_Pnt

    return gp_Pnt(*map(float, point))


def knots_of(knots: Floats) -> tuple[Any, Any]:
    """The distinct knots and how often each occurs, as Open Cascade's arrays."""
    from OCP.collections import Array1_double, Array1_int

    distinct, times = np.unique(knots, return_counts=True)
    values, counts = Array1_double(1, len(distinct)), Array1_int(1, len(distinct))
    for place, (value, count) in enumerate(zip(distinct.tolist(), times.tolist(), strict=True), start=1):
        values.SetValue(place, value)
        counts.SetValue(place, count)
    return values, counts
