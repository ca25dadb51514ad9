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
from pas.algebra.rational import to_float
from pas.fairing.quadrature import tetrahedra_rule
from pas.partition.cells import Partition
from pas.partition.frame import Frame

CONDITION = 1e4
"""A basis this well conditioned is used as it is: it costs 4 of 16 digits."""

Derivative = tuple[int, ...]
"""A partial derivative by the numbers of its variables: (0, 2) is d^2/dx dz, () the value itself."""

ATTEMPTS = 6
"""Changes of basis before giving up; each gains about ten digits."""


@dataclass(frozen=True)
class WorkingBasis:
    """A basis of a space of piecewise polynomials, exact and rounded, in local coordinates.

    `patches[p]` (m, C(n+3, 3)) is exact; `coefficients` (pieces, m, C(n+3, 3)) are its doubles;
    `transform` (m, m) gives the working basis in terms of the one it was made from.  `partition` is
    that of the local coordinates, `frame` says where these are: `x = origin + scale * u`.
    """

    partition: Partition
    frame: Frame
    degree: int
    transform: fmpq_mat
    patches: tuple[fmpq_mat, ...]
    coefficients: Floats

    @classmethod
    def of(cls, partition: Partition, patches: Sequence[fmpq_mat], degree: int) -> WorkingBasis:
        """A well-conditioned basis of the span of `patches`, which are in the partition's local coordinates."""
        rules = tetrahedra_rule(partition.local, 2 * degree)
        values = [monomial_values(p, degree) * np.sqrt(w) for p, w in rules]

        def samples(tables: list[Floats]) -> Floats:
            on_cells = zip((tables[piece] for piece in partition.piece_of), values, strict=True)
            return np.concatenate([c @ v for c, v in on_cells], axis=1).T

        transform, exact = orthonormal(patches, samples)
        return cls(
            partition.local, partition.frame, degree, transform, exact, np.array([to_doubles(patch) for patch in exact])
        )

    @property
    def size(self) -> int:
        """The dimension m."""
        return int(self.coefficients.shape[1])

    @property
    def scale(self) -> float:
        """The user's units in a local one."""
        return to_float(self.frame.scale)

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

    def derivative(self, piece: int, points: Floats, variables: Derivative) -> Floats:
        """A partial derivative of the members on a piece at local points (N, 3), in local units: (N, m)."""
        return monomial_values(points, self.degree).T @ self._derived(piece, variables)

    def quadrature(self, degree: int) -> list[tuple[int, Floats, Floats]]:
        """For each cell its piece, local points (N, 3) and weights (N,), exact for polynomials of that degree.

        Weights are local volumes: times `scale^3` they are the user's.
        """
        rules = tetrahedra_rule(self.partition, degree)
        return [(int(piece), *rule) for piece, rule in zip(self.partition.piece_of, rules, strict=True)]

    def squares(
        self, piece: int, points: Floats, weights: Floats, derivatives: Sequence[tuple[Derivative, int]]
    ) -> Floats:
        """A factor J (rows, m) of a weighted sum of squares of derivatives at points: it is `q^T J^T J q`.

        Each derivative comes with the number of times that it counts.
        """
        values = monomial_values(points, self.degree).T * np.sqrt(weights)[:, None]
        blocks = [values @ self._derived(piece, variables) * np.sqrt(times) for variables, times in derivatives]
        return np.concatenate(blocks)

    def _derived(self, piece: int, variables: Derivative) -> Floats:
        """The coefficients of a derivative of the members: (C(n+3, 3), m)."""
        change = np.eye(self.coefficients.shape[2])
        for variable in variables:
            change = change @ derivative_matrix(self.degree, variable)
        return np.asarray(change @ self.coefficients[piece].T)


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
