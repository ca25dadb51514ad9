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

CUTS, MANY = 6, 4096
"""How often triangles are cut into four where bounds on them do not do, and how many are cut for their distance."""

CLEAR = 1e-9
"""In local units: how far what is apart from a triangle is from a plane of it."""

TIMES = (0.65, 0.75, 0.85, 0.95, 1.05, 1.2, 1.5, 2.0, 4.0)
"""How far triangles are moved for a change of sign, over what |f| by the least slope on them asks for, at most and for
the share `USUAL` of them."""

USUAL, ENOUGH = 0.98, 1.2
"""That share; and how many times as far triangles in several pieces are moved, before they are cut."""


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


def apart(simplex: Floats, triangles: Floats) -> np.ndarray:
    """Which triangles (T, 3, 3) a plane separates from a simplex (d + 1, 3): their own, or one through a side of it.

    Others may be apart as well.  The margin `CLEAR` is for rounding, and for corners on walls that are off these.
    """
    normals = unit_normals(triangles)[0]
    heights = [np.einsum("tsx,tx->ts", simplex - triangles[:, :1], side * normals) for side in (-1, 1)]
    for i in range(3):
        way = triangles[:, (i + 1) % 3] - triangles[:, i]
        out = np.cross(way, normals) / np.maximum(np.sqrt((way * way).sum(axis=1)), 1e-300)[:, None]
        heights.append(np.einsum("tsx,tx->ts", simplex - triangles[:, i, None], out))
    return np.asarray(np.max([height.min(axis=1) for height in heights], axis=0) > CLEAR)


def bounds(sheet: Sheet) -> Bounds:
    """The bounds on all triangles, each for all pieces that it may touch.

    Triangles in several pieces are cut into parts where the polynomial of one goes wrong in another.
    """
    normals, loose = unit_normals(sheet.corners)
    most, least = np.zeros(len(normals)), np.full(len(normals), np.inf)
    owner, corners, usual = np.arange(len(normals)), sheet.corners, np.inf
    for depth in range(CUTS + 1):
        large, small, several = _bounded(sheet.stage, corners, normals[owner], loose[owner])
        if depth == 0 and not several.all():
            usual = large[~several].max()
        again = several & ((small <= 0) | (large > usual)) & (depth < CUTS)
        np.maximum.at(most, owner[~again], large[~again])
        np.minimum.at(least, owner[~again], small[~again])
        if not again.any():
            break
        owner, corners = np.repeat(owner[again], 4), quarters(corners[again])
    return Bounds(most, least)


def _bounded(stage: Stage, corners: Floats, normals: Floats, loose: Floats) -> tuple[Floats, Floats, np.ndarray]:
    """Of triangles (T, 3, 3) upper bounds of |f|, lower ones of derivatives along normals that are off by `loose`, and
    which may touch several pieces, (T,)."""
    most, least = np.zeros(len(corners)), np.full(len(corners), np.inf)
    touched = stage.touched(corners)
    several = _times(touched, len(corners)) > 1
    for maker, rows in zip(stage.makers, touched, strict=True):
        most[rows] = np.maximum(most[rows], _largest(maker.ranges(corners[rows])) + maker.value_error)
        along, size = maker.slopes(corners[rows], normals[rows])
        least[rows] = np.minimum(least[rows], along - _slack(size, maker.gradient_error, loose[rows]))
    large = most > most.max(initial=0.0, where=~several if not several.all() else several) / 2  # bounded more closely
    closer = np.zeros(len(most))
    for maker, rows in zip(stage.makers, touched, strict=True):
        part = rows[large[rows]]
        closer[part] = np.maximum(closer[part], _largest(maker.ranges(corners[part], closer=True)) + maker.value_error)
    return np.where(large, closer, most), least, several


