"""All piecewise polynomials on a mesh, by their B-coefficients.

The unknowns are the B-coefficients at the domain points, those on common faces shared by the cells around them, so that
C^0 holds by construction.  Across a face with corners v1, v2, v3 the patches of the cells with the other corners a and
b meet with C^r iff their B-coefficients satisfy the equations of `across`.  These have few terms and only neighbours in
common, so sparse elimination hardly fills in: for more than a few cells this is much faster than the construction of
`pas.blending.solving`, which is there for few cells and large orders.

The basis is not the reduced one: each member has whole B-coefficients, and is not zero at just
one of the domain points that elimination left free (a minimal determining set).

On a layout every face between pieces passes through the centre (`solve_on_layout`).  With the centre at 0 the
homogeneous parts of a piecewise polynomial meet with C^k across such faces on their own: the space without contacts is
the direct sum of those of homogeneous splines on the sphere of directions (Alfeld, Neamtu and Schumaker 1996), degree
by degree.  Each is found once, from short integers alone; contacts then join them by few equations.  Neither walls nor
clips enter: how a region is cut makes no difference.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import combinations
from math import gcd, lcm, prod

from flint import fmpq, fmpq_mat, fmpz_mat

from pas.algebra.ideal import Ideal
from pas.algebra.matrices import Products, whole_rows
from pas.algebra.monomials import Exponents, count, homogeneous_exponents, multinomial, positions
from pas.algebra.nullspace import Solved, integral, integral_nullspace, solve_sparse
from pas.algebra.polynomial import GENERATORS, RING
from pas.contacts.contact import Contact
from pas.limits import checkpoint
from pas.partition.cells import Partition
from pas.partition.layout import Layout
from pas.surface.placed import PlacedContacts

Row = dict[int, fmpq]
Column = dict[Exponents, fmpq]

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
    points: Mapping[Point, int], degree: int, face: Exponents, a: int, b: int, coordinates: Sequence[fmpq], order: int
) -> Iterator[Row]:
    """The conditions of orders 1 to `order` across a face between the corners a and b, `coordinates` those of b by
    (a, *face): a row for each order and multi-index."""
    for s in range(1, 1 + min(order, degree)):
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


def coordinates_of(vector: Sequence[fmpq], *others: Sequence[fmpq]) -> list[fmpq]:
    """The coordinates of a vector by as many others as it has entries: barycentric ones of points (1, x, y, z)."""
    return list((fmpq_mat([list(vector)]) * fmpq_mat([list(other) for other in others]).inv()).entries())


def bernstein_polynomials(others: Sequence[Sequence[fmpq]], degree: int) -> list[Column]:
    """The Bernstein polynomials of a simplex by corners (1, x, y, z), or of rays, by multi-index and monomial."""
    axes, inverse = (RING.constant(1), *GENERATORS)[-len(others) :], fmpq_mat([list(other) for other in others]).inv()
    forms = [sum((g * inverse[i, k] for i, g in enumerate(axes)), RING.constant(0)) for k in range(len(others))]
    powers = [[form**k for k in range(degree + 1)] for form in forms]
    products = (
        prod((powers[i][k] for i, k in enumerate(index)), start=RING.constant(1)) * multinomial(index)
        for index in homogeneous_exponents(degree, len(others))
    )
    return [product.to_dict() for product in products]


def in_monomials(
    values: list[dict[int, int]], dimension: int, bernstein: Sequence[Column], places: Mapping[Exponents, int]
) -> fmpq_mat:
    """Members (dimension, monomials) by values at the domain points of a simplex, given its Bernstein polynomials.

    Most members vanish on it; the others are converted together, in integers.
    """
    change, common = whole_rows(bernstein, places)
    touched = sorted({member for at_point in values for member in at_point})
    table = fmpz_mat(len(touched), len(values), [at_point.get(m, 0) for m in touched for at_point in values])
    rows, nothing = dict(zip(touched, (table * change).tolist(), strict=True)), [0] * len(places)
    whole = fmpz_mat(dimension, len(places), [v for m in range(dimension) for v in rows.get(m, nothing)])
    return fmpq_mat(whole) * fmpq(1, common)


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
            a, b = (next(v for v in self.partition.cells[i] if v not in triangle) for i in (first, second))
            corners = [(fmpq(1), *corner) for corner in self.partition.corners((b, a, *triangle))]
            order = self.degree if same else self.placed.order
            yield from across(self.points, self.degree, triangle, a, b, coordinates_of(*corners), order)
        for contact, pieces in zip(self.placed.local_contacts, self.placed.carriers, strict=True):
            ideal = contact.ideal(self.placed.order)
            for piece in pieces:
                terms = (polynomial.items() for polynomial in self._bernstein(piece))
                yield from ideal.equations(zip(self._numbers(piece), terms, strict=True), self.degree)

    def _patch(self, piece: int, members: list[dict[int, int]], dimension: int) -> fmpq_mat:
        """The members' polynomials on a piece, from the B-coefficients on its first cell."""
        checkpoint("writing the basis", piece / len(self.partition.pieces))
        values = [members[number] for number in self._numbers(piece)]
        return in_monomials(values, dimension, self._bernstein(piece), positions(self.degree))

    def _numbers(self, piece: int) -> list[int]:
        """The unknowns on the first cell of a piece."""
        cell = self.partition.cells[self.partition.pieces[piece][0]]
        return [self.points[domain_point(cell, index)] for index in homogeneous_exponents(self.degree, 4)]

    def _bernstein(self, piece: int) -> list[Column]:
        """The Bernstein polynomials of the first cell of a piece, by monomials in x, y, z."""
        corners = self.partition.corners(self.partition.cells[self.partition.pieces[piece][0]])
        return bernstein_polynomials([(fmpq(1), *corner) for corner in corners], self.degree)


