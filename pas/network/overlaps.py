"""The solid parts of a network, exactly: nodes, and the straight parts of struts; and points inside of two of these.

A node is where the function of its blend is negative, in the interior of its region; a strut is a cylinder or cone
between its ends.  Both are open, so that solids that only touch have no point in common.  Doubles choose a point, over
the rationals it is decided whether it is inside.  Coordinates are steps of the grid about some point.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.affine import Affine
from pas.algebra.rational import Vector, dot, exact_vector, minus, moved, to_floats
from pas.arrays import Floats
from pas.surface.function import PiecewisePolynomial


@dataclass(frozen=True)
class NodeSolid:
    """The inside of a blend's surface, with the map from the blend's coordinates to the node's place."""

    surface: PiecewisePolynomial
    place: Affine

    def depths(self, points: Floats) -> Floats:
        """About how far inside points (N, 3) are; NaN outside of the region."""
        jets = self.surface.jets(self.place.inverse.points(points))
        return np.asarray(-jets[:, 0] / np.maximum(np.linalg.norm(jets[:, 1:], axis=1), 1e-300))

    def side(self, point: Vector) -> int:
        """On which side of what bounds it a point is, exact: -1 inside, 1 outside, else 0."""
        cells, at = self.surface.local, self.surface.partition.frame.local_point(self.place.inverse.exact(point))
        held = [n for n in range(len(cells.cells)) if all(plane.at(at) <= 0 for plane in cells.planes(n))]
        outer = [face.plane.at(at) for face in cells.outer_faces if face.cell in held]
        values = [self.surface.patches[cells.piece_of[n]].at(at) for n in held] or [1]
        return 1 if max(values) > 0 else -int(max(*values, *outer) < 0)

    def holds(self, point: Vector) -> bool:
        """Whether a point is inside, exact."""
        return self.side(point) < 0


@dataclass(frozen=True)
class StrutSolid:
    """The inside of a strut from its first point along a vector, between two parts of that; with its radii at both."""

    start: Vector
    way: Vector
    ends: tuple[fmpq, ...]
    radii: tuple[fmpq, ...]

    @property
    def middle(self) -> Vector:
        """The middle of its axis."""
        return moved(self.start, (sum(self.ends, fmpq(0)) / 2, self.way))

    def depths(self, points: Floats) -> Floats:
        """About how far inside points (N, 3) are."""
        start, way, ends, radii = map(to_floats, (self.start, self.way, self.ends, self.radii))
        along, square, radius = _about_axis(points.T, start, way, radii)
        room = np.minimum(along - ends[0], ends[1] - along) * np.linalg.norm(way)
        return np.asarray(np.minimum(room, radius - np.sqrt(np.maximum(square, 0))))

    def holds(self, point: Vector) -> bool:
        """Whether a point is inside, exact."""
        along, square, radius = _about_axis(point, self.start, self.way, self.radii)
        return bool(self.ends[0] < along < self.ends[1] and square < radius**2)


def _about_axis(point: Any, start: Any, way: Any, radii: Any) -> tuple[Any, Any, Any]:
    """Where a point is along a vector, in parts of it, its distance from the axis, squared, and the radius there."""
    off = minus(point, start)
    along = dot(off, way) / dot(way, way)
    return along, dot(off, off) - along**2 * dot(way, way), radii[0] + along * (radii[1] - radii[0])


def common_point(points: Floats, *solids: NodeSolid | StrutSolid) -> Vector | None:
    """The one of points (N, 3) that seems deepest inside of all solids; None where it is not in all of them."""
    depths = np.min([solid.depths(points) for solid in solids], axis=0)
    found = exact_vector(points[np.nan_to_num(depths, nan=-np.inf).argmax()].tolist())
    return found if all(solid.holds(found) for solid in solids) else None
