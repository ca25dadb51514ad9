"""A surface and meshes of it in coordinates in which both are known exactly, for proofs.

The origin is a point of doubles, so that differences from it are rounded once; polynomials, cells and their B-forms are
worked out exactly there before they are rounded.  What depends on the surface alone is worked out once for all meshes.
"""

from __future__ import annotations

from functools import cache, cached_property, lru_cache
from itertools import combinations

import numpy as np

from pas.algebra.affine import Frame
from pas.algebra.monomials import Floats, homogeneous_exponents
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, exact_vector, to_float, to_floats
from pas.algebra.scaling import Scaled
from pas.bernstein.forms import UNIT_ROUNDOFF, b_form, nearby_forms, on_simplex
from pas.bernstein.search import Searched
from pas.bernstein.simplices import Simplices
from pas.certify.critical_points import isolated
from pas.certify.proofs import face_verdict
from pas.certify.triangle_forms import TriangleForms
from pas.mesh.field import Integers
from pas.mesh.rows import cross, dots
from pas.partition.complex import OuterFace
from pas.surface.function import PiecewisePolynomial

ON_WALL = 1e-12
"""In local units: how far points of the boundary may be off a wall, by rounding."""

OUTSIDE = 1e-11
"""In local units, or barycentric coordinates: how far points of the region may be outside, by rounding."""

ROUNDINGS = 64
"""Of a triangle's unit normal, over its longest edge squared and its area; and of points that are moved."""

SCALED = 1e-9
"""Relative error of sizes of B-coefficients that are known but for a factor."""

LARGER = 2.0
"""By how much the region is enlarged where the surface beyond its walls counts as well (exact in doubles)."""

BLOCK = 2048
"""Triangles whose places in all cells are held at once."""

BESIDE = 1e-9
"""In barycentric coordinates: how far outside a face or cell a point still counts as one of it."""


