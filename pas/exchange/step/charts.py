"""A solid's boundary in charts: connected parts of its mesh, each on one smooth function, to become a CAD face each.

The mesh says only which faces meet where; every number in a file comes from the functions.  A face of pieces is cut at
the walls between these, so that each chart is on one polynomial; `Atlas.cut` divides charts further.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float
from pas.arrays import Floats, Integers
from pas.errors import GeometryError
from pas.exchange.step.carriers import Carrier, Plane, reducible_planes
from pas.exchange.step.parametrized import PlacedSurface, Wall, surface_of
from pas.mesh.field import column_of, orientation, place_of
from pas.mesh.halfedges import halved
from pas.mesh.labelled import Labelled
from pas.mesh.projection import CommonZeros
from pas.mesh.shading import unit_rows
from pas.mesh.topology import connected, twins_of
from pas.solid.field import SolidField
from pas.solid.functions import Pieces

ON_PLANE, NEAR = 1e-9, 1e-5
"""In a solid's local coordinates: heights over a plane below which points are on it, and the distance within which all
points of a border are on the plane that it was cut by: some are on another one, beside a line where several meet."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A smooth function, positive outside, on whose zeros charts are, in a solid's local coordinates.

    `jets` gives values and gradients (N, 4) at points (N, 3); `label` is the mesh's; `polynomial`, in these
    coordinates, is its function where that is one, and `carrier` its surface where that is one that CAD programs
    have or that has parameters.
    """

    jets: Callable[[Floats], Floats]
    label: int
    polynomial: Polynomial | None = None
    carrier: Carrier | PlacedSurface | None = None

    def normals(self, points: Floats) -> Floats:
        """Outward unit normals (N, 3)."""
        return unit_rows(self.jets(points)[:, 1:])


Functions = tuple[Sheet | Wall, ...]


class Atlas:
    """The charts of a mesh: `points` (N, 3), `triangles` (T, 3), the number of the `chart` (T,) of each.

    `sheets` are by chart; `planes`, those by which charts were cut, by label.
    """

    def __init__(self, mesh: Labelled, field: SolidField) -> None:
        self.field = field
        self.points, self.triangles, self.chart = mesh.points, mesh.triangles, mesh.labels  # until there are charts
        self._between: dict[frozenset[int], list[Plane]] = {}
        self._seams: dict[int, Sheet] = {}
        self._sheets = {label: self._sheet(label) for label in np.unique(mesh.labels).tolist()}
        self.sheets, self.planes = self._sheets, dict[int, list[Wall]]()
        for label in self._sheets:
            self.planes[label] = [] if (function := self._pieces(label)) is None else _walls(function, field)
            self.planes[label] += [wall for wall, _ in self._caps(label)]
            for wall in self.planes[label]:
                self._cut(label, wall)
        labels, self.chart, self.sheets = self.chart, np.full(len(self.triangles), -1), {}
        for label, sheet in self._sheets.items():
            rows, function = np.flatnonzero(labels == label), self._pieces(label)
            middles = self.points[self.triangles[rows]].mean(axis=1)
            if isinstance(sheet.carrier, PlacedSurface):
                number = sheet.carrier.ends(middles)
                for end, (_, ball) in enumerate(self._caps(label)):
                    self._add(rows[number == end], replace(sheet, carrier=ball))
                rows, function = rows[number < 0], None
            if function is None:
                self._add(rows, sheet)
                continue
            partition = function.partition
            number = partition.local.location.pieces(partition.frame.local_points(field.world(middles)).T, np.inf)
            for piece in np.unique(number).tolist():
                self._add(rows[number == piece], _piece_sheet(function, piece, label, field))

    def _pieces(self, label: int) -> Pieces | None:
        function = self.field.evaluator.columns[column_of(label)].function
        return function if isinstance(function, Pieces) else None

    def _caps(self, label: int) -> list[tuple[Plane, Carrier]]:
        carrier = self._sheets[label].carrier
        return carrier.caps() if isinstance(carrier, PlacedSurface) else []

    def _sheet(self, label: int) -> Sheet:
        points = self.points[np.unique(self.triangles[self.chart == label])]
        column = column_of(label)
        polynomial, carrier = self.field.evaluator.polynomial(column), surface_of(self.field, column, points)
        return Sheet(partial(self.field.jets, labels=label), label, polynomial, carrier)

    def _add(self, rows: Integers, sheet: Sheet) -> list[int]:
        """Each connected part of some triangles as a new chart; returns the charts."""
        inside = np.full(len(self.triangles), -1)
        inside[rows] = np.arange(len(rows))
        halves = (3 * rows[:, None] + np.arange(3)).ravel()
        ends = np.stack([inside[halves // 3], inside[self.twins[halves] // 3]], axis=1)
        part = connected(ends[ends[:, 1] >= 0], len(rows))
        first = max(self.sheets, default=-1) + 1
        self.chart[rows] = first + part
        made = list(range(first, first + int(part.max(initial=-1)) + 1))
        self.sheets |= dict.fromkeys(made, sheet)
        return made

    @property
    def twins(self) -> Integers:
        """The twins (3 T,) of half edges."""
        return twins_of(self.triangles, len(self.points))

    def rows(self, chart: int) -> Integers:
        """The triangles of a chart."""
        return np.flatnonzero(self.chart == chart)

    def cut(self, chart: int, plane: Wall) -> list[int]:
        """A chart divided by a wall, into the charts that are returned."""
        sheet = self.sheets[chart]
        self._cut(chart, plane)
        self.planes[sheet.label].append(plane)
        del self.sheets[chart]
        rows = self.rows(chart)
        above = self._heights(plane)[self.triangles[rows]].sum(axis=1) > 0
        return [*self._add(rows[above], sheet), *self._add(rows[~above], sheet)]

    def _heights(self, plane: Wall) -> Floats:
        heights = plane.heights(self.points)
        return np.asarray(np.where(np.abs(heights) < ON_PLANE, 0.0, heights))

    def _cut(self, chart: int, plane: Wall) -> None:
        """A chart's triangles divided where a plane crosses them, and their neighbours with them."""
        self._draw(chart, plane)
        mesh, heights = Labelled.of(self.points, self.triangles, self.chart), self._heights(plane)
        edges, charts = mesh.topology.edge_table
        crossed = np.flatnonzero((heights[edges].prod(axis=1) < 0) & (charts == chart).any(axis=1))
        if not len(crossed):
            return
        crossed = crossed[np.argsort(-mesh.lengths[crossed], kind="stable")]  # the order in which they are halved
        finer, edges, charts = halved(mesh, crossed), edges[crossed], charts[crossed]
        low, high = heights[edges].T
        start, end = self.points[edges].transpose(1, 0, 2)
        added = start + (low / (low - high))[:, None] * (end - start)
        self.points = np.concatenate([self.points, self._placed(added, edges, charts, plane)])
        self.triangles, self.chart = finer.triangles, finer.labels.copy()

    def _draw(self, chart: int, plane: Wall) -> None:
        """The vertices of a chart that are nearly on a plane moved onto it, in its face or along another plane.

        An edge beside a plane bends across it: points put on that edge later would be on the plane's other side.
        """
        sheet, beside = self.sheets[chart], 1 / 50  # of the shortest edge; edges bend by less
        same = [other for other, own in self.sheets.items() if own.label == sheet.label]
        ends = self.triangles[:, [0, 1, 2, 1, 2, 0]].reshape(-1, 2, 3).transpose(0, 2, 1).reshape(-1, 2)
        shortest = np.full(len(self.points), np.inf)
        np.minimum.at(shortest, ends, np.linalg.norm(np.subtract(*self.points[ends].swapaxes(0, 1)), axis=1)[:, None])
        near = np.zeros(len(self.points), dtype=bool)
        near[self.triangles[self.chart == chart]] = True
        near[self.triangles[~np.isin(self.chart, same)]] = False
        near &= np.abs(plane.heights(self.points)) < beside * shortest
        others = [other for other in self.planes[sheet.label] if other != plane]
        on = np.stack([~near, *(np.abs(other.heights(self.points)) < ON_PLANE for other in others)])
        near &= on.sum(axis=0) < 2  # where two others meet it stays
        first = on.argmax(axis=0) - 1
        self.points = self.points.copy()
        for place in np.unique(first[near]).tolist():
            rows, along = np.flatnonzero(near & (first == place)), others[place : place + 1] if place >= 0 else []
            moved = CommonZeros((sheet, *along, plane)).placed(self.points[rows])
            # along a plane at a small angle to this one that may be far: no edge gets shorter than half
            short = np.linalg.norm(moved - self.points[rows], axis=1) < shortest[rows] / 4
            self.points[rows[short]] = moved[short]

    def _placed(self, added: Floats, edges: Integers, charts: Integers, plane: Wall) -> Floats:
        """New points (K, 3) on edges (K, 2) between charts (K, 2) moved onto these, and onto a plane."""
        result = added.copy()
        for left, right in np.unique(charts, axis=0).tolist():
            rows = np.flatnonzero((charts == (left, right)).all(axis=1))
            if left != right:
                for row in rows.tolist():  # of several cuts each point may be on another
                    functions = (*self.meeting(left, right, self.points[edges[row]]), plane)
                    result[[row]] = CommonZeros(functions).placed(added[[row]])
                continue
            sheet = self.sheets[left]
            on = np.full(len(rows), -1)  # an edge that is on another plane stays there
            others = [other for other in self.planes[sheet.label] if other != plane]
            for place, other in enumerate(others):
                on[(np.abs(other.heights(self.points[edges[rows]])) < ON_PLANE).all(axis=1)] = place
            for place in np.unique(on).tolist():
                some, before = rows[on == place], others[place : place + 1] if place >= 0 else []
                result[some] = CommonZeros((sheet, *before, plane)).placed(added[some])
        return result

    def meeting(self, left: int, right: int, points: Floats) -> Functions:
        """The functions whose common zeros are where two charts meet near points (N, 3).

        Raises `GeometryError` where a face meets itself elsewhere than where it was cut.
        """
        sheets = self.sheets[left], self.sheets[right]
        labels = sheets[0].label, sheets[1].label
        if labels[0] == labels[1]:
            plane, off = _nearest(self.planes[labels[0]], points)
            if plane is None or off > NEAR:
                place = place_of(self.field, points[len(points) // 2])
                raise GeometryError(f"the face {self.field.face(labels[0])!r} meets itself near {place}")
            return sheets[0], plane
        placing = self.field.functions(tuple(sorted(labels)))
        if {*map(column_of, placing)} != {*map(column_of, labels)}:
            made = (Sheet(partial(self.field.jets, labels=p), p) for p in placing)
            return tuple(self._seams.setdefault(p, sheet) for p, sheet in zip(placing, made, strict=True))
        plane, _ = _nearest(self.planes_between(left, right), points)
        return sheets[0], sheets[1] if plane is None else plane

    def planes_between(self, left: int, right: int) -> list[Plane]:
        """The planes that hold all common points of two charts' quadrics, where there are such."""
        one, other = self.sheets[left], self.sheets[right]
        if one.label == other.label or one.polynomial is None or other.polynomial is None:
            return []
        key = frozenset((one.label, other.label))
        if key not in self._between:
            self._between[key] = reducible_planes(one.polynomial, other.polynomial)
        return self._between[key]


def _nearest(planes: Sequence[Wall], points: Floats) -> tuple[Wall | None, float]:
    """The plane from which points (N, 3) are least far, and how far; None of none."""
    off = [float(np.abs(plane.heights(points)).max()) for plane in planes]
    return (planes[int(np.argmin(off))], min(off)) if off else (None, np.inf)


def _walls(function: Pieces, field: SolidField) -> list[Wall]:
    """The planes between pieces, in a solid's local coordinates, each once."""
    found: dict[tuple[float, ...], Plane] = {}
    for face in function.partition.interior_faces:
        row = face.plane.dense(1)
        size = float(np.linalg.norm(row[1:]))
        normal, height = row[1:] / size, -row[0] / size
        height = float(height - normal @ field.world(np.zeros(3))) / field.scale
        signed = np.array([*normal, height]) * (1 if normal[np.argmax(np.round(np.abs(normal), 6))] > 0 else -1)
        found.setdefault(tuple((np.round(signed, 9) + 0.0).tolist()), Plane.of(normal, height))
    return list(found.values())


def _piece_sheet(function: Pieces, piece: int, label: int, field: SolidField) -> Sheet:
    """The polynomial of one piece, which goes on beyond the piece."""
    frame, batch = function.partition.frame, function.surface.evaluator.batch(0, 1)
    factors = orientation(label) * np.array([1.0, *[field.scale / to_float(frame.scale)] * 3])

    def jets(points: Floats) -> Floats:
        local = frame.local_points(field.world(points))
        return np.asarray(batch(local, np.full(len(local), piece, dtype=np.intp)) * factors)

    return Sheet(jets, label)
