"""Exact nullspaces of sparse rational systems.

The basis is the reduced one: each member is 1 in its own free unknown and 0 in the other free
unknowns, so it depends on the space and the order of the unknowns alone.  Elimination starts at
the last unknown, so the free ones are the first possible: with coefficients listed by degree,
these are low ones, which keeps the numbers short and the basis well conditioned (a factor of 10^7
on the corner with k = 2, n = 6).

Small systems go to flint's fraction-free elimination of the dense integer matrix.  For large ones
the pivots are found modulo a prime, and sparse elimination (`pas.algebra.sparse`) solves for
these unknowns exactly; that they are the right ones is then checked on the result, so the prime
decides nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import lcm

from flint import fmpq, fmpq_mat, fmpz_mat, nmod_mat

from pas.algebra.sparse import integral, solve_sparse

DENSE = 1500
"""Unknowns up to which dense elimination is used.  On the corner's systems of 150 to 850 unknowns
it is 1 to 4 times faster; but it cannot be interrupted, and grows with the cube."""

PRIME = 2**62 - 57


def nullspace(rows: Iterable[Mapping[int, fmpq]], unknowns: int) -> fmpq_mat:
    """A basis of all v with `row . v = 0` for every row: a matrix (dimension, unknowns)."""
    numerators, denominator = integral_nullspace(rows, unknowns)
    return fmpq_mat(numerators) * fmpq(1, denominator)


def integral_nullspace(rows: Iterable[Mapping[int, fmpq]], unknowns: int) -> tuple[fmpz_mat, int]:
    """The same basis as integers over one denominator."""
    system = [dict(entries) for entries in {tuple(sorted(integral(row).items())) for row in rows if row} if entries]
    if not system:
        return fmpz_mat(unknowns, unknowns, [int(i == j) for i in range(unknowns) for j in range(unknowns)]), 1
    system.sort(key=len)
    if unknowns > DENSE:
        return _by_sparse_elimination(system, unknowns)
    matrix = fmpz_mat(len(system), unknowns)
    for i, row in enumerate(system):
        for j, value in row.items():
            matrix[i, unknowns - 1 - j] = value
    reduced, denominator, rank = matrix.rref()
    return _from_reduced(reduced, int(denominator), rank, unknowns)


def _from_reduced(reduced: fmpz_mat, denominator: int, rank: int, unknowns: int) -> tuple[fmpz_mat, int]:
    table = reduced.tolist()[:rank]
    pivots: list[int] = []
    for row in table:
        start = pivots[-1] + 1 if pivots else 0
        pivots.append(next(j for j in range(start, unknowns) if row[j] != 0))
    bound = set(pivots)
    free = [j for j in reversed(range(unknowns)) if j not in bound]
    basis = fmpz_mat(len(free), unknowns)
    for i, j in enumerate(free):
        basis[i, unknowns - 1 - j] = denominator
        for row, pivot in zip(table, pivots, strict=True):
            if row[j] != 0:
                basis[i, unknowns - 1 - pivot] = -row[j]
    return basis, denominator


def _by_sparse_elimination(system: list[dict[int, int]], unknowns: int) -> tuple[fmpz_mat, int]:
    prime = PRIME
    while True:
        pivots = _pivots_modulo(system, unknowns, prime)
        exact = ({j: fmpq(v) for j, v in row.items()} for row in system)
        try:
            solved = solve_sparse(exact, unknowns, pivots)
        except ArithmeticError:
            solved = None
        # the reduced form: no unknown depends on one that comes after it
        if solved is not None and all(max(row, default=-1) < j for j, row in solved.bound.items()):
            break
        prime = _prime_below(prime)
    denominator = lcm(*(int(v.q) for row in solved.bound.values() for v in row.values()))
    place = {j: i for i, j in enumerate(solved.free)}
    basis = fmpz_mat(len(place), unknowns)
    for j, i in place.items():
        basis[i, j] = denominator
    for j, values in solved.bound.items():
        for free, v in values.items():
            basis[place[free], j] = int(v.p) * (denominator // int(v.q))
    return basis, denominator


def _pivots_modulo(system: list[dict[int, int]], unknowns: int, prime: int) -> list[int]:
    """The pivot unknowns of elimination from the last unknown, modulo a prime."""
    matrix = nmod_mat(len(system), unknowns, prime)
    for i, row in enumerate(system):
        for j, value in row.items():
            matrix[i, unknowns - 1 - j] = value % prime
    reduced, rank = matrix.rref()
    pivots: list[int] = []
    for residues in reduced.tolist()[:rank]:
        start = pivots[-1] + 1 if pivots else 0
        pivots.append(next(j for j in range(start, unknowns) if int(residues[j])))
    return [unknowns - 1 - j for j in pivots]


def _prime_below(prime: int) -> int:
    from flint import fmpz

    candidate = prime - 2
    while not fmpz(candidate).is_probable_prime():
        candidate -= 2
    return candidate
