"""A surface and meshes of it in coordinates in which both are known exactly, for proofs.

The origin is a point of doubles, so that differences from it are rounded once; polynomials, cells and their B-forms are
worked out exactly there before they are rounded.  What depends on the surface alone is worked out once for all meshes:
parts of simplices that hold all critical points of a polynomial, too, on each of which it has a sign (how they are
found is told in docs/theory/meshes.md, under assumption 2).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from itertools import combinations

import numpy as np

from pas.algebra.affine import Frame
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import exact_vector, to_float, to_floats
from pas.algebra.scaling import Scaled, scaled
from pas.arrays import Bools, Floats, Integers
from pas.bernstein.forms import LARGEST_ERROR, SMALLEST, UNIT_ROUNDOFF, b_form, on_simplex, polar_forms
from pas.bernstein.search import Fate, Fates, Limits, Searched, search
from pas.bernstein.simplices import Simplices
from pas.certify.proofs import face_verdict
from pas.certify.triangle_forms import TriangleForms, on_corners
from pas.mesh.rows import cross, dots
from pas.surface.function import PiecewisePolynomial

ON_WALL = 1e-12
"""In local units: how far points of the boundary may be off a wall, by rounding."""

OUTSIDE = 1e-11
"""In local units, or barycentric coordinates: how far points of the region may be outside, by rounding."""

ROUNDINGS = 64
"""Of a triangle's unit normal, over its longest edge squared and its area; and of points that are moved."""

OFF = 1e-9
"""In local units: how far vertices may be from the surface, and those of the boundary from the contacts' curves."""

BEYOND = 0.5
"""In local units: how far beyond its region a surface is followed at most."""

BESIDE = 1e-9
"""In barycentric coordinates: how far outside a face or cell a point still counts as one of it."""


