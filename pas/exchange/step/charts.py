"""A solid's boundary in charts: connected parts of its mesh, each on one smooth function, to become a CAD face each.

The mesh says only which faces meet where; every number in a file comes from the functions.  A face of pieces is cut at
the walls between these, so that each chart is on one polynomial; `Atlas.cut` divides charts further.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float
from pas.exchange.step.carriers import Carrier, carrier_of
from pas.mesh.labelled import Labelled
from pas.mesh.topology import connected, twins_of
from pas.solid.field import SolidField
from pas.solid.functions import Pieces

Integers = NDArray[np.intp]
Bools = NDArray[np.bool_]
Plane = tuple[Floats, float]
"""The points with n.x = d, as (n, d) with |n| = 1."""

ON_PLANE = 1e-9
"""Heights over a plane, in a solid's local coordinates, below which points are on it."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A smooth function, positive outside, on whose zeros charts are, in a solid's local coordinates.

    `jets` gives values and gradients (N, 4) at points (N, 3); `label` is the mesh's; `polynomial`, in these coordinates,
    is its function where that is one, and `carrier` its surface where that is one that CAD programs have.
    """

    jets: Callable[[Floats], Floats]
    label: int
    polynomial: Polynomial | None = None
    carrier: Carrier | None = None

    def normals(self, points: Floats) -> Floats:
        """Outward unit normals (N, 3)."""
        slopes = self.jets(points)[:, 1:]
        return np.asarray(slopes / np.maximum(np.linalg.norm(slopes, axis=1, keepdims=True), 1e-300))


class Atlas:
    """The charts of a mesh: `points` (N, 3), `triangles` (T, 3), the number of the `chart` (T,) of each.

    `sheets` are by chart; `planes`, those by which charts were cut, by label.
    """

    def __init__(self, mesh: Labelled, field: SolidField) -> None:
        self.field = field
        self.points, self.triangles = np.array(mesh.points), np.array(mesh.triangles)
        self.sheets: dict[int, Sheet] = {}
        self.planes: dict[int, list[Plane]] = {int(label): [] for label in np.unique(mesh.labels)}
        self.chart = np.array(mesh.labels, dtype=np.intp)  # until there are charts, their labels
        pieces = {label: self._pieces(label) for label in self.planes}
        for label, function in pieces.items():
            for wall in [] if function is None else _walls(function, field):
                self._cut(np.flatnonzero(self.chart == label), wall)
                self.planes[label].append(wall)
        labels, self.chart = self.chart, np.full(len(self.triangles), -1, dtype=np.intp)
        for label, function in pieces.items():
            rows = np.flatnonzero(labels == label)
            if function is None:
                self._add(rows, self._sheet(label))
                continue
            partition, middles = function.partition, self.points[self.triangles[rows]].mean(axis=1)
            local = partition.frame.local_points(field.world(middles))
            number = partition.local.location.pieces(local.T, np.inf)
            for piece in np.unique(number):
                self._add(rows[number == piece], _piece_sheet(function, int(piece), label, field))

    def _pieces(self, label: int) -> Pieces | None:
        function = self.field.evaluator.columns[label // 2].function
        return function if isinstance(function, Pieces) else None

    def _sheet(self, label: int) -> Sheet:
        polynomial = self.field.evaluator.polynomial(label // 2)
        carrier = None if polynomial is None else carrier_of(polynomial)
        return Sheet(lambda points: self.field.jets(points, label), label, polynomial, carrier)

    def _add(self, rows: Integers, sheet: Sheet) -> list[int]:
        """Each connected part of some triangles as a new chart; returns the charts."""
        inside = np.full(len(self.triangles), -1, dtype=np.intp)
        inside[rows] = np.arange(len(rows))
        halves = np.flatnonzero(np.repeat(inside >= 0, 3))
        ends = np.stack([inside[halves // 3], inside[self._twins[halves] // 3]], axis=1)
        part = connected(ends[ends[:, 1] >= 0], len(rows))
        first = max(self.sheets, default=-1) + 1
        self.chart[rows] = first + part
        made = list(range(first, first + int(part.max(initial=-1)) + 1))
        self.sheets |= dict.fromkeys(made, sheet)
        return made

    @property
    def _twins(self) -> Integers:
        return twins_of(self.triangles, len(self.points))

    def rows(self, chart: int) -> Integers:
        """The triangles of a chart."""
        return np.flatnonzero(self.chart == chart)

    def cut(self, chart: int, plane: Plane) -> list[int]:
        """A chart divided by a plane, into the charts that are returned."""
        sheet = self.sheets.pop(chart)
        self._cut(self.rows(chart), plane)
        self.planes[sheet.label].append(plane)
        rows = self.rows(chart)
        above = self._heights(plane)[self.triangles[rows]].sum(axis=1) > 0
        return [*self._add(rows[above], sheet), *self._add(rows[~above], sheet)]

    def _heights(self, plane: Plane) -> Floats:
        heights = self.points @ plane[0] - plane[1]
        return np.asarray(np.where(np.abs(heights) < ON_PLANE, 0.0, heights))

    def _cut(self, rows: Integers, plane: Plane) -> None:
        """Triangles divided where a plane crosses them, and their neighbours with them; charts stay as they are."""
        heights = self._heights(plane)
        size, ends = len(self.points), np.stack([self.triangles, self.triangles[:, [1, 2, 0]]], axis=2)
        keys = ends.min(axis=2) * size + ends.max(axis=2)
        wanted = np.unique(keys[rows][heights[ends[rows]].prod(axis=2) < 0])
        if not len(wanted):
            return
        low, high = wanted // size, wanted % size
        share = heights[low] / (heights[low] - heights[high])
        self.points = np.concatenate([self.points, self.points[low] + share[:, None] * (self.points[high] - self.points[low])])
        place = np.searchsorted(wanted, keys).clip(max=len(wanted) - 1)
        crossed = wanted[place] == keys
        middle, number = size + place, crossed.sum(axis=1)
        made, source = [self.triangles[number == 0]], [np.flatnonzero(number == 0)]
        for side in range(3):
            next_, last = (side + 1) % 3, (side + 2) % 3
            one = np.flatnonzero((number == 1) & crossed[:, side])
            a, b, c = self.triangles[one][:, [side, next_, last]].T
            m = middle[one, side]
            made += [np.stack(t, axis=1) for t in ((a, m, c), (m, b, c))]
            two = np.flatnonzero((number == 2) & ~crossed[:, side])  # the side is whole, its opposite corner cut off
            a, b, c = self.triangles[two][:, [side, next_, last]].T
            m, n = middle[two, next_], middle[two, last]
            made += [np.stack(t, axis=1) for t in ((c, n, m), (a, b, m), (a, m, n))]
            source += [one, one, two, two, two]
        self.triangles, self.chart = np.concatenate(made), self.chart[np.concatenate(source)]


def _walls(function: Pieces, field: SolidField) -> list[Plane]:
    """The planes between pieces, in a solid's local coordinates, each once."""
    found: dict[tuple[float, ...], Plane] = {}
    for face in function.partition.interior_faces:
        row = face.plane.dense(1)
        size = float(np.linalg.norm(row[1:]))
        normal, height = row[1:] / size, -row[0] / size
        plane = normal, float(height - normal @ field.world(np.zeros(3))) / field.scale
        normal = normal * (1 if normal[np.abs(normal).argmax()] > 0 else -1)
        found.setdefault(tuple(np.round([*normal, abs(plane[1])], 9).tolist()), plane)
    return list(found.values())


def _piece_sheet(function: Pieces, piece: int, label: int, field: SolidField) -> Sheet:
    """The polynomial of one piece, which goes on beyond the piece."""
    frame, batch = function.partition.frame, function.surface.evaluator.batch(0, 1)
    sign = 1.0 - 2.0 * (label % 2)
    factors = sign * np.array([1.0, *[field.scale / to_float(frame.scale)] * 3])

    def jets(points: Floats) -> Floats:
        local = frame.local_points(field.world(points))
        return np.asarray(batch(local, np.full(len(local), piece, dtype=np.intp)) * factors)

    return Sheet(jets, label)
