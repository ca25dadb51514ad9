"""How many random nodes are proved and fair: draws of 2 to 6 pipes in any directions, at each order.

Directions are whole vectors with entries up to 6, at least 50 degrees apart; radii are drawn from 1, 11/10, .., 2;
clips are the nearest at which no circle is seen wider than 40 degrees from the middle and no two take up more than a
share (`--fit`, 0.8 if nothing is said) of the angle between their directions.  Prints a line for each node that is not
proved, or not fair, and for each number of pipes the shares, layouts, degrees and seconds.

    python benchmarks/nodes.py [--orders 1 2] [--pipes 2 3 4 5 6] [--count 20] [--fit 0.8] [--auto] [--lowest]
                               [--against]

With `--auto` clips are placed by `pas.struts`; with `--lowest` the first degree that is proved is kept, whatever its
shape.  With `--against` the variation of curvature is compared with that of the least thin-plate energy, of the same
degree on the same region.
"""

from __future__ import annotations

import argparse
import random
from collections import Counter
from dataclasses import fields, replace
from fractions import Fraction
from itertools import combinations
from math import atan, ceil, gcd, hypot, radians
from statistics import median

import numpy as np
from measured import spent as processor_seconds

import pas

APART, WIDEST, ENTRIES = radians(50), radians(40), 6
FINE = 64
WIDER = 1.5

Ray = tuple[int, int, int]


def directions(generator: random.Random, number: int) -> list[Ray]:
    """Whole vectors, no two of which are closer than 50 degrees."""
    while True:
        found: list[Ray] = []
        for _ in range(400):
            v = [generator.gauss(0, 1) for _ in range(3)]
            size = ENTRIES / max(map(abs, v))
            whole = tuple(round(c * size) for c in v)
            x, y, z = (c // gcd(*whole) for c in whole)
            if all(angle((x, y, z), other) >= APART for other in found):
                found.append((x, y, z))
                if len(found) == number:
                    return found


def angle(a: Ray, b: Ray) -> float:
    """Between two directions, in radians."""
    cosine = np.dot(a, b) / (hypot(*a) * hypot(*b))
    return float(np.arccos(np.clip(cosine, -1, 1)))


def draw(generator: random.Random, number: int, fit: float) -> list[pas.Pipe]:
    """Pipes through the origin, clipped as near as they may be: all alike at first, then each by itself."""
    axes = directions(generator, number)
    sizes = [Fraction(generator.randint(10, 20), 10) for _ in axes]

    def fits(clips: list[float]) -> bool:
        wide = [atan(float(r) / c) for r, c in zip(sizes, clips, strict=True)]
        pairs = combinations(range(number), 2)
        return max(wide) <= WIDEST and all(wide[i] + wide[j] <= fit * angle(axes[i], axes[j]) for i, j in pairs)

    clips = [0.5] * number
    while not fits(clips):
        clips = [1.01 * c for c in clips]
    for i in range(number):
        least = 0.6 * clips[i]
        while clips[i] * 0.99 > least and fits([*clips[:i], clips[i] * 0.99, *clips[i + 1 :]]):
            clips[i] *= 0.99
    return [
        pas.Pipe(axis=axis, radius=size, clip=Fraction(ceil(clip / hypot(*axis) * FINE), FINE))
        for axis, size, clip in zip(axes, sizes, clips, strict=True)
    ]


def main() -> None:
    """Run the draws and print what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--orders", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--pipes", type=int, nargs="+", default=[2, 3, 4, 5, 6])
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--fit", type=float, default=0.8)
    parser.add_argument("--lowest", action="store_true")
    parser.add_argument("--auto", action="store_true")
    parser.add_argument("--against", action="store_true")
    parser.add_argument("--seed", type=int, default=2026)
    options = parser.parse_args()
    pas.blend(draw(random.Random(0), 2, 0.6), 1)  # imports
    for order in options.orders:
        for number in options.pipes:
            report(order, number, options)


def wider(limits: pas.FairnessLimits) -> pas.FairnessLimits:
    """The same limits, so many times as wide."""
    return replace(limits, **{f.name: WIDER * getattr(limits, f.name) for f in fields(limits)})


def report(order: int, number: int, options: argparse.Namespace) -> None:
    """The nodes of one order and number of pipes."""
    generator = random.Random(f"{options.seed} {number}")
    made: Counter[str] = Counter()
    seconds, fair, nearly, sharp, times = [], 0, 0, [], []
    for case in range(options.count):
        pipes = draw(generator, number, options.fit)
        start = processor_seconds()
        try:
            if options.auto:
                pipes = pas.struts([(pipe.axis, pipe.radius) for pipe in pipes], order)
            blend = pas.blend(pipes, order, "lowest" if options.lowest else None, seconds=240)
        except pas.PasError as error:
            print(f"k={order} n={number} #{case}: {error}", flush=True)
        else:
            assert blend.certificate.proved
            made[f"{blend.surface.partition.title.split()[0]}, degree {blend.surface.degree}"] += 1
            beyond = blend.fairness.beyond(blend.limits)
            sharp.append(blend.fairness.sharpness)
            fair += not beyond
            nearly += not blend.fairness.beyond(wider(blend.limits))
            if beyond:
                print(f"k={order} n={number} #{case}: {', '.join(beyond)}", flush=True)
        seconds.append(processor_seconds() - start)
        if options.against and made.total() == len(sharp) > len(times):
            times.append(against_thin_plate(pipes, blend))
    shares = ", ".join(f"{name}: {count}" for name, count in sorted(made.items()))
    print(
        f"k={order} n={number}: {made.total()} of {options.count} proved ({shares}), {fair} fair, {nearly} with limits "
        f"{WIDER} times as wide, median sharpness {median(sharp or [0.0]):.2f}; seconds of one processor: median "
        f"{median(seconds):.1f}, largest {max(seconds):.1f}",
        flush=True,
    )
    if times:
        print(
            f"  thin plate varies {median(times):.1f} times as much (median), {min(times):.1f} times at least, "
            f"five times or more in {sum(t >= 5 for t in times)} of {len(times)}",
            flush=True,
        )


def against_thin_plate(pipes: list[pas.Pipe], blend: pas.Blend) -> float:
    """How many times more the curvature of the member of the least thin-plate energy varies; infinite where none is
    seen all along its rays."""
    try:
        surface, energy = blend.surface, pas.ThinPlate()
        plate = pas.blend(pipes, blend.space.order, surface.degree, surface.partition, energy=energy, prove=False)
        return plate.fairness.variation / blend.fairness.variation
    except pas.PasError:
        return float("inf")


if __name__ == "__main__":
    main()
