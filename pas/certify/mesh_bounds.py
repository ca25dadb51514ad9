"""Bounds on every triangle of a mesh of a surface f = 0: |f|, and how steeply f rises across it.

Near the walls, where the mesh ends, across means along the wall: see `pas.certify.mesh_proofs`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.search import Cells, Fate, Fates, Limits, search
from pas.certify.local_mesh import ROUNDINGS, FramedMesh, FramedSurface
from pas.certify.triangle_forms import on_corners
from pas.mesh.rows import any_of, cross, dots, norms, quarters

CUTS = 8
"""How often triangles are cut into four where bounds on them do not do; the rounding of forms counts so many cuts."""

ALL = Limits(CUTS, 1 << 22)
"""Of triangles that are bounded: some 100 bytes are needed for each."""

CLEAR = 1e-9
"""In local units: how far what is apart from a triangle is from a plane of it."""


@dataclass(frozen=True)
class Parts(Cells):
    """Parts (P, 3, 3) of triangles, their numbers (P,), and which corners (P, 3) are marked, such as those on walls."""

    corners: Floats
    owner: Integers
    marks: Bools

    @classmethod
    def of(cls, corners: Floats) -> Parts:
        """Whole triangles (T, 3, 3), all corners of which are marked."""
        return cls(corners, np.arange(len(corners)), np.ones((len(corners), 3), dtype=bool))

    def quarters(self) -> Parts:
        """The quarters of each with marked corners: cut at sides' middles, marked if both ends are."""
        marks = quarters(self.marks.astype(float)).reshape(-1, 3) == 1
        parts = Parts(quarters(self.corners).reshape(-1, 3, 3), np.repeat(self.owner, 4), marks)
        return parts if marks.all() else parts.select(marks.any(axis=1))


def apart(simplices: Floats, corners: Floats, normals: Floats) -> Bools:
    """Which simplices (K, d + 1, 3) are parted from triangles (K, 3, 3) with unit normals (K, 3), each from one, by its
    plane or one through a side of it.

    Others may be apart as well.  The margin `CLEAR` is for rounding, and for corners on walls that are off these.
    """
    found = np.zeros(len(simplices), dtype=bool)
    if not len(found):
        return found
    planes = [(corners[:, 0], normals), (corners[:, 0], -normals)]
    for i in range(3):
        way = corners[:, (i + 1) % 3] - corners[:, i]
        planes.append((corners[:, i], cross(way, normals) / np.maximum(np.sqrt(dots(way, way)), 1e-300)[:, None]))
    for point, out in planes:
        x, y, z = (corner - p[:, None] for corner, p in zip(simplices.transpose(2, 0, 1), point.T, strict=True))
        heights = x * out[:, :1] + y * out[:, 1:2] + z * out[:, 2:]
        found |= heights.min(axis=1) > CLEAR
    return found


def bounds(mesh: FramedMesh) -> tuple[Floats, Floats]:
    """Of all triangles an upper bound of |f| and a lower one of the derivative of f along the normal, (T,), each for
    all pieces that it may touch.

    Triangles in several pieces are cut into parts where the polynomial of one goes wrong in another.
    """
    normals, loose = mesh.normals, mesh.loose
    most, least, usual = np.zeros(len(normals)), np.full(len(normals), np.inf), np.inf

    def judge(parts: Parts, depth: int) -> Fates:
        nonlocal usual
        large, small, several = _bounded(mesh.local, parts.corners, normals[parts.owner], loose[parts.owner])
        if depth == 0 and not several.all():
            usual = large[~several].max()
        again = several & ((small <= 0) | (large > usual)) & (depth < CUTS)
        np.maximum.at(most, parts.owner[~again], large[~again])
        np.minimum.at(least, parts.owner[~again], small[~again])
        return np.where(again, Fate.SPLIT, Fate.SETTLED)

    left = search(Parts.of(mesh.corners), judge, Parts.quarters, ALL, "bounding f on triangles").open.owner
    most[left], least[left] = np.inf, -np.inf
    return most, least


