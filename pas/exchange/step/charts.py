"""A solid's boundary in charts: connected parts of its mesh, each on one smooth function, to become a CAD face each.

The mesh says only which faces meet where; every number in a file comes from the functions.  A face of pieces is cut at
the walls between these, so that each chart is on one polynomial; `Atlas.cut` divides charts further.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float
from pas.errors import GeometryError
from pas.exchange.step.carriers import Carrier, carrier_of, reducible_planes
from pas.mesh.field import place_of
from pas.mesh.labelled import Labelled
from pas.mesh.projection import newton
from pas.mesh.topology import connected, twins_of
from pas.solid.field import SolidField
from pas.solid.functions import Pieces

Integers = NDArray[np.intp]
Plane = tuple[Floats, float]
"""The points with n.x = d, as (n, d) with |n| = 1."""


class CommonZeros:
    """CommonZeros by number, in a solid's local coordinates, as `pas.mesh.projection` wants them."""

    def __init__(self) -> None:
        self._jets: list[Callable[[Floats], Floats]] = []
        self._numbers: dict[object, int] = {}

    def number(self, key: object, jets: Callable[[Floats], Floats]) -> int:
        """That of a function, by a key."""
        if key not in self._numbers:
            self._numbers[key] = len(self._jets)
            self._jets.append(jets)
        return self._numbers[key]

    def plane(self, plane: Plane) -> int:
        """That of a plane."""
        normal, height = plane

        def jets(points: Floats) -> Floats:
            values = points @ normal - height
            return np.concatenate([values[:, None], np.broadcast_to(normal, points.shape)], axis=1)

        return self.number((*normal.tolist(), height), jets)

    def jets(self, points: Floats, label: int | Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3) of one function, or of each point's own (N,)."""
        labels = np.asarray(label, dtype=np.intp)
        if labels.ndim == 0 or (labels == labels[:1]).all():
            return self._jets[int(labels.ravel()[0])](points)
        result = np.empty((len(points), 4))
        for number in np.unique(labels):
            rows = labels == number
            result[rows] = self._jets[int(number)](points[rows])
        return result

    def placed(self, points: Floats, numbers: tuple[int, ...]) -> Floats:
        """Points (N, 3) moved onto the common zeros of functions."""
        if not len(points):
            return points
        each = np.tile(np.array(numbers, dtype=np.intp), (len(points), 1))
        # How far a step may move a point of a mesh, in local coordinates, when it is put on its curve.
        reach = 0.05
        return newton(points, self, each, np.full(len(points), reach))


Bools = NDArray[np.bool_]

ON_PLANE = 1e-9
"""Heights over a plane, in a solid's local coordinates, below which points are on it."""