class Stage:
    """The surface's patches and cells in local coordinates."""

    def __init__(self, surface: PiecewisePolynomial) -> None:
        self.surface, self.partition = surface, surface.partition
        frame = self.partition.frame
        self.origin = np.array(to_floats(frame.origin))
        self.frame = Frame(exact_vector(self.origin.tolist()), frame.scale)
        self._same_frame = self.frame.origin == frame.origin
        scaled = surface.scaled
        if not self._same_frame:
            scaled = Scaled.of(self.frame.localise(p) for p in surface.polynomials)
        self.patches: tuple[Polynomial, ...] = scaled.polynomials
        self.degree, self.scale = max(surface.degree, 1), to_float(frame.scale)

    @cached_property
    def reach(self) -> float:
        """The largest size of a coordinate in the region and as far beyond as surfaces are followed."""
        return float(np.abs(self.corners).max()) + self.beyond

    @cached_property
    def makers(self) -> list[TriangleForms]:
        """What makes the forms of each patch on triangles in the enlarged region."""
        return [TriangleForms(patch, self.degree, self.reach) for patch in self.patches]

    def world(self, points: Floats) -> Floats:
        """The user's coordinates of points (..., 3)."""
        return self.frame.global_points(points)

    def jets(self, points: Floats) -> tuple[Floats, Floats]:
        """Values (N,) and gradients (3, N) at points (N, 3), all by one positive factor; NaN outside of a region of
        several pieces."""
        if len(self.patches) == 1:
            return self.makers[0].jets(points)
        jets = self.surface.evaluator.scaled_derivatives(self.world(points), (0, 1))
        return jets[:, 0], jets[:, 1:].T * self.scale

    @cached_property
    def exact(self) -> list[tuple[Vector, ...]]:
        """The corners of the cells, exact."""
        points = [self.frame.local_point(v) for v in self.partition.vertices]
        return [tuple(points[v] for v in cell) for cell in self.partition.cells]

    @cached_property
    def corners(self) -> Floats:
        """The corners of the cells (C, 4, 3)."""
        points = np.array([to_floats(self.frame.local_point(v)) for v in self.partition.vertices])
        return points[np.array(self.partition.cells)]

    @cached_property
    def center(self) -> Floats | None:
        """The centre of the region (3,), from which all of it is seen; None where it has none."""
        center = self.partition.center
        return None if center is None else np.array(to_floats(self.frame.local_point(center)))

    def forms(self, cells: list[tuple[Vector, ...]]) -> tuple[Floats, float]:
        """The B-coefficients (C, m) of each cell's polynomial on tetrahedra given in the same order.

        Also by how much each may be off over the largest of its tetrahedron, but for a factor that is the same for all
        of these and errs by less than `SCALED`: it is found from an exact value at a corner.
        """
        patches = [self.patches[piece] for piece in self.partition.piece_of.tolist()]
        if cells is self.exact and self._same_frame:
            forms, error = self.surface.cell_forms[0].copy(), self.surface.cell_forms[1]
        else:
            forms, error = nearby_forms([p.raw for p in patches], cells, self.degree)
        ends = [i for i, a in enumerate(homogeneous_exponents(self.degree, 4)) if max(a) == self.degree]
        largest = np.abs(forms[:, ends]).argmax(axis=1).tolist()
        known: dict[tuple[int, int], float] = {}  # by the numbers of the objects, of which many are the same
        for row, (patch, cell, corner) in enumerate(zip(patches, cells, largest, strict=True)):
            value = forms[row, ends[corner]]
            if abs(value) * SCALED > 2 * error:
                key = id(patch), id(cell[corner])
                if key not in known:
                    known[key] = float(patch.at(cell[corner]))
                forms[row] *= known[key] / value
            else:
                exact = b_form(on_simplex(patch.raw, cell), self.degree, 3)
                forms[row] = [to_float(c) for c in exact]
        return forms, error

    @cached_property
    def cell_forms(self) -> tuple[Floats, float]:
        """Those on the cells themselves."""
        return self.forms(self.exact)

    @cached_property
    def _maps(self) -> Floats:
        whole = np.concatenate([self.corners, np.ones((len(self.corners), 4, 1))], axis=2)
        return np.asarray(np.linalg.inv(whole.transpose(0, 2, 1)))

    def barycentric(self, points: Floats, cells: Integers) -> Floats:
        """Coordinates (c, 4, N) of points (N, 3) in some cells."""
        maps = self._maps[cells]
        return np.asarray(maps[:, :, :3] @ points.T + maps[:, :, 3:])

    @property
    def faces(self) -> tuple[OuterFace, ...]:
        """The outer faces, with planes in the surface's own local coordinates, which are there already."""
        return self.surface.local.outer_faces

    @cached_property
    def walls(self) -> Floats:
        """The planes (W, 4) of the outer faces, unit normals outwards and offsets."""
        faces, cells = self.faces, self.partition.cells
        owners = self.corners[[face.cell for face in faces]]
        places = np.array([[cells[face.cell].index(v) for v in face.vertices] for face in faces]).reshape(-1, 3)
        a, b, c = (owners[np.arange(len(faces)), column] for column in places.T)
        normals = cross(b - a, c - a)
        normals /= np.sqrt(dots(normals, normals))[:, None]
        normals[dots(normals, a - owners.mean(axis=1)) <= 0] *= -1
        return np.concatenate([normals, dots(normals, a)[:, None]], axis=1)

    @cached_property
    def wall_of(self) -> Integers:
        """The number of each outer face's plane (W,): faces in one plane have one number."""
        return self.surface.local.wall_of

    @cached_property
    def planes(self) -> Floats:
        """The planes (P, 4) by their numbers."""
        return self.walls[np.unique(self.wall_of, return_index=True)[1]]

    @cached_property
    def convex(self) -> bool:
        """Whether the region is all that is behind its outer faces' planes: none of its vertices is beyond one."""
        heights = self.planes[:, :3] @ self.corners.reshape(-1, 3).T - self.planes[:, 3:]
        return not self.partition.open and bool((heights <= ON_WALL).all())

    @cached_property
    def room(self) -> float:
        """The radius of a ball around the centre that no plane of an outer face cuts."""
        assert self.center is not None
        return float((self.walls[:, 3] - self.walls[:, :3] @ self.center).min())

    @property
    def beyond(self) -> float:
        """How far beyond the walls the surface is followed: in the region enlarged by `LARGER`."""
        return 0.0 if self.center is None else (LARGER - 1) * self.room

    def placed(self, points: Floats) -> tuple[np.ndarray, list[Integers]]:
        """Which points (N, 3) are in the region, but for rounding, and, of each plane of outer faces, which are on
        one of these, in order."""
        heights = self.planes[:, :3] @ points.T - self.planes[:, 3:]
        near = [np.flatnonzero(np.abs(height) <= ON_WALL) for height in heights]
        if self.convex:
            return heights.max(axis=0) <= OUTSIDE, near
        inside = np.zeros(len(points), dtype=bool)
        for cell in range(len(self.corners)):
            inside |= self.barycentric(points, np.array([cell]))[0].min(axis=0) >= -OUTSIDE
        for number, rows in enumerate(near):
            cells = np.array([face.cell for face, n in zip(self.faces, self.wall_of, strict=True) if n == number])
            near[number] = rows[self.barycentric(points[rows], cells).min(axis=1).max(axis=0) >= -BESIDE]
        return inside, near

    def touched(self, corners: Floats, larger: float = 1.0) -> list[Integers]:
        """Of each piece, of the region or of one so many times as large, which triangles (T, 3, 3) may have a point in
        it."""
        if len(self.patches) == 1:
            return [np.arange(len(corners))]
        if larger != 1:
            assert self.center is not None
            corners = self.center + (corners - self.center) / larger
        found: list[list[Integers]] = [[] for _ in self.patches]
        for start in range(0, len(corners), BLOCK):
            block = corners[start : start + BLOCK]
            apart = np.logical_and.reduce([self._outside(block[:, i]) for i in range(3)]).any(axis=1)
            for piece, cells in enumerate(self.partition.pieces):
                found[piece].append(start + np.flatnonzero(~apart[list(cells)].all(axis=0)))
        return [np.concatenate(rows) if rows else np.empty(0, dtype=np.intp) for rows in found]

    def _outside(self, points: Floats) -> np.ndarray:
        """Of points (N, 3) in which barycentric coordinates they are outside each cell, (c, 4, N)."""
        depth = self._maps[:, :, :3].reshape(-1, 3) @ points.T + self._maps[:, :, 3].reshape(-1, 1)
        return (depth < -BESIDE).reshape(len(self.corners), 4, -1)

    @cached_property
    def isolated(self) -> list[Searched[Simplices]]:
        """Where the function may have critical points in each of the strata, its forms over the largest coefficient."""
        return [isolated(forms / self.size, corners, self.cell_forms[1]) for forms, corners in self.strata]

    @cached_property
    def size(self) -> float:
        """The largest of the cells' B-coefficients."""
        return float(np.abs(self.cell_forms[0]).max())

    @cached_property
    def meets_smoothly(self) -> bool:
        """Whether the pieces are proved to meet with continuous gradients."""
        if len(self.patches) == 1:
            return True
        faces = range(len(self.partition.interior_faces))
        return not faces or (self.surface.order > 0 and all(face_verdict(self.surface, i).proved for i in faces))

    @cached_property
    def strata(self) -> list[tuple[Floats, Floats]]:
        """B-coefficients and corners of the cells, the outer faces, the edges between walls, and their ends."""
        result = [(self.cell_forms[0], self.corners)]
        faces = tuple(
            (wall, face.cell, face.vertices) for wall, face in zip(self.wall_of.tolist(), self.faces, strict=True)
        )
        for cells, at in _strata(self.partition.cells, faces):
            ons = np.array([_on_corners(self.degree, tuple(corners)) for corners in at.tolist()])
            result.append((self.cell_forms[0][cells[:, None], ons], self.corners[cells[:, None], at]))
        return result