def _bounded(local: FramedSurface, corners: Floats, normals: Floats, loose: Floats) -> tuple[Floats, Floats, Bools]:
    """For triangles (T, 3, 3) upper bounds of |f|, lower ones of derivatives along normals that are off by `loose`, and
    which may touch several pieces, (T,)."""
    most, least = np.zeros(len(corners)), np.full(len(corners), np.inf)
    touched = local.touched(corners)
    several = _times(touched, len(corners)) > 1
    for maker, rows in zip(local.makers, touched, strict=True):
        some = (corners, normals) if len(rows) == len(corners) else (corners[rows], normals[rows])
        most[rows] = np.maximum(most[rows], _largest(maker.ranges(some[0])) + maker.value_error)
        along, size = maker.slopes(*some)
        least[rows] = np.minimum(least[rows], along - _slack(size, maker.gradient_error, loose[rows]))
    large = most > most.max(initial=0.0, where=~several if not several.all() else several) / 2  # bounded more closely
    closer = np.zeros(len(most))
    for maker, rows in zip(local.makers, touched, strict=True):
        part = rows[large[rows]]
        closer[part] = np.maximum(closer[part], _largest(maker.ranges(corners[part], closer=True)) + maker.value_error)
    return np.where(large, closer, most), least, several


def _largest(ranges: tuple[Floats, Floats]) -> Floats:
    return np.maximum(-ranges[0], ranges[1])


def _slack(sizes: Floats, error: float, loose: Floats) -> Floats:
    """The errors (T,) of derivatives along directions that are off by `loose` (T,), for gradients of some size (T,)
    whose coefficients are off by `error`."""
    return np.asarray(3 * error + loose * (sizes + 3 * error))


def along_walls(mesh: FramedMesh, borders: list[tuple[Floats, Bools]]) -> tuple[Floats, Integers]:
    """How steeply f rises across triangles along walls or edges, where the mesh ends on them: the least of each, (K,),
    and the triangles (K,).

    `borders` are orthonormal directions (k, 3) at right angles to which it counts, and the vertices (N,) there.
    """
    if not borders:
        return np.empty(0), np.empty(0, dtype=np.intp)
    ends = mesh.triangles[some := np.flatnonzero(any_of(np.any([v for _, v in borders], axis=0)[mesh.triangles]))]
    rows = [some[any_of(vertices[ends])] for _, vertices in borders]
    owner, rim = np.concatenate(rows), np.repeat(np.arange(len(borders)), [len(own) for own in rows])
    marks = np.concatenate([vertices[mesh.triangles[own]] for (_, vertices), own in zip(borders, rows, strict=True)])
    normals = [mesh.normals[own] for own in rows]
    ways = [n - (n @ across.T) @ across for n, (across, _) in zip(normals, borders, strict=True)]
    along, loose, corners = np.concatenate(ways), mesh.loose[owner], mesh.corners[owner]
    found: list[tuple[Floats, Integers]] = []

    def judge(parts: Parts, depth: int) -> Fates:
        least, several = _on_sides(mesh.local, parts, along[parts.owner], loose[parts.owner])
        again = several & (least <= 0) & (depth < CUTS)
        found.append((least[~again], parts.owner[~again]))
        return np.where(again, Fate.SPLIT, Fate.SETTLED)

    left = search(
        Parts(corners, np.arange(len(owner)), marks), judge, Parts.quarters, ALL, "bounding f on triangles"
    ).open
    found.append((np.full(len(left), -np.inf), left.owner))
    least, part = (np.concatenate(column) for column in zip(*found, strict=True))
    order = np.argsort(rim[part], kind="stable")
    return least[order], owner[part[order]]


def _on_sides(local: FramedSurface, parts: Parts, along: Floats, loose: Floats) -> tuple[Floats, Bools]:
    """The least derivatives (T,) along given directions (T, 3), off by `loose`, on the sides or corners of triangles
    that are marked; and which triangles may touch several pieces."""
    least, touched = np.full(len(parts), np.inf), local.touched(parts.corners)
    code = parts.marks @ np.array([1, 2, 4])
    for maker, near in zip(local.makers, touched, strict=True):
        gradients = maker.gradients(parts.corners[near])
        slack = _slack(np.sqrt((gradients**2).sum(axis=0).max(axis=0)), maker.gradient_error, loose[near])
        way = along[near].T
        slopes = way[0] * gradients[0] + way[1] * gradients[1] + way[2] * gradients[2]
        slopes[~on_corners(local.degree - 1)[code[near]].T] = np.inf
        least[near] = np.minimum(least[near], slopes.min(axis=0) - slack)
    return least, _times(touched, len(parts)) > 1


