"""The one door from exact solution spaces to floating point: a well-conditioned working basis.

The reduced basis of a solution space can be nearly dependent in floating point (condition
numbers of 10^10 to 10^17 were measured on corners).  So the basis is first changed, exactly and by
a rational matrix, to one that is orthonormal over the region up to rounding; that one is
rounded to doubles.  Coefficients found for it go back exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import fmpq, fmpq_mat, fmpz, fmpz_mat
from numpy.typing import NDArray
from scipy.linalg import qr

from pas.algebra.monomials import Floats, exponents, monomial_values, positions
from pas.fairing.energy import SECOND_DERIVATIVES, Box, box_rule, tetrahedra_rule
from pas.partition.cells import Partition

CONDITION = 1e4
"""A basis this well conditioned is used as it is: it costs 4 of 16 digits."""

ATTEMPTS = 6
"""Changes of basis before giving up; each gains about ten digits."""


@dataclass(frozen=True)
class WorkingBasis:
    """A basis of a space of piecewise polynomials, exact and rounded, in local coordinates.

    `patches[p]` (m, C(n+3, 3)) is exact; `coefficients` (pieces, m, C(n+3, 3)) are its doubles;
    `transform` (m, m) gives the working basis in terms of the one it was made from.
    """

    partition: Partition
    degree: int
    transform: fmpq_mat
    patches: tuple[fmpq_mat, ...]
    coefficients: Floats

    @classmethod
    def of(cls, partition: Partition, patches: Sequence[fmpq_mat], degree: int) -> WorkingBasis:
        """A well-conditioned basis of the span of `patches`."""
        rules = tetrahedra_rule(partition, 2 * degree)
        values = [monomial_values(p, degree) * np.sqrt(w) for p, w in rules]

        def samples(tables: list[Floats]) -> Floats:
            on_cells = zip((tables[piece] for piece in partition.piece_of), values, strict=True)
            return np.concatenate([c @ v for c, v in on_cells], axis=1).T

        transform, exact = orthonormal(patches, samples)
        return cls(partition, degree, transform, exact, np.array([to_doubles(patch) for patch in exact]))

    @property
    def size(self) -> int:
        """The dimension m."""
        return int(self.coefficients.shape[1])

    def values(self, piece: int, points: Floats) -> Floats:
        """Values of the members on a piece at local points (N, 3): (N, m)."""
        return monomial_values(points, self.degree).T @ self.coefficients[piece].T

    def radial(self, piece: int, points: Floats) -> Floats:
        """`grad g . x` of the members at local points (N, 3): (N, m)."""
        degrees = np.array([sum(e) for e in exponents(self.degree)])
        return monomial_values(points, self.degree).T @ (self.coefficients[piece] * degrees).T

    def combine(self, working: fmpq_mat) -> list[list[fmpq]]:
        """The exact coefficients, piece by piece, of the member with working coefficients (1, m).

        In integers over one denominator, several times faster than rationals.
        """
        numerators, denominator = working.numer_denom()
        result = []
        for matrix, scale in self._integers:
            divisor = scale * denominator
            result.append([fmpq(v, divisor) for v in (numerators * matrix).entries()])
        return result

    @cached_property
    def _integers(self) -> list[tuple[fmpz_mat, fmpz]]:
        return [patch.numer_denom() for patch in self.patches]

    @cached_property
    def cell_energy(self) -> Floats:
        """A factor J (rows, m) of the energy over the cells: `q^T J^T J q` for coefficients q."""
        rules = tetrahedra_rule(self.partition, 2 * max(self.degree - 2, 0))
        pieces = self.partition.piece_of
        return np.concatenate([self._energy_factor(pieces[cell], p, w) for cell, (p, w) in enumerate(rules)])

    def box_energy(self, piece: int, box: Box) -> Floats:
        """The same for one patch over a box in local coordinates."""
        lower, upper = (np.array([int(c.p) / int(c.q) for c in corner]) for corner in (box.lower, box.upper))
        points, weights = box_rule(lower, upper, 2 * max(self.degree - 2, 0))
        return self._energy_factor(piece, points, weights)

    def _energy_factor(self, piece: int, points: Floats, weights: Floats) -> Floats:
        values = monomial_values(points, self.degree).T * np.sqrt(weights)[:, None]
        blocks = []
        for i, j, times in SECOND_DERIVATIVES:
            derivative = derivative_matrix(self.degree, i) @ derivative_matrix(self.degree, j)
            blocks.append(values @ (derivative @ self.coefficients[piece].T) * np.sqrt(times))
        return np.concatenate(blocks)


def orthonormal(
    matrices: Sequence[fmpq_mat], samples: Callable[[list[Floats]], Floats]
) -> tuple[fmpq_mat, tuple[fmpq_mat, ...]]:
    """Change a basis exactly to one whose samples are orthonormal columns up to `CONDITION`.

    `matrices` hold the members as rows; `samples` maps their doubles to columns (N, m).  Returns
    the change (m, m) and the changed matrices.
    """
    change = _unit_scale(matrices)  # exact, since some spaces have members with coefficients beyond any double
    exact = tuple(change * matrix for matrix in matrices)
    for _ in range(ATTEMPTS):
        columns = samples([to_doubles(matrix) for matrix in exact])
        norms = np.linalg.norm(columns, axis=0)
        triangular, order = qr(columns / norms, mode="r", pivoting=True)  # dependent members come last
        triangular = triangular[: len(order)]
        if np.linalg.cond(triangular) < CONDITION and norms.max() < CONDITION * norms.min():
            break
        step = _rational_matrix(_inverse(triangular).T / norms[order], order)
        exact = tuple(step * matrix for matrix in exact)
        change = step * change
    return change, exact


def derivative_matrix(degree: int, variable: int) -> Floats:
    """The map from coefficients of a polynomial to those of its derivative."""
    where = positions(degree)
    matrix = np.zeros((len(where), len(where)))
    for e, column in where.items():
        if e[variable]:
            lower = list(e)
            lower[variable] -= 1
            matrix[where[tuple(lower)], column] = e[variable]
    return matrix


def to_doubles(matrix: fmpq_mat) -> Floats:
    """The nearest doubles of an exact matrix."""
    entries = [int(v.p) / int(v.q) if v else 0.0 for v in matrix.entries()]
    return np.array(entries).reshape(matrix.nrows(), matrix.ncols())


def _unit_scale(matrices: Sequence[fmpq_mat]) -> fmpq_mat:
    """The powers of two, as a diagonal matrix, that bring the largest coefficient of each member near 1."""
    size = matrices[0].nrows()
    scale = fmpq_mat(size, size)
    for row, tables in enumerate(zip(*(matrix.tolist() for matrix in matrices), strict=True)):
        bits = max((v.p.bit_length() - v.q.bit_length() for table in tables for v in table if v != 0), default=0)
        scale[row, row] = fmpq(1, 2**bits) if bits >= 0 else fmpq(2**-bits)
    return scale


def _inverse(triangular: Floats) -> Floats:
    """The inverse, with pivots that vanished by rounding replaced by the rounding level."""
    diagonal = np.abs(np.diag(triangular))
    floor = 1e-15 * diagonal.max()
    safe = triangular + np.diag(np.where(diagonal < floor, floor, 0.0))
    return np.linalg.inv(safe)


def _rational_matrix(matrix: Floats, order: NDArray[np.intp]) -> fmpq_mat:
    """A matrix, exact, with its columns put at the places that `order` says."""
    placed = np.empty_like(matrix)
    placed[:, order] = matrix
    rows, columns = placed.shape
    return fmpq_mat(rows, columns, [fmpq(*float(x).as_integer_ratio()) for x in placed.ravel()])
