"""The pairs of nodes and struts of a network that are near: balls, and cylinders with round ends around axes.

Distances are compared with room for rounding.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from pas.arrays import Floats, Integers
from pas.limits import checkpoint
from pas.mesh.rows import dots

AT_ONCE = 1024
"""Things whose neighbours are looked at together, so that memory is bounded."""


@dataclass(frozen=True, eq=False)
class Capsules:
    """What is within `radii` (M,) of segments with these `middles` (M, 3), from which a `share` (M,) of their `vectors`
    (M, 3) leads to their ends, and no farther than `far` from any middle.

    `of` (M, 2) are numbers of points: of two things that have one in common nothing is asked.
    """

    middles: Floats
    vectors: Any
    share: Floats
    radii: Floats
    far: float
    of: Any

    def halves(self, rows: Any) -> Floats:
        """The vectors from the middles of some to their ends."""
        return np.asarray(self.vectors[rows] * self.share[rows, None])

    def segments(self, rows: Any) -> Floats:
        """The axes (m, 2, 3) of some."""
        middles, halves = self.middles[rows], self.halves(rows)
        return np.stack([middles - halves, middles + halves], axis=1)


def near(first: Capsules, second: Capsules, slack: float) -> Iterator[tuple[Integers, Integers, Floats]]:
    """The pairs of two sets of capsules whose axes are nearer than both radii together and a slack: two numbers, and
    the distance; each pair once where both are the same."""
    from scipy.spatial import cKDTree

    if not len(first.middles) or not len(second.middles):
        return
    tree, order = cKDTree(second.middles), np.lexsort(first.middles.T)
    for start in range(0, len(order), AT_ONCE):
        checkpoint("looking for what meets", start / len(order))
        own, far = order[start : start + AT_ONCE], first.far + second.far + slack
        pairs = cKDTree(first.middles[own]).sparse_distance_matrix(tree, far, output_type="ndarray")
        i, j = own[pairs["i"]], pairs["j"]
        if first is second:
            i, j = i[i < j], j[i < j]
        way = second.middles[j] - first.middles[i]  # along which those that come near overlap: seen before the distance
        square, need = dots(way, way), first.radii[i] + second.radii[j] + slack
        along = np.abs(dots(way, first.halves(i))) + np.abs(dots(way, second.halves(j)))
        close = square - along <= need * np.sqrt(square)
        for a, b in product(first.of.T, second.of.T):
            close &= a[i] != b[j]
        i, j = i[close], j[close]
        one, other = nearest_points(first.segments(i), second.segments(j))
        distance = np.linalg.norm(one - other, axis=1)
        near_ = distance < need[close]
        yield i[near_], j[near_], distance[near_]


def nearest_points(first: Floats, second: Floats) -> tuple[Floats, Floats]:
    """The nearest points (M, 3) of segments (M, 2, 3) and of others, which may be points (Ericson 2005, 5.1.9)."""
    u, v, w = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0], first[:, 0] - second[:, 0]
    a, b, c, d, e = (np.einsum("ni,ni->n", *pair) for pair in ((u, u), (u, v), (v, v), (u, w), (v, w)))
    det = a * c - b * b
    parallel = det <= 1e-12 * a * c
    s = np.clip(np.where(parallel, 0.0, b * e - c * d) / np.where(parallel, 1.0, det), 0.0, 1.0)
    t = np.clip((b * s + e) / np.where(c > 0, c, 1.0), 0.0, 1.0)
    s = np.where(a > 0, np.clip((b * t - d) / np.where(a > 0, a, 1.0), 0.0, 1.0), 0.0)
    return first[:, 0] + s[:, None] * u, second[:, 0] + t[:, None] * v
