"""How many junctions with straight runs are proved, straight and fair: 60 drawn at random, at GC^1 and GC^2 in turn.

The run has radius 1 (a reducer's thinner end 3/5 to 9/10); radii of branches are drawn from 3/10 to 1, their angles to
the run from 50 to 90 degrees, the angles around it so that branches are at least 80 degrees apart; clips are placed by
`pas.struts`.  Prints a line for each junction, and how many are proved, have a waist within its limit, and are within
all limits; with `--solids` also how long meshes of the solid take, full and as a wall, at a thousandth of the radius.

    python benchmarks/junctions.py [--kinds T cross ...] [--count 60] [--seed 2026] [--solids]
"""

from __future__ import annotations

import argparse
import random
from collections import Counter
from fractions import Fraction
from math import cos, radians, sin
from statistics import median

from measured import spent as processor_seconds

import pas

KINDS = {"T": 1, "cross": 2, "two branches": 2, "three branches": 3, "reducer": 1, "bend": 1, "Y": 0}
"""The kinds and how many branches each has."""

Item = tuple[tuple[Fraction, Fraction, Fraction], Fraction]


def exact(x: float, y: float, z: float) -> tuple[Fraction, Fraction, Fraction]:
    """A direction with three decimals."""
    return Fraction(round(1000 * x), 1000), Fraction(round(1000 * y), 1000), Fraction(round(1000 * z), 1000)


def draw(generator: random.Random, kind: str) -> list[Item]:
    """Directions and radii of a junction of a kind."""
    if kind == "Y":
        turns = (0.0, generator.uniform(118.5, 121), 240.0)
        return [(exact(cos(radians(turn)), sin(radians(turn)), 0), Fraction(1)) for turn in turns]
    bend = generator.uniform(0, 25) if kind == "bend" else 0.0
    thinner = Fraction(generator.randint(6, 9), 10) if kind == "reducer" else Fraction(1)
    items = [(exact(1, 0, 0), Fraction(1)), (exact(-cos(radians(bend)), sin(radians(bend)), 0), thinner)]
    around = generator.uniform(0, 360)
    for number in range(KINDS[kind]):
        turn = around + (180 if kind == "cross" else generator.uniform(80, 120)) * number
        along, side = radians(generator.uniform(50, 90)), radians(turn)
        axis = exact(cos(along), sin(along) * cos(side), sin(along) * sin(side))
        items.append((axis, Fraction(generator.randint(6, 20), 20)))
    return items


def main() -> None:
    """Draw, blend, measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--solids", action="store_true")
    options = parser.parse_args()
    pas.node([((1, 0, 0), 1), ((0, 1, 0), 1)])  # imports
    generator = random.Random(options.seed)
    known: Counter[str] = Counter()
    waists, seconds = [], []
    spent: dict[str, list[float]] = {"full": [], "hollow": []}
    for number in range(options.count):
        kind, order = options.kinds[number % len(options.kinds)], 1 + number // len(options.kinds) % 2
        items = draw(generator, kind)
        start = processor_seconds()
        try:
            blend = pas.node(items, order, seconds=240)
        except pas.PasError as error:
            print(f"#{number} {kind}, GC^{order}: {error}", flush=True)
            continue
        seconds.append(processor_seconds() - start)
        fairness, beyond = blend.fairness, blend.fairness.beyond(blend.limits)
        waists.append(fairness.waist)
        known["proved"] += bool(blend.certificate.proved)
        known["straight"] += fairness.waist <= blend.limits.waist
        known["within all other limits"] += not [word for word in beyond if not word.startswith("waist")]
        known["within all"] += not beyond
        meshed = solid_meshes(blend, spent) if options.solids else ""
        print(
            f"#{number} {kind}, GC^{order}: {blend.surface.partition.title}, degree {blend.surface.degree}, waist "
            f"{fairness.waist:.3f}, {', '.join(beyond) or 'fair'}, {seconds[-1]:.1f} s{meshed}",
            flush=True,
        )
    shares = ", ".join(f"{count} {name}" for name, count in known.items())
    print(
        f"{options.count} junctions: {shares}; waist {median(waists):.3f} (median), {max(waists):.3f} (largest); "
        f"seconds of one processor: {median(seconds):.1f} (median), {max(seconds):.1f} (largest)"
    )
    for name, times in spent.items():
        if times:
            print(f"{len(times)} meshes of {name} solids: {median(times):.2f} s (median), {max(times):.2f} s (largest)")


def solid_meshes(blend: pas.Blend, spent: dict[str, list[float]]) -> str:
    """How long the meshes of a junction's solid take, full and hollow, in words, or why there is none."""
    words = ""
    thickness = Fraction(round(125 * min(end.radius or end.radii[0] for end in blend.ends())), 1000)
    for name, of in (("full", lambda: blend), ("hollow", lambda: blend.hollow(thickness))):
        try:
            solid = of().solid()
            start = processor_seconds()
            mesh = solid.mesh(0.001, seconds=120)
        except pas.PasError as error:
            words += f", {name}: {error}"
            continue
        spent[name].append(processor_seconds() - start)
        assert mesh.is_closed
        words += f", {name} in {spent[name][-1]:.2f} s{'' if solid.sheets else ' by a lattice'}"
    return words


if __name__ == "__main__":
    main()
