"""Surfaces with known truth: nothing false is proved, nothing true refuted, every witness is right.

Case n of a break is drawn from a generator seeded by its name and n, so that a failure names the
case.  What is exact (faces, membership in a contact's ideal) must be decided, and enough of the
rest: a proof that decided nothing would tell no lies.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from random import Random

import pytest
from adversarial.exact_checks import exact, meets_ray_once, witness_flaws
from adversarial.surface_bases import Known, Truth
from adversarial.surface_breaks import BREAKS
from adversarial.surface_disguises import disguised
from adversarial.surface_places import in_hull

from pas import Certificate, Status, Verdict

COUNTS = {
    # break: (cases in CI, cases in all, least share of the inequalities known that are decided)
    "ball_factor": (12, 900, 0.5),
    "point_factor": (12, 500, 0.2),
    "positive_factor": (6, 250, 0.2),
    "plane_factor": (25, 900, 0.4),
    "turned": (10, 300, 1.0),
    "cubed": (1, 50, 0.0),
    "jump": (35, 1000, 1.0),
    "one_coefficient": (35, 1000, 0.7),
    "higher_order": (25, 800, 1.0),
    "other_contact": (20, 700, 0.8),
    "scaled_contact": (15, 400, 1.0),
    "turned_contact": (10, 300, 1.0),
    "lowered": (25, 700, 0.9),
    "lowered_alpha": (20, 700, 0.8),
    "local_sheet": (12, 500, 0.9),
    "touching_quadric": (40, 1000, 0.6),
    "inflection": (10, 300, 0.4),
}

BLOCK = 100
"""Cases of one slow test, so that the net can be run and followed in parts."""

RAYS = 3
"""Along which a sheet that is proved is looked at, exactly."""


def test_every_break_is_counted():
    assert set(COUNTS) == set(BREAKS)
    assert sum(count for count, _, _ in COUNTS.values()) >= 280
    assert sum(count for _, count, _ in COUNTS.values()) >= 10_000


@pytest.mark.parametrize("name", COUNTS)
def test_no_false_verdict(name):
    count, _, share = COUNTS[name]
    assert decided_share(name, range(count)) >= share


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "first"), [(name, first) for name, (_, count, _) in COUNTS.items() for first in range(0, count, BLOCK)]
)
def test_no_false_verdict_among_ten_thousand(name, first):
    _, count, share = COUNTS[name]
    assert decided_share(name, range(first, min(first + BLOCK, count))) >= share


def decided_share(name: str, numbers: range) -> float:
    """The share of known inequalities that are decided in these cases; fails if one is wrong."""
    decided: Counter[bool] = Counter()
    flaws = []
    for number in numbers:
        random = Random(f"{name} {number}")
        known = disguised(BREAKS[name](random), random)
        certificate = known.surface.certify()
        flaws += [f"{name} {number}: {known.story}: {flaw}" for flaw in flaws_of(known, certificate, random)]
        for truth, verdict in zip(
            (known.sheet, known.enclosed), (certificate.one_sheet, certificate.enclosed), strict=True
        ):
            if truth is not Truth.UNKNOWN:
                decided[verdict.status is not Status.UNDECIDED] += 1
    assert flaws == []
    return decided[True] / decided.total() if decided else 1.0


def flaws_of(known: Known, certificate: Certificate, random: Random) -> Iterator[str]:
    """Everything that is wrong in a certificate."""
    sheet_and_walls = ((known.sheet, certificate.one_sheet), (known.enclosed, certificate.enclosed))
    pairs = [*zip(known.contacts, certificate.contacts, strict=True), *sheet_and_walls]
    for truth, verdict in pairs:
        if verdict.status is FALSE.get(truth):
            yield f"it {truth.value}, but {verdict}"
    for truth, verdict in zip(known.faces, certificate.faces, strict=True):
        if verdict.status is not {Truth.HOLDS: Status.PROVED, Truth.FAILS: Status.REFUTED}[truth]:
            yield f"it {truth.value}, but {verdict}"
    yield from witness_flaws(known.surface, certificate)
    if certificate.one_sheet.proved:
        yield from ray_flaws(known, certificate.one_sheet, random)


FALSE = {Truth.HOLDS: Status.REFUTED, Truth.FAILS: Status.PROVED}
"""What a verdict must not say."""


def ray_flaws(known: Known, verdict: Verdict, random: Random) -> Iterator[str]:
    """Rays from the centre that meet the surface twice or not transversally, by Sturm's theorem."""
    region = known.surface.partition
    for _ in range(RAYS):
        face = random.choice(region.outer_faces)
        end = in_hull(region, face.vertices, random)
        if not meets_ray_once(known.surface.polynomials[face.piece], exact(region.center), end):
            yield f"the ray to {tuple(map(float, end))} meets it more than once or not from inside, but {verdict}"
