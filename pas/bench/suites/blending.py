"""Corners and elbows from contacts to the proved, fair surface."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import count

from pas.bench.case import Case, Prepare, Suite, Work

AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
STEP = Fraction(1, 5000)
"""By which radii differ from run to run, so that nothing that was kept helps."""


def _blend(radii: Sequence[str], order: int) -> Prepare:
    def prepare() -> Work:
        from pas.contacts.pipe import Pipe
        from pas.pipeline.blend import blend

        runs = count()

        def work() -> object:
            more = STEP * next(runs)
            return blend([Pipe(a, Fraction(r) + more, 1) for a, r in zip(AXES, radii, strict=False)], order)

        return work

    return prepare


def cases() -> list[Case]:
    """Those of this suite."""
    bodies = {"elbow": ("1/3", "1/3"), "equal corner": ("1/3",) * 3, "unequal corner": ("1/3", "1/4", "2/5")}
    return [Case(f"{name}, GC^{order}", _blend(radii, order)) for name, radii in bodies.items() for order in (1, 2, 3)]


BLENDING = Suite("blend", "contacts to a proved and fair surface", cases)
