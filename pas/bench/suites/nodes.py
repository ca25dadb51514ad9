"""Nodes of pipes in any directions, with clips by the program."""

from __future__ import annotations

from fractions import Fraction
from itertools import count

from pas.bench.case import Case, Prepare, Suite, Work

STEP = Fraction(1, 5000)
"""By which the first radius differs from run to run, so that nothing that was kept helps."""

DIRECTIONS = {
    "T": ((1, 0, 0), (-1, 0, 0), (0, 1, 0)),
    "three skew directions": ((1, 0, 0), (-1, 2, 0), (0, -1, 3)),
    "tetrahedral": ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)),
    "six-way": ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)),
}


def _node(name: str, order: int) -> Prepare:
    def prepare() -> Work:
        from pas.pipeline.node import node

        first, *others = DIRECTIONS[name]
        runs = count()
        return lambda: node([(first, 1 + STEP * next(runs)), *((way, 1) for way in others)], order)

    return prepare


def _again() -> Work:
    from pas.pipeline.node import node

    def work() -> object:
        return node([(way, "7/9") for way in DIRECTIONS["three skew directions"]], 1)

    work()
    return work


def cases() -> list[Case]:
    """Those of this suite."""
    fresh = [Case(f"{name}, GC^{order}", _node(name, order)) for name in DIRECTIONS for order in (1, 2)]
    return [*fresh, Case("the same node again", _again)]


NODES = Suite("node", "nodes of pipes in any directions", cases)
