"""Limits and progress of long computations."""

from __future__ import annotations

import pytest

import pas
from pas.limits import checkpoint, limit, note


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
            with pytest.raises(pas.LimitError, match="gave up after 10 s"):
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


def test_a_limit_inside_reports_to_the_listener_around_it(clock):
    lines = []
    with limit(progress=lines.append), limit(seconds=60):
        note("quick work is not told of")
        assert not lines
        clock.now += 1.5
        checkpoint("counting")
        note("done")
    assert lines == ["counting, 2 s", "done"]


def test_a_loop_far_below_says_the_task_that_was_said_last(clock):
    with limit(seconds=10):
        checkpoint("eliminating 3 x 4")
        clock.now += 10.5
        with pytest.raises(pas.LimitError, match="while eliminating 3 x 4"):
            checkpoint()


def test_bad_limits():
    with pytest.raises(ValueError, match="seconds must be a positive number"), limit(seconds=0):
        pass


def test_groebner_bases_look_at_the_clock_and_go_on(monkeypatch):
    """With little room the basis is the same, found in several steps."""
    from pas.algebra import normal_form
    from pas.algebra.ideal import Ideal

    generators = ["x^2 + y*z - 1", "y^2 - z", "z^2 - x*y"]
    whole = Ideal(*generators).groebner_basis("lex")
    monkeypatch.setattr(normal_form, "FIRST_ROOM", (2, 2, 2))
    assert Ideal(*generators).groebner_basis("lex") == whole
    with limit(seconds=1e-9), pytest.raises(pas.LimitError, match="computing a Groebner basis"):
        Ideal(*generators).groebner_basis("lex")


def test_what_is_stopped_ends_at_its_next_look_and_inner_limits_are_stopped_too():
    asked = []
    with limit(stopped=lambda: len(asked) > 1), limit(seconds=100):
        checkpoint("eliminating")
        asked += [1, 2]
        with pytest.raises(pas.LimitError, match="stopped while eliminating"):
            checkpoint()
    checkpoint("afterwards nothing is stopped")
    with pytest.raises(TypeError, match="stopped must be a function without arguments"), limit(stopped=True):
        pass
