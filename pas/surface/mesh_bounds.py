"""Bounds on every triangle of a mesh of a surface f = 0: |f|, and how steeply f rises across it.

Near the walls, where the mesh ends, across means along the wall: see `pas.surface.mesh_proofs`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.limits import checkpoint
from pas.mesh.field import Integers
from pas.mesh.radial import facets
from pas.surface.mesh_stage import LARGER, ON_WALL, Sheet, Stage
from pas.surface.triangle_forms import on_corners

ROUNDINGS = 64
"""Of a triangle's unit normal, over its longest edge squared and its area."""

TIMES = (0.65, 0.75, 0.85, 0.95, 1.05, 1.2, 1.5, 2.0, 4.0)
"""How far triangles are moved for a change of sign, over the most that |f| by the least slope on them asks for."""


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


def bounds(sheet: Sheet) -> Bounds:
    """The bounds on all triangles, each for all pieces that it may touch."""
    corners, makers = sheet.corners, sheet.stage.makers
    most, least = np.zeros(len(corners)), np.full(len(corners), np.inf)
    normals, loose = unit_normals(corners)
    touched = [np.flatnonzero(sheet.stage.near(piece, corners)) for piece in range(len(makers))]
    for maker, rows in zip(makers, touched, strict=True):
        most[rows] = np.maximum(most[rows], _largest(maker.ranges(corners[rows])) + maker.value_error)
        along, size = maker.slopes(corners[rows], normals[rows])
        least[rows] = np.minimum(least[rows], along - _slack(size, maker.gradient_error, loose[rows]))
    large = most > most.max(initial=0.0) / 2  # few: these are bounded more closely
    closer = np.zeros(len(most))
    for maker, rows in zip(makers, touched, strict=True):
        part = rows[large[rows]]
        closer[part] = np.maximum(closer[part], _largest(maker.ranges(corners[part], closer=True)) + maker.value_error)
    return Bounds(np.where(large, closer, most), least)


def _largest(ranges: tuple[Floats, Floats]) -> Floats:
    return np.maximum(-ranges[0], ranges[1])


def unit_normals(corners: Floats) -> tuple[Floats, Floats]:
    """Unit normals (T, 3) of triangles, and by how much each may be turned, by rounding or by putting corners that are
    off a wall by rounding onto it."""
    across = facets(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    area = np.maximum(np.sqrt((across * across).sum(axis=1)), 1e-300)
    sides = corners - np.roll(corners, 1, axis=1)
    longest = (sides * sides).sum(axis=2).max(axis=1)
    return across / area[:, None], ROUNDINGS * UNIT_ROUNDOFF * longest / area + 8 * ON_WALL * np.sqrt(longest) / area


def _slack(sizes: Floats, error: float, loose: Floats) -> Floats:
    """What derivatives along unit vectors may be off by, which are themselves off by `loose` (T,): of gradients of
    some size (T,) whose coefficients err by so much."""
    return np.asarray(3 * error + loose * (sizes + 3 * error))


def along_walls(sheet: Sheet, rims: list[tuple[Floats, np.ndarray]]) -> tuple[Floats, Integers]:
    """How steeply f rises across triangles along walls or edges, where the mesh ends on them: the least of each, (K,),
    and the triangles (K,).

    `rims` are orthonormal directions (k, 3) at right angles to which it counts, and the vertices (N,) there.
    """
    found, numbers = [np.empty(0)], [np.empty(0, dtype=np.intp)]
    stage = sheet.stage
    for across, vertices in rims:
        code = vertices[sheet.triangles] @ np.array([1, 2, 4])
        for pattern in np.flatnonzero(np.bincount(code, minlength=8)[1:]) + 1:
            rows = np.flatnonzero(code == pattern)
            marked = (bool(pattern & 1), bool(pattern & 2), bool(pattern & 4))
            for piece, maker in enumerate(stage.makers):
                part = rows[stage.near(piece, sheet.corners[rows])]
                if not len(part):
                    continue
                corners = sheet.corners[part]
                forms = maker.on(corners)
                normals, loose = unit_normals(corners)
                normals = normals - (normals @ across.T) @ across
                chosen = forms.gradients[:, on_corners(stage.degree - 1, marked)]
                size = np.sqrt((forms.gradients**2).sum(axis=0).max(axis=0))
                slack = _slack(size, maker.gradient_error, loose)
                found.append(np.einsum("tx,xkt->kt", normals, chosen).min(axis=0) - slack)
                numbers.append(part)
    return np.concatenate(found), np.concatenate(numbers)


def farthest(sheet: Sheet, bounds: Bounds) -> Floats | None:
    """How far triangles (T,) are from the zeros at most, in local units, infinite where that is not known.

    A triangle is moved along its normal, to one side until f < 0 on it, to the other until f > 0: between the two
    places of each of its points there is a zero, as the pieces of f go on beyond the walls as cones about the centre.
    """
    stage, corners = sheet.stage, sheet.corners
    if stage.center is None:
        return None
    normals = unit_normals(corners)[0]
    longest = (LARGER - 1) * stage.room
    way = np.full(len(corners), np.inf)
    with np.errstate(all="ignore"):
        need = np.where(bounds.least > 0, bounds.most / bounds.least, np.inf)
    common = need[need <= longest].max(initial=0.0)
    rows = np.flatnonzero(need <= longest)
    for times in TIMES:
        checkpoint(f"bounding distances ({len(rows)} triangles)")
        tried = min(common * times, longest)
        ends = [corners[rows] + side * tried * normals[rows, None] for side in (-1, 1)]
        far = np.maximum(*(((end - corners[rows]) ** 2).sum(axis=2).max(axis=1) for end in ends))
        apart = _signs(stage, ends[0], -1) & _signs(stage, ends[1], 1) & (far <= longest**2)
        way[rows[apart]] = np.sqrt(far[apart]) * (1 + ROUNDINGS * UNIT_ROUNDOFF)
        rows = rows[~apart]
        if not len(rows):
            break
    return way


def _signs(stage: Stage, corners: Floats, sign: int) -> np.ndarray:
    """On which triangles (T, 3, 3) of the enlarged region f surely has a sign."""
    result = np.ones(len(corners), dtype=bool)
    for piece, maker in enumerate(stage.makers):
        rows = np.flatnonzero(result & stage.near(piece, corners, LARGER))
        for closer in (False, True):
            low, high = maker.ranges(corners[rows], closer)
            rows = rows[~((low if sign > 0 else -high) > maker.value_error)]
        result[rows] = False
    return result