Tables = tuple[fmpz_mat, ...]
"""For each piece the members' coefficients, one member a row."""


@lru_cache(maxsize=16)
def solve_on_layout(
    contacts: tuple[Contact, ...], carriers: tuple[tuple[int, ...], ...], order: int, layout: Layout, degree: int
) -> Products:
    """A basis of all solutions: for each piece (dimension, C(n+3, 3)) coefficients of monomials.

    `contacts` are in local coordinates, `carriers` the pieces of each.  Kept by what it depends on: regions of one
    layout differ in their walls alone.
    """
    tables, rows = equations_on_layout(contacts, carriers, order, layout, degree)
    # without the denominator of all members each is many times shorter
    (basis,) = _shortened([integral_nullspace(rows, tables[0].nrows())[0]])
    return Products(basis, tables)


@lru_cache(maxsize=2)
def equations_on_layout(
    contacts: tuple[Contact, ...], carriers: tuple[tuple[int, ...], ...], order: int, layout: Layout, degree: int
) -> tuple[Tables, list[Row]]:
    """Piecewise polynomials of which all solutions are combinations, and the equations for these."""
    parts = [splines(layout, order, d) for d in range(degree + 1)]
    tables = tuple(_side_by_side([part[piece] for part in parts], degree) for piece in range(len(layout.pieces)))
    rows: list[Row] = []
    for contact, pieces in zip(contacts, carriers, strict=True):
        checkpoint("setting up the conditions at contacts")
        images = _images(contact.ideal(order), degree)
        for piece in pieces:
            rows += [
                {i: fmpq(v) for i, v in enumerate(row) if v != 0}
                for row in (tables[piece] * images).transpose().tolist()
            ]
    return tables, rows


@lru_cache(maxsize=64)
def splines(layout: Layout, order: int, degree: int) -> Tables:
    """A basis of the homogeneous splines C^order of a degree: for each piece (dimension, C(degree+2, 2))."""
    places = {e: i for i, e in enumerate(homogeneous_exponents(degree, 3))}
    if degree <= order:
        size = len(places)
        whole = fmpz_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
        return (whole,) * len(layout.pieces)
    triangles = [t for piece in layout.triangles for t in piece]
    points = numbered(triangles, degree)
    solved = solve_sparse((row for row in _rows(layout, points, order, degree) if row), len(points))
    found, dimension = members(solved, len(points)), len(solved.free)
    patches = []
    for piece in layout.triangles:
        checkpoint("writing homogeneous splines")
        values = [found[points[domain_point(piece[0], index)]] for index in homogeneous_exponents(degree, 3)]
        rays = [tuple(map(fmpq, layout.rays[v])) for v in piece[0]]
        patches.append(in_monomials(values, dimension, bernstein_polynomials(rays, degree), places))
    common = lcm(*(int(v.q) for patch in patches for v in patch.entries()))
    return _shortened([(patch * common).numer_denom()[0] for patch in patches])


def _rows(layout: Layout, points: dict[Point, int], order: int, degree: int) -> Iterator[Row]:
    """The conditions across all sides of triangles: of all orders within a piece, up to `order` between two."""
    sides: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for piece, triangles in enumerate(layout.triangles):
        for triangle in triangles:
            for side in combinations(sorted(triangle), 2):
                sides.setdefault(side, []).append((piece, next(v for v in triangle if v not in side)))
    for common, ((first, a), (second, b)) in sides.items():
        coordinates = coordinates_of(*([fmpq(c) for c in layout.rays[v]] for v in (b, a, *common)))
        yield from across(points, degree, common, a, b, coordinates, degree if first == second else order)


def _side_by_side(parts: list[fmpz_mat], degree: int) -> fmpz_mat:
    """The members of all homogeneous parts on one piece, by the monomials of all degrees."""
    where, size = positions(degree), count(degree)
    table = fmpz_mat(sum(part.nrows() for part in parts), size)
    start = 0
    for d, part in enumerate(parts):
        columns = [where[e] for e in homogeneous_exponents(d, 3)]
        for row, entries in enumerate(part.tolist(), start):
            for column, value in zip(columns, entries, strict=True):
                if value != 0:
                    table[row, column] = value
        start += part.nrows()
    return table


def _images(ideal: Ideal, degree: int) -> fmpz_mat:
    """The normal forms of all monomials: (monomials, targets), whole numbers, each target by its own factor."""
    where, columns = positions(degree), dict[Exponents, Row]()
    for e, image in ideal.images(degree).items():
        for target, value in image.items():
            columns.setdefault(target, {})[where[e]] = value
    table = fmpz_mat(count(degree), len(columns))
    for column, entries in enumerate(columns.values()):
        for row, whole in integral(entries).items():
            table[row, column] = whole
    return table


def _shortened(tables: list[fmpz_mat]) -> Tables:
    """The members with the shortest whole coefficients: one factor for all pieces of each."""
    rows = [table.tolist() for table in tables]
    contents = [gcd(*(int(v) for row in rows for v in row[i])) or 1 for i in range(tables[0].nrows())]
    return tuple(
        fmpz_mat(t.nrows(), t.ncols(), [v // contents[i] for i, entries in enumerate(row) for v in entries])
        for t, row in zip(tables, rows, strict=True)
    )
