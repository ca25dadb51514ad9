"""Surfaces in their local coordinates, as meshers ask for them: projections, gradients, curvatures; and for the mesher
of cells forms on these, Newton's method, and the walls of the region."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_fraction
from pas.kernels.library import compiled
from pas.mesh.field import RimCurve
from pas.mesh.rows import Integers, cross, dots, norms
from pas.mesh.triangulate import Beginnings
from pas.partition.complex import OuterFace
from pas.surface.function import PiecewisePolynomial

CLOSE = 1e-11
"""The last step along a gradient, in local units, that is worth another."""

INSIDE = 1e-11
"""How far outside the region a point may be by rounding: in local units, barycentric coordinates, or over the way to
where its ray leaves."""


class LocalSurface(ABC):
    """A piecewise surface at points (N, 3) in its local coordinates, scaled.

    The piece of a point is that of the cell it is deepest in; with `faces` that of the outer face through which its ray
    from 0 leaves, given for each by the map (F, 3, 3) from points to weights of the corners, and the piece (F,).
    """

    rims: Sequence[RimCurve]
    """The curves on which it ends."""

    def __init__(self, surface: PiecewisePolynomial, faces: tuple[Floats, Integers] | None = None) -> None:
        local, self.degree, self.evaluator = surface.local, max(surface.degree, 1), surface.evaluator
        self.frame = surface.partition.frame
        self.scale = float(to_fraction(self.frame.scale))
        self.reach = float(np.sqrt((local.points**2).sum(axis=1).max()))
        self._value, self._jets, self._bends = (self.evaluator.batch(*range(n)) for n in (1, 2, 3))
        pieces = len(surface.patches)
        if faces is not None:
            self._pieces = np.array([pieces, len(faces[0]), 0]), *faces
        elif pieces == 1:
            self._pieces = np.array([1, 0, 0]), np.empty((0, 4, 4)), np.empty(0, dtype=np.intp)
        else:
            maps = np.ascontiguousarray(local.barycentric_maps)
            self._pieces = np.array([pieces, 0, len(maps)]), maps, np.array(local.piece_of, dtype=np.intp)

    @cached_property
    def fixed(self) -> NDArray[np.bool_]:
        """Which of `rims` are fixed, and, at the end, that what is on none is not, (R + 1,)."""
        return np.array([*(curve.fixed for curve in self.rims), False])

    def pieces(self, points: Floats) -> Integers:
        """The numbers of the pieces (N,) that hold points, or are nearest to them."""
        found = np.empty(len(points), dtype=np.intp)
        compiled().call("pas_pieces_of", *self._pieces, len(points), points, found)
        return found

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""
        return self.frame.global_points(points)

    def values(self, points: Floats) -> Floats:
        """The values (N,)."""
        return self._value(points, self.pieces(points))[:, 0]

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4)."""
        return self._jets(points, self.pieces(points))

    def gradients(self, points: Floats) -> Floats:
        """The gradients (N, 3)."""
        return self.jets(points)[:, 1:]

    def distances(self, points: Floats) -> Floats:
        """The distances |f| / |grad f| (N,), to first order."""
        result = np.empty(len(points))
        compiled().call("pas_distances", *self._pieces, *self._jets.arrays, len(points), points, result)
        return result

    @abstractmethod
    def near(self, points: Floats) -> Floats:
        """Points (N, 3) of the surface near points inside or outside it."""

    def drawn(self, points: Floats, still: NDArray[np.bool_]) -> tuple[Floats, Floats, Floats]:
        """Points near the surface moved towards it, but for those that are `still` (N,), and gradients and curvatures
        there.

        By a step along the gradient, or as `near` does where the next one would be more than a tenth of it.
        """
        left = 0.1  # a larger share means that a point was not near the surface
        number = len(points)
        (moved, gradients), bends = np.empty((2, number, 3)), np.empty(number)
        lost = np.empty(number, dtype=np.bool_)
        given = (*self._pieces, *self._jets.arrays, *self._bends.arrays, number, points, still, left**2, CLOSE**2)
        compiled().call("pas_drawn", *given, moved, gradients, bends, lost)
        if lost.any():
            moved[lost] = self.near(points[lost])
            gradients[lost], bends[lost] = self.bending(moved[lost])
        return moved, gradients, bends

    def bending(self, points: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) and the larger of the principal curvatures' sizes (N,) at points on the surface."""
        values, bends = np.empty((2, len(points)))
        gradients = np.empty((len(points), 3))
        given = (*self._pieces, *self._bends.arrays, len(points), points)
        compiled().call("pas_bent", *given, values, gradients, bends)
        return gradients, bends

    def closed(self, points: Floats) -> tuple[Floats, Floats]:
        """Points very near the surface moved onto it along gradients, (N, 3), and the gradients (N, 3) there."""
        steps = 6  # along gradients: from very near the surface two or three do
        result, gradients = np.array(points, order="C"), np.empty((len(points), 3))
        given = (*self._pieces, *self._jets.arrays, len(points), steps, CLOSE)
        compiled().call("pas_closed", *given, result, gradients)
        return result, gradients


