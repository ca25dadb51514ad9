"""Nullspaces of sparse rational systems, exact.

The basis is the reduced one: each member is 1 in its own free unknown and 0 in the other free unknowns, so it depends
on the space and the order of the unknowns alone.  Elimination starts at the last unknown, so the free ones are the
first possible: with coefficients listed by degree, these are low ones, which keeps the numbers short and the basis well
conditioned (a factor of 10^7 on the corner with k = 2, n = 6).

Small systems are dense: which equations are independent, and which unknowns they bind, is found modulo a prime, and
the values of these by solving that square system exactly (flint's p-adic lifting; Dixon 1982), whose numbers are no
longer than those of the basis, where those of an elimination are eight times as long.  What depends on the prime is
checked on the solution: that it fulfils all other equations, so that the rank is right, and that no unknown hangs on a
free one that is named after it, so that the free ones are the first possible.  Large systems go to elimination of
sparse rows, fraction-free: rows are integers in dictionaries, kept primitive by dividing out their content, so numbers
stay as short as the elimination allows.  Where any solution will do (`solve_sparse`) the next pivot is the row with the
fewest entries and in it the unknown that fewest rows share (after Markowitz 1957).  Splines on tetrahedra, whose
conditions in B-form have few terms and only neighbours in common, hardly fill in: the C^1 quartics on 162 jittered
tetrahedra (2700 equations, 2197 unknowns, rank 1773) take seconds, where dense elimination takes minutes.

Every step is exact or checked exactly; nothing is left to chance.
"""

from __future__ import annotations

import heapq
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from itertools import count
from math import gcd, lcm
from typing import TypeVar, cast

from flint import fmpq, fmpq_mat, fmpz, fmpz_mat, nmod_mat

from pas.algebra.matrices import leads
from pas.elsewhere import elsewhere
from pas.limits import checkpoint

Row = dict[int, int]
K = TypeVar("K", bound=Hashable)

DENSE = 1500
"""Unknowns up to which dense elimination is used.  On the corner's systems of 150 to 850 unknowns
it is 4 times faster, but grows with the cube."""

FIRST_PRIME = 2**61 - 1
"""Primes from this one on are taken, until one divides no minor that counts: as a rule at once."""

STEPS = 64
"""Pivots between looks at the clock."""


@dataclass(frozen=True)
class Solved:
    """All solutions: `bound[j]` is the value of unknown j as {free unknown: coefficient}."""

    free: tuple[int, ...]
    bound: dict[int, dict[int, fmpq]]


def nullspace(rows: Iterable[Mapping[int, fmpq]], unknowns: int) -> fmpq_mat:
    """A basis of all v with `row . v = 0` for every row: a matrix (dimension, unknowns)."""
    numerators, denominator = integral_nullspace(rows, unknowns)
    return fmpq_mat(numerators) * fmpq(1, denominator)


def integral_nullspace(rows: Iterable[Mapping[int, fmpq]], unknowns: int) -> tuple[fmpz_mat, int]:
    """The basis of `nullspace` as integers (dimension, unknowns) over one denominator."""
    system = _distinct(rows)
    if not system:
        return fmpz_mat(unknowns, unknowns, [int(i == j) for i in range(unknowns) for j in range(unknowns)]), 1
    if unknowns > DENSE:
        return _basis(_solved(system, unknowns, from_last=True), unknowns)
    table = [[row.get(j, 0) for j in reversed(range(unknowns))] for row in sorted(system, key=len)]
    size = len(table) * unknowns * max(value.bit_length() for row in system for value in row.values())
    # Bits in a system that may take a second, which nothing interrupts: those of five pipes at GC^2 take 2 and 5 s.
    task, long = f"eliminating {len(table)} x {unknowns}", 6_000_000
    where = "pas.algebra.nullspace:bound_values"
    pivots, values, denominator = bound_values(table) if size < long else elsewhere(task, where, table)
    free = sorted(set(range(unknowns)) - set(pivots), reverse=True)
    basis = fmpz_mat(len(free), unknowns)
    for i, j in enumerate(free):
        basis[i, unknowns - 1 - j] = denominator
    for pivot, row in zip(pivots, values, strict=True):
        for i, value in enumerate(reversed(row)):
            basis[i, unknowns - 1 - pivot] = -value
    return basis, denominator


def bound_values(table: list[list[int]]) -> tuple[list[int], list[list[int]], int]:
    """The pivots of whole numbers (p, n), as in their reduced echelon form, and its other entries over one denominator:
    one row for each pivot, of one entry for each column without."""
    matrix, size = fmpz_mat(table), len(table[0])
    prime = fmpz(FIRST_PRIME)
    while True:
        residues = nmod_mat(matrix, int(prime))
        pivots, chosen = leads(*residues.rref()), leads(*residues.transpose().rref())
        free = sorted(set(range(size)) - set(pivots))
        if not free:
            return pivots, [[] for _ in pivots], 1
        if pivots:
            left, right = (fmpz_mat([[table[i][j] for j in columns] for i in chosen]) for columns in (pivots, free))
            values, denominator = cast(fmpq_mat, left.solve(right)).numer_denom()
            rest = [table[i] for i in sorted(set(range(len(table))) - set(chosen))]
            if _follow(rest, pivots, free, values, denominator):
                return pivots, [[int(v) for v in row] for row in values.tolist()], int(denominator)
        prime = next(n for n in (prime + step for step in count(1)) if n.is_prime())