def quarters(corners: Floats) -> Floats:
    """The four parts (4 T, 3, ...) of triangles (T, 3, ...), cut at the middles of their sides."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    p, q, r = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [np.stack(part, axis=1) for part in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))]
    return np.stack(parts, axis=1).reshape(-1, *corners.shape[1:])


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
    normals, loose = unit_normals(sheet.corners)
    for across, vertices in rims:
        owner = np.flatnonzero(vertices[sheet.triangles].any(axis=1))
        marks, corners = vertices[sheet.triangles[owner]], sheet.corners[owner]
        along = normals - (normals @ across.T) @ across
        for depth in range(CUTS + 1):
            least, several = _on_sides(sheet.stage, corners, marks, along[owner], loose[owner])
            again = several & (least <= 0) & (depth < CUTS)
            found.append(least[~again])
            numbers.append(owner[~again])
            if not again.any():
                break
            owner, corners = np.repeat(owner[again], 4), quarters(corners[again])
            marks = quarters(marks[again].astype(float)) == 1  # the middle of a side is on the wall if both ends are
            kept = marks.any(axis=1)
            owner, corners, marks = owner[kept], corners[kept], marks[kept]
    return np.concatenate(found), np.concatenate(numbers)


def _on_sides(
    stage: Stage, corners: Floats, marks: np.ndarray, along: Floats, loose: Floats
) -> tuple[Floats, np.ndarray]:
    """The least derivatives (T,) along given directions (T, 3), off by `loose`, on the sides or corners of triangles
    (T, 3, 3) that have marks (T, 3); and which triangles may touch several pieces."""
    least, touched = np.full(len(corners), np.inf), stage.touched(corners)
    code = marks @ np.array([1, 2, 4])
    for maker, near in zip(stage.makers, touched, strict=True):
        for pattern in np.unique(code[near]).tolist():
            rows = near[code[near] == pattern]
            gradients = maker.gradients(corners[rows])
            chosen = gradients[:, on_corners(stage.degree - 1, (pattern & 1 > 0, pattern & 2 > 0, pattern & 4 > 0))]
            size = np.sqrt((gradients**2).sum(axis=0).max(axis=0))
            slope = np.einsum("tx,xkt->kt", along[rows], chosen).min(axis=0)
            least[rows] = np.minimum(least[rows], slope - _slack(size, maker.gradient_error, loose[rows]))
    return least, _times(touched, len(corners)) > 1


def farthest(sheet: Sheet, bounds: Bounds) -> Floats | None:
    """How far triangles (T,) are from the zeros at most, in local units, infinite where that is not known.

    A triangle, or each of its parts, is moved along its normal, to one side until f < 0 on it, to the other until
    f > 0: between the two places of each of its points there is a zero, as the pieces of f go on beyond the walls as
    cones about the centre.
    """
    stage = sheet.stage
    if stage.center is None:
        return None
    normals, longest = unit_normals(sheet.corners)[0], stage.beyond
    with np.errstate(all="ignore"):
        need = np.where(bounds.least > 0, bounds.most / bounds.least, np.inf)
    known = np.sort(need[need <= longest])
    usual, most = known[[int(USUAL * (len(known) - 1)), -1]].tolist() if len(known) else (longest, longest)
    tried = sorted({min(some * times, longest) for some in (usual, most) for times in TIMES})
    way, owner, corners = np.zeros(len(need)), np.arange(len(need)), sheet.corners
    for depth in range(CUTS + 1):
        several = _several(stage, corners, ENOUGH * usual * normals[owner])
        for away in tried:
            checkpoint(f"bounding distances ({len(owner)} triangles)")
            rows = np.flatnonzero(~several | (away <= ENOUGH * usual) | (depth == CUTS))
            far, apart = _apart(stage, corners[rows], normals[owner[rows]], away)
            apart &= far <= longest
            np.maximum.at(way, owner[rows[apart]], far[apart] * (1 + ROUNDINGS * UNIT_ROUNDOFF))
            left = np.ones(len(owner), dtype=bool)
            left[rows[apart]] = False
            owner, corners, several = owner[left], corners[left], several[left]
            if not len(owner):
                return way
        if depth == CUTS or len(owner) > MANY:
            break
        owner, corners = np.repeat(owner, 4), quarters(corners)
    way[owner] = np.inf
    return way


def _several(stage: Stage, corners: Floats, ways: Floats) -> np.ndarray:
    """Which triangles (T, 3, 3) may touch several pieces when they are moved along given ways (T, 3) or back."""
    if len(stage.makers) == 1:
        return np.zeros(len(corners), dtype=bool)
    moved = [stage.touched(corners + side * ways[:, None], LARGER) for side in (-1, 1)]
    return np.asarray(np.maximum(*(_times(rows, len(corners)) for rows in moved)) > 1)


def _times(rows: list[Integers], count: int) -> Integers:
    """How often each of the first numbers stands in some rows."""
    return np.bincount(np.concatenate(rows), minlength=count)


def _apart(stage: Stage, corners: Floats, normals: Floats, way: float) -> tuple[Floats, np.ndarray]:
    """How far triangles (T, 3, 3) that are moved so far along normals (T, 3) and back get, and between which places f
    surely changes its sign."""
    back, forth = (corners + side * way * normals[:, None] for side in (-1, 1))
    off = np.maximum(((back - corners) ** 2).sum(axis=2), ((forth - corners) ** 2).sum(axis=2))
    return np.sqrt(off.max(axis=1)), _signs(stage, back, -1) & _signs(stage, forth, 1)


def _signs(stage: Stage, corners: Floats, sign: int) -> np.ndarray:
    """On which triangles (T, 3, 3) of the enlarged region f surely has a sign."""
    result = np.ones(len(corners), dtype=bool)
    for maker, near in zip(stage.makers, stage.touched(corners, LARGER), strict=True):
        rows = near[result[near]]
        for closer in (False, True):
            low, high = maker.ranges(corners[rows], closer)
            rows = rows[~((low if sign > 0 else -high) > maker.value_error)]
        result[rows] = False
    return result
