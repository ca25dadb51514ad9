"""Parametric surfaces: maps of two parameters that can be proved, meshed within a tolerance, drawn and saved.

For a mesh the rectangle of parameters is halved until the surface P differs little enough from the bilinear interpolant
B of a cell's corners, across the direction in which it bends more.  If |P - B| <= e on a cell and q is the length of
B's mixed derivative, a triangle with vertices P(v), all v in the cell, is at most 2 e + q/4 away from P at equal
parameters: B differs by q/4 from its own linear interpolant (the variance of a variable in [0, 1] is at most 1/4),
and both this and B miss P by e.  That holds whatever points of its sides a cell shares with smaller neighbours.

Guaranteed: for exact surfaces e is a bound, the greatest Bernstein coefficient of the numerator of P - B over the
least weight, and rounding is counted in, that of the vertices too.  For others it is measured at points of each cell;
features between these are missed.  All is done in the surface's own frame (`framed`), so that neither its units nor
those of the parameters matter.  Sides that close up share their vertices, sides and lines that shrink to a point
have one vertex, no triangle has two equal vertices, and triangles are oriented along dP/dt x dP/dh.  Not
guaranteed: that the surface does not pass through itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import pairwise
from typing import Unpack

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from pas.algebra.affine import Affine, AffineShape
from pas.algebra.inputs import check_tolerance
from pas.algebra.lengths import lengths
from pas.algebra.monomials import Floats
from pas.bernstein.search import Cells, Fate, Fates, Limits, search
from pas.errors import GeometryError, MeshError
from pas.limits import WorkLimits, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.mesh.rows import Integers
from pas.parametric.bounds import Examination, NetPoints, bounded, measured, surface_points
from pas.parametric.domain import DomainLike
from pas.parametric.maps import ParametricMap
from pas.parametric.nets import Framed, Nets, Rectangle, exact_net, exact_rectangle
from pas.parametric.regularity import regularity
from pas.parametric.solids import solid_of
from pas.parametric.tiling import GRID, SEAM, Placing, assemble
from pas.settings import RELATIVE_TOLERANCE
from pas.shape import Shape
from pas.solid.solid import Solid
from pas.verdicts import Findings

LARGEST = 1_000_000
"""Cells; twice as many triangles would not fit into the memory of a small machine."""

ParametricMesh = Mesh
"""What the meshes of parametric surfaces were called."""

PARTS = tuple((n, m) for m in (1, 3) for n in (1, 3))
"""Into how many parts each way the rectangle is cut first, before parts are halved; usually there is one."""

WAYS = {
    Quality.BALANCED: ((PARTS[0], False),),
    Quality.COUNT: tuple((parts, False) for parts in PARTS),
    Quality.ANGLES: ((PARTS[0], False), *((parts, True) for parts in PARTS)),
}
"""Such parts, and whether long cells are halved as well: the best of these meshes is kept."""


class ParametricSurface(ParametricMap, AffineShape["ParametricSurface"], Shape):
    __doc__ = (ParametricMap.__doc__ or "").replace("A map (x, y, z)", "A surface (x, y, z)")
    kind = "parametric surface"

    @cached_property
    def certificate(self) -> Findings:
        """The verdict of `pas.regularity` on the whole domain, worked out when first asked for."""
        return Findings((regularity(self),))

    @limited("meshing a surface", "a coarser tolerance or a smaller domain")
    def mesh(
        self,
        tolerance: float | None = None,
        domain: DomainLike = None,
        *,
        quality: Quality | str = Quality.BALANCED,
        **limits: Unpack[WorkLimits],
    ) -> Mesh:
        """A triangle mesh, with normals, nowhere further than `tolerance` from the surface.

        The tolerance is by default a thousandth of the surface's extent.  `domain` is that of the mesh, None for a
        parameter or an end that the surface's own bounds.  The bound is proved for exact surfaces, measured for
        others; the mesh says which.  Of some meshes the `quality` "angles" takes that with the largest smallest angle,
        "count" that with fewest triangles; for "angles" long cells are halved as well.  Raises `ValueError` for an
        infinite domain, `GeometryError` near poles, `MeshError` for a tolerance that needs too many triangles.
        """
        how = Quality.of(quality)
        rectangle = exact_rectangle(self, domain)
        framed = Framed.of(self.with_domain(rectangle))
        wanted = RELATIVE_TOLERANCE * framed.size
        if tolerance is not None:
            wanted = framed.inside(check_tolerance(tolerance, framed.outside(framed.size)))
        welding = min(SEAM * framed.size, wanted / 16)
        aim = wanted - 4 * welding  # the rest is for vertices: their rounding, and welding them
        nets = _nets(framed, rectangle, np.array([0, GRID, 0, GRID]))
        place: Placing = surface_points(framed.surface) if nets is None else NetPoints(framed, nets.table[0], welding)
        examine = measured(framed.surface) if nets is None else bounded

        def made(parts: tuple[int, int], even: bool) -> Mesh:
            starts = [(_nets(framed, rectangle, cell), cell[None]) for cell in _first_cells(parts)]
            leaves, worst = _leaves(starts, _Halving(examine, framed, aim, even))
            return _assembled(framed, leaves, worst, place, wanted, nets is not None)

        return self._kept((wanted, rectangle, how), lambda: how.best_of(partial(made, *way) for way in WAYS[how]))

    def _moved(self, map_: Affine) -> ParametricSurface:
        return self.moved(map_.matrix, map_.shift)

    @limited("making a solid of a surface", "a smaller domain")
    def solid(self, face: str = "surface", **limits: Unpack[WorkLimits]) -> Solid:
        """The body that the surface bounds, as a `pas.solid.Solid` with a face of that name.

        The surface is closed, as a ball's or a ring's are, or has ends in planes, as a vase or a tube has, which are
        closed by flat faces, "surface start" and "surface end".  Raises `ValueError` for an infinite domain,
        `GeometryError` where it has other edges, an end that is not plane, or passes through itself.

            pas.surface_of_revolution("1 + h^2/4", "h", angle=True, interval=(-1, 2)).solid("vase")
        """
        return solid_of(self, self.mesh(), face)


def _assembled(framed: Framed, leaves: Integers, worst: float, place: Placing, wanted: float, proved: bool) -> Mesh:
    """The mesh of cells whose greatest bound is given."""
    tiles = assemble(framed.surface, leaves, place, framed.size)
    if not len(tiles.triangles):
        raise GeometryError(f"the surface is a curve as far as doubles tell, less than {SEAM:.0e} as wide as long")
    if tiles.away > wanted - worst:
        raise MeshError(_too_fine(framed.outside(wanted)))
    return Mesh.smooth(
        framed.points_outside(tiles.points),
        tiles.triangles,
        tiles.normals,
        parameters=framed.parameters_outside(tiles.shares),
        deviation=framed.outside((worst + tiles.away) * (1 + 2.0**-40)),  # for the rounding of the sum of bounds
        proved=proved,
    )


def _first_cells(parts: tuple[int, int]) -> Integers:
    """The cells (n m, 4) into which the rectangle is cut first: multiples of 2^-13, that they can be halved often."""
    fine = 1 << 13
    first, second = ([round(GRID / fine * k / n) * fine for k in range(n + 1)] for n in parts)
    return np.array([[*a, *b] for a in pairwise(first) for b in pairwise(second)])


def _nets(framed: Framed, rectangle: Rectangle, cell: Integers) -> Nets | None:
    """The net of an exact surface on a cell (4,), unless it is too large to work with: then it is measured."""
    if not framed.bounded.is_exact:
        return None
    sides = zip(rectangle, cell.reshape(2, 2).tolist(), strict=True)
    first, second = (
        (low + (high - low) * fmpq(p, GRID), low + (high - low) * fmpq(q, GRID)) for (low, high), (p, q) in sides
    )
    exact = exact_net(framed.bounded, (first, second))
    size = exact.weights.shape
    return exact.rounded(framed.unit) if size[0] * size[1] <= 3000 and max(size) <= 500 else None


@dataclass(frozen=True)
class GridCells(Cells):
    """C cells of the grid: (first, last) in both parameters (C, 4), how often they were halved, and what was seen.

    `bounds` are those of the distance, `floors` the part that no halving takes away, `axes` the parameters across which
    to halve, and `done` are those that stay.  `table` and `off` are the cells' `Nets`, None where there are none.
    """

    places: Integers
    halvings: Integers
    bounds: Floats
    floors: Floats
    axes: Integers
    done: NDArray[np.bool_]
    table: Floats | None
    off: Floats | None


@dataclass
class _Halving:
    """How cells are seen, judged and halved until they are within `aim`; `count` are those that stay.

    Where they are to be `even` none is long that has four sides.
    """

    examine: Examination
    framed: Framed
    aim: float
    even: bool
    count: int = 0

    def seen(self, nets: Nets | None, places: Integers, halvings: Integers) -> GridCells:
        """Cells with their bounds; nothing measured is believed before three halvings each way."""
        with np.errstate(all="ignore"):
            errors = self.examine(nets, places)
            bounds, axes = errors.bounds_and_axes
        if nets is None:
            bounds[halvings < 6] = math.inf
        axes = np.where(np.isfinite(bounds), axes, halvings % 2)
        done = bounds <= self.aim
        if self.even:
            done &= ~_long(errors.corners, axes, done)
        table, off = (None, None) if nets is None else (nets.table, nets.off)
        return GridCells(places, halvings, bounds, errors.least, axes, done, table, off)

    def judge(self, cells: GridCells, _: int) -> Fates:
        """Raises `MeshError` or `GeometryError` where halving on would be in vain."""
        self.count += int(cells.done.sum())
        far = cells.select(cells.bounds > self.aim)
        if 2 * float(far.floors.max(initial=0.0)) > self.aim:
            raise MeshError(_too_fine(self.framed.outside(self.aim)))
        if not cells.done.all():
            self._require_hope(far, self.count + len(cells))
        return np.where(cells.done, int(Fate.KEEP), int(Fate.SPLIT))

    def _require_hope(self, far: GridCells, count: int) -> None:
        """A cell without a bound after 32 halvings is 2e-5 wide each way, and reported as a pole; after 40 any cell is,
        since smooth surfaces have run out of triangles before."""
        lost = far.select((far.halvings >= 40) | ~np.isfinite(far.bounds))
        if len(lost) and (lost.halvings.max() >= 32 or count > LARGEST):
            values = self.framed.parameters_outside(lost.places[0].reshape(2, 2).mean(axis=1) / GRID)
            names = self.framed.bounded.parameters
            place = ", ".join(f"{name} = {x:.6g}" for name, x in zip(names, values, strict=True))
            what = "the surface has a pole, jumps, or numerator and denominator vanish together,"
            raise GeometryError(f"{what} near {place}; give a domain that avoids it")
        if count > LARGEST:
            tolerance = self.framed.outside(self.aim)
            raise MeshError(f"the tolerance {tolerance:.3g} needs more than {2 * LARGEST} triangles; give a larger one")

    def split(self, cells: GridCells) -> GridCells:
        """Both halves of all."""
        first, *second = (self._halved(part, axis) for axis in (0, 1) if len(part := cells.select(cells.axes == axis)))
        return first.joined(second)

    def _halved(self, cells: GridCells, axis: int) -> GridCells:
        starts, ends = cells.places[:, 2 * axis], cells.places[:, 2 * axis + 1]
        width = ends - starts
        if ((width % 2 == 1) & (width > 1)).any():
            raise MeshError("a third of the rectangle cannot be halved that often")
        left, right = cells.places.copy(), cells.places.copy()
        left[:, 2 * axis + 1] = right[:, 2 * axis] = (starts + ends) // 2
        nets = None if cells.table is None or cells.off is None else Nets(cells.table, cells.off).halves(axis)
        return self.seen(nets, np.concatenate([left, right]), np.tile(cells.halvings + 1, 2))


def _leaves(starts: Sequence[tuple[Nets | None, Integers]], halving: _Halving) -> tuple[Integers, float]:
    """Cells (C, 4) as (first, last) in both parameters on a grid of GRID steps, and the greatest bound.

    Some are searched at a time, not to fill the memory; those at poles come first.
    """
    pending = [halving.seen(nets, places, np.zeros(len(places), dtype=np.intp)) for nets, places in starts]
    leaves, worst = list[Integers](), 0.0
    while pending:
        cells = pending.pop()
        batch = 1 << 18  # coefficients of the cells that are searched at a time
        most = batch // (4 if cells.table is None else cells.table[0].size)
        found = search(cells, halving.judge, halving.split, Limits(cells=most), "meshing a surface")
        leaves.append(found.kept.places)
        worst = max(worst, float(found.kept.bounds.max(initial=0.0)))
        order = np.argsort(~np.isfinite(found.open.bounds), kind="stable")
        pending += [found.open.select(rows) for rows in np.array_split(order, 4) if len(rows)]
    return np.concatenate(leaves), worst


def _long(corners: Floats, axes: Integers, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which chosen cells (C,) of given corners (C, 2, 2, 3) are over 1.5 times as long as wide, and are to be halved
    across, which is written to `axes`."""
    sides = [lengths(np.diff(corners, axis=axis)).reshape(-1, 2) for axis in (1, 2)]
    whole = np.min([side.min(axis=1) for side in sides], axis=0) > SEAM
    first, second = (side.sum(axis=1) for side in sides)
    result = chosen & whole & ((first > 1.5 * second) | (second > 1.5 * first))
    axes[result] = np.where(first > second, 0, 1)[result]
    return np.asarray(result)


def _too_fine(tolerance: float) -> str:
    return f"the tolerance {tolerance:.3g} is finer than doubles resolve on this surface; give a larger one"
