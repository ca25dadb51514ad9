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
from dataclasses import dataclass, replace
from itertools import pairwise
from itertools import product as pairs_of
from typing import Self

import numpy as np
from flint import fmpq

from pas.algebra.lengths import lengths
from pas.arrays import Bools, Floats, Integers
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.search import Fate, Fates, Limits, search
from pas.errors import GeometryError, MeshError
from pas.mesh.mesh import Mesh
from pas.parametric.maps import ParametricMap
from pas.parametric.nets import Framed, Nets, Rectangle, bernstein_at, exact_net, product
from pas.parametric.tiling import GRID, SEAM, assemble

LARGEST = 1_000_000
"""Cells; twice as many triangles would not fit into the memory of a small machine."""


@dataclass(frozen=True)
class CellErrors:
    """What was seen of C cells: P - B (C, a, b, 3), first and last rows on the sides, and `points` (C, 5, 3): corners,
    the last parameter first, and the middle.

    `slack` (C,) is what rounding may add to |P - B|, `least` the part of it that no halving takes away.
    """

    errors: Floats
    points: Floats
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

    @property
    def corners(self) -> Floats:
        """The corners (C, 2, 2, 3)."""
        return self.points[:, :4].reshape(-1, 2, 2, 3)

    @property
    def away(self) -> Floats:
        """How far they may be from P there (C,)."""
        return np.asarray(lengths(self.errors[:, [0, 0, -1, -1], [0, -1, 0, -1]]).max(axis=1) + self.slack)

    def long(self) -> tuple[Bools, Integers]:
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
    least = (weights[..., 0] - nets.off).min(axis=(1, 2))
    positive = least > 0
    least = np.where(positive, least, 1.0)
    errors = product(tops, np.ones((1, *pieces.shape[1:3], 1))) - product(weights, pieces)
    far = 1.0 + np.abs(pieces).max(axis=(1, 2, 3))
    greatest = np.abs(nets.table).max(axis=(1, 2, 3))
    slack = 2 * far * (nets.off.max(axis=(1, 2)) + rounding * greatest) / least  # 2 > sqrt(3) coordinates
    errors = np.where(positive[:, None, None, None], errors / least[:, None, None, None], np.inf)
    return errors, np.where(positive, slack, np.inf)


def bounded(nets: Nets) -> CellErrors:
    """Of exact surfaces: coefficients of P - B over the least weight, infinite where that is not positive."""
    table, (m, n) = nets.table, np.array(nets.table.shape[1:3]) - 1
    half = np.array(0.5)
    middles = np.einsum("i,cijx,j->cx", bernstein_at(m, half), table, bernstein_at(n, half))[:, None]
    rounding = (2 * m + 2 * n + 24) * UNIT_ROUNDOFF  # of sums of Bernstein polynomials (Higham 2002, 3.1)
    with np.errstate(all="ignore"):
        five = np.concatenate([table[:, [0, 0, -1, -1], [0, -1, 0, -1]], middles], axis=1)
        points = five[..., :3] / five[..., 3:]
        errors, slack = distances(nets, points[:, :4].reshape(-1, 2, 2, 3), rounding)
        floors = np.where(np.isfinite(slack), 2 * (nets.off / table[..., 3]).min(axis=(1, 2)), 0.0)
        return CellErrors(errors, points, slack, floors)


def measured(surface: ParametricMap, cells: Integers) -> CellErrors:
    """Of other surfaces over the unit square: P - B at 5 x 5 points of each cell (C, 4), and a tenth more.

    Of a parabola these may miss a sixteenth.
    """
    places, share = cells / GRID, np.linspace(0.0, 1.0, 5)
    t, h = (places[:, i, None] * (1 - share) + places[:, i + 1, None] * share for i in (0, 2))
    points = np.stack(np.broadcast_arrays(t[:, :, None], h[:, None, :]), axis=-1)
    values = surface(np.clip(points, 0.0, 1.0))
    five = values[:, [0, 0, -1, -1, 2], [0, -1, 0, -1, 2]]
    hats = np.stack([1 - share, share])
    with np.errstate(all="ignore"):
        errors = values - np.einsum("ia,jb,cijx->cabx", hats, hats, five[:, :4].reshape(-1, 2, 2, 3))
    none = np.zeros(len(cells))
    return CellErrors(np.where(np.isfinite(errors), 1.1 * errors, np.inf), np.nan_to_num(five), none, none)


