"""A surface for the mesher of cells: forms on these, Newton's method, and the walls of the region."""

from __future__ import annotations

import math
from functools import cached_property
from itertools import combinations

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.mesh.rows import cross, dots, norms, off_zero
from pas.partition.complex import OuterFace
from pas.surface.function import PiecewisePolynomial
from pas.surface.sheet import INSIDE, TINY, LocalSurface, gradient_steps


class LocalField(LocalSurface):
    """The surface with its cells, and the walls of the region in which it may end.

    `rims` are the planes (k, 4), unit normals and offsets, of each wall, and then of two walls each whose line is an
    edge of the region.
    """

    def __init__(self, surface: PiecewisePolynomial) -> None:
        super().__init__(surface)
        self.surface = surface
        self._maps = surface.local.barycentric_maps if len(surface.patches) > 1 else np.empty((0, 4, 4))
        self._piece_of = np.array(surface.local.piece_of, dtype=np.intp)
        self.vertices = surface.local.points
        self.cells = np.array(surface.local.cells)
        outer = surface.local.outer_faces
        found = [_unit_plane(face) for face in outer]
        numbers = {plane: i for i, plane in enumerate(sorted({*found}))}
        planes, self.walls = np.array([*numbers]), len(numbers)
        self._wall_of = np.array([numbers[plane] for plane in found], dtype=np.intp)
        sides = [(wall, {*face.vertices}) for wall, face in zip(self._wall_of.tolist(), outer, strict=True)]
        pairs = {(min(i, j), max(i, j)) for (i, a), (j, b) in combinations(sides, 2) if i != j and len(a & b) == 2}
        self.edges: list[tuple[int, int]] = sorted(pairs)
        self.rims = [planes[[*walls]] for walls in [*((i,) for i in range(self.walls)), *self.edges]]
        self.curves = [join.curve() for join in surface.joins if np.isfinite(join.radius)]
        self.feature_size = min((join.radius for join in surface.joins), default=np.inf)

    def pieces(self, points: Floats) -> Integers:
        """The pieces of the cells in which points are deepest."""
        cells, deepest = np.zeros(len(points), dtype=np.intp), np.full(len(points), -np.inf)
        x, y, z = points.T
        for number, cell in enumerate(self._maps):
            a, b, c, d = (m[0] * x + m[1] * y + m[2] * z + m[3] for m in cell)  # barycentric coordinates
            depths = np.minimum(np.minimum(a, b), np.minimum(c, d))
            cells[depths > deepest] = number
            deepest = np.maximum(deepest, depths)
        return self._piece_of[cells]

    @cached_property
    def fixed(self) -> Bools:
        """Which rims are points: those of two walls."""
        return np.array([*(len(planes) > 1 for planes in self.rims), False])

    @cached_property
    def forms(self) -> Floats:
        """The B-coefficients (C, m) of the function on the cells, each cell's scaled by a positive number."""
        return self.surface.cell_forms[0]

    def nearest_walls(self, points: Floats) -> Integers:
        """The numbers of the walls (N,) whose faces are nearest to points (N, 3)."""
        if not len(points):
            return np.empty(0, dtype=np.intp)
        return np.asarray(self._wall_of[np.argmin(_distances(points, *self._triangles), axis=0)])

    @cached_property
    def _triangles(self) -> tuple[Floats, Floats]:
        """The outer faces (F, 3, 3), and from points' differences to a face's first corner to the shares of the other
        corners (F, 2, 3)."""
        faces = np.array([self.surface.local.points[list(face.vertices)] for face in self.surface.local.outer_faces])
        first, second = faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]
        normals = cross(first, second)
        shares = np.stack([cross(second, normals), cross(normals, first)], axis=1)
        return faces, shares / dots(normals, normals)[:, None, None]

    def within(self, points: Floats) -> bool:
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
        """Of two walls in which both ends are, that where the curve is in the region, with the surface to its left."""
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
        planes, across, back = (table[rim] for table in self._planes)
        return _onto(planes, back, _onto(planes, back, self._slid(_onto(planes, back, points), across)))

    def rim_distances(self, points: Floats, rim: Integers) -> Floats:
        """Distances (N,) of points (N, 3) in walls or edges of given numbers (N,) from the surface there, to first
        order."""
        jets = self.jets(points)
        return off_zero(jets[:, 0], _free(jets[:, 1:], self._planes[1][rim]))

    @cached_property
    def _planes(self) -> tuple[Floats, Floats, Floats]:
        """Of each wall and edge two planes (R, 2, 4), orthonormal directions (R, 2, 3) that span their normals, and the
        ways (R, 2, 3) onto both; zeros where there is one."""
        planes, across, back = (np.zeros((len(self.rims), 2, columns)) for columns in (4, 3, 3))
        for row, own in enumerate(self.rims):
            planes[row, : len(own)] = own
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
        return self._slid(points, np.zeros((len(points), 2, 3)))

    def _slid(self, points: Floats, across: Floats) -> Floats:
        """Points (N, 3) moved along gradients, and at right angles to orthonormal directions `across` (N, 2, 3), or
        zeros."""
        settled = 1e-9  # length of a step, in local units, that ends it: the next is about its square
        farthest = 0.2 * self.reach  # length of a step at most
        result, rows = np.array(points), np.arange(len(points))
        for _ in range(20):
            jets = self.jets(result[rows])
            jets[:, 1:] = _free(jets[:, 1:], across[rows])
            ways = gradient_steps(jets)
            lengths = norms(ways)
            result[rows] += ways * np.minimum(farthest / np.maximum(lengths, TINY), 1.0)[:, None]
            rows = rows[lengths > settled]
            if not len(rows):
                break
        return result


def _onto(planes: Floats, back: Floats, points: Floats) -> Floats:
    """Points (N, 3) moved onto two planes each (N, 2, 4) by the ways (N, 2, 3) onto them."""
    first, second = (dots(points, planes[:, k, :3]) - planes[:, k, 3] for k in range(2))
    return points - first[:, None] * back[:, 0] - second[:, None] * back[:, 1]


def _free(gradients: Floats, across: Floats) -> Floats:
    """The parts of gradients (N, 3) at right angles to directions (N, 2, 3)."""
    for number in range(2):
        way = across[:, number]
        gradients = gradients - dots(gradients, way)[:, None] * way
    return gradients


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
