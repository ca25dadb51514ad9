"""Limits and progress of long computations."""

from __future__ import annotations

import pytest

import pas
from pas.limits import checkpoint, limit


class Clock:
    def __init__(self):
        self.now = 100.0

    def monotonic(self):
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr("pas.limits.time", clock)
    return clock


def test_past_the_deadline_it_gives_up_in_words(clock):
    with limit(seconds=10):
        checkpoint("eliminating")
        clock.now += 10.5
        with pytest.raises(pas.LimitError, match="gave up after 10 s while eliminating 3 x 4; allow more seconds"):
            checkpoint("eliminating 3 x 4")
    checkpoint("afterwards there is no limit")


def test_an_inner_limit_cannot_outlast_an_outer_one(clock):
    with limit(seconds=10):
        clock.now += 4
        with limit(seconds=60):
            clock.now += 7
            with pytest.raises(pas.LimitError, match="gave up after 6 s"):
                checkpoint("waiting")


def test_progress_is_reported_now_and_then(clock):
    lines = []
    with limit(progress=lines.append):
        for i in range(40):
            clock.now += 0.1
            with limit():
                pass
            checkpoint("counting", i / 40)
    assert lines[0].startswith("counting (2")
    assert 5 <= len(lines) <= 7


def test_bad_limits():
    with pytest.raises(ValueError, match="seconds must be a positive number"), limit(seconds=0):
        pass
