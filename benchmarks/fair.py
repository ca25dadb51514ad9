"""Seconds that fair surfaces take: what of them goes into sampling, linearising, programmes and proofs; and live steps.

    python benchmarks/fair.py [--repeat 3]

The first table has medians of whole `pas.blend` calls, at the degree that they choose, and what of them goes where; the
second the milliseconds of one step of `refit` with another tension.
"""

from __future__ import annotations

import argparse
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from statistics import median
from typing import Any

import pas
from pas.fairing.objective import SurfaceObjective
from pas.fairing.programme import MemberProgramme
from pas.fairing.solver import FitSolver
from pas.piecewise import PiecewiseSurface
from pas.surface.directions import Directions

AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
CASES = {
    "elbow GC^1": (("1/3", "1/3"), 1),
    "elbow GC^2": (("1/3", "1/3"), 2),
    "equal GC^2": (("1/3", "1/3", "1/3"), 2),
    "unequal GC^1": (("1/3", "1/4", "2/5"), 1),
    "unequal GC^2": (("1/3", "1/4", "2/5"), 2),
    "unequal GC^3": (("1/3", "1/4", "2/5"), 3),
}
LIVE = ((1, 4), (2, 6), (1, 5), (2, 7))
"""Orders and degrees of the unequal corner for single steps."""

PARTS = {
    "sampling": ((Directions, "of"), (SurfaceObjective, "__init__")),
    "looking": ((SurfaceObjective, "look"),),
    "linearising": ((SurfaceObjective, "linearised"),),
    "programme": ((MemberProgramme, "step"),),
    "start": ((FitSolver, "started"),),
    "proof": ((PiecewiseSurface, "certify"),),
}
"""Methods whose seconds are added up, none of which calls another but `__init__` `of`."""


def corner(radii: tuple[str, ...]) -> list[pas.Pipe]:
    """Pipes along the axes, one or two or three."""
    return [pas.Pipe(axis, radius, 1) for axis, radius in zip(AXES, radii, strict=False)]


@contextmanager
def timed(found: dict[str, float]) -> Iterator[None]:
    """Add up the seconds of the parts while the block runs."""
    kept: list[tuple[type, str, Any]] = []
    depth: dict[str, int] = defaultdict(int)

    def wrapped(part: str, method: Callable[..., Any]) -> Callable[..., Any]:
        def run(*args: Any, **kwargs: Any) -> Any:
            depth[part] += 1
            start = time.perf_counter()
            try:
                return method(*args, **kwargs)
            finally:
                depth[part] -= 1
                if not depth[part]:
                    found[part] += time.perf_counter() - start

        return run

    for part, methods in PARTS.items():
        for owner, name in methods:
            original = vars(owner)[name]
            kept.append((owner, name, original))
            function = original.__func__ if isinstance(original, classmethod) else original
            new = wrapped(part, function)
            setattr(owner, name, classmethod(new) if isinstance(original, classmethod) else new)
    try:
        yield
    finally:
        for owner, name, original in kept:
            setattr(owner, name, original)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=3)
    repeat = parser.parse_args().repeat
    pas.blend(corner(("1/3", "1/3")), 1)  # imports
    print(f"{'':<14}{'degree':>7}{'seconds':>9}{'measure':>9}" + "".join(f"{part:>12}" for part in PARTS))
    for name, (radii, order) in CASES.items():
        seconds, measured, parts = [], [], defaultdict(list)
        for _ in range(repeat):
            found: dict[str, float] = defaultdict(float)
            with timed(found):
                start = time.perf_counter()
                blend = pas.blend(corner(radii), order)
                seconds.append(time.perf_counter() - start)
            measured.append(blend.timings["measure"])
            for part in PARTS:
                parts[part].append(found[part])
        cells = "".join(f"{median(parts[part]):>12.2f}" for part in PARTS)
        print(f"{name:<14}{blend.surface.degree:>7}{median(seconds):>9.2f}{median(measured):>9.2f}{cells}", flush=True)
    print(f"\n{'one step':<14}{'degree':>7}{'unknowns':>9}{'ms':>9}")
    for order, degree in LIVE:
        space = pas.solutions(corner(("1/3", "1/4", "2/5")), order, degree)
        moved = space.fit().refit(tension=5)
        times = []
        for i in range(12):
            start = time.perf_counter()
            moved = moved.refit(tension=5 + i / 4)  # another one each time
            times.append(time.perf_counter() - start)
        print(f"{'GC^' + str(order):<14}{degree:>7}{space.dimension:>9}{1e3 * median(times):>9.1f}", flush=True)


if __name__ == "__main__":
    main()
