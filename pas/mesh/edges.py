"""The edge table of triangles: the half edge that leads back along each, and what is known by that."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from pas.mesh.rows import Integers
from pas.mesh.topology import twins_of


class Edges:
    """The edges of an oriented mesh of T triangles on `size` vertices: `every` (E, 2), those of the boundary last."""

    def __init__(self, triangles: Integers, size: int) -> None:
        self.triangles = triangles
        self.twins = twins_of(triangles, size)
        halves = np.arange(len(self.twins))
        self._inner, self._rim = np.flatnonzero(self.twins > halves), np.flatnonzero(self.twins < 0)
        rows = np.concatenate([self._inner, self._rim])
        corners, column = triangles.ravel(), rows % 3
        self.every = np.stack([corners[rows], corners[rows - column + (column + 1) % 3]], axis=1)

    @property
    def manifold(self) -> bool:
        """Whether each edge has one or two triangles, turned alike."""
        return bool(self.twins.min(initial=-1) >= -1)

    @cached_property
    def owners(self) -> Integers:
        """The two triangles (I, 2) of each inner edge; the edge is directed as in the first."""
        return np.stack([self._inner, self.twins[self._inner]], axis=1) // 3

    @property
    def inner(self) -> Integers:
        """The edges (I, 2) between two triangles."""
        return self.every[: len(self._inner)]

    @property
    def rim(self) -> Integers:
        """Those (R, 2) of one triangle, directed as in it."""
        return self.every[len(self._inner) :]

    @property
    def apexes(self) -> Integers:
        """The vertices (I, 2) opposite to the inner edges in their owners."""
        ends = self.inner.sum(axis=1)[:, None]
        return np.asarray(self.triangles[self.owners].sum(axis=2) - ends)
