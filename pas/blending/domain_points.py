"""Domain points of B-forms, and the conditions of smoothness between neighbours in them.

A simplex is given by the numbers of its corners, a domain point by a multi-index of these; points on common
faces are one.  With w the coordinates of the corner b that is across a common face by those of the simplex on
this side, corners a, v1, v2, ..., two polynomials meet with C^r iff for all s <= r

    c_b(s, i, j, ..) = sum over |m| = s of  c_a(m0, i + m1, j + m2, ..) * (s! / m!) * w^m

(Lai and Schumaker 2007, theorem 2.28).  That holds for tetrahedra with barycentric coordinates, and for
homogeneous polynomials on spherical triangles with coordinates by their three rays (Alfeld, Neamtu and
Schumaker 1996).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import factorial, lcm, prod

from flint import fmpq

from pas.algebra.monomials import Exponents, homogeneous_exponents
from pas.algebra.nullspace import Solved

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