def farthest(mesh: FramedMesh, most: Floats, least: Floats) -> Floats | None:
    """How far triangles (T,) are from the zeros at most, in local units, infinite where that is not known.

    A triangle, or each of its parts, is moved to one side until f < 0 on it, to the other until f > 0: between one of
    the two places of each of its points and the point there is a zero, as the pieces of f go on beyond the walls as
    cones about the centre.  It is moved along its normal or, where this leads through a sharp edge or past it, along
    the ray from the centre, which stays on one side of a surface that it crosses once.  Most are moved as far as f and
    its gradient say in the middle of triangles, those that are left farther.
    """
    local = mesh.local
    if local.center is None:
        return None
    most_share, factors = 0.995, (1.05, 1.25, 1.5, 2.0, 3.0, 6.0, 30.0)
    values, gradients = local.jets(mesh.corners.mean(axis=1))
    with np.errstate(all="ignore"):
        nearest = np.min(np.where(least > 0, most / least, local.beyond))
        near = np.nan_to_num(np.abs(values) / norms(gradients.T))
    usual = max(float(np.quantile(near, most_share)), float(nearest))
    way, left = np.zeros(len(near)), np.arange(len(near))
    for away in sorted({min(times * usual, local.beyond) for times in factors}):
        way[left] = away
        left = _one_signed(mesh, left, away)
    way[left] = np.inf
    return np.asarray(way + ROUNDINGS * UNIT_ROUNDOFF * (way + local.reach))


def _one_signed(mesh: FramedMesh, chosen: Integers, away: float) -> Integers:
    """Those of some triangles of which f is not proved to have both signs once they, or their parts, move by `away`.

    One is given up where the middle of a part has a sign on neither way: parts of that would not have it either.
    """
    local, limits = mesh.local, Limits(depth=6, cells=4096)  # a farther way costs less than smaller parts

    def judge(parts: Parts, depth: int) -> Fates:
        fates, done = np.full(len(parts), Fate.SPLIT.value), np.arange(len(parts))
        middles, wrong = parts.corners.mean(axis=1), np.zeros(len(parts), dtype=bool)
        rays = middles - local.center
        ways = mesh.normals[chosen[parts.owner]], rays / np.maximum(norms(rays), 1e-300)[:, None]
        for sign in (-1, 1):
            left = done
            for way in ways:
                left = left[~_signs(local, parts.corners[left], sign * away * way[left], sign)]
            done = np.setdiff1d(done, left)
            moved = [middles[left] + sign * away * way[left] for way in ways]
            wrong[left] |= np.all([sign * local.jets(points)[0] <= 0 for points in moved], axis=0)
        fates[np.isin(parts.owner, parts.owner[wrong])] = Fate.KEEP
        fates[done] = Fate.SETTLED
        return fates

    found = search(Parts.of(mesh.corners[chosen]), judge, Parts.quarters, limits, "bounding distances")
    return chosen[np.unique(np.concatenate([found.open.owner, found.kept.owner]))]


def _times(rows: list[Integers], count: int) -> Integers:
    """How often each of the first numbers stands in some rows."""
    return np.bincount(np.concatenate(rows), minlength=count)


def _signs(local: FramedSurface, corners: Floats, ways: Floats, sign: int) -> Bools:
    """On which triangles (T, 3, 3), moved along ways (T, 3) in the enlarged region, f surely has a sign."""
    corners = corners + ways[:, None]
    touched = local.touched(corners, local.larger)
    result = _times(touched, len(corners)) > 0
    for maker, near in zip(local.makers, touched, strict=True):
        rows = near[result[near]]
        for closer in (False, True) if len(rows) else ():
            low, high = maker.ranges(corners[rows], closer)
            rows = rows[~((low if sign > 0 else -high) > maker.value_error)]
        result[rows] = False
    return result
