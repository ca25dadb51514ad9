"""Exact nullspaces of sparse rational systems.

Rows are sparse; the elimination is flint's fraction-free one on the dense integer matrix of the
rows with their denominators cleared, which at the sizes of blends (a few hundred unknowns) is
faster than sparse elimination.  The basis is the reduced one: each member is 1 in its own free
unknown and 0 in the other free unknowns, so it depends on the space and the order of the
unknowns alone.  Elimination starts at the last unknown, so the free ones are the first
possible: with coefficients listed by degree, these are low ones, which keeps the numbers short
and the basis well conditioned (a factor of 10^7 on the corner with k = 2, n = 6).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import lcm

from flint import fmpq, fmpq_mat, fmpz_mat


def nullspace(rows: Iterable[Mapping[int, fmpq]], unknowns: int) -> fmpq_mat:
    """A basis of all v with `row . v = 0` for every row: a matrix (dimension, unknowns)."""
    integral = list({tuple(sorted(_integral(row).items())) for row in rows if row})
    if not integral:
        return fmpq_mat(unknowns, unknowns, [int(i == j) for i in range(unknowns) for j in range(unknowns)])
    matrix = fmpz_mat(len(integral), unknowns)
    for i, row in enumerate(sorted(integral, key=len)):
        for j, value in row:
            matrix[i, unknowns - 1 - j] = value
    reduced, denominator, rank = matrix.rref()
    return _from_reduced(reduced, int(denominator), rank, unknowns)


def _integral(row: Mapping[int, fmpq]) -> dict[int, int]:
    denominator = lcm(*(int(value.q) for value in row.values()))
    return {j: int(value.p) * (denominator // int(value.q)) for j, value in row.items()}


def _from_reduced(reduced: fmpz_mat, denominator: int, rank: int, unknowns: int) -> fmpq_mat:
    table = reduced.tolist()[:rank]
    pivots: list[int] = []
    for row in table:
        start = pivots[-1] + 1 if pivots else 0
        pivots.append(next(j for j in range(start, unknowns) if row[j] != 0))
    bound = set(pivots)
    free = [j for j in reversed(range(unknowns)) if j not in bound]
    basis = fmpq_mat(len(free), unknowns)
    for i, j in enumerate(free):
        basis[i, unknowns - 1 - j] = 1
        for row, pivot in zip(table, pivots, strict=True):
            if row[j] != 0:
                basis[i, unknowns - 1 - pivot] = fmpq(-row[j], denominator)
    return basis
