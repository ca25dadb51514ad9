"""How many random corners are proved and fair: 100 drawn radii and clip distances at each order.

Clip distances are drawn from 1/2, 11/20, .., 2; radii from 20% to 100% of the largest rational
with two decimals whose circle, enlarged by 10%, still fits its face.  Prints a line for each
corner that is not proved or not fair, and the shares, degrees and seconds.

    python benchmarks/random_corners.py [--orders 1 2 3] [--count 100] [--seed 2026]
"""

from __future__ import annotations

import argparse
import random
import time
from collections import Counter
from fractions import Fraction
from math import floor, sqrt
from statistics import median

import pas

AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def draw(generator: random.Random) -> list[pas.Pipe]:
    """Three pipes along the axes, with circles that fit their faces with 10% to spare."""
    heights = [Fraction(generator.randint(10, 40), 20) for _ in AXES]
    pipes = []
    for i, axis in enumerate(AXES):
        a, b = sorted(float(h) for j, h in enumerate(heights) if j != i)
        largest = a * b / sqrt(a * a + 4 * b * b) / 1.1
        radius = Fraction(max(1, floor(100 * generator.uniform(0.2, 1.0) * largest)), 100)
        pipes.append(pas.Pipe(axis=axis, radius=radius, clip=heights[i]))
    return pipes


def main() -> None:
    """Run the draws and print what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--orders", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=2026)
    options = parser.parse_args()
    pas.blend(draw(random.Random(0)), 1)  # imports
    for order in options.orders:
        generator = random.Random(options.seed)
        degrees: Counter[int] = Counter()
        seconds, alone, fair = [], [], 0
        for number in range(options.count):
            pipes = draw(generator)
            start, processor = time.perf_counter(), time.process_time()
            try:
                blend = pas.blend(pipes, order)
            except pas.PasError as error:
                print(f"k={order} #{number}: {'; '.join(map(str, pipes))}: {error}", flush=True)
            else:
                assert blend.certificate.proved
                degrees[blend.surface.degree] += 1
                beyond = blend.fairness.beyond(blend.limits)
                fair += not beyond
                if beyond:
                    print(f"k={order} #{number}: {'; '.join(map(str, pipes))}: {', '.join(beyond)}", flush=True)
            seconds.append(time.perf_counter() - start)
            alone.append(time.process_time() - processor)
        shares = ", ".join(f"degree {n}: {c}" for n, c in sorted(degrees.items()))
        print(
            f"k={order}: {degrees.total()} of {options.count} proved ({shares}), {fair} fair; "
            f"seconds: median {median(seconds):.2f}, largest {max(seconds):.2f}, of processors {median(alone):.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
