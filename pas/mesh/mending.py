"""Slender triangles of a mesh made better where they are: vertices moved and edges flipped, a few at a time.

Each change is put onto the surface and measured before it is kept: no triangle about it is then further off than
allowed, folded, or more slender than the worst was.  Changes made at the same time have no triangle in common, so that
their order does not matter.  The topology stays, and no vertex leaves its face.  Not guaranteed: that no slender
triangle is left, since the number of vertices stays.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pas.limits import checkpoint
from pas.mesh.edges import Edges
from pas.mesh.field import Floats, Integers
from pas.mesh.places import Asked, Stars, all_sines, at_vertices, better_places, sines
from pas.mesh.rows import all_of, any_of, dots, norms

BESIDE = 0.1
"""How much triangles with fixed corners count: they may be slender for ever, and their neighbours not."""

HELD = 0.5
"""Cosine between a triangle and the normals at its corners that is kept."""

LEFT, GAIN = 0.98, 1.02
"""Share of what is too slender that a move must leave at most, and of the worse sine of two triangles that a flip must
give at least."""

ENOUGH, FAIR = 0.002, 0.8
"""Share of the triangles that may be left, and of the sine that they should have that they must."""


CHOICES = 3
"""Passes in which moves are chosen that have no triangle in common with those chosen before (after Luby 1986)."""


class Ground(Protocol):
    """A surface on which vertices are moved; labels are those of its faces."""

    def placed(self, points: Floats, labels: Integers) -> tuple[Floats, Floats]:
        """Points (K, 3) near faces of labels (K,) moved onto them, and the unit normals (K, 3) there."""

    def farthest(self, corners: Floats, labels: Integers) -> Floats:
        """How far triangles (T, 3, 3) and their edges are, at most, from faces of labels (T,), as measured (T,)."""


@dataclass
class Mending:
    """A mesh that is changed in place: points (N, 3), triangles (T, 3), and their labels (T,).

    Vertices that are `free` (N,) may move, within the faces of their triangles; `normals` (N, 3) of the surface there
    have length 1, and 0 elsewhere.  Triangles of which all corners are free, with an angle whose sine is below `aim`,
    are mended; none that is new may be further from the ground than `most`.  As far as `worst` some are, or were.
    """

    points: Floats
    triangles: Integers
    labels: Integers
    normals: Floats
    free: NDArray[np.bool_]
    ground: Ground
    aim: float
    most: float

    def __post_init__(self) -> None:
        self.sines, self.worst = all_sines(self.points, self.triangles), 0.0
        self._tried = np.zeros(len(self.points), dtype=bool)

    @property
    def slender(self) -> Integers:
        """The rows of the triangles to be mended."""
        rows = np.flatnonzero(self.sines < self.aim)
        return rows[all_of(self.free[self.triangles[rows]])]

    def mend(self, rounds: int) -> bool:
        """Move and flip until little changes, in so many rounds at most; whether anything did."""
        changed = False
        for _ in range(rounds):
            rows = self.slender
            if len(rows) <= ENOUGH * len(self.triangles) and self.sines[rows].min(initial=1.0) >= FAIR * self.aim:
                break
            checkpoint(f"mending slender triangles ({len(rows)})")
            corners = self._marked(self.triangles[rows])
            near = at_vertices(self.triangles, corners)  # so that all triangles at these corners are among theirs
            flips = self._flip(corners, near)
            moves = self._move(corners, near)
            if not flips and not moves:
                break
            changed = True
        return changed

    def _marked(self, vertices: Integers) -> NDArray[np.bool_]:
        """Some vertices among all (N,)."""
        marks = np.zeros(len(self.points), dtype=bool)
        marks[vertices] = True
        return marks

    def _move(self, corners: NDArray[np.bool_], near: Integers) -> bool:
        """Move corners (N,) of slender triangles, all of whose triangles are in rows `near`; whether some did."""
        triangles = self.triangles[near]
        slender = triangles[(self.sines[near] < self.aim) & all_of(self.free[triangles])]
        stars = Stars.of(self.triangles, near, self._marked(slender) & corners & ~self._tried)
        if not len(stars.vertices):
            return False
        before, inside = self.sines[stars.rows], self.free[stars.first] & self.free[stars.second]
        worst, beside = (stars.least(np.where(one, before, 1.0)) for one in (inside, ~inside))
        floors = np.where(inside, worst[stars.owner], beside[stars.owner])
        asked = Asked(self.aim, np.where(inside, 1.0, BESIDE), floors)
        places, was, left = better_places(stars, self.points, self.normals, before, asked)
        gains = left < LEFT * was
        self._tried[stars.vertices[~gains]] = True
        mine = np.flatnonzero(_apart(stars, gains, worst, len(self.points)))
        vertices, labels = stars.vertices[mine], self.labels[stars.rows[stars.starts[mine]]]
        points, normals = self.ground.placed(places[mine], labels)
        good = self._settle(stars, mine, (points, normals), floors)
        moved = vertices[good]
        self.points[moved], self.normals[moved] = points[good], normals[good]
        self._tried[vertices[~good]] = True
        return len(moved) > 0

    def _settle(self, stars: Stars, mine: Integers, to: tuple[Floats, Floats], floors: Floats) -> NDArray[np.bool_]:
        """Which of the vertices `mine` (M,) of stars may go to points (M, 3) with normals (M, 3); see `Asked`."""
        (points, normals), owner = to, stars.owner
        place = np.full(len(stars.vertices), -1)
        place[mine] = np.arange(len(mine))
        at = np.flatnonzero(place[owner] >= 0)
        rows, mover, a, b = stars.rows[at], place[owner[at]], stars.first[at], stars.second[at]
        corners = np.stack([points[mover], self.points[a], self.points[b]], axis=1)
        after, across = sines(*corners.transpose(1, 0, 2))
        about = normals[mover] + self.normals[a] + self.normals[b]
        off = self.ground.farthest(corners, self.labels[rows])
        fine = _upright(across, about) & (after >= floors[at]) & (off <= self.most)
        good = np.ones(len(mine), dtype=bool)
        good[mover[~fine]] = False
        stays = good[mover]
        self._tried[np.concatenate([a[stays], b[stays]])] = False
        self.sines[rows[stays]] = after[stays]
        self.worst = max(self.worst, float(off[stays].max(initial=0.0)))
        return good

    def _flip(self, corners: NDArray[np.bool_], near: Integers) -> bool:
        """Flip edges of slender triangles where that makes the worse of two better; whether there were some."""
        edges = Edges(self.triangles[near], len(self.points))
        may = np.flatnonzero(any_of((self.sines[near] < self.aim)[edges.owners]))
        owners, (a, b), (c, d) = near[edges.owners[may]], edges.inner[may].T, edges.apexes[may].T
        before = self.sines[owners]
        same = self.labels[owners[:, 0]] == self.labels[owners[:, 1]]
        may = np.flatnonzero(same & (corners[c] | corners[d]))
        owners, before, (a, b, c, d) = owners[may], before[may], (v[may] for v in (a, b, c, d))
        new = np.stack([c, a, d, c, d, b], axis=1).reshape(-1, 2, 3)
        places = self.points[new]
        after, across = sines(*places.reshape(-1, 3, 3).transpose(1, 0, 2))
        about = self.normals[a] + self.normals[b] + self.normals[c] + self.normals[d]
        after, upright = after.reshape(-1, 2), _upright(across, np.repeat(about, 2, axis=0)).reshape(-1, 2)
        inside = (self._inside(self.triangles[owners], before), self._inside(new, after))
        better = (after.min(axis=1) > GAIN * before.min(axis=1)) & (inside[1] >= np.minimum(inside[0], self.aim))
        at = np.flatnonzero(better & all_of(upright))
        at = at[~self._joined(edges.every, c[at], d[at])]
        labels = np.repeat(self.labels[owners[at, 0]], 2)
        off = self.ground.farthest(places[at].reshape(-1, 3, 3), labels).reshape(-1, 2).max(axis=1)
        at, off = at[off <= self.most], off[off <= self.most]
        order = np.argsort(before[at].min(axis=1), kind="stable")
        order = order[_unshared(owners[at[order]], np.stack([c, d], axis=1)[at[order]])]
        at = at[order]
        self.triangles[owners[at]], self.sines[owners[at]] = new[at], after[at]
        self.worst = max(self.worst, float(off[order].max(initial=0.0)))
        self._tried[new[at]] = False
        return len(at) > 0

    def _joined(self, edges: Integers, a: Integers, b: Integers) -> NDArray[np.bool_]:
        """Which pairs of vertices (F,) are among edges (E, 2)."""
        edges, size = edges[all_of(self._marked(np.concatenate([a, b]))[edges])], len(self.points)
        pairs = np.stack([a, b], axis=1)
        return np.isin(*(t.min(axis=1) * size + t.max(axis=1) for t in (pairs, edges)))

    def _inside(self, triangles: Integers, values: Floats) -> Floats:
        """The least sine (E,) of pairs of triangles (E, 2, 3), without those at fixed vertices."""
        free = all_of(self.free[triangles].reshape(-1, 3)).reshape(-1, 2)
        return np.asarray(np.where(free, values, 1.0).min(axis=1))


def _upright(across: Floats, about: Floats) -> NDArray[np.bool_]:
    """Whether triangles with vectors (T, 3) across them are not turned away from others (T, 3)."""
    return np.asarray(dots(across, about) > HELD * norms(across) * norms(about))


def _apart(stars: Stars, wanted: NDArray[np.bool_], worst: Floats, size: int) -> NDArray[np.bool_]:
    """Some of the wanted moves (V,), no two of which have a triangle in common: those of the worst triangles first."""
    rank, every = np.empty(len(wanted)), np.full(size, np.inf)
    rank[np.argsort(np.where(wanted, worst, 2.0), kind="stable")] = np.arange(len(wanted))
    chosen, open_ = np.zeros(len(wanted), dtype=bool), wanted
    for _ in range(CHOICES):
        every[stars.vertices[open_]], every[stars.vertices[chosen]] = rank[open_], -1.0
        nearest = stars.least(np.minimum(every[stars.first], every[stars.second]))
        chosen |= open_ & (rank < nearest)
        open_ = open_ & ~chosen & (nearest >= 0)
        every[stars.vertices] = np.inf
    return chosen


def _unshared(owners: Integers, ends: Integers) -> Integers:
    """Rows, earlier ones preferred, of which no two have an owner (F, 2) in common or make the same edge (F, 2)."""
    taken: set[int] = set()
    edges: set[tuple[int, int]] = set()
    chosen = []
    for row, ((i, j), (c, d)) in enumerate(zip(owners.tolist(), np.sort(ends, axis=1).tolist(), strict=True)):
        if i not in taken and j not in taken and (c, d) not in edges:
            taken |= {i, j}
            edges.add((c, d))
            chosen.append(row)
    return np.array(chosen, dtype=np.intp)