Parts = tuple[tuple[int, ...], ...]


@lru_cache(maxsize=64)
def _strata(cells: Parts, faces: tuple[tuple[int, int, tuple[int, ...]], ...]) -> list[tuple[Integers, Integers]]:
    """The outer faces, the edges between walls and their ends, of tetrahedra and of faces with their walls, cells and
    vertices: of each kind of which there are some, in which cells (N,) they are, and which corners (N, k) of these."""
    parts: list[set[tuple[int, tuple[int, ...]]]] = [{(cell, vertices) for _, cell, vertices in faces}, set(), set()]
    for (wall, cell, vertices), (other, _, others) in combinations(faces, 2):
        common = tuple(sorted(set(vertices) & set(others)))
        if len(common) == 2 and wall != other:
            parts[1].add((cell, common))
    ends: dict[int, int] = {v: cell for cell, edge in sorted(parts[1]) for v in edge}
    parts[2] = {(cell, (v,)) for v, cell in ends.items()}
    found = []
    for part in filter(None, parts):
        at = [[k for k, v in enumerate(cells[cell]) if v in vertices] for cell, vertices in sorted(part)]
        found.append((np.array([cell for cell, _ in sorted(part)]), np.array(at)))
    return found


@cache
def _on_corners(degree: int, corners: tuple[int, ...]) -> Integers:
    """Which B-coefficients of a tetrahedron are those on the simplex that some of its corners span."""
    others = [k for k in range(4) if k not in corners]
    return np.array([i for i, a in enumerate(homogeneous_exponents(degree, 4)) if not any(a[k] for k in others)])


class Sheet:
    """A mesh on a stage: its points (N, 3) in local coordinates, triangles (T, 3), their corners (T, 3, 3) and unit
    normals (T, 3), and by how much these may be turned (T,)."""

    def __init__(self, stage: Stage, points: Floats, triangles: Integers) -> None:
        self.stage, self.triangles = stage, triangles
        self.points = (points - stage.origin) / stage.scale
        self.corners = np.take(self.points, triangles, axis=0)
        self.normals, self.loose = unit_normals(self.corners)


def unit_normals(corners: Floats) -> tuple[Floats, Floats]:
    """Unit normals (T, 3) of triangles, and by how much each may be turned, by rounding or by putting corners that are
    off a wall by rounding onto it."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    first, second, third = b - a, c - b, a - c
    across = cross(first, -third)
    area = np.maximum(np.sqrt(dots(across, across)), 1e-300)
    longest = np.maximum(np.maximum(dots(first, first), dots(second, second)), dots(third, third))
    return across / area[:, None], ROUNDINGS * UNIT_ROUNDOFF * longest / area + 8 * ON_WALL * np.sqrt(longest) / area
