"""Values and gradients of many polynomials at many points, each point with a polynomial of its own."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.tables import PieceTables

Integers = NDArray[np.intp]


class Jets:
    """M polynomials with their gradients as doubles; those of one degree are evaluated together."""

    def __init__(self, polynomials: Sequence[Polynomial]) -> None:
        self._polynomials = polynomials
        self._degrees = np.array([max(p.degree, 0) for p in polynomials], dtype=np.intp)

    def __call__(self, points: Floats, numbers: Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3) of polynomials of given numbers (N,)."""
        degrees = self._degrees[numbers]
        found = np.flatnonzero(np.bincount(degrees))
        if len(found) == 1:
            return self._tables[int(found[0])](points, self._places[numbers]).T
        result = np.empty((4, len(points)))
        for degree in found.tolist():
            rows = np.flatnonzero(degrees == degree)
            result[:, rows] = self._tables[degree](points[rows], self._places[numbers[rows]])
        return result.T

    @cached_property
    def _places(self) -> Integers:
        """Where each stands among those of its degree (M,)."""
        result = np.zeros(len(self._degrees), dtype=np.intp)
        for degree in np.unique(self._degrees):
            own = self._degrees == degree
            result[own] = np.arange(own.sum())
        return result

    @cached_property
    def _tables(self) -> dict[int, PieceTables]:
        """Of each degree."""
        result = {}
        for degree in np.unique(self._degrees).tolist():
            own = [p for p, d in zip(self._polynomials, self._degrees, strict=True) if d == degree]
            table = np.array([[q.dense(degree) for q in (p, *map(p.diff, range(3)))] for p in own])
            result[degree] = PieceTables(table, (degree, *[max(degree - 1, 0)] * 3))
        return result
