"""Rays that are hard to shoot: none of their crossings is missed and none invented.

Case n of a family is drawn from a generator seeded by the family's name and n, so that a failure names the case; its
surface is the one number n of those there are.  The truth is worked out exactly in `adversarial.exact_rays`.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from random import Random

import numpy as np
import pytest
from adversarial.ray_cases import FAMILIES, TARGETS, Target, target

from pas.algebra.rational import to_float

COUNTS = {
    # family: (cases in CI, cases in all)
    "ordinary": (22, 550),
    "tangent": (44, 1375),
    "through edges": (33, 1100),
    "along faces": (33, 1100),
    "from the surface": (33, 1100),
    "from far": (44, 1375),
    "long and short": (44, 1375),
    "at the boundary": (22, 825),
    "from the centre": (22, 550),
    "double roots": (33, 1100),
}

BLOCK = 275
"""Cases of one slow test, so that the net can be run and followed in parts."""

CLOSE = 1e-6
"""Of the region's size, and 1e-14 of how far the origin is: what parameters may be off by as points."""


def test_every_family_is_counted():
    assert set(COUNTS) == set(FAMILIES)
    assert sum(count for count, _ in COUNTS.values()) >= 300
    assert sum(count for _, count in COUNTS.values()) >= 10_000


@pytest.mark.parametrize("family", COUNTS)
def test_no_crossing_is_missed_or_invented(family):
    assert list(flaws(family, range(COUNTS[family][0]))) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "first"), [(family, n) for family, (_, count) in COUNTS.items() for n in range(0, count, BLOCK)]
)
def test_no_crossing_is_missed_or_invented_among_ten_thousand_rays(family, first):
    assert list(flaws(family, range(first, min(first + BLOCK, COUNTS[family][1])))) == []


def flaws(family: str, numbers: range) -> Iterator[str]:
    """What is wrong with these cases."""
    names = list(TARGETS)
    for number in numbers:
        name = names[number % len(names)]
        aim = target(name)
        origin, direction = FAMILIES[family](aim, Random(f"{family} {number}"))
        for flaw in flaws_of(aim, np.array(origin), np.array(direction)):
            yield f"{family} {number}: {name}: {origin}, {direction}: {flaw}"


def flaws_of(aim: Target, origin: np.ndarray, direction: np.ndarray) -> Iterator[str]:
    """What is wrong with the crossings of one ray."""
    truth = aim.ground.crossings(origin.tolist(), direction.tolist())
    found = aim.evaluator.rays([origin], [direction])
    first = aim.evaluator.first([origin], [direction])[0]
    if found.sides.tolist() != [side for _, side in truth]:
        yield f"sides are {found.sides.tolist()}, not {[side for _, side in truth]}"
        return
    if not np.array_equal(first, found.first[0], equal_nan=True) and abs(first / found.first[0] - 1) > CLOSE:
        yield f"the first is {first}, not {found.first[0]}"
    for parameter, point, (exact, _) in zip(found.parameters.tolist(), found.points, truth, strict=True):
        t = Fraction(int(exact.p), int(exact.q))
        right = [Fraction(o) + t * Fraction(d) for o, d in zip(origin.tolist(), direction.tolist(), strict=True)]
        if max(map(abs, right)) > Fraction(10) ** 300:
            continue
        near = CLOSE * aim.size + 1e-14 * max(float(np.abs(origin).max()), *(abs(float(v)) for v in right))
        if np.abs(point - np.array(right, dtype=float)).max() > near:
            yield f"a crossing is at {point.tolist()}, not at {list(map(float, right))}"
        known = to_float(exact)
        if parameter != known and not abs(parameter - known) * np.abs(direction).max() <= near:
            yield f"a parameter is {parameter}, not {known}"
