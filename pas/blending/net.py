"""All piecewise polynomials on a mesh, by their B-coefficients.

The unknowns are the B-coefficients at the domain points, those on common faces shared by the cells around them, so that
C^0 holds by construction.  Across a face with corners v1, v2, v3 the patches of the cells with the other corners a and
b meet with C^r iff their B-coefficients satisfy the equations of `across`.  These have few terms and only neighbours in
common, so sparse elimination hardly fills in: for more than a few cells this is much faster than the construction of
`pas.blending.conditions`, which is there for few cells and large orders.

The basis is not the reduced one: each member has whole B-coefficients, and is not zero at just
one of the domain points that elimination left free (a minimal determining set).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import factorial, lcm, prod

from flint import fmpq, fmpq_mat, fmpq_mpoly, fmpz_mat

from pas.algebra.monomials import Exponents, count, homogeneous_exponents, positions
from pas.algebra.normal_form import NormalForm
from pas.algebra.nullspace import Solved, solve_sparse
from pas.algebra.polynomial import GENERATORS, RING
from pas.algebra.rational import Vector
from pas.limits import checkpoint
from pas.partition.cells import Partition
from pas.surface.placed import PlacedContacts

Row = dict[int, fmpq]

Point = tuple[tuple[int, int], ...]
"""The corners of a domain point with their multiplicities, in order."""


def domain_point(simplex: Exponents, index: Exponents) -> Point:
    """The domain point of a multi-index on a simplex."""
    return tuple(sorted((v, times) for v, times in zip(simplex, index, strict=True) if times))


def numbered(simplices: Sequence[Exponents], degree: int) -> dict[Point, int]:
    """All domain points of a degree, with a number each."""
    numbers: dict[Point, int] = {}
    for simplex in simplices:
        for index in homogeneous_exponents(degree, len(simplex)):
            numbers.setdefault(domain_point(simplex, index), len(numbers))
    return numbers


def across(
    points: Mapping[Point, int], degree: int, face: Exponents, a: int, b: int, coordinates: Sequence[fmpq], s: int
) -> Iterator[Row]:
    """The conditions of order s across a face between the corners a and b, `coordinates` those of b by (a, *face)."""
    weights = _power_weights(coordinates, s)
    for index in homogeneous_exponents(degree - s, len(face)):
        row: Row = {points[domain_point((b, *face), (s, *index))]: fmpq(-1)}
        for shift, weight in weights:
            there = (shift[0], *(i + m for i, m in zip(index, shift[1:], strict=True)))
            number = points[domain_point((a, *face), there)]
            row[number] = row.get(number, fmpq(0)) + weight
        yield row


def members(solved: Solved, points: int) -> list[dict[int, int]]:
    """The B-coefficients as {member: value} for each domain point, every member primitive."""
    place = {number: i for i, number in enumerate(solved.free)}
    scales = [1] * len(place)
    for row in solved.bound.values():
        for source, value in row.items():
            scales[place[source]] = lcm(scales[place[source]], int(value.q))
    found: list[dict[int, int]] = [{} for _ in range(points)]
    for number, i in place.items():
        found[number][i] = scales[i]
    for number, row in solved.bound.items():
        for source, value in row.items():
            i = place[source]
            found[number][i] = int(value.p) * (scales[i] // int(value.q))
    return found


def bernstein_polynomials(coordinates: Sequence[fmpq_mpoly], degree: int) -> list[fmpq_mpoly]:
    """Those of a simplex whose barycentric coordinates are given as linear forms, by multi-index."""
    powers = [[form**k for k in range(degree + 1)] for form in coordinates]
    return [
        prod((powers[i][k] for i, k in enumerate(index)), start=RING.constant(1)) * multinomial(index)
        for index in homogeneous_exponents(degree, len(coordinates))
    ]


def multinomial(index: Exponents) -> int:
    """The number of words with so many letters of each kind."""
    return factorial(sum(index)) // prod(map(factorial, index))


def _power_weights(coordinates: Sequence[fmpq], s: int) -> list[tuple[Exponents, fmpq]]:
    """The terms of (sum of coordinates)^s that are not zero, by multi-index."""
    weights = []
    for index in homogeneous_exponents(s, len(coordinates)):
        value = prod((c**k for c, k in zip(coordinates, index, strict=True)), start=fmpq(1)) * multinomial(index)
        if value != 0:
            weights.append((index, value))
    return weights


@dataclass(frozen=True)
class Net:
    """The B-coefficients of degree `degree` on a partition, cells of a piece being one polynomial.

    They are in the local coordinates of the contacts in place.
    """

    placed: PlacedContacts
    degree: int

    @property
    def partition(self) -> Partition:
        """The partition in local coordinates."""
        return self.placed.local

    @cached_property
    def points(self) -> dict[Point, int]:
        """The number of each domain point: its vertices with their multiplicities."""
        return numbered(self.partition.cells, self.degree)

    def solve(self) -> tuple[fmpq_mat, ...]:
        """A basis of all solutions: for each piece (dimension, C(n+3, 3)) coefficients of monomials."""
        solved = solve_sparse((row for row in self._rows() if row), len(self.points))
        found = members(solved, len(self.points))
        return tuple(self._patch(piece, found, len(solved.free)) for piece in range(len(self.partition.pieces)))

    def _rows(self) -> Iterator[Row]:
        for number, (triangle, first, second) in enumerate(self.partition.inner_triangles):
            checkpoint("setting up the conditions across faces", number / len(self.partition.inner_triangles))
            same = self.partition.piece_of[first] == self.partition.piece_of[second]
            for s in range(1, 1 + min(self.degree if same else self.placed.order, self.degree)):
                yield from self._across(triangle, first, second, s)
        for contact, pieces in zip(self.placed.local_contacts, self.placed.carriers, strict=True):
            form = NormalForm([contact.surface.raw, contact.clip.raw ** (self.placed.order + 1)])
            for piece in pieces:
                terms = (polynomial.to_dict().items() for polynomial in self._bernstein(piece))
                yield from form.rows(zip(self._numbers(piece), terms, strict=True), self.degree)

    def _across(self, triangle: Exponents, first: int, second: int, s: int) -> Iterator[Row]:
        """The conditions of order s across a face, a row for each index (i, j, k) of degree n - s."""
        a, b = (self._opposite(cell, triangle) for cell in (first, second))
        coordinates = _barycentric(self.partition.corners((a, *triangle)), self.partition.vertices[b])
        yield from across(self.points, self.degree, triangle, a, b, coordinates, s)

    def _patch(self, piece: int, members: list[dict[int, int]], dimension: int) -> fmpq_mat:
        """The members' polynomials on a piece, from the B-coefficients on its first cell.

        Most members vanish on it; the others are converted together, in integers.
        """
        checkpoint("writing the basis", piece / len(self.partition.pieces))
        numbers, polynomials = self._numbers(piece), self._bernstein(piece)
        where, size = positions(self.degree), count(self.degree)
        common = lcm(*(int(c.q) for p in polynomials for c in p.coeffs()))
        change = fmpz_mat(size, size)
        for row, polynomial in enumerate(polynomials):
            for e, c in polynomial.to_dict().items():
                change[row, where[e]] = int(c.p) * (common // int(c.q))
        touched = sorted({member for number in numbers for member in members[number]})
        table = [members[number].get(member, 0) for member in touched for number in numbers]
        converted = fmpq_mat(fmpz_mat(len(touched), size, table) * change) * fmpq(1, common)
        result = fmpq_mat(dimension, size)
        for member, values in zip(touched, converted.tolist(), strict=True):
            for column, value in enumerate(values):
                if value != 0:
                    result[member, column] = value
        return result

    def _numbers(self, piece: int) -> list[int]:
        """The unknowns on the first cell of a piece."""
        cell = self.partition.cells[self.partition.pieces[piece][0]]
        return [self.points[domain_point(cell, index)] for index in homogeneous_exponents(self.degree, 4)]

    def _bernstein(self, piece: int) -> list[fmpq_mpoly]:
        """The Bernstein polynomials of the first cell of a piece, in x, y, z."""
        corners = self.partition.corners(self.partition.cells[self.partition.pieces[piece][0]])
        origin = RING.constant(0)
        linear = [
            origin + sum((g * c for g, c in zip(GENERATORS, f[1:], strict=True)), f[0]) for f in _inverse(corners)
        ]
        return bernstein_polynomials(linear, self.degree)

    def _opposite(self, cell: int, triangle: Exponents) -> int:
        return next(v for v in self.partition.cells[cell] if v not in triangle)


def _inverse(corners: tuple[Vector, ...]) -> list[list[fmpq]]:
    """The barycentric coordinates as linear forms (constant, x, y, z)."""
    table = [[fmpq(1), *corner] for corner in corners]
    inverse = fmpq_mat(table).inv().transpose()
    rows: list[list[fmpq]] = inverse.tolist()
    return rows


def _barycentric(corners: tuple[Vector, ...], point: Vector) -> list[fmpq]:
    x, y, z = point
    return [f[0] + f[1] * x + f[2] * y + f[3] * z for f in _inverse(corners)]
