"""The one conversion of exact solution spaces to floating point: a well-conditioned working basis.

The reduced basis of a solution space can be nearly dependent in floating point (condition
numbers of 10^10 to 10^17 were measured on corners).  So the basis is first changed by a matrix of
binary fractions to one that is orthonormal over the region up to `CONDITION`; that one is rounded to
doubles.  The change is exact, and coefficients found go back exactly; the changed basis itself
has numbers of hundreds of digits, is worked out to as many as its doubles need, and exactly on demand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, chain

import numpy as np
from flint import fmpq, fmpq_mat, fmpz, fmpz_mat
from scipy.linalg import qr

from pas.algebra.affine import Frame
from pas.algebra.matrices import Products
from pas.algebra.monomials import derivative_matrix, exponents, monomial_values
from pas.algebra.polynomial import RING, Polynomial
from pas.algebra.rational import to_float
from pas.arrays import Floats, Integers
from pas.fairing.functionals import tetrahedra_rule
from pas.partition.cells import Partition

CONDITION = 1e4
"""A basis this well conditioned is used as it is: it costs 4 of 16 digits."""

Derivative = tuple[int, ...]
"""A partial derivative by the numbers of its variables: (0, 2) is d^2/dx dz, () the value itself."""

STEP_BITS, BITS, GUARD_BITS = 60, 128, 64
"""Binary digits of a change of basis, below the largest number of each row; those that the members have to begin with,
below 1; and those which they keep at least when a change makes sums of them that cancel."""


@dataclass(frozen=True)
class BasisChange:
    """A change of basis, exact: the matrix `numerators * 2^-shift`, a new member a row."""

    numerators: fmpz_mat
    shift: int

    @cached_property
    def matrix(self) -> fmpq_mat:
        """The change of basis as a matrix of rationals."""
        return fmpq_mat(self.numerators) * fmpq(2) ** -self.shift


@dataclass(frozen=True)
class WorkingBasis:
    """A basis of a space of piecewise polynomials, exact and rounded, in local coordinates.

    `source` holds those that it was made from, (m, C(n+3, 3)) on each piece, and `change` gives it in terms of them;
    `coefficients` (pieces, m, C(n+3, 3)) are its doubles.  `partition` is that of the local coordinates, `frame` says
    where these are: `x = origin + scale * u`.  `gram` (m, m) has the integrals of products of two members over the
    region, in local volumes.
    """

    partition: Partition
    frame: Frame
    degree: int
    source: Products
    change: BasisChange
    coefficients: Floats
    gram: Floats

    @classmethod
    def of(cls, partition: Partition, source: Products, degree: int) -> WorkingBasis:
        """A well-conditioned basis of the span of members in the partition's local coordinates."""
        rules = tetrahedra_rule(partition.local, 2 * degree)
        values = [(monomial_values(p, degree) * np.sqrt(w)).T for p, w in rules]
        # on a piece the squares of all its samples are those of as many as there are monomials
        factors = [np.linalg.qr(np.concatenate([values[c] for c in piece]), mode="r") for piece in partition.pieces]

        def samples(tables: list[Floats]) -> Floats:
            return np.concatenate([f @ t.T for f, t in zip(factors, tables, strict=True)])

        change, doubles = orthonormal(source, samples)
        columns = samples(doubles)
        return cls(partition.local, partition.frame, degree, source, change, np.array(doubles), columns.T @ columns)

    @property
    def members(self) -> tuple[fmpq_mat, ...]:
        """The exact coefficients (m, C(n+3, 3)) of the members that it was made from, on each piece."""
        return self.source.matrices

    @property
    def transform(self) -> fmpq_mat:
        """The working basis in terms of the one it was made from: (m, m)."""
        return self.change.matrix

    @cached_property
    def patches(self) -> tuple[fmpq_mat, ...]:
        """The exact coefficients (m, C(n+3, 3)) of the working basis on each piece."""
        return tuple(self.transform * matrix for matrix in self.members)

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

    def combine(self, working: fmpq_mat) -> list[Polynomial]:
        """The exact polynomials, piece by piece, of the member with working coefficients (1, m).

        In integers over one denominator, several times faster than rationals.
        """
        monomials = exponents(self.degree)
        numerators, denominator = working.numer_denom()
        scale = fmpq(1, denominator * self.source.denominator * fmpz(2) ** self.change.shift)
        result = []
        for row in self.source.combined(numerators * self.change.numerators):
            whole = RING.from_dict(dict(zip(monomials, row.entries(), strict=True)))
            result.append(Polynomial.from_raw(whole * scale))
        return result

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


def orthonormal(source: Products, samples: Callable[[list[Floats]], Floats]) -> tuple[BasisChange, list[Floats]]:
    """Change a basis exactly to one whose samples are orthonormal columns up to `CONDITION`.

    `source` holds the members as rows; `samples` maps doubles of its matrices to columns (N, m).  Returns
    the change (m, m), and the doubles of the changed matrices.
    """
    members = _FixedPoint(source)
    whole, shift, doubles = members.unit, 0, members.doubles()
    attempts = 6  # changes of basis before giving up; each gains about ten digits
    for _ in range(attempts):
        columns = samples(doubles)
        norms = np.linalg.norm(columns, axis=0)
        columns = columns / norms
        angles = np.linalg.eigvalsh(columns.T @ columns)  # the squares of the singular values
        if angles[-1] < CONDITION**2 * angles[0] and norms.max() < CONDITION * norms.min():
            break
        triangular, order = qr(columns, mode="r", pivoting=True)  # dependent members come last
        triangular = triangular[: len(order)]
        step, binary = _whole(_inverse(triangular).T / norms[order], order)
        whole, shift = step * whole, shift + binary
        doubles = members.changed(whole, shift)
    return members.change(whole, shift), doubles