NEAR = 1e-6
"""Distance, in local coordinates, within which all points of a border are on the plane that it was cut by."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A smooth function, positive outside, on whose zeros charts are, in a solid's local coordinates.

    `jets` gives values and gradients (N, 4) at points (N, 3); `label` is the mesh's; `polynomial`, in these
    coordinates, is its function where that is one, and `carrier` its surface where that is one that CAD programs have.
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
        self.functions = CommonZeros()
        self._between: dict[frozenset[int], list[Plane]] = {}
        self.planes: dict[int, list[Plane]] = {int(label): [] for label in np.unique(mesh.labels)}
        self.chart = np.array(mesh.labels, dtype=np.intp)  # until there are charts, their labels
        self.sheets = {label: self._sheet(label) for label in self.planes}
        pieces = {label: self._pieces(label) for label in self.planes}
        for label, function in pieces.items():
            for wall in [] if function is None else _walls(function, field):
                self._cut(np.flatnonzero(self.chart == label), wall)
                self.planes[label].append(wall)
        sheets, self.sheets = self.sheets, {}
        labels, self.chart = self.chart, np.full(len(self.triangles), -1, dtype=np.intp)
        for label, function in pieces.items():
            rows = np.flatnonzero(labels == label)
            if function is None:
                self._add(rows, sheets[label])
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
        sheet = self.sheets[chart]
        self._cut(self.rows(chart), plane)
        self.planes[sheet.label].append(plane)
        del self.sheets[chart]
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
        added = self.points[low] + share[:, None] * (self.points[high] - self.points[low])
        self.points = np.concatenate([self.points, self._placed(added, wanted, keys, plane)])
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

    def _placed(self, added: Floats, wanted: Integers, keys: Integers, plane: Plane) -> Floats:
        """New points (K, 3) on edges of some keys moved onto the charts beside these, and onto a plane."""
        order = np.argsort(keys.ravel(), kind="stable")
        first = np.searchsorted(keys.ravel()[order], wanted)
        pairs = np.sort(self.chart[order[np.stack([first, first + 1], axis=1)] // 3], axis=1)
        result, number = added.copy(), self.functions.plane(plane)
        for pair in np.unique(pairs, axis=0):
            rows = np.flatnonzero((pairs == pair).all(axis=1))
            left, right = pair.tolist()
            if left != right:
                for row in rows.tolist():  # of several cuts each point may be on another
                    functions = (*self.meeting(left, right, added[[row]])[0], number)
                    result[[row]] = self.functions.placed(added[[row]], functions)
                continue
            sheet, ends = self.sheets[left], np.stack([wanted // len(self.points), wanted % len(self.points)])[:, rows]
            on = np.zeros(len(rows), dtype=np.intp)  # an edge that is on an earlier plane stays there
            for place, (normal, height) in enumerate(self.planes[sheet.label], start=1):
                on[(np.abs(self.points[ends] @ normal - height) < ON_PLANE).all(axis=0)] = place
            for place in np.unique(on).tolist():
                earlier = [self.functions.plane(p) for p in self.planes[sheet.label][place - 1 : place] if place]
                some = rows[on == place]
                result[some] = self.functions.placed(added[some], (self._number(sheet), *earlier, number))
        return result

    def meeting(self, left: int, right: int, points: Floats) -> tuple[tuple[int, ...], int]:
        """The functions whose common zeros are where two charts meet near points (N, 3), and the order GC^k of contact.

        That is 9 where one face was cut, and 0 where nothing says that the faces touch.
        """
        sheets = self.sheets[left], self.sheets[right]
        labels = sheets[0].label, sheets[1].label
        if labels[0] == labels[1]:
            planes = self.planes[labels[0]]
            off = [float(np.abs(points @ n - d).max()) for n, d in planes]
            if not off or min(off) > NEAR:
                place = place_of(self.field, points[len(points) // 2])
                raise GeometryError(f"the face {self.field.face(labels[0])!r} meets itself near {place}")
            return (self._number(sheets[0]), self.functions.plane(planes[int(np.argmin(off))])), 9
        placing = self.field.functions(tuple(sorted(labels)))
        if {p // 2 for p in placing} != {label // 2 for label in labels}:
            return tuple(self.functions.number(p, partial(_jets, self.field, p)) for p in placing), 1
        planes = self.planes_between(left, right)
        off = [float(np.abs(points @ n - d).max()) for n, d in planes]
        if off:
            return (self._number(sheets[0]), self.functions.plane(planes[int(np.argmin(off))])), 0
        return (self._number(sheets[0]), self._number(sheets[1])), 0

    def planes_between(self, left: int, right: int) -> list[Plane]:
        """The planes that hold all common points of two charts' quadrics, where there are such."""
        one, other = self.sheets[left], self.sheets[right]
        if one.label == other.label or one.polynomial is None or other.polynomial is None:
            return []
        key = frozenset((one.label, other.label))
        if key not in self._between:
            self._between[key] = reducible_planes(one.polynomial, other.polynomial)
        return self._between[key]

    def _number(self, sheet: Sheet) -> int:
        return self.functions.number(sheet, sheet.jets)


def _jets(field: SolidField, label: int, points: Floats) -> Floats:
    return field.jets(points, label)


def _walls(function: Pieces, field: SolidField) -> list[Plane]:
    """The planes between pieces, in a solid's local coordinates, each once."""
    found: dict[tuple[float, ...], Plane] = {}
    for face in function.partition.interior_faces:
        row = face.plane.dense(1)
        size = float(np.linalg.norm(row[1:]))
        normal, height = row[1:] / size, -row[0] / size
        plane = normal, float(height - normal @ field.world(np.zeros(3))) / field.scale
        signed = np.array([*normal, plane[1]]) * (1 if normal[np.argmax(np.round(np.abs(normal), 6))] > 0 else -1)
        found.setdefault(tuple((np.round(signed, 9) + 0.0).tolist()), plane)
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
