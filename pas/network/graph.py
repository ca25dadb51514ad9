"""Graphs of points and struts with radii, on an exact grid, and what is wrong with them.

Points are whole multiples of the grid, so that directions of struts are exact vectors: nodes are the same, up to a
rotation or reflection, where these are, which is decided exactly (`pas.network.classes`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from pas.algebra.inputs import shown
from pas.algebra.rational import Exact, positive, to_fraction
from pas.arrays import Floats, Integers, Numbers
from pas.errors import GeometryError
from pas.mesh.topology import connected
from pas.network.near import Capsules, near

LARGEST = 2**20
"""Components of a strut in the grid: their products in three factors fit into 64 bits with their sums."""


ROUNDING = 1e-9
"""Of the longest strut and the largest coordinate: by so much more than it comes out things are to be apart."""


@dataclass(frozen=True)
class NetworkProblem:
    """What is wrong with a network: the kind in a word or two, the numbers of its points or struts, and a sentence.

    `struts` are the numbers of those that may become points, which mends it (see `Network.repair`).
    """

    kind: str
    ids: tuple[int, ...]
    sentence: str
    struts: tuple[int, ...] = ()

    def __str__(self) -> str:
        return self.sentence


class NetworkError(GeometryError):
    """A network that cannot be made; `problems` has all that was found, with the numbers of points and struts.

    The first of each kind is told, and how many others of the kind there are.
    """

    def __init__(self, problems: Sequence[NetworkProblem]) -> None:
        super().__init__(problems_text(problems))
        self.problems = tuple(problems)

    @property
    def struts(self) -> tuple[int, ...]:
        """The numbers of all struts that may become points, by `repair(collapse=error.struts)`."""
        return tuple(sorted({strut for problem in self.problems for strut in problem.struts}))


def problems_text(problems: Sequence[NetworkProblem]) -> str:
    """The first problem of each kind, and how many others of the kind there are."""
    kinds = Counter(problem.kind for problem in problems)
    found = []
    for kind, count in kinds.items():
        more = f" (and {count - 1} more like this)" if count > 1 else ""
        found.append(f"{next(problem for problem in problems if problem.kind == kind)}{more}")
    return "; ".join(found)


class StrutGraph:
    """Points, struts between them, and the radii of these.

    `points` (N, 3) are rounded to multiples of the `grid` (the model's units), `edges` (E, 2) are numbers of points,
    `radii` one exact number, or for each strut one, or a pair for its two ends, between which it is a cone.  `places`
    (N, 3) are the points as whole numbers of the grid; `sizes` (E, 2) says which of the different radii `radii` each
    strut has at its ends.

    Raises `ValueError` for arrays of other shapes, numbers of points that do not exist, radii that are not positive,
    a grid that is not positive or so fine that a strut is longer than 2^20 of its steps; `TypeError` for what are no
    numbers.
    """

    def __init__(self, points: Any, edges: Any, radii: Any, grid: Exact = "1/1024") -> None:
        self.grid: Fraction = to_fraction(positive(grid, "grid"))
        self.places: Integers = _places(points, self.grid)
        self.edges: Numbers = _edges(edges, len(self.places))
        self.radii, self.sizes = _radii(radii, len(self.edges))
        self.points: Floats = np.asarray(self.places * float(self.grid), dtype=np.float64)
        vectors = self.places[self.edges[:, 1]] - self.places[self.edges[:, 0]]
        self.vectors: Numbers = vectors.astype(np.int32)  # of each strut from its first point on (E, 3), in steps
        longest = max(int(vectors.max(initial=0)), -int(vectors.min(initial=0)))
        if longest >= LARGEST:
            raise ValueError(
                f"the grid {self.grid} is too fine: a strut is {longest} steps long, and {LARGEST} is the most"
            )
        for array in (self.places, self.edges, self.sizes, self.points, self.vectors):
            array.setflags(write=False)

    @cached_property
    def lengths(self) -> Floats:
        """The lengths of the struts (E,), in the model's units."""
        return np.asarray(np.linalg.norm(self.vectors, axis=1) * float(self.grid))

    @cached_property
    def slack(self) -> float:
        """A bound, with much to spare, of the rounding of distances in doubles, in the model's units."""
        return ROUNDING * float(self.lengths.max(initial=0) + np.abs(self.points).max(initial=0))

    @property
    def widths(self) -> Floats:
        """The radii of each strut at its ends (E, 2), in the model's units."""
        return np.array([float(r) for r in self.radii])[self.sizes] if len(self.edges) else np.zeros((0, 2))

    @cached_property
    def thickness(self) -> Floats:
        """The radius of each strut (E,) where it is widest, in the model's units."""
        known = np.array([float(r) for r in self.radii])
        return known[self.sizes.max(axis=1)] if len(known) > 1 else np.broadcast_to(known, len(self.edges))

    def capsules(self, ends: Floats | None = None) -> Capsules:
        """The struts, or where they are straight, which is between `ends` (E, 2) in parts of their lengths."""
        here, there = np.zeros((2, 1)) if ends is None else ends.T
        middles, step = np.empty((len(self.edges), 3)), float(self.grid)
        for axis in range(3):  # as all three together take twice as much memory
            middles[:, axis] = self.vectors[:, axis] * (step * (1 + here - there) / 2)
            middles[:, axis] += self.points[self.edges[:, 0], axis]
        share = np.broadcast_to(step * (1 - here - there) / 2, len(self.edges))
        far = float(self.lengths.max(initial=0) / 2 + self.thickness.max(initial=0))
        return Capsules(middles, self.vectors, share, self.thickness, far, self.edges)

    @cached_property
    def crossings(self) -> list[tuple[int, int, float]]:
        """Struts without a common point that come nearer than their radii: two numbers and the distance of their
        axes."""
        struts = self.capsules()
        found = (zip(*(column.tolist() for column in rows), strict=True) for rows in near(struts, struts, self.slack))
        return [pair for pairs in found for pair in pairs]

    @property
    def even(self) -> bool:
        """Whether all struts have one radius, so that they are cylinders."""
        return bool((self.sizes[:, 0] == self.sizes[:, 1]).all())

    def wall_of(self, wall: Exact) -> Fraction:
        """The thickness of a wall of all struts; raises `ValueError` where it is not positive, or fills a strut."""
        found = to_fraction(positive(wall, "wall"))
        if self.radii and found >= self.radii[0]:
            raise ValueError(
                f"a wall of {found} leaves no cavity in struts of the radius {self.radii[0]}; give a thinner one"
            )
        return found

    @cached_property
    def valence(self) -> Numbers:
        """The number of struts at each point (N,)."""
        return np.bincount(self.edges.ravel(), minlength=len(self.places)).astype(np.int32)

    @cached_property
    def shortest(self) -> Integers:
        """The number of the shortest strut at each point (N,), -1 where there is none."""
        found = np.full(len(self.places), -1)
        order = np.argsort(-self.lengths, kind="stable")
        found[self.edges[order].ravel()] = order.repeat(2)  # of several at one point the last one stays
        return found

    @property
    def pieces(self) -> int:
        """The number of connected pieces of the graph, points without struts left out."""
        return len(np.unique(self.components[self.edges[:, 0]]))

    @cached_property
    def components(self) -> Integers:
        """The number of the connected piece of each point (N,)."""
        return connected(self.edges, len(self.places))

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self.places)} points, {len(self.edges)} struts>"


