"""Bounds on every triangle of a mesh of a surface f = 0: |f|, and how steeply f rises across it.

Near the walls, where the mesh ends, across means along the wall: see `pas.surface.mesh_proofs`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.signs import rounding_bound
from pas.bernstein.subdivision import raised
from pas.mesh.field import Integers
from pas.mesh.radial import facets
from pas.surface.mesh_stage import ON_WALL, SCALED, Stage
from pas.surface.rests import halves
from pas.surface.triangle_forms import Forms, TriangleForms, on_corners

ROUNDINGS = 64
"""Of a triangle's unit normal, over its longest edge squared and its area."""

LARGER = 1.0625
"""By how much the region is enlarged where the surface beyond its walls counts as well (exact in doubles)."""

ENOUGH = 10_000
"""Parts of the cells that are not halved further."""

CUTS = (9, 14)
"""Halvings of the cells for bounds of second derivatives, and where those are not enough."""


@dataclass(frozen=True)
class Bounds:
    """Of each triangle: an upper bound of |f| and a lower one of the derivative of f along its normal, (T,)."""

    most: Floats
    least: Floats


class Boxes:
    """Many boxes from `low` (N, 3) to `high` (N, 3)."""

    def __init__(self, low: Floats, high: Floats) -> None:
        self._low, self._high = np.ascontiguousarray(low.T), np.ascontiguousarray(high.T)

    def meeting(self, low: Floats, high: Floats) -> Integers:
        """The numbers of those that meet the box from `low` (3,) to `high` (3,)."""
        rows = np.flatnonzero((self._low[0] <= high[0]) & (self._high[0] >= low[0]))
        for axis in (1, 2):
            rows = rows[(self._low[axis, rows] <= high[axis]) & (self._high[axis, rows] >= low[axis])]
        return rows


def bounds(stage: Stage) -> Bounds:
    """The bounds on all triangles, each for all pieces that it may touch."""
    most, least = np.zeros(len(stage.triangles)), np.full(len(stage.triangles), np.inf)
    corners = stage.points[stage.triangles]
    for piece, patch in enumerate(stage.patches):
        rows = np.flatnonzero(stage.touching(piece))
        maker = TriangleForms(patch, stage.degree, stage.reach)
        for here, forms in maker.blocks(corners[rows]):
            part = rows[here]
            most[part] = np.maximum(most[part], np.abs(forms.values).max(axis=0) + forms.value_error)
            normals, loose = unit_normals(corners[part])
            along = np.einsum("tx,xkt->kt", normals, forms.gradients).min(axis=0)
            least[part] = np.minimum(least[part], along - _slack(forms, loose))
    return Bounds(most, least)


