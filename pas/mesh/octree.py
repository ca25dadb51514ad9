"""Cubes halved where a boundary needs it, cut into tetrahedra that fit together.

A cube is cut into six tetrahedra about its diagonal (Kuhn 1960); the middles of the cube, of its faces and of its
edges, in this order, halve them until each eighth of the cube has its own six (Maubach 1995).  Which middles are used
decides everything, and they fit where the middle of an edge comes with those of the faces beside it, that of a face
with those of both its cubes, and that of a cube with the cube's eight corners.
"""

from __future__ import annotations

from copy import copy
from itertools import product

import numpy as np

from pas.arrays import Bools, Floats, Integers
from pas.kernels.library import compiled
from pas.limits import blocks, checkpoint
from pas.mesh.field import FaceField, extent_of
from pas.mesh.topology import numbered

SHIFT = np.array([0.381966, 0.267949, 0.414214])
"""Where the cubes start, in small cubes before the box: irrational, so that the planes and axes that
designers like do not pass through corners."""

MOST_CUBES = 400_000
"""On one level; more take minutes."""

CLEAR, QUIET, OPEN = range(3)
"""The state of a cube: the boundary in it is one sheet; some points in it agree with that; or neither."""

SAMPLES, CHUNK = 5, 2000
"""Points on each line along which the boundary is looked for in cubes where it is not proved to be clear; and
how many cubes are looked at together."""

DEEPEST = 14
"""How often cubes are halved at most, so that `_SPAN` is not exceeded."""


HIDDEN = 1
"""Levels on which the boundary is looked for where it is not met."""

NOWHERE = np.empty((0, 3))

BASE, FLAT = 3, 0.2
"""How often cubes are halved wherever the boundary may pass, but for those in which faces turn less (radians)."""

_SPAN = 1 << 18
_WEIGHTS = np.array([_SPAN * _SPAN, _SPAN, 1])
"""Corners and middles are numbered by their coordinates; the number is linear in these."""

_SIGNS = np.array(list(product((-1, 1), repeat=3)))
_NEIGHBOURS = np.array(list(product((-1, 0, 1), repeat=3)))


