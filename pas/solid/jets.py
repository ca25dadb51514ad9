"""Values and gradients of many polynomials at many points, each point with a polynomial of its own."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.tables import PieceTables, Rows

Integers = NDArray[np.intp]


class Jets:
    """M polynomials with their gradients as doubles; those of one degree are evaluated together."""

    def __init__(self, polynomials: Sequence[Polynomial]) -> None:
        self._polynomials = polynomials
        self._degrees = np.array([max(p.degree, 0) for p in polynomials], dtype=np.intp)

    def __call__(self, points: Floats, numbers: Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3) of polynomials of given numbers (N,)."""
        return self._tables(points, numbers).T if len(points) else np.empty((0, 4))

    @cached_property
    def _tables(self) -> Rows:
        degrees, kinds = np.unique(self._degrees, return_inverse=True)
        places, tables = np.zeros(len(kinds), dtype=np.intp), []
        for kind, degree in enumerate(degrees.tolist()):
            own = np.flatnonzero(kinds == kind)
            places[own] = np.arange(len(own))
            jets = [(p, *map(p.diff, range(3))) for p in (self._polynomials[k] for k in own.tolist())]
            table = np.array([[q.dense(degree) for q in jet] for jet in jets])
            tables.append(PieceTables(table, (degree, *[max(degree - 1, 0)] * 3)))
        return Rows.of_kinds(tables, kinds, places)
