"""Exact linear functionals on piecewise polynomials: values at points, and B-coefficients."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_mat

from pas.algebra.monomials import count, exponents
from pas.algebra.rational import Vector, vector
from pas.bernstein.forms import polar_row
from pas.fairing.wishes import Handle
from pas.partition.cells import Partition

REFERENCE = tuple(vector(corner) for corner in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
"""The tetrahedron of the B-form where the partition is all of space."""


@dataclass(frozen=True)
class Functional:
    """What a polynomial on one piece is multiplied with: a column (C(n+3, 3), 1) on its coefficients
    in local coordinates."""

    piece: int
    column: fmpq_mat

    def on(self, patches: Sequence[fmpq_mat]) -> list[fmpq]:
        """Its value on each member of a basis given by `patches[p]` (m, C(n+3, 3))."""
        values: list[fmpq] = (patches[self.piece] * self.column).entries()
        return values


def value_at(partition: Partition, point: Vector, degree: int, name: str = "the point") -> Functional:
    """The value at a point (user's coordinates).  Raises `ValueError` outside the region."""
    piece, local = partition.place(point, name)
    x, y, z = ([c**i for i in range(degree + 1)] for c in local)
    return Functional(piece, fmpq_mat(count(degree), 1, [x[a] * y[b] * z[c] for a, b, c in exponents(degree)]))


def b_coefficient(partition: Partition, handle: Handle, degree: int) -> Functional:
    """The B-coefficient of a cell at a multi-index, as of degree `degree`.

    Raises `ValueError` for a cell or an index that does not exist.
    """
    cell, index = handle
    cells = max(len(partition.cells), 1)
    if not 0 <= cell < cells:
        raise ValueError(f"the handle {handle} is in no cell: cells are numbered from 0 to {cells - 1}")
    if min(index) < 0 or sum(index) != degree:
        raise ValueError(f"the multi-index of handle {handle} must be four numbers >= 0 with the sum {degree}")
    corners = partition.local.corners(partition.cells[cell]) if partition.cells else REFERENCE
    arguments = [corner for corner, times in zip(corners, index, strict=True) for _ in range(times)]
    piece = int(partition.piece_of[cell]) if partition.cells else 0
    return Functional(piece, fmpq_mat(count(degree), 1, polar_row(arguments)))