def _lines() -> Integers:
    """The lines of samples from side to side of a cube, along axes and diagonals of squares and the cube (L, n)."""
    steps, last = np.arange(SAMPLES), SAMPLES - 1
    weights = SAMPLES ** np.arange(3)[::-1]
    found = []
    for direction in _NEIGHBOURS[len(_NEIGHBOURS) // 2 + 1 :]:
        start = [[0] if d > 0 else [last] if d < 0 else steps for d in direction]
        found += [(np.array(p) + steps[:, None] * direction) @ weights for p in product(*start)]
    return np.array(found)


_NONE = np.empty((0, 3), dtype=np.intp), np.empty(0, dtype=np.intp)
_SAMPLES = np.array(list(product(np.linspace(-1.0, 1.0, SAMPLES), repeat=3)))
_LINES = _lines()


class Octree:
    """Cubes about a boundary, halved at first where it bends and then where it is not clear.

    On level i cubes have the edge `size / 2**i`; their corners have even coordinates in halves of that
    edge, counted from `origin`, and their middles odd ones.  Where more than `MOST_CUBES` would be on one level it is
    `crowded`, without these.
    """

    def __init__(self, field: FaceField, spacing: float) -> None:
        self.field, self.size = field, spacing * 2**BASE
        self.origin = field.box[0] - (1 + SHIFT) * spacing
        self._counts = np.ceil((field.box[1] + 1.5 * spacing - self.origin) / self.size).astype(np.intp)
        self.crowded = False
        self._halved: list[Integers] = []
        self._missed: list[Integers] = []
        self._leaves: list[tuple[Integers, Integers]] = [_NONE] * (BASE + 1)
        axes = (2 * np.arange(n) + 1 for n in self._counts)
        cubes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        cubes = self._halve(0, self._crossed(0, cubes))
        for level in range(1, BASE):
            cubes = self._crossed(level, cubes)
            half = self.size / 2 ** (level + 1)
            flat = field.turning(self.origin + cubes * half, half) <= FLAT
            self._leaves[level] = cubes[flat], np.full(flat.sum(), CLEAR)
            cubes = self._halve(level, cubes[~flat])
        self._add(BASE, cubes)

    @property
    def levels(self) -> int:
        """How often the smallest cubes were halved."""
        return len(self._halved)

    @property
    def spacing(self) -> float:
        """The edge of the smallest cubes."""
        return float(self.size / 2**self.levels)

    @property
    def finest(self) -> str:
        """The edge of the smallest cubes over the longest side of the box, in words."""
        return f"1/{round(extent_of(self.field) / self.spacing)} of its bounding box"

    @property
    def count(self) -> int:
        """The number of cubes."""
        return sum(len(cubes) for cubes, _ in self._leaves)

    @property
    def open_places(self) -> Floats:
        """The middles (K, 3) of the cubes in which more than one sheet may be."""
        halves = self.size / 2 ** np.arange(1, len(self._leaves) + 1)
        return np.concatenate(
            [self.origin + half * c[s == OPEN] for half, (c, s) in zip(halves, self._leaves, strict=True)]
        )

    @property
    def open_share(self) -> float:
        """The share of the cubes in which more than one sheet may be."""
        return len(self.open_places) / max(self.count, 1)

    @property
    def is_seen(self) -> bool:
        """Whether some sample in the cubes is in the set."""
        for level, (cubes, _) in enumerate(self._leaves):
            half, start, number = self.size / 2 ** (level + 1), 0, 1
            while start < len(cubes):
                checkpoint()
                if self._samples(self.origin + cubes[start : start + number] * half, half).any():
                    return True
                start, number = start + number, min(8 * number, CHUNK)
        return False

    def refined(self, places: Floats = NOWHERE, least: int = OPEN) -> Octree:
        """With the cubes halved whose state is at least as given, and those about given points (K, 3)."""
        result = copy(self)
        result._halved, result._missed, result._leaves = [*self._halved], [*self._missed], [*self._leaves]
        for level, (cubes, state) in reversed([*enumerate(self._leaves)]):
            near = 2 * np.floor((places - self.origin) * 2**level / self.size).astype(np.intp) + 1
            around = (near[:, None] + 2 * _NEIGHBOURS) @ _WEIGHTS
            chosen = (state >= least) | np.isin(cubes @ _WEIGHTS, around)
            if chosen.any() and level < DEEPEST and not result.crowded:
                result._leaves[level] = cubes[~chosen], state[~chosen]
                result._add(level + 1, result._halve(level, cubes[chosen]))
        return result

    def tetrahedra(self) -> tuple[Floats, Integers]:
        """Nodes (N, 3), and tetrahedra (T, 4) that hold all of the boundary and fit together."""
        halved, missed = [cubes @ _WEIGHTS for cubes in self._halved], self._missed[: self.levels + 1]
        tables = [(np.concatenate(level), np.cumsum([0, *map(len, level)])) for level in (halved, missed)]
        found = np.empty(2, dtype=np.intp)  # how many, and where they are until they are taken
        compiled().call("pas_tetrahedra", len(halved), *tables[0], *tables[1], self._counts, found)
        corners = np.empty((found[0], 4), dtype=np.intp)
        compiled().call("pas_tetrahedra_taken", *found.tolist(), corners)
        checkpoint()
        numbers, inverse = numbered(corners.ravel())
        nodes = np.stack([numbers // (_SPAN * _SPAN), numbers // _SPAN % _SPAN, numbers % _SPAN], axis=1)
        return self.origin + nodes * (self.size / 2**self.levels), inverse.reshape(-1, 4)

    def _halve(self, level: int, cubes: Integers) -> Integers:
        if level == len(self._halved):
            self._halved.append(np.empty((0, 3), dtype=np.intp))
        self._halved[level] = np.concatenate([self._halved[level], cubes])
        return (2 * cubes[:, None] + _SIGNS).reshape(-1, 3)

    def _crossed(self, level: int, cubes: Integers) -> Integers:
        """The cubes that the boundary may pass; the others are remembered."""
        if level == len(self._missed):
            self._missed.append(np.empty(0, dtype=np.intp))
        half = self.size / 2 ** (level + 1)
        crossed = self.field.crossed(self.origin + cubes * half, half)
        self._missed[level] = np.sort(np.concatenate([self._missed[level], cubes[~crossed] @ _WEIGHTS]))
        return cubes[crossed]

    def _add(self, level: int, cubes: Integers) -> None:
        if len(cubes) > MOST_CUBES:
            self.crowded = True
            return
        checkpoint(f"refining a lattice ({len(cubes)} cubes)")
        cubes = self._crossed(level, cubes)
        half = self.size / 2 ** (level + 1)
        places = self.origin + cubes * half
        unknown = np.isinf(self.field.turning(places, half))
        state = np.where(unknown, OPEN, CLEAR)
        state[unknown] = np.where(self._is_quiet(level, places[unknown], half), QUIET, OPEN)
        while level >= len(self._leaves):
            self._leaves.append(_NONE)
        before, known = self._leaves[level]
        self._leaves[level] = np.concatenate([before, cubes]), np.concatenate([known, state])

    def _is_quiet(self, level: int, centers: Floats, half: float) -> Bools:
        """Whether each line of samples through a cube, straight or diagonal, crosses the boundary at most once (N,).

        On the first levels cubes that no line crosses are not quiet: there the boundary may hide.
        """
        result = np.empty(len(centers), dtype=bool)
        for part in blocks(len(centers), CHUNK):
            inside = self._samples(centers[part], half)
            along = inside[:, _LINES]
            times = (along[..., 1:] != along[..., :-1]).sum(axis=2).max(axis=1)
            result[part] = (times == 1) | ((times == 0) & (level >= BASE + HIDDEN))
        return result

    def _samples(self, centers: Floats, half: float) -> Bools:
        """Which samples in cubes are in the set (N, SAMPLES^3)."""
        points = (centers[:, None] + half * _SAMPLES).reshape(-1, 3)
        return self.field.inside(self.field.signs(points)).reshape(-1, len(_SAMPLES))