class LocalField(LocalSurface):
    """The surface with its cells, and the walls of the region in which it may end."""

    rims: list[WallCurve]

    def __init__(self, surface: PiecewisePolynomial) -> None:
        super().__init__(surface)
        self.surface = surface
        self.vertices = surface.local.points
        self.cells = np.array(surface.local.cells)
        outer = surface.local.outer_faces
        self.faces = [surface.local.points[list(face.vertices)] for face in outer]
        wall_of = surface.local.wall_of.tolist()
        known = {wall: _unit_plane(face) for wall, face in dict(zip(wall_of, outer, strict=True)).items()}
        found = [known[wall] for wall in wall_of]
        numbers = {plane: i for i, plane in enumerate(sorted(dict.fromkeys(found)))}
        planes, self.walls = np.array([*numbers]), len(numbers)
        self._wall_of = np.array([numbers[plane] for plane in found], dtype=np.intp)
        sides = [(wall, {*face.vertices}) for wall, face in zip(self._wall_of.tolist(), outer, strict=True)]
        pairs = {(min(i, j), max(i, j)) for (i, a), (j, b) in combinations(sides, 2) if i != j and len(a & b) == 2}
        self.edges: list[tuple[int, int]] = sorted(pairs)
        self.rims = [WallCurve(planes[[*numbers]]) for numbers in [*((i,) for i in range(self.walls)), *self.edges]]
        self.curves = [join.curve() for join in surface.joins if np.isfinite(join.radius)]
        self.feature_size = min((join.radius for join in surface.joins), default=np.inf)

    @cached_property
    def forms(self) -> Floats:
        """The B-coefficients (C, m) of the function on the cells, each cell's scaled by a positive number."""
        return self.surface.cell_forms[0]

    @cached_property
    def beginnings(self) -> Beginnings:
        """The first meshes on lattices."""
        return Beginnings(self)

    def nearest_walls(self, points: Floats) -> NDArray[np.intp]:
        """The numbers of the walls (N,) whose faces are nearest to points (N, 3)."""
        if not len(points):
            return np.empty(0, dtype=np.intp)
        return np.asarray(self._wall_of[np.argmin(_distances(points, *self._triangles), axis=0)])

    @cached_property
    def _triangles(self) -> tuple[Floats, Floats]:
        """The outer faces (F, 3, 3), and from points' differences to a face's first corner to the shares of the other
        corners (F, 2, 3)."""
        faces = np.array(self.faces)
        first, second = faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]
        normals = cross(first, second)
        shares = np.stack([cross(second, normals), cross(normals, first)], axis=1)
        return faces, shares / dots(normals, normals)[:, None, None]

    def within(self, points: Floats) -> bool:
        """Whether all points (N, 3) are in the region, but for rounding."""
        if not self._convex:
            return bool((self.surface.local.locate(points, tolerance=INSIDE) >= 0).all())
        return bool((self._heights(points) <= INSIDE).all())

    @cached_property
    def _convex(self) -> bool:
        """Whether the region is all that is behind its walls."""
        on_plane = 1e-12  # in local units: how far corners of a convex region may be beyond a wall by rounding
        return not self.surface.local.open and bool((self._heights(self.vertices) <= on_plane).all())

    def _heights(self, points: Floats) -> Floats:
        """How far points (N, 3) are beyond each wall (W, N)."""
        planes = self._planes[0][: self.walls, 0]
        return np.asarray(planes[:, :3] @ points.T - planes[:, 3:])

    def between(self, ends: Floats, rims: Integers) -> Integers:
        """See `pas.mesh.field.SheetField`: of two walls in which both ends are, that where the curve is in the region,
        with the surface to its left."""
        result = np.empty(len(ends), dtype=np.intp)
        for row, (pair, (first, second)) in enumerate(zip(ends, (rims - self.walls).tolist(), strict=True)):
            common = np.array(sorted({*self.edges[first]} & {*self.edges[second]}), dtype=np.intp)
            result[row] = common[0] if len(common) == 1 else self._between(pair, common)
        return result

    def _between(self, ends: Floats, walls: Integers) -> int:
        """The wall that one edge (2, 3) is in, of those in question or, without any, of all."""
        if not len(walls):
            return int(self.nearest_walls(ends.mean(axis=0)[None])[0])
        curve = self.on_rims(np.tile(ends.mean(axis=0), (len(walls), 1)), walls)
        left = cross(self.gradients(curve), np.tile(ends[1] - ends[0], (len(walls), 1)))
        fits = (dots(left, self._planes[0][walls, 0, :3]) < 0) & [self.within(point[None]) for point in curve]
        return int(walls[np.argmax(fits)])

    def on_rims(self, points: Floats, rim: Integers) -> Floats:
        """Points (N, 3) near walls or edges of given numbers (N,) moved to where the surface ends there."""
        return self._slid(points, self._planes, rim)

    def rim_distances(self, points: Floats, rim: Integers) -> Floats:
        """Distances (N,) of points (N, 3) in walls or edges of given numbers (N,) from the surface there, to first
        order."""
        jets, across = self.jets(points), self._planes[1][rim]
        g = jets[:, 1:]
        for way in (across[:, 0], across[:, 1]):
            g = g - dots(g, way)[:, None] * way
        return np.asarray(np.abs(jets[:, 0]) / np.maximum(norms(g), 1e-300))

    @cached_property
    def _planes(self) -> tuple[Floats, Floats, Floats]:
        """Of each wall and edge two planes (R, 2, 4), orthonormal directions (R, 2, 3) that span their normals, and the
        ways (R, 2, 3) onto both; zeros where there is one."""
        planes, across, back = (np.zeros((len(self.rims), 2, columns)) for columns in (4, 3, 3))
        for row, curve in enumerate(self.rims):
            planes[row, : len(curve.planes)] = curve.planes
        across[:, 0] = back[:, 0] = planes[:, 0, :3]
        edges = slice(self.walls, None)
        first, second = planes[edges, 0, :3], planes[edges, 1, :3]
        cosine = dots(first, second)[:, None]
        square = 1 - cosine * cosine  # of the sine: they are not parallel
        across[edges, 1] = (second - cosine * first) / np.sqrt(square)
        back[edges] = np.stack([first - cosine * second, second - cosine * first], axis=1) / square[:, :, None]
        return planes, across, back

    def near(self, points: Floats) -> Floats:
        """Points moved onto the surface along gradients."""
        none = np.empty((0, 2, 4))
        return self._slid(points, (none, none, none), np.empty(0, dtype=np.intp))

    def _slid(self, points: Floats, walls: tuple[Floats, Floats, Floats], numbers: Integers) -> Floats:
        """Points (N, 3) moved along gradients, onto walls (see `_planes`) of given numbers (N,) where there are any."""
        steps = 20  # of Newton's method along gradients
        settled = 1e-9  # length of a step, in local units, that ends it: the next is about its square
        farthest = 0.2  # length of a step at most, over the region's reach
        result = np.array(points, order="C")
        given = (*self._pieces, *self._jets.arrays, len(walls[0]), *walls, numbers)
        compiled().call("pas_slid", *given, steps, settled, farthest * self.reach, len(result), result)
        return result


