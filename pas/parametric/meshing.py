"""Triangle meshes of parametric surfaces within a tolerance.

The rectangle of parameters is halved until the surface P differs little enough from the bilinear interpolant B of a
cell's corners, across the direction in which it bends more.  If |P - B| <= e on a cell and q is the length of B's
mixed derivative, a triangle with vertices P(v), all v in the cell, is at most 2 e + q/4 away from P at equal
parameters: B differs by q/4 from its own linear interpolant (the variance of a variable in [0, 1] is at most 1/4),
and both this and B miss P by e.  That holds whatever points of its sides a cell shares with smaller neighbours.

Guaranteed: for exact surfaces e is a bound, the greatest Bernstein coefficient of the numerator of P - B over the
least weight (up to rounding, some 1e-12 of the coordinates).  For others it is measured at SAMPLES^2 points a cell;
features between these are missed.  Sides that close up share their vertices, sides and lines that shrink to a point
have one vertex, no triangle has two equal vertices, and triangles are oriented along dP/dt x dP/dh.  Not
guaranteed: that the surface does not pass through itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pas.algebra.inputs import check_tolerance
from pas.algebra.monomials import Floats
from pas.errors import GeometryError
from pas.limits import checkpoint
from pas.mesh.field import Integers, TriangleMesh
from pas.mesh.triangulate import MeshError
from pas.parametric.nets import exact_net, halved, product, rectangle_of
from pas.parametric.tiling import GRID, assemble

if TYPE_CHECKING:
    from pas.parametric.surface import Domain, ParametricSurface

RELATIVE = 1e-3
"""The tolerance over the surface's extent where none is given."""

SAMPLES = 5
"""Points a side of a cell at which a surface that is not exact is compared."""

SAFETY = 1.1
"""On what is measured at them: of a parabola they may miss a sixteenth."""

FIRST = 3
"""Halvings each way before anything measured is believed."""

LOST = 32
"""Halvings after which a cell that still has no bound is reported as a pole: it is then 2e-5 wide each way."""

DEEPEST = 40
"""Halvings after which any cell is: smooth surfaces have run out of triangles before."""

LARGEST = 1_000_000
"""Cells; twice as many triangles would not fit into the memory of a small machine."""

HIGHEST = 3000
"""Bernstein coefficients of one coordinate up to which bounds are worked out; above, they are measured."""

BATCH = 1 << 21
"""Numbers held in one batch of cells."""

Nets = Floats
Look = Callable[[Floats, Integers], tuple[Floats, Floats]]
"""From nets and cells to the errors P - B (C, a, b, 3), first and last rows on the sides, and corners (C, 2, 2, 3)."""


@dataclass(frozen=True)
class ParametricMesh(TriangleMesh):
    """A triangle mesh with the parameters (N, 2) of its vertices (one pair for those on seams and poles).

    `deviation` bounds the distance of the triangles from the surface: proved where `certified`, else measured.
    """

    parameters: Floats
    deviation: float
    certified: bool

    def to_pyvista(self) -> Any:
        """The mesh as a `pyvista.PolyData` with normals and `parameters` as point data."""
        data = super().to_pyvista()
        data.point_data["parameters"] = self.parameters
        return data


def mesh_surface(surface: ParametricSurface, tolerance: Any = None, domain: Any = None) -> ParametricMesh:
    """The mesh of a surface over its domain, or another; see `ParametricSurface.mesh`."""
    rectangle = finite_domain(surface, domain)
    bounded = surface.with_domain(rectangle)
    size = extent(bounded)
    tolerance = RELATIVE * size if tolerance is None else check_tolerance(tolerance, size)
    net = exact_net(bounded, rectangle_of(rectangle)).rounded if bounded.is_exact else None
    certified = net is not None and net[..., 0].size <= HIGHEST
    if net is not None and certified:
        leaves, worst = _leaves(net[None], _bounded, tolerance, bounded)
    else:
        leaves, worst = _leaves(np.zeros((1, 1, 1, 4)), _measured(bounded), tolerance, bounded)
    points, triangles, normals, parameters = assemble(bounded, leaves, size)
    return ParametricMesh(points, triangles, normals, parameters, worst, certified)