class FramedSurface:
    """A surface's patches and cells, the `cells` being a partition in local coordinates."""

    def __init__(self, function: PiecewisePolynomial) -> None:
        self.function, frame = function, function.partition.frame
        self.origin = np.array(to_floats(frame.origin))
        self.frame = Frame(exact_vector(self.origin.tolist()), frame.scale)
        same = self.frame.origin == frame.origin
        self.cells = function.local if same else function.partition.in_frame(self.frame)
        patches = function.scaled
        if not same:
            patches = Scaled.of(self.frame.localise(p) for p in function.polynomials)
        self.patches: tuple[Polynomial, ...] = patches.polynomials
        self.degree, self.scale = max(function.degree, 1), to_float(frame.scale)

    @cached_property
    def reach(self) -> float:
        """The largest size of a coordinate in the region and as far beyond as surfaces are followed."""
        return float(np.abs(self.corners).max()) + self.beyond

    @cached_property
    def makers(self) -> list[TriangleForms]:
        """The makers of the forms of each patch on triangles in the enlarged region."""
        return [TriangleForms(patch, self.degree, self.reach) for patch in self.patches]

    def jets(self, points: Floats) -> tuple[Floats, Floats]:
        """Values (N,) and gradients (3, N) at points (N, 3), all by one positive factor; NaN outside of the region."""
        jets = self.function.evaluator.scaled_derivatives(self.frame.global_points(points), (0, 1))
        return jets[:, 0], jets[:, 1:].T * self.scale

    @cached_property
    def corners(self) -> Floats:
        """The corners of the cells (C, 4, 3)."""
        return self.cells.points[np.array(self.cells.cells)]

    @cached_property
    def center(self) -> Floats | None:
        """The centre of the region (3,), from which all of it is seen; None where it has none."""
        return None if self.cells.center is None else np.array(to_floats(self.cells.center))

    @cached_property
    def cell_forms(self) -> tuple[Floats, float]:
        """The B-coefficients (C, m) on the cells, and by how much they may be off over the largest."""
        pieces = self.cells.piece_of.tolist()
        forms, errors = polar_forms([self.patches[piece] for piece in pieces], self.corners, self.degree)
        size = float(np.abs(forms).max())
        if size > SMALLEST and errors.max() <= LARGEST_ERROR * size:
            return forms, float(errors.max()) / size + UNIT_ROUNDOFF
        cells = map(self.cells.corners, self.cells.cells)
        exact = [on_simplex(self.patches[piece].raw, cell) for piece, cell in zip(pieces, cells, strict=True)]
        return np.array([to_floats(b_form(raw, self.degree, 3)) for raw in exact]), 2 * UNIT_ROUNDOFF

    @cached_property
    def planes(self) -> Floats:
        """The planes (P, 4) of the outer faces by their numbers, unit normals outwards and offsets."""
        faces = (self.cells.outer_faces[i] for i in np.unique(self.cells.wall_of, return_index=True)[1])
        rows = np.array([scaled(face.plane).dense(1) for face in faces]).reshape(-1, 4)
        return np.roll(rows * [-1, 1, 1, 1], -1, axis=1) / np.sqrt(dots(rows[:, 1:], rows[:, 1:]))[:, None]

    @cached_property
    def convex(self) -> bool:
        """Whether the region is all that is behind its outer faces' planes: none of its vertices is beyond one."""
        heights = self.planes[:, :3] @ self.corners.reshape(-1, 3).T - self.planes[:, 3:]
        return not self.cells.open and bool((heights <= ON_WALL).all())

    @cached_property
    def room(self) -> float:
        """The radius of a ball around the centre that no plane of an outer face cuts."""
        assert self.center is not None
        return float((self.planes[:, 3] - self.planes[:, :3] @ self.center).min())

    @cached_property
    def larger(self) -> float:
        """By how much the region is enlarged about its centre where the surface beyond its walls counts as well.

        It is a power of two, by which doubles are divided exactly, and what is moved by less than that times the room
        is in the enlarged region, as each point of the room sees all of the region.
        """
        return float(2.0 ** np.ceil(np.log2(1 + BEYOND / max(self.room, OUTSIDE))))

    @property
    def beyond(self) -> float:
        """How far beyond the walls the surface is followed."""
        return 0.0 if self.center is None else min((self.larger - 1) * self.room, BEYOND)

    def placed(self, points: Floats) -> tuple[Bools, list[Integers]]:
        """Which points (N, 3) are in the region, but for rounding, and, of each plane of outer faces, which are on
        one of these, in order."""
        heights = self.planes[:, :3] @ points.T - self.planes[:, 3:]
        near = [np.flatnonzero(np.abs(height) <= ON_WALL) for height in heights]
        if self.convex:
            return heights.max(axis=0) <= OUTSIDE, near
        inside = np.zeros(len(points), dtype=bool)
        for cell in range(len(self.corners)):
            inside |= self.cells.barycentric(points, [cell])[0].min(axis=0) >= -OUTSIDE
        for number, rows in enumerate(near):
            walls = zip(self.cells.outer_faces, self.cells.wall_of, strict=True)
            cells = [face.cell for face, n in walls if n == number]
            near[number] = rows[self.cells.barycentric(points[rows], cells).min(axis=1).max(axis=0) >= -BESIDE]
        return inside, near

    def touched(self, corners: Floats, larger: float = 1.0) -> list[Integers]:
        """For each piece, of the region or of one `larger` times as large, which triangles (T, 3, 3) may have a point
        in it."""
        if len(self.patches) == 1:
            return [np.arange(len(corners))]
        if larger != 1:
            assert self.center is not None
            corners = self.center + (corners - self.center) / larger
        found: list[list[Integers]] = [[] for _ in self.patches]
        size = 2048  # triangles whose places in all cells are held at once
        for start in range(0, len(corners), size):
            block = corners[start : start + size]
            outside = [self.cells.barycentric(block[:, i]) < -BESIDE for i in range(3)]
            apart = np.logical_and.reduce(outside).any(axis=1)
            if self.center is not None:
                cell, row = np.nonzero(~apart & ((~apart).sum(axis=0) > 1))
                apart[cell, row] = self._parted(cell, block[row] - self.center)
            for piece, cells in enumerate(self.cells.pieces):
                found[piece].append(start + np.flatnonzero(~apart[list(cells)].all(axis=0)))
        return [np.concatenate(rows) if rows else np.empty(0, dtype=np.intp) for rows in found]

    def _parted(self, cells: Integers, corners: Floats) -> Bools:
        """Which triangles (K, 3, 3) relative to the centre are parted from cells (K,) by a plane through it and a side.

        Corners of the cell, and so all of it, are seen from the centre behind the plane by an angle whose sine is s at
        least; as far out as the triangle is, that is more than `BESIDE`.
        """
        with np.errstate(all="ignore"):  # nan, which parts nothing, where the plane holds all of the triangle
            normals = np.cross(corners, np.roll(corners, -1, axis=1))
            normals *= np.sign((normals * np.roll(corners, 1, axis=1)).sum(axis=2, keepdims=True))
            normals /= np.linalg.norm(normals, axis=2, keepdims=True)
            ways = (self.corners - np.asarray(self.center))[cells]
            sines = np.einsum("kni,kci->knc", normals, ways) / np.linalg.norm(ways, axis=2)[:, None]
            behind = -np.where((ways == 0).all(axis=2)[:, None], -1.0, sines).max(axis=2)
            middle = corners.mean(axis=1, keepdims=True)
            out = (corners * middle).sum(axis=2).min(axis=1, keepdims=True) / np.linalg.norm(middle, axis=2)
            return np.asarray((behind * np.maximum(out, 0) > BESIDE).any(axis=1))

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
        faces = range(len(self.cells.interior_faces))
        return not faces or (self.function.order > 0 and all(face_verdict(self.function, i).proved for i in faces))

    @cached_property
    def strata(self) -> list[tuple[Floats, Floats]]:
        """B-coefficients and corners of the cells, the outer faces, the edges between walls, and their ends."""
        cells, outer, result = self.cells.cells, self.cells.outer_faces, [(self.cell_forms[0], self.corners)]
        edges = {
            (one.cell, common)
            for (wall, one), (beside, other) in combinations(zip(self.cells.wall_of.tolist(), outer, strict=True), 2)
            if len(common := tuple(sorted({*one.vertices} & {*other.vertices}))) == 2 and wall != beside
        }
        ends = {v: cell for cell, edge in sorted(edges) for v in edge}
        parts = {(face.cell, face.vertices) for face in outer}, edges, {(cell, (v,)) for v, cell in ends.items()}
        for part in (sorted(some) for some in parts if some):
            rows = np.array([cell for cell, _ in part])
            at = np.array([[k for k, v in enumerate(cells[cell]) if v in vertices] for cell, vertices in part])
            own = on_corners(self.degree, 4)[(1 << at).sum(axis=1)]
            result.append((self.cell_forms[0][rows][own].reshape(len(at), -1), self.corners[rows[:, None], at]))
        return result


