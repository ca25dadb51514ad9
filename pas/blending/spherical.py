"""All piecewise polynomials on a layout: where every face between pieces passes through the centre.

With the centre at 0 the homogeneous parts of a piecewise polynomial meet with C^k across such faces on their own: the
space without contacts is the direct sum of those of homogeneous splines on the sphere of directions (Alfeld, Neamtu
and Schumaker 1996), degree by degree.  Each is found once, from short integers alone; contacts then join them by few
equations.  Neither walls nor clips enter: how a region is cut makes no difference.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from itertools import combinations
from math import gcd, lcm

from flint import fmpq, fmpq_mat, fmpz_mat

from pas.algebra.matrices import Products
from pas.algebra.monomials import Exponents, count, homogeneous_exponents, positions
from pas.algebra.normal_form import NormalForm
from pas.algebra.nullspace import integral_nullspace, solve_sparse
from pas.algebra.polynomial import GENERATORS, RING
from pas.blending.net import Row, across, bernstein_polynomials, domain_point, members, numbered
from pas.contacts.contact import Contact
from pas.limits import checkpoint
from pas.partition.layout import Layout

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
    parts = [splines(layout, order, d) for d in range(degree + 1)]
    total = sum(part[0].nrows() for part in parts)
    tables = tuple(_side_by_side([part[piece] for part in parts], degree) for piece in range(len(layout.pieces)))
    rows: list[dict[int, fmpq]] = []
    for contact, pieces in zip(contacts, carriers, strict=True):
        checkpoint("setting up the conditions at contacts")
        form = NormalForm([contact.surface.raw, contact.clip.raw ** (order + 1)])
        images = _images(form, degree)
        for piece in pieces:
            rows += [
                {i: fmpq(v) for i, v in enumerate(row) if v != 0}
                for row in (tables[piece] * images).transpose().tolist()
            ]
    # without the denominator of all members each is many times shorter
    (basis,) = _shortened([integral_nullspace(rows, total)[0]])
    return Products(basis, tables)


@lru_cache(maxsize=64)
def splines(layout: Layout, order: int, degree: int) -> Tables:
    """A basis of the homogeneous splines C^order of a degree: for each piece (dimension, C(degree+2, 2))."""
    monomials = list(homogeneous_exponents(degree, 3))
    if degree <= order:
        size = len(monomials)
        whole = fmpz_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
        return (whole,) * len(layout.pieces)
    triangles = [t for piece in layout.triangles for t in piece]
    points = numbered(triangles, degree)
    solved = solve_sparse((row for row in _rows(layout, points, order, degree) if row), len(points))
    found, dimension = members(solved, len(points)), len(solved.free)
    patches = []
    for piece in layout.triangles:
        checkpoint("writing homogeneous splines")
        numbers = [points[domain_point(piece[0], index)] for index in homogeneous_exponents(degree, 3)]
        values = fmpz_mat(dimension, len(numbers))
        for column, number in enumerate(numbers):
            for member, value in found[number].items():
                values[member, column] = value
        patches.append(fmpq_mat(values) * _bernstein(layout, piece[0], degree, monomials))
    return _integral(patches)


def _rows(layout: Layout, points: dict[tuple[tuple[int, int], ...], int], order: int, degree: int) -> Iterator[Row]:
    """The conditions across all sides of triangles: of all orders within a piece, up to `order` between two."""
    sides: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for piece, triangles in enumerate(layout.triangles):
        for triangle in triangles:
            for side in combinations(sorted(triangle), 2):
                sides.setdefault(side, []).append((piece, next(v for v in triangle if v not in side)))
    for common, ((first, a), (second, b)) in sides.items():
        coordinates = _dual(layout, (a, *common), b)
        for s in range(1, 1 + (degree if first == second else min(order, degree))):
            yield from across(points, degree, common, a, b, coordinates, s)


def _dual(layout: Layout, corners: Exponents, ray: int) -> list[fmpq]:
    """The coordinates of a ray by three others."""
    inverse = fmpq_mat(3, 3, [c for v in corners for c in layout.all_rays[v]]).inv()
    row = fmpq_mat(1, 3, list(layout.all_rays[ray])) * inverse
    return list(row.entries())


def _bernstein(layout: Layout, triangle: Exponents, degree: int, monomials: list[Exponents]) -> fmpq_mat:
    """The Bernstein basis of a spherical triangle by monomials, a polynomial a row."""
    inverse = fmpq_mat(3, 3, [c for v in triangle for c in layout.all_rays[v]]).inv()
    origin = RING.constant(0)
    linear = [
        origin + sum((g * inverse[axis, corner] for axis, g in enumerate(GENERATORS)), origin) for corner in range(3)
    ]
    table = fmpq_mat(len(monomials), len(monomials))
    where = {e: i for i, e in enumerate(monomials)}
    for row, polynomial in enumerate(bernstein_polynomials(linear, degree)):
        for e, c in polynomial.to_dict().items():
            table[row, where[e]] = c
    return table


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


def _images(form: NormalForm, degree: int) -> fmpz_mat:
    """The normal forms of all monomials: (monomials, targets), whole numbers, each target by its own factor."""
    where = positions(degree)
    targets: dict[Exponents, int] = {}
    columns: list[dict[int, fmpq]] = []
    for e, image in form.images(degree).items():
        for target, value in image.items():
            number = targets.setdefault(target, len(targets))
            if number == len(columns):
                columns.append({})
            columns[number][where[e]] = value
    table = fmpz_mat(count(degree), len(columns))
    for column, entries in enumerate(columns):
        common = lcm(*(int(v.q) for v in entries.values()))
        for row, value in entries.items():
            table[row, column] = int(value.p) * (common // int(value.q))
    return table


def _integral(patches: list[fmpq_mat]) -> Tables:
    """Members with the shortest whole coefficients: one factor for all pieces of each."""
    common = lcm(*(int(v.q) for patch in patches for v in patch.entries()))
    return _shortened([(patch * common).numer_denom()[0] for patch in patches])


def _shortened(tables: list[fmpz_mat]) -> Tables:
    """The members with their contents divided out."""
    rows = [table.tolist() for table in tables]
    contents = [gcd(*(int(v) for row in rows for v in row[i])) or 1 for i in range(tables[0].nrows())]
    return tuple(
        fmpz_mat(t.nrows(), t.ncols(), [v // contents[i] for i, entries in enumerate(row) for v in entries])
        for t, row in zip(tables, rows, strict=True)
    )