def finite_domain(surface: ParametricSurface, domain: Any = None) -> Domain:
    """The finite rectangle to mesh: `domain`, completed by the surface's own.

    An interval None, or an end None, is that of the surface.  Raises `ValueError` naming a parameter that has no
    finite interval or one outside the surface's domain.
    """
    given = surface.with_domain(domain).domain
    result = []
    for name, own, (low, high) in zip(surface.parameters, surface.domain, given, strict=True):
        ends = own[0] if math.isinf(low) else low, own[1] if math.isinf(high) else high
        if not (math.isfinite(ends[0]) and math.isfinite(ends[1])):
            raise ValueError(
                f"the domain of {name} is infinite ({ends[0]:g} to {ends[1]:g}); "
                f"give a finite one, such as domain={_example(surface)}"
            )
        if not own[0] <= ends[0] < ends[1] <= own[1]:
            raise ValueError(
                f"the interval [{ends[0]:g}, {ends[1]:g}] of {name} is not within the surface's domain "
                f"[{own[0]:g}, {own[1]:g}]"
            )
        result.append(ends)
    return result[0], result[1]


def extent(surface: ParametricSurface) -> float:
    """The longest side of the box around a few points of a surface on a finite domain."""
    t, h = (np.linspace(low, high, 17) for low, high in surface.domain)
    points = surface.on_grid(t, h).reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    size = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    if not 0 < size < math.inf:
        raise GeometryError("the surface is a single point, or has no finite points, on this domain")
    return size


def _example(surface: ParametricSurface) -> str:
    sides = ["(-1, 1)" if math.isinf(low) or math.isinf(high) else "None" for low, high in surface.domain]
    return f"({', '.join(sides)})"