class FramedMesh:
    """A mesh beside a surface: its points (N, 3) in local coordinates, triangles (T, 3), their corners (T, 3, 3) and
    unit normals (T, 3), and by how much these may be turned (T,)."""

    def __init__(self, local: FramedSurface, points: Floats, triangles: Integers) -> None:
        self.local, self.triangles = local, triangles
        self.points = (points - local.origin) / local.scale
        self.corners = np.take(self.points, triangles, axis=0)
        a, b, c = self.corners[:, 0], self.corners[:, 1], self.corners[:, 2]
        first, second, third = b - a, c - b, a - c
        across = cross(first, -third)
        area = np.maximum(np.sqrt(dots(across, across)), 1e-300)
        longest = np.maximum(np.maximum(dots(first, first), dots(second, second)), dots(third, third))
        self.normals = across / area[:, None]
        # by rounding, or by putting corners that are off a wall by rounding onto it
        self.loose = ROUNDINGS * UNIT_ROUNDOFF * longest / area + 8 * ON_WALL * np.sqrt(longest) / area


LIMITS = Limits(depth=150, cells=6000)
"""Of what is critical on more simplices than these, such as along a curve, nothing can be counted."""


Free = Callable[[Floats, Floats], Bools]
"""Says which simplices (N, d + 1, 3), on which the polynomial's size is at least (N,), are free of what must not be
in them."""


def isolated(forms: Floats, corners: Floats, error: float = UNIT_ROUNDOFF) -> Searched[Simplices]:
    """Critical points on simplices (N, d + 1, 3) of B-coefficients (N, m), at most 1 in size, each off by `error`: the
    simplices that are kept have coefficients of one sign."""
    cells = Simplices.of([forms], corners, error)
    return search(cells, lambda some, _: some.rising(), Simplices.halved, _limits(cells), "looking for critical points")


def critical_parts(found: Searched[Simplices], free: Free) -> Searched[Simplices]:
    """The kept simplices that are free, or parts of those that are not: the polynomial has one sign on each, and all
    its critical points are in one of them or of those left open."""

    def judge(cells: Simplices, _: int) -> Fates:
        fates = cells.rising()
        rows = np.flatnonzero(fates != Fate.SETTLED)
        form = cells.table[rows]
        least = np.maximum(form.min(axis=1), -form.max(axis=1)) - cells.bound
        sure = free(least, cells.corners[rows])
        fates[rows[sure]], fates[rows[~sure & (fates[rows] == Fate.KEEP)]] = Fate.KEEP, Fate.SPLIT
        return fates

    result = search(found.kept, judge, Simplices.halved, _limits(found.kept), "looking for critical points")
    return replace(result, examined=found.examined + result.examined)


def _limits(cells: Simplices) -> Limits:
    """A point is not halved."""
    return replace(LIMITS, depth=LIMITS.depth - cells.halvings if cells.corners.shape[1] > 1 else 0)