class _FixedPoint:
    """Members, scaled by powers of two to coefficients of about 1, as whole numbers of 2^-bits.

    Exact to the last of these digits, of which there are always as many as a change of basis leaves `GUARD_BITS` of:
    some spaces have members with coefficients beyond any double, and more digits than are of use.
    """

    def __init__(self, source: Products) -> None:
        self.source, self.size = source, source.size
        self.widths = [table.ncols() for table in source.tables]
        self.rows = [[int(v) for v in row] for row in source.rows.tolist()]
        self.lengths = [_length(row) for row in self.rows]
        self.unit = fmpz_mat(self.size, self.size, [int(i == j) for i in range(self.size) for j in range(self.size)])
        self.exponents = [0] * self.size
        self._bits, self._table = BITS, self._rounded(BITS)

    @cached_property
    def lost(self) -> int:
        """Digits that a sum over the generators may lose."""
        return len(self.rows[0]).bit_length() + max(_length(map(int, t.entries())) for t in self.source.tables)

    def doubles(self) -> list[Floats]:
        """The doubles of the members, scaled."""
        return self._split(self._table, self._bits)

    def changed(self, whole: fmpz_mat, shift: int) -> list[Floats]:
        """The doubles of the members, scaled and then changed by `whole * 2^-shift`."""
        growth = max(int(v).bit_length() for v in whole.entries()) + self.size.bit_length() - shift
        if self._bits < growth + GUARD_BITS:
            self._bits = growth + GUARD_BITS
            self._table = self._rounded(self._bits)
        return self._split(whole * self._table, self._bits + shift)

    def _split(self, whole: fmpz_mat, shift: int) -> list[Floats]:
        """The doubles of a table of whole numbers of 2^-shift, piece by piece."""
        entries = np.array([float(v) for v in whole.entries()])
        table = np.ldexp(entries, -shift).reshape(self.size, -1)
        ends = list(accumulate(self.widths))
        return [table[:, end - width : end] for end, width in zip(ends, self.widths, strict=True)]

    def change(self, whole: fmpz_mat, shift: int) -> BasisChange:
        """`whole * 2^-shift` as a change of the members as they were given."""
        most = max(self.exponents)
        entries = [[int(v) << (most - e) for v, e in zip(row, self.exponents, strict=True)] for row in whole.tolist()]
        total = shift + most
        scaled = [v * self.source.denominator << max(-total, 0) for row in entries for v in row]
        return BasisChange(fmpz_mat(self.size, self.size, scaled), max(total, 0))

    @cached_property
    def generators(self) -> list[list[tuple[int, int]]]:
        """The coefficients of each generator, side by side on the pieces: the places of those other than 0, and
        these."""
        rows = zip(*(table.tolist() for table in self.source.tables), strict=True)
        return [[(place, int(v)) for place, v in enumerate(chain(*parts)) if v] for parts in rows]

    def _combined(self, row: list[int]) -> list[int]:
        """A combination of the generators: most numbers are 0 in both."""
        total = [0] * sum(self.widths)
        for factor, generator in zip(row, self.generators, strict=True):
            if factor:
                for place, value in generator:
                    total[place] += factor * value
        return total

    def _rounded(self, bits: int) -> fmpz_mat:
        """All members, side by side on the pieces, in whole numbers of 2^-bits.

        The combinations of generators are cut to as many digits as that takes, and to more where members cancel.
        """
        kept = max(bits, *self.lengths) if max(self.lengths) <= 2 * bits else bits + self.lost
        while True:
            cut = [max(length - kept, 0) for length in self.lengths]
            whole = [self._combined([v >> c for v in row]) for row, c in zip(self.rows, cut, strict=True)]
            sizes = [_length(row) for row in whole]
            missing = max((bits + self.lost - s for s, c in zip(sizes, cut, strict=True) if c), default=0)
            if missing <= 0:
                break
            kept += missing
        self.exponents = [s + c for s, c in zip(sizes, cut, strict=True)]
        moved: list[int] = []
        for row, size in zip(whole, sizes, strict=True):
            up, down = max(bits - size, 0), max(size - bits, 0)
            moved += [v << up >> down for v in row]
        return fmpz_mat(self.size, sum(self.widths), moved)


def _length(values: Iterable[int]) -> int:
    """Binary digits of the largest of some whole numbers."""
    found = list(values)
    return max(max(found, default=0), -min(found, default=0)).bit_length()


def to_doubles(matrix: fmpq_mat) -> Floats:
    """The nearest doubles of an exact matrix."""
    entries = [int(v.p) / int(v.q) if v else 0.0 for v in matrix.entries()]
    return np.array(entries).reshape(matrix.nrows(), matrix.ncols())


def _inverse(triangular: Floats) -> Floats:
    """The inverse, with pivots that vanished by rounding replaced by the rounding level."""
    diagonal = np.abs(np.diag(triangular))
    floor = 1e-15 * diagonal.max()
    safe = triangular + np.diag(np.where(diagonal < floor, floor, 0.0))
    return np.linalg.inv(safe)


def _whole(matrix: Floats, order: Integers) -> tuple[fmpz_mat, int]:
    """A matrix in whole numbers of a power of two, `STEP_BITS` in the row of the smallest numbers, and that power's
    exponent; its columns are put at the places that `order` says."""
    placed = np.empty_like(matrix)
    placed[:, order] = matrix
    shift = STEP_BITS - int(np.frexp(np.abs(placed).max(axis=1))[1].min())
    entries = [int(value) for value in np.rint(np.ldexp(placed, shift)).ravel().tolist()]
    rows, columns = placed.shape
    return fmpz_mat(rows, columns, entries), shift
