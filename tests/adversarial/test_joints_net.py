"""Joints with known truth: not one false verdict, and none undecided but where faces are singular on the curve."""

from __future__ import annotations

from fractions import Fraction

import joint_cases
import numpy as np
import pytest

from pas import Status

IN_TURN = len(joint_cases.KINDS)
ROUNDS, MANY = 10, 2080
"""Of all kinds in turn, for every test run; and joints in the long one."""


def check(number: int) -> None:
    """One joint's verdict is the right one, and a missing face is missing where it says so."""
    case = joint_cases.make(number)
    verdict = case.solid.verdicts[0]
    assert verdict.status is case.expected, (number, case.kind, str(verdict))
    if case.gap is not None:
        place = [Fraction(c) for c in verdict.witness]
        largest = max(abs(c) for c in place)
        slope = case.gap.gradient(np.array([[float(c) for c in place]]))[0]
        assert float(case.gap.at(place)) <= 1e-9 * float(np.abs(slope).sum()) * float(1 + largest), (number, case.kind)


@pytest.mark.parametrize("kind", joint_cases.KINDS)
def test_joints_of_known_truth(kind):
    for turn in range(ROUNDS):
        check(turn * IN_TURN + list(joint_cases.KINDS).index(kind))


@pytest.mark.slow
@pytest.mark.parametrize("block", range(MANY // 80))
def test_many_joints_of_known_truth(block):
    for number in range(block * 80, block * 80 + 80):
        check(number)


def test_every_kind_is_hostile_somewhere():
    """Both verdicts occur, so that neither refusing nor believing everything would pass."""
    found = [joint_cases.make(n).expected for n in range(IN_TURN * ROUNDS)]
    assert min(found.count(Status.PROVED), found.count(Status.REFUTED)) > len(found) / 4