def _places(points: Any, grid: Fraction) -> Integers:
    try:
        given = np.asarray(points, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"points must be numbers (N, 3), not {shown(points)}") from None
    if given.ndim != 2 or given.shape[1] != 3:
        raise ValueError(f"points must have the shape (N, 3), not {given.shape}")
    if not np.isfinite(given).all():
        number = int((~np.isfinite(given)).any(axis=1).argmax())
        raise ValueError(f"point {number} is not finite: {given[number].tolist()}")
    steps = given * grid.denominator / grid.numerator
    if np.abs(steps).max(initial=0) >= 2.0**52:
        raise ValueError(f"the grid {grid} is too fine for points as far out as {np.abs(given).max():.4g}")
    return np.rint(steps).astype(np.int64)


def _edges(edges: Any, count: int) -> Numbers:
    given = np.asarray(edges)
    if given.size == 0:
        return np.zeros((0, 2), dtype=np.int32)
    if given.ndim != 2 or given.shape[1] != 2 or not np.issubdtype(given.dtype, np.integer):
        raise ValueError(f"edges must be whole numbers of points (E, 2), not {given.dtype} {given.shape}")
    least, most = int(given.min()), int(given.max())
    if not 0 <= least <= most < count:
        wrong = least if least < 0 else most
        raise ValueError(f"edges must be numbers of the {count} points, from 0 on; {wrong} is none")
    return given.astype(np.int32)


def _radii(radii: Any, count: int) -> tuple[tuple[Fraction, ...], Numbers]:
    """The different radii, the least first, and which of them each strut has at its ends (E, 2)."""
    if isinstance(radii, str) or not hasattr(radii, "__len__"):
        return (to_fraction(positive(radii, "radius")),), np.broadcast_to(np.int32(0), (count, 2))
    if len(radii) != count:
        raise ValueError(f"radii must be one number, or one for each of the {count} struts, not {len(radii)}")
    pairs = [(r, r) if isinstance(r, str) or not hasattr(r, "__len__") else tuple(r) for r in radii]
    known: dict[Any, Fraction] = {}
    for number, pair in enumerate(pairs):
        if len(pair) != 2:
            raise ValueError(f"radii[{number}] must be one number, or one for each end, not {shown(radii[number])}")
        for value in pair:
            if value not in known:
                known[value] = to_fraction(positive(value, f"radii[{number}]"))
    values = tuple(sorted(set(known.values())))
    ranks = {value: number for number, value in enumerate(values)}
    return values, np.array([[ranks[known[r]] for r in pair] for pair in pairs], dtype=np.int32).reshape(-1, 2)
