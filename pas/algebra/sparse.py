"""Exact elimination of sparse rational systems, fraction-free.

Rows are integers in dictionaries.  The next pivot is the row with the fewest entries and in it
the unknown that fewest rows share (after Markowitz 1957); rows are kept primitive by dividing out
their content, so numbers stay as short as the elimination allows.  Splines on tetrahedra, whose
conditions in B-form have few terms and only neighbours in common, hardly fill in: the C^1 quartics
on 162 jittered tetrahedra (2700 equations, 2197 unknowns, rank 1773) take less than a second,
where dense elimination takes minutes.

Every step is exact; no prime is involved and nothing is left to chance.
"""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from math import gcd, lcm

from flint import fmpq

from pas.limits import checkpoint

Row = dict[int, int]

STEPS = 64
"""Pivots between looks at the clock."""


@dataclass(frozen=True)
class Solved:
    """All solutions: `bound[j]` is the value of unknown j as {free unknown: coefficient}."""

    free: tuple[int, ...]
    bound: dict[int, dict[int, fmpq]]


def solve_sparse(rows: Iterable[Mapping[int, fmpq]], unknowns: int, pivots: Collection[int] | None = None) -> Solved:
    """Solve a homogeneous system.

    With `pivots` only these unknowns may be eliminated; raises `ArithmeticError` where they do not
    carry the whole rank.
    """
    allowed = None if pivots is None else frozenset(pivots)
    system = [dict(entries) for entries in {tuple(sorted(integral(row).items())) for row in rows if row}]
    steps = _eliminated(system, unknowns, allowed)
    bound = _substituted(system, steps)
    return Solved(tuple(j for j in range(unknowns) if j not in bound), bound)


def integral(row: Mapping[int, fmpq]) -> Row:
    """The row's primitive integral multiple (up to sign), without zeros."""
    denominator = lcm(*(int(value.q) for value in row.values()))
    whole = {j: int(v.p) * (denominator // int(v.q)) for j, v in row.items() if v != 0}
    content = gcd(*whole.values()) or 1
    return {j: v // content for j, v in whole.items()}


def _eliminated(system: list[Row], unknowns: int, allowed: frozenset[int] | None) -> list[tuple[int, int]]:
    """Bring the system to echelon form in place; returns the pivots (row, unknown) in order."""
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
        candidates = row if allowed is None else [j for j in row if j in allowed]
        if not candidates:
            raise ArithmeticError("the given pivots do not carry the whole rank of the system")
        pivot = min(candidates, key=lambda j: (len(sharing[j]), abs(row[j])))
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
