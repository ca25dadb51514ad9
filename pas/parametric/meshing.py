"""Meshes of surfaces within a tolerance: the unit square, over which the framed surface is, halved into cells.

A cell is halved until the surface P differs little enough from the bilinear interpolant B of its corners, across the
direction in which it bends more.  If |P - B| <= e on a cell and q is the length of B's mixed derivative, a triangle
with vertices P(v), all v in the cell, is at most 2 e + q/4 away from P at equal parameters: B differs by q/4 from its
own linear interpolant (the variance of a variable in [0, 1] is at most 1/4), and both this and B miss P by e.  That
holds whatever points of its sides a cell shares with smaller neighbours.

Guaranteed: for exact surfaces e is a bound, the greatest Bernstein coefficient of the numerator of P - B over the
least weight, and rounding is counted in, that of the vertices too.  For others it is measured at points of each cell;
features between these are missed.  Not guaranteed: that the surface does not pass through itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from itertools import product as pairs_of
from typing import Self

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from pas.algebra.lengths import lengths
from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.bernstein.boxes import product
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.search import Fate, Fates, Limits, search
from pas.errors import GeometryError, MeshError
from pas.limits import checkpoint
from pas.mesh.mesh import Mesh
from pas.mesh.rows import Integers
from pas.parametric.maps import ParametricMap
from pas.parametric.nets import SMALLEST, Framed, Nets, Rectangle, bernstein_at, exact_net
from pas.parametric.tiling import GRID, SEAM, assemble

PRODUCT = 32 * UNIT_ROUNDOFF
"""Relative error of a coefficient of a product of nets by bilinear ones: some 20 operations."""

LARGEST = 1_000_000
"""Cells; twice as many triangles would not fit into the memory of a small machine."""


@dataclass(frozen=True)
class CellErrors:
    """What was seen of C cells: P - B (C, a, b, 3), first and last rows on the sides, and corners (C, 2, 2, 3).

    `slack` (C,) is what rounding may add to |P - B|, `least` the part of it that no halving takes away.
    """

    errors: Floats
    corners: Floats
    slack: Floats
    least: Floats

    @property
    def bounds_and_axes(self) -> tuple[Floats, Integers]:
        """The bound 2 e + q/4 of each cell, infinite where there is none, and the axis across which to halve it."""
        away = lengths(self.errors)
        corners = self.corners
        twist = lengths(corners[:, 0, 0] - corners[:, 0, 1] - corners[:, 1, 0] + corners[:, 1, 1])
        largest = away.max(axis=(1, 2))
        bounds = 2 * (largest + self.slack) + twist / 4
        along_t, along_h = away[:, :, [0, -1]].max(axis=(1, 2)), away[:, [0, -1]].max(axis=(1, 2))
        sides = [lengths(np.diff(corners, axis=axis)).sum(axis=(1, 2)) for axis in (1, 2)]
        clear = np.maximum(along_t, along_h) > np.maximum(largest / 2, twist / 8)
        wider = np.where(clear, along_t < along_h, sides[0] < sides[1])
        return np.where(np.isfinite(bounds), bounds, np.inf), wider.astype(np.intp)

    def long(self) -> tuple[NDArray[np.bool_], Integers]:
        """Which cells are over 1.5 times as long as wide (C,), unless a side is a point, and the axis across which."""
        sides = [lengths(np.diff(self.corners, axis=axis)).reshape(-1, 2) for axis in (1, 2)]
        whole = np.min([side.min(axis=1) for side in sides], axis=0) > SEAM
        first, second = (side.sum(axis=1) for side in sides)
        return whole & ((first > 1.5 * second) | (second > 1.5 * first)), np.where(first > second, 0, 1)


def distances(nets: Nets, pieces: Floats, rounding: float) -> tuple[Floats, Floats]:
    """Bernstein coefficients (C, a, b, 3) of N - D S over the least of D's, and what rounding may add to them (C,).

    N / D are the surfaces of some nets, S the polynomials of nets (C, m+1, n+1, 3), whose products with others err by a
    share `rounding`.  Both are infinite where D is not surely positive.
    """
    tops, weights = nets.table[..., :3], nets.table[..., 3:]
    least = weights.min(axis=(1, 2, 3)) - nets.off
    positive = least > 0
    least = np.where(positive, least, 1.0)
    errors = product(tops, np.ones((1, *pieces.shape[1:3], 1))) - product(weights, pieces)
    far = 1.0 + np.abs(pieces).max(axis=(1, 2, 3))
    greatest = np.abs(nets.table).max(axis=(1, 2, 3))
    slack = 2 * far * (nets.off + rounding * greatest) / least  # 2 > sqrt(3) coordinates
    errors = np.where(positive[:, None, None, None], errors / least[:, None, None, None], np.inf)
    return errors, np.where(positive, slack, np.inf)


def bounded(nets: Nets) -> CellErrors:
    """Of exact surfaces: coefficients of P - B over the least weight, infinite where that is not positive."""
    points, weights = nets.table[..., :3], nets.table[..., 3:]
    with np.errstate(all="ignore"):
        corners = points[:, [0, 0, -1, -1], [0, -1, 0, -1]] / weights[:, [0, 0, -1, -1], [0, -1, 0, -1]]
        corners = corners.reshape(-1, 2, 2, 3)
        errors, slack = distances(nets, corners, PRODUCT)
        floors = np.where(np.isfinite(slack), 2 * nets.off / weights.max(axis=(1, 2, 3)), 0.0)
    return CellErrors(errors, corners, slack, floors)


def measured(surface: ParametricMap, cells: Integers) -> CellErrors:
    """Of other surfaces over the unit square: P - B at 5 x 5 points of each cell (C, 4), and a tenth more.

    Of a parabola these may miss a sixteenth.
    """
    places, share = cells / GRID, np.linspace(0.0, 1.0, 5)
    t, h = (places[:, i, None] * (1 - share) + places[:, i + 1, None] * share for i in (0, 2))
    points = np.stack(np.broadcast_arrays(t[:, :, None], h[:, None, :]), axis=-1)
    values = surface(np.clip(points, 0.0, 1.0))
    corners = values[:, [0, 0, -1, -1], [0, -1, 0, -1]].reshape(-1, 2, 2, 3)
    hats = np.stack([1 - share, share])
    with np.errstate(all="ignore"):
        errors = values - np.einsum("ia,jb,cijx->cabx", hats, hats, corners)
    none = np.zeros(len(cells))
    return CellErrors(np.where(np.isfinite(errors), 1.1 * errors, np.inf), np.nan_to_num(corners), none, none)


@dataclass(frozen=True)
class NetPoints:
    """Points of an exact surface at parameters of its frame that are multiples of 1 / GRID, and bounds on their errors.

    A Bernstein sum of degrees (m, n) errs by (2 m + 2 n + 24) 2^-53 of the same sum of absolute values at most, 24
    being the operations that do not grow with the degrees (Higham 2002, section 3.1).  Where that is more than
    `allowed` the point is worked out exactly.
    """

    framed: Framed
    table: Floats
    allowed: float

    def __call__(self, places: Integers) -> tuple[Floats, Floats]:
        """Points (N, 3) at places (N, 2) on the grid, and what they may be off by (N,)."""
        points, off = np.empty((len(places), 3)), np.empty(len(places))
        step = 1 << 13
        for start in range(0, len(places), step):
            checkpoint("placing the vertices of a mesh", start / len(places))
            rows = slice(start, start + step)
            points[rows], off[rows] = self._summed(places[rows] / GRID)
        for number in np.flatnonzero(~(off <= self.allowed)):
            checkpoint("placing vertices exactly")
            points[number] = self._exact(places[number])
            off[number] = 2 * UNIT_ROUNDOFF * (1 + np.abs(points[number]).max())
        return points, off

    def _summed(self, shares: Floats) -> tuple[Floats, Floats]:
        m, n = (size - 1 for size in self.table.shape[:2])
        first, second = bernstein_at(m, shares[:, 0]), bernstein_at(n, shares[:, 1])
        four, most = (
            np.einsum("nj,njx->nx", second, np.tensordot(first, table, 1)) for table in (self.table, np.abs(self.table))
        )
        error = (2 * m + 2 * n + 24) * UNIT_ROUNDOFF * most + SMALLEST
        with np.errstate(all="ignore"):
            points = four[:, :3] / four[:, 3:]
            least = four[:, 3] - error[:, 3]
            far = np.abs(points).max(axis=1)
            off = 2 * (error[:, :3].max(axis=1) + error[:, 3] * far) / least + UNIT_ROUNDOFF * far
        return points, np.where(least > 0, off, np.inf)

    def _exact(self, place: Integers) -> list[float]:
        at = self.framed.exact_parameters([fmpq(int(k), GRID) for k in place])
        return [
            to_float(c.numerator(*at) / c.denominator(*at) / self.framed.unit) for c in self.framed.bounded.components
        ]


@dataclass(frozen=True)
class GridCells(Nets):
    """C cells of the grid: (first, last) in both parameters (C, 4), how often they were halved, and what was seen.

    `bounds` are those of the distance, `floors` the part that no halving takes away, `axes` the parameters across which
    to halve, and `done` are those that stay.  Nets are zero where there are none.
    """

    places: Integers
    halvings: Integers
    bounds: Floats
    floors: Floats
    axes: Integers
    done: NDArray[np.bool_]

    def halves(self, axis: int) -> Self:
        """The first halves of all cells along a parameter, then the second ones; not seen yet."""
        starts, ends = self.places[:, 2 * axis], self.places[:, 2 * axis + 1]
        width, count, both = ends - starts, len(self), super().halves(axis)
        if ((width % 2 == 1) & (width > 1)).any():
            raise MeshError("a third of the rectangle cannot be halved that often")
        both.places[:count, 2 * axis + 1] = both.places[count:, 2 * axis] = (starts + ends) // 2
        return replace(both, halvings=both.halvings + 1)


@dataclass
class CellMesher:
    """A mesh of a surface, on its `rectangle`, within a tolerance `wanted` in its frame.

    Cells are first parts of the rectangle, so many each way; where they are to be `even` none is long that has four
    sides.  `count` are the cells that stay.
    """

    framed: Framed
    rectangle: Rectangle
    wanted: float
    parts: tuple[int, int]
    even: bool
    count: int = 0

    @cached_property
    def whole(self) -> Nets | None:
        """The net of an exact surface, unless it is too large to work with."""
        return self._net(np.array([0, GRID, 0, GRID]))

    @property
    def welding(self) -> float:
        """By which vertices that are welded, and rounded, may move."""
        return min(SEAM * self.framed.size, self.wanted / 16)

    @property
    def aim(self) -> float:
        """The bound for cells: the rest is for vertices, their rounding, and welding them."""
        return self.wanted - 4 * self.welding

    def mesh(self) -> Mesh:
        """Raises `GeometryError` near poles, `MeshError` for a tolerance that is too fine."""
        framed, whole = self.framed, self.whole
        leaves, worst = self._leaves()
        place: Callable[[Integers], tuple[Floats, Floats]] = lambda at: (framed.surface(at / GRID), np.zeros(len(at)))  # noqa: E731
        points = place if whole is None else NetPoints(framed, whole.table[0], self.welding)
        tiles = assemble(framed.surface, leaves, points, framed.size)
        if not len(tiles.triangles):
            raise GeometryError(f"the surface is a curve as far as doubles tell, less than {SEAM:.0e} as wide as long")
        if tiles.away > self.wanted - worst:
            raise self._too_fine(self.wanted)
        return Mesh.smooth(
            np.ldexp(tiles.points, framed.exponent),
            tiles.triangles,
            tiles.normals,
            parameters=framed.parameters_outside(tiles.shares),
            deviation=framed.outside((worst + tiles.away) * (1 + 2.0**-40)),  # for the rounding of the sum of bounds
            proved=whole is not None,
        )

    def _net(self, cell: Integers) -> Nets | None:
        """The net of an exact surface on a cell (4,), None where it is too large to work with: then it is measured."""
        if not self.framed.bounded.is_exact:
            return None
        ends = zip(self.rectangle, cell.reshape(2, 2).tolist(), strict=True)
        first, second = ([low + (high - low) * fmpq(end, GRID) for end in pair] for (low, high), pair in ends)
        exact = exact_net(self.framed.bounded, ((first[0], first[1]), (second[0], second[1])))
        size = exact.weights.shape
        return exact.rounded(self.framed.unit) if size[0] * size[1] <= 3000 and max(size) <= 500 else None

    def _first(self) -> list[GridCells]:
        """The cells into which the rectangle is cut first: multiples of 2^-13, that they can be halved often."""
        fine, found = 1 << 13, list[GridCells]()
        ends = [[round(GRID / fine * k / n) * fine for k in range(n + 1)] for n in self.parts]
        for first, second in pairs_of(*map(pairwise, ends)):
            cell = np.array([*first, *second])
            nets = self.whole if len(ends[0]) == len(ends[1]) == 2 else self._net(cell)
            nets = Nets(np.zeros((1, 2, 2, 1)), np.zeros(1)) if nets is None else nets
            none, unseen = np.zeros(1, dtype=np.intp), np.zeros(1)
            cells = GridCells(nets.table, nets.off, cell[None], none, unseen, unseen, none, unseen > 0)
            found.append(self._seen(cells))
        return found

    def _seen(self, cells: GridCells) -> GridCells:
        """Cells with their bounds; nothing measured is believed before three halvings each way."""
        errors = measured(self.framed.surface, cells.places) if self.whole is None else bounded(cells)
        with np.errstate(all="ignore"):
            bounds, axes = errors.bounds_and_axes
        if self.whole is None:
            bounds[cells.halvings < 6] = math.inf
        axes = np.where(np.isfinite(bounds), axes, cells.halvings % 2)
        done = bounds <= self.aim
        if self.even:
            long, across = errors.long()
            axes, done = np.where(done & long, across, axes), done & ~long
        return replace(cells, bounds=bounds, floors=errors.least, axes=axes, done=done)

    def _judge(self, cells: GridCells, _: int) -> Fates:
        """Raises `MeshError` or `GeometryError` where halving on would be in vain."""
        self.count += int(cells.done.sum())
        far = cells.select(cells.bounds > self.aim)
        if 2 * float(far.floors.max(initial=0.0)) > self.aim:
            raise self._too_fine(self.aim)
        if not cells.done.all():
            self._require_hope(far, self.count + len(cells))
        return np.where(cells.done, int(Fate.KEEP), int(Fate.SPLIT))

    def _require_hope(self, far: GridCells, count: int) -> None:
        """A cell without a bound after 32 halvings is 2e-5 wide each way, and reported as a pole; so is after 40 one
        of measured bound, since smooth surfaces have run out of triangles before.  Proved bounds are rounding then."""
        lost = far.select((far.halvings >= 40) | ~np.isfinite(far.bounds))
        if len(lost) and (lost.halvings.max() >= 32 or count > LARGEST):
            if self.whole is not None and np.isfinite(lost.bounds).all():
                raise self._too_fine(self.aim)
            values = self.framed.parameters_outside(lost.places[0].reshape(2, 2).mean(axis=1) / GRID)
            place = ", ".join(f"{n} = {x:.6g}" for n, x in zip(self.framed.bounded.parameters, values, strict=True))
            what = "the surface has a pole, jumps, or numerator and denominator vanish together,"
            raise GeometryError(f"{what} near {place}; give a domain that avoids it")
        if count > LARGEST:
            tolerance = self.framed.outside(self.aim)
            raise MeshError(f"the tolerance {tolerance:.3g} needs more than {2 * LARGEST} triangles; give a larger one")

    def _leaves(self) -> tuple[Integers, float]:
        """Cells (C, 4) as (first, last) in both parameters on a grid of GRID steps, and the greatest bound.

        Some are searched at a time, not to fill the memory; those at poles come first.
        """
        pending, leaves, worst = self._first(), list[Integers](), 0.0
        while pending:
            cells = pending.pop()
            batch = 1 << 18  # coefficients of the cells that are searched at a time
            limits = Limits(cells=batch // cells.table[0].size)
            found = search(cells, self._judge, lambda c: self._seen(c.split(c.axes)), limits, "meshing a surface")
            leaves.append(found.kept.places)
            worst = max(worst, float(found.kept.bounds.max(initial=0.0)))
            order = np.argsort(~np.isfinite(found.open.bounds), kind="stable")
            pending += [found.open.select(rows) for rows in np.array_split(order, 4) if len(rows)]
        return np.concatenate(leaves), worst

    def _too_fine(self, tolerance: float) -> MeshError:
        told = f"the tolerance {self.framed.outside(tolerance):.3g} is finer than doubles resolve on this surface"
        return MeshError(f"{told}; give a larger one")