@dataclass(frozen=True, eq=False)
class WallCurve:
    """Where a surface ends on a plane, or on the line of two planes (unit normals and offsets, (k, 4))."""

    planes: Floats

    @property
    def fixed(self) -> bool:
        """Whether its points are ends of curves, which stay."""
        return len(self.planes) > 1

    def off(self, points: Floats) -> Floats:
        """How far points (N, 3) are from the planes."""
        return np.asarray(np.abs(points @ self.planes[:, :3].T - self.planes[:, 3]).max(axis=1))


def _unit_plane(face: OuterFace) -> tuple[float, ...]:
    """The unit normal and offset of a face's plane, (4,)."""
    constant, *slope = face.plane.dense(1).tolist()
    length = math.sqrt(sum(s * s for s in slope))
    return tuple(round(value, 14) for value in (*(s / length for s in slope), -constant / length))


def _distances(points: Floats, triangles: Floats, shares_of: Floats) -> Floats:
    """How far points (N, 3) are from triangles (F, 3, 3), (F, N): from the point of each with the nearest barycentric
    coordinates that are not negative.  For `shares_of` see `LocalField._triangles`."""
    way = points.T - triangles[:, 0, :, None]
    shares = shares_of @ way
    weights = np.maximum(np.concatenate([1 - shares.sum(axis=1, keepdims=True), shares], axis=1), 0)
    weights /= weights.sum(axis=1, keepdims=True)
    apart = points.T - triangles.transpose(0, 2, 1) @ weights
    return np.asarray((apart * apart).sum(axis=1))