def _leaves(nets: Nets, look: Look, tolerance: float, surface: ParametricSurface) -> tuple[Integers, float]:
    """Cells (C, 4) as (first, last) in both parameters on a grid of GRID steps, and the greatest bound."""
    pending = [(nets, np.array([[0, GRID, 0, GRID]]), 0)]
    leaves: list[Integers] = []
    worst, count = 0.0, 0
    while pending:
        nets, cells, depth = pending.pop()
        checkpoint(f"meshing a surface ({count} cells)")
        with np.errstate(all="ignore"):
            bounds, axes = _judged(*look(nets, cells))
        if look is not _bounded and depth < 2 * FIRST:
            bounds[:] = math.inf
        axes[~np.isfinite(bounds)] = depth % 2
        good = bounds <= tolerance
        leaves.append(cells[good])
        worst, count = max(worst, float(bounds[good].max(initial=0.0))), count + int(good.sum())
        if good.all():
            continue
        _require_hope(bounds[~good], cells[~good], depth, count + len(cells), surface, tolerance)
        for finite, axis in ((True, 0), (True, 1), (False, 0), (False, 1)):  # cells at poles come first off the pile
            rest = np.flatnonzero(~good & (axes == axis) & (np.isfinite(bounds) == finite))
            step = max(1, BATCH // max(1, nets[0].size * 8))
            for start in range(0, len(rest), step):
                part = rest[start : start + step]
                children = np.concatenate(halved(nets[part], axis)) if look is _bounded else nets[:1]
                pending.append((children, _halves(cells[part], axis), depth + 1))
    return np.concatenate(leaves), worst


def _judged(errors: Floats, corners: Floats) -> tuple[Floats, Integers]:
    """The bound 2 e + q/4 of each cell, and the axis across which to halve it."""
    lengths = np.linalg.norm(errors, axis=-1)
    twist = np.linalg.norm(corners[:, 0, 0] - corners[:, 0, 1] - corners[:, 1, 0] + corners[:, 1, 1], axis=-1)
    largest = lengths.max(axis=(1, 2))
    bounds = 2 * largest + twist / 4
    along_t, along_h = lengths[:, :, [0, -1]].max(axis=(1, 2)), lengths[:, [0, -1]].max(axis=(1, 2))
    sides = [np.linalg.norm(np.diff(corners, axis=axis), axis=-1).sum(axis=(1, 2)) for axis in (1, 2)]
    clear = np.maximum(along_t, along_h) > np.maximum(largest / 2, twist / 8)
    wider = np.where(clear, along_t < along_h, sides[0] < sides[1])
    return np.where(np.isfinite(bounds), bounds, math.inf), wider.astype(np.intp)


def _halves(cells: Integers, axis: int) -> Integers:
    middles = (cells[:, 2 * axis] + cells[:, 2 * axis + 1]) // 2
    left, right = cells.copy(), cells.copy()
    left[:, 2 * axis + 1] = right[:, 2 * axis] = middles
    return np.concatenate([left, right])


def _bounded(nets: Nets, cells: Integers) -> tuple[Floats, Floats]:
    """Of exact surfaces: coefficients of P - B over the least weight, infinite where that is not positive."""
    points, weights = nets[..., :3], nets[..., 3:]
    with np.errstate(all="ignore"):
        corners = points[:, [0, 0, -1, -1], [0, -1, 0, -1]] / weights[:, [0, 0, -1, -1], [0, -1, 0, -1]]
        corners = corners.reshape(-1, 2, 2, 3)
        errors = product(points, np.ones((1, 2, 2, 1))) - product(weights, corners)
        least = weights.min(axis=(1, 2), keepdims=True)
        return np.where(least > 0, errors / least, math.inf), corners


def _measured(surface: ParametricSurface) -> Look:
    """Of other surfaces: P - B at points of each cell."""
    share = np.linspace(0.0, 1.0, SAMPLES)
    (low, high), (bottom, top) = surface.domain

    def look(_: Nets, cells: Integers) -> tuple[Floats, Floats]:
        places = cells / GRID
        t, h = (places[:, i, None] * (1 - share) + places[:, i + 1, None] * share for i in (0, 2))
        t, h = low + (high - low) * t[:, :, None], bottom + (top - bottom) * h[:, None, :]
        points = np.stack(np.broadcast_arrays(t, h), axis=-1)
        points[..., 0] = np.clip(points[..., 0], low, high)
        points[..., 1] = np.clip(points[..., 1], bottom, top)
        values = surface(points)
        corners = values[:, [0, 0, -1, -1], [0, -1, 0, -1]].reshape(-1, 2, 2, 3)
        hats = np.stack([1 - share, share])
        errors = values - np.einsum("ia,jb,cijx->cabx", hats, hats, corners)
        return np.where(np.isfinite(errors), SAFETY * errors, math.inf), np.nan_to_num(corners)

    return look


def _require_hope(
    bounds: Floats, cells: Integers, depth: int, count: int, surface: ParametricSurface, tolerance: float
) -> None:
    """Raise the error that says why halving on would be in vain."""
    lost = cells if depth >= DEEPEST else cells[~np.isfinite(bounds)]
    if len(lost) and (depth >= LOST or count > LARGEST):
        middles = [(lost[0, 2 * i] + lost[0, 2 * i + 1]) / (2 * GRID) for i in (0, 1)]
        place = ", ".join(
            f"{name} = {low + (high - low) * share:.6g}"
            for name, share, (low, high) in zip(surface.parameters, middles, surface.domain, strict=True)
        )
        what = "the surface has a pole, jumps, or numerator and denominator vanish together,"
        raise GeometryError(f"{what} near {place}; give a domain that avoids it")
    if count > LARGEST:
        raise MeshError(f"the tolerance {tolerance:.3g} needs more than {2 * LARGEST} triangles; give a larger one")
