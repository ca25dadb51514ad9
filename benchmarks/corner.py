"""Seconds of the corner's stages, medians of several runs in one process, imports not counted.

    python benchmarks/corner.py [--repeat 5]

`mesh` is a mesh of tolerance 1e-3, `total` all up to it, `refit` the choice of another member of
the solved space after a point has moved.
"""

from __future__ import annotations

import argparse
import time
from collections import defaultdict
from collections.abc import Callable
from statistics import median

import pas

AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
CASES = {
    "equal k=1": (("1/3", "1/3", "1/3"), 1),
    "equal k=2": (("1/3", "1/3", "1/3"), 2),
    "equal k=3": (("1/3", "1/3", "1/3"), 3),
    "unequal k=1": (("1/3", "1/4", "2/5"), 1),
    "unequal k=2": (("1/3", "1/4", "2/5"), 2),
    "unequal k=3": (("1/3", "1/4", "2/5"), 3),
}
STAGES = ("partition", "solve", "fit and prove", "mesh", "total", "refit")


def seconds(work: Callable[[], object]) -> float:
    """The seconds one call takes."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def corner(radii: tuple[str, ...], order: int) -> dict[str, float]:
    """Seconds by stage of one blend, its mesh at tolerance 1e-3 and a refit."""
    pipes = [pas.Pipe(axis, radius, 1) for axis, radius in zip(AXES, radii, strict=True)]
    start = time.perf_counter()
    blend = pas.blend(pipes, order)
    spent = time.perf_counter() - start
    times = dict(blend.timings)
    times["mesh"] = seconds(lambda: blend.surface.triangulate(1e-3))
    times["total"] = spent + times["mesh"]
    times["refit"] = seconds(lambda: blend.refit(near=[("-3/10", "-3/10", "-3/10")], near_weight=3))
    return times


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=5)
    repeat = parser.parse_args().repeat
    corner(*CASES["equal k=1"])  # imports
    print(f"{'':<12}" + "".join(f"{stage:>14}" for stage in STAGES))
    for name, case in CASES.items():
        runs: dict[str, list[float]] = defaultdict(list)
        for _ in range(repeat):
            for stage, spent in corner(*case).items():
                runs[stage].append(spent)
        print(f"{name:<12}" + "".join(f"{median(runs[stage]):>14.3f}" for stage in STAGES), flush=True)


if __name__ == "__main__":
    main()