def _follow(rest: list[list[int]], pivots: list[int], free: list[int], values: fmpz_mat, denominator: fmpz) -> bool:
    """Whether other equations follow from those solved, and pivots depend on free unknowns after them only."""
    first = all(values[i, k] == 0 or j > pivot for i, pivot in enumerate(pivots) for k, j in enumerate(free))
    if not rest or not first:
        return first
    bound, others = (fmpz_mat([[row[j] for j in columns] for row in rest]) for columns in (pivots, free))
    return bool(bound * values == others * denominator)


def solve_sparse(rows: Iterable[Mapping[int, fmpq]], unknowns: int) -> Solved:
    """Solve a homogeneous system by sparse elimination, whatever unknowns stay free."""
    return _solved(_distinct(rows), unknowns, from_last=False)


def integral(row: Mapping[K, fmpq]) -> dict[K, int]:
    """The row's primitive integral multiple (up to sign), without zeros."""
    denominator = lcm(*(int(value.q) for value in row.values()))
    whole = {j: int(v.p) * (denominator // int(v.q)) for j, v in row.items() if v != 0}
    content = gcd(*whole.values()) or 1
    return {j: v // content for j, v in whole.items()}


def _distinct(rows: Iterable[Mapping[int, fmpq]]) -> list[Row]:
    """Integral multiples of the rows, none zero and none twice."""
    return [dict(entries) for entries in {tuple(sorted(integral(row).items())) for row in rows} if entries]


def _basis(solved: Solved, unknowns: int) -> tuple[fmpz_mat, int]:
    """One solution for each free unknown, over one denominator."""
    denominator = lcm(*(int(v.q) for row in solved.bound.values() for v in row.values()))
    place = {j: i for i, j in enumerate(solved.free)}
    basis = fmpz_mat(len(place), unknowns)
    for j, i in place.items():
        basis[i, j] = denominator
    for j, values in solved.bound.items():
        for free, v in values.items():
            basis[place[free], j] = int(v.p) * (denominator // int(v.q))
    return basis, denominator


def _solved(system: list[Row], unknowns: int, from_last: bool) -> Solved:
    bound = _substituted(system, _eliminated(system, unknowns, from_last))
    return Solved(tuple(j for j in range(unknowns) if j not in bound), bound)


def _eliminated(system: list[Row], unknowns: int, from_last: bool) -> list[tuple[int, int]]:
    """Bring the system to echelon form in place; returns the pivots (row, unknown) in order.

    The pivot of a row is its last unknown, if that is asked for, else the one that fewest rows share.
    """
    sharing: list[set[int]] = [set() for _ in range(unknowns)]
    for i, row in enumerate(system):
        for j in row:
            sharing[j].add(i)
    done = [False] * len(system)
    queue = [(len(row), i) for i, row in enumerate(system)]
    heapq.heapify(queue)
    steps: list[tuple[int, int]] = []
    while queue:
        length, i = heapq.heappop(queue)
        row = system[i]
        if done[i] or len(row) != length or not row:
            continue
        pivot = max(row) if from_last else min(row, key=lambda j: (len(sharing[j]), abs(row[j])))
        done[i] = True
        for j in row:
            sharing[j].discard(i)
        steps.append((i, pivot))
        if len(steps) % STEPS == 0:
            checkpoint(f"eliminating {len(system)} equations in {unknowns} unknowns", len(steps) / unknowns)
        for other in tuple(sharing[pivot]):
            _subtract(system[other], row, pivot, other, sharing)
            heapq.heappush(queue, (len(system[other]), other))
    return steps


def _subtract(target: Row, row: Row, pivot: int, number: int, sharing: list[set[int]]) -> None:
    """Clear the pivot in row `number` with a multiple of the pivot row, and keep it primitive."""
    a, b = row[pivot], target[pivot]
    common = gcd(a, b)
    a, b = a // common, b // common
    if a != 1:
        for j in target:
            target[j] *= a
    for j, value in row.items():
        old = target.get(j, 0)
        new = old - b * value
        if new:
            target[j] = new
            if not old:
                sharing[j].add(number)
        elif old:
            del target[j]
            sharing[j].discard(number)
    content = gcd(*target.values())
    if content > 1:
        for j in target:
            target[j] //= content


def _substituted(system: list[Row], steps: list[tuple[int, int]]) -> dict[int, dict[int, fmpq]]:
    """Every pivot unknown in terms of the free ones, from the last pivot to the first."""
    eliminated = {pivot for _, pivot in steps}
    bound: dict[int, dict[int, fmpq]] = {}
    for number, (i, pivot) in enumerate(reversed(steps)):
        if number % STEPS == 0:
            checkpoint(f"substituting {len(steps)} unknowns", number / len(steps))
        total: dict[int, fmpq] = {}
        for j, value in system[i].items():
            if j == pivot:
                continue
            for free, known in bound[j].items() if j in eliminated else ((j, fmpq(1)),):
                total[free] = total.get(free, 0) - known * value
        lead = system[i][pivot]
        bound[pivot] = {free: value / lead for free, value in total.items() if value != 0}
    return bound