@dataclass(frozen=True)
class GridCells(Nets):
    """C cells of the grid: (first, last) in both parameters (C, 4), how often they were halved, and what was seen.

    `bounds` are those of the distance, `floors` the part that no halving takes away, `axes` the parameters across which
    to halve, `points` (C, 5, 3) the corners and the middle, and `away` how far these may be from the surface; those
    that are `done` stay.  Nets are zero where there are none.
    """

    places: Integers
    halvings: Integers
    bounds: Floats
    floors: Floats
    axes: Integers
    points: Floats
    away: Floats
    done: Bools

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
    sides.  `count` are the cells that stay; bounds are `proved` where there are nets.
    """

    framed: Framed
    rectangle: Rectangle
    wanted: float
    parts: tuple[int, int]
    even: bool
    count: int = 0
    proved: bool = False

    @property
    def aim(self) -> float:
        """The bound for cells: the rest is for vertices, by which these may move when they are rounded and welded."""
        return self.wanted - 4 * min(SEAM * self.framed.size, self.wanted / 16)

    def mesh(self) -> Mesh:
        """Raises `GeometryError` near poles, `MeshError` for a tolerance that is too fine."""
        framed = self.framed
        leaves, known, worst, off = self._leaves()
        points, triangles, normals, shares, moved = assemble(framed.surface, leaves, known, framed.size)
        if not len(triangles):
            raise GeometryError(f"the surface is a curve as far as doubles tell, less than {SEAM:.0e} as wide as long")
        outside, rounding = framed.points_outside(points)
        away = moved + off + rounding
        if away > self.wanted - worst:
            raise self._too_fine(self.wanted)
        return Mesh.smooth(
            outside,
            triangles,
            normals,
            parameters=framed.parameters_outside(shares),
            deviation=framed.outside((worst + away) * (1 + 2.0**-40)),  # for the rounding of the sum of bounds
            proved=self.proved,
        )

    def _net(self, cell: Integers) -> Nets | None:
        """The net of an exact surface on a cell (4,), None where it is too large to work with: then it is measured."""
        if not self.framed.bounded.is_exact:
            return None
        ends = zip(self.rectangle, cell.reshape(2, 2).tolist(), strict=True)
        first, second = ([low + (high - low) * fmpq(end, GRID) for end in pair] for (low, high), pair in ends)
        exact = exact_net(self.framed.bounded, ((first[0], first[1]), (second[0], second[1])), self.framed)
        size = exact.weights.shape
        return exact.rounded() if size[0] * size[1] <= 3000 and max(size) <= 500 else None

    def _first(self) -> list[GridCells]:
        """The cells into which the rectangle is cut first: multiples of 2^-13, that they can be halved often."""
        fine, found = 1 << 13, list[GridCells]()
        ends = [[round(GRID / fine * k / n) * fine for k in range(n + 1)] for n in self.parts]
        for first, second in pairs_of(*map(pairwise, ends)):
            cell = np.array([*first, *second])
            nets = self._net(cell)
            self.proved = nets is not None
            nets = Nets(np.zeros((1, 2, 2, 1)), np.zeros((1, 2, 2))) if nets is None else nets
            none, unseen, points = np.zeros(1, dtype=np.intp), np.zeros(1), np.zeros((1, 5, 3))
            cells = GridCells(nets.table, nets.off, cell[None], none, unseen, unseen, none, points, unseen, unseen > 0)
            found.append(self._seen(cells))
        return found

    def _seen(self, cells: GridCells) -> GridCells:
        """Cells with their bounds; nothing measured is believed before three halvings each way."""
        errors = bounded(cells) if self.proved else measured(self.framed.surface, cells.places)
        with np.errstate(all="ignore"):
            bounds, axes = errors.bounds_and_axes
        if not self.proved:
            bounds[cells.halvings < 6] = math.inf
        axes = np.where(np.isfinite(bounds), axes, cells.halvings % 2)
        done = bounds <= self.aim
        if self.even:
            long, across = errors.long()
            axes, done = np.where(done & long, across, axes), done & ~long
        seen = replace(cells, bounds=bounds, floors=errors.least, axes=axes, done=done)
        return replace(seen, points=errors.points, away=errors.away)

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
            if self.proved and np.isfinite(lost.bounds).all():
                raise self._too_fine(self.aim)
            values = self.framed.parameters_outside(lost.places[0].reshape(2, 2).mean(axis=1) / GRID)
            place = ", ".join(f"{n} = {x:.6g}" for n, x in zip(self.framed.bounded.parameters, values, strict=True))
            what = "the surface has a pole, jumps, or numerator and denominator vanish together,"
            raise GeometryError(f"{what} near {place}; give a domain that avoids it")
        if count > LARGEST:
            tolerance = self.framed.outside(self.aim)
            raise MeshError(f"the tolerance {tolerance:.3g} needs more than {2 * LARGEST} triangles; give a larger one")

    def _leaves(self) -> tuple[Integers, Floats, float, float]:
        """Cells (C, 4) as (first, last) in both parameters on a grid of GRID steps, their points (C, 5, 3), the
        greatest bound, and how far points may be from the surface.

        Some are searched at a time, not to fill the memory; those at poles come first.
        """
        pending, leaves = self._first(), list[GridCells]()
        while pending:
            cells = pending.pop()
            batch = 1 << 18  # coefficients of the cells that are searched at a time
            limits = Limits(cells=batch // cells.table[0].size)
            found = search(cells, self._judge, lambda c: self._seen(c.split(c.axes)), limits, "meshing a surface")
            none = np.zeros((len(found.kept), 0, 0))
            leaves.append(replace(found.kept, table=none[..., None], off=none))
            order = np.argsort(~np.isfinite(found.open.bounds), kind="stable")
            pending += [found.open.select(rows) for rows in np.array_split(order, 4) if len(rows)]
        kept = leaves[0].joined(leaves[1:])
        return kept.places, kept.points, float(kept.bounds.max()), float(kept.away.max())

    def _too_fine(self, tolerance: float) -> MeshError:
        told = f"the tolerance {self.framed.outside(tolerance):.3g} is finer than doubles resolve on this surface"
        return MeshError(f"{told}; give a larger one")