def unit_normals(corners: Floats) -> tuple[Floats, Floats]:
    """Unit normals (T, 3) of triangles, and by how much each may be turned, by rounding or by putting corners that are
    off a wall by rounding onto it."""
    across = facets(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    area = np.maximum(np.sqrt((across * across).sum(axis=1)), 1e-300)
    sides = corners - np.roll(corners, 1, axis=1)
    longest = (sides * sides).sum(axis=2).max(axis=1)
    return across / area[:, None], ROUNDINGS * UNIT_ROUNDOFF * longest / area + 8 * ON_WALL * np.sqrt(longest) / area


def _slack(forms: Forms, loose: Floats) -> Floats:
    """What derivatives along unit vectors may be off by, which are themselves off by `loose` (T,)."""
    size = np.sqrt((forms.gradients**2).sum(axis=0).max(axis=0)) + 3 * forms.gradient_error
    return np.asarray(3 * forms.gradient_error + loose * size)


def along_walls(stage: Stage, rims: list[tuple[Floats, np.ndarray]]) -> tuple[Floats, Integers]:
    """How steeply f rises across triangles along walls or edges, where the mesh ends on them: the least of each, (K,),
    and the triangles (K,).

    `rims` are orthonormal directions (k, 3) at right angles to which it counts, and the vertices (N,) there.
    """
    found, numbers = [np.empty(0)], [np.empty(0, dtype=np.intp)]
    makers = [TriangleForms(patch, stage.degree, stage.reach) for patch in stage.patches]
    touching = [stage.touching(piece) for piece in range(len(makers))]
    for across, vertices in rims:
        code = vertices[stage.triangles] @ np.array([1, 2, 4])
        for pattern in np.flatnonzero(np.bincount(code, minlength=8)[1:]) + 1:
            rows = np.flatnonzero(code == pattern)
            marked = (bool(pattern & 1), bool(pattern & 2), bool(pattern & 4))
            for maker, near in zip(makers, touching, strict=True):
                part = rows[near[rows]]
                if not len(part):
                    continue
                corners = stage.points[stage.triangles[part]]
                forms = maker.on(corners)
                normals, loose = unit_normals(corners)
                normals = normals - (normals @ across.T) @ across
                chosen = forms.gradients[:, on_corners(stage.degree - 1, marked)]
                found.append(np.einsum("tx,xkt->kt", normals, chosen).min(axis=0) - _slack(forms, loose))
                numbers.append(part)
    return np.concatenate(found), np.concatenate(numbers)


def farthest(stage: Stage, bounds: Bounds) -> Floats | None:
    """How far triangles (T,) are from the zeros at most, in local units, infinite where that is not known.

    From x on a triangle f falls towards 0 along the normal by at least `least s - H s^2 / 2` on a way s, where H bounds
    second derivatives on the way, which must be in the enlarged region: near by, where those everywhere are too large.
    """
    if stage.center is None:
        return None
    way = np.full(len(bounds.most), np.inf)
    corners = stage.points[stage.triangles]
    for cuts in CUTS:
        low, high, bends = _bends(stage, float(bounds.most.max()), cuts)
        way = np.minimum(way, _way(bounds, bends.max(initial=0.0)))
        boxes = Boxes(low, high)
        for row in np.flatnonzero(~np.isfinite(way) & (bounds.least > 0)).tolist():
            reach = 2 * bounds.most[row] / bounds.least[row]
            near = boxes.meeting(corners[row].min(axis=0) - reach, corners[row].max(axis=0) + reach)
            way[row] = _way(Bounds(bounds.most[[row]], bounds.least[[row]]), bends[near].max(initial=0.0))[0]
        if np.isfinite(way).all():
            break
    return np.where(way <= (LARGER - 1) * stage.room, way, np.inf)


def _way(bounds: Bounds, bend: float) -> Floats:
    """The least way on which f surely vanishes, infinite where there is none."""
    with np.errstate(all="ignore"):
        root = np.sqrt(bounds.least**2 - 2 * bend * bounds.most)
        way = 2 * bounds.most / (bounds.least + root) * (1 + ROUNDINGS * UNIT_ROUNDOFF)
    return np.where((bounds.least > 0) & np.isfinite(way), way, np.inf)


def _bends(stage: Stage, most: float, cuts: int) -> tuple[Floats, Floats, Floats]:
    """The boxes (N, 3), (N, 3) of parts of the enlarged region that hold all of it where |f| <= most, and on each a
    bound of the second derivatives' matrix (N,)."""
    center = stage.partition.center
    assert center is not None
    middle = stage.frame.local_point(center)
    cells = [
        tuple(tuple(m + (c - m) * 17 / 16 for c, m in zip(v, middle, strict=True)) for v in cell)
        for cell in stage.exact
    ]
    forms, error = stage.forms(cells)  # type: ignore[arg-type]
    origin = np.array(to_floats(middle))
    corners = origin + LARGER * (stage.corners - origin)
    size, cut = float(np.abs(forms).max()), 0
    while True:
        bound = rounding_bound(stage.degree, cut, error) * size
        near = np.maximum(forms.min(axis=1), -forms.max(axis=1)) - bound <= most * (1 + 2 * SCALED)
        forms, corners = forms[near], corners[near]
        if cut == cuts or not len(forms) or len(forms) > ENOUGH:
            break
        forms, corners = halves(forms, corners, stage.degree)
        cut += 1
    return corners.min(axis=1), corners.max(axis=1), _hessians(forms, corners, stage.degree, bound)


def _hessians(forms: Floats, corners: Floats, degree: int, error: float) -> Floats:
    """The largest Frobenius norms (N,) of second derivatives' B-coefficients on tetrahedra."""
    if degree < 2 or not len(forms):
        return np.zeros(len(forms))
    up, again = raised(degree - 1, 4), raised(degree, 4)
    second = forms[:, again[up]]  # (N, m, 4, 4)
    differences = second[:, :, 1:, 1:] - second[:, :, 1:, :1] - second[:, :, :1, 1:] + second[:, :, :1, :1]
    back = np.linalg.inv(corners[:, 1:] - corners[:, :1])
    hessians = back[:, None] @ differences @ back.transpose(0, 2, 1)[:, None]
    norms = np.sqrt((hessians**2).sum(axis=(2, 3))).max(axis=1)
    loose = 12 * error * (back**2).sum(axis=(1, 2))
    return np.asarray(degree * (degree - 1) * (norms + loose) * (1 + 2 * SCALED))
